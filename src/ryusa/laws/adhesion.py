"""Adhesion of two grains in touch: attraction, energy, and the impacts that it makes stick (design/0024).

Every law is a force that is linear in the overlap, A = pull + slope x, and acts as long as the grains touch;
its energy is -(pull x + slope x**2/2). The springs and dashpots of a contact stay what they are without it.
A contact begins and ends at overlap 0, so that a whole contact gains nothing from the attraction: a grain
sticks where its dashpot has taken so much that it cannot climb back to overlap 0.
"""

import math

from ryusa.laws._law import law, step_law

STEP_OF_PHASE = 0.02  # of the search for the instant at which a sticking contact began
FINE = 1.0e-3  # step of the integration of a contact of elastic spheres, in its own unit of time
MOST_STEPS = 400_000


@step_law
def adhesion_constant(amount: float, overlap: float) -> tuple[float, float]:
    """Attraction of a constant pull-off force [N], and the energy that it releases from touch on [J].

    Parameters
    ----------
    amount : pull-off force [N].
    overlap : x [m].

    >>> adhesion_constant(2.0, 0.5)
    (2.0, 1.0)
    """
    return amount, amount * overlap


@step_law
def adhesion_dmt(amount: float, r: float, overlap: float) -> tuple[float, float]:
    """Attraction 2 pi w R_e of two spheres [N], and the energy that it releases from touch on [J].

    Parameters
    ----------
    amount : work of adhesion w [J/m2]; twice the surface energy of either where both are of one material.
    r : reduced radius R_e [m].
    overlap : x [m].

    Notes
    -----
    Source: Derjaguin, Muller & Toporov 1975, J. Colloid Interface Sci. 53, 314, whose spheres keep Hertz's
    shape; of rigid spheres Bradley 1932, Phil. Mag. 13, 853. LAMMPS `dmt` writes 4 pi gamma R_e, w = 2 gamma.

    >>> force, energy = adhesion_dmt(0.5, 2.0, 0.1)
    >>> round(force / math.pi, 12), round(energy / force, 12)
    (2.0, 0.1)
    """
    force = 2.0 * math.pi * amount * r
    return force, force * overlap


@step_law
def adhesion_area(amount: float, r: float, overlap: float) -> tuple[float, float]:
    """Attraction in proportion to the contact area pi R_e x [N], and the energy that it releases [J].

    Parameters
    ----------
    amount : energy density c, the attraction per area [J/m3 = Pa].
    r : reduced radius R_e [m].
    overlap : x [m].

    Notes
    -----
    Source: the simplified JKR model of LIGGGHTS, c A; the area of Hertz pi a**2 = pi R_e x is half of the
    circle in which the spheres intersect (`cohesion sjkr`) and a quarter of that of `cohesion sjkr2`.

    >>> force, energy = adhesion_area(0.5, 2.0, 3.0)
    >>> round(force / math.pi, 12), round(energy / force, 12)
    (3.0, 1.5)
    """
    slope = math.pi * amount * r
    return slope * overlap, 0.5 * slope * overlap * overlap


@step_law
def adhesion_given_by_step(
    now: float, energy: float, before: float, energy_before: float, begins: float, ends: float,
    closing: float, hdt: float,
) -> float:  # fmt: skip
    """Energy that the attraction gains because a contact begins or ends between two steps [J].

    Parameters
    ----------
    now, energy : attraction and its energy at the overlap of this step [N], [J].
    before, energy_before : those of the step before.
    begins, ends : 1 if the pair touches now and did not before, and if it did and does no longer; else 0 [-].
    closing : closing speed [m/s].
    hdt : half the time step [s].

    Notes
    -----
    Source: derived. The work of half an interval is A closing hdt; at the begin the potential takes the
    energy, at the end it gives it back. Between two steps in touch the two agree to third order in the step.

    >>> adhesion_given_by_step(2.0, 1.0, 2.0, 0.0, 1.0, 0.0, 0.5, 1.0)
    0.0
    """
    return closing * hdt * (begins * now + ends * before) - begins * energy + ends * energy_before


@law
def overlap_at_rest_hertz(load: float, slope: float, k_hertz: float) -> float:
    """Overlap of two elastic spheres at which K x**1.5 carries a load and the attraction slope x [m].

    Parameters
    ----------
    load : load and constant attraction together [N], >= 0.
    slope : attraction over overlap [N/m], >= 0.
    k_hertz : K of `hertz.hertz_stiffness` [N/m**1.5].

    Notes
    -----
    By Newton's method. Without a load (slope/K)**2, without a slope (load/K)**(2/3).

    >>> round(overlap_at_rest_hertz(0.0, 2.0, 1.0), 12), round(overlap_at_rest_hertz(8.0, 0.0, 1.0), 12)
    (4.0, 4.0)
    """
    x = 2.0 * ((load / k_hertz) ** (2.0 / 3.0) + (slope / k_hertz) ** 2)
    if x == 0.0:
        return 0.0
    for _ in range(100):
        root = math.sqrt(x)
        change = (k_hertz * x * root - slope * x - load) / (1.5 * k_hertz * root - slope)
        x -= change
        if math.fabs(change) <= 1.0e-15 * x:
            break
    return x


