"""What `ryusa check` says of a column of water."""

import math
from collections.abc import Callable

import pytest

from ryusa.casefile import Case, read
from ryusa.casefile.column_rows import regime
from ryusa.casefile.explain import Row
from ryusa.laws import transport

CaseOf = Callable[..., Case]
PACKING = "{ kind = 'packing', columns = 5, layers = 3 }"
WATER = "{ profile = 'column', depth = '2 cm' }"
D_STAR = transport.d_star(1.65, 9.80665, 0.002, 1e-6)


def rows(case: Case) -> dict[str, Row]:
    return {row.name: row for row in case.explain()}


def flowing(case: CaseOf, water: str = WATER, **others: str) -> dict[str, Row]:
    given = {"build": PACKING, "water": water, "motion.slope": "1/20"}
    return rows(case(**(given | others)))


def test_the_numbers_of_flowing_water_are_explained(case: CaseOf) -> None:
    found = flowing(case)
    u_star = math.sqrt(9.80665 * 0.02 * math.sin(math.atan(0.05)))
    assert found["u_star"].value == pytest.approx(u_star)
    assert "steady flow" in found["u_star"].how
    assert found["Re_star"].value == pytest.approx(u_star * 0.002 / 1e-6)
    assert found["Rouse number"].value == pytest.approx(
        float(found["settling velocity"].value) / 0.41 / u_star
    )
    assert found["expected motion"].value == "bed load: rolling and saltation"
    assert found["depth"].shown == "2 cm"
    assert found["cell"].how == "100 in the depth"
    assert "50 steps" in found["coupling interval"].how
    assert "u_star of slope and depth" not in found  # the same number


def test_the_driver_is_named(case: CaseOf) -> None:
    for keys, part in (
        ("column = { drive = 'tau_star' }, tau_star = 1.0", "tau_star"),
        ("column = { drive = 'tau_star' }, u_star = '0.1 m/s'", "water.u_star"),
        ("column = { drive = 'discharge', discharge = '0.02 m2/s' }", "mean speed"),
        ("column = { drive = 'pressure gradient', pressure_gradient = '9 Pa/m' }", "dp/dx"),
    ):
        assert part in flowing(case, WATER.replace(" }", f", {keys} }}"))["u_star"].how
    still = flowing(case, **{"motion.slope": "0"})
    assert still["driver"].value == "none"
    assert "Rouse number" not in still


def test_a_slope_that_comes_later_is_the_one_explained(case: CaseOf) -> None:
    later = {"motion.slope": "0", "timeline": "[{ at = '0.05 s', slope = '1/20' }]"}
    found = flowing(case, **later)
    assert found["u_star"].value == flowing(case)["u_star"].value
    assert "timeline" in found["Re_star"].how


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
def test_the_motion_to_expect_follows_from_stress_and_settling(
    tau_star: float, rouse: float, words: str, why: str
) -> None:
    said, because = regime(tau_star, D_STAR, rouse)
    assert said == words
    assert why in because


@pytest.mark.parametrize("drag", ["none", "24/Re+0.4"])
@pytest.mark.parametrize("density", ["1000 kg/m3", "3000 kg/m3", "2650 kg/m3"])
def test_grains_that_float_or_feel_nothing_are_explained(case: CaseOf, drag: str, density: str) -> None:
    water = WATER.replace(" }", f", drag = '{drag}', density = '{density}' }}")
    assert ("expected motion" in flowing(case, water)) == (drag != "none" and density == "1000 kg/m3")


def test_the_shipped_columns_are_explained_without_a_warning(shipped) -> None:
    settling, bed = (read(shipped / f"{name}.toml") for name in ("settling_column", "movable_bed"))
    assert not [row for row in (*settling.explain(), *bed.explain()) if row.flag == "warning"]
    assert rows(settling)["hindrance exponent n"].value == pytest.approx(2.97, abs=0.01)
    assert rows(bed)["expected motion"].value == "bed load: rolling and saltation"
