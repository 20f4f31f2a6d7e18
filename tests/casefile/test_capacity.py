"""What `ryusa check` says of transport along a stream: Shields number, capacity, and when a dam is full."""

import math
import re
from typing import Any

import pytest

from ryusa.casefile import explain, read_text
from ryusa.casefile.explain import ExplainRow
from ryusa.laws.transport import solid_discharge_smart_jaeggi

S_0, P, Q, D, WIDTH = 0.08, 0.04, 0.05, 0.005, 0.05  # slope, dam [m], discharge [m2/s], diameter, width [m]
CASE = f"""
[grains]
diameter = "{D} m"
density = "2600 kg/m3"
[contact]
stiffness = "200 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
[water]
profile = "column"
depth = "2 cm"
hindrance = "Di Felice"
[water.column]
bed = "rough"
cell = "2.5 mm"
[water.row]
bottom = [["0 m", "{S_0 * 2.0} m"], ["2 m", "0 m"]]
segments = 100
width = "{WIDTH} m"
upstream = {{ end = "discharge", discharge = "{Q} m2/s" }}
downstream = {{ end = "free fall" }}
[[water.row.dams]]
name = "dam"
begin = "1.6 m"
end = "1.64 m"
crest = "{S_0 * 0.4 + P} m"
[build]
kind = "stream"
bed = "0 mm"
walls = false
[[feeds]]
name = "feeder"
low = ["2 cm", "0 cm", "22 cm"]
high = ["8 cm", "5 cm", "25 cm"]
rate = "RATE"
velocity = ["2 m/s", "0 m/s", "0 m/s"]
[[exits]]
name = "outlet"
point = ["2 m", "0 m", "0 m"]
normal = [1, 0, 0]
[stop]
time = "10 s"
[record]
frames = "50 ms"
events = "none"
"""


EXIT = "[{ name = 'outlet', point = ['2 m', '0 m', '0 m'], normal = [1, 0, 0] }]"


def rows(rate: str = "0.1 kg/s", more: dict[str, str] | None = None) -> dict[str, ExplainRow]:
    return {row.name: row for row in explain(read_text(CASE.replace("RATE", rate), more or {}))}


def value(found: dict[str, Any], begins: str) -> float:
    return next(row.value for name, row in found.items() if name.startswith(begins))


def test_capacity_is_that_of_the_formula_at_normal_depth() -> None:
    found = rows()
    depth = value(found, "normal depth")
    assert value(found, "Shields number") == pytest.approx(depth * math.sin(math.atan(S_0)) / (1.6 * D))
    tau_star = depth * S_0 / (1.6 * D)
    by_hand = 4.0 / 1.6 * Q * S_0**1.6 * (1.0 - 0.05 / tau_star)
    assert value(found, "capacity") == pytest.approx(by_hand)


def test_a_dam_is_full_when_the_wedge_below_the_slope_of_the_feed_is() -> None:
    """V = P**2/(2 (S_0 - S)) behind a dam P high on a plane bed; S carries the feed."""
    rate = 0.12  # kg/s
    found = rows(f"{rate} kg/s")
    slope = value(found, "slope of the deposit")
    brought = rate / 2600.0 / WIDTH  # m2/s
    again = rows(more={"water.row.bottom": f"[['0 m', '{slope * 2.0} m'], ['2 m', '0 m']]",
                       "water.row.dams": "[]"})  # fmt: skip
    assert value(again, "capacity") == pytest.approx(brought, rel=1e-6)
    assert 0.02 < slope < S_0
    packed = 0.61
    volume = P**2 / (2.0 * (S_0 - slope))
    assert value(found, "time to fill") == pytest.approx(volume * packed / brought, rel=2e-3)


def test_a_feed_beyond_the_formula_has_no_time_and_a_small_one_says_so() -> None:
    assert not [name for name in rows("2.5 kg/s") if name.startswith("time to fill")]
    small = rows("0.0005 kg/s", {"grains.diameter": "'1 mm'"})
    assert value(small, "slope of the deposit") == pytest.approx(0.005)
    assert "where the formula" in small["slope of the deposit behind 'dam'"].origin


