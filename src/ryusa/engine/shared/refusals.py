"""What engines refuse before any step: a scene they cannot simulate, a state that does not fit it."""

from typing import get_type_hints

import numpy as np

from ryusa.engine.shared.parameters import LARGEST_DISPLACEMENT
from ryusa.errors import NotANumber
from ryusa.laws._family import Family
from ryusa.laws.families import Adhesion, ContactForce, ContactTiming, Fluctuations, Profile, Rebound
from ryusa.model import RigidBodies, Scene, State, Walls
from ryusa.model.scene import ALIKE, Damping, Floats
from ryusa.model.walls import SPIN, largest_speed

_OFF = 1.0e-6  # of a diameter, or of a unit quaternion: more is no round-off
_SHORTEST_PERIOD = 3.0  # in diameters: below, a pair could touch through two images


def refusals(scene: Scene) -> tuple[str, ...]:
    """Reasons why the engine cannot carry the scene; () when it can."""
    reasons = unknown_choices(scene)
    if reasons:
        return tuple(reasons)
    if "spring" in scene.rolling.model.marks and "varies" in scene.rolling.arm.marks:
        reasons.append(
            "the spring-dashpot-slider needs rolling.arm = 'reduced radius': its stiffness may not change"
        )
    if scene.rolling.twisting > 0.0:
        if "both alike" in scene.rolling.model.marks:
            reasons.append(
                "twisting friction opposes the relative spin: rolling.model may not act alike on both"
            )
        if scene.plane_case or not scene.rotation:
            reasons.append("twisting friction needs motion in space with rotation")
    if scene.water.rebound != Rebound.DRY and scene.contact.damping == Damping.CONSTANTS:
        reasons.append("an immersed rebound needs a restitution in air: contact.damping gives constants")
    reasons += _refused_of_hertz(scene)
    reasons += _refused_of_adhesion(scene)
    reasons += _refused_of_materials(scene)
    reasons += _refused_of_clumps(scene)
    largest = float(np.concatenate([scene.d, scene.d_fixed[scene.fixed_active]]).max(initial=0.0))
    for axis, length in zip("xy", scene.period, strict=True):
        if length < _SHORTEST_PERIOD * largest:
            reasons.append(f"the period in {axis} ({length:g} m) is shorter than 3 diameters ({largest:g} m)")
    for k, axis in enumerate("xy"):
        if np.isfinite(scene.period[k]) and np.any(scene.plane_normal[scene.plane_active, k] != 0.0):
            reasons.append(f"a plane stands across the periodic direction {axis}")
    if scene.walls is not None:
        reasons += _walls(scene, scene.walls)
    return tuple(reasons)


def _walls(scene: Scene, walls: Walls) -> list[str]:
    """Reasons why the walls of a scene cannot be simulated."""
    reasons: list[str] = []
    if scene.plane_case:
        reasons.append("walls need motion in space: a plane scene has none but planes")
    for k, axis in enumerate("xy"):
        across = np.delete(walls.motion[:, SPIN : SPIN + 3], k, axis=1)
        for w in np.flatnonzero(walls.active & np.any(across != 0.0, axis=1)):
            if np.isfinite(scene.period[k]):
                reasons.append(f"wall '{walls.names[w]}' turns across the periodic direction {axis}")
    smallest = scene.d_min
    step, speed = LARGEST_DISPLACEMENT * smallest, largest_speed(walls)
    if speed * scene.dt > step:
        way = speed * scene.dt / smallest
        reasons.append(
            f"walls move at up to {speed:.3g} m/s, {way:.2g} diameters in one step: at most "
            f"{LARGEST_DISPLACEMENT:g}; a smaller time step is needed"
        )
    return reasons


def _refused_of_hertz(scene: Scene) -> list[str]:
    """What elastic spheres cannot have."""
    law, found = scene.contact, list[str]()
    if law.force != ContactForce.HERTZ_MINDLIN:
        return found
    if law.timing != ContactTiming.AT_STEPS:
        found.append("elastic spheres (Hertz-Mindlin) need contact.timing = 'at steps' (design/0018)")
    if law.damping == Damping.CONSTANTS:
        found.append("elastic spheres (Hertz-Mindlin) take a restitution, not constant dashpots")
    if not (0.0 < law.youngs_modulus < np.inf and 0.0 <= law.poisson_ratio <= 0.5):
        found.append("elastic spheres need a Young's modulus above 0 and a Poisson's ratio from 0 to 0.5")
    return found


def _refused_of_adhesion(scene: Scene) -> list[str]:
    """What adhesive contacts cannot have."""
    law, found = scene.contact, list[str]()
    if law.adhesion == Adhesion.NONE:
        return found
    if law.timing != ContactTiming.AT_STEPS:
        found.append("adhesion needs contact.timing = 'at steps' (design/0024)")
    if "elastic" in law.adhesion.marks and law.force != ContactForce.HERTZ_MINDLIN:
        found.append(
            f"adhesion '{law.adhesion.word}' needs elastic spheres (Hertz-Mindlin), which have an area"
        )
    laws = (law,) if scene.materials is None else scene.materials.contact
    if not all(0.0 <= one.adhesion_amount < np.inf for one in laws):
        found.append("the amount of adhesion must be a number from 0 on")
    return found


