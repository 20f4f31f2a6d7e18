"""The paper's premise: what is filmed, and what follows from it."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ryusa.study import Level, Outcome, Plan, carry_out
from ryusa.study.registration import Registration
from ryusa_studies import osada2004
from ryusa_studies.osada2004 import _film, film
from ryusa_studies.osada2004._film import COLLISION, CUT, DESIGNS, FLOWS, FPS, RESOLUTION, SEEN, SLOWER
from ryusa_studies.osada2004.film import Filmed, FilmNumbers
from ryusa_studies.osada2004.study import load

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3, 4))
EPS = [float(one.removesuffix(" d")) for one in _film.RESOLUTIONS]


def filmed(mean=0.01, cut=0.0, slower=0.01):
    """A run whose contacts last `mean` [s] on the film that is judged, and `slower` [s] on slower films."""
    one = FilmNumbers(mean, 0.8 * mean, mean, 0.0, cut, 100, 1.5, 0.1)
    films = {(eps, FPS): one for eps in EPS} | {(EPS[0], fps): replace(one, mean=slower) for fps in SLOWER}
    return Filmed(films, np.full(100, mean), 1.0e-4, 0.1, 0.2, 0.002)


def verdicts(of, plan=STANDARD):
    """Claim -> finding where `of(task)` gives the run."""
    found = {one: of(one) for one in film.tasks(plan)}
    return {one.id: one for one in film.judge(found, plan)}


def stiff(one):
    return any("0.00001" in value or value in {"10000 N/cm", "20000 N/cm"} for _, value in one.overrides)


@pytest.mark.parametrize("plan", [QUICK, STANDARD])
@pytest.mark.parametrize(
    ("mean", "outcome"),
    [
        (0.01, Outcome.HOLDS), (0.0031, Outcome.HOLDS), (0.029, Outcome.HOLDS),
        (0.0029, Outcome.FAILS), (0.031, Outcome.FAILS),
    ],
)  # fmt: skip
def test_a_film_shows_what_the_paper_says_from_3_to_30_ms(plan, mean, outcome):
    found = verdicts(lambda one: filmed(mean), plan)
    assert {one.outcome for one in found.values()} == {outcome}
    assert set(found) == set(film.CLAIMS)


def test_the_springs_decide_if_only_the_softer_ones_show_it():
    for one in verdicts(lambda task: filmed(0.001 if stiff(task) else 0.01)).values():
        assert 0 < one.robustness.holds < one.robustness.of


def test_the_frames_of_a_slow_film_decide_nothing():
    for one in verdicts(lambda task: filmed(0.001, slower=0.01)).values():
        assert one.outcome is Outcome.FAILS
        assert {trial.part for trial in one.trials if trial.judged} == {film.PART}


def test_the_film_that_is_judged_can_show_less_than_the_band_and_slower_ones_cannot():
    assert SEEN.low / 2.0 > 1.0 / FPS
    assert all(1.0 / fps >= SEEN.low for fps in SLOWER)


def test_nothing_is_judged_where_too_many_contacts_are_cut_off():
    for one in verdicts(lambda task: filmed(0.01, cut=1.1 * CUT)).values():
        assert one.outcome is Outcome.UNDECIDED
        assert "22 % are cut off" in one.base[0].note
        assert math.isnan(one.base[0].found.value)


@pytest.mark.parametrize("claim", FLOWS)
def test_springs_are_100_times_as_stiff_and_nothing_else_differs(claim):
    base = DESIGNS[claim].base
    soft, hard = (
        film.run(claim, {**base, COLLISION: time}, 1).read()
        for time in _film.DESIGNS[claim].levels[COLLISION]
    )
    assert hard.contact.restitution == soft.contact.restitution == film.E

    def k_n(case):
        from ryusa.casefile.derive import derive

        found = derive(case)
        return np.array([found.k_n, found.k_s])

    np.testing.assert_allclose(k_n(hard) / k_n(soft), 100.0, rtol=1e-12)


def test_every_flow_is_filmed_at_every_level_of_its_factors_with_equal_samples():
    registered = Registration.read(Path(osada2004.__file__).parent / "registration")
    found = {one.id: one for one in film.judge({t: filmed() for t in film.tasks(STANDARD)}, STANDARD)}
    for claim in FLOWS:
        sets = film.settings(claim, STANDARD)
        assert sets[0] == DESIGNS[claim].base
        assert len(sets) == (16 if claim == "film-debris" else 17)  # two points fall on the same levels
        for name, levels in DESIGNS[claim].levels.items():
            assert {one[name] for one in sets} == set(levels)
        registered.check(found[claim])
        judged = [one for one in found[claim].trials if one.judged]
        assert set(judged[0].choices) == set(registered.claims[claim].factors)
        assert {one.choices[RESOLUTION] for one in judged} == set(_film.RESOLUTIONS)
        assert {one.found.n for one in judged} == {4}


def test_every_setting_of_every_flow_can_be_read():
    for claim in FLOWS:
        for one in film.settings(claim, STANDARD):
            assert film.run(claim, one, 1).read().record.events == "all"


def test_numbers_and_the_picture_follow_from_the_runs():
    found = {one: filmed() for one in film.tasks(STANDARD)}
    rows = film.rows(found, STANDARD)
    assert len(rows) == len(film.tasks(STANDARD)) * (len(EPS) + len(SLOWER))
    assert {row["mean"] for row in rows} == {0.01}
    assert set(film.draw(found, STANDARD)) == {"film"}


@pytest.mark.slow
def test_a_short_run_of_each_flow_can_be_filmed(tmp_path, monkeypatch):
    def short(case, overrides=None, seed=1):
        begin = float((overrides or {})["record.settle"].split()[0])
        return plain(case, {**(overrides or {}), "stop.time": f"{begin + 0.05:g} s"}, seed)

    plain = film.paper_run
    monkeypatch.setattr(film, "paper_run", short)
    campaign = carry_out({"film": film.tasks(QUICK)}, load, tmp_path)
    assert not campaign.problems
    found = campaign.found["film"]
    assert {one.id for one in film.judge(found, QUICK)} == set(film.CLAIMS)
    assert film.draw(found, QUICK)
    for one in found.values():
        base = one.film()
        assert base.mean >= 1.0 / FPS
        assert 5.0e-5 < one.collision < 2.0e-4
