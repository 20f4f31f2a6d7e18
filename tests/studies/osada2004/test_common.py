from dataclasses import replace

from ryusa.studies.osada2004._parts import PHI, SLIP
from ryusa.studies.osada2004.common import common
from ryusa.study import Band, Finding, Trial, over_seeds

WANTED = Band(0.5, 1.5, "-", "about one")


def found(claim, outcomes, name="slip rule"):
    """Build a finding from {(phi, other): holds}."""
    numbers = {True: 1.0, False: 9.0, None: float("nan")}
    trials = [
        Trial(
            "part", {PHI: phi, **({name: other} if other else {})}, over_seeds([numbers[held]], "-"), WANTED
        )
        for (phi, other), held in outcomes.items()
    ]
    return Finding(claim, tuple(trials), "physics")


def test_the_best_set_is_the_one_known_by_hand():
    slips = {("10", "a"): True, ("20", "a"): True, ("10", "b"): False, ("20", "b"): True}
    findings = [
        ("one", found("fig4", slips)),
        (
            "two",
            found("fig5", {("10", "a"): False, ("20", "a"): False, ("20", "b"): True, ("10", "b"): None}),
        ),
        ("three", found("fig7", {("10", ""): True, ("20", ""): True})),
        ("four", found("fig8", {("10", ""): False, ("20", ""): False})),
    ]
    sets = common([one for _, one in findings])
    assert len(sets) == 4
    best = sets[0]
    assert dict(best.choices) == {PHI: "20", "slip rule": "b"}
    assert best.holds == ("fig4", "fig5", "fig7")
    assert best.fails == ("fig8",)
    assert not best.undecided
    worst = sets[-1]
    assert dict(worst.choices) == {PHI: "10", "slip rule": "b"}
    assert worst.undecided == ("fig5",)


def test_a_choice_of_one_experiment_alone_stays_free_for_its_claim():
    findings = [
        ("one", found("fig10-soft", {("10", "1 mm/s"): False, ("10", "9 mm/s"): True}, "threshold")),
        ("two", found("fig14", {("10", ""): True, ("20", ""): True})),
    ]
    sets = common([one for _, one in findings])
    assert [dict(one.choices) for one in sets] == [{PHI: "10"}, {PHI: "20"}]
    assert sets[0].holds == ("fig10-soft", "fig14")
    assert sets[1].untried == ("fig10-soft",)


def test_a_claim_that_its_own_equations_exclude_never_counts():
    good = found("fig12", {("10", ""): True})
    excluded = Finding("fig12", good.trials, "physics", contradiction="10 is less than 100")
    sets = common([excluded, found("fig14", {("10", ""): True})])
    assert sets[0].holds == ("fig14",)
    assert sets[0].fails == ("fig12",)


def test_claims_that_need_different_friction_do_not_hold_together():
    sets = common([found("fig4", {("10", ""): True}), found("fig5", {("20", ""): True})])
    assert [one.holds for one in sets] == [("fig4",), ("fig5",)]
    assert [one.untried for one in sets] == [("fig5",), ("fig4",)]


def test_runs_with_one_slip_rule_do_not_count_for_another():
    varied = found("fig4", {("10", "spring"): True, ("10", "total"): True}, SLIP)
    fixed = replace(found("fig5", {("10", ""): True}), settings={SLIP: "spring"})
    sets = {one.choices[SLIP]: one for one in common([varied, fixed])}
    assert sets["spring"].holds == ("fig4", "fig5")
    assert sets["total"].untried == ("fig5",)
