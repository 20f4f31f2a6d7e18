"""The contact law of a scene in the words of `pair_style granular`, for each pair of types."""

from ryusa.engine.lammps.elastic_words import elastic_words
from ryusa.engine.lammps.partner import Partner
from ryusa.laws.collision import damping_ratio, effective_mass, effective_mass_tangential, restitution_tension
from ryusa.laws.contact import damping, damping_in_steps
from ryusa.laws.families import ContactForce, Rolling
from ryusa.laws.rolling import epsd_damping, epsd_stiffness, inertia_rolling, reduced_radius
from ryusa.model import Scene
from ryusa.model.scene import Damping


def contact_words(scene: Scene, i: Partner, j: Partner) -> str:
    """What follows the two types in `pair_coeff`, and the region in `fix wall/gran/region granular`.

    Parameters
    ----------
    scene : the scene, which this engine does not refuse.
    i, j : a free grain, and its partner.

    Notes
    -----
    Rolling: the force k_roll R* phi with the angle phi of relative rotation acts at the arm R*.
    """
    law = scene.contact
    elastic = law.force == ContactForce.HERTZ_MINDLIN
    words = elastic_words(scene, i, j) if elastic else linear_words(scene, i, j)
    if scene.rotation and scene.rolling.model == Rolling.EPSD:
        words += " rolling sds {!r} {!r} {!r}".format(*rolling_coefficients(scene, i, j))
    return words if law.tension else f"{words} limit_damping"


def linear_words(scene: Scene, i: Partner, j: Partner) -> str:
    """Normal force, dashpot and tangential force of linear springs.

    Notes
    -----
    `damping coeff_restitution` takes a restitution e and damps with 2 zeta sqrt(k_n m), where zeta is that of
    a contact that may pull, e = exp(-pi zeta/sqrt(1 - zeta**2)) (LAMMPS documentation, pair_style granular).
    It is given the e that belongs to the zeta of the case, for either kind of parting, after the correction
    for the lag of half a step. The tangential dashpot is given as its ratio to the normal one.
    """
    law = scene.contact
    eta_n, eta_s = dashpots(scene, i, j)
    if law.damping == Damping.CONSTANTS:
        normal = f"hooke {law.k_n!r} {law.eta_n!r} damping velocity"
    else:
        zeta = damping_ratio(eta_n, law.k_n, effective_mass(i.m, j.m))
        normal = f"hooke {law.k_n!r} {restitution_tension(zeta)!r} damping coeff_restitution"
    ratio = eta_s / eta_n if eta_n > 0.0 else 0.0
    return f"{normal} tangential linear_history {law.k_s!r} {ratio!r} {law.mu!r}"


def dashpots(scene: Scene, i: Partner, j: Partner) -> tuple[float, float]:
    """Normal and tangential dashpot of a pair [N s/m], corrected for the lag of half a step."""
    law, dt = scene.contact, scene.dt
    if law.damping == Damping.CONSTANTS:
        return law.eta_n, law.eta_s
    m_n = effective_mass(i.m, j.m)
    m_t = effective_mass_tangential(i.m, i.r, i.inertia, j.m, j.r, j.inertia, scene.rotation)
    return (
        damping_in_steps(damping(law.zeta_n, law.k_n, m_n), m_n, dt),
        damping_in_steps(damping(law.zeta_s, law.k_s, m_t), m_t, dt),
    )


def rolling_coefficients(scene: Scene, i: Partner, j: Partner) -> tuple[float, float, float]:
    """Stiffness [N/m] and dashpot [N s/m] of `rolling sds`, those of rotation over R*^2, and mu_r."""
    rolling, arm = scene.rolling, reduced_radius(i.r, j.r)
    k_r = epsd_stiffness(scene.contact.k_n, rolling.coefficient * arm, rolling.stiffness_factor)
    inertia = inertia_rolling(i.m, i.r, i.inertia, j.m, j.r, j.inertia)
    eta_r = epsd_damping(k_r, inertia, rolling.zeta_r)
    return k_r / arm**2, eta_r / arm**2, rolling.coefficient
