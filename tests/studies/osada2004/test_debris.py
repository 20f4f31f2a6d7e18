"""Ito's debris flow: what is measured, and what follows from it; fig17, fig17-lock, fig17-free, fig18."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.studies.osada2004 import _debris, fig17, fig17_free, fig18
from ryusa.studies.osada2004._debris import Debris, DebrisContacts
from ryusa.studies.osada2004.study import load
from ryusa.study import Level, Outcome, Plan, carry_out

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3))
D = 0.00218


@dataclass(frozen=True)
class Fake(Debris):
    """A run of known numbers."""

    near_surface: float = 0.3
    topmost: float = 0.2
    near_bed: float = 0.5
    speed: float = 1.0
    q: float = 0.004
    steep: float = 0.08
    drift: float = 1.0


def flow(**changed):
    """A run that is all the paper says; what is changed is said."""
    contacts = {
        "all contacts": DebrisContacts(100, 7e-5, 7e-5, 0.7),
        "two free grains": DebrisContacts(50, 6.6e-5, 6.6e-5, 0.65),
    }
    contacts["fixed grain"] = DebrisContacts(50, 7.4e-5, 7.4e-5, 0.75)
    known = {
        "profile": None, "water": None, "depth": 0.0148, "thrown": 3.0, "rms_z": 0.08, "rest": 0.0,
        "contacts": contacts, "closed": {"fixed grain": (8e-5, 0.74)}, "companions": 0.1, "rods": 0.0,
        "null": 0.0, "path": None,
    }  # fmt: skip
    return Fake(**(known | changed))


def verdicts(module, plan, of):
    """Claim -> verdict where `of(variant)` gives the run."""
    found = {one: of(one) for one in module.tasks(plan)}
    return {one.id: one for one in module.judge(found, plan)}


def is_free(one):
    return one.get("motion.rotation") == "free"


@pytest.mark.parametrize("plan", [QUICK, STANDARD])
def test_a_flow_as_described_in_the_paper_is_reproduced(plan):
    found = verdicts(fig17, plan, lambda one: flow())
    assert {claim: one.outcome for claim, one in found.items()} == dict.fromkeys(fig17.CLAIMS, Outcome.HOLDS)


def test_the_number_of_grains_can_decide():
    found = verdicts(
        fig17, STANDARD, lambda one: flow(near_surface=0.15 if one.get("build.layers") == "3" else 0.3)
    )
    assert 0 < found["fig17"].robustness.holds < found["fig17"].robustness.of


def test_a_contact_time_that_no_kind_of_pair_has_is_not_reproduced():
    apart = {
        "all contacts": DebrisContacts(100, 6.3e-5, 6.3e-5, 0.7),
        "two free grains": DebrisContacts(50, 6e-5, 6e-5, 0.7),
        "fixed grain": DebrisContacts(50, 8e-5, 8e-5, 0.7),
    }
    found = verdicts(fig17, STANDARD, lambda one: flow(contacts=apart))
    assert found["fig17-time"].outcome is Outcome.FAILS
    assert found["fig17-e"].outcome is Outcome.HOLDS


def test_grains_in_parallel_layers_disagree_with_the_paper():
    assert verdicts(fig17, STANDARD, lambda one: flow(thrown=0.5))["fig17"].outcome is Outcome.FAILS


def test_locking_does_harm_where_it_makes_rods_or_a_deposit():
    for harm in ({"rods": 0.4}, {"rest": 0.3}):
        assert (
            verdicts(fig17_free, STANDARD, lambda one, h=harm: flow(**h))["fig17-lock"].outcome
            is Outcome.FAILS
        )
    assert verdicts(fig17_free, STANDARD, lambda one: flow())["fig17-lock"].outcome is Outcome.HOLDS


def test_free_grains_must_be_much_faster_near_the_bed_and_carry_more():
    fast = {"near_bed": 1.2, "q": 0.008}
    found = verdicts(fig17_free, STANDARD, lambda one: flow(**fast) if is_free(one) else flow())
    assert found["fig17-free"].outcome is Outcome.HOLDS
    assert verdicts(fig17_free, STANDARD, lambda one: flow())["fig17-free"].outcome is Outcome.FAILS


def test_long_contacts_must_correlate_speeds_and_damp_vertical_motion():
    def of(one):
        long = one.case == "fig18"
        return flow(companions=0.6, rms_z=0.06, steep=0.05) if long else flow()

    assert verdicts(fig18, STANDARD, of)["fig18"].outcome is Outcome.HOLDS
    assert verdicts(fig18, STANDARD, lambda one: flow())["fig18"].outcome is Outcome.FAILS


def test_longer_contacts_keep_the_restitution_of_the_paper_s_constants():
    once, longer = (
        variant.read().contact for variant in (fig18._short(fig18.SHIPPED, 1), fig18._run(fig18.SHIPPED, 1))
    )
    for spring in ("stiffness", "shear_stiffness"):
        assert getattr(once, spring) / getattr(longer, spring) == pytest.approx(900.0, rel=1e-4)
    for dashpot in ("damping", "shear_damping"):
        assert getattr(once, dashpot) / getattr(longer, dashpot) == pytest.approx(30.0, rel=1e-4)


def test_the_upper_third_and_the_lowest_diameter_are_cut_out_of_the_profile_exactly():
    thickness = 0.5 * D
    z = (np.arange(20) - 2 + 0.5) * thickness
    phi = SimpleNamespace(value=0.1 + 10.0 * z)  # linear in height
    v_x = SimpleNamespace(value=np.where((z > 0.0) & (z < D), 0.7, np.nan))
    profile = SimpleNamespace(z=z, thickness=thickness, d=D, phi=phi, v_x=v_x)
    one = replace(
        Debris(**{name: getattr(flow(), name) for name in Debris.__dataclass_fields__}), profile=profile,
        depth=6 * D,
    )  # fmt: skip
    assert one.near_surface == pytest.approx(0.1 + 10.0 * 5.0 * D)
    assert one.topmost == pytest.approx(0.1 + 10.0 * 5.5 * D)
    assert one.near_bed == pytest.approx(0.7)


@pytest.mark.slow
def test_a_short_run_of_the_real_scene_can_be_measured_and_drawn(tmp_path, monkeypatch):
    def short(case, overrides=None, seed=1):
        cut = {"stop.time": "0.3 s", "record.settle": "0.1 s"}
        return plain(case, {**(overrides or {}), **cut}, seed)

    plain = _debris.paper_run
    monkeypatch.setattr(_debris, "paper_run", short)
    monkeypatch.setattr(fig18, "paper_run", short)
    names = ("fig17", "fig17_free", "fig18")
    campaign = carry_out({name: load(name).tasks(QUICK) for name in names}, load, tmp_path)
    assert not campaign.problems
    for name, module in zip(names, (fig17, fig17_free, fig18), strict=True):
        found = campaign.found[name]
        assert {one.id for one in module.judge(found, QUICK)} == set(module.CLAIMS)
        assert module.draw(found, QUICK)
        assert module.rows(found, QUICK)
    (base,) = [one for variant, one in campaign.found["fig17"].items() if not is_free(variant)]
    assert 0.2 < base.near_surface < 0.4
    assert 5.5e-5 < base.contacts["all contacts"].time < 9.0e-5
