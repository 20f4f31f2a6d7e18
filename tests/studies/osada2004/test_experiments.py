import pytest

from ryusa.errors import CaseError
from ryusa.study import CaseRun, Level, Plan, carry_out
from ryusa_studies.osada2004._parts import paper_run
from ryusa_studies.osada2004.claims import CLAIMS
from ryusa_studies.osada2004.study import NAMES, load


def faults_of(name, level):
    """What an experiment lacks at a level, and which of its cases cannot be read."""
    experiment = load(name)
    for part in ("FIGURE", "TITLE", "CLAIMS"):
        if not getattr(experiment, part):
            yield f"has no {part}"
    for claim in set(experiment.CLAIMS) - set(CLAIMS):
        yield f"judges {claim!r}, which is no claim"
    runs = list(dict.fromkeys(experiment.tasks(Plan(level, (1,)))))
    folders = [one.folder for one in runs]
    for folder in {one for one in folders if folders.count(one) > 1}:
        yield f"has two runs in {folder}"
    for one in runs:
        try:
            one.read()
        except Exception as error:
            yield f"{one.folder}: {error}"


def test_every_experiment_has_its_parts_and_its_cases_can_be_read():
    assert [
        f"{name}, {level.name.lower()}: {fault}"
        for name in NAMES
        for level in Level
        for fault in faults_of(name, level)
    ] == []


def test_every_claim_is_judged_once():
    judged = [claim for name in NAMES for claim in load(name).CLAIMS]
    assert sorted(judged) == sorted(CLAIMS)


def test_a_higher_level_runs_all_that_a_lower_one_runs():
    smaller = {"rolling_blind"}  # a heap and a bed take minutes each: quick has smaller ones of either
    for name in NAMES:
        quick, standard, full = (set(load(name).tasks(Plan(level, (1,)))) for level in Level)
        assert standard <= full, name
        assert (quick <= standard) == (name not in smaller), name


def test_an_unknown_experiment_is_named():
    with pytest.raises(CaseError, match="fig99"):
        load("fig99")


def test_variants_with_the_same_overrides_are_one_run_whatever_their_order():
    one = paper_run("saltation", {"motion.rotation": "free", "contact.stiffness": "1 N/cm"}, 2)
    other = paper_run("saltation", {"contact.stiffness": "1 N/cm", "motion.rotation": "free"}, 2)
    assert one == other
    assert one.folder == other.folder
    assert one != paper_run("saltation", {"contact.stiffness": "1 N/cm", "motion.rotation": "free"}, 3)
    assert CaseRun("saltation").folder.startswith("saltation/")


def test_a_study_without_runs_is_valid(tmp_path):
    found = carry_out({name: load(name).tasks(Plan()) for name in ()}, load, tmp_path)
    assert found.found == {}
    assert found.n_run == 0
