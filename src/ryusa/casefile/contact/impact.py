"""Rows of `ryusa check` about impacts: how fast grains will collide, and how far they will overlap."""

import math
from typing import TYPE_CHECKING

from ryusa.casefile.builders.schema import BoxSection, DropSection, FillSection, FlumeSection, PackingSection
from ryusa.casefile.builders.values import fill_cells
from ryusa.casefile.contact.schema import OverlapStiffnessSection
from ryusa.casefile.rows import ExplainRow, Flag, number
from ryusa.casefile.water.values import terminal_velocity, water_speed
from ryusa.laws import collision

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.derive import Derived

STABLE = (1.0e-3, 1.0e-2)  # overlap over d at which motion is stable and free: the paper, fig11
SKIMMING = 0.3  # u t/d beyond which grains pass each other before the collision time of Eq. (8) is over


def expected_speed(case: "Case", derived: "Derived") -> tuple[float, str]:
    """Impact speed for judging the overlap [m/s], and where it comes from."""
    rule, build = case.contact.stiffness, case.build
    if isinstance(rule, OverlapStiffnessSection):
        return rule.speed, "contact.stiffness.speed"
    settling, buoyant = terminal_velocity(case), derived.m_weight / (derived.m + derived.m_added)
    if isinstance(build, DropSection):
        fall = math.sqrt(build.speed**2 + 2.0 * derived.g * (build.height or 0.0) * buoyant)
        if math.isfinite(settling) and settling < fall:
            return max(settling, build.speed), "settling velocity, which is below the speed of a free fall"
        return fall, "free fall from build.height with build.speed, without drag"
    if isinstance(build, BoxSection):
        height = build.height + build.layers * build.gap * derived.d_max
        if height > derived.d:
            fastest = math.sqrt(2.0 * derived.g * height * buoyant)
            return min(fastest, settling), "fall of the top layer through the free height below it"
    if isinstance(build, PackingSection | FlumeSection | BoxSection | FillSection):
        return math.sqrt(2.0 * derived.g * derived.d), "fall through one diameter, sqrt(2 g d)"
    if math.isfinite(settling):
        return settling, "settling velocity; most impacts of a saltating grain are slower"
    return math.sqrt(2.0 * derived.g * derived.d), "fall through one diameter, sqrt(2 g d)"


def impact_rows(case: "Case", derived: "Derived") -> list[ExplainRow]:
    """Overlap and travel to expect within one contact."""
    speed, origin = expected_speed(case, derived)
    rows = [number("impact", "expected impact speed", speed, "m/s", origin), _overlap(derived, speed)]
    if isinstance(case.build, PackingSection | FlumeSection | BoxSection | FillSection):
        layers = fill_cells(case)[2] if isinstance(case.build, FillSection) else case.build.layers
        weight = layers * derived.m_weight * derived.g * math.cos(derived.slope)
        rest = weight / (derived.k_n * derived.d)
        deep: Flag = "warning" if rest > STABLE[1] else ""
        origin = f"weight of {layers:g} layers over k_n d"
        rows.append(number("impact", "overlap/d at rest", rest, "-", origin, deep))
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


def _overlap(derived: "Derived", speed: float) -> ExplainRow:
    overlap = collision.overlap_max(speed, derived.fixed.m, derived.k_n, derived.fixed.zeta_n) / derived.d
    low, high = STABLE
    verdict, flag = f"in the stable range {low:g} to {high:g}", ""
    if overlap > high:
        verdict, flag = f"above the stable range {low:g} to {high:g}; take a larger k_n", "warning"
    elif overlap < low:
        verdict, flag = (
            f"below the range {low:g} to {high:g}; a smaller k_n would allow a longer step",
            "note",
        )
    return number("impact", "largest overlap/d", overlap, "-", f"on a fixed grain: {verdict}", flag)


def _speed_along(case: "Case", derived: "Derived") -> tuple[float, str]:
    """Speed at which grains pass the bed [m/s], and where it comes from."""
    if isinstance(case.build, DropSection):
        return abs(case.build.speed_along), "build.speed_along"
    if case.water is not None and case.water.profile != "still":
        above = abs(water_speed(case, derived, 1.25 * derived.d))
        return above, "water one diameter above the crest"
    return math.sqrt(derived.g * derived.d), "sqrt(g d)"
