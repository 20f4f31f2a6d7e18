"""Every check, as far as it can be told without a long run; all of the quick level where slow tests run."""

import numpy as np
import pytest

from ryusa.study import CaseRun, Level, Outcome, Plan, Task, relative
from ryusa.study.executors import Processes
from ryusa.study.ledger import make
from ryusa_studies.validation import terminal_velocity
from ryusa_studies.validation.study import NAMES, VALIDATION, load
from ryusa_studies.validation.suspension import expected, exponent

LEVELS = tuple(Level)


@pytest.mark.parametrize("name", NAMES)
def test_a_check_names_its_runs_and_what_they_cost(name):
    check = load(name)
    assert check.TITLE
    for level in LEVELS:
        runs = check.tasks(Plan(level, (1, 2)))
        assert all(isinstance(one, Task) for one in runs)
        assert len({one.folder for one in runs}) == len(set(runs))
        assert all(one.cost() > 0.0 for one in runs)
        if any(isinstance(one, CaseRun) for one in runs):
            assert check.measure


def test_the_quick_level_takes_seconds():
    works = {one for name in NAMES for one in load(name).tasks(Plan(Level.QUICK, (1,)))}
    assert sum(one.cost() for one in works) < 260.0  # core seconds, by rule of thumb


def test_the_standard_level_takes_less_than_an_hour_and_a_half_on_two_cores():
    works = {one for name in NAMES for one in load(name).tasks(Plan(Level.STANDARD, (1, 2, 3)))}
    assert sum(one.cost_by_rule() for one in works) < 2 * 85 * 60.0  # core seconds


@pytest.mark.slow
def test_every_comparison_of_the_quick_level_is_within_tolerance(tmp_path):
    made = make(VALIDATION, None, Plan(Level.QUICK, (1,)), tmp_path, where=Processes(2))
    assert {
        one.id: one.outcome for one in made.entries if one.outcome not in (Outcome.HOLDS, Outcome.SHOWN)
    } == {}
    assert len({one.id for one in made.entries}) == len(made.entries)


@pytest.mark.parametrize(
    ("d", "schiller", "sphere", "sand"),
    [(1e-4, 0.0080, 0.0080, 0.0075), (1e-3, 0.1551, 0.1846, 0.1263), (6e-3, 0.5425, 0.5591, 0.3559)],
)
def test_roots_are_those_of_the_known_table(d, schiller, sphere, sand):
    laws = terminal_velocity.LAWS
    asked = {"Schiller-Naumann": schiller, "Ferguson-Church sphere": sphere, "Ferguson-Church sand": sand}
    for law, speed in asked.items():
        assert terminal_velocity.root(laws[law][1], d) == pytest.approx(speed, abs=6e-5)


@pytest.mark.parametrize(
    ("d", "speed"), [(0.25e-3, 0.0325), (0.5e-3, 0.0763), (1e-3, 0.1535), (2e-3, 0.2747)]
)
def test_the_fit_to_measured_spheres_gives_the_speeds_quoted_for_quartz(d, speed):
    assert terminal_velocity.gibbs(d, 2650.0, *terminal_velocity.WATER_20) == pytest.approx(speed, abs=6e-5)


@pytest.mark.parametrize(
    ("law", "stokes", "newton"),
    [("none", 2.0, 1.5), ("power 3.1", 5.1, 3.05), ("Wen-Yu", 4.65, 2.325), ("Di Felice", 4.7, 2.35)],
)
def test_exponents_are_those_of_the_table_in_hindrance(law, stokes, newton):
    assert exponent(law, "stokes", "stress") == pytest.approx(stokes)
    assert exponent(law, "newton", "stress") == pytest.approx(newton)


def test_a_bed_of_ergun_settles_the_same_under_both_forms():
    phi = np.array([0.3, 0.45])
    assert expected("Gidaspow", "newton", "stress", phi) == pytest.approx(
        expected("Gidaspow", "newton", "weight", phi)
    )


def test_without_a_reference_there_is_no_error():
    assert np.isnan(relative([], []))
    assert np.isnan(relative([1.0], [0.0]))
