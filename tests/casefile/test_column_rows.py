"""What `ryusa check` says of a column of water."""

import math
from collections.abc import Callable

import pytest

from ryusa.casefile import Case, derive, explain, read
from ryusa.casefile.column.rows import regime
from ryusa.casefile.rows import ExplainRow
from ryusa.cases import case_path
from ryusa.errors import CaseError
from ryusa.laws import transport
from ryusa.laws.turbulence import speed_mean_rough

CaseOf = Callable[..., Case]
PACKING = "{ kind = 'packing', columns = 5, layers = 3 }"
WATER = "{ profile = 'column', depth = '2 cm' }"
D_STAR = transport.d_star(1.65, 9.80665, 0.002, 1e-6)


def rows(case: Case) -> dict[str, ExplainRow]:
    return {row.name: row for row in explain(case)}


def flowing(case: CaseOf, water: str = WATER, **others: str) -> dict[str, ExplainRow]:
    given = {"build": PACKING, "water": water, "motion.slope": "1/20"}
    return rows(case(**(given | others)))


def test_every_exchange_with_the_column_takes_its_share_of_the_wall_time() -> None:
    # 0.1 s of the packaged bed load took 6.1 s longer with an exchange in every step, 9,461 more
    # exchanges, on a core that others shared
    brief = {"stop.time": "0.15 s", "record.settle": "0.05 s"}
    found = [
        rows(read(case_path("bedload_3d.toml"), {**brief, "water.column.interval": interval}))
        for interval in ("33", "1")
    ]
    seldom, always = (float(one["wall time"].value) for one in found)
    exchanges = float(found[0]["steps"].value) * (1.0 - 1.0 / 33.0)
    assert always - seldom == pytest.approx(exchanges * (2.0e-4 + 600 * 2.5e-7), rel=1e-3)
    assert 6.1 / 2.0 < always - seldom < 6.1
    assert always > 3.0 * seldom


def test_the_numbers_of_flowing_water_are_explained(case: CaseOf) -> None:
    found = flowing(case)
    u_star = math.sqrt(9.80665 * 0.02 * math.sin(math.atan(0.05)))
    assert found["u_star"].value == pytest.approx(u_star)
    assert "steady flow" in found["u_star"].origin
    assert found["Re_star"].value == pytest.approx(u_star * 0.002 / 1e-6)
    assert found["Rouse number"].value == pytest.approx(
        float(found["settling velocity"].value) / 0.41 / u_star
    )
    assert found["expected motion"].value == "bed load: rolling and saltation"
    assert found["depth"].shown == "2 cm"
    assert found["cell"].origin == "100 in the depth"
    assert "50 steps" in found["coupling interval"].origin
    assert "u_star of slope and depth" not in found  # the same number


def test_the_driver_is_named(case: CaseOf) -> None:
    for keys, part in (
        ("column = { drive = 'tau_star' }, tau_star = 1.0", "tau_star"),
        ("column = { drive = 'tau_star' }, u_star = '0.1 m/s'", "water.u_star"),
        ("column = { drive = 'discharge', discharge = '0.02 m2/s' }", "mean speed"),
        ("column = { drive = 'pressure gradient', pressure_gradient = '9 Pa/m' }", "dp/dx"),
    ):
        assert part in flowing(case, WATER.replace(" }", f", {keys} }}"))["u_star"].origin
    still = flowing(case, **{"motion.slope": "0"})
    assert still["driver"].value == "none"
    assert "Rouse number" not in still


