from ryusa.studies.osada2004._parts import PHI, ROTATION
from ryusa.studies.osada2004.friction import FAILS, HOLDS, NONE, OPEN, SOME, by_angle, ranges


def claim(outcomes, settings=None, setup="", names=(PHI, "slip rule")):
    sweep = [
        {"choices": dict(zip(names, key, strict=True)), "outcome": word} for key, word in outcomes.items()
    ]
    return {"id": "fig19", "trials": sweep, "settings": settings or {}, "setup": setup, "statement": ""}


def test_a_cell_shows_the_shipped_setting_and_the_others():
    outcomes = {
        ("30 deg", "a"): "holds", ("5 deg", "a"): "fails",
        ("10 deg", "a"): "undecided", ("10 deg", "b"): "fails",
        ("40 deg", "a"): "fails", ("40 deg", "b"): "holds", ("50 deg", "b"): "fails",
    }  # fmt: skip
    angles, (line,) = by_angle([claim(outcomes, setup="a heap; rotation locked")])
    assert angles == ("5 deg", "10 deg", "30 deg", "40 deg", "50 deg")
    assert [one.word for one in line.cells] == [FAILS, OPEN, HOLDS, SOME, FAILS]
    assert [(one.n_holds, one.n) for one in line.cells] == [(0, 1), (0, 2), (1, 1), (1, 2), (0, 1)]
    assert line.rotation == "locked"
    assert line.holds == "30 deg to 40 deg"


def test_every_part_of_a_claim_must_hold():
    one = claim({("30 deg", "a"): "holds"})
    one["trials"].append({"choices": one["trials"][0]["choices"], "outcome": "fails"})
    _, (line,) = by_angle([one])
    assert line.cells[0].word == FAILS
    assert line.holds == "nowhere tried"


def test_rotation_as_a_choice_gives_a_line_each():
    outcomes = {("30 deg", "locked"): "holds", ("30 deg", "free"): "fails", ("20 deg", "free"): "holds"}
    _, lines = by_angle([claim(outcomes, names=(PHI, ROTATION))])
    assert [one.rotation for one in lines] == ["locked", "free"]
    assert [[one.word for one in line.cells] for line in lines] == [[NONE, HOLDS], [HOLDS, FAILS]]


def test_a_claim_without_a_friction_angle_is_left_out():
    angles, lines = by_angle([claim({("1 m/s", "a"): "holds"}, names=("impact speed", "slip rule"))])
    assert not angles
    assert not lines


def test_ranges_follow_what_was_tried():
    tried = ["5 deg", "10 deg", "20 deg", "30 deg"]
    assert ranges(tried, tried) == "everywhere tried (5 deg to 30 deg)"
    assert ranges(["30 deg", "5 deg", "10 deg"], tried) == "5 deg to 10 deg and 30 deg"
