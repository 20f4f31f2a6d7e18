"""Which comparisons are run how often: every part has its line, and seeds give independent runs."""

import math

import pytest

from ryusa.study import Level, Plan
from ryusa_studies.validation.sampling import CLOSED, SAMPLING, sampling_lines, sampling_table
from ryusa_studies.validation.study import NAMES, load

FULL_ALONE = {
    "silo",
    "collapse",
    "channel_collapse",
    "gravel_heap",
    "drum",
    "plane_shear",
    "split_bottom",
    "frey/walls",
}  # comparisons that the standard level leaves out


def test_every_part_is_repeated_or_says_why_it_need_not_be():
    repeated = {name.partition("/")[0] for name in SAMPLING}
    assert repeated | set(CLOSED) == set(NAMES)
    assert not repeated & set(CLOSED)
    assert all(one.why for one in SAMPLING.values())
    assert all(CLOSED.values())


@pytest.mark.parametrize("name", NAMES)
def test_disjoint_seeds_share_no_run_unless_nothing_is_random(name):
    one, other = (set(load(name).tasks(Plan(Level.STANDARD, seeds))) for seeds in ((1, 2, 3), (4, 5, 6)))
    assert one == other if name in CLOSED else not one & other


@pytest.mark.parametrize("name", SAMPLING)
def test_every_seed_is_used_once(name):
    sampling = SAMPLING[name]
    for level in (Level.STANDARD, Level.FULL):
        seeds = sampling.seeds(Plan(level, (1, 2, 3)))
        assert len(set(seeds)) == len(seeds) == 3 * sampling.runs[level is Level.FULL]
    standard, full = (set(sampling.seeds(Plan(level, (1, 2)))) for level in (Level.STANDARD, Level.FULL))
    assert standard <= full
    assert sampling.seeds(Plan(Level.QUICK, (1,))) == (1,)


def test_no_comparison_is_judged_from_a_single_run():
    for name in SAMPLING:
        assert (name in FULL_ALONE) == (SAMPLING[name].runs[0] == 0)
        for level in (Level.FULL,) if name in FULL_ALONE else (Level.STANDARD, Level.FULL):
            assert len(SAMPLING[name].seeds(Plan(level, (1, 2, 3)))) >= 3


def test_the_full_level_is_no_shorter():
    for one in SAMPLING.values():
        lengths = [one.length(level) for level in (Level.STANDARD, Level.FULL)]
        assert one.time is None or lengths[0] <= lengths[1]
        assert one.time is not None or math.isnan(lengths[0])


def test_the_table_has_a_line_for_each():
    table = sampling_table()
    assert all(f"| {name} |" in table for name in SAMPLING)
    assert [one["name"] for one in sampling_lines(Level.FULL)] == list(SAMPLING)
    assert sampling_lines(Level.QUICK) == []
