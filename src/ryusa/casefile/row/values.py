"""What a row of columns will be: its segments and cells, its dams, and estimates of its flow."""

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np

from ryusa.casefile.builders.schema import BedOfRunSection
from ryusa.casefile.builders.table import table_of
from ryusa.casefile.case import Case
from ryusa.casefile.column.packed import packed
from ryusa.casefile.files import contents, inside
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.motion import slope
from ryusa.casefile.row.backwater import backwater, bore_depth, level_of_basin
from ryusa.casefile.row.ends import keys_of_row, levels_of, peak_discharge, width_of
from ryusa.casefile.row.reach_source import reach_of
from ryusa.casefile.row.schema import RowDamSection
from ryusa.formats.line import read_line
from ryusa.laws import turbulence, water
from ryusa.model.arrays import Floats

CELL = 0.5  # thickness of a cell when the case gives none, in mean diameters
SPARE = 1.5  # height of the cells over the largest depth to be expected, when the case gives none
COURANT = 0.5  # largest Courant number of a step
WEIR = (2.0 / 3.0) ** 1.5  # q/(sqrt(g) H**1.5) of critical flow without loss
THINNEST = 1.01  # cells; the normal depth of a thinner film does not follow from the column
MOST_CELLS = 4_000_000

Points = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class RowPlan:
    """Segments and cells of a row."""

    x_low: float  # [m]
    dx: float  # length of a segment [m]
    n: int  # segments
    cell: float  # thickness of a cell [m]
    n_cell: int  # cells of a column
    x: Floats  # middles of the segments [m], shape (n,)
    bottom: Floats  # height of the bottom there [m], shape (n,)
    start: Floats  # height of the surface at the start [m], shape (n,)


@dataclass(frozen=True)
class Reach:
    """A straight piece of the bottom, and the uniform flow of the discharge on it."""

    begin: float  # [m]
    end: float
    slope: float  # total, of frame and bottom, positive down towards +x [rad]
    normal: float  # normal depth [m]; nan where nothing drives the water, or without a discharge
    froude: float  # of normal flow [-]


def line_points(folder: Path, key: str, given: Points | str) -> Points:
    """Points of a line as given, or as its file holds them.

    Raises
    ------
    CaseError : its file cannot be read.
    """
    if not isinstance(given, str):
        return given
    return contents(folder, key, given, inside(folder, key, given), _read)


@lru_cache(maxsize=4)
def _read(path: Path, name: str, _changed: int, _size: int) -> Points:
    return read_line(path, name)


def not_downstream(points: Points, strictly: bool = False) -> str:
    """Say which point of a line lies upstream of the one before, or with `strictly` at the same place."""
    for k, ((a, _), (b, _)) in enumerate(pairwise(points)):
        if b < a or (strictly and b == a):
            return f"point {k + 2} lies at x = {b:g} m, not downstream of the one before at {a:g} m"
    return ""


def line_files(case: Case) -> list[str]:
    """Names of the CSV files of the lines of a row, of the bed along it, and of what changes over time."""
    keys = case.row
    if keys is None:
        return []
    bed = case.build.bed if case.build.kind == "stream" else None
    hydrograph = None if keys.upstream is None else keys.upstream.hydrograph
    stage = None if keys.downstream is None else keys.downstream.stage
    return [one for one in (keys.bottom, keys.surface, bed, hydrograph, stage) if isinstance(one, str)]


def bottom_points(case: Case) -> Points:
    """Points of the bottom [m]."""
    return line_points(case.folder, "water.row.bottom", keys_of_row(case).bottom)


def segments_of(case: Case) -> tuple[float, float, int]:
    """Where the row begins [m], the length of a segment [m], and how many there are."""
    keys, points = keys_of_row(case), bottom_points(case)
    length = points[-1][0] - points[0][0]
    count = keys.segments or max(round(length / (keys.segment or length)), 1)
    return points[0][0], length / count, count


def cell_of(case: Case) -> float:
    """Thickness of a cell [m]."""
    return case.column.cell or CELL * reference_diameter(case)


def stream(case: Case) -> bool:
    """Whether grains enter and leave a row with ends."""
    return case.row is not None and case.build.kind == "stream"


