"""What `ryusa check` says of the pressure of a row."""

import math

import pytest

from ryusa.casefile import explain, read
from ryusa.cases import case_path
from ryusa.errors import CaseError

LACKS = "hydrostatic, so without"
FINE = "segments in the head over a crest"


def said(name: str, row: str, **keys: str) -> tuple[str, str]:
    """Value and origin of a row of `ryusa check`, empty where there is none; of a packaged case."""
    given = {key.replace("__", "."): one for key, one in keys.items()}
    rows = [one for one in explain(read(case_path(f"{name}.toml"), given)) if one.name == row]
    return (str(rows[0].value), rows[0].origin) if rows else ("", "")


@pytest.mark.parametrize(
    ("name", "what", "why"),
    [
        ("weir", "bent flow", "over 'weir' on a crest 3 heads long; within about three depths of the free"),
        ("river", "bent flow, antidunes", "on a loose bed at a Froude number up to 1.9"),
        ("dam_break", "front", "from a step of 10 cm in the surface"),
        ("even_bed", "", ""),
    ],
)
def test_check_says_what_a_hydrostatic_pressure_lacks(name, what, why):
    value, origin = said(name, LACKS)
    assert value == what and why in origin
    assert said(name, LACKS, water__row__pressure="full") == ("", "")


def test_pores_that_fill_slowly_are_said_with_their_time():
    """0.05 H L/((1 - phi)^2 (sigma/rho - 1) g phi), L = 150 nu phi^2/((1 - phi) d^2) by Ergun [s]."""
    fine = {"grains__diameter": "0.2 mm", "water__column__cell": "0.2 mm", "water__row__width": "0.8 mm"}
    value, origin = said("dam_break", LACKS, **fine)
    phi, d, high, g = 0.53, 2e-4, 0.015, 9.80665
    drag = 150.0 * 1e-6 * phi / ((1.0 - phi) * d**2) * phi
    fills = 0.05 * high * drag / ((1.0 - phi) ** 2 * 0.58 * g * phi)
    assert value == "front, drainage sideways"
    assert f"take {fills:.2g} s to fill when it dilates by 5 %" in origin


def test_segments_that_do_not_resolve_a_crest_are_said():
    assert "take water.row.segment = 1.7 cm" in said("weir", FINE, water__row__pressure="full")[1]
    fine = {"water__row__pressure": "full", "water__row__segment": "1.25 cm"}
    assert said("weir", FINE, **fine) == ("", "")


def test_check_says_that_a_jet_over_gravel_wants_the_mixing_length_of_one():
    assert said("scour", "jet of 'weir'") == ("", "")
    value, origin = said("scour", "jet of 'weir'", water__column__mixing_length="Li-Sawamoto")
    assert value == "by Li-Sawamoto it spreads over its pool at once" and "'shear layer'" in origin
    assert said(
        "weir", "jet of 'weir'", water__row__pressure="full", water__row__dams__0__aerated="true"
    ) == ("", "")


def test_heads_and_nappes_below_a_hydrograph_are_those_of_its_peak():
    value, origin = said("scour", "energy head over 'weir', at the peak")
    q, g = 0.016, 9.80665
    assert float(value) == pytest.approx((q / ((2.0 / 3.0) ** 1.5 * math.sqrt(g))) ** (2.0 / 3.0), rel=1e-3)
    assert "critical flow" in origin
    assert 0.08 < float(said("scour", "nappe of 'weir' lands, at the peak")[0]) < 0.16


def test_the_mixing_length_of_a_jet_wants_a_row():
    with pytest.raises(
        CaseError, match=r"is that of jets and eddies in a row of columns: give \[water\.row\]"
    ):
        read(case_path("bedload_3d.toml"), {"water.column.mixing_length": "shear layer"})


def test_check_warns_of_segments_on_which_single_grains_drive_the_water():
    name = "grains side by side on a segment"
    narrow = {"water__row__width": "9.7 mm", "feeds__0__high__1": "9.7 mm"}
    value, origin = said("sabo_dam", name, **narrow)
    assert float(value) == pytest.approx(0.025 * 0.0097 / (0.25 * math.pi * 0.008**2))
    assert "eddies of single grains" in origin
    assert said("sabo_dam", name) == ("", "")
    assert said("sabo_dam", name, **narrow, water__column__fluctuations="none") == ("", "")
