"""Builders place what the case says, and nothing overlaps."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ryusa.build import build, change, scene
from ryusa.build.overlaps import refuse_overlaps
from ryusa.build.placement import Placement, Wall
from ryusa.casefile import Case, ChangeSection, derive, read_text
from ryusa.casefile.builders.values import periodic
from ryusa.casefile.water.values import drag_coefficient, water_speed
from ryusa.engine.shared import fluid
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.parameters import parameters_of
from ryusa.errors import CaseError
from ryusa.laws import drag
from ryusa.laws._family import evaluate
from ryusa.laws.dispatch import drag_of
from ryusa.laws.families import Drag, Profile
from ryusa.model.scene import Damping, EventRule

BASE = """
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "free"
slope = "1/20"
[build]
kind = "drop"
[stop]
time = "1 s"
"""
WATER = "{ profile = 'log rough', tau_star = 0.3 }"


def case(build: str, **keys: str) -> Case:
    return read_text(BASE, {"build": build, **{key.replace("__", "."): value for key, value in keys.items()}})


def test_a_drop_starts_above_a_fixed_grain() -> None:
    built = build(
        case(
            "{ kind = 'drop', height = '1 cm', speed = '0.2 m/s', speed_along = '0.1 m/s', spin = '5 rad/s' }"
        )
    )
    assert built.state.x.tolist() == [[0.0, 0.0, pytest.approx(0.013)]]
    assert built.state.v.tolist() == [[0.1, 0.0, -0.2]]
    assert built.state.omega.tolist() == [[0.0, 5.0, 0.0]]
    assert built.scene.x_fixed.tolist() == [[0.0, 0.0, 0.001]]
    assert built.scene.groups["struck"] == (1, 2)
    assert built.scene.plane_case and built.scene.rotation


@pytest.mark.parametrize("offset", [0.0, 0.001, -0.0019])
def test_an_oblique_drop_with_no_gap_just_touches(offset: float) -> None:
    built = build(case(f"{{ kind = 'drop', height = '0 m', speed = '1 m/s', offset = '{offset} m' }}"))
    assert np.linalg.norm(built.state.x[0] - built.scene.x_fixed[0]) == pytest.approx(0.002, rel=1e-12)


def test_a_drop_on_a_free_grain_and_on_a_plane() -> None:
    free = build(case("{ kind = 'drop', partner = 'free', height = '1 mm' }")).scene
    assert (free.n_grain, free.n_fixed, free.n_plane) == (2, 0, 0)
    plane = build(case("{ kind = 'drop', partner = 'plane', height = '1 mm' }"))
    assert (plane.scene.n_grain, plane.scene.n_fixed, plane.scene.n_plane) == (1, 0, 1)
    assert plane.scene.groups["floor"] == (1, 2)
    assert plane.state.x[0, 2] == pytest.approx(0.002)


def test_copies_of_a_drop_cannot_be_neighbours() -> None:
    built = build(case("{ kind = 'drop', height = '1 mm', copies = 5, height_step = '0.1 mm' }"))
    y = built.state.x[:, 1]
    assert np.diff(np.sort(y)).min() >= 2 * 0.002
    assert np.diff(built.state.x[:, 2]) == pytest.approx(1e-4)
    assert np.array_equal(built.scene.x_fixed[:, 1], y)


def test_a_saltation_bed_is_a_periodic_line_of_touching_grains() -> None:
    built = build(case("{ kind = 'saltation', n_bed = 12, starts = 3 }", water=WATER))
    s = built.scene
    assert s.period[0] == pytest.approx(12 * 0.002)
    assert math.isinf(s.period[1])
    lane = s.x_fixed.reshape(3, 12, 3)[1]
    assert np.diff(lane[:, 0]) == pytest.approx(0.002)
    assert lane[0, 0] + s.period[0] - lane[-1, 0] == pytest.approx(0.002)
    assert s.x_fixed[:, 2] == pytest.approx(0.001)
    assert s.groups["bed"] == (3, 39)
    assert np.diff(built.state.x[:, 1]).min() >= 2 * 0.002
    assert ((built.state.x[:, 0] >= 0) & (built.state.x[:, 0] < s.period[0])).all()


def test_saltation_states_its_free_choices() -> None:
    built = build(case("{ kind = 'saltation' }", water=WATER))
    water = built.scene.water
    assert water.z_zero == pytest.approx(0.75 * 0.002)
    assert water.k_rough == 0.002
    for part in ("zero of the water profile", "roughness", "start", "drag", "k_s"):
        assert any(part in note for note in built.notes), part
    height = 3.5 * 0.002 - water.z_zero
    expected = water.u_star * (8.5 + 5.75 * math.log10(height / 0.002))
    assert built.state.v[:, 0] == pytest.approx(expected)


def test_starts_are_random_by_the_seed_alone() -> None:
    def xs(seed: int, starts: int) -> list[float]:
        return (
            build(case(f"{{ kind = 'saltation', starts = {starts} }}", seed=str(seed))).state.x[:, 0].tolist()
        )

    assert xs(1, 4) == xs(1, 4)
    assert xs(1, 6)[:4] == xs(1, 4)
    assert xs(1, 4) != xs(2, 4)


@settings(max_examples=25)
@given(
    columns=st.integers(3, 8),
    rows=st.integers(3, 6),
    layers=st.integers(1, 4),
    gap=st.floats(0, 1),
    jitter=st.floats(0, 1),
    bed=st.sampled_from(["random", "flat", "plane"]),
    spread=st.sampled_from(["0.0", "0.3", "{kind='lognormal', ratio=0.3}", "{kind='normal', ratio=0.2}"]),
    plane=st.booleans(),
    seed=st.integers(0, 1000),
)
def test_a_packing_never_overlaps(
    columns: int,
    rows: int,
    layers: int,
    gap: float,
    jitter: float,
    bed: str,
    spread: str,
    plane: bool,
    seed: int,
) -> None:
    rows = 1 if plane else rows
    keys = f"columns = {columns}, rows = {rows}, layers = {layers}, gap = {gap:.6f}"
    one = case(
        f"{{ kind = 'packing', {keys}, jitter = {jitter:.6f}, bed = '{bed}' }}",
        grains__spread=spread,
        motion__plane=str(plane).lower(),
        seed=str(seed),
    )
    built = build(one)  # refuses overlaps itself
    assert built.scene.n_grain == derive(one).n_grain == columns * rows * layers
    assert built.scene.n_fixed == derive(one).n_fixed
    assert built.scene.d.min() >= derive(one).d_min * (1 - 1e-12)
    assert built.scene.d.max() <= derive(one).d_max * (1 + 1e-12)
    if plane:
        assert not built.state.x[:, 1].any()
    for axis in (0, 1):
        if math.isfinite(built.scene.period[axis]):
            assert built.state.x[:, axis].min() >= 0.0
            assert built.state.x[:, axis].max() < built.scene.period[axis]


def test_the_laws_of_the_case_are_those_of_the_scene() -> None:
    s = build(
        case(
            "{ kind = 'drop', height = '1 cm' }",
            water="{ profile = 'still', drag = 'Schiller-Naumann', added_mass = 0.0 }",
            contact__damping="0.001 N s/cm",
            record__events="tracked",
            record__tracked="[0]",
        )
    ).scene
    assert s.contact.damping == Damping.CONSTANTS
    assert s.contact.eta_n == pytest.approx(0.1)
    assert (s.water.profile, s.water.drag) == (Profile.STILL, Drag.SCHILLER_NAUMANN)
    assert s.m_added.tolist() == [0.0]
    assert s.m_weight[0] == pytest.approx(s.m[0] * 1650 / 2650)
    assert s.events == EventRule.TRACKED
    assert s.tracked.tolist() == [True]
    angle = math.atan(0.05)
    assert s.gravity == pytest.approx([9.80665 * math.sin(angle), 0.0, -9.80665 * math.cos(angle)])


def test_arrays_of_a_scene_are_read_only_and_the_world_is_bounded() -> None:
    built = build(case("{ kind = 'saltation' }", water=WATER))
    with pytest.raises(ValueError, match="read-only"):
        built.scene.d[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        built.state.x[0] = 1.0
    assert built.scene.world_low[2] < -0.01
    assert 1.0 < built.scene.world_high[2] < 10.0


def test_planes_of_the_case_become_groups_that_the_timeline_can_remove() -> None:
    gate = "[{ name = 'gate', point = ['5 cm', '0 cm', '0 cm'], normal = [-2, 0, 0] }]"
    one = case(
        "{ kind = 'drop', height = '1 cm' }", planes=gate, timeline="[{ at = '0.1 s', remove = 'gate' }]"
    )
    built = build(one)
    assert built.scene.plane_normal.tolist() == [[-1.0, 0.0, 0.0]]
    after = change(one, built.scene, one.timeline[0])
    assert after.plane_active.tolist() == [False]
    assert built.scene.plane_active.tolist() == [True]
    with pytest.raises(
        CaseError, match="must be a group of fixed grains, a plane or a wall: bed, struck, gate"
    ):
        build(
            case(
                "{ kind = 'drop', height = '1 cm' }",
                planes=gate,
                timeline="[{ at = '0.1 s', remove = 'gat' }]",
            )
        )


def test_changes_tilt_gravity_and_switch_friction_and_rotation() -> None:
    one = case("{ kind = 'drop', height = '1 cm' }")
    before = build(one).scene
    tilted = change(one, before, ChangeSection.model_validate({"at": "0 s", "slope_angle": "30 deg"}))
    assert tilted.gravity == pytest.approx([9.80665 / 2, 0.0, -9.80665 * math.sqrt(3) / 2])
    slippery = change(one, before, ChangeSection.model_validate({"at": "0 s", "friction": 0.0}))
    assert slippery.contact.mu == 0.0
    assert replace(slippery.contact, mu=before.contact.mu) == before.contact
    assert not change(one, before, ChangeSection.model_validate({"at": "0 s", "rotation": "locked"})).rotation
    bare = change(one, before, ChangeSection.model_validate({"at": "0 s", "remove": "bed"}))
    assert bare.fixed_active.tolist() == [False]


def test_first_grains_that_overlap_across_a_period_or_a_plane_are_named() -> None:
    x = np.array([[0.0005, 0.0, 0.01], [0.0995, 0.0, 0.01]])
    two = Placement(
        d=np.full(2, 0.002), x=x, v=np.zeros((2, 3)), omega=np.zeros((2, 3)), period=(0.1, math.inf)
    )
    with pytest.raises(CaseError, match=r"free grain 0 at .* and free grain 1 at .* by 0.5 d"):
        refuse_overlaps(two, "build")
    refuse_overlaps(replace(two, period=(math.inf, math.inf)), "build")
    floor = (Wall("floor", (0.0, 0.0, 0.0095), (0.0, 0.0, 3.0)),)
    with pytest.raises(CaseError, match=r"free grain 0 .* and plane 'floor' by 0.25 d"):
        refuse_overlaps(replace(two, period=(math.inf, math.inf), walls=floor), "build")


def test_a_script_builds_a_scene_grain_by_grain() -> None:
    s, first = scene(
        x=[[0.0, 0.0, 0.01], [0.0, 0.0, 0.013]],
        d=[0.002, 0.003],
        v=[[0.0, 0.0, -1.0], [0.0, 0.0, 0.0]],
        x_fixed=[0.0, 0.0, 0.001],
        d_fixed=0.002,
        planes=[("floor", (0, 0, 0), (0, 0, 1))],
        restitution=0.5,
        steps_per_contact=20,
    )
    assert (s.n_grain, s.n_fixed, s.n_plane) == (2, 1, 1)
    assert s.m[1] / s.m[0] == pytest.approx(1.5**3)
    assert s.contact.zeta_n == pytest.approx(0.25528, abs=1e-5)
    assert first.v[0, 2] == -1.0
    assert 20 * s.dt < math.pi * math.sqrt(s.m[0] / 2 / s.contact.k_n)


@pytest.mark.parametrize(
    "keys",
    [
        {"x": [[0.0, 0.0]], "d": 0.002},
        {"x": [], "d": 0.002},
        {"x": [[0.0, 0.0, math.nan]], "d": 0.002},
        {"x": [[0.0, 0.0, 0.0]], "d": -1.0},
        {"x": [[0.0, 0.0, 0.0]], "d": [0.002, 0.002]},
        {"x": [[0.0, 0.0, 0.0], [0.001, 0.0, 0.0]], "d": 0.002},
        {"x": [[0.0, 0.0, 0.0]], "d": 0.002, "v": [[0.0, 0.0, 0.0]] * 2},
    ],
)
def test_bad_arrays_of_a_script_are_refused_by_name(keys: dict[str, object]) -> None:
    with pytest.raises(CaseError):
        scene(**keys)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("density", 0.0), ("stiffness", -1e4), ("stiffness", math.nan), ("shear_ratio", -0.1),
        ("restitution", 1.5), ("restitution", 0.0), ("restitution_shear", math.nan), ("friction", -0.1),
        ("gravity", math.inf), ("density", [2650.0]), ("slope", 1.6), ("dt", 0.0),
        ("steps_per_contact", 0.0), ("period", (0.0, math.inf)),
    ],
)  # fmt: skip
def test_a_number_of_a_script_out_of_range_is_refused_by_name(key: str, value: object) -> None:
    with pytest.raises(CaseError, match=f"^{key} = .*must") as caught:
        scene(x=[[0.0, 0.0, 0.0]], d=0.002, **{key: value})  # type: ignore[arg-type]
    assert caught.value.key == key


def test_a_plane_script_has_lanes_that_are_equal_or_a_diameter_apart() -> None:
    over = [[0.0, 0.0, 0.01], [0.0, 0.0, 0.0125]]
    scene(x=over, d=0.002, plane_case=True)
    for y in (1e-18, 0.0015, 0.0019):
        over[1][1] = y
        with pytest.raises(CaseError, match=r"two lanes .* free grain 0 at .* and free grain 1 at .* equal"):
            scene(x=over, d=0.002, plane_case=True, allow_overlap=True)
    scene(x=over, d=0.002)  # in three dimensions y may be anything
    with pytest.raises(CaseError, match=r"free grain 0 at .* and fixed grain 1 at"):
        scene(x=over[0], d=0.002, x_fixed=over[1], d_fixed=0.002, plane_case=True)
    over[1] = [0.0, 0.002, 0.01]  # side by side at the same x and z, each in its lane
    scene(x=over, d=0.002, plane_case=True)
    with pytest.raises(CaseError, match="two lanes"):
        scene(x=over, d=[0.002, 0.003], plane_case=True)


@given(st.lists(st.tuples(*[st.floats(0.0, 0.02)] * 2, st.integers(0, 2)), min_size=2, max_size=6))
@settings(max_examples=60)
def test_first_grains_of_a_plane_scene_overlap_in_their_lane_only(places: list[tuple[float, ...]]) -> None:
    x = np.array([(a, 0.002 * lane, b) for a, b, lane in places])
    apart = np.hypot(*(x[:, None, k] - x[None, :, k] for k in (0, 2)))
    same = x[:, None, 1] == x[None, :, 1]
    deepest = ((0.002 - apart) / 0.002)[same & ~np.eye(len(x), dtype=bool)].max(initial=-1.0)
    if deepest > 2e-9:
        with pytest.raises(CaseError, match="overlap"):
            scene(x=x, d=0.002, plane_case=True)
    elif deepest < 0.0:
        scene(x=x, d=0.002, plane_case=True)


@pytest.mark.parametrize(
    ("keys", "part"),
    [
        ({"planes": [("gate", (0.1, 0, 0), (-1, 0, 0))], "period": (0.2, math.inf)}, "x = 0"),
        ({"planes": [("side", (0, 0.1, 0), (0, -1, 0.5))], "period": (math.inf, 0.2)}, "y = 0"),
        ({"planes": [("side", (0, 0.1, 0), (0, -1, 0))], "plane_case": True}, "y = 0 in a plane scene"),
        ({"planes": [("flat", (0, 0, 0), (0, 0, 0))]}, "other than zero"),
        ({"planes": [("flat", (0, 0, 0), (0, 0, math.nan))]}, "finite"),
        ({"period": (math.inf, 0.2), "plane_case": True}, "no meaning in y"),
    ],
)
def test_walls_and_periods_that_contradict_each_other_are_refused(keys: dict[str, object], part: str) -> None:
    with pytest.raises(CaseError, match=part):
        scene(x=[0.0, 0.0, 0.01], d=0.002, **keys)  # type: ignore[arg-type]


@pytest.mark.parametrize("plane", ["true", "false"])
def test_an_open_packing_stands_between_its_walls(plane: str) -> None:
    rows = 1 if plane == "true" else 2
    pitch = 1.1 * 0.002
    walls = [("left", 0.0, 1), ("gate", 5 * pitch, -1)]
    planes = [
        f"{{ name = '{n}', point = ['{at} m', '0 m', '0 m'], normal = [{s}, 0, 0] }}" for n, at, s in walls
    ]
    one = case(
        f"{{ kind = 'packing', columns = 5, rows = {rows}, layers = 3, periodic = false }}",
        motion__plane=plane,
        planes=f"[{', '.join(planes)}]",
        timeline="[{ at = '0.1 s', remove = 'gate' }]",
    )
    built = build(one)
    assert built.scene.period == (math.inf, math.inf)
    assert (built.scene.n_grain, built.scene.n_fixed) == (15 * rows, derive(one).n_fixed)
    bed = built.scene.x_fixed
    assert bed[:, 0].min() > 0.0
    assert bed[:, 0].max() < 5 * pitch
    assert not change(one, built.scene, one.timeline[0]).plane_active[1]


@pytest.mark.parametrize(
    ("keys", "plane"),
    [
        ("{ kind = 'drop', height = '1 cm' }", "true"),
        ("{ kind = 'saltation' }", "true"),
        ("{ kind = 'packing', columns = 4, layers = 2 }", "true"),
        ("{ kind = 'packing', columns = 4, layers = 2, periodic = false }", "true"),
        ("{ kind = 'packing', columns = 4, rows = 3, layers = 2 }", "false"),
        ("{ kind = 'packing', columns = 4, rows = 1, layers = 2, periodic = false }", "false"),
    ],
)
def test_a_case_knows_which_axes_its_builder_makes_periodic(keys: str, plane: str) -> None:
    one = case(keys, motion__plane=plane)
    period = build(one).scene.period
    assert periodic(one) == tuple(math.isfinite(length) for length in period)


def test_records_of_contacts_are_kept_for_few_grains_and_left_out_for_many() -> None:
    for layers, kept, rule in ((10, "all", EventRule.ALL), (11, "none", EventRule.NONE)):
        packing = f"{{ kind = 'packing', columns = 100, layers = {layers} }}"
        built = build(case(packing))
        assert built.scene.events == rule
        assert f"contacts recorded: {kept} (record.events not given)" in built.notes
        assert build(case(packing, record__events="all")).scene.events == EventRule.ALL
    assert (
        build(case("{ kind = 'saltation', starts = 1001 }", stop__saltations="3")).scene.events
        == EventRule.ALL
    )


@pytest.mark.parametrize("above", ["continue", "hold", "dry"])
@pytest.mark.parametrize("profile", ["log rough", "log smooth", "uniform", "still"])
def test_case_and_engine_read_the_same_water(profile: str, above: str) -> None:
    shear = (
        "tau_star = 0.3,"
        if profile.startswith("log")
        else "speed = '0.3 m/s',"
        if profile == "uniform"
        else ""
    )
    one = case(
        "{ kind = 'drop', height = '1 cm' }",
        water=f"{{ profile = '{profile}', {shear} zero = '0 m', depth = '2 cm', above = '{above}' }}",
    )
    water = build(one).scene.water
    numbers = parameters_of(build(one).scene)
    in_the_engine: Any = getattr(fluid.height_in_profile, "py_func", fluid.height_in_profile)  # for kernels
    for z in (-1e-3, 1e-5, 1e-3, 0.019, 0.03):
        height, there = in_the_engine(int(water.above), z, numbers[P.Z_ZERO], numbers[P.DEPTH])
        expected = there * evaluate(
            Profile(int(water.profile)), z=height, u_star=numbers[P.U_STAR], k_rough=numbers[P.K_ROUGH],
            nu=numbers[P.NU], speed=numbers[P.U_UNIFORM],
        )  # fmt: skip
        assert water_speed(one, derive(one), z) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    "law", ["24/Re+0.4", "24/Re+2", "constant", "Schiller-Naumann", "Ferguson-Church sand"]
)
def test_case_and_engine_read_the_same_drag(law: str) -> None:
    one = case("{ kind = 'drop', height = '1 cm' }", water=f"{{ profile = 'still', drag = '{law}' }}")
    made = build(one).scene
    for speed in (1e-4, 0.1, 1.0):
        c_d = drag_coefficient(one, drag.reynolds(speed, 0.002, 1e-6))
        expected = drag.drag_factor(speed, c_d, 1000.0, math.pi / 4, 0.002)
        wet = made.water
        found = drag_of(int(wet.drag), speed, 0.002, wet.nu, wet.rho_w, wet.a_2, wet.c_d)
        assert found == pytest.approx(expected)


def test_grains_of_a_packing_begin_with_the_speed_asked_for() -> None:
    state = build(case("{ kind = 'packing', columns = 4, layers = 2, speed = '1.5 m/s' }")).state
    assert np.all(state.v == [1.5, 0.0, 0.0])
