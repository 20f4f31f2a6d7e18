"""Parameters of a scene: one row of doubles that kernels read at the places named here."""

import numpy as np

from ryusa.laws.families import ContactForce
from ryusa.laws.hertz import effective_modulus, mindlin_ratio
from ryusa.model import Scene
from ryusa.model.scene import Damping, Floats

# What each is stands where `parameters_of` sets it.
(
    DT, K_N, K_S, MU, COHESION, ROLLING, ROLLING_STIFFNESS, ROLLING_ZETA, OVERLAP_LIMIT,
    DISPLACEMENT_LIMIT, PERIOD_X, PERIOD_Y, G_X, G_Y, G_Z, U_STAR, K_ROUGH, Z_ZERO, U_UNIFORM, DEPTH,
    NU, RHO_W, C_D, A_2, SKIN, T_ZERO, ZETA_N, ZETA_S, ETA_N, ETA_S, HINDRANCE, C_L, FILM_REACH,
    ASPERITY, ST_C, E_DRY, E_LEAST, E_EFFECTIVE, MINDLIN, TWISTING, ADHESION, N_PARAMETER,
) = range(42)  # fmt: skip

# Largest displacement of a grain in one step, over the smallest diameter: two grains that approach each other
# by twice that cannot pass through each other unseen (design/0008).
LARGEST_DISPLACEMENT = 0.25


def parameters_of(scene: Scene) -> Floats:
    """Parameters of a scene; the engine itself sets SKIN and T_ZERO."""
    law, rolling, water = scene.contact, scene.rolling, scene.water
    asked = law.damping == Damping.RESTITUTION
    table = {
        DT: scene.dt,
        K_N: law.k_n,
        K_S: law.k_s,
        MU: law.mu,
        COHESION: law.cohesion,
        ROLLING: rolling.coefficient,
        ROLLING_STIFFNESS: rolling.stiffness_factor,
        ROLLING_ZETA: rolling.zeta_r,
        OVERLAP_LIMIT: scene.overlap_limit,
        # largest displacement of a grain in one step [m]
        DISPLACEMENT_LIMIT: LARGEST_DISPLACEMENT * scene.d_min,
        PERIOD_X: scene.period[0],
        PERIOD_Y: scene.period[1],
        G_X: scene.gravity[0],
        G_Y: scene.gravity[1],
        G_Z: scene.gravity[2],
        U_STAR: water.u_star,
        K_ROUGH: water.k_rough,
        Z_ZERO: water.z_zero,
        U_UNIFORM: water.u_uniform,
        DEPTH: water.depth,
        NU: water.nu,
        RHO_W: water.rho_w,
        C_D: water.c_d,
        A_2: water.a_2,
        SKIN: 0.0,
        T_ZERO: 0.0,  # time of step 0 [s]
        ZETA_N: law.zeta_n if asked else 0.0,
        ZETA_S: law.zeta_s if asked else 0.0,
        ETA_N: 0.0 if asked else law.eta_n,  # constants, 0 where they follow from restitution
        ETA_S: 0.0 if asked else law.eta_s,
        HINDRANCE: water.hindrance_exponent,
        C_L: water.c_l,
        FILM_REACH: water.film_reach,  # gap below which a film resists before touch [m]
        ASPERITY: water.asperity,
        ST_C: water.st_c,
        E_DRY: law.e_n,  # restitution of the case, in air [-]
        E_LEAST: water.e_least,
        E_EFFECTIVE: 0.0,  # of elastic spheres [Pa]; else 0
        MINDLIN: 0.0,  # their tangential stiffness over K sqrt(overlap) [-]
        TWISTING: rolling.twisting,  # largest torque about the normal over f_n R* [-]
        ADHESION: law.adhesion_amount,  # pull-off force [N], work of adhesion [J/m2] or energy density [Pa]
    }
    if law.force == ContactForce.HERTZ_MINDLIN:
        table[E_EFFECTIVE] = effective_modulus(law.youngs_modulus, law.poisson_ratio)
        table[MINDLIN] = mindlin_ratio(law.poisson_ratio)
    parameters = np.zeros(len(table))
    for place, value in table.items():
        parameters[place] = value
    return parameters