def test_a_deposit_shorter_than_the_way_to_normal_flow_is_noted() -> None:
    short = rows("0.01 kg/s")["slope of the deposit behind 'dam'"]
    length, way = (
        float(re.search(rf"{word} ([0-9.]+) m", short.origin)[1]) for word in ("deposit is", "h/S =")
    )
    assert short.flag == "note"
    assert length < way
    assert length == pytest.approx(P / (S_0 - short.value), abs=0.5 * D / (S_0 - short.value) + 0.01)
    gentle = rows(
        "0.12 kg/s",
        {"water.row.dams": "[{ name = 'dam', begin = '1.7 m', end = '1.8 m', height = '20 cm' }]"},
    )
    assert "h/S" not in gentle["slope of the deposit behind 'dam'"].origin


def test_a_deposit_as_steep_as_the_bed_reaches_up_to_the_feed() -> None:
    found = rows()["capacity, x = 0 to 2 m"].value * 2600.0 * WIDTH
    assert "up to the feed" in rows(f"{found} kg/s")["time to fill 'dam'"].origin


def test_a_dam_that_is_full_at_the_start_says_so() -> None:
    found = rows(more={"build.bed": "'5 cm'", "build.begin": "'1 m'", "build.end": "'1.6 m'"})
    assert found["time to fill 'dam'"].value == "full"


def test_gentle_and_porous_reaches_and_light_grains_have_no_estimate() -> None:
    gentle = rows(more={"water.row.bottom": "[['0 m', '0.004 m'], ['2 m', '0 m']]", "water.row.dams": "[]",
                        "feeds": "[]", "build.bed": "'5 mm'"})  # fmt: skip
    assert gentle["capacity, x = 0 to 2 m"].value == "not known"
    light = rows(more={"grains.density": "'900 kg/m3'", "grains.buoyant": "true"})
    assert not [name for name in light if name.startswith(("capacity", "Shields number", "time to fill"))]


def test_nothing_moves_below_the_threshold() -> None:
    assert solid_discharge_smart_jaeggi(1.0, 0.01, 0.01, 2.65, 0.01, 1.0, 0.05) == 0.0


def test_walls_that_water_flows_through_are_named() -> None:
    own = "[{ name = 'sill', shape = 'rectangle', at = ['1 m', '0 m', '0 m'], " \
          "sides = [['0 m', '5 cm', '0 m'], ['0 m', '0 m', '9 cm']] }]"  # fmt: skip
    row = rows(more={"walls": own})["walls for grains alone"]
    assert row.value == "'sill'"
    assert row.flag == "note"
    assert "walls for grains alone" not in rows()


def test_side_walls_that_the_water_does_not_feel_are_named() -> None:
    row = rows(more={"build.walls": "true"})["side walls"]
    assert row.flag == "note" and "water.column.side_walls" in row.origin
    assert "side walls" not in rows(more={"build.walls": "false"})
    assert "side walls" not in rows(more={"build.walls": "true", "water.column.side_walls": "1 m"})


def test_a_bed_of_a_rounded_slope_has_its_capacity() -> None:
    assert math.tan(math.atan2(0.0075, 1.5)) < 0.005
    row = {"water.row.bottom": "[['0 m', '0.0075 m'], ['1.5 m', '0 m']]", "water.row.dams": "[]",
           "feeds": "[]", "build.bed": "'5 mm'", "exits": EXIT.replace("2 m", "1.5 m")}  # fmt: skip
    assert isinstance(rows(more=row)["capacity, x = 0 to 1.5 m"].value, float)


def test_feeds_whose_rate_is_not_all_of_it_have_no_estimate() -> None:
    back = rows(more={"exits": EXIT.replace("normal", "to = 'feeder', normal")})
    flood = rows(more={"timeline": "[{ at = '1 s', discharge = '0.1 m2/s' }]"})
    assert not [name for one in (back, flood) for name in one if name.startswith("time to fill")]
    assert flood["capacity, x = 0 to 2 m, at the peak"].value > flood["capacity, x = 0 to 2 m"].value


def test_a_feed_that_ends_before_the_dam_is_full_is_told() -> None:
    found = rows("0.02 kg/s")["time to fill 'dam'"]
    assert found.value > 10.0
    assert "the feed lasts 10 s" in found.origin
    assert found.flag == "note"
