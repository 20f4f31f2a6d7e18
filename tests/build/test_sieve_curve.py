"""Every builder that draws sizes lays the sieve curve, and no first grain touches another."""

from pathlib import Path

import numpy as np
import pytest

from ryusa.build import build
from ryusa.build.nested_lattice import LatticeCells, nested_lattice
from ryusa.casefile import Case, derive, read, read_text
from ryusa.casefile.builders.values import bed_area
from ryusa.casefile.column.bed import bed_thickness
from ryusa.cases import case_path
from ryusa.model.grading import Grading

CURVE = "[['1 mm', 0], ['2 mm', 30], ['4 mm', 80], ['8 mm', 100]]"
ASKED = Grading.of([(0.001, 0.0), (0.002, 0.3), (0.004, 0.8), (0.008, 1.0)])
HEAD = """
[grains]
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
[stop]
time = "0.1 s"
[build]
"""
BUILD = {
    "packing": 'kind = "packing"\ncolumns = 5\nrows = 4\nlayers = 40\nbed = "plane"\n',
    "flume": 'kind = "flume"\nlength = "5 cm"\nwidth = "4 cm"\nlayers = 3\nbed = "plane"\n',
    "box": 'kind = "box"\ncolumns = 5\nrows = 4\nlayers = 40\nfloor = "plane"\n',
    "fill": 'kind = "fill"\nlow = ["0 cm", "0 cm", "0 cm"]\nhigh = ["5 cm", "4 cm", "6 cm"]\n',
}
PLANE = {"packing": {"build.rows": "1"}, "flume": {}, "box": {"build.rows": "1"}, "fill": {}}


def case(kind: str, **keys: str) -> Case:
    given = {"grains.sieve_curve": CURVE, **{key.replace("__", "."): value for key, value in keys.items()}}
    return read_text(HEAD + BUILD[kind], given)


def finer(d: np.ndarray, at: float) -> float:
    return float((d[d < at] ** 3).sum() / (d**3).sum())


@pytest.mark.parametrize("kind", BUILD)
@pytest.mark.parametrize("plane", ["false", "true"])
def test_a_builder_lays_the_curve_without_overlaps(kind: str, plane: str) -> None:
    # overlaps between grains are refused by the builder itself
    text = HEAD + (BUILD[kind] if plane == "false" else BUILD[kind].replace('width = "4 cm"\n', ""))
    keys = {"motion.plane": plane, "grains.sieve_curve": CURVE, **(PLANE[kind] if plane == "true" else {})}
    found = read_text(text, keys)
    built = build(found)
    d = np.asarray(built.scene.d)
    within = ASKED.largest_share(len(d)) * (1.0 + 1e-9)
    for at in (0.0015, 0.002, 0.003, 0.004, 0.006):
        assert finer(d, at) == pytest.approx(ASKED.share_below(at), abs=within)
    assert 0.001 <= d.min() < 0.00102
    assert np.asarray(built.scene.m) == pytest.approx(2650.0 * np.pi / 6.0 * d**3, rel=1e-12)
    for normal, point in zip(built.scene.plane_normal, built.scene.plane_point, strict=True):
        assert np.min((built.state.x - point) @ normal - 0.5 * d) >= -1e-12


def test_a_flume_holds_the_volume_of_its_layers_whatever_the_curve() -> None:
    one = case("flume", grains__diameter="'3 mm'")
    n_alike = 3 * int(0.05 / 0.003) * int(0.04 / 0.003)
    d = np.asarray(build(one).scene.d)
    assert np.sum(d**3) == pytest.approx(n_alike * 0.003**3, rel=0.5 / len(d) + 1e-9)
    solid = len(d) * np.pi / 6.0 * ASKED.mean_cube
    assert bed_thickness(one) == pytest.approx(solid / (bed_area(one) * 0.61), rel=1e-12)


def test_grains_of_a_curve_do_not_stand_higher_than_a_few_times_their_volume() -> None:
    built = build(case("flume"))
    solid = float(np.sum(np.pi / 6.0 * np.asarray(built.scene.d) ** 3)) / (0.05 * 0.04)
    # a cell is 1 to 8 times the cube that holds its grain with the gap, and the highest layer is not full
    assert np.max(built.state.x[:, 2]) < 10.0 * solid + 0.008 * 1.05


def test_sizes_are_those_of_every_seed_and_their_order_is_not() -> None:
    one, other = (build(case("packing", seed=seed)) for seed in ("1", "2"))
    again = build(case("packing", seed="1"))
    assert np.array_equal(np.sort(one.scene.d), np.sort(other.scene.d))
    assert not np.array_equal(one.scene.d, other.scene.d)
    assert np.array_equal(one.scene.d, again.scene.d)
    assert np.array_equal(one.state.x, again.state.x)


