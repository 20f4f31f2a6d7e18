"""[water.row]: what is refused and how, and the numbers of `ryusa check` against those known by hand."""

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ryusa.build import build
from ryusa.casefile import Case, derive, explain, read_text, resolved
from ryusa.errors import CaseError
from ryusa.laws.turbulence import speed_mean_rough
from ryusa.model.row import EndKind
from ryusa.results.scene_file import scene_digest

RIVER = """
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
[contact]
stiffness = "700 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
slope = "1/200"
[water]
profile = "column"
depth = "6 cm"
[water.column]
bed = "rough"
[water.row]
bottom = [["0 m", "0 cm"], ["2 m", "0 cm"], ["4 m", "-10 cm"]]
segments = 40
upstream = { end = "discharge", discharge = "0.03 m2/s" }
downstream = { end = "free fall" }
[[water.row.dams]]
name = "weir"
begin = "3 m"
end = "3.2 m"
height = "8 cm"
[build]
kind = "empty"
[stop]
time = "2 s"
[record]
frames = "0.1 s"
"""


@pytest.fixture
def river() -> Callable[..., Case]:
    """Read the river with keys set; None removes one."""
    return lambda **keys: read_text(RIVER, keys)


def shown(case: Case, name: str) -> float:
    """Value of a row of `ryusa check`."""
    return next(float(one.value) for one in explain(case) if one.name == name)


def test_check_gives_the_depths_of_uniform_and_critical_flow(river):
    case = river()
    assert shown(case, "critical depth") == pytest.approx(
        (0.03**2 / 9.80665 / math.cos(math.atan(1 / 200))) ** (1 / 3)
    )
    for where, slope in (("x = 0 to 2 m", 0.005), ("x = 2 to 4 m", None)):
        depth = shown(case, f"normal depth, {where}")
        angle = math.atan(slope) if slope is not None else math.atan(0.005) + math.atan(0.05)
        passed = depth * speed_mean_rough(depth, math.sqrt(9.80665 * depth * math.sin(angle)), 0.004)
        assert passed == pytest.approx(0.03, rel=1e-6)
        froude = 0.03 / math.sqrt(9.80665 * math.cos(angle) * depth**3)
        assert shown(case, f"Froude number, {where}") == pytest.approx(froude)
    assert shown(case, "energy head over 'weir'") == pytest.approx(1.5 * shown(case, "critical depth"))


@pytest.mark.parametrize(
    ("end", "said"),
    [
        ("3.1 m", "2 % less over 1 segment"),
        ("3.2 m", "4 % more over 2 segments"),
        ("3.98 m", "9 % more over 10 segments"),
    ],
)
def test_check_says_how_the_head_over_a_crest_differs_in_a_row(end, said):
    text = RIVER.replace('end = "3.2 m"', f'end = "{end}"')
    row = next(one for one in explain(read_text(text)) if one.name == "energy head over 'weir'")
    assert said in row.origin


AIR = {"water.row.pressure": "full", "water.row.dams.0.aerated": "true"}


def test_check_says_where_a_nappe_with_air_below_it_lands(river):
    """By 1.4 times the speed of critical flow, from the middle of the nappe to the floor."""
    case, q = river(**AIR), 0.03
    depth = 0.715 * shown(case, "critical depth")
    plan = build(case).scene.row
    assert plan is not None and plan.dams[0].aerated
    fall = plan.dams[0].crest + 0.5 * depth - plan.bottom[plan.dams[0].end]
    g = 9.80665 * math.cos(math.atan(1 / 200))
    assert shown(case, "nappe of 'weir' lands") == pytest.approx(q / depth * math.sqrt(2.0 * fall / g))
    assert not any("nappe" in one.name for one in explain(river(**{"water.row.pressure": "full"})))


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"water.row.pressure": "hydrostatic"}, 'needs water.row.pressure = "full"'),
        ({"water.row.dams.0.concentration": "0.5"}, "lets water through"),
        ({"water.row.dams.0.end": "4 m"}, "end = 'free fall' has air behind it"),
        ({"water.row.dams.0.end": "3.9 m"}, "beyond the end of the row, 0.1 m behind it: lengthen the row"),
        (
            {
                "water.row.upstream": None,
                "water.row.downstream": None,
                "water.row.bottom": "[['0 m', '0 m'], ['4 m', '0 m']]",
            },
            "has no place in a periodic row",
        ),
        (
            {
                "water.row.dams": "[{ name = 'a', begin = '3 m', end = '3.2 m', crest = '2 cm', aerated = "
                "true }, { name = 'b', begin = '3.2 m', end = '3.4 m', crest = '2 cm' }]"
            },
            "has no effect before dam 'b', which is as high",
        ),
    ],
)
def test_a_dam_behind_which_no_air_can_lie_is_refused(river, more, says):
    with pytest.raises(CaseError) as caught:
        river(**(AIR | more))
    lines = [one.line for one in (caught.value, *caught.value.others) if ".aerated" in one.line]
    assert any(says in line for line in lines), lines


