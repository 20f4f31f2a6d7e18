"""Which test of a heap a case shows, and the refusal of a case that shows another."""

import pytest

from ryusa.campaigns.calibrate.heaps import OTHER, TESTS, read_test, refuse_other_test, shown_test
from ryusa.casefile import read
from ryusa.cases import case_path
from ryusa.errors import CaseError


@pytest.mark.parametrize(("test", "name"), [(test, name) for test, names in TESTS.items() for name in names])
def test_every_packaged_case_shows_the_test_that_it_is_named_for(test, name):
    case = read(case_path(f"{name}.toml"))
    assert shown_test(case) == test
    refuse_other_test("observations.0.test", test, case)


def test_a_case_without_feed_gate_or_lift_shows_none():
    assert shown_test(read(case_path("dense_plane.toml"))) is None


@pytest.mark.parametrize("measure", ["surface", "cone"])
def test_a_missing_test_is_asked_with_the_cases_that_show_each(measure):
    with pytest.raises(CaseError) as raised:
        read_test("observations.0.test", None, measure)
    said = str(raised.value)
    assert "observations.0.test: missing" in said
    for name in ("poured_heap", "lifted_cylinder", "gravel_heap", "heap", "column_collapse"):
        assert f"ryusa new {name}" in said
    assert "'poured in a plane' (a case of your own)" in said


def test_an_unknown_test_is_refused_with_the_nearest():
    with pytest.raises(CaseError, match="Did you mean 'poured in space'"):
        read_test("test", "poured in spce", "surface")


def test_a_measure_of_no_heap_needs_no_test():
    assert read_test("test", None, "discharge") == ""
    with pytest.raises(CaseError, match="of the measures surface, cone"):
        read_test("test", OTHER, "discharge")


def test_a_case_of_another_test_is_refused_with_the_cases_of_the_right_one():
    heap = read(case_path("heap.toml"))
    with pytest.raises(CaseError) as raised:
        refuse_other_test("observations.0.test", "lifted cylinder in space", heap)
    said = str(raised.value)
    assert "observations.0.test = 'lifted cylinder in space': heap.toml shows 'gate in a plane'" in said
    assert "ryusa new lifted_cylinder or ryusa new gravel_heap" in said
    refuse_other_test("observations.0.test", OTHER, heap)