def walls_of_stream(case: Case) -> tuple[str, ...]:
    """Names of the walls that builder 'stream' makes for grains and water: the bottom, and the dams."""
    return ("bottom", *(dam.name for dam in keys_of_row(case).dams)) if stream(case) else ()


def stream_span(case: Case) -> tuple[float, float]:
    """Where the bed of builder 'stream' begins and ends along x [m]."""
    build, points = case.build, bottom_points(case)
    assert build.kind == "stream"
    if not isinstance(build.bed, float | int):
        points = _bed_line(case, build.bed)
    return (
        points[0][0] if build.begin is None else build.begin,
        points[-1][0] if build.end is None else build.end,
    )


def bed_points(case: Case) -> Points:
    """Points of x and thickness [m] of the bed of builder 'stream', from where it begins to where it ends."""
    build, (begin, end) = case.build, stream_span(case)
    assert build.kind == "stream"
    if isinstance(build.bed, float | int):
        return (begin, build.bed), (end, build.bed)
    line = _bed_line(case, build.bed)
    x, thick = np.array(line).T
    first, last = np.interp([begin, end], x, thick).tolist()
    return (begin, first), *(one for one in line if begin < one[0] < end), (end, last)


def _bed_line(case: Case, given: Points | str | BedOfRunSection) -> Points:
    """Points of x and thickness [m] as given; of a run, those of its grains packed in each segment."""
    if not isinstance(given, BedOfRunSection):
        return line_points(case.folder, "build.bed", given)
    table, (x_low, dx, n) = table_of(case), segments_of(case)
    assert table is not None
    x, d = table.column("x"), table.column("d")
    at = np.clip(((x - x_low) / dx).astype(np.int64), 0, n - 1)
    per_area = 1.0 / (dx * (width_of(case) or math.inf) * packed(case))
    thick = np.bincount(at, math.pi / 6.0 * d**3 * per_area, n)
    first, last = (int(at.min()), int(at.max())) if len(at) else (0, 0)
    middles = tuple((x_low + (i + 0.5) * dx, float(thick[i])) for i in range(first, last + 1))
    return (
        (x_low + first * dx, float(thick[first])), *middles, (x_low + (last + 1) * dx, float(thick[last])),
    )  # fmt: skip


def bed_over(case: Case, x: Floats) -> Floats:
    """Thickness of the bed of builder 'stream' at x [m], shape as x; 0 with another builder."""
    return _thickness(bed_points(case), x) if case.build.kind == "stream" else np.zeros_like(x)


def _thickness(points: Points, x: Floats) -> Floats:
    return np.interp(x, *np.array(points).T, left=0.0, right=0.0)


def water_alone(case: Case) -> bool:
    """Whether a case is a row without a moving grain, whose step resolves waves instead of contacts."""
    return case.row is not None and case.build.kind == "empty" and not case.feeds


@lru_cache(maxsize=8)
def _plan(
    points: Points, surface: Points | None, depth: float, about: tuple[float, float, int], cell: float,
    height: float, bed: Points,
) -> RowPlan:  # fmt: skip
    x_low, dx, n = about
    x: Floats = x_low + (np.arange(n, dtype=np.float64) + 0.5) * dx
    bottom = np.interp(x, *np.array(points).T)
    over = depth + _thickness(bed, x)
    start = bottom + over if surface is None else np.interp(x, *np.array(surface).T)
    n_cell = max(math.ceil(height / cell - 1e-9), 2)
    return RowPlan(x_low, dx, n, cell, n_cell, x, bottom, start)


def row_plan(case: Case) -> RowPlan:
    """Segments, cells, bottom and first surface of the row of a case."""
    keys, wet = keys_of_row(case), case.water
    assert wet is not None
    surface = None if keys.surface is None else line_points(case.folder, "water.row.surface", keys.surface)
    about, cell = segments_of(case), cell_of(case)
    bed = bed_points(case) if case.build.kind == "stream" else ((0.0, 0.0),)
    first = _plan(bottom_points(case), surface, wet.depth or 0.0, about, cell, cell, bed)
    height = keys.height or SPARE * max(highest_water(case, first), 4.0 * cell)
    return _plan(bottom_points(case), surface, wet.depth or 0.0, about, cell, height, bed)


