"""One contact of elastic spheres, one time step: the counterpart of `contact_step` for Hertz and Mindlin.

Geometry, sliding and forces are those of `contact_step`; the springs are not: the normal one stiffens with
the overlap, and the stiffness of the tangential one changes from step to step. A pair keeps its overlap of
the last step, from which follow its spring forces and stiffnesses then. Work is accounted by velocity
interval, as there: where the work of the curved spring over an interval differs from what it has taken up, by
third order in the step, and where a contact begins or ends between two steps, the difference is the term
`step`.
"""

import math

from ryusa.laws._law import step_law
from ryusa.laws.contact_step import tangential_step

# A dashpot acts on the velocity of half a step before, which stiffens spring and dashpot by 1 + eps/2,
# eps = eta dt/m. To first order in eps the loss of an impact is kept if the dashpot is 1 - (5/22) eps of its
# value: (1 - k) B(3/5, 3/2) = B(8/5, 1/2)/2.2 at k = 5/11 of eps/2 (design/0018; the linear contact has 1/4).
LAG = 5.0 / 22.0


@step_law
def spring_hertz(overlap: float, k_hertz: float) -> tuple[float, float]:
    """Force of the normal spring [N], and the root of the overlap [m**0.5]; both 0 without overlap.

    Parameters
    ----------
    overlap : x [m].
    k_hertz : K of `hertz.hertz_stiffness` [N/m**1.5].

    >>> spring_hertz(4.0, 0.5), spring_hertz(-1.0, 0.5)
    ((4.0, 2.0), (0.0, 0.0))
    """
    x = max(overlap, 0.0)
    root = math.sqrt(x)
    return k_hertz * x * root, root


@step_law
def dashpot_hertz(fourth: float, c_hertz: float, per_m: float, dt: float) -> float:
    """Normal dashpot of elastic spheres at an overlap [N s/m], for a velocity of half a step before.

    Parameters
    ----------
    fourth : fourth root of the overlap [m**0.25], >= 0.
    c_hertz : of `hertz.hertz_damping` [N s/m**1.25].
    per_m : one over the effective mass [1/kg].
    dt : time step [s].

    Notes
    -----
    Source: Tsuji et al. 1992, c x**0.25; less (5/22) eta dt/m of it, derived as `contact.damping_in_steps`.

    >>> dashpot_hertz(2.0, 2.0, 1.0, 0.0)
    4.0
    """
    eta = c_hertz * fourth
    return eta / (1.0 + LAG * eta * per_m * dt)


@step_law
def normal_step_hertz(
    overlap: float, closing: float, raw: float, e_n: float, least: float, hdt: float
) -> tuple[float, float, float, float, float]:
    """Normal force at a step, and its work over the half interval before it.

    Parameters
    ----------
    overlap, closing : as `contact_step.contact_kinematics` gives them [m], [m/s].
    raw : spring and dashpot before the limit is applied [N].
    e_n : force of the spring [N], from `spring_hertz`.
    least : smallest normal force that a contact may have [N]: 0, or -inf if the dashpot may pull.
    hdt : half the time step [s]; 0 in the first step of a run.

    Returns
    -------
    f_n : normal force [N]; positive pushes apart.
    held, touching : 1 if the contact exerts a force, and if the grains touch; else 0 [-].
    dashpot, released : energy dissipated by the dashpot, and lost because the force was limited [J].

    >>> normal_step_hertz(4.0, 1.0, 9.0, 8.0, 0.0, 1.5)
    (9.0, 1.0, 1.0, 1.5, 0.0)
    """
    touching = overlap > 0.0
    f_n = max(raw, least) if touching else 0.0
    held = touching and f_n > least
    work = hdt * closing * (f_n - e_n)
    return f_n, 1.0 if held else 0.0, 1.0 if touching else 0.0, work if held else 0.0, 0.0 if held else work


@step_law
def normal_work_hertz(
    overlap: float, closing: float, e_n: float, overlap_old: float, f_old: float, e_old: float, least: float,
    hdt: float,
) -> tuple[float, float, float]:  # fmt: skip
    """Work of the previous normal force over the half interval after it, and the error of the step.

    Parameters
    ----------
    overlap, closing, e_n, least, hdt : as in `normal_step_hertz`.
    overlap_old : overlap at the previous step [m]; 0 if the pair did not touch.
    f_old, e_old : normal force then, and that of its spring [N].

    Returns
    -------
    dashpot, released : energy dissipated by the dashpot, and lost because the force was limited [J].
    step : energy added by the step: the elastic energy (2/5) F x taken up, less the work on the spring [J].

    Notes
    -----
    Source: derived, design/0018. In touch at both steps the work on the spring is that of the mean force over
    the change of the overlap, else that of the one force over half the interval.

    >>> [round(x, 9) for x in normal_work_hertz(4.0, 1.0, 8.0, 1.0, 1.0, 1.0, 0.0, 1.5)]
    [0.0, 0.0, -1.1]
    """
    touching, touched = overlap > 0.0, overlap_old > 0.0
    before, held_old = hdt * closing * (f_old - e_old), f_old > least
    taken = 0.4 * (e_n * overlap - e_old * overlap_old)
    moved, flown = 0.5 * (overlap - overlap_old), hdt * closing
    added = taken - (moved if touching and touched else flown) * (e_n + e_old)
    step = added if hdt > 0.0 else 0.0
    return before if held_old else 0.0, 0.0 if held_old else before, step


