from collections.abc import Callable

import pytest

from ryusa.casefile import Case, derive, estimate, explain
from ryusa.casefile.rows import ExplainRow

CaseOf = Callable[..., Case]
WATER = "{ profile = 'log rough', tau_star = 0.3, depth = '2 cm' }"
SALTATION = {"build": "{ kind = 'saltation' }", "water": WATER, "motion.slope": "1/20"}


def rows(case: Case) -> dict[str, ExplainRow]:
    return {row.name: row for row in explain(case)}


def warnings(case: Case) -> list[str]:
    return [f"{row.name} = {row.shown}: {row.origin}" for row in explain(case) if row.flag == "warning"]


def test_cohesion_is_shown_where_the_case_has_it(case: CaseOf) -> None:
    assert rows(case(**{"contact.cohesion": "'2 mN'"}))["cohesion c"].shown == "0.002 N"
    assert "cohesion c" not in rows(case())


def test_every_derived_number_is_explained(case: CaseOf) -> None:
    found = rows(case(**SALTATION))
    for name in (
        "mass m",
        "added mass",
        "normal stiffness k_n",
        "tangential stiffness k_s",
        "normal dashpot eta_n on a fixed grain",
        "normal dashpot eta_n between free grains",
        "restitution e on a fixed grain",
        "restitution e between free grains",
        "collision time on a fixed grain",
        "contact time between free grains",
        "dt",
        "steps per contact",
        "largest overlap/d",
        "travel per contact u t/d",
        "u_star",
        "tau_star",
        "grain Re",
        "tangential half period on a fixed grain",
        "disk for frames",
        "memory",
        "steps",
        "wall time",
    ):
        assert name in found, name
        assert found[name].origin
        assert found[name].shown


def test_values_are_in_si_and_printed_in_the_unit_of_the_case(case: CaseOf) -> None:
    row = rows(case())["normal stiffness k_n"]
    assert (row.value, row.unit, row.shown) == (1.0e4, "N/m", "100 N/cm")


@pytest.mark.parametrize(
    ("stiffness", "word", "flag"),
    [("1 N/cm", "above", "warning"), ("100 N/cm", "in the", ""), ("1e5 N/cm", "below", "note")],
)
def test_the_stable_band_has_a_verdict(case: CaseOf, stiffness: str, word: str, flag: str) -> None:
    row = rows(case(**{"contact.stiffness": stiffness}))["largest overlap/d"]
    assert word in row.origin
    assert row.flag == flag


def test_skimming_gives_a_warning(case: CaseOf) -> None:
    assert any(
        text.startswith("travel per contact u t/d")
        for text in warnings(case(**SALTATION, **{"contact.stiffness": "1 N/cm"}))
    )
    assert not warnings(case(**SALTATION))


def test_tangential_restitution_is_undefined_if_the_periods_differ(case: CaseOf) -> None:
    soft = rows(case(**{"contact.shear_ratio": "0.075"}))["tangential half period on a fixed grain"]
    assert "too different" in soft.origin
    matched = rows(case(**{"motion.rotation": "free"}))["tangential half period on a fixed grain"]
    assert "too different" not in matched.origin
    assert "1 times the collision time" in matched.origin


def test_few_steps_per_contact_give_a_warning(case: CaseOf) -> None:
    step = derive(case()).shortest / 7
    at_steps = {"contact.timing": "at steps", "time.step": f"{step} s"}
    assert any("ten" in text for text in warnings(case(**at_steps)))
    assert not any("ten" in text for text in warnings(case(**{"time.step": f"{step} s"})))


def test_a_step_near_the_largest_stable_one_gives_a_warning(case: CaseOf) -> None:
    keys = {"contact.shear_ratio": "10", "motion.rotation": "free"}
    assert not warnings(case(**keys))
    coarse = case(**keys, **{"time.steps_per_contact": "12"})
    row = rows(coarse)["largest stable step"]
    assert (row.flag, row.value) == ("warning", derive(coarse).step_limit)
    assert "tangential" in row.origin
    assert derive(coarse).dt > 0.5 * row.value


@pytest.mark.parametrize(("torque", "spin", "flag"), [("Dennis", 900, ""), ("Dennis", 1100, "warning")])
def test_an_initial_spin_beyond_the_range_of_dennis_gives_a_warning(
    case: CaseOf, torque: str, spin: int, flag: str
) -> None:
    one = case(
        water=f"{{ profile = 'still', torque = '{torque}' }}",
        build=f"{{ kind = 'drop', height = '1 cm', spin = '{spin} rad/s' }}",
        **{"motion.rotation": "free"},
    )
    row = rows(one)["rotational Re"]
    assert row.value == pytest.approx(spin * 4.0)
    assert row.flag == flag


def test_the_choice_of_contacts_to_record_is_printed(case: CaseOf) -> None:
    free = rows(case())["contacts recorded"]
    assert (free.value, free.flag) == ("all", "note")
    assert "not given" in free.origin
    asked = rows(case(**{"record.events": "none"}))
    assert (asked["contacts recorded"].value, asked["contacts recorded"].flag) == ("none", "")
    assert "disk for events" not in asked


def test_a_run_that_does_not_fit_on_the_disk_gives_a_warning(
    case: CaseOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = case()
    monkeypatch.setattr(estimate, "free_here", lambda: estimate.disk_in_all(one, derive(one)))
    assert "disk in all" not in rows(one)
    monkeypatch.setattr(
        estimate, "free_here", lambda: estimate.disk_needed(one, derive(one))
    )  # no room for events
    found = rows(one)["disk in all"]
    assert found.flag == "warning"
    assert found.value == estimate.disk_needed(one, derive(one)) + estimate.disk_for_events(one, derive(one))