def test_the_time_to_come_up_to_speed_is_held_against_the_settling_time(case: CaseOf) -> None:
    at_rest = WATER.replace(" }", ", column = { start = 'rest' } }")
    speed = speed_mean_rough(0.02, float(flowing(case)["u_star"].value), 0.002)
    whole = speed / (9.80665 * math.sin(math.atan(0.05)))  # U/(g S)
    found = flowing(case, at_rest)["time to come up to speed"]
    assert found.value == pytest.approx(math.atanh(0.95) * whole)
    assert found.flag == "warning" and "record.settle, 0 s, is shorter" in found.origin
    longer = {"record.settle": f"{1.01 * float(found.value)} s", "stop.time": "20 s"}
    assert flowing(case, at_rest, **longer)["time to come up to speed"].flag == ""
    tilted = {"timeline": "[{ at = '1 s', slope = '1/20' }]", "motion.slope": "0"}
    assert flowing(case, at_rest, **longer, **tilted)["time to come up to speed"].flag == "warning"
    begun = flowing(case)
    assert "time to come up to speed" not in begun
    assert begun["time to adapt"].value == pytest.approx(0.5 * whole)
    assert begun["time to adapt"].flag == "note"
    given = at_rest.replace("'rest'", "'rest', drive = 'discharge', discharge = '0.02 m2/s'")
    assert "time to come up to speed" not in flowing(case, given)
    viscous = at_rest.replace("'rest'", "'rest', mixing_length = 'none'")
    slowest = 4.0 * 0.02**2 / (math.pi**2 * 1e-6)
    found = flowing(case, viscous)["time to come up to speed"]
    assert found.value == pytest.approx(math.log(96.0 / math.pi**4 / 0.05) * slowest)


def test_a_slope_that_comes_later_is_the_one_explained(case: CaseOf) -> None:
    later = {"motion.slope": "0", "timeline": "[{ at = '0.05 s', slope = '1/20' }]"}
    found = flowing(case, **later)
    assert found["u_star"].value == flowing(case)["u_star"].value
    assert "timeline" in found["Re_star"].origin


@pytest.mark.parametrize(
    ("tau_star", "rouse", "words", "why"),
    [
        (0.03, 20.0, "no motion", "Soulsby & Whitehouse"),
        (0.3, 7.0, "bed load: rolling and saltation", "above 2.5"),
        (0.7, 4.0, "bed load: rolling and saltation, towards sheet flow", "Wilson"),
        (0.3, 2.0, "suspension near the bed", "below 2.5"),
        (0.3, 0.5, "suspension throughout the depth", "below 0.8"),
        (1.2, 3.0, "sheet flow", "Sumer"),
        (1.2, 0.5, "sheet flow with suspension throughout the depth", "below 0.8"),
    ],
)
def test_the_expected_motion_follows_from_stress_and_settling(
    tau_star: float, rouse: float, words: str, why: str
) -> None:
    said, because = regime(tau_star, D_STAR, rouse)
    assert said == words
    assert why in because


def test_where_the_moving_layer_fills_the_depth_it_is_a_debris_flow() -> None:
    said, because = regime(1.08, D_STAR, 4.0, layer=20.0, depth=6.8)
    assert said == "debris flow"
    assert "Egashira" in because
    assert regime(1.08, D_STAR, 4.0, layer=6.7, depth=6.8)[0] == "sheet flow"
    assert regime(0.03, D_STAR, 4.0, layer=math.inf, depth=6.8)[0] == "no motion"
    assert "without a limiting thickness" in regime(0.3, D_STAR, 4.0, layer=math.inf, depth=6.8)[1]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("bedload_3d", "bed load: rolling and saltation"),
        ("sheet_flow", "sheet flow"),
        ("debris_equilibrium", "debris flow"),
        ("paper/fig17", "debris flow"),  # as the paper calls it
        ("paper/fig22", "debris flow"),  # friction is that of the timeline's end, not of the settling
    ],
)
def test_the_packaged_flows_are_classified(name, words) -> None:
    assert rows(read(case_path(f"{name}.toml")))["expected motion"].value == words


@pytest.mark.parametrize("drag", ["none", "24/Re+0.4"])
@pytest.mark.parametrize("density", ["1000 kg/m3", "3000 kg/m3", "2650 kg/m3"])
def test_floating_grains_and_grains_without_drag_are_explained(case: CaseOf, drag: str, density: str) -> None:
    water = WATER.replace(" }", f", drag = '{drag}', density = '{density}' }}")
    found = flowing(case, water, **({"grains.buoyant": "true"} if density == "3000 kg/m3" else {}))
    assert ("expected motion" in found) == (drag != "none" and density == "1000 kg/m3")


def test_the_shipped_columns_are_explained_without_a_warning() -> None:
    settling, bed = (read(case_path(f"{name}.toml")) for name in ("settling_column", "movable_bed"))
    assert not [row for row in (*explain(settling), *explain(bed)) if row.flag == "warning"]
    assert rows(settling)["hindrance exponent n"].value == pytest.approx(2.97, abs=0.01)
    assert rows(bed)["expected motion"].value == "bed load: rolling and saltation"


