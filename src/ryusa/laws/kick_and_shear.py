"""The exact map of a linear contact over one time step, and its true instants of touch and release.

A contact of linear spring and dashpot, alone, is a damped oscillator y'' + 2 a y' + (a**2 + q) y = 0 with
decay rate a [1/s] and square of the angular frequency q [1/s2], negative when it is overdamped. Its normal
motion over a step is a kick, a shear and a kick (`kick_and_shear`, design/0014), with velocities that are
those of the oscillator; where it begins or ends within a step, `touch_in_step` and `part_in_step` follow it.
The tangential motion goes the same way, its spring kept as a force: it does not move the grains apart.
"""

import math

from ryusa.laws._law import law, step_law
from ryusa.laws.elementary import exp, log
from ryusa.laws.elementary_trigonometric import arctan_of_root, cosine_of_root, half_angle, sine_of_root

DOUBLINGS = 4  # of a sixteenth of the time
LEAST_SQUARE = 0.04  # of the hyperbolic tangent of an eighth of the angle, from which its logarithm is taken


@law
def decay_rate(eta: float, m: float) -> float:
    """Decay rate a of a contact [1/s]: eta/(2 m).

    Parameters
    ----------
    eta : dashpot [N s/m].
    m : effective mass [kg].

    >>> decay_rate(4.0, 2.0)
    1.0
    """
    return 0.5 * eta / m


@law
def frequency_squared(k: float, eta: float, m: float) -> float:
    """Square q of the angular frequency of a damped contact [1/s2]: k/m - a**2; negative when overdamped.

    Parameters
    ----------
    k : stiffness [N/m].
    eta : dashpot [N s/m].
    m : effective mass [kg].

    >>> frequency_squared(10.0, 4.0, 2.0)
    4.0
    """
    a = decay_rate(eta, m)
    return k / m - a * a


@law
def dashpot_of_kick(eta: float, m: float, dt: float) -> float:
    """Dashpot of the half steps before and after a kick [N s/m]: m (1 - exp(-a dt))/dt.

    Parameters
    ----------
    eta : dashpot [N s/m].
    m : effective mass [kg].
    dt : time step [s].

    Notes
    -----
    Source: derived, design/0014. Over dt it takes from a velocity what `eta` takes in half the time.

    >>> round(dashpot_of_kick(4.0 * math.log(2.0), 2.0, 1.0), 12)
    1.0
    """
    return -m * math.expm1(-decay_rate(eta, m) * dt) / dt


@step_law
def decay_of_kick(eta_d: float, m: float, dt: float) -> float:
    """Decay rate a of the oscillator of a pair [1/s]; inverse of `dashpot_of_kick`.

    Parameters
    ----------
    eta_d : dashpot at kicks [N s/m].
    m : effective mass [kg].
    dt : time step [s].

    Notes
    -----
    Source: derived, design/0014. The error is that of 1e-16 in the phase a dt over a step.

    >>> round(decay_of_kick(dashpot_of_kick(0.5, 2.0, 0.1), 2.0, 0.1), 12)
    0.125
    """
    return -log(1.0 - eta_d * dt / m) / dt


@step_law
def free_response(t: float, a: float, q: float) -> tuple[float, float]:
    """Displacement [s] and velocity [-] of the oscillator at time t for a unit velocity at time 0.

    Parameters
    ----------
    t : time [s], of either sign, abs(q) t**2 at most 500.
    a : decay rate [1/s].
    q : square of the angular frequency [1/s2].

    Returns
    -------
    g : exp(-a t) sin(w t)/w.
    h : dg/dt. From displacement x and velocity v at time 0, the displacement at t is x (h + 2 a g) + v g,
        and the velocity v h - (a**2 + q) x g.

    Notes
    -----
    Source: derived, design/0014. Power series in q over a part of the time, then the angle and the decay
    doubled: no case of damping has to be told from another.

    >>> free_response(0.5, 0.0, 0.0)
    (0.5, 1.0)
    """
    part = t * (1.0 / 2**DOUBLINGS)
    z, decay = q * part * part, exp(-a * part)
    g, c = decay * part * sine_of_root(z), decay * cosine_of_root(z)
    for _ in range(DOUBLINGS):
        g, c = 2.0 * g * c, c * c - q * g * g
    return g, c - a * g


@step_law
def kick_and_shear(dt: float, a: float, q: float) -> tuple[float, float, float, float]:
    """The flow of the oscillator over a step as a kick at either end and a shear between them.

    Parameters
    ----------
    dt : time step [s].
    a : decay rate [1/s].
    q : square of the angular frequency [1/s2].

    Returns
    -------
    way : displacement of the shear over its velocity [s].
    after, before : rate that the kicks after and before a step take from a displacement [1/s].
    left : what the dashpot leaves of a velocity in half a step [-].

    Notes
    -----
    Source: derived, design/0014. From displacement x and velocity v, u = v - after x, and one step later
    x + way u and left**2 u - before (x + way u). Without damping kicks and shear are canonical, whatever else
    acts on the velocities at the steps.

    >>> way, after, before, left = kick_and_shear(1.0, 0.0, (math.pi / 3.0) ** 2)
    >>> u = 2.0 - after * 0.5
    >>> x = 0.5 + way * u
    >>> math.isclose(x, 0.25 + 2.0 * math.sin(math.pi / 3.0) / (math.pi / 3.0)), after == before, left
    (True, True, 1.0)
    """
    # from half the time, so that nothing is the difference of two large numbers
    g, h = free_response(0.5 * dt, a, q)
    left, way = exp(-a * dt), 2.0 * g * (h + a * g)
    turned, gone = 2.0 * q * g * g, 1.0 - left
    return way, (turned + gone - a * way) / way, (turned + a * way - left * gone) / way, left


