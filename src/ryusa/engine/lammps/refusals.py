"""What LAMMPS cannot carry, each with the key of the case and what would be carried instead."""

from collections.abc import Iterator

import numpy as np

from ryusa.engine.lammps.commands import completes_forces
from ryusa.engine.lammps.grain_types import MOST_TYPES
from ryusa.laws.families import (
    Adhesion,
    Arm,
    Cap,
    ContactForce,
    ContactTiming,
    DampingLaw,
    DragOfForm,
    Film,
    Parting,
    Rebound,
    Rolling,
    Slip,
)
from ryusa.model import Scene
from ryusa.model.scene import ContactLaw, Damping, EventRule, Floats

_STEEPEST = 0.99  # damping ratio up to which `coeff_restitution` of LAMMPS can be given an e
_ALIKE = 1e-9  # largest relative difference of ratios that are the same for all grains


def refusals_of_lammps(scene: Scene) -> tuple[str, ...]:
    """Reasons why LAMMPS cannot simulate a scene that the laws of ryusa can; () when it can."""
    return tuple(
        [*_row(scene), *_contact(scene), *_rolling(scene), *_films(scene), *_kinds(scene), *_records(scene)]
    )


def _row(scene: Scene) -> list[str]:
    if scene.row is None:
        return []
    return ["water.row: a row of columns of water goes with engine 'cpu' alone; one column would be carried"]


def _instead(key: str, value: str) -> str:
    return f"--set {key}='{value}' would be carried"


def _contact(scene: Scene) -> list[str]:
    law, found = scene.contact, list[str]()
    if law.timing != ContactTiming.AT_STEPS:
        found.append(
            f"contact.timing is '{law.timing.word}', the default: LAMMPS begins and ends contacts at steps, "
            "so that e is within 0.01 with 50 steps per contact, and within 0.03 with 10; "
            f"{_instead('contact.timing', ContactTiming.AT_STEPS.word)}"
        )
    if law.slip != Slip.TOTAL:
        found.append(
            f"contact.slip is '{law.slip.word}': LAMMPS caps spring and dashpot together; "
            f"{_instead('contact.slip', Slip.TOTAL.word)}"
        )
    if law.cap != Cap.TOTAL:
        found.append(
            f"contact.cap is '{law.cap.word}': LAMMPS caps by the whole normal force; "
            f"{_instead('contact.cap', Cap.TOTAL.word)}"
        )
    if law.cohesion != 0.0:
        found.append(
            f"contact.cohesion: LAMMPS has none in the Coulomb cap; {_instead('contact.cohesion', '0 N')}"
        )
    if law.adhesion != Adhesion.NONE:
        found.append(
            f"contact.adhesion is '{law.adhesion.word}': the laws of LAMMPS are others; "
            f"{_instead('contact.adhesion', Adhesion.NONE.word)}"
        )
    for one, whose in _laws(scene):
        found += _pair(one, whose)
    return found


def _laws(scene: Scene) -> Iterator[tuple[ContactLaw, str]]:
    """Contact laws of materials that can meet, and words that name the two; the one law without materials."""
    made = scene.materials
    if made is None:
        yield scene.contact, ""
    elif len(made.contact) == made.n**2:  # else it is refused for all engines
        free, every = np.unique(made.of[: scene.n_grain]).tolist(), np.unique(made.of).tolist()
        for k in sorted({min(a, b) * made.n + max(a, b) for a in free for b in every}):
            yield made.contact[k], f" of {made.pair_name(k)}"


def _pair(law: ContactLaw, whose: str) -> list[str]:
    """What LAMMPS cannot carry of the contacts of two materials."""
    found: list[str] = []
    if law.tension and law.mu > 0.0:
        pulls, ends = Parting.TENSION, Parting.NO_TENSION
        if law.force == ContactForce.HERTZ_MINDLIN:
            pulls, ends = DampingLaw.TSUJI, DampingLaw.THORNTON
        found.append(
            f"{pulls.key} is '{pulls.word}'{whose}: where the dashpot pulls, LAMMPS lets friction act by the "
            f"size of the pull; {_instead(pulls.key, ends.word)}"
        )
    if not law.k_s > 0.0:
        found.append(f"no tangential spring{whose}: a contact.shear_stiffness above 0 would be carried")
    if law.damping == Damping.RESTITUTION and law.zeta_n > _STEEPEST:
        found.append(f"contact.restitution {law.e_n:g}{whose}: from 0.14 on it would be carried")
    lossless = law.eta_n == 0.0 if law.damping == Damping.CONSTANTS else law.zeta_n == 0.0
    dashed = law.eta_s != 0.0 if law.damping == Damping.CONSTANTS else law.zeta_s != 0.0
    if lossless and dashed:
        found.append(
            f"a tangential dashpot without a normal one{whose}: LAMMPS takes their ratio; "
            "contact.restitution_shear 1, or a restitution below 1, would be carried"
        )
    return found


