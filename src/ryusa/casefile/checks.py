"""Checks of a whole case that no single key shows: what is missing, what contradicts what."""

import math
from collections.abc import Iterator
from typing import Any

from ryusa.casefile.builders.checks import check_builder, check_domain, check_fill
from ryusa.casefile.case import Case
from ryusa.casefile.choices import check_choices
from ryusa.casefile.column.checks import check_column
from ryusa.casefile.contact.checks import check_contact, check_expected_speed, check_rolling
from ryusa.casefile.contact.impact import check_overlap
from ryusa.casefile.contact.schema import RIVALS as CONTACT_RIVALS
from ryusa.casefile.derive import derive
from ryusa.casefile.facts import Derived
from ryusa.casefile.feeds.checks import check_traffic
from ryusa.casefile.films import check_film_step, check_films
from ryusa.casefile.grading import check_grading
from ryusa.casefile.grains.schema import RIVALS as GRAINS_RIVALS
from ryusa.casefile.materials.checks import check_materials
from ryusa.casefile.materials.sizes import check_sizes
from ryusa.casefile.motion import RIVALS as MOTION_RIVALS
from ryusa.casefile.motion import check_motion
from ryusa.casefile.record.checks import (
    check_frames,
    check_precision,
    check_record,
    check_stop,
    check_timeline,
)
from ryusa.casefile.record.schema import RIVALS as TIME_RIVALS
from ryusa.casefile.record.time import check_time
from ryusa.casefile.row.checks import check_row
from ryusa.casefile.row.hydrograph import check_hydrograph
from ryusa.casefile.row.reach_checks import check_reach, check_unlike_reach
from ryusa.casefile.row.values import water_alone
from ryusa.casefile.section import Section, given
from ryusa.casefile.shape import check_shape
from ryusa.casefile.walls.checks import check_meshes, check_planes, check_walls
from ryusa.casefile.water.checks import check_drag_step, check_water
from ryusa.casefile.water.schema import RIVALS as WATER_RIVALS
from ryusa.casefile.without_effect import check_without_effect
from ryusa.errors import CaseError

RIVALS: dict[str, tuple[tuple[str, str], ...]] = {  # two keys for one thing, by section
    "grains": GRAINS_RIVALS,
    "contact": CONTACT_RIVALS,
    "motion": MOTION_RIVALS,
    "water": WATER_RIVALS,
    "time": TIME_RIVALS,
}
MOST_GRAINS = 20_000_000


def check(case: Case, data: dict[str, Any]) -> list[CaseError]:
    """Find the faults that no single key shows; `data` is what the file held.

    Checks that need derived numbers come last: these exist only for a case without contradictions.
    """
    if case.build.kind == "stream" and case.row is None:
        text = "needs [water.row], whose bottom is the floor of its grains; without it take another builder"
        return [*_rivals(case), CaseError("build.kind", "stream", text)]
    unsized = [*check_grading(case), *check_sizes(case), *check_shape(case), *check_reach(case)]
    unsized = unsized or [*check_fill(case)]
    if unsized:  # most checks need the sizes
        return [*_rivals(case), *unsized]
    found = [
        *_rivals(case),
        *check_choices(case),
        *check_contact(case),
        *check_stop(case.stop, case.build),
        *check_water(case),
        *check_column(case),
        *check_row(case),
        *check_hydrograph(case),
        *check_films(case),
        *check_rolling(case),
        *check_motion(case.motion, case.timeline),
        *check_planes(case),
        *check_walls(case),
        *check_builder(case),
        *check_traffic(case),
        *check_timeline(case.timeline, case.stop, data),
        *check_materials(case),
        *check_precision(case),
    ]
    found = found or [*check_without_effect(case)]
    found = found or [*check_expected_speed(case), *check_unlike_reach(case)]
    if found:
        return found
    derived = derive(case)
    found = [*_numbers(derived)]
    if found:
        return found
    step: list[CaseError] = []
    if not water_alone(case):  # no contact and no drag to resolve
        step = [
            *check_time(case, derived, data),
            *check_film_step(case, derived),
            *check_drag_step(case, derived),
        ]
    frames = [] if step else [*check_frames(case, derived, data)]
    if not step and not frames and not water_alone(case):
        frames += check_overlap(case, derived, data)
    return [
        *check_domain(case, derived),
        *check_meshes(case, derived),
        *step,
        *frames,
        *check_record(case, derived),
    ]


def _rivals(case: Case) -> Iterator[CaseError]:
    """Find two keys that give the same thing."""
    for name, pairs in RIVALS.items():
        section: Section | None = getattr(case, name)
        for one, other in pairs:
            if section is not None and given(section, one) and given(section, other):
                yield CaseError(f"{name}.{one}", None, f"excludes {name}.{other}; give only one of the two")


def _numbers(derived: Derived) -> Iterator[CaseError]:
    """Find derived numbers beyond what can be computed with."""
    count = derived.n_grain + derived.n_fixed
    if count > MOST_GRAINS:
        yield CaseError("build", None, f"asks for {count:,} grains; at most {MOST_GRAINS:,}")
    for name in ("m", "inertia", "k_n", "shortest", "dt"):
        value = getattr(derived, name)
        if not (0.0 < value < math.inf):
            yield CaseError("case", None, f"a derived number is out of range: {_NAMES[name]} = {value:g}")


_NAMES = {
    "m": "mass m of a grain",
    "inertia": "moment of inertia of a grain",
    "k_n": "normal stiffness k_n",
    "shortest": "duration of the shortest contact",
    "dt": "time step dt",
}
