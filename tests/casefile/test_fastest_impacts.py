"""The largest overlaps that `ryusa check` expects, beside those that runs had (largest_overlaps.toml)."""

import math
import tomllib
from pathlib import Path

import pytest
from scipy.optimize import brentq

import ryusa
from ryusa.casefile import Case, derive, explain
from ryusa.casefile.contact import fastest_impacts
from ryusa.casefile.contact.fastest_impacts import (
    FALL,
    FLOW,
    LAYERS,
    MOVED,
    SETTLING,
    SLIDE,
    SURGE,
    Kind,
    heaviest_overlap,
    overlaps_expected,
)
from ryusa.casefile.read import read
from ryusa.casefile.trial import read_shortened
from ryusa.cases import case_path
from ryusa.laws import water

FOUND = tomllib.loads(Path(__file__).with_name("largest_overlaps.toml").read_text(encoding="utf-8"))
KINDS = {one.words: one for one in (FALL, FLOW, LAYERS, MOVED, SETTLING, SLIDE, SURGE)}


def given(name: str, **keys: str) -> Case:
    return read(case_path(f"{name}.toml"), {key.replace("__", "."): value for key, value in keys.items()})


def of_table(name: str) -> Case:
    """The case of an entry of the table."""
    return read(case_path(f"{FOUND[name].get('case', name)}.toml"), FOUND[name].get("set", {}))


def overlap_row(case: Case):
    (row,) = [one for one in explain(case) if one.name == "largest overlap/d"]
    return row


@pytest.mark.parametrize("name", FOUND)
def test_the_range_holds_what_a_run_of_the_case_had(name: str) -> None:
    case = of_table(name)
    low, high, _ = overlaps_expected(case, derive(case))
    assert 0.99 * low <= FOUND[name]["largest"] <= 1.01 * high


def test_the_factors_of_each_kind_are_the_extremes_of_its_cases() -> None:
    """Rounded outward to two digits, and as many cases as the kind says."""
    factors: dict[str, list[float]] = {words: [] for words in KINDS}
    cases: dict[str, set[str]] = {words: set() for words in KINDS}
    for name, found in FOUND.items():
        case = of_table(name)
        if name == "drop":
            continue
        derived = derive(case)
        speed, kind = fastest_impacts.fastest_impacts(case, derived)
        deep = found["largest"]
        reached = brentq(lambda v, of=(case, derived), deep=deep: heaviest_overlap(*of, v) - deep, 1e-9, 99.0)
        factors[kind.words].append(reached / speed)
        cases[kind.words].add(found.get("case", name))
    for words, kind in KINDS.items():
        assert kind.cases == len(cases[words])
        assert 0.0 <= min(factors[words]) - kind.least < 0.01
        assert 0.0 <= kind.most - max(factors[words]) < 0.01


def test_the_heaviest_grain_is_stopped_by_springs_over_the_smallest() -> None:
    case = given("heap", contact__restitution="1")
    derived = derive(case)
    heavy = derived.m * (derived.d_max / derived.d) ** 3
    expected = 0.3 * math.sqrt(heavy / derived.k_n) / derived.d_min  # (1/2) m v^2 = (1/2) k x^2
    assert heaviest_overlap(case, derived, 0.3) == pytest.approx(expected, rel=1e-9)


def test_grains_in_a_flow_hit_as_fast_as_its_water_lets_them() -> None:
    case = given("bedload_3d")
    derived = derive(case)
    speed, kind = fastest_impacts.fastest_impacts(case, derived)
    u = water.log_law_rough(1.25 * derived.d, derived.u_star, derived.k_rough)
    assert (speed, kind) == (pytest.approx(u), FLOW)
    row = overlap_row(case)
    assert row.shown == "0.0042 to 0.018" and row.flag == "note"
    assert "times 1.03 m/s, of the water where grains travel, as in runs of" in row.origin
    assert "may rise above the stable range 0.001 to 0.01" in row.origin


@pytest.mark.parametrize(
    ("stiffness", "words", "flag"),
    [
        ("1 N/cm", "above the stable range", "warning"),
        ("200 N/cm", "in the stable range", ""),
        ("1e5 N/cm", "below the range", "note"),
    ],
)
def test_a_range_has_a_verdict(stiffness: str, words: str, flag: str) -> None:
    row = overlap_row(given("heap", contact__stiffness=stiffness))
    assert words in row.origin and row.flag == flag


def test_grains_that_rest_deeper_than_they_hit_say_so() -> None:
    rows = {one.name: one for one in explain(given("settling_column", build__layers="900"))}
    assert rows["largest overlap/d"].value == rows["overlap/d at rest"].value > 0.01
    assert rows["largest overlap/d"].origin.startswith("more at rest than in impacts: above")


def test_a_kind_seen_in_few_cases_is_wider() -> None:
    assert Kind("any", 0.5, 0.8, 3).range == (0.5, 0.8)
    assert Kind("any", 0.6, 0.8, 2).range == (pytest.approx(0.4), pytest.approx(1.2))


def test_a_single_grain_that_falls_has_one_number() -> None:
    row = overlap_row(given("drop"))
    assert row.shown == "0.00617" and row.origin.startswith("impact at 0.443 m/s, free fall from")


@pytest.mark.full
@pytest.mark.parametrize("name", ["drop", "box", "saltation", "mill", "bedload_3d"])
def test_the_numbers_that_are_kept_can_be_had_again(name: str, tmp_path: Path) -> None:
    """How all of them were had; another processor rounds otherwise, and the extreme of a run with it."""
    path, end = case_path(f"{name}.toml"), FOUND[name].get("try")
    case = read(path) if end is None else read_shortened(path, {}, end)
    run = ryusa.run(case, tmp_path / "run", progress=False)
    assert run.summary["overlap"]["largest_over_d"] == pytest.approx(FOUND[name]["largest"], rel=0.3)