FLUME = {"build": "{ kind = 'flume', length = '6 cm', width = '2 cm', layers = 6 }", "motion.plane": "false"}


def test_the_friction_velocity_is_that_of_the_water_over_a_loose_bed(case: CaseOf) -> None:
    # ten grains by thirty, six layers: their volume over the area, packed
    thick = 6 * 300 * math.pi / 6 * 0.002**3 / (0.06 * 0.02 * 0.6)
    deep = WATER.replace("2 cm", "3 cm").replace(" }", ", zero = '0 cm', column = { packed = 0.6 } }")
    found = flowing(case, deep, **FLUME)
    assert found["bed thickness"].value == pytest.approx(thick)
    assert found["water over the bed"].value == pytest.approx(0.03 - thick)
    square = 9.80665 * (0.03 - thick) * math.sin(math.atan(0.05))
    assert found["u_star"].value == pytest.approx(math.sqrt(square))
    assert found["tau_star"].value == pytest.approx(square / (1.65 * 9.80665 * 0.002))
    assert "above the bed" in found["u_star"].origin
    from_top = flowing(case, WATER.replace(" }", ", column = { packed = 0.6 } }"), **FLUME)
    assert from_top["water over the bed"].value == 0.02


def test_a_stress_prescribed_below_the_top_of_the_bed_is_smaller_at_the_top(case: CaseOf) -> None:
    thick = 6 * 300 * math.pi / 6 * 0.002**3 / (0.06 * 0.02 * 0.6)
    column = "column = { packed = 0.6, drive = 'tau_star' } }"
    asked = WATER.replace("2 cm", "3 cm").replace(" }", f", zero = '0 cm', tau_star = 0.5, {column}")
    found = flowing(case, asked, **FLUME, **{"motion.slope": "0"})
    over = (0.03 - thick) / 0.03  # a pressure gradient alone: the stress falls evenly to the surface
    assert found["tau_star"].value == pytest.approx(0.5 * over)
    assert "at the top of the bed" in found["u_star"].origin


def test_a_stress_within_half_a_grain_of_slope_and_depth_agrees(case: CaseOf) -> None:
    thick = 6 * 300 * math.pi / 6 * 0.002**3 / (0.06 * 0.02 * 0.6)
    for off, agrees in ((-0.9, True), (0.9, True), (2.0, False)):
        tau_star = (0.03 - thick + off * 0.001) * math.sin(math.atan(0.05)) / (1.65 * 0.002)
        more = f", zero = '0 cm', tau_star = {tau_star}, column = {{ packed = 0.6 }} }}"
        water = WATER.replace("2 cm", "3 cm").replace(" }", more)
        if agrees:
            assert flowing(case, water, **FLUME)["tau_star"].value == pytest.approx(tau_star)
        else:
            with pytest.raises(CaseError, match="give or take half a grain"):
                flowing(case, water, **FLUME)


def test_fluctuations_have_a_row_where_the_case_has_them(case: CaseOf) -> None:
    walked = flowing(case, WATER.replace(" }", ", column = { fluctuations = 'random walk' } }"))
    assert walked["fluctuations"].value == walked["u_star"].value
    assert "fluctuations" not in flowing(case)


def test_still_water_may_end_in_the_bed(case: CaseOf) -> None:
    shallow = WATER.replace("2 cm", "0.9 cm").replace(" }", ", zero = '0 cm' }")
    found = flowing(case, shallow, **FLUME, **{"motion.slope": "0"})
    assert found["water over the bed"].flag == "note"
    assert found["driver"].value == "none"


@pytest.mark.parametrize(
    ("name", "tau_star", "n"),
    [("bedload_3d", 0.2, 600), ("sheet_flow", 1.0, 650), ("debris_equilibrium", 0.4, 630)],
)
def test_packaged_flows_in_three_dimensions_state_their_stress(name, tau_star, n) -> None:
    found = read(case_path(f"{name}.toml"))
    assert derive(found).n_grain == n
    assert rows(found)["tau_star"].value == pytest.approx(tau_star, rel=0.06)
    assert rows(found)["overlap/d at rest"].flag != "warning"