def test_a_cut_curve_lays_only_what_lies_between() -> None:
    d = np.asarray(build(case("packing", grains__finest="'2 mm'", grains__coarsest="'4 mm'")).scene.d)
    assert d.min() >= 0.002
    assert d.max() <= 0.004
    assert finer(d, 0.002 * 2**0.5) == pytest.approx(0.5, abs=ASKED.cut(0.002, 0.004).largest_share(len(d)))


def test_the_reference_diameter_is_d50_unless_the_case_gives_it() -> None:
    assert derive(case("packing")).d == pytest.approx(0.002 * 2 ** (0.2 / 0.5), rel=1e-12)
    found = derive(case("packing", grains__diameter="'3 mm'"))
    assert (found.d, found.d_min, found.d_max) == (0.003, 0.001, 0.008)
    # the step follows the finest grain, with d^1.5 at one stiffness
    assert found.dt / derive(case("packing", grains__finest="'2 mm'")).dt == pytest.approx(0.5**1.5, rel=1e-9)


@pytest.mark.parametrize("plane", [False, True])
def test_a_nested_lattice_keeps_grains_apart(plane: bool) -> None:
    rng = np.random.default_rng(5)
    d = rng.permutation(ASKED.quotas(3_000))
    cells = LatticeCells((0.0085, 0.0088, 0.0084), 7, 1 if plane else 5)
    x = nested_lattice(d, cells, 0.05, 0.9, plane, rng)
    width = np.array([7 * 0.0085, cells.n_y * 0.0088])
    for one in range(0, len(d), 7):
        apart = x - x[one]
        apart[:, :2] -= width * np.round(apart[:, :2] / width)
        if plane:
            apart[:, 1] = 0.0
        gap = np.sqrt((apart**2).sum(axis=1)) - 0.5 * (d + d[one])
        gap[one] = 1.0
        assert gap.min() > 0.0


@pytest.mark.parametrize("plane", [False, True])
def test_a_nested_lattice_mixes_sizes_over_its_height(plane: bool) -> None:
    cells = LatticeCells((0.0085, 0.0088, 0.0084), 7, 1 if plane else 5)
    more = []
    for seed in range(20):  # one differs by 12 %, standard deviation: half of the mass is in 208 grains
        rng = np.random.default_rng(seed)
        d = rng.permutation(ASKED.quotas(3_000))
        z = nested_lattice(d, cells, 0.05, 0.9, plane, rng)[:, 2]
        mean = [np.average(d, weights=d**3 * there) for there in (z < np.median(z), z >= np.median(z))]
        more.append(mean[0] / mean[1] - 1.0)
    assert abs(np.mean(more)) < 0.1


def test_the_packaged_case_is_built() -> None:
    found = read(case_path("graded_gravel.toml"))
    assert build(found).scene.n_grain == derive(found).n_grain
    assert Path(case_path("graded_gravel.toml")).is_file()


@pytest.mark.parametrize("plane", ["false", "true"])
@pytest.mark.parametrize(
    "curve", [CURVE, "[['0.3 mm', 0], ['1 mm', 60], ['9 mm', 100]]", "[['3 mm', 0], ['4 mm', 100]]"]
)
def test_a_box_filled_by_a_curve_holds_all_its_grains_and_little_room_is_left(plane: str, curve: str) -> None:
    made = build(case("fill", motion__plane=plane, grains__sieve_curve=curve))
    x, r = made.state.x, 0.5 * np.asarray(made.scene.d)
    for axis, high in ((0, 0.05), (2, 0.06)):
        assert np.min(x[:, axis] - r) >= -1e-12
        assert np.max(x[:, axis] + r) <= high + 1e-12
    assert np.max(x[:, 2] + r) > 0.06 - 2.5 * 1.05 * 2.0 * r.max()  # the highest layers are not left empty


def test_the_most_grains_of_a_box_are_those_that_it_holds_at_first_whatever_feeds_bring() -> None:
    hose = 'feeds=[{name="hose", centre=["2 cm", "2 cm", "9 cm"], radius="1 cm", rate="100 grains/s"}]\n'
    found = read_text("\n" + hose + HEAD + BUILD["fill"] + "most = 20\n", {"grains.diameter": "3 mm"})
    made = build(found)
    assert made.scene.traffic is not None
    assert made.scene.traffic.n_first == 20
    assert derive(found).n_grain == made.scene.n_grain == 30