def _refused_of_materials(scene: Scene) -> list[str]:
    """What contacts between several materials cannot have."""
    made, law, found = scene.materials, scene.contact, list[str]()
    if made is None:
        return found
    if len(made.of) != scene.n_partner or not (made.of >= 0).all() or not (made.of < made.n).all():
        found.append(f"materials need a number from 0 to {made.n - 1} for each of {scene.n_partner} ids")
    if len(made.contact) != made.n**2 or len(made.rolling) != made.n**2:
        found.append(f"{made.n} materials need {made.n**2} contact laws")
        return found
    if law.damping == Damping.CONSTANTS:
        found.append("materials need a restitution, not constant dashpots (contact.damping)")
    for k, one in enumerate(made.contact):
        if any(getattr(one, name) != getattr(law, name) for name in ALIKE):
            found.append(f"contacts of {made.pair_name(k)} need the laws of all others: {', '.join(ALIKE)}")
    springs = {(one.k_n, one.k_s) for one in made.contact}
    at_steps = law.force == ContactForce.LINEAR and law.timing == ContactTiming.AT_STEPS
    if at_steps and len(springs) > 1:
        found.append("linear springs of several stiffnesses need contact.timing = 'exact'")
    return found


def _refused_of_clumps(scene: Scene) -> list[str]:
    """What a scene with clumps cannot have."""
    bodies, found = scene.bodies, list[str]()
    if bodies is None:
        return found
    if fault := bodies.fault(scene.n_grain):
        found.append(fault)
    if scene.contact.timing != ContactTiming.AT_STEPS:
        found.append("clumps need contact.timing = 'at steps' (design/0022)")
    if scene.plane_case or not scene.rotation:
        found.append("clumps need motion in space with rotation")
    if scene.water.profile != Profile.NONE and len(bodies.drag_form) != bodies.n:
        found.append("clumps in water need their form: bodies.drag_form (ryusa.build.clumps)")
    if scene.water.rebound != Rebound.DRY or scene.water.film_reach > 0.0:
        found.append("clumps have no films of water between them: rebound must be dry, film_reach 0")
    if scene.column is not None and scene.column.fluctuations != Fluctuations.NONE:
        found.append("clumps need a column of water without fluctuations: each grain has an eddy of its own")
    return found


def check_sampled(sampled: Floats, shape: tuple[int, ...] | None) -> None:
    """Refuse water at the grains of another shape than theirs; None: of a scene without a column of water.

    Raises
    ------
    ValueError : what is wrong.
    """
    if shape is None:
        raise ValueError("the scene has no column of water: water.profile is not COLUMN")
    if sampled.shape != shape:
        raise ValueError(f"sampled has shape {sampled.shape}, not {shape}")


def check_state(scene: Scene, state: State) -> None:
    """Refuse a state of another scene, one that is not finite, and lanes of a plane scene that overlap.

    Raises
    ------
    ValueError, NotANumber : what is wrong; the latter names the grain.
    """
    n = scene.n_grain
    if state.x.shape != (n, 3):
        raise ValueError(f"state.x has shape {state.x.shape}, the scene has {n} free grains")
    if scene.plane_case:
        _check_lanes(scene, state)
    if scene.bodies is not None:
        _check_bodies(scene, scene.bodies, state)
    bad = np.flatnonzero(~np.isfinite(np.hstack([state.x, state.v, state.omega])).all(axis=1))
    if len(bad):
        raise NotANumber(
            "position, velocity or spin is not finite",
            grain=int(bad[0]),
            step=state.step,
            t=state.t,
            hint="Nothing was stepped: give finite numbers.",
        )


def _check_bodies(scene: Scene, bodies: RigidBodies, state: State) -> None:
    """Clumps have to be where their members are."""
    moved = state.bodies
    shapes = {"x": (3,), "v": (3,), "q": (4,), "momentum": (3,), "image": (2,)}
    if moved is None or any(getattr(moved, name).shape != (bodies.n, *row) for name, row in shapes.items()):
        raise ValueError(f"state.bodies must hold the motion of {bodies.n} clumps")
    numbers = np.hstack([moved.x, moved.v, moved.q, moved.momentum])
    bad = np.flatnonzero(~np.isfinite(numbers).all(axis=1))
    if len(bad):
        raise ValueError(f"clump {bad[0]}: position, velocity, orientation or angular momentum is not finite")
    if np.abs(np.linalg.norm(moved.q, axis=1) - 1.0).max(initial=0.0) > _OFF:
        raise ValueError("an orientation of a clump is no unit quaternion")
    members = bodies.members
    apart = state.x[members] - moved.of_members(bodies)[0]
    for k in range(2):
        if np.isfinite(scene.period[k]):
            apart[:, k] -= scene.period[k] * np.round(apart[:, k] / scene.period[k])
    off = np.linalg.norm(apart, axis=1) > _OFF * np.repeat(bodies.d, bodies.count)
    if off.any():
        raise ValueError(f"grain {members[int(off.argmax())]} is not where its clump has it")


def _check_lanes(scene: Scene, state: State) -> None:
    """In a plane scene another y is another lane; lanes closer than a diameter would hide contacts."""
    lanes = np.unique(np.concatenate([state.x[:, 1], scene.x_fixed[:, 1]]))
    largest = scene.d_max
    apart = np.diff(lanes)
    if len(apart) and apart.min() < largest * (1.0 - 1e-9):
        y = lanes[int(apart.argmin())]
        text = f"a plane scene has grains at y = {y:g} m and {apart.min():g} m beside, less than a diameter"
        raise ValueError(f"{text} ({largest:g} m): give them the same y, or set the lanes apart")


def unknown_choices(scene: Scene) -> list[str]:
    """Choices of a scene, each by its family, whose number is none of the table of laws."""
    found: list[str] = []
    for part in (scene.contact, scene.rolling, scene.water, scene.column):
        if part is None:
            continue
        for name, kind in get_type_hints(type(part)).items():
            if not (isinstance(kind, type) and issubclass(kind, Family)):
                continue
            number = int(getattr(part, name))
            if number not in [int(choice) for choice in kind]:
                known = ", ".join(f"{int(choice)} ({choice.word or choice.name})" for choice in kind)
                found.append(f"{kind.key}: number {number} is none of {known}")
    return found
