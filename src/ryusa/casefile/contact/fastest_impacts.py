"""How far grains will overlap at most: the fastest impacts of a run, by kind of case, and the heaviest pair.

A kind has a speed that follows from the case, and the range of what the deepest overlaps of runs had over an
impact at that speed (design/lab/0016-largest-overlaps.md, with the runs and how to make them again).
"""

import math
from dataclasses import dataclass

from ryusa.casefile.builders.schema import BoxSection, DropSection, FillSection, FlumeSection, PackingSection
from ryusa.casefile.builders.values import fill_cells, room
from ryusa.casefile.case import Case
from ryusa.casefile.contact.speed import expected_speed
from ryusa.casefile.contact.values import adhesion, is_hertz, law_of, pair_values, stiffness
from ryusa.casefile.facts import Derived
from ryusa.casefile.feeds.schema import FeedSection
from ryusa.casefile.feeds.values import corners_of
from ryusa.casefile.motion import slope_at_last
from ryusa.casefile.row.ends import peak_discharge
from ryusa.casefile.row.values import critical_depth, deepest, reaches, row_plan, stream
from ryusa.casefile.walls.mesh import box_of
from ryusa.casefile.walls.schema import WallSection
from ryusa.casefile.water.values import terminal_velocity, water_speed
from ryusa.laws import collision, water
from ryusa.laws.families import Adhesion
from ryusa.model.contact_law import largest_overlap_of

POURED = 0.6  # concentration to which loose spheres settle
FEW, WIDER = 3, 1.5  # a kind seen in fewer cases than these has its range wider by this factor each way


