"""Hertz's and Mindlin's law of elastic spheres in the words of `pair_style granular` (design/0025)."""

import math

from ryusa.engine.lammps.partner import Partner
from ryusa.laws.collision import effective_mass, effective_mass_tangential, restitution_tension
from ryusa.laws.families import Unloading
from ryusa.laws.hertz import (
    effective_modulus,
    hertz_damping,
    hertz_stiffness,
    mindlin_damping,
    mindlin_ratio,
    overlap_max_hertz,
)
from ryusa.laws.hertz_step import LAG
from ryusa.laws.rolling import reduced_radius
from ryusa.model import Scene

# B(3/5, 3/2)/B(1/2, 3/2): mean of the dashpot over an impact without losses, weighted by what it takes, over
# the dashpot at the largest overlap.
_MEAN = math.gamma(0.6) * math.gamma(2.0) / (math.gamma(2.1) * math.gamma(0.5))
_TANGENTIAL = {Unloading.RESCALED: "mindlin_rescale/force", Unloading.PLAIN: "mindlin/force"}


def elastic_words(scene: Scene, i: Partner, j: Partner) -> str:
    """Normal force, dashpot and tangential force of two elastic spheres, or of one and a plane.

    Notes
    -----
    `hertz` takes K/sqrt(R_e), `mindlin` k_s/a. `damping coeff_restitution` damps with sqrt(5) zeta sqrt(K m)
    x**0.25, where zeta is that of a contact that may pull, e = exp(-pi zeta/sqrt(1 - zeta**2)); it is given
    the e that belongs to `damping_ratio_in_steps`. The tangential dashpot is the normal one times a constant
    (LAMMPS documentation, pair_style granular), as that of ryusa is: both go with x**0.25.
    """
    law = scene.contact
    stiff, ratio = _stiffness(scene, i, j), mindlin_ratio(law.poisson_ratio)
    zeta, m_n = damping_ratio_in_steps(scene, i, j), effective_mass(i.m, j.m)
    m_t = effective_mass_tangential(i.m, i.r, i.inertia, j.m, j.r, j.inertia, scene.rotation)
    dashed = mindlin_damping(law.zeta_s, ratio * stiff, m_t)
    per_normal = dashed / hertz_damping(zeta, stiff, m_n) if zeta > 0.0 else 0.0
    k = hertz_stiffness(effective_modulus(law.youngs_modulus, law.poisson_ratio), 1.0)
    return (
        f"hertz {k!r} {restitution_tension(zeta)!r} damping coeff_restitution "
        f"tangential {_TANGENTIAL[law.unloading]} {ratio * k!r} {per_normal!r} {law.mu!r}"
    )


def damping_ratio_in_steps(scene: Scene, i: Partner, j: Partner) -> float:
    """Damping ratio of elastic spheres that damps as that of the law, from velocities of half a step before.

    Notes
    -----
    Source: derived. `hertz_step.dashpot_hertz` takes (5/22) eps of the dashpot away, eps = eta dt/m, where
    eta goes with x**0.25. LAMMPS has one constant for all overlaps. Over an impact without losses an amount
    that is taken away in equal parts costs as much as one that goes with eps if it is the mean of that,
    weighted by the rate at which the dashpot takes energy: B(3/5, 3/2)/B(1/2, 3/2) of it at the largest
    overlap, at the speed that is to be expected. At another speed it is off by (v/v_0)**0.2 - 1 of itself.
    """
    law = scene.contact
    stiff, m = _stiffness(scene, i, j), effective_mass(i.m, j.m)
    largest = overlap_max_hertz(law.speed, m, stiff, 0.0)
    eps = hertz_damping(law.zeta_n, stiff, m) * largest**0.25 * scene.dt / m
    return law.zeta_n / (1.0 + LAG * _MEAN * eps)


def _stiffness(scene: Scene, i: Partner, j: Partner) -> float:
    law = scene.contact
    modulus = effective_modulus(law.youngs_modulus, law.poisson_ratio)
    return hertz_stiffness(modulus, reduced_radius(i.r, j.r))
