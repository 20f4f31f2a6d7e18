from ryusa_studies.osada2004._parts import PHI, SLIP
from ryusa_studies.osada2004.by_level import LevelCell, tables


def claim(name, outcomes, names=(PHI, SLIP), decides=None):
    trials = [
        {"choices": dict(zip(names, key, strict=True)), "outcome": word} for key, word in outcomes.items()
    ]
    return {"id": name, "trials": trials, "readings": [], "deciding_factor": decides and {"choice": decides}}


def test_a_cell_counts_the_settings_of_one_level():
    held = {
        ("30 deg", "spring"): "holds", ("30 deg", "total"): "fails",
        ("20 deg", "spring"): "undecided", ("20 deg", "total"): "fails",
    }  # fmt: skip
    phi, slip = tables([claim("heap", held, decides=SLIP)])
    assert (phi.choice, phi.levels) == (PHI, ("30 deg", "20 deg"))
    assert phi.rows[0].cells == (LevelCell(1, 2, 0), LevelCell(0, 2, 1))
    assert [one.look for one in phi.rows[0].cells] == ["partly", "no"]
    assert [one.look for one in slip.rows[0].cells] == ["partly", "no"]
    assert slip.rows[0].cells[0] == LevelCell(1, 2, 1)  # the other setting may fail
    assert (phi.rows[0].decides, slip.rows[0].decides) == (False, True)


def test_every_part_of_a_claim_that_is_judged_must_hold():
    one = claim("heap", {("30 deg", "spring"): "holds", ("20 deg", "spring"): "holds"})
    one["trials"] += [
        {"choices": one["trials"][0]["choices"], "outcome": "fails"},
        {"choices": one["trials"][1]["choices"], "outcome": "shown"},
    ]
    (phi,) = tables([one])
    assert phi.rows[0].cells == (LevelCell(0, 1), LevelCell(1, 1))


def test_a_second_reading_of_the_same_runs_is_not_counted():
    held = {("30 deg", "early"): "holds", ("30 deg", "late"): "fails", ("20 deg", "early"): "holds"}
    one = claim("flow", held, names=(PHI, "window")) | {"readings": ["window"]}
    (phi,) = tables([one])
    assert phi.rows[0].cells == (LevelCell(1, 1), LevelCell(1, 1))


def test_a_claim_for_which_a_choice_was_not_varied_is_left_out():
    still = claim("drop", {("30 deg", "spring"): "holds", ("30 deg", "total"): "fails"})
    varied = claim("heap", {("30 deg", "spring"): "holds", ("20 deg", "spring"): "fails"})
    phi, slip = tables([still, varied])
    assert [one.claim for one in phi.rows] == ["heap"]
    assert [one.claim for one in slip.rows] == ["drop"]
    assert tables([claim("a", {("1 m/s",): "holds"}, names=("impact speed",))]) == []