@dataclass(frozen=True)
class Kind:
    """A kind of case, and its deepest overlaps over those of an impact at its speed.

    Attributes
    ----------
    words : the speed.
    least, most : of the speeds that give the overlaps found, over that speed [-].
    cases : packaged cases in which they were found.
    """

    words: str
    least: float
    most: float
    cases: int

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest factor to be expected [-]."""
        wider = WIDER if self.cases < FEW else 1.0
        return self.least / wider, self.most * wider


# Rounded outward to two digits:
FLOW = Kind("of the water where grains travel", 0.19, 0.82, 18)
SURGE = Kind("of the front of a dam break, 2 sqrt(g h)", 0.12, 0.13, 1)
FALL = Kind("of the fall through the free height", 0.38, 0.77, 9)
LAYERS = Kind("of the fall of the top layer", 0.56, 1.21, 6)
SLIDE = Kind("of a fall through one diameter, in a bed that slides", 1.30, 2.62, 3)
SETTLING = Kind("of settling", 0.84, 0.85, 1)
MOVED = Kind("of the fastest wall", 0.85, 0.86, 1)


def fastest_impacts(case: Case, derived: Derived) -> tuple[float, Kind]:
    """Speed that governs the fastest impacts among grains [m/s], and the kind of case."""
    bed = isinstance(case.build, PackingSection | FlumeSection)
    if case.water is None and bed and slope_at_last(case.motion, case.timeline) > 0.0:
        return math.sqrt(2.0 * derived.g * derived.d), SLIDE
    fall, walls = _fall_speed(case, derived), _wall_speed(case.walls)
    flow, kind = _flow_speed(case, derived)
    settling = terminal_velocity(case)
    falling = LAYERS if bed or isinstance(case.build, BoxSection) else FALL
    still = (settling, SETTLING) if settling < fall else (fall, falling)
    return max(((flow, kind), still, (walls, MOVED)), key=lambda one: one[0])


def overlaps_expected(case: Case, derived: Derived) -> tuple[float, float, str]:
    """Range of the largest overlap over d in a run [-], and in words where it comes from."""
    if isinstance(case.build, DropSection):
        speed, origin = expected_speed(case)
        alone = heaviest_overlap(case, derived, speed)
        return alone, alone, f"impact at {speed:.3g} m/s, {origin}"
    speed, kind = fastest_impacts(case, derived)
    least, most = kind.range
    low, high = (heaviest_overlap(case, derived, factor * speed) for factor in (least, most))
    pair = "a grain hits another" if derived.d_max == derived.d_min else "the largest grain hits the smallest"
    seen = f"{kind.cases} case{'s' if kind.cases > 1 else ''}"
    seen += f", {WIDER:g} times wider each way" if kind.cases < FEW else ""
    times = f"{least:.2g} to {most:.2g} times {speed:.3g} m/s"
    return low, high, f"{pair} at {times}, {kind.words}, as in runs of {seen}"


def heaviest_overlap(case: Case, derived: Derived, speed: float) -> float:
    """Overlap over d of the heaviest grain that hits the smallest one, which others hold in place [-]."""
    one, heavier = pair_values(case, derived.d, False), (derived.d_max / derived.d) ** 3
    if is_hertz(case.contact) or adhesion(case.contact) is not Adhesion.NONE:
        r = 0.5 * derived.d_max * derived.d_min / (derived.d_max + derived.d_min)
        overlap = largest_overlap_of(law_of(case), heavier * one.m, r, speed)
    else:
        overlap = collision.overlap_max(speed, heavier * one.m, stiffness(case)[0], one.zeta_n)
    return overlap / derived.d_min


def _flow_speed(case: Case, derived: Derived) -> tuple[float, Kind]:
    """Speed of the water one diameter above the bed, or where feeds let grains in [m/s]; 0 in still water."""
    wet = case.water
    if wet is None or wet.profile == "still":
        return 0.0, FLOW
    z = max([1.25 * derived.d, *(height for height, _ in _feeds(case.feeds))])
    if case.row is None or not stream(case):
        return abs(water_speed(case, derived, z)), FLOW
    q = peak_discharge(case)
    if not q > 0.0:
        return 2.0 * math.sqrt(derived.g * deepest(case, row_plan(case))), SURGE
    steep = [
        water.log_law_rough(
            min(z, one.normal), math.sqrt(derived.g * one.normal * math.sin(one.slope)), derived.k_rough
        )
        for one in reaches(case, q)
        if one.normal > 0.0
    ]
    return max([*steep, 0.0 if steep else q / critical_depth(case, q)]), FLOW


def _fall_speed(case: Case, derived: Derived) -> float:
    """Speed of a fall through the free height: that of a loose fill, of a drum, below a feed [m/s]."""
    build, heights = case.build, [derived.d]
    if isinstance(build, FillSection):
        pitch = room(case) * (1.0 + build.gap)
        loose = math.pi / 6.0 * derived.d**3 / pitch**3
        heights.append(pitch * fill_cells(case, build)[2] * (1.0 - loose / POURED))
    elif isinstance(build, BoxSection | PackingSection | FlumeSection):
        below = build.height if isinstance(build, BoxSection) else 0.0
        heights.append(below + build.layers * build.gap * room(case))
    boxes = [box_of(case.folder, wall, f"walls.{k}") for k, wall in enumerate(case.walls)]
    for wall, (low, high) in zip(case.walls, boxes, strict=True):
        if wall.angular_velocity is not None and any(wall.angular_velocity[:2]):
            heights.append(float(high[2] - low[2]))
    lowest = min((float(low[2]) for low, _ in boxes), default=0.0)
    lighter = 2.0 * derived.g * derived.m_weight / (derived.m + derived.m_added)
    fed = [speed**2 + lighter * (height - lowest) for height, speed in _feeds(case.feeds)]
    return math.sqrt(max([lighter * max(heights), *fed, 0.0]))


def _feeds(feeds: tuple[FeedSection, ...]) -> list[tuple[float, float]]:
    """Greatest height [m] and speed [m/s] of the grains of each feed."""
    corners = [(corners_of(one), math.hypot(*one.velocity)) for one in feeds]
    return [(float(found[1][2]), speed) for found, speed in corners if found is not None]


def _wall_speed(walls: tuple[WallSection, ...]) -> float:
    """Speed of the fastest wall or belt [m/s], without what a wall turns."""
    moved = [one for wall in walls for one in (wall.velocity, wall.surface_velocity) if one is not None]
    return max((math.hypot(*one) for one in moved), default=0.0)
