"""Grains in a row with ends, fed and leaving, from a case file: books, bits, dams, and what is refused."""

import math
import sys
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.build import build
from ryusa.campaigns.sweep.measures import refuse_measure
from ryusa.casefile import explain, read_text, resolved
from ryusa.casefile.builders.values import stream_cells
from ryusa.casefile.row.values import critical_depth, dam_span, deepest, highest_water, reaches, row_plan
from ryusa.catalogue import MEASURES
from ryusa.errors import CaseError, GrainLost
from ryusa.measure.along_row import grains_along_row
from ryusa.measure.deposit import deposit
from ryusa.measure.front import front
from ryusa.measure.loads import loads
from ryusa.measure.long_section import long_section
from ryusa.measure.walls import walls
from ryusa.model.feeds import IN, OUT
from ryusa.report.contents import contents_of
from ryusa.results import Results, schema
from ryusa.units import quantity
from ryusa.water._kernel import parameters_of
from ryusa.water.closures import bed_thickness
from ryusa.water.row_coupling import RowCoupling

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

STREAM = """
[grains]
diameter = "6 mm"
density = "2650 kg/m3"
spread = 0.1
[contact]
stiffness = "200 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
slope = "1/20"
[water]
profile = "column"
depth = "2 cm"
hindrance = "Di Felice"
[water.column]
bed = "rough"
cell = "3 mm"
[water.row]
bottom = [["0 m", "1 cm"], ["0.2 m", "0 cm"], ["0.4 m", "0 cm"]]
segments = 16
width = "2.4 cm"
upstream = { end = "discharge", discharge = "0.02 m2/s" }
downstream = { end = "free fall" }
[[water.row.dams]]
name = "dam"
begin = "0.25 m"
end = "0.3 m"
height = "1.5 cm"
[build]
kind = "stream"
bed = "6 mm"
walls = false
[[feeds]]
name = "feeder"
low = ["2 cm", "0 cm", "4 cm"]
high = ["8 cm", "2.4 cm", "7 cm"]
rate = "300 grains/s"
velocity = ["1 m/s", "0 m/s", "0 m/s"]
[[exits]]
name = "outlet"
point = ["0.4 m", "0 m", "0 m"]
normal = [1, 0, 0]
[stop]
time = "0.12 s"
[record]
frames = "10 ms"
events = "none"
"""


def test_the_height_of_the_cells_counts_normal_and_critical_depth_from_the_bed() -> None:
    none = {"water.row.dams": "[]"}
    line = "[['0 m', '0 cm'], ['0.1 m', '3 cm'], ['0.4 m', '3 cm']]"
    plain, thick = read_text(STREAM, none), read_text(STREAM, none | {"build.bed": line})
    low, high = (deepest(one, row_plan(one)) for one in (plain, thick))
    flow = max(critical_depth(thick, 0.02), *(one.normal for one in reaches(thick, 0.02)))
    assert (low, high) == (pytest.approx(flow + 0.006), pytest.approx(flow + 0.03))
    assert row_plan(thick).n_cell == math.ceil(
        1.5 * max(high, highest_water(thick, row_plan(thick))) / 0.003 - 1e-9
    )


def feeder(x: str, z: str, y: str = "0 mm") -> dict[str, str]:
    """A feed as a box of 2 x 2.4 x 2 cm3 with a given lower corner."""
    (a, b, c), name = (quantity(one, "m") for one in (x, y, z)), "feeder"
    high = [f"'{one + more} m'" for one, more in ((a, 0.02), (b, 0.024), (c, 0.02))]
    box = f"low = ['{x}', '{y}', '{z}'], high = [{', '.join(high)}]"
    return {"feeds": f"[{{ name = '{name}', {box}, rate = '100 grains/s' }}]"}


def run(folder: Path, more: dict[str, str] | None = None, **how: Any) -> Results:
    return ryusa.run(read_text(STREAM, more or {}), folder, progress=False, **how)


