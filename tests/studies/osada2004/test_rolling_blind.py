"""The fit of a rolling coefficient to heaps in a wide box, the step it needs, and what is predicted blind."""

import math
from pathlib import Path

import pytest
from tests.studies.osada2004.test_heaps import heap

from ryusa.laws import rolling
from ryusa.study import Level, Outcome, Plan
from ryusa.study.registration import Registration
from ryusa_studies import osada2004
from ryusa_studies.osada2004 import rolling_blind as part
from ryusa_studies.osada2004._rolling_fit import HeapFit
from ryusa_studies.osada2004.rolling_friction import NONE, MeasuredFlow

QUICK, STANDARD = Plan(Level.QUICK, (1,)), Plan(Level.STANDARD, (1, 2, 3, 4))
TRIED = tuple(map(float, part.COEFFICIENTS))


def fit(slope):
    return HeapFit({mu_r: [slope(mu_r) + one for one in (-0.5, 0.5)] for mu_r in TRIED})


def test_the_fit_finds_the_coefficient_that_made_the_slopes():
    found = fit(lambda mu_r: 36.0 + 4.0 * math.log(mu_r))
    assert found.crossing(38.0) == pytest.approx(math.exp(0.5))
    assert found.chosen(38.0) == found.crossing(38.0) and not found.edge(38.0)
    place = math.log(math.exp(0.5) / 0.25) / math.log(8.0)
    assert place - 0.1 < min(found.places(38.0, 200)) < place < max(found.places(38.0, 200)) < place + 0.1


def test_where_heaps_get_no_steeper_the_edge_is_named_and_the_smallest_such_coefficient_taken():
    found = fit(lambda mu_r: min(33.0, 33.0 + 5.0 * math.log(mu_r)))  # level from 1 on
    assert math.isnan(found.crossing(38.0))
    assert found.chosen(38.0) == 1.0
    assert "upper edge of the box, mu_r 2" in found.edge(38.0) and "above 33 deg" in found.edge(38.0)
    steep = fit(lambda mu_r: 45.0 + mu_r)
    assert "lower edge of the box, mu_r 0.25" in steep.edge(38.0)
    assert steep.chosen(38.0) == 0.25


def test_a_coefficient_whose_heaps_all_stand_has_no_mean():
    found = HeapFit({**fit(lambda mu_r: 36.0 + 4.0 * math.log(mu_r)).slopes, 4.0: []})
    assert [one for one, _ in found.means] == [0.25, 0.5, 1.0, 2.0]
    assert found.crossing(38.0) == pytest.approx(math.exp(0.5))


@pytest.mark.parametrize("mu_r", [*part.COEFFICIENTS, NONE])
def test_every_step_keeps_the_springs_of_a_grain_with_six_partners_stable(mu_r):
    m, radius, k_n = 1.0, 1.0, 1.0
    contact = math.pi * math.sqrt(0.5 * m / k_n)  # of two free grains, the shortest
    dt = contact / float(part.steps(mu_r))
    if mu_r == NONE:
        assert part.steps(mu_r) == "10"
        return
    inertia = 0.4 * m * radius**2
    k_r = rolling.epsd_stiffness(k_n, float(mu_r) * rolling.reduced_radius(radius, radius), 2.25)
    about = rolling.inertia_rolling(m, radius, inertia, m, radius, inertia)
    limit = rolling.epsd_step(k_r, rolling.epsd_damping(k_r, about, 0.3), inertia, part.PARTNERS)
    assert dt < limit / 1.4
    assert (contact / 10.0 < limit) == (float(mu_r) < 0.7)  # with ten steps, as the first search had


def made(plan, slope=lambda mu_r: 36.0 + 4.0 * math.log(mu_r), spin=300.0, load=1.0, space=38.0):
    """What a study finds if every run gives these numbers."""
    result = {}
    for one in part.tasks(plan):
        seed, mu_r = int(one.get("seed")), float(one.get("rolling.coefficient") or 0.1)
        if one.case == "fig19":
            result[one] = heap((space if one.get("motion.plane") else slope(mu_r)) + 0.1 * (seed - 2.5))
        elif one.case == "saltation":
            result[one] = spin + seed
        elif one.case == "fig17":
            result[one] = MeasuredFlow(1.0, 1.0, math.nan, math.nan)
        else:
            result[one] = MeasuredFlow(1e-4, math.nan, load, 0.3)
    return result


def at_38(mu_r):
    """Slopes that cross 38 deg at the coefficient that is written into the study, for 30 deg."""
    return 38.0 + 4.0 * math.log(mu_r / float(part.FITTED["30 deg"]) * 1.001)


@pytest.mark.parametrize(
    ("missed", "n"), [({}, 0), ({"spin": 900.0}, 1), ({"load": 4.0}, 4), ({"space": 25.0}, 1)]
)
def test_a_coefficient_serves_if_every_part_holds(missed, n):
    (finding,) = part.judge(made(STANDARD, slope=at_38, **missed), STANDARD)
    assert finding.base_outcome is (Outcome.FAILS if missed else Outcome.HOLDS)
    assert sum(one.holds is False for one in finding.base) == n
    assert not any(one.judged for one in finding.beside) and len(finding.beside) == 8
    assert {one.choices[part.PHI] for one in finding.trials} == set(part.ANGLES)


def test_the_verdict_names_the_edge_where_no_coefficient_gives_the_slope():
    (finding,) = part.judge(made(STANDARD, slope=lambda mu_r: min(33.0, 33.0 + math.log(mu_r))), STANDARD)
    (place,) = [one for one in finding.base if one.part == part.PLACE]
    assert place.holds is False and "upper edge of the box, mu_r 2" in place.note
    assert "upper edge of the box" in finding.decided_by and "none of them" in finding.decided_by


def test_runs_have_the_laws_of_bed_load_and_the_water_keeps_its_interval():
    for one in part.tasks(STANDARD):
        if one.case != part.BED:
            continue
        case = one.read()
        water = case.water
        assert (water.lift, water.torque, water.column.fluctuations) == (
            "Wiberg-Smith",
            "Dennis",
            "random walk",
        )
        assert case.contact.restitution_shear == 1.0 and case.contact.cap == "total"
        steps = case.time.steps_per_contact
        assert water.column.interval == pytest.approx(3.3 * steps, abs=1.0)


def test_the_quick_level_is_one_short_run_of_each_kind():
    tasks = part.tasks(QUICK)
    assert [one.case for one in tasks] == ["fig19", "saltation", "fig17", part.BED, "fig17"]
    found = made(QUICK)
    (finding,) = part.judge(found, QUICK)
    assert {one.part for one in finding.trials} < {
        one.part for one in part.judge(made(STANDARD), STANDARD)[0].trials
    }
    assert part.rows(found, QUICK) and part.draw(found, QUICK)


def test_bands_factors_and_the_box_are_registered():
    registered = Registration.read(Path(osada2004.__file__).parent / "registration")
    found = made(STANDARD)
    (finding,) = part.judge(found, STANDARD)
    registered.check(finding)
    claim = registered.claims[finding.id]
    assert set(claim.factors) == set(finding.trials[0].choices)
    assert f"Box: mu_r {part.COEFFICIENTS[0]} to {part.COEFFICIENTS[-1]}" in claim.test
    assert set(part.FITTED) == set(part.ANGLES)
    assert part.rows(found, STANDARD) and part.draw(found, STANDARD)