@step_law
def shear_spring_hertz(
    rescaled: bool, root: float, root_old: float, k_shear: float
) -> tuple[float, float, float, float]:
    """Tangential stiffness at a step, and what the change of the contact does to the spring.

    Parameters
    ----------
    rescaled : whether a spring is let go with the contact area as this shrinks.
    root, root_old : root of the overlap now and at the step before [m**0.5]; 0 where the pair did not touch.
    k_shear : tangential stiffness over the root of the overlap [N/m**1.5].

    Returns
    -------
    k_s : stiffness [N/m]; that of the step before if the grains touch no longer.
    soft_s, soft_old : inverse of it, and of that of the step before if they touched then [m/N]; 0 without
        a spring.
    scale : factor of the spring force kept from the step before [-].

    Notes
    -----
    Source: Mindlin 1949, k_s = 8 G_e a, a proportional to the root. On loading the force is kept: the area
    that comes in carries no tangential stress. On unloading it is multiplied by a/a_old: what the area that
    goes out carried is lost (Walton 1993; LAMMPS `mindlin_rescale/force`). Without it energy comes from
    nothing.

    >>> shear_spring_hertz(True, 1.0, 2.0, 4.0), shear_spring_hertz(False, 1.0, 2.0, 4.0)
    ((4.0, 0.25, 0.125, 0.5), (4.0, 0.25, 0.125, 1.0))
    >>> shear_spring_hertz(True, 0.0, 2.0, 4.0)
    (8.0, 0.125, 0.125, 1.0)
    """
    here, before = root if root > 0.0 else root_old, root_old if root_old > 0.0 else root
    k_s = k_shear * here
    both = k_s * before
    # one division for the two, outside of any branch, which would keep the lanes of a batch apart
    inverse = 1.0 / (both if both > 0.0 else math.inf)
    soft_s, soft_old = before * inverse, here * inverse
    return k_s, soft_s, soft_old, max(min(k_s * soft_old, 1.0), 0.0 if rescaled else 1.0)


@step_law
def tangential_step_hertz(
    plane: bool, total: bool, drop: bool, cap_total: bool, n_x: float, n_y: float, n_z: float, twist: float,
    f_n: float, e_n: float, held: float, s_x: float, s_y: float, s_z: float, p_x: float, p_y: float,
    p_z: float, q_x: float, q_y: float, q_z: float, k_s: float, soft_s: float, soft_old: float, scale: float,
    eta_s: float, cohesion: float, mu: float, dt: float, hdt: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """Tangential spring and dashpot force on grain i after a step, and the work of the whole interval.

    Parameters
    ----------
    plane, total, drop, cap_total, n_x, n_y, n_z, twist, f_n, e_n, held, s_x, s_y, s_z, p_x, p_y, p_z,
        q_x, q_y, q_z, cohesion, mu, dt, hdt : as in `contact_step.tangential_step`.
    k_s, soft_s, soft_old, scale : as `shear_spring_hertz` gives them [N/m], [m/N], [m/N], [-].
    eta_s : tangential dashpot at the overlap [N s/m]: c x**0.25, c of `hertz.mindlin_damping`.

    Returns
    -------
    As `contact_step.tangential_step`; the energy lost without work has, beside that of a contact without
    force, what the spring loses as its stiffness changes [J].

    Notes
    -----
    Source: Mindlin 1949 with history, as LAMMPS `mindlin/force`; derived, design/0018. The spring holds
    e**2/(2 k_s) at the present stiffness. Scaled, it cannot gain: on loading k_s grows, on unloading e**2
    falls faster than k_s.

    >>> flags, normal, slip = (True, False, False, False), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0)
    >>> force, law = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0), (4.0, 0.25, 0.125, 0.5, 0.0, 0.0, 1.0)
    >>> found = tangential_step_hertz(*flags, *normal, 9.0, 9.0, 1.0, *slip, *force, *law, 0.1, 0.05)
    >>> found[0], found[6], found[9]
    (0.5, 1.0, 0.03125)
    """
    held_force, slid = p_x * p_x, s_x * p_x
    if not plane:
        held_force += p_y * p_y + p_z * p_z
        slid += s_y * p_y + s_z * p_z
    changed = 0.5 * held_force * (soft_old - scale * scale * soft_s) - hdt * (1.0 - scale) * slid
    e_x, e_y, e_z, b_x, b_y, b_z, share, dashpot, sliding, released = tangential_step(
        plane, total, drop, cap_total, n_x, n_y, n_z, twist, f_n, e_n, held, s_x, s_y, s_z,
        scale * p_x, scale * p_y, scale * p_z, q_x, q_y, q_z, k_s, soft_s, eta_s, cohesion, mu, dt, hdt,
    )  # fmt: skip
    return e_x, e_y, e_z, b_x, b_y, b_z, share, dashpot, sliding, released + changed
