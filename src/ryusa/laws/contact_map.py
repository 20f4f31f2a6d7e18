"""The exact map of a linear contact over one time step, and its true instants of touch and release.

A contact of linear spring and dashpot, alone, is a damped oscillator y'' + 2 a y' + (a**2 + q) y = 0 with
decay rate a [1/s] and square of the angular frequency q [1/s2], negative when it is overdamped. The scheme of
`motion.semi_implicit` with constant coefficients is a linear map too: `spring_of_map` and `dashpot_of_map`
make it the map of the oscillator sampled at the steps (design/0014). What is left of the error of a
restitution then comes from the steps in which a contact begins and ends; `begin_in_step` and `end_in_step`
let it begin and end within them.
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
def half_sine_squared(q: float, t: float) -> float:
    """sin(w t/2)**2 with w**2 = q [-]; -sinh(|w| t/2)**2 for negative q.

    Parameters
    ----------
    q : square of the angular frequency [1/s2].
    t : time [s].

    >>> round(half_sine_squared(math.pi**2, 1.0), 12)
    1.0
    """
    half = 0.5 * math.sqrt(math.fabs(q)) * t
    if q >= 0.0:
        return math.sin(half) ** 2
    return -(math.sinh(half) ** 2)


@law
def spring_of_map(k: float, eta: float, m: float, dt: float) -> float:
    """Stiffness whose discrete map is the oscillator of stiffness k [N/m].

    Parameters
    ----------
    k : stiffness [N/m].
    eta : dashpot [N s/m].
    m : effective mass [kg].
    dt : time step [s].

    Returns
    -------
    m (1 - 2 E cos(w dt) + E**2)/dt**2 with E = exp(-a dt), w**2 = q: trace and determinant of the map
    are those of the oscillator. Tends to k for small steps.

    Notes
    -----
    Source: derived, design/0014.

    >>> round(spring_of_map(1.0, 0.0, 1.0, math.pi / 3.0) * (math.pi / 3.0) ** 2, 12)
    1.0
    """
    e = math.exp(-decay_rate(eta, m) * dt)
    return m * ((1.0 - e) ** 2 + 4.0 * e * half_sine_squared(frequency_squared(k, eta, m), dt)) / (dt * dt)


@law
def dashpot_of_map(eta: float, m: float, dt: float) -> float:
    """Dashpot whose discrete map is the oscillator with dashpot eta [N s/m]: m (1 - exp(-2 a dt))/dt.

    Parameters
    ----------
    eta : dashpot [N s/m].
    m : effective mass [kg].
    dt : time step [s].

    Notes
    -----
    Source: derived, design/0014. Tends to eta for small steps.

    >>> round(dashpot_of_map(2.0 * math.log(2.0), 2.0, 1.0), 12)
    1.0
    """
    return -m * math.expm1(-2.0 * decay_rate(eta, m) * dt) / dt


@step_law
def decay_of_map(eta_d: float, m: float, dt: float) -> float:
    """Decay rate a of the oscillator of a map [1/s]; inverse of `dashpot_of_map`.

    Parameters
    ----------
    eta_d : dashpot of the map [N s/m].
    m : effective mass [kg].
    dt : time step [s].

    Notes
    -----
    Source: derived, design/0014. The error is that of 1e-16 in the phase a dt over a step.

    >>> round(decay_of_map(dashpot_of_map(0.5, 2.0, 0.1), 2.0, 0.1), 12)
    0.125
    """
    return -0.5 * log(1.0 - eta_d * dt / m) / dt


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
def velocity_of_map(x: float, v: float, dt: float, a: float, q: float) -> float:
    """Velocity at a step [m/s] of an oscillator at x that was at x - v dt one step before.

    Parameters
    ----------
    x : displacement at the step [m].
    v : mean velocity over the step before [m/s].
    dt : time step [s].
    a : decay rate [1/s].
    q : square of the angular frequency [1/s2].

    >>> round(velocity_of_map(1.0, 1.0, 1.0, 0.0, 0.0), 12)
    1.0
    """
    g, h = free_response(-dt, a, q)
    return (x - v * dt - x * (h + 2.0 * a * g)) / g


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
def begin_in_step(
    x: float, v: float, curve: float, dt: float, a: float, q: float
) -> tuple[float, float, float, float, float]:
    """Let a contact that began within the last step be the oscillator from its true instant of touch.

    Parameters
    ----------
    x : overlap at the first step that finds the grains in touch [m], > 0.
    v : closing speed of that step [m/s], > 0.
    curve : rate at which the closing speed of free grains falls as they pass each other [m/s2], as in
        `passing`.
    dt : time step [s].
    a : decay rate [1/s].
    q : square of the angular frequency [1/s2].

    Returns
    -------
    since : time since touch [s].
    v_touch : closing speed at touch [m/s].
    y : overlap that the oscillator has now [m]; less than x, since its force has braked the pair.
    rate : its rate now [m/s].
    brake : closing speed that its force takes within the coming step [m/s], so that the overlap comes to
        where the oscillator will be. The step after has to take the closing speed (y_new - y)/dt into its
        map.

    Notes
    -----
    Source: derived, design/0014: x = v since + curve since**2/2 of a free flight, v_touch = v + curve since.

    >>> begin_in_step(0.5, 1.0, 0.0, 1.0, 0.0, 0.0)
    (0.5, 1.0, 0.5, 1.0, 0.0)
    >>> begin_in_step(1.5, 1.0, 1.0, 2.0, 0.0, 0.0)
    (1.0, 2.0, 1.5, 2.0, 0.0)
    """
    v_touch = math.sqrt(v * v + 2.0 * curve * x)
    since = min(2.0 * x / (v + v_touch), dt)
    now, rate = free_response(since, a, q)
    then, _ = free_response(since + dt, a, q)
    bent = 0.5 * curve * since * since
    brake = (v_touch * (dt - then) + x + bent) / dt
    return since, v_touch, v_touch * now - bent, v_touch * rate, brake


@step_law
def passing(u_square: float, v: float, distance: float) -> float:
    """Rate at which the closing speed of two free grains falls as they pass each other [m/s2].

    Parameters
    ----------
    u_square : square of their relative velocity [m2/s2].
    v : closing speed [m/s].
    distance : of their centres [m]; inf of a grain and a plane.

    Notes
    -----
    Source: the second derivative of the distance of two points in uniform motion, (u**2 - v**2)/distance.

    >>> passing(5.0, 1.0, 2.0), passing(5.0, 1.0, math.inf)
    (2.0, 0.0)
    """
    return (u_square - v * v) / distance


@step_law
def end_in_step(x: float, v: float, until: float, dt: float, a: float, q: float) -> tuple[float, float]:
    """Let a contact that ends within the coming step leave the oscillator at its true instant of release.

    Parameters
    ----------
    x : overlap [m].
    v : its rate at the step [m/s].
    until : time to the end of the force [s], at most dt.
    dt : time step [s].
    a : decay rate [1/s].
    q : square of the angular frequency [1/s2].

    Returns
    -------
    v_mean : mean closing speed over the coming step [m/s], with free flight after the release.
    v_end : closing speed of that flight [m/s].

    >>> end_in_step(0.0, -1.0, 0.0, 1.0, 0.0, 4.0)
    (-1.0, -1.0)
    """
    g, h = free_response(until, a, q)
    there = x * (h + 2.0 * a * g) + v * g
    v_end = v * h - (a * a + q) * x * g
    return (there + v_end * (dt - until) - x) / dt, v_end
