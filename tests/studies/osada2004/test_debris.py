"""Ito's debris flow: what is measured, and what follows from it; fig17, fig17-lock, fig17-free, fig18."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.study import Level, Outcome, Plan, carry_out
from ryusa.study.registration import Registration
from ryusa_studies.osada2004 import _debris, fig17, fig17_free, fig18, long_contacts
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._debris import AMOUNT, SHIPPED
from ryusa_studies.osada2004._debris_run import (
    NEAR_SURFACE,
    Debris,
    DebrisContacts,
    NearSurface,
    concentration,
)
from ryusa_studies.osada2004._parts import PARTING, PHI, START
from ryusa_studies.osada2004.study import load

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3, 4))
D = 0.00218


@dataclass(frozen=True)
class Fake(Debris):
    """A run of known numbers."""

    near_bed: float = 0.5
    speed: float = 1.0
    q: float = 0.004
    steep: float = 0.08
    drift: float = 1.0
    along: float = 0.03


def near(phi=0.3, thrown=3.0, between=0.005):
    """Layers near the surface that are alike."""
    return dict.fromkeys(NEAR_SURFACE, NearSurface(phi, thrown, between))


def flow(**changed):
    """A run that is all the paper says; what is changed is said."""
    contacts = {
        "all contacts": DebrisContacts(100, 7e-5, 7e-5, 0.7, 0.1, 0.003, 0.01),
        "two free grains": DebrisContacts(50, 6.6e-5, 6.6e-5, 0.66),
        "fixed grain": DebrisContacts(50, 7.4e-5, 7.4e-5, 0.74),
    }
    known = {
        "profile": None, "water": None, "depth": 0.0148, "near_surface": near(),
        "thirds": (0.4, 0.35, 0.3), "rms_z": 0.08, "rest": 0.0, "touching": 0.02, "contacts": contacts,
        "closed": {"fixed grain": (8e-5, 0.74)}, "companions": 0.1, "rods": 0.0, "null": 0.0,
        "spin": 100.0, "path": None,
    }  # fmt: skip
    return Fake(**(known | changed))


def verdicts(module, plan, of):
    """Claim -> finding where `of(variant)` gives the run."""
    found = {one: of(one) for one in module.tasks(plan)}
    return {one.id: one for one in module.judge(found, plan)}


def is_free(one):
    return one.get("motion.rotation") == "free"


def at_rest(one):
    return one.get("build.speed") == "0 m/s"


@pytest.mark.parametrize("plan", [QUICK, STANDARD])
def test_a_flow_as_described_in_the_paper_is_reproduced(plan):
    found = verdicts(fig17, plan, lambda one: flow())
    assert {claim: one.outcome for claim, one in found.items()} == dict.fromkeys(fig17.CLAIMS, Outcome.HOLDS)


@pytest.mark.parametrize("module", [fig17, fig17_free, fig18])
def test_every_setting_has_the_same_number_of_runs_and_the_design_holds_the_shipped_case(module):
    (finding, *_) = verdicts(module, STANDARD, lambda one: flow()).values()
    judged = [one for one in finding.trials if one.judged]
    assert {one.found.n for one in judged} == {4}
    sets = _debris.settings(STANDARD)
    assert sets[0] == SHIPPED
    assert len(sets) == 17
    assert len(_debris.settings(Plan(Level.FULL, (1,)))) == 33


@pytest.mark.parametrize("module", [fig17, fig17_free, fig18])
def test_nothing_is_judged_by_a_band_that_is_not_registered(module):
    registered = Registration.read(Path(fig17.__file__).with_name("registration"))
    for finding in verdicts(module, STANDARD, lambda one: flow()).values():
        registered.check(finding)
        varied = set(finding.trials[0].choices)
        assert varied == set(registered.claims[finding.id].factors)


def test_the_layer_that_is_called_near_the_surface_is_a_free_choice():
    thin = near() | {"uppermost diameter": NearSurface(0.16, 3.0, 0.005)}
    finding = verdicts(fig17, STANDARD, lambda one: flow(near_surface=thin))["fig17"]
    assert finding.base_outcome is Outcome.HOLDS
    assert (finding.robustness.holds, finding.robustness.of) == (17, 17)
    assert (finding.counts["holds"], finding.counts["fails"]) == (2 * 17, 17)
    assert finding.deciding is not None
    assert finding.deciding.choice == fig17.LAYER


def test_rare_collisions_near_the_surface_disagree_with_the_paper():
    rare = verdicts(fig17, STANDARD, lambda one: flow(near_surface=near(between=0.05)))
    assert rare["fig17"].base_outcome is Outcome.FAILS


def test_grains_in_parallel_layers_disagree_with_the_paper():
    flat = verdicts(fig17, STANDARD, lambda one: flow(near_surface=near(thrown=0.5)))
    assert flat["fig17"].base_outcome is Outcome.FAILS


def test_the_time_of_contacts_is_judged_by_the_band_set_before_any_number_and_swept_over_parting():
    assert (band("fig17-time", "mean contact time").low, band("fig17-time", "mean contact time").high) == (
        6.0e-5, 8.0e-5,
    )  # fmt: skip
    apart = {
        "all contacts": DebrisContacts(100, 6.3e-5, 6.3e-5, 0.8),
        "two free grains": DebrisContacts(50, 5.5e-5, 5.5e-5, 0.7),
        "fixed grain": DebrisContacts(50, 8.5e-5, 8.5e-5, 0.7),
    }
    found = verdicts(fig17, STANDARD, lambda one: flow(contacts=apart))
    assert found["fig17-time"].base_outcome is Outcome.HOLDS
    assert (found["fig17-time"].robustness.holds, found["fig17-time"].robustness.of) == (17, 17)
    assert found["fig17-time"].counts == {"holds": 17, "fails": 2 * 17, "undecided": 0}
    assert {one.choices[PARTING] for one in found["fig17-time"].trials} == {"no tension", "tension"}
    assert found["fig17-e"].base_outcome is Outcome.FAILS


def test_contacts_that_a_setting_lacks_decide_nothing():
    none = {name: DebrisContacts(0, math.nan, math.nan, math.nan) for name in flow().contacts}
    finding = verdicts(fig17, STANDARD, lambda one: flow(contacts=none) if at_rest(one) else flow())
    n = sum(one[START] == "at rest" for one in _debris.settings(STANDARD))
    assert finding["fig17-time"].robustness.undecided == n > 0
    assert finding["fig17-time"].counts["undecided"] == 3 * n


def test_locking_does_harm_where_it_makes_rods_a_deposit_or_lasting_contacts():
    for harm in ({"rods": 0.4}, {"rest": 0.3}, {"touching": 0.9}):
        found = verdicts(fig17_free, STANDARD, lambda one, h=harm: flow(**h))
        assert found["fig17-lock"].base_outcome is Outcome.FAILS
    assert verdicts(fig17_free, STANDARD, lambda one: flow())["fig17-lock"].base_outcome is Outcome.HOLDS


def test_grains_that_begin_at_rest_enter_the_test_of_locking():
    found = verdicts(fig17_free, STANDARD, lambda one: flow(rest=1.0) if at_rest(one) else flow())
    lock = found["fig17-lock"]
    resting = sum(one[START] == "at rest" for one in _debris.settings(STANDARD))
    assert lock.robustness.holds == 17 - resting
    assert resting >= 7
    assert lock.deciding is not None
    assert lock.deciding.choice == START
    assert any(f"friction angle {SHIPPED[PHI]}" in one for one in lock.also)


def test_no_interval_of_a_share_leaves_0_to_1():
    found = verdicts(
        fig17_free, STANDARD, lambda one: flow(rest=1.0 if one.get("seed") == "1" else 0.0, rods=0.0)
    )
    shares = [one.found for one in found["fig17-lock"].trials if one.judged]
    assert min(one.low for one in shares) == 0.0
    assert max(one.high for one in shares) == 1.0


def test_free_grains_must_be_faster_near_the_bed_carry_more_and_change_the_concentration():
    fast = {"near_bed": 1.2, "q": 0.008, "thirds": (0.3, 0.35, 0.3)}

    def judged(**changed):
        found = verdicts(fig17_free, STANDARD, lambda one: flow(**changed) if is_free(one) else flow())
        return found["fig17-free"]

    assert judged(**fast).base_outcome is Outcome.HOLDS
    assert judged(**{**fast, "thirds": flow().thirds}).base_outcome is Outcome.FAILS
    assert judged().base_outcome is Outcome.FAILS
    change = next(one for one in judged(**fast).trials if one.part == fig17_free.PROFILE)
    assert change.found.value == pytest.approx(0.4 / 0.3)
    assert change.halves == (True, True)


def test_free_grains_are_held_against_no_flow_that_stands():
    finding = verdicts(
        fig17_free, STANDARD, lambda one: flow(rest=1.0) if at_rest(one) and not is_free(one) else flow()
    )["fig17-free"]
    resting = sum(one[START] == "at rest" for one in _debris.settings(STANDARD))
    assert finding.robustness.undecided == resting
    assert any(one.note == fig17_free.STAND for one in finding.trials)


def test_long_contacts_must_correlate_speeds_and_damp_vertical_motion():
    def of(one):
        long = one.case == "fig18"
        return flow(companions=0.6, rms_z=0.06, steep=0.05) if long else flow()

    assert verdicts(fig18, STANDARD, of)["fig18"].base_outcome is Outcome.HOLDS
    assert verdicts(fig18, STANDARD, lambda one: flow())["fig18"].base_outcome is Outcome.FAILS


def test_the_water_can_decide_whether_long_contacts_do_what_the_sketch_says():
    def of(one):
        pores = one.get("water.column.pore_eddies") == "0.16"
        long = one.case == "fig18" and not pores
        return flow(companions=0.6, rms_z=0.06, steep=0.05) if long else flow()

    finding = verdicts(fig18, STANDARD, of)["fig18"]
    pores = sum(one["water"] == "eddies in pores, k_f 0.16" for one in _debris.settings(STANDARD))
    assert pores > 0
    assert finding.robustness.holds == 17 - pores
    shown = {one.part for one in finding.trials if not one.judged}
    assert shown == set(fig18.SHOWN)


def test_one_run_that_comes_to_rest_is_harm():
    found = verdicts(
        fig17_free,
        STANDARD,
        lambda one: flow(rest=1.0) if at_rest(one) and one.get("seed") == "3" else flow(),
    )
    still = [one for one in found["fig17-lock"].trials if one.note]
    assert {one.note for one in still} == {"1 of 4 runs come to rest"}
    assert {one.holds for one in still} == {False}
    assert {one.halves for one in still} == {(False, True)}
    assert {one.choices[START] for one in still} == {"at rest"}


def test_settings_near_their_stop_do_not_widen_the_intervals_of_others():
    def of(one):
        wild = {name: DebrisContacts(9, 1e-4 * int(one.get("seed")), 1e-4, 0.7) for name in flow().contacts}
        return flow(contacts=wild) if at_rest(one) else flow()

    base = verdicts(fig17, STANDARD, of)["fig17-time"].base
    assert all(one.found.low == one.found.high for one in base)


def test_longer_contacts_keep_the_restitution_of_the_paper_s_constants():
    long = _debris.DESIGN.base
    for times, chosen in (
        (30.0, long),
        (10.0, {**long, _debris.LONGER: "10"}),
        (3.0, {**long, _debris.LONGER: "3"}),
    ):
        once, longer = (one.read().contact for one in (_debris.run(SHIPPED, 1), fig18.run(chosen, 1)))
        for spring in ("stiffness", "shear_stiffness"):
            assert getattr(once, spring) / getattr(longer, spring) == pytest.approx(times**2, rel=1e-4)
        for dashpot in ("damping", "shear_damping"):
            assert getattr(once, dashpot) / getattr(longer, dashpot) == pytest.approx(times, rel=1e-4)


def test_layers_of_the_depth_are_cut_out_of_the_profile_exactly():
    thickness = 0.5 * D
    z = (np.arange(20) - 2 + 0.5) * thickness
    phi = SimpleNamespace(value=0.1 + 10.0 * z)  # linear in height
    v_x = SimpleNamespace(value=np.where((z > 0.0) & (z < D), 0.7, np.nan))
    profile = SimpleNamespace(z=z, thickness=thickness, d=D, phi=phi, v_x=v_x)
    one = replace(
        Debris(**{name: getattr(flow(), name) for name in Debris.__dataclass_fields__}), profile=profile
    )
    assert concentration(profile, 4 * D, 6 * D) == pytest.approx(0.1 + 10.0 * 5.0 * D)  # type: ignore[arg-type]
    assert concentration(profile, 5 * D, 6 * D) == pytest.approx(0.1 + 10.0 * 5.5 * D)  # type: ignore[arg-type]
    assert one.near_bed == pytest.approx(0.7)


def test_the_series_over_long_contacts_covers_every_flow_at_every_time_and_shares_runs_with_fig18():
    sets = long_contacts.settings(STANDARD)
    assert len(sets) == len(long_contacts.CLOSURES) * 4 + len(long_contacts.FALLS)
    shared = set(long_contacts.tasks(STANDARD)) & set(fig18.tasks(STANDARD))
    assert {one.get("seed") for one in shared} == {"1", "2", "3", "4"}
    assert len(shared) >= 4 * 4


@pytest.mark.slow
def test_a_short_run_of_the_real_scene_can_be_measured_and_drawn(tmp_path, monkeypatch):
    def short(case, overrides=None, seed=1):
        cut = {"stop.time": "0.3 s", "record.settle": "0.1 s"}
        return plain(case, {**(overrides or {}), **cut}, seed)

    plain = _debris.paper_run
    monkeypatch.setattr(_debris, "paper_run", short)
    monkeypatch.setattr(fig18, "paper_run", short)
    names = ("fig17", "fig17_free", "fig18", "long_contacts")
    campaign = carry_out({name: load(name).tasks(QUICK) for name in names}, load, tmp_path)
    assert not campaign.problems
    for name, module in zip(names, (fig17, fig17_free, fig18, long_contacts), strict=True):
        found = campaign.found[name]
        assert {one.id for one in module.judge(found, QUICK)} == set(module.CLAIMS)
        assert module.draw(found, QUICK)
        assert module.rows(found, QUICK)
    (base,) = [one for variant, one in campaign.found["fig17"].items() if not is_free(variant)]
    assert 0.2 < base.near_surface["upper third"].phi < 0.4
    assert 0.0 < base.near_surface["upper third"].between < 0.05
    assert 5.5e-5 < base.contacts["all contacts"].time < 9.0e-5
    assert base.touching < 0.2
    assert AMOUNT in SHIPPED