def reaches(case: Case, q: float) -> list[Reach]:
    """The straight pieces of the bottom, with normal depth and Froude number of a discharge [m2/s]."""
    tilt, g = slope(case.motion), case.motion.gravity
    found: list[Reach] = []
    for (a, low), (b, high) in pairwise(bottom_points(case)):
        angle = tilt - math.atan2(high - low, b - a)
        normal = normal_depth(case, q, angle)
        froude = q / math.sqrt(g * math.cos(angle) * normal**3) if normal > 0.0 else math.nan
        found.append(Reach(a, b, angle, normal, froude))
    return found


def critical_depth(case: Case, q: float) -> float:
    """Critical depth of a discharge [m2/s] [m]; nan without one."""
    return (q * q / (case.motion.gravity * math.cos(slope(case.motion)))) ** (1.0 / 3.0)


def normal_depth(case: Case, q: float, angle: float) -> float:
    """Depth of uniform flow of a discharge [m2/s] on a slope [rad], mean of Eq. (9) [m]; nan without."""
    wet, keys = case.water, case.column
    along = case.motion.gravity * math.sin(angle)
    if wet is None or not q > 0.0 or not along > 0.0:
        return math.nan
    rough = wet.roughness or reference_diameter(case)

    def passes(depth: float) -> float:
        shear = math.sqrt(along * depth)
        if keys.bed == "smooth":
            return depth * water.log_law_smooth(depth / math.e, shear, wet.viscosity)
        return depth * turbulence.speed_mean_rough(depth, shear, rough)

    low, high = 0.0, 1.0e3
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if passes(middle) < q else (low, middle)
    return 0.5 * (low + high)


def enters_fast(case: Case, q: float) -> bool:
    """Whether a discharge [m2/s] enters upstream at its normal depth: supercritical, and a cell deep."""
    first = reaches(case, q)[0]
    return first.froude > 1.0 and first.normal > THINNEST * cell_of(case)


def inlet_tilt(case: Case) -> float:
    """Angle of the bottom at the upper end to the x axis, positive where it rises [rad]."""
    (x, z), (x_next, z_next) = bottom_points(case)[:2]
    return math.atan2(z_next - z, x_next - x)


def inlet_depth(case: Case) -> float | None:
    """Depth of the water that enters, along z over a bed there [m]; None where it is that of the row."""
    reach, end = reach_of(case), keys_of_row(case).upstream
    if reach is None:
        return None if end is None else end.depth
    return reach.depth / math.cos(inlet_tilt(case)) if reach_froude(case) > 1.0 else None


def reach_froude(case: Case) -> float:
    """Froude number of the mean flow of the feeder reach over its bed [-]; nan without one."""
    reach = reach_of(case)
    if reach is None:
        return math.nan
    return reach.discharge / math.sqrt(case.motion.gravity * math.cos(reach.slope) * reach.depth**3)


def deepest(case: Case, plan: RowPlan) -> float:
    """Largest depth to be expected [m]: at the start, of flow on the bed, behind dams, below levels."""
    keys, q = keys_of_row(case), peak_discharge(case)
    critical, bed = critical_depth(case, q), bed_over(case, plan.x)
    found = [float((plan.start - plan.bottom).max()), critical + float(bed.max())]
    for one in reaches(case, q):
        on_it = (plan.x >= one.begin) & (plan.x <= one.end)
        found.append(one.normal + float(bed[on_it].max(initial=0.0)))
    over = 1.5 * critical if critical > 0.0 else 0.0
    tilt = math.tan(slope(case.motion))
    for dam in keys.dams:
        if dam.concentration is None:
            crest = crest_of(plan, dam)
            before = plan.x < dam.end
            found.append(
                float((crest + over - tilt * (dam.begin - plan.x) - plan.bottom)[before].max(initial=0.0))
            )
    for end, at in ((keys.upstream, plan.x[0]), (keys.downstream, plan.x[-1])):
        for level in [] if end is None else levels_of(case, end):
            found.append(float((level - tilt * (at - plan.x) - plan.bottom).max()))
    if (entering := inlet_depth(case)) is not None:
        found.append(entering + max(float(bed[0]), dam_at_inlet(case, plan)))
    return max((one for one in found if one > 0.0), default=0.0)


