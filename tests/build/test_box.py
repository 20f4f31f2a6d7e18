"""A box of floor, back wall and gate holds its grains until the gate goes."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ryusa.build import build, change
from ryusa.casefile import Case, derive, read_text
from ryusa.casefile.builders.values import periodic
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.errors import CaseError

D = 0.002
BASE = """
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
[contact]
stiffness = "10 N/cm"
restitution = 0.5
friction_angle = "20 deg"
[motion]
rotation = "free"
[build]
kind = "box"
columns = 3
layers = 2
[time]
steps_per_contact = 15
[stop]
time = "1 s"
"""
GATE = "[{ at = '0.1 s', remove = 'gate' }]"
WATER = "{ profile = 'log rough', tau_star = 0.3 }"


def case(keys: str = "", **others: str) -> Case:
    box = f"{{ kind = 'box', columns = 3, layers = 2{', ' + keys if keys else ''} }}"
    return read_text(BASE, {"build": box, **{key.replace("__", "."): value for key, value in others.items()}})


def sized(columns: int, layers: int, keys: str) -> str:
    return f"{{ kind = 'box', columns = {columns}, layers = {layers}, {keys} }}"


@pytest.mark.parametrize("floor", ["grains", "plane"])
@pytest.mark.parametrize("walls", ["grains", "planes"])
def test_floor_back_and_gate_are_groups_that_can_be_removed(floor: str, walls: str) -> None:
    one = case(
        f"floor = '{floor}', walls = '{walls}'" + (", run_out = '1 cm'" if floor == "grains" else ""),
        timeline=GATE,
    )
    built = build(one)
    groups = built.scene.groups
    assert {"floor", "back", "gate"} <= set(groups)
    after = change(one, built.scene, one.timeline[0])
    first, end = groups["gate"]
    gone = np.concatenate([~after.fixed_active, ~after.plane_active])
    assert gone.sum() == end - first > 0
    assert gone[first - built.scene.n_grain : end - built.scene.n_grain].all()
    assert end - first == 1 or walls == "grains"
    assert groups["floor"][1] - groups["floor"][0] == 1 or floor == "grains"


@settings(max_examples=40)
@given(
    columns=st.integers(1, 7),
    rows=st.integers(3, 5),
    layers=st.integers(1, 4),
    gap=st.floats(0, 1),
    jitter=st.floats(0, 1),
    run_out=st.floats(0, 0.02),
    height=st.floats(0, 0.01),
    floor=st.sampled_from(["floor = 'plane'", "floor = 'grains'", "floor_height = 0.4"]),
    walls=st.sampled_from(["grains", "planes"]),
    spread=st.sampled_from(["0.0", "0.3", "{kind='lognormal', ratio=0.2}"]),
    plane=st.booleans(),
    seed=st.integers(0, 1000),
)
def test_a_box_never_overlaps_and_holds_its_lattice(
    columns: int,
    rows: int,
    layers: int,
    gap: float,
    jitter: float,
    run_out: float,
    height: float,
    floor: str,
    walls: str,
    spread: str,
    plane: bool,
    seed: int,
) -> None:
    rows = 1 if plane else rows
    keys = f"rows = {rows}, gap = {gap:.6f}, jitter = {jitter:.6f}, height = '{height:.6f} m', {floor}"
    keys += f", walls = '{walls}'" + (f", run_out = '{run_out:.6f} m'" if "plane" not in floor else "")
    one = read_text(
        BASE,
        {
            "build": sized(columns, layers, keys),
            "grains.spread": spread,
            "motion.plane": str(plane).lower(),
            "seed": str(seed),
        },
    )
    built = build(one)  # refuses overlaps of free grains itself
    scene, x = built.scene, built.state.x
    assert scene.n_grain == derive(one).n_grain == columns * rows * layers
    assert scene.n_fixed == derive(one).n_fixed
    assert periodic(one) == tuple(math.isfinite(length) for length in scene.period)
    assert (x[:, 0] - scene.d / 2 > -1e-12).all()
    if scene.n_fixed > 1 and plane:
        apart = np.linalg.norm(scene.x_fixed[:, None] - scene.x_fixed[None], axis=2)
        assert apart[~np.eye(scene.n_fixed, dtype=bool)].min() >= D * (1 - 1e-9)
    if walls == "grains":
        first, end = (edge - scene.n_grain for edge in scene.groups["gate"])
        gate = scene.x_fixed[first:end]
        assert gate[:, 2].max() > x[:, 2].max()
        assert gate[0, 0] - D / 2 > x[:, 0].max()
        assert (gate[0, 0] - D / 2) / D == pytest.approx(round((gate[0, 0] - D / 2) / D))


def test_the_box_of_the_paper_has_42_grains_over_a_floor_without_holes() -> None:
    one = read_text(BASE, {"build": sized(6, 7, "walls = 'grains'")})
    scene = build(one).scene
    assert scene.n_grain == 42
    first, end = (edge - 42 for edge in scene.groups["floor"])
    floor = scene.x_fixed[first:end]
    assert floor[:, 0] == pytest.approx((np.arange(7) + 0.5) * D)  # 6 x 1.1 d, rounded up
    assert floor[:, 2] == pytest.approx(D / 2)
    first, end = (edge - 42 for edge in scene.groups["back"])
    back = scene.x_fixed[first:end]
    assert back[:, 0] == pytest.approx(-D / 2)
    assert back[:, 2] == pytest.approx((np.arange(end - first) + 0.5) * D)


def test_the_run_out_continues_beneath_the_gate_and_without_one_the_floor_ends_there() -> None:
    for run_out, beyond, lowest in (("0 cm", 0, D / 2), ("1.1 cm", 6, 1.5 * D)):
        scene = build(case(f"walls = 'grains', run_out = '{run_out}'")).scene
        n = scene.n_grain
        first, end = (edge - n for edge in scene.groups["floor"])
        assert end - first == 4 + beyond
        first, end = (edge - n for edge in scene.groups["gate"])
        assert scene.x_fixed[first:end, 2].min() == pytest.approx(lowest)


def test_the_domain_contains_the_pit_and_the_run_out() -> None:
    assert 3.0 < build(case("run_out = '3 m'")).scene.world_high[0] < math.inf
    for endless in ("floor = 'plane'", "run_out = '3 m', drop = '2 m'"):  # rolling grains go far
        assert build(case(endless)).scene.world_high[0] == math.inf
    scene = build(case("run_out = '3 m', drop = '2 m'")).scene
    assert scene.world_low[2] < -2.0
    pit = scene.groups["pit"][0] - scene.n_grain - scene.n_fixed
    assert scene.plane_point[pit].tolist() == [0.0, 0.0, -2.0]


def test_an_uneven_floor_stays_within_its_height() -> None:
    scene = build(case("floor_height = 0.4, walls = 'grains', run_out = '2 cm'")).scene
    first, end = (edge - scene.n_grain for edge in scene.groups["floor"])
    heights = scene.x_fixed[first:end, 2] - D / 2
    assert 0.0 < np.ptp(heights) <= 0.4 * D
    assert heights.min() >= 0.0


def test_the_notes_list_the_free_choices_of_a_box() -> None:
    notes = " ".join(build(case("drop = '1 cm'", timeline=GATE, water=WATER)).notes)
    for part in ("build.floor", "build.walls", "build.run_out", "grains.spread", "zero of the water profile"):
        assert part in notes, part
    assert "build.drop not given" not in notes
    assert "build.drop not given" in " ".join(build(case("run_out = '1 cm'", timeline=GATE)).notes)


@pytest.mark.parametrize(
    ("floor", "zero"),
    [("floor = 'grains'", 0.75 * D), ("floor_height = 0.0", 0.75 * D), ("floor = 'plane'", 0.0)],
)
def test_water_begins_at_the_floor(floor: str, zero: float) -> None:
    assert build(case(floor, water=WATER)).scene.water.z_zero == pytest.approx(zero)


@pytest.mark.parametrize(
    ("keys", "others", "key", "part"),
    [
        ("rows = 2", {}, "build.rows", "must be 1 in a plane scene"),
        ("rows = 2", {"motion__plane": "false"}, "build.rows", "at least 3"),
        ("floor = 'plane', run_out = '1 cm'", {}, "build.run_out", "unbounded"),
        ("floor = 'plane', drop = '1 cm'", {}, "build.drop", "unbounded"),
        ("floor = 'plane', floor_height = 0.2", {}, "build.floor_height", "flat"),
        ("", {"timeline": GATE}, "timeline.0.remove", "build.drop (a plane that catches them)"),
        (
            "run_out = '9 cm'",
            {"timeline": GATE.replace("gate", "back")},
            "timeline.0.remove",
            "lets grains fall beside the floor",
        ),
        (
            "floor = 'plane'",
            {"timeline": GATE.replace("gate", "floor")},
            "timeline.0.remove",
            "a plane in [[planes]]",
        ),
        ("", {"timeline": GATE.replace("gate", "pit")}, "timeline.0.remove", "floor, back, gate"),
        ("floor_height = 0.9", {"grains__spread": "0.7"}, "grains.spread", "slips through"),
        (
            "rows = 3",
            {"grains__spread": "0.7", "motion__plane": "false"},
            "grains.spread",
            "slips through",
        ),
        (
            "",
            {"planes": "[{ name = 'gate', point = ['9 cm', '0 m', '0 m'], normal = [-1, 0, 0] }]"},
            "planes.0.name",
            "already used by the builder",
        ),
    ],
)
def test_a_box_that_cannot_be_is_refused(keys: str, others: dict[str, str], key: str, part: str) -> None:
    with pytest.raises(CaseError) as caught:
        build(case(keys, **others))
    assert caught.value.key == key
    assert part in str(caught.value)


@pytest.mark.parametrize("walls", ["grains", "planes"])
@pytest.mark.parametrize("water", ["", "{ profile = 'still' }"])
def test_grains_leave_only_after_the_gate_is_removed(walls: str, water: str) -> None:
    one = read_text(
        BASE,
        {
            "build": sized(4, 8, f"gap = 0.2, walls = '{walls}', run_out = '2 cm', drop = '1 cm'"),
            "grains.spread": "0.2",
            "timeline": GATE,
            **({"water": water} if water else {}),
        },
    )
    built = build(one)
    engine, scene = CpuEngine(), built.scene
    steps = round(0.1 / scene.dt)
    engine.load(scene, built.state)
    engine.advance(steps).raise_if_any()
    inside = scene.x_fixed[scene.groups["floor"][0] - scene.n_grain, 0] - D / 2 + 6 * D
    assert engine.state().x[:, 0].max() < inside
    engine.load(change(one, scene, one.timeline[0]), engine.state())
    engine.advance(steps).raise_if_any()
    assert engine.state().x[:, 0].max() > inside + D


def test_the_pit_catches_grains_that_fall_off_the_end() -> None:
    one = read_text(
        BASE,
        {
            "build": sized(3, 12, "drop = '1 cm'"),
            "grains.spread": "0.2",
            "timeline": "[{ at = '0 s', remove = 'gate' }]",
        },
    )
    built = build(one)
    engine = CpuEngine()
    engine.load(change(one, built.scene, one.timeline[0]), built.state)
    engine.advance(round(0.3 / built.scene.dt)).raise_if_any()
    below = engine.state().x[:, 2] < 0.0
    assert below.sum() > 3
    assert engine.state().x[below, 2].min() > -0.01