@pytest.fixture(scope="module")
def stream(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return run(tmp_path_factory.mktemp("stream") / "run")


@pytest.mark.full
def test_the_dam_is_pushed_by_water_and_grains_of_the_same_frames(stream: Results) -> None:
    found, of = loads(stream), walls(stream)
    w = of.names.index("dam")
    assert found.grains[:, 0, 0] == pytest.approx(of.force[:, w, 0])
    assert found.grains[:, 0, 1] == pytest.approx(of.force[:, w, 2])
    assert (found.water[:, 0, 0] != 0.0).all()


@pytest.mark.full
def test_grains_enter_and_leave_and_the_water_is_kept(stream: Results) -> None:
    found, water = stream.row, stream.summary["water"]
    assert found is not None
    ways = stream.passages["way"]
    assert (ways == IN).sum() > 20 and (ways == OUT).sum() > 3
    assert water["momentum_residual"] < 1e-9
    held = found.volume.sum(axis=1) * found.row.dx
    assert np.abs(held - held[0] - found.passed[:, 0] + found.passed[:, -1]).max() < 1e-14
    assert found.passed[-1, 0] == pytest.approx(0.02 * 0.12, rel=1e-2)  # a step of the water is still to come
    assert stream.summary["energy"]["residual"] < 1e-2


@pytest.mark.full
def test_all_grains_that_are_there_are_in_the_segments(stream: Results) -> None:
    found, scene = stream.row, stream.scene
    assert found is not None
    row = found.row
    solid = found.phi.sum(axis=(1, 2)) * row.column.dz * row.column.area / row.n_segment
    volume = np.isfinite(stream.frames.x[:, :, 2]) @ (math.pi / 6.0 * scene.d**3)
    np.testing.assert_allclose(solid[2:], volume[2:], rtol=1e-2)  # a little lies above or below all cells
    assert found.phi.max() < 0.75
    assert found.phi[:, 10:12, :5].max() == 0.0  # of the dam


@pytest.mark.full
def test_a_run_that_was_stopped_and_two_threads_give_the_same_bits(
    stream: Results, tmp_path: Path, stop_at: Any
) -> None:
    for step in (1, 901, 3000):
        stop_at(step)
        assert run(tmp_path / "run", resume=True).status == schema.STOPPED
    run(tmp_path / "run", resume=True, threads=2)
    assert differences(stream.folder, tmp_path / "run") == []


@pytest.mark.full
def test_water_enters_over_the_bed_in_the_first_segment_and_resumes_with_the_same_bits(
    tmp_path: Path, stop_at: Any
) -> None:
    bed = {"build.bed": "'1.8 cm'", "build.end": "'0.24 m'"}
    more = bed | {"water.row.height": "'12 cm'", "stop.time": "'0.06 s'", "feeds": "[]"}
    found = run(tmp_path / "whole", more)
    stop_at(2500)
    assert run(tmp_path / "run", more, resume=True).status == schema.STOPPED
    run(tmp_path / "run", more, resume=True)
    assert differences(found.folder, tmp_path / "run") == []
    row = found.row
    assert row is not None
    p = parameters_of(row.row.column)
    thick = [bed_thickness(p, np.ascontiguousarray(phi[0])) for phi in row.phi]
    assert min(thick) > 0.012
    for u, bed in zip(row.u[1:], thick[1:], strict=True):
        lowest = int(np.flatnonzero(u[0])[0])
        assert lowest == pytest.approx(bed / p.dz, abs=1.0)
    np.testing.assert_allclose(row.discharge[1:, 0], 0.02, rtol=1e-9)


def test_a_bed_at_rest_that_is_looser_than_packed_warns() -> None:
    """As laid it has 0.3; what has not settled, flows or is a single layer gives no warning."""

    def water(**more: str) -> RowCoupling:
        case = build(read_text(STREAM, {"feeds": "[]", "build.bed": "'1.8 cm'", **more}))
        assert case.scene.row is not None
        return RowCoupling.begin(case.scene, case.scene.row, case.state.x)

    found = water(**{"water.column.packed": "0.4"})
    assert 8 < len(found.densest_beds()) <= 14
    assert "does not reach the packed concentration 0.4: its largest, averaged" in found.warnings()[0]
    found.state = replace(found.state, u=np.full_like(found.state.u, 0.5))
    assert found.warnings() == []
    assert water(**{"water.column.packed": "0.2"}).warnings() == []
    assert water().warnings() == []
    assert len(water(**{"build.bed": "'3 mm'"}).densest_beds()) == 0


@pytest.mark.full
def test_bottom_and_dam_are_walls_for_the_grains_by_their_names(stream: Results) -> None:
    scene = stream.scene
    assert scene.walls is not None
    assert scene.walls.names == ("bottom", "dam")
    found = walls(stream, begin=0.05)
    assert found.names == ("bottom", "dam")
    assert found.force[:, 0, 2].mean() < 0.0  # grains lie on the bottom
    x = stream.frames.x[-1]
    inside = (x[:, 0] > 0.253) & (x[:, 0] < 0.297) & (x[:, 2] < 0.015)
    assert not inside.any()


@pytest.mark.full
def test_the_report_has_the_measures_that_the_run_allows_and_one_number_of_grains(stream: Results) -> None:
    found = contents_of(stream, size=5.0e6, progress=lambda share: None)
    tables = {one.name: one for one in found.measures}
    assert {"walls", "discharge", "passages", "long_section", "deposit"} <= tables.keys()
    assert {"walls", "discharge", "passages"} <= {one.name for one in found.drawings}
    assert found.missing == []
    assert "± s.e." in tables["discharge"].heads
    segments = tables["long_section"]
    assert len(segments.rows) == stream.row.row.n_segment
    assert "±" in segments.rows[3][2] and "means with standard errors" in segments.notes[0]
    scene, rows = stream.scene, stream.passages
    assert scene.traffic is not None
    first, came = scene.traffic.n_first, len(np.unique(rows["grain"][rows["way"] == IN]))
    case = dict(found.rows)["case"]
    assert case.startswith(
        f"{scene.n_grain} free ({first} at the start, {scene.n_grain - first} for the feeds, which "
        f"brought {came})"
    )
    shown = next(one.shown for one in found.values if one.name == "free grains")
    assert shown.replace(",", "") == str(scene.n_grain)


def test_check_explains_flow_dams_and_bed() -> None:
    case = read_text(STREAM)
    shown = {line.name: line.value for line in explain(case)}
    assert shown["critical depth"] == pytest.approx(
        (0.02**2 / (9.80665 * math.cos(math.atan(0.05)))) ** (1 / 3)
    )
    assert shown["Froude number, x = 0 to 0.2 m"] > 1.0
    assert shown["bed at the start"] == pytest.approx(0.006)
    assert shown["water.column.mixing_length"] == "Li-Sawamoto"
    volume = shown["free grains"] - shown["feed 'feeder': grains"]
    volume *= math.pi / 6.0 * 0.006**3
    assert volume == pytest.approx(0.61 * 0.006 * 0.024 * 0.35, rel=0.1)
    assert resolved(case)["water"]["row"]["height"] > 0.05
    assert resolved(case)["water"]["column"]["mixing_length"] == "Li-Sawamoto"


QUIET = {
    "build.bed": "'1.2 cm'", "build.begin": "'3 cm'", "build.end": "'0.25 m'", "feeds": "[]", "exits": "[]",
    "water.row.upstream": "{ end = 'wall' }", "water.row.downstream": "{ end = 'wall' }",
    "water.row.bottom": "[['0 m', '1 cm'], ['0.2 m', '0 cm'], ['0.4 m', '-1 cm']]",
    "water.row.surface": "[['0 m', '4 cm'], ['0.4 m', '6 cm']]", "stop.time": "'1 s'",
    "rolling.model": "'spring-dashpot-slider'", "rolling.arm": "'reduced radius'",
    "rolling.coefficient": "0.1",
}  # fmt: skip


@pytest.mark.full
def test_walls_carry_the_weight_under_water_of_grains_at_rest_behind_a_dam(tmp_path: Path) -> None:
    """Bottom and dam together: m g less that of the water displaced, along and normal to the axis."""
    found = ryusa.run(
        read_text(STREAM.replace('depth = "2 cm"\n', ""), QUIET), tmp_path / "run", progress=False
    )
    scene = found.scene
    assert np.abs(found.frames.v[-1]).max() < 1e-2
    weight = float(scene.m_weight.sum()) * scene.gravity
    total = walls(found, begin=0.8).force.sum(axis=1).mean(axis=0)
    assert total == pytest.approx(weight, abs=0.01 * abs(weight[2]))
    assert total[0] > 0.03 * abs(total[2])
    assert walls(found, begin=0.8).force[:, 1, 0].mean() > 0.0  # the dam holds some of it
    assert found.row is not None
    assert np.abs(found.row.u[-1]).max() < 2e-2  # waves that the settling grains have made
    assert found.row.volume[-1].sum() == pytest.approx(found.row.volume[0].sum(), rel=1e-14)


SLIDER = {
    "grains.density": "'7800 kg/m3'", "grains.spread": "0", "contact.friction_angle": "'11.31 deg'",
    "water.drag": "'24/Re+0.4'", "motion.rotation": "'locked'", "motion.slope": "0",
    "water.hindrance": "'none'", "water.depth": "'3.5 cm'",
    "water.row.bottom": "[['0 m', '10 cm'], ['1 m', '0 cm']]", "water.row.segments": "30",
    "water.row.width": "'20 cm'", "water.row.upstream": "{ end = 'discharge', discharge = '0.04 m2/s' }",
    "water.row.downstream": "{ end = 'same depth' }", "water.row.dams": "[]", "build.bed": "'0 cm'",
    "feeds": "[{ name = 'one', low = ['5 cm', '5 cm', '9.6 cm'], high = ['8 cm', '15 cm', '10.3 cm'], "
    "rate = '2 grains/s', begin = '0.8 s', end = '1.3 s', velocity = ['0.65 m/s', '0 m/s', '-0.06 m/s'] }]",
    "exits": "[{ name = 'outlet', point = ['1 m', '0 m', '0 m'], normal = [1, 0, 0] }]",
    "stop.time": "'1.6 s'", "record.frames": "'20 ms'",
}  # fmt: skip


@pytest.mark.full
def test_a_heavy_grain_slides_down_an_inclined_reach_as_drag_weight_and_friction_say(tmp_path: Path) -> None:
    """Drag of the slip r takes (mu cos - sin) of the weight under water; the grain is slower by r."""
    found = run(tmp_path / "run", SLIDER)
    assert found.row is not None
    row, d, alpha, x = found.row.row, 0.006, math.atan(0.1), found.frames.x[:, 0, 0]
    there = np.flatnonzero((x > 0.5) & (x < 0.6))
    assert len(there) > 3
    weight = 6800.0 * math.pi / 6.0 * d**3 * 9.80665
    holds = (math.tan(math.radians(11.31)) * math.cos(alpha) - math.sin(alpha)) * weight
    low, high = 0.0, 5.0
    for _ in range(60):
        r = 0.5 * (low + high)
        drag = 0.5 * 1000.0 * math.pi / 4.0 * d**2 * (24.0 / (r * d / 1e-6) + 0.4) * r * r
        low, high = (low, r) if drag > holds else (r, high)
    edges = np.clip(row.column.faces, 0.0, d)
    slices = np.diff(edges**2 / 2.0 * d - edges**3 / 3.0)
    slices /= slices.sum()
    for k in there:
        j = int(np.abs(row.x_station - x[k]).argmin())
        u = float(slices @ found.row.u[k, j]) / math.cos(alpha)
        v = float(found.frames.v[k, 0, 0]) / math.cos(alpha)
        assert u > 0.6
        assert v == pytest.approx(u - r, abs=0.01 * u)
        assert np.hypot(*found.frames.v[k, 0, [0, 2]]) == pytest.approx(v, rel=0.02)


@pytest.mark.parametrize(
    ("more", "key", "says"),
    [
        ({"exits": "[]"}, "exits", "lower end of the row"),
        ({"exits": "[{ name = 'outlet', point = ['0.5 m', '0 m', '0 m'], normal = [1, 0, 0] }]"}, "exits",
         "none takes grains at x = 0.4 m"),
        ({"motion.plane": "true"}, "motion.plane", "three dimensions"),
        ({"water.row.width": "3 mm"}, "water.row.width", "at least"),
        ({"water.column.bed": "'moving'"}, "water.column.bed", "'rough' or 'smooth'"),
        ({"water.column.mixing_length": "'parabolic'"}, "water.column.mixing_length", "Li-Sawamoto"),
        ({"water.column.start": "'steady'"}, "water.column.start", "'rest'"),
        ({"water.buoyancy": "'weight'"}, "water.buoyancy", "'stress'"),
        ({"build.end": "'0.5 m'"}, "build.end", "must lie in the row"),
        ({"build.bed": "'0 cm'", "feeds": "[]"}, "build.bed", "no grain"),
        ({"exits": "[{ name = 'dam', point = ['0.4 m', '0 m', '0 m'], normal = [1, 0, 0] }]"},
         "water.row.dams.0.name", "used twice"),
        ({"timeline": "[{ at = '0.1 s', remove = 'dam' }]"}, "timeline.0.remove", "cannot be removed"),
        (feeder(x="26 cm", z="1.4 cm"), "feeds.0", "in the dam 'dam', which stands from x = 0.25 to 0.3 m"),
        (feeder(x="10 cm", z="0.4 cm"), "feeds.0", "reaches below the bottom, which is as high as z = 0.005"),
        (feeder(x="-1 cm", z="4 cm"), "feeds.0", "must lie in the row"),
        (feeder(x="10 cm", z="4 cm", y="1 mm") | {"build.walls": "true"}, "feeds.0", "between the side"),
        ({"water.column.packed": "0.95"}, "water.column.packed", "densest packing"),
        ({"water.column.mixing_length": "'none'", "water.column.fluctuations": "'random walk'"},
         "water.column.fluctuations", "has no effect"),
        ({"water.column.side_friction": "'Blasius'"}, "water.column.side_friction", "needs"),
        ({"timeline": "[{ at = '0.1 s', move = { wall = 'dam', velocity = ['1 mm/s', '0 m/s', '0 m/s'] } }]"},
         "timeline.0.move.wall", "cannot move: it is one for grains and water"),
    ],
)  # fmt: skip
def test_what_a_stream_cannot_be_is_refused_with_its_key(more: dict[str, str], key: str, says: str) -> None:
    with pytest.raises(CaseError) as caught:
        build(read_text(STREAM, more))
    faults = (caught.value, *caught.value.others)
    assert any(one.key == key and says in one.line for one in faults), [one.line for one in faults]


@pytest.mark.full
@pytest.mark.parametrize(
    ("name", "walls_of_it"),
    [
        ("sabo_dam", ("bottom", "dam")),
        ("dam_break", ("bottom",)),
        ("delta", ("bottom",)),
        ("river", ("bottom", "weir")),
        ("slope_break", ("bottom",)),
        ("debris_flume", ("bottom",)),
    ],
)
def test_a_packaged_stream_runs(name: str, walls_of_it: tuple[str, ...], tmp_path: Path) -> None:
    text = files("ryusa.cases").joinpath(f"{name}.toml").read_text(encoding="utf-8")
    short = {"stop.time": "'20 ms'", "record.frames": "'10 ms'", "record.settle": "'0 s'", "timeline": "[]"}
    if name == "debris_flume":  # the strip of it
        short |= {"water.row.width": "'12.8 cm'", "build.walls": "false"}
    found = ryusa.run(read_text(text, short), tmp_path / "run", progress=False)
    assert found.complete
    assert found.scene.walls is not None
    assert found.scene.walls.names == walls_of_it
    assert found.summary["water"]["momentum_residual"] < 1e-9


def test_a_stream_without_a_row_is_refused() -> None:
    head, rest = STREAM.split("[water.row]")
    text = head + rest[rest.index("[build]") :]
    with pytest.raises(CaseError, match=r"build.kind = 'stream': needs \[water.row\]"):
        read_text(text)


@pytest.mark.full
def test_a_report_has_the_pictures_of_a_stream_and_none_of_a_heap(stream: Results) -> None:
    found = contents_of(stream, size=5.0e6, progress=lambda share: None)
    drawn = {one.name for one in found.drawings}
    assert {"long_section", "x_t", "deposit", "front"} <= drawn
    assert not drawn & {"surface", "cone"}
    assert not {what for what, _ in found.missing} & {"picture surface", "picture cone"}


def test_a_sweep_may_measure_the_walls_of_a_stream() -> None:
    case, entries = read_text(STREAM), {one.name: one for one in MEASURES}
    for name in ("walls", "deposit", "front", "discharge"):
        refuse_measure(entries[name], case)
    with pytest.raises(CaseError, match=r"record\.forces"):
        refuse_measure(entries["contact_stress"], case)


@pytest.mark.full
def test_a_grain_that_leaves_the_row_beside_its_exit_stops_the_run(tmp_path: Path) -> None:
    """It flies over the box of the exit, which reaches as high as the water can."""
    more = {
        "exits": "[{ name = 'outlet', low = ['0.4 m', '-1 m', '-1 m'], high = ['0.5 m', '1 m', '12 cm'] }]",
        "feeds": "[{ name = 'jet', low = ['2 cm', '0 cm', '30 cm'], high = ['8 cm', '2.4 cm', '33 cm'], "
        "rate = '100 grains/s', velocity = ['4 m/s', '0 m/s', '0 m/s'] }]",
        "build.bed": "'0 cm'",
    }
    with pytest.raises(GrainLost, match=r"beyond the row of columns from 0 to 0\.4 m") as caught:
        run(tmp_path / "run", more)
    fault, flight = caught.value, 0.4 - 0.08  # m at most, at 4 m/s
    assert fault.t is not None and fault.step is not None
    assert fault.t == pytest.approx(fault.step * Results.open(tmp_path / "run").scene.dt)
    assert 0.0 < fault.t < 0.02 + flight / 4.0


@pytest.mark.full
def test_a_clump_leaves_a_stream_with_its_centre(tmp_path: Path) -> None:
    """One of its spheres is beyond the row before its centre is at the exit."""
    more = {
        "grains.shape": "'dumbbell'", "build.bed": "'0 cm'", "stop.time": "'0.2 s'", "water.row.dams": "[]",
        "feeds": "[{ name = 'jet', low = ['5 cm', '0 cm', '8 cm'], high = ['10 cm', '2.4 cm', '11 cm'], "
        "rate = '100 grains/s', velocity = ['3 m/s', '0 m/s', '0 m/s'] }]",
    }  # fmt: skip
    found = run(tmp_path / "run", more)
    assert found.scene.bodies is not None
    out = found.passages[found.passages["way"] == OUT]
    assert len(out) > 5
    assert np.abs(out["x"][:, 0] - 0.4).max() < 1e-6


@pytest.mark.parametrize("begin", [0.24, 0.26, 0.3, 0.31, 0.36])
@pytest.mark.parametrize("n", [40, 50, 60, 80, 100, 160])
def test_the_lattice_of_a_bed_ends_at_a_dam_and_loses_no_column_to_rounding(begin: float, n: int) -> None:
    """A dam between columns of the lattice, whose places are rounded."""
    row = {"water.row.bottom": "[['0 m', '0 m'], ['0.5 m', '0 m']]", "water.row.segments": "50"}
    row |= {"exits": "[{ name = 'outlet', point = ['0.5 m', '0 m', '0 m'], normal = [1, 0, 0] }]"}
    dam = f"[{{ name = 'dam', begin = '{begin} m', end = '{begin + 0.02} m', height = '1.5 cm' }}]"
    size = {"grains.diameter": f"'{0.5 / n / 1.14} m'", "water.column.cell": "'3 mm'", "feeds": "[]"}
    case = read_text(
        STREAM, row | size | {"water.row.dams": dam, "grains.spread": "0", "water.row.width": "'6 cm'"}
    )
    low, (pitch, _), columns, _ = stream_cells(case)
    first, last = (k * 0.5 / 50 for k in dam_span(row_plan(case), case.water.row.dams[0]))
    count = round(0.5 / pitch)
    beside = [k for k in range(count) if k + 1 <= first / pitch + 1e-6 or k >= last / pitch - 1e-6]
    assert low == 0.0
    assert columns.tolist() == beside


@pytest.mark.full
def test_measures_along_the_row_count_every_grain_that_came_and_left(stream: Results) -> None:
    row, frames = stream.row.row, np.arange(len(stream.frames))
    held = grains_along_row(stream, row, frames)
    gained = (held.volume - held.volume[0]) * row.dx
    rest = gained - (held.passed[:, :-1] - held.passed[:, 1:] + held.fed)
    assert np.abs(rest).max() < 1e-12 * gained.max()
    later = stream.passages[stream.passages["step"] > 0]  # one comes before the first frame
    m, way = later["m"] / 2650.0, later["way"]
    assert held.passed[-1, -1] * held.width == pytest.approx(m[way == OUT].sum(), rel=1e-9)  # the outlet
    found = deposit(stream, dam="dam")
    assert np.abs(found.unaccounted).max() < 1e-12 * found.held.max()
    assert np.abs(found.brought - found.passed - found.stored).max() < 1e-12 * found.held.max()
    assert found.brought[-1] * held.width == pytest.approx(m[way == IN].sum(), rel=1e-9)
    assert 0.05 < found["trapped_share"].value <= 1.0
    assert front(stream).first[-1] > 0.1
    section = long_section(stream, begin=0.05)
    assert (section.solid_discharge[3:6] > 0.0).all() and section.bed[5] > section.bottom[5]


FLOOD = {"timeline": "[{ at = '31 ms', discharge = '0.04 m2/s' }, { at = '73 ms', discharge = '0.01 m2/s' }]"}


@pytest.fixture(scope="module")
def flood(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return run(tmp_path_factory.mktemp("flood") / "run", FLOOD)


@pytest.mark.full
def test_each_discharge_acts_among_grains_in_its_own_time(flood: Results) -> None:
    """The water is behind by the unfinished interval alone, and is never ahead."""
    found, dt = flood.row, flood.scene.dt
    assert found is not None
    asked = np.interp(found.t, [0.0, 0.031, 0.073, 0.12], np.cumsum([0.0, 0.00062, 0.00168, 0.00047]))
    behind = asked - found.passed[:, 0]
    q = np.interp(found.t, [0.0, 0.031, 0.0311, 0.073, 0.0731, 0.12], [0.02, 0.02, 0.04, 0.04, 0.01, 0.01])
    assert (behind > -0.04 * dt).all()  # a change falls on the nearest step
    assert (behind <= q * (found.row.column.interval + 1) * dt).all()


@pytest.mark.full
def test_a_run_stopped_within_a_flood_among_grains_gives_the_same_bits(
    flood: Results, tmp_path: Path, stop_at: Any
) -> None:
    change = round(0.031 / flood.scene.dt)
    for step in (change - 7, change, change + 5, 4000):
        stop_at(step)
        assert run(tmp_path / "run", FLOOD, resume=True).status == schema.STOPPED
    run(tmp_path / "run", FLOOD, resume=True, threads=2)
    assert differences(flood.folder, tmp_path / "run") == []
