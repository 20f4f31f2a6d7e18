"""Height of the cells of a row that a case does not name: jumps, backwater, closed basins."""

import pytest

import ryusa
from ryusa.casefile import read_text
from ryusa.casefile.row.values import critical_depth, highest_water, jumping, row_plan
from ryusa.errors import CaseError
from ryusa.laws.bore import conjugate_depth
from ryusa.results import schema

CASE = """
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
{slope}
[water]
profile = "column"
depth = "{depth}"
[water.column]
bed = "rough"
cell = "1 cm"
[water.row]
bottom = {bottom}
segment = "10 cm"
{ends}
[build]
kind = "empty"
[stop]
time = "{time}"
[record]
frames = "0.2 s"
"""
ENDS = """upstream = {{ end = "discharge", discharge = "{q} m2/s" }}
downstream = {{ {down} }}"""
WALLS = 'upstream = { end = "wall" }\ndownstream = { end = "wall" }'
JUMP = '[["0 m", "20 cm"], ["3 m", "0 cm"], ["6 m", "0 cm"]]'
FLAT = '[["0 m", "0 cm"], ["6 m", "0 cm"]]'
ADVERSE = '[["0 m", "0 cm"], ["3 m", "0 cm"], ["6 m", "3 cm"]]'
V = '[["0 m", "20 cm"], ["1 m", "0 cm"], ["2 m", "20 cm"]]'
FREE = 'end = "free fall"'


def row(bottom, ends=None, q="0.03", down=FREE, depth="3 cm", time="4 s", slope=""):
    text = CASE.format(
        bottom=bottom, ends=ends or ENDS.format(q=q, down=down), depth=depth, time=time, slope=slope
    )
    return read_text(text)


def test_a_jump_below_a_steep_reach_has_its_conjugate_depth():
    case = row(JUMP)
    (reach,), plan = jumping(case, 0.03), row_plan(case)
    # h/2 (sqrt(1 + 8 Fr^2) - 1) with h = 2.33 cm and Fr = 2.70: 7.8 cm
    assert conjugate_depth(reach.normal, reach.froude) == pytest.approx(0.078, abs=1e-3)
    assert plan.n_cell * plan.cell >= 1.5 * 0.078


@pytest.mark.parametrize(("down", "stands"), [(FREE, False), ('end = "level", level = "9 cm"', True)])
def test_a_steep_reach_alone_has_no_jump_but_one_before_a_level_has(down, stands):
    case = row('[["0 m", "20 cm"], ["3 m", "0 cm"]]', down=down)
    assert bool(jumping(case, 0.03)) == stands


def test_a_flat_reach_is_deeper_than_its_brink():
    case = row(FLAT)
    assert 1.2 < highest_water(case, row_plan(case)) / critical_depth(case, 0.03) < 1.8


def test_a_dam_ponds_to_its_crest_and_the_head_on_it():
    ends = ENDS.format(q="0.03", down=FREE)
    ends += '\ndams = [{ name = "weir", begin = "4 m", end = "4.2 m", height = "10 cm" }]'
    case = row(FLAT, ends)
    assert highest_water(case, row_plan(case)) == pytest.approx(
        0.10 + 1.5 * critical_depth(case, 0.03), rel=0.1
    )


def test_a_closed_basin_fills_to_the_level_of_its_volume():
    case = row(V, WALLS, depth="5 cm")
    # 2 m of 5 cm is 0.1 m2, and the V holds level^2/0.2: 14.1 cm
    assert highest_water(case, row_plan(case)) == pytest.approx((0.1 * 0.2) ** 0.5, rel=0.08)


def test_a_basin_that_a_discharge_fills_holds_what_has_entered_at_the_end():
    case = row(FLAT, down='end = "wall"', time="10 s")
    assert highest_water(case, row_plan(case)) == pytest.approx(0.03 + 0.03 * 10 / 6, rel=0.01)


RUNS = {
    "a jump": row(JUMP),
    "flat": row(FLAT),
    "adverse": row(ADVERSE),
    "a jump before a level": row('[["0 m", "20 cm"], ["3 m", "0 cm"]]', down='end = "level", level = "9 cm"'),
    "a V": row(V, WALLS, depth="5 cm"),
    "a basin that fills": row(FLAT, down='end = "wall"', q="0.02", time="6 s"),
    "tilted axes": row(FLAT, WALLS, slope="slope = 0.02"),
    "more water": row(JUMP, q="0.06", depth="4 cm"),
}


@pytest.mark.full
@pytest.mark.parametrize("kind", RUNS)
def test_the_water_stays_below_the_top_of_the_cells(kind, tmp_path):
    run = ryusa.run(RUNS[kind], tmp_path / "run", progress=False)
    assert run.status == schema.COMPLETE


def test_water_that_enters_over_a_dam_finds_room_over_its_crest():
    step = """
[[water.row.dams]]
name = "step"
begin = "0 m"
end = "2 m"
crest = "20 cm"
"""
    up = 'upstream = { end = "discharge", discharge = "0.03 m2/s", depth = "30 cm" }'
    case = row(FLAT, ends=f'{up}\ndownstream = {{ end = "level", level = "5 cm" }}{step}')
    plan = row_plan(case)
    assert plan.n_cell * plan.cell > 0.5

    ends = f'surface = [["0 m", "-1 cm"], ["6 m", "-1 cm"]]\n{ENDS.format(q="0.03", down=FREE)}'
    dry = CASE.format(bottom=FLAT, ends=ends + "{}", depth="-", time="4 s", slope="").replace(
        'depth = "-"\n', ""
    )
    with pytest.raises(CaseError, match="the first segment is dry"):
        read_text(dry.replace("{}", ""))
    read_text(dry.replace("{}", step))  # over the crest it enters at critical depth