@law
def overlap_max_adhesive(speed: float, m: float, k_n: float, zeta: float, pull: float) -> float:
    """Largest overlap of a damped impact on a linear spring under a constant attraction [m].

    Parameters
    ----------
    speed : closing speed at first touch [m/s].
    m : effective mass [kg].
    k_n : normal stiffness [N/m].
    zeta : damping ratio [-].
    pull : attraction [N].

    Notes
    -----
    Source: damped oscillator about pull/k_n; without damping pull/k_n + sqrt((pull/k_n)**2 + m speed**2/k_n).

    >>> overlap_max_adhesive(0.0, 1.0, 2.0, 0.0, 3.0), overlap_max_adhesive(4.0, 1.0, 1.0, 0.0, 3.0)
    (3.0, 8.0)
    """
    rest, omega = pull / k_n, math.sqrt(k_n / m)
    u = speed / omega  # over the natural frequency, as all speeds here
    square = (1.0 - zeta) * (1.0 + zeta)
    w = math.sqrt(math.fabs(square))
    slow = u * zeta - rest  # -(y'' at touch), y = x - rest
    if square > 0.0:
        phase = math.atan2(u * w, slow) / w
        return rest + math.exp(-zeta * phase) * (
            (u - zeta * rest) * math.sin(w * phase) / w - rest * math.cos(w * phase)
        )
    if slow <= 0.0 or (w > 0.0 and u * w >= slow):
        return rest  # approached from below: never beyond it
    phase = u / slow if w == 0.0 else math.atanh(u * w / slow) / w
    grown = phase if w == 0.0 else math.sinh(w * phase) / w
    return rest + math.exp(-zeta * phase) * ((u - zeta * rest) * grown - rest * math.cosh(w * phase))


@law
def overlap_max_adhesive_hertz(energy: float, pull: float, slope: float, k_hertz: float) -> float:
    """Largest overlap of elastic spheres that bring an energy and attract each other, without damping [m].

    Parameters
    ----------
    energy : kinetic energy at first touch, m v**2/2 [J].
    pull, slope : attraction pull + slope x [N], [N/m].
    k_hertz : K of `hertz.hertz_stiffness` [N/m**1.5].

    Notes
    -----
    Source: conservation, energy + pull x + slope x**2/2 = (2/5) K x**2.5, by Newton's method.

    >>> round(overlap_max_adhesive_hertz(12.8, 0.0, 0.0, 1.0), 12)
    4.0
    >>> round(overlap_max_adhesive_hertz(0.0, 3.2, 0.0, 1.0), 12)
    4.0
    """
    x = (
        (2.5 * energy / k_hertz) ** 0.4
        + (2.5 * pull / k_hertz) ** (2.0 / 3.0)
        + (1.25 * slope / k_hertz) ** 2
    )
    x *= 2.0
    if x == 0.0:
        return 0.0
    for _ in range(100):
        root = math.sqrt(x)
        excess = 0.4 * k_hertz * x * x * root - 0.5 * slope * x * x - pull * x - energy
        change = excess / (k_hertz * x * root - slope * x - pull)
        x -= change
        if math.fabs(change) <= 1.0e-15 * x:
            break
    return x


@law
def pull_off_area(slope: float, k_hertz: float) -> float:
    """Largest force that an attraction slope x holds against K x**1.5 [N]: (4/27) slope**3/K**2.

    Parameters
    ----------
    slope : attraction over overlap [N/m].
    k_hertz : K of `hertz.hertz_stiffness` [N/m**1.5].

    Notes
    -----
    Source: derived, at the overlap (2 slope/(3 K))**2. Unlike a pull-off force it falls with the modulus.

    >>> pull_off_area(3.0, 1.0)
    4.0
    """
    return 4.0 / 27.0 * slope * slope * slope / (k_hertz * k_hertz)