def highest_water(case: Case, plan: RowPlan) -> float:
    """Depth that the water may reach in a run [m]: `deepest`, backwater, bores, and closed basins."""
    keys, wet, q = keys_of_row(case), case.water, peak_discharge(case)
    found = deepest(case, plan)
    if wet is None or keys.upstream is None or keys.downstream is None:
        return found
    bed, tilt, end = bed_over(case, plan.x), math.tan(slope(case.motion)), keys.downstream
    rigid = plan.bottom + bed
    for dam in keys.dams:
        first, last = dam_span(plan, dam)
        if dam.concentration is None:
            rigid[first:last] = np.maximum(rigid[first:last], crest_of(plan, dam))
    up = rigid - tilt * plan.x  # over a level line
    volume = float(np.maximum(plan.start - rigid, 0.0).sum()) * plan.dx
    if q > 0.0:
        below = max(levels_of(case, end), default=-math.inf) - tilt * float(plan.x[-1])
        rough = 0.0 if case.column.bed == "smooth" else wet.roughness or reference_diameter(case)
        held = backwater(
            up, plan.dx, q, below, critical_depth(case, q), case.motion.gravity, rough, wet.viscosity
        )
        found = max(found, float((rigid + held - plan.bottom).max()))
        fast = jumping(case, q)
        found = max([found, *(bore_depth(one.normal, one.froude) + float(bed.max()) for one in fast)])
        volume += q * (case.stop.time or 0.0)
    if end.end == "wall" and (keys.upstream.end == "wall" or q > 0.0):
        level = level_of_basin(up, plan.dx, volume)
        found = max(found, float((level + tilt * plan.x - plan.bottom).max()))
    return found


def jumping(case: Case, q: float) -> list[Reach]:
    """Reaches where a discharge [m2/s] is supercritical and has subcritical water somewhere below it."""
    keys, found = keys_of_row(case), reaches(case, q)
    held = keys.downstream is not None and keys.downstream.end in ("wall", "level")
    return [
        one
        for k, one in enumerate(found)
        if one.froude > 1.0
        and (
            held
            or any(not other.froude > 1.0 for other in found[k + 1 :])
            or any(dam.end > one.begin for dam in keys.dams)
        )
    ]


def crest_of(plan: RowPlan, dam: RowDamSection) -> float:
    """Height of the crest of a dam over the x axis [m]."""
    if dam.crest is not None:
        return dam.crest
    middle = 0.5 * (dam.begin + dam.end)
    return float(np.interp(middle, plan.x, plan.bottom)) + (dam.height or 0.0)


def dam_span(plan: RowPlan, dam: RowDamSection) -> tuple[int, int]:
    """First segment of a dam, and the one after its last."""
    inside_it = np.flatnonzero((plan.x >= dam.begin) & (plan.x <= dam.end))
    return (int(inside_it[0]), int(inside_it[-1]) + 1) if len(inside_it) else (0, 0)


def dam_at_inlet(case: Case, plan: RowPlan) -> float:
    """Height over the bottom of the dam in the first segment, over which water enters [m]; 0 without one."""
    dams = [one for one in keys_of_row(case).dams if one.concentration is None]
    over = (crest_of(plan, one) - plan.bottom[0] for one in dams if one.begin <= plan.x[0] <= one.end)
    return max((float(one) for one in over), default=0.0)


def fastest(case: Case, plan: RowPlan) -> float:
    """Speed of water and long waves that the case lets expect [m/s], for the time step."""
    q, g = peak_discharge(case), case.motion.gravity
    flows = [one.normal for one in reaches(case, q) if one.normal > 0.0]
    flows += [critical_depth(case, q)] if q > 0.0 else []
    wave = math.sqrt(g * deepest(case, plan))
    # 2 sqrt(g h): the front of a dam break over a dry bed (Ritter 1892)
    return max([2.0 * wave, *(q / one + math.sqrt(g * one) for one in flows)])


def water_step(case: Case) -> float:
    """Time step of a row without grains [s]: an even part of record.frames within the Courant number."""
    plan = row_plan(case)
    longest = COURANT * plan.dx / fastest(case, plan) if fastest(case, plan) > 0.0 else math.inf
    frames = case.record.frames
    return frames / max(math.ceil(frames / longest - 1e-9), 1)
