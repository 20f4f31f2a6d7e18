"""A river that a reach feeds: what is taken from it, when and where its grains enter, and the same bits."""

import json
import math
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.build import build
from ryusa.casefile import explain, read_text
from ryusa.casefile.read import read
from ryusa.casefile.row.reach import FeederReach, digest_of
from ryusa.casefile.row.reach_record import bed_lines, supplied
from ryusa.casefile.row.reach_source import reach_of, repeated
from ryusa.errors import CaseError
from ryusa.measure import discharge, passages, transport
from ryusa.model.feeds import IN
from ryusa.results import Results, schema
from ryusa.water._kernel import parameters_of
from ryusa.water.closures import bed_thickness

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

SAME = """
[grains]
diameter = "6 mm"
density = "2650 kg/m3"
spread = 0.1
[contact]
stiffness = "100 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
slope = "1/8"
[water]
profile = "column"
depth = "2 cm"
hindrance = "Di Felice"
"""
EVEN = (
    SAME
    + """
[water.column]
bed = "moving"
cell = "3 mm"
packed = 0.55
start = "steady"
[water.row]
bottom = [["0 m", "0 m"], ["6 cm", "0 m"]]
segments = 3
[build]
kind = "flume"
length = "6 cm"
width = "2.4 cm"
walls = false
layers = 2
bed = "random"
[stop]
time = "0.5 s"
[record]
frames = "10 ms"
events = "none"
settle = "0.1 s"
"""
)
RIVER = (
    SAME
    + """
[water.column]
bed = "rough"
cell = "3 mm"
packed = 0.55
[water.row]
bottom = [["0 m", "0 cm"], ["0.2 m", "0 cm"]]
segments = 10
width = "2.4 cm"
upstream = { end = "feeder reach", run = "runs/even" }
downstream = { end = "same depth" }
[build]
kind = "stream"
bed = "1.2 cm"
end = "0.15 m"
walls = false
[[exits]]
name = "outlet"
point = ["0.2 m", "0 m", "0 m"]
normal = [1, 0, 0]
[stop]
time = "0.3 s"
[record]
frames = "20 ms"
events = "none"
"""
)


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a finished reach."""
    folder = tmp_path_factory.mktemp("feeder")
    ryusa.run(read_text(EVEN), folder / "runs" / "even", progress=False)
    return folder


def river(place: Path, more: dict[str, str] | None = None) -> Any:
    return read_text(RIVER, more or {}, path=place / "river.toml")


@pytest.fixture(scope="module")
def fed(place: Path) -> Results:
    return ryusa.run(river(place), place / "runs" / "river", progress=False)


def test_a_pressure_of_its_own_is_refused_beside_a_feeder_reach(place: Path) -> None:
    with pytest.raises(CaseError, match="knows nothing of grains that enter by end = 'feeder reach'"):
        river(place, {"water.row.pressure": "full"})


def test_a_reach_supplies_the_discharge_and_the_grains_of_its_record(place: Path) -> None:
    run = Results.open(place / "runs" / "even")
    found, water = supplied(run), run.row
    assert water is not None
    assert (found.begin, found.end) == (pytest.approx(0.1, abs=2e-3), pytest.approx(0.5, abs=2e-3))
    first = int(np.searchsorted(run.frames.t, 0.1 - 1e-3))
    passed = (water.passed[-1] - water.passed[first]).mean() / (run.frames.t[-1] - run.frames.t[first])
    assert found.discharge == pytest.approx(passed, rel=1e-14)
    q = transport(run).averages["q"]
    assert found.solid_discharge == pytest.approx(q.value, rel=1e-12)
    assert 0.3 < found.error / q.error < 3.0
    volume = np.pi / 6.0 * found.d**3
    moving = 0.3 * run.scene.solid_volume.sum()  # at most so much comes or goes within the period by chance
    assert abs(volume.sum() - q.value * found.width * found.duration) < moving
    assert len(found.t) > 10
    assert ((found.y >= 0.0) & (found.y < 0.024)).all()
    assert set(found.d) <= set(run.scene.d)


def test_a_bed_line_is_that_over_which_water_enters(place: Path) -> None:
    run = Results.open(place / "runs" / "even")
    assert run.row is not None
    column = run.row.row.column
    phi = np.concatenate([run.row.phi[::5].reshape(-1, column.n), np.zeros((1, column.n))])
    phi = np.concatenate([phi, np.full((1, column.n), 0.5)])
    by_kernel = [bed_thickness(parameters_of(column), np.ascontiguousarray(one)) for one in phi]
    np.testing.assert_allclose(bed_lines(phi, column), by_kernel, rtol=1e-12)
    assert supplied(run).bed == pytest.approx(np.mean([one for one in bed_lines(
        run.row.phi[10:].reshape(-1, column.n), column)]), rel=1e-12)  # fmt: skip


def test_its_file_is_exact(place: Path) -> None:
    found = reach_of(river(place))
    assert found is not None
    again = FeederReach.from_bytes(found.to_bytes())
    assert again.to_bytes() == found.to_bytes()
    assert np.array_equal(again.v, found.v) and again.discharge == found.discharge
    with pytest.raises(ValueError):
        FeederReach.from_bytes(found.to_bytes().replace(b'"t": [', b'"t": [0.0, '))


def entered_by(run: Results, reach: FeederReach) -> int:
    """Grains of the record that were due at the last instant at which grains enter."""
    assert run.scene.traffic is not None
    interval = run.scene.traffic.interval * run.scene.dt
    last = interval * math.floor(float(run.frames.t[-1]) / interval * (1.0 + 1.0e-12))
    assert last > 0.25
    return int((reach.t <= last).sum())


@pytest.mark.full
def test_each_grain_enters_once_when_it_is_due_where_it_crossed(place: Path, fed: Results) -> None:
    reach = reach_of(river(place))
    assert reach is not None and fed.scene.traffic is not None
    due = repeated(river(place), reach)
    rows = fed.passages[fed.passages["way"] == IN]
    feed, arrivals = fed.scene.traffic.feeds[-1], fed.scene.traffic.arrivals
    assert arrivals is not None
    waiting = fed.summary["traffic"]["feeds"][-1]["due"]
    assert feed.name == "reach"
    assert len(due.t) == int((reach.t < 0.3).sum()) == feed.count
    assert entered_by(fed, reach) == len(rows) + waiting
    k = rows["grain"] - feed.first
    assert len(set(k)) == len(k)
    np.testing.assert_array_equal(rows["due"], reach.t[k])
    np.testing.assert_array_equal(rows["d"], reach.d[k])
    np.testing.assert_array_equal(rows["v"], reach.v[k])
    np.testing.assert_array_equal(rows["omega"], reach.omega[k])
    np.testing.assert_array_equal(rows["x"][:, 1], reach.y[k])
    interval = fed.scene.traffic.interval * fed.scene.dt
    soon = rows["t"] - rows["due"] < interval
    assert soon.mean() > 0.8 and (rows["t"] >= rows["due"]).all()
    gone = rows["x"][:, 0] - 0.5 * rows["d"]
    assert (gone >= 0.0).all() and (gone <= np.maximum(reach.v[k, 0], 0.0) * interval + 1e-9).all()
    assert discharge(fed).rows() and passages(fed).gates[0].name == "reach"


@pytest.mark.full
def test_the_discharge_of_the_reach_enters_with_its_profile_and_its_depth(place: Path, fed: Results) -> None:
    reach, end, water = reach_of(river(place)), fed.scene.row, fed.row
    assert reach is not None and end is not None and end.upstream is not None and water is not None
    np.testing.assert_allclose(water.discharge[1:, 0], reach.discharge, rtol=1e-12)
    profile = end.upstream.profile
    assert profile is not None
    z = (np.arange(len(profile)) + 0.5) * end.column.dz
    np.testing.assert_allclose(profile, np.interp(z, reach.z, reach.u), rtol=1e-12)
    assert end.upstream.depth == pytest.approx(reach.depth)  # faster than waves


@pytest.mark.full
def test_a_river_resumes_with_the_same_bits_without_its_reach_on_any_threads(
    place: Path, fed: Results, tmp_path: Path, stop_at: Any
) -> None:
    shutil.copytree(place / "runs" / "even", tmp_path / "runs" / "even")
    stop_at(1500)
    folder = tmp_path / "runs" / "river"
    assert ryusa.run(river(tmp_path), folder, progress=False).status == schema.STOPPED
    shutil.rmtree(tmp_path / "runs" / "even")
    for step, threads in ((4000, 1), (None, 2)):
        if step is not None:
            stop_at(step)
        case = read(folder / schema.CASE_TOML)
        ryusa.run(case, folder, progress=False, resume=True, threads=threads)
    assert differences(fed.folder, folder) == []
    said = json.loads((folder / schema.PROVENANCE).read_text())["feeder_reach"]
    assert said["run"] == "runs/even" and said["sha256"] == digest_of((folder / schema.REACH).read_bytes())


@pytest.mark.full
def test_a_changed_copy_of_the_reach_is_refused(place: Path, fed: Results, tmp_path: Path) -> None:
    shutil.copytree(fed.folder, tmp_path / "river")
    kept = tmp_path / "river" / schema.REACH
    kept.write_bytes(kept.read_bytes().replace(b'"discharge": 0.0', b'"discharge": 0.1'))
    with pytest.raises(CaseError, match="has changed since the run began"):
        read(tmp_path / "river" / schema.CASE_TOML)


def test_a_record_is_repeated_with_a_shift_across(place: Path) -> None:
    case = river(place, {"stop.time": "1.3 s"})
    reach = reach_of(case)
    assert reach is not None
    n, came = len(reach.t), repeated(case, reach)
    assert n * 3 <= len(came.t) < n * 4
    assert (np.diff(came.t) >= 0.0).all() and came.t[-1] < 1.3
    for turn in range(1, 3):
        some = slice(turn * n, (turn + 1) * n)
        np.testing.assert_allclose(came.t[some] - reach.t, turn * reach.duration)
        shift = (came.y[some] - reach.y) % reach.width
        assert np.ptp(np.minimum(shift, reach.width - shift)) < 1e-12 and shift.max() > 1e-4
    other = repeated(river(place, {"stop.time": "1.3 s", "seed": "2"}), reach)
    assert not np.allclose(other.y[n:], came.y[n:]) and np.array_equal(other.y[:n], came.y[:n])
    scene = build(case).scene
    assert scene.traffic is not None and scene.traffic.feeds[-1].count == len(came.t)


def test_check_says_what_the_reach_brings(place: Path) -> None:
    rows = {one.name: one for one in explain(river(place, {"motion.slope": "0.1"}))}
    reach = reach_of(river(place))
    assert reach is not None
    assert rows["discharge"].value == reach.discharge and "feeder reach" in rows["discharge"].origin
    assert rows["q_s of the reach"].value == reach.solid_discharge
    assert f"{reach.error:.2g}" in rows["q_s of the reach"].origin
    assert rows["grains from the reach"].value == int((reach.t < 0.3).sum())
    assert rows["record of the reach"].value == pytest.approx(0.4, abs=4e-3)
    assert (
        rows["slope of the reach"].flag == "note" and "carries on less" in rows["slope of the reach"].origin
    )
    assert "slope of the reach" not in {one.name for one in explain(river(place))}


REFUSED = [
    ({"water.row.upstream.run": "runs/evn"}, "no such run folder in the folder of the case"),
    ({"water.row.upstream.run": "runs/river"}, "must be a run of a periodic row"),
    ({"water.row.upstream": "{ end = 'feeder reach' }"}, "missing; end 'feeder reach' needs the run folder"),
    ({"water.row.upstream": "{ end = 'wall', run = 'runs/even' }"}, "has no effect with end 'wall'"),
    (
        {"water.row.upstream": "{ end = 'feeder reach', run = 'runs/even', discharge = '1 L/s' }"},
        "has no effect with end 'feeder reach'",
    ),
    ({"water.row.downstream": "{ end = 'feeder reach' }"}, "can only be given upstream"),
    ({"water.row.width": "3 cm"}, "is a bed 0.024 m wide, and water.row.width is 0.03 m"),
    ({"grains.density": "2600 kg/m3"}, "has grains.density = 2650, and this case 2600"),
    ({"contact.friction_angle": "31 deg"}, "has contact.friction = 0.57735, and this case 0.600861"),
    ({"water.viscosity": "2e-6 m2/s"}, "has water.viscosity = 1e-06, and this case 2e-06"),
    ({"water.drag": "24/Re+0.4"}, "has water.drag = 'Schiller-Naumann'"),
    ({"water.column.packed": "0.6"}, "has water.column.packed = 0.55, and this case 0.6"),
    ({"motion.gravity": "1.6 m/s2"}, "has motion.gravity = 9.80665, and this case 1.6"),
    ({"build.walls": "true"}, "has no side walls, and this river has some"),
    ({"grains.shape": "tetrahedron"}, "brings spheres of one material"),
    (
        {"timeline": "[{ at = '0.1 s', discharge = '2 L/s' }]"},
        "needs water.row.upstream with end = 'discharge'",
    ),
    ({"exits.0.name": "reach"}, "is the name of the feed of the feeder reach"),
]


@pytest.mark.full
@pytest.mark.parametrize(("keys", "said"), REFUSED, ids=[next(iter(keys)) for keys, _ in REFUSED])
def test_what_cannot_feed_a_river_is_refused_before_any_work(
    place: Path, fed: Results, keys: dict[str, str], said: str
) -> None:
    del fed
    with pytest.raises(CaseError, match=said):
        river(place, keys)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"stop.time": "0.3 s"}, "has 21 frames from its record.settle of 0.1 s on, and needs 33 or more"),
        ({"motion.slope": "0.001", "water.depth": "8 mm"}, "no grain crosses the end of its period"),
    ],
)
def test_a_reach_that_supplies_too_little_is_refused(
    tmp_path: Path, change: dict[str, str], said: str
) -> None:
    ryusa.run(read_text(EVEN, change), tmp_path / "runs" / "even", progress=False)
    with pytest.raises(CaseError, match=said):
        river(tmp_path)


def test_an_unfinished_reach_is_refused(tmp_path: Path, stop_at: Any) -> None:
    stop_at(3000)
    ryusa.run(read_text(EVEN), tmp_path / "runs" / "even", progress=False)
    with pytest.raises(CaseError, match="is not finished; `ryusa resume` continues it"):
        river(tmp_path)


def test_what_comes_along_the_bed_of_the_reach_goes_along_an_inclined_bottom(place: Path) -> None:
    tilt = -np.arctan2(0.03, 0.2)
    case = river(place, {"water.row.bottom": "[['0 m', '3 cm'], ['0.2 m', '0 cm']]"})
    reach, scene = reach_of(case), build(case).scene
    assert reach is not None and scene.traffic is not None and scene.row is not None
    arrivals, end = scene.traffic.arrivals, scene.row.upstream
    assert arrivals is not None and end is not None
    n = len(arrivals.t)
    along = arrivals.v[:, 0] * np.cos(tilt) + arrivals.v[:, 2] * np.sin(tilt)
    np.testing.assert_allclose(along, reach.v[:n, 0], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(arrivals.v, axis=1), np.linalg.norm(reach.v[:n], axis=1))
    np.testing.assert_array_equal(arrivals.omega[:, 1], reach.omega[:n, 1])
    np.testing.assert_allclose(arrivals.height, reach.height[:n] / np.cos(tilt))
    assert end.depth == pytest.approx(reach.depth / np.cos(tilt)) and end.discharge == reach.discharge


def test_between_side_walls_a_record_is_repeated_without_a_shift(place: Path) -> None:
    case = river(place, {"stop.time": "0.7 s"})
    reach = reach_of(case)
    assert reach is not None
    n = len(reach.t)
    again = repeated(case, replace(reach, side_walls=True)).y[n:]
    np.testing.assert_array_equal(again, reach.y[: len(again)])


@pytest.mark.full
def test_grains_that_crept_in_the_bed_enter_on_a_bottom_without_one(place: Path, tmp_path: Path) -> None:
    shutil.copytree(place / "runs" / "even", tmp_path / "runs" / "even")
    bare = {
        "build.bed": "0 cm",
        "water.row.bottom": "[['0 m', '1 cm'], ['0.1 m', '0 cm'], ['0.2 m', '0 cm']]",
    }
    case = river(tmp_path, bare | {"water.row.height": "8 cm"})
    reach, run = reach_of(case), ryusa.run(case, tmp_path / "runs" / "bare", progress=False)
    assert reach is not None
    assert (reach.height < -0.006).any()  # deeper than any grain of a bed of one layer
    rows = run.passages[run.passages["way"] == IN]
    assert len(rows) == entered_by(run, reach)
    steep = np.hypot(1.0, 0.1)
    assert (rows["x"][:, 2] >= 0.01 - 0.1 * rows["x"][:, 0] + 0.5 * rows["d"] * steep).all()
    there = run.frames.x[-1]
    assert np.nanmin(there[:, 2]) > 0.0
