"""From a scene to what a kernel reads: its variant and its table of numbers."""

import numpy as np

from ryusa.engine.shared import rows as k
from ryusa.engine.shared.rows import Choice, Variant
from ryusa.laws.rolling import epsd_stiffness, reduced_radius
from ryusa.model import Scene, State
from ryusa.model.enums import Damping, EventRule, Profile, Rolling
from ryusa.model.scene import Floats

# What a grain may move in a step, of the smallest diameter: two that near each other by twice that cannot
# pass through each other unseen (design/0008).
STEP_LIMIT = 0.25


def variant_of(scene: Scene) -> Variant:
    """The kernel this scene needs."""
    return Variant(
        plane_case=int(scene.plane_case),
        rotation=int(scene.rotation),
        rolling=int(scene.rotation and scene.rolling.model != Rolling.NONE),
        events=int(scene.events != EventRule.NONE),
        column=int(scene.water.profile == Profile.COLUMN),
        film=int(scene.water.profile != Profile.NONE and scene.water.film_reach > 0.0),
        water=int(scene.water.profile != Profile.NONE),
    )


def choice_of(scene: Scene) -> Choice:
    """The laws this scene names."""
    law, rolling, water = scene.contact, scene.rolling, scene.water
    return Choice(
        slip=int(law.slip),
        cap=int(law.cap),
        tension=int(law.tension),
        rolling=int(rolling.model),
        arm=int(rolling.arm),
        events=int(scene.events),
        profile=int(water.profile),
        above=int(water.above),
        drag=int(water.drag),
        torque=int(water.torque),
        buoyancy=int(water.buoyancy),
        hindrance=int(water.hindrance),
        lift=int(water.lift),
        magnus=int(water.magnus),
        rebound=int(water.rebound) if water.profile != Profile.NONE else 0,
    )


def numbers_of(scene: Scene) -> Floats:
    """The scalars of a scene, by the C_ names of rows.py; the skin is the engine's own."""
    law, rolling, water = scene.contact, scene.rolling, scene.water
    asked = law.damping == Damping.RESTITUTION
    table = {
        k.C_DT: scene.dt,
        k.C_K_N: law.k_n,
        k.C_K_S: law.k_s,
        k.C_MU: law.mu,
        k.C_COHESION: law.cohesion,
        k.C_ROLL: rolling.coefficient,
        k.C_ROLL_STIFFNESS: rolling.stiffness_factor,
        k.C_ROLL_ZETA: rolling.zeta_r,
        k.C_OVERLAP_LIMIT: scene.overlap_limit,
        k.C_STEP_LIMIT: STEP_LIMIT * float(np.concatenate([scene.d, scene.d_fixed]).min(initial=np.inf)),
        k.C_PERIOD_X: scene.period[0],
        k.C_PERIOD_Y: scene.period[1],
        k.C_G_X: scene.gravity[0],
        k.C_G_Y: scene.gravity[1],
        k.C_G_Z: scene.gravity[2],
        k.C_U_STAR: water.u_star,
        k.C_K_ROUGH: water.k_rough,
        k.C_Z_ZERO: water.z_zero,
        k.C_U_UNIFORM: water.u_uniform,
        k.C_DEPTH: water.depth,
        k.C_NU: water.nu,
        k.C_RHO_W: water.rho_w,
        k.C_C_D: water.c_d,
        k.C_A_2: water.a_2,
        k.C_SKIN: 0.0,
        k.C_T_ZERO: 0.0,
        k.C_ZETA_N: law.zeta_n if asked else 0.0,
        k.C_ZETA_S: law.zeta_s if asked else 0.0,
        k.C_ETA_N: 0.0 if asked else law.eta_n,
        k.C_ETA_S: 0.0 if asked else law.eta_s,
        k.C_HINDRANCE: water.hindrance_exponent,
        k.C_C_L: water.c_l,
        k.C_FILM_REACH: water.film_reach,
        k.C_ASPERITY: water.asperity,
        k.C_ST_C: water.st_c,
        k.C_E_DRY: law.e_n,
        k.C_E_LEAST: water.e_least,
    }
    numbers = np.zeros(len(table))
    for place, value in table.items():
        numbers[place] = value
    return numbers


def potential_energy(scene: Scene, state: State) -> float:
    """Energy of weight and buoyancy at a state [J], from the origin, periods crossed added."""
    x = np.array(state.x)
    for a in range(2):
        if np.isfinite(scene.period[a]) and len(state.image) == len(x):
            x[:, a] += state.image[:, a] * scene.period[a]
    return -float(np.sum(scene.m_weight[:, None] * x * scene.gravity))


def rolling_energy(scene: Scene, state: State, places: np.ndarray) -> float:
    """Energy in the rolling springs of some of a state's contacts [J]."""
    if scene.rolling.model != Rolling.EPSD:
        return 0.0
    r = 0.5 * np.concatenate([scene.d, scene.d_fixed, np.full(scene.n_plane, np.inf)])
    energy = 0.0
    for place in places:
        radius = reduced_radius(float(r[state.contacts.i[place]]), float(r[state.contacts.j[place]]))
        f = scene.rolling.coefficient * radius
        k_r = epsd_stiffness(scene.contact.k_n, f, scene.rolling.stiffness_factor)
        energy += 0.5 * float(np.sum(state.contacts.spring_r[place] ** 2)) / k_r if k_r > 0.0 else 0.0
    return energy


def energy_of_switch(before: Scene, scene: Scene, state: State, dropped: np.ndarray) -> float:
    """Energy a change of the timeline gives [J]: height on a new slope, spin locked, springs let go.

    `dropped` are the places of contacts that the change takes away.
    """
    given = potential_energy(scene, state) - potential_energy(before, state)
    if before.rotation and not scene.rotation:
        given -= float(0.5 * np.sum(scene.inertia[:, None] * state.omega**2))
        given -= rolling_energy(before, state, np.arange(len(state.contacts)))
    elif len(dropped):
        given -= rolling_energy(before, state, dropped)
    if len(dropped):
        law, gone = before.contact, state.contacts
        e_n = gone.f_n[dropped] - gone.dash_n[dropped]
        given -= float(np.sum(0.5 * e_n**2 / law.k_n))
        if law.k_s > 0.0:
            given -= float(np.sum(0.5 * gone.spring_s[dropped] ** 2 / law.k_s))
    return given