@step_law
def springs_of_kicks(k: float, eta_d: float, m: float, dt: float) -> tuple[float, float, float, float, float]:
    """Springs of the kicks of a pair.

    Parameters
    ----------
    k : stiffness [N/m].
    eta_d : dashpot at kicks, of `dashpot_of_kick` [N s/m].
    m : effective mass [kg].
    dt : time step [s].

    Returns
    -------
    k_d : force of a kick over the displacement [N/m].
    way, after : of `kick_and_shear` [s], [1/s].
    stored : stiffness of which the energy is that of the spring, if m u u'/2 is that of the motion with u and
        u' the velocities before and after a kick [N/m].
    k_step : force that a spring gains in a step over velocity times dt [N/m], for a spring that is kept as
        its force.

    Notes
    -----
    Source: derived, design/0014. All tend to k for small steps.

    >>> k_d, way, after, stored, k_step = springs_of_kicks(1.0, 0.0, 1.0, 1.0)
    >>> math.isclose(k_d, 2.0 * math.tan(0.5)), math.isclose(stored, 1.0 / math.cos(0.5) ** 2)
    (True, True)
    >>> math.isclose(k_step, 4.0 * math.sin(0.5) ** 2)
    True
    """
    a = decay_of_kick(eta_d, m, dt)
    way, after, before, left = kick_and_shear(dt, a, k / m - a * a)
    k_d = m * (after + before) / dt
    return k_d, way, after, k + m * after * before, k_d * way / (left * dt)


@step_law
def time_of_release(x: float, v: float, a: float, q: float, tension: bool) -> float:
    """Time until the force of a contact ends [s]; inf if it does not, 0 if it has ended.

    Parameters
    ----------
    x : overlap [m].
    v : its rate [m/s], the closing speed.
    a : decay rate [1/s].
    q : square of the angular frequency [1/s2].
    tension : the force ends with the overlap; else where it would pull.

    Notes
    -----
    Source: derived, design/0014. Overlap, rate and force are all exp(-a t) (A cos(w t) + B sin(w t)/w).

    >>> round(time_of_release(0.0, 1.0, 0.0, 4.0, True), 9)
    1.570796327
    """
    cosine, sine = x, v + a * x
    if not tension:
        for _ in range(2):  # twice the derivative: the force is minus m y''
            cosine, sine = sine - a * cosine, -a * sine - q * cosine
        cosine, sine = -cosine, -sine
    # tan(w t/2)/w, where w t, or what it lacks to a half turn, is below a quarter turn
    steep = math.fabs(sine)
    half = cosine / (steep + math.sqrt(max(sine * sine + q * cosine * cosine, 0.0)))
    eighth = half_angle(half_angle(half, q), q)
    square = q * eighth * eighth
    t = 8.0 * eighth * arctan_of_root(square)
    w = math.sqrt(math.fabs(q))
    if square < -LEAST_SQUARE:
        t = 0.5 * log((steep + w * cosine) / (steep - w * cosine)) / w
    if sine >= 0.0:
        t = math.pi / w - t if q > 0.0 else math.inf
    if q < 0.0 and steep <= w * cosine:
        t = math.inf
    return 0.0 if cosine < 0.0 else t


@step_law
def touch_in_step(x: float, v: float, dt: float, a: float, q: float) -> tuple[float, float, float]:
    """Let a contact that begins within the coming step be the oscillator from its true instant of touch.

    Parameters
    ----------
    x : overlap at the step [m]; minus the gap if the grains do not touch yet.
    v : closing speed [m/s], > 0.
    dt : time step [s].
    a : decay rate [1/s].
    q : square of the angular frequency [1/s2].

    Returns
    -------
    since : time from touch to the end of the step [s]; negative if there is none within it.
    y, rate : overlap at the end of the step [m], and its rate [m/s].

    >>> touch_in_step(-0.5, 1.0, 1.0, 0.0, 0.0)
    (0.5, 0.5, 1.0)
    """
    since = dt - max(-x, 0.0) / v
    held = max(x, 0.0)
    g, h = free_response(since, a, q)
    return since, held * (h + 2.0 * a * g) + v * g, v * h - (a * a + q) * held * g


@step_law
def part_in_step(x: float, v: float, until: float, dt: float, a: float, q: float) -> tuple[float, float]:
    """Let a contact that ends within the coming step leave the oscillator at its true instant of release.

    Parameters
    ----------
    x : overlap at the step [m].
    v : its rate [m/s].
    until : time to the end of the force [s], at most dt.
    dt : time step [s].
    a : decay rate [1/s].
    q : square of the angular frequency [1/s2].

    Returns
    -------
    y : overlap at the end of the step [m], after a free flight from the release on.
    rate : its rate in that flight [m/s].

    >>> part_in_step(0.5, -1.0, 0.0, 1.0, 0.0, 4.0)
    (-0.5, -1.0)
    """
    g, h = free_response(until, a, q)
    rate = v * h - (a * a + q) * x * g
    return x * (h + 2.0 * a * g) + v * g + rate * (dt - until), rate