def test_frames_fall_on_steps_and_the_step_keeps_the_courant_number(river):
    found = derive(river())
    assert 0.1 / found.dt == pytest.approx(round(0.1 / found.dt), abs=1e-9)
    assert 0.25 < shown(river(), "Courant number") <= 0.5


def test_a_discharge_may_be_that_of_the_whole_width(river):
    whole = 'upstream = { end = "discharge", discharge = "6 L/s" }\nwidth = "20 cm"'
    text = RIVER.replace('upstream = { end = "discharge", discharge = "0.03 m2/s" }', whole)
    row = build(read_text(text)).scene.row
    assert row is not None and row.upstream is not None
    assert row.upstream.discharge == pytest.approx(0.03, rel=1e-14)


def test_the_row_of_a_scene_is_what_the_case_says(river):
    row = build(river()).scene.row
    assert row is not None and row.upstream is not None and row.downstream is not None
    assert (row.n_segment, row.dx) == (40, pytest.approx(0.1))
    assert np.allclose(row.bottom, np.interp(row.x, [0.0, 2.0, 4.0], [0.0, 0.0, -0.1]))
    assert row.upstream.kind is EndKind.DISCHARGE and row.downstream.kind is EndKind.FREE_FALL
    assert np.flatnonzero(row.solid).tolist() == [30, 31]
    middle = float(np.interp(3.1, row.x, row.bottom))
    top = row.bottom[30:32] + row.solid[30:32] * row.column.dz
    assert np.abs(top - middle - 0.08).max() <= 0.5 * row.column.dz
    assert [(one.name, one.first, one.end) for one in row.dams] == [("weir", 30, 32)]


def test_a_porous_dam_has_the_resistance_of_its_grains(river):
    text = RIVER.replace('height = "8 cm"', 'height = "8 cm"\nconcentration = 0.6\ndiameter = "5 mm"')
    row = build(read_text(text)).scene.row
    assert row is not None and row.porous is not None and row.solid is None
    inside = row.porous.phi[30]
    assert inside[0] == 0.6 and inside[-1] == 0.0
    # Ergun per volume of mixture, with the speed in the pores: 150 nu phi^2/(eps d^2)
    assert row.porous.linear[30, 0] == pytest.approx(150.0 * 1e-6 * 0.6**2 / (0.4 * 0.005**2))


def test_the_bottom_may_be_a_file(tmp_path: Path):
    (tmp_path / "line.csv").write_text("# surveyed\nz [mm],x [cm]\n0,0\n0,200\n-100,400\n")
    text = RIVER.replace('[["0 m", "0 cm"], ["2 m", "0 cm"], ["4 m", "-10 cm"]]', '"line.csv"')
    case = read_text(text, path=tmp_path / "case.toml")
    assert scene_digest(build(case).scene) == scene_digest(build(read_text(RIVER)).scene)
    plain = json.loads(json.dumps(resolved(case)))
    assert plain["water"]["row"]["bottom"] == [[0.0, 0.0], [2.0, 0.0], [4.0, -0.1]]