def _rolling(scene: Scene) -> list[str]:
    rolling, found = scene.rolling, list[str]()
    if rolling.twisting > 0.0:
        found.append(f"rolling.twisting_coefficient: {_instead('rolling.twisting_coefficient', '0')}")
    if rolling.model == Rolling.NONE:
        return found
    if rolling.model != Rolling.EPSD:
        found.append(
            f"rolling.model is '{rolling.model.word}': {_instead('rolling.model', Rolling.EPSD.word)} with "
            "damping_ratio 0"
        )
        return found
    if rolling.arm != Arm.REDUCED_RADIUS:
        found.append(f"rolling.arm: {_instead('rolling.arm', Arm.REDUCED_RADIUS.word)}")
    if rolling.zeta_r != 0.0:
        found.append(
            "rolling.damping_ratio: the slider of LAMMPS limits rolling spring and dashpot together, ours "
            f"the spring alone; {_instead('rolling.damping_ratio', '0')}, the same law in both"
        )
    return found


def _films(scene: Scene) -> list[str]:
    water, found = scene.water, list[str]()
    if water.rebound != Rebound.DRY:
        found.append(f"water.rebound: {_instead('water.rebound', Rebound.DRY.word)}")
    if water.film_reach > 0.0:
        found.append(f"water.film: {_instead('water.film', Film.NONE.word)}")
    if water.drag_of_form != DragOfForm.SPHERE:
        found.append(f"water.drag_of_form: {_instead('water.drag_of_form', DragOfForm.SPHERE.word)}")
    return found


def _kinds(scene: Scene) -> list[str]:
    found: list[str] = []
    if scene.n_grain == 0:
        found.append("a scene without free grains")
    if scene.bodies is not None:
        found.append("clumps: spheres would be carried")
    if scene.has_servo:
        found.append("[walls.servo]: no wall is pressed; planes and fixed grains at rest would be carried")
    elif scene.walls is not None:
        found.append("[[walls]]: planes and fixed grains would be carried")
    if scene.traffic is not None:
        found.append("[[feeds]] and [[exits]]: a fixed number of grains would be carried")
    if scene.materials is not None:
        free = len(np.unique(scene.materials.of[: scene.n_grain]))
        if free > MOST_TYPES:
            found.append(f"free grains of {free} materials: {MOST_TYPES} would be carried")
    if scene.n_grain:
        found += _shares(scene)
    return found


def _shares(scene: Scene) -> list[str]:
    """A type has one share of added mass, and the weight of grains without water is that of all."""
    m, found = scene.m + scene.m_added, list[str]()
    made_of = np.zeros(len(m)) if scene.materials is None else scene.materials.of[: scene.n_grain]
    added, weight = scene.m_added / m, scene.m_weight / m
    if any(_differ(added[made_of == number]) for number in np.unique(made_of)):
        found.append(
            "grains with different added mass per mass: one density for each material would be carried"
        )
    if not completes_forces(scene) and _differ(weight):
        found.append("grains with different buoyancy per mass: one density would be carried")
    return found


def _differ(shares: Floats) -> bool:
    return bool(np.ptp(shares) > _ALIKE * abs(float(shares[0])))


def _records(scene: Scene) -> list[str]:
    found: list[str] = []
    if scene.events != EventRule.NONE:
        found.append(
            f"record.events: LAMMPS keeps no records of contacts; {_instead('record.events', 'none')}"
        )
    if scene.forces:
        found.append(f"record.forces: contact forces are not recorded; {_instead('record.forces', 'false')}")
    return found


def refusals_of_change(before: Scene, after: Scene) -> tuple[str, ...]:
    """Reasons why LAMMPS cannot go on with a scene that the timeline changed; () when it can."""
    found: list[str] = []
    if before.rotation != after.rotation:
        found.append("a timeline that locks or frees rotation")
    if before.contact != after.contact:
        found.append("a timeline that changes the friction")
    return tuple(found)