@law
def sticking_speed(pull: float, m: float, k_n: float, zeta: float, tension: bool) -> float:
    """Closing speed up to which a head-on impact on a linear spring sticks [m/s].

    Parameters
    ----------
    pull : constant attraction [N].
    m : effective mass [kg].
    k_n : normal stiffness [N/m].
    zeta : damping ratio [-].
    tension : whether the dashpot may pull until the overlap ends; else spring and dashpot never pull.

    Notes
    -----
    Source: derived, design/0024. The slowest impact that parts reaches overlap 0 with no speed left; the
    oscillator about pull/k_n is followed back from there to the touch. Where spring and dashpot may not pull,
    the last 2 eta/k_n of such a contact are those of the attraction alone. For small zeta
    2 sqrt(pi zeta) pull/sqrt(k_n m), 0 without damping; inf with tension from zeta = 1 on.

    >>> round(sticking_speed(3.0, 4.0, 1.0, 1.0e-6, True) / (3.0 * math.sqrt(math.pi * 1.0e-6)), 4)
    1.0
    """
    if tension and zeta >= 1.0:
        return math.inf
    if zeta == 0.0:
        return 0.0
    y, rate = -1.0, 0.0  # overlap less that at rest over that at rest, and its rate back in phase
    if not tension:
        y, rate = 8.0 * zeta * zeta - 1.0, 4.0 * zeta
    square = (1.0 - zeta) * (1.0 + zeta)
    w = math.sqrt(math.fabs(square))
    low, high, phase, speed = 0.0, math.inf, STEP_OF_PHASE, 0.0
    for _ in range(MOST_STEPS):
        if square > 0.0:
            c, s = math.cos(w * phase), math.sin(w * phase) / w
        else:
            c, s = math.cosh(w * phase), math.sinh(w * phase) / w if w > 0.0 else phase
        grown = math.exp(zeta * phase)
        x = 1.0 + grown * (y * c + (rate - zeta * y) * s)
        speed = -grown * (rate * c + (zeta * rate - y) * s)
        if x > 0.0:
            low = phase
        else:
            high = phase
        if high == math.inf:
            phase += STEP_OF_PHASE
        else:
            phase = 0.5 * (low + high)
            if high - low <= 4.0e-16 * high:
                return pull / math.sqrt(k_n * m) * speed
    return math.inf


@law
def sticking_factor_hertz(zeta: float, tension: bool, by_area: bool) -> float:
    """Speed up to which a head-on impact of elastic spheres sticks, in units of their own [-].

    Parameters
    ----------
    zeta : damping ratio [-].
    tension : whether the dashpot may pull until the overlap ends; else spring and dashpot never pull.
    by_area : whether the attraction is proportional to the overlap; else it is constant.

    Notes
    -----
    Source: derived, design/0024. In units in which mass, K and the attraction are 1, the equation
    x'' + max(x**1.5 + sqrt(5) zeta x**0.25 x', 0) = 1 (or x) is integrated back from overlap 0 without speed
    to the touch, by the method of Runge and Kutta; to 1e-5. inf where no impact parts.

    >>> round(sticking_factor_hertz(1.0e-4, True, False) / math.sqrt(1.0e-4), 3)
    3.664
    """
    alpha, dt = math.sqrt(5.0) * zeta, FINE
    x, u = (1.0e-6, 1.0e-6) if by_area else (0.5 * dt * dt, dt)
    if zeta == 0.0:
        return 0.0
    for _ in range(MOST_STEPS):
        x_0, u_0 = x, u
        x_sum, u_sum, x_k, u_k = 0.0, 0.0, x, u
        for k in range(4):
            root = math.sqrt(max(x_k, 0.0))
            push = max(x_k, 0.0) * root - alpha * math.sqrt(root) * u_k
            if not tension:
                push = max(push, 0.0)
            rate = (max(x_k, 0.0) if by_area else 1.0) - push
            weight = 1.0 if k in (0, 3) else 2.0
            x_sum, u_sum = x_sum + weight * u_k, u_sum + weight * rate
            ahead = dt if k == 2 else 0.5 * dt
            x_k, u_k = x_0 + ahead * u_k, u_0 + ahead * rate
        x, u = x_0 + dt / 6.0 * x_sum, u_0 + dt / 6.0 * u_sum
        if x <= 0.0:
            return -(u_0 + (u - u_0) * x_0 / (x_0 - x))
        if not x < 1.0e12:
            return math.inf + x
    return math.inf


@law
def sticking_speed_hertz(
    pull: float, slope: float, m: float, k_hertz: float, zeta: float, tension: bool
) -> float:
    """Closing speed up to which a head-on impact of elastic spheres sticks [m/s].

    Parameters
    ----------
    pull, slope : attraction [N], [N/m]; one of the two is 0.
    m : effective mass [kg].
    k_hertz : K of `hertz.hertz_stiffness` [N/m**1.5].
    zeta, tension : as in `sticking_factor_hertz` [-].

    Notes
    -----
    Source: derived, design/0024. Units of overlap: (pull/K)**(2/3), or (slope/K)**2; of speed
    pull**(5/6)/(K**(1/3) sqrt(m)), or slope**2.5/(K**2 sqrt(m)).

    >>> round(
    ...     sticking_speed_hertz(64.0, 0.0, 4.0, 8.0, 0.1, True) / sticking_factor_hertz(0.1, True, False), 9
    ... )
    8.0
    """
    if pull == 0.0 and slope == 0.0:
        return 0.0
    if slope != 0.0:
        return slope**2.5 / (k_hertz**2 * math.sqrt(m)) * sticking_factor_hertz(zeta, tension, True)
    unit = pull ** (5.0 / 6.0) / (k_hertz ** (1.0 / 3.0) * math.sqrt(m))
    return unit * sticking_factor_hertz(zeta, tension, False)