BAD = [
    ({"water.row.bottom": '[["0 m", "0 cm"], ["1 m", "-40 cm"]]'}, "water.row.bottom", "21.8 deg"),
    ({"water.row.bottom": '[["0 m", "0 cm"], ["0 m", "-4 cm"]]'}, "water.row.bottom", "point 2"),
    ({"water.row.segment": "10 cm"}, "water.row.segments", "give one"),
    ({"water.row.upstream.end": "level"}, "water.row.upstream.level", "missing; end 'level' needs it"),
    ({"water.row.downstream.end": "discharge"}, "water.row.downstream.end", "only be given upstream"),
    ({"water.row.downstream.level": "5 cm"}, "water.row.downstream.level", "no effect with end 'free fall'"),
    ({"water.row.upstream.discharge": "6 L/s"}, "water.row.width", "missing"),
    ({"water.row.upstream.discharge": "6 m/s"}, "water.row.upstream.discharge", "0.03 m2/s"),
    ({"water.row.height": "7 cm"}, "water.row.height", "the depth to be expected"),
    ({"water.row.surface": '[["0 m", "1 cm"], ["4 m", "1 cm"]]'}, "water.depth", "excludes"),
    ({"water.column.bed": "moving"}, "water.column.bed", "'rough' or 'smooth'"),
    ({"water.column.drive": "tau_star"}, "water.column.drive", "water.row.upstream"),
    ({"water.column.surface": "depth"}, "water.column.surface", "'volume'"),
    ({"water.column.start": "steady"}, "water.column.start", "'rest'"),
    ({"water.buoyancy": "weight"}, "water.buoyancy", "'stress'"),
    ({"water.tau_star": "0.2"}, "water.tau_star", "leave it out"),
    ({"build.kind": "flume", "build.length": "40 cm", "build.layers": "2", "build.width": "2 cm"},
     "water.row.upstream", "has no place in a row with grains"),
]  # fmt: skip


@pytest.mark.parametrize(("keys", "key", "text"), BAD)
def test_what_a_row_cannot_be_is_refused_with_key_and_way_out(river, keys, key, text):
    with pytest.raises(CaseError) as caught:
        river(**keys)
    faults = (caught.value, *caught.value.others)
    assert any(one.key == key and text in one.line for one in faults), [one.line for one in faults]


def test_a_dam_thinner_than_a_segment_is_refused(river):
    text = RIVER.replace('end = "3.2 m"', 'end = "3.04 m"')
    with pytest.raises(CaseError, match="at least one segment thick"):
        read_text(text)


def test_a_dam_beyond_the_row_is_refused(river):
    with pytest.raises(CaseError, match=r"dams.0.end = '60 m'.*must lie in the row, 0 to"):
        read_text(RIVER.replace('end = "3.2 m"', 'end = "60 m"'))


def test_a_bottom_that_does_not_close_is_refused_without_ends(river):
    text = "\n".join(line for line in RIVER.splitlines() if not line.startswith(("upstream", "downstream")))
    with pytest.raises(CaseError, match="is periodic"):
        read_text(text)


DRY = RIVER.replace('depth = "6 cm"\n', "").replace(
    "segments = 40", 'segments = 40\nsurface = [["0 m", "-1 cm"], ["2 m", "6 cm"], ["4 m", "6 cm"]]'
)


def test_an_inlet_that_would_find_no_depth_in_a_dry_segment_is_refused():
    with pytest.raises(CaseError, match=r"^water.row.upstream.depth: missing.* is dry .*not supercritical"):
        read_text(DRY)
    with pytest.raises(CaseError, match=r"water.row.upstream.depth.*normal depth is less than a cell"):
        read_text(DRY, {"motion.slope": "1/5", "water.row.upstream.discharge": "'2 cm2/s'"})
    read_text(DRY, {"motion.slope": "1/20"})  # enters at normal depth
    read_text(DRY.replace('"0.03 m2/s" }', '"0.03 m2/s", depth = "8 cm" }'))


def test_a_normal_depth_of_less_than_a_cell_is_said(river):
    def said(**keys: str) -> list[str]:
        found = explain(river(**{"motion.slope": "1/5"} | keys))
        return [one.origin for one in found if one.name == "depth at the upper end" and one.flag == "note"]

    assert said() == []
    assert "less than a cell of 0.2 cm" in said(**{"water.row.upstream.discharge": "'2 cm2/s'"})[0]
    assert said(**{"water.row.upstream.discharge": "'2 cm2/s'", "water.row.upstream.depth": "'4 mm'"}) == []
    flood = "[{ at = '1 s', discharge = '2 cm2/s' }]"
    assert "normal depth of 0.0002 m2/s" in said(timeline=flood)[0]
