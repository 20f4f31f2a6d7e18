"""Rows of `ryusa check` about impacts: how fast grains will collide, and how far they will overlap."""

import math
from collections.abc import Iterator
from typing import Any

from ryusa.casefile.builders.schema import BoxSection, DropSection, FillSection, FlumeSection, PackingSection
from ryusa.casefile.builders.values import fill_cells
from ryusa.casefile.case import Case
from ryusa.casefile.contact.fastest_impacts import overlaps_expected
from ryusa.casefile.contact.speed import expected_speed
from ryusa.casefile.contact.values import adhesion, is_hertz, largest_overlap, overlap_under
from ryusa.casefile.facts import Derived
from ryusa.casefile.rows import ExplainRow, Flag, number
from ryusa.casefile.water.values import water_speed
from ryusa.errors import CaseError
from ryusa.laws.families import Adhesion

STABLE = (1.0e-3, 1.0e-2)  # overlap over d at which motion is stable and free: the paper, fig11
SKIMMING = 0.3  # u t/d beyond which grains pass each other before the collision time of Eq. (8) is over


def impact_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Overlap and travel to expect within one contact."""
    speed, origin = expected_speed(case)
    rest, at_rest = _at_rest(case, derived)
    rows = [number("impact", "expected impact speed", speed, "m/s", origin), _overlap(case, derived, rest)]
    if at_rest:
        deep: Flag = "warning" if rest > STABLE[1] else ""
        rows.append(number("impact", "overlap/d at rest", rest, "-", at_rest, deep))
    along, where = _speed_along(case, derived)
    if along > 0.0:
        travel = along * derived.fixed.t_col / derived.d
        skims = travel > SKIMMING
        origin = f"distance over d travelled within one contact at {along:.3g} m/s ({where})"
        if skims:
            origin += f"; above {SKIMMING:g} grains pass each other before the contact time is over"
        rows.append(
            number("impact", "travel per contact u t/d", travel, "-", origin, "warning" if skims else "")
        )
    return rows


def check_overlap(case: Case, derived: Derived, data: dict[str, Any]) -> Iterator[CaseError]:
    """Find contacts so soft that grains pass through one another, but for single drops, which study that."""
    if isinstance(case.build, DropSection):
        return
    impact = largest_overlap(case, expected_speed(case)[0]) / derived.d
    overlap = max(impact, _at_rest(case, derived)[0])
    if overlap > 1.0:
        key = "youngs_modulus" if is_hertz(case.contact) else "stiffness"
        yield CaseError(
            f"contact.{key}", data["contact"].get(key), f"is so small that grains would overlap by "
            f"{overlap:.3g} diameters and pass through one another; motion is stable up to {STABLE[1]:g}",
        )  # fmt: skip


def _at_rest(case: Case, derived: Derived) -> tuple[float, str]:
    """Overlap over d of the lowest layer at rest [-], and where it comes from; 0 where there is none."""
    build = case.build
    if not isinstance(build, PackingSection | FlumeSection | BoxSection | FillSection):
        return 0.0, ""
    layers = fill_cells(case, build)[2] if isinstance(build, FillSection) else build.layers
    weight = layers * derived.m_weight * derived.g * math.cos(derived.slope)
    origin = f"weight of {layers:g} layers {'by Hertz' if is_hertz(case.contact) else 'over k_n d'}"
    origin += "" if adhesion(case.contact) is Adhesion.NONE else ", with adhesion"
    return overlap_under(case, weight) / derived.d, origin


def _overlap(case: Case, derived: Derived, rest: float) -> ExplainRow:
    least, most, origin = overlaps_expected(case, derived)
    if rest > most:
        least, most, origin = rest, rest, "more at rest than in impacts"
    stiff, (low, high) = "Young's modulus" if is_hertz(case.contact) else "k_n", STABLE
    verdict, flag = f"in the stable range {low:g} to {high:g}", ""
    if least > high:
        verdict, flag = f"above the stable range {low:g} to {high:g}; take a larger {stiff}", "warning"
    elif most > high:
        verdict, flag = f"may rise above the stable range {low:g} to {high:g}; see overlap/d of a run", "note"
    elif most < low:
        verdict = f"below the range {low:g} to {high:g}; a smaller {stiff} would allow a longer step"
        flag = "note"
    shown = f"{most:.3g}" if least == most else f"{least:.2g} to {most:.2g}"
    return ExplainRow("impact", "largest overlap/d", most, "", shown, f"{origin}: {verdict}", flag)


def _speed_along(case: Case, derived: Derived) -> tuple[float, str]:
    """Speed at which grains pass the bed [m/s], and where it comes from."""
    if isinstance(case.build, DropSection):
        return abs(case.build.speed_along), "build.speed_along"
    if case.water is not None and case.water.profile != "still":
        above = abs(water_speed(case, derived, 1.25 * derived.d))
        return above, "water one diameter above the crest"
    return math.sqrt(derived.g * derived.d), "sqrt(g d)"
