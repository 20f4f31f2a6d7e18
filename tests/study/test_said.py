"""Verdicts in words: what the case as it ships gives, and in how many of all settings the finding holds."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.study import Band, Finding, Outcome, Plan, Study, Trial, exact, over_range
from ryusa.study.entry import LedgerEntry, plain_entry
from ryusa.study.verdict import Count, held_of, settings_within
from ryusa.study.verdict_words import checks, said, tally

BAND = Band(1.0, 2.0, "m", "1 to 2 m")
VALUES = {True: (1.4, 1.5, 1.6), False: (2.9, 3.0, 3.1), None: (1.8, 2.0, 2.2)}


class Part:
    TITLE = "part"

    def tasks(self, plan: Plan):
        del plan
        return ()


class Mine(Study):
    """A study that varies free choices."""

    name = "mine"
    alone = "the only setting"

    def part(self, name):
        del name
        return Part()


def trial(held, choices, part="length"):
    return Trial(part, choices, over_range(VALUES[held], "m", "3 tries"), BAND)


def finding(*held, **more):
    """A finding that holds (True), fails (False) or is undecided (None) in one setting after the other."""
    return Finding("one", tuple(trial(one, {"run": f"{k:02d}"}) for k, one in enumerate(held)), **more)


def swept(with_it, without, **more):
    """A finding with settings at two levels of a choice; the first is the case as it ships."""
    held = [("in", one) for one in with_it] + [("out", one) for one in without]
    trials = [trial(one, {"phi": phi, "run": f"{k:02d}"}) for k, (phi, one) in enumerate(held)]
    return Finding("one", tuple(trials), **more)


def plain(found, tmp_path, study=None):
    return plain_entry(study or Mine(), LedgerEntry("one", "part", found), tmp_path)


SHIPPED = [
    ("bed18", [False, *[True] * 14, None, False], "though it holds in 14 of 17 settings (1 undecided)"),
    ("fig19-locked", [False] * 10 + [None] * 7, "and in none of 17 settings (7 undecided)"),
    ("fig18", [True] * 4 + [False] * 6 + [None] * 7, "in 4 of 17 settings (7 undecided)"),
    ("fig22", [True] * 4 + [False] * 5 + [None] * 8, "in 4 of 17 settings (8 undecided)"),
    ("steps", [True] * 5 + [False] * 9, "in 5 of 14 settings"),
    ("film-saltation", [False] * 17, "and in none of 17 settings"),
]


@pytest.mark.parametrize(("held", "share"), [one[1:] for one in SHIPPED], ids=[one[0] for one in SHIPPED])
def test_a_verdict_says_what_the_case_as_it_ships_gives_and_the_share_of_all_settings(held, share, tmp_path):
    found = plain(finding(*held), tmp_path)
    word = "holds" if held[0] else "fails"
    assert (found["outcome"], found["verdict"]) == (word, f"{word} as shipped, {share}")


def test_a_case_that_is_undecided_as_it_ships_is_called_so(tmp_path):
    found = plain(finding(None, True, True, False), tmp_path)
    assert found["verdict"] == "undecided as shipped; it holds in 2 of 4 settings (1 undecided)"


def test_a_claim_that_its_equations_exclude_has_its_share_too(tmp_path):
    found = plain(finding(True, False, contradiction="10 is no 100"), tmp_path)
    assert found["verdict"] == "excluded by its own equations; it holds in 1 of 2 settings"


def test_one_setting_is_called_the_only_one_where_a_study_varies_choices(tmp_path):
    assert plain(finding(True), tmp_path)["verdict"] == "holds as shipped, the only setting"

    class Fixed(Mine):
        """A study without free choices."""

        alone = ""

    assert plain(finding(True), tmp_path, Fixed())["verdict"] == "holds"
    assert plain(finding(True, False), tmp_path, Fixed())["verdict"] == "holds as shipped, in 1 of 2 settings"


def test_what_was_not_judged_says_so_and_what_is_shown_has_no_share(tmp_path):
    assert plain(None, tmp_path)["verdict"] == "undecided, no setting was judged"
    shown = Finding("one", (Trial("length", {}, exact(1.0, "m"), None),))
    assert plain(shown, tmp_path)["verdict"] == "shown"


def test_only_if_is_said_where_it_holds_in_most_settings_and_fails_in_all_others(tmp_path):
    found = swept([True] * 8, [False] * 8)
    assert found.outcome is Outcome.ONLY_IF
    assert plain(found, tmp_path)["verdict"] == (
        "holds as shipped, in 8 of 16 settings, only if phi in (8 of 8 settings, none of 8 others)"
    )


def doubtful(with_it, without):
    """A finding of which a choice decides among the settings that are decided."""
    found = swept(with_it, without)
    assert found.deciding is not None
    assert found.deciding.choice == "phi"
    return found


def test_only_if_is_not_said_of_a_case_that_is_undecided_as_it_ships(tmp_path):
    found = doubtful([None, *[True] * 8], [False] * 8)
    assert found.deciding.decides
    assert (found.outcome, found.condition) == (Outcome.UNDECIDED, "")
    words = plain(found, tmp_path)
    assert words["verdict"] == "undecided as shipped; it holds in 8 of 17 settings (1 undecided)"
    assert words["deciding_factor"]["words"] == "phi in (8 of 9 settings, 1 undecided; none of 8 others)"


def test_only_if_is_not_said_where_a_setting_without_the_levels_may_hold(tmp_path):
    found = doubtful([True] * 8, [*[False] * 8, None])
    assert found.outcome is Outcome.HOLDS
    assert plain(found, tmp_path)["verdict"] == "holds as shipped, in 8 of 17 settings (1 undecided)"
    assert found.deciding.in_words(["in", "out"]) == (
        "phi in (8 of 8 settings; none of 9 others, 1 undecided)"
    )
    more = swept([True] * 16, [*[False] * 15, True])
    assert more.outcome is found.outcome  # with more settings one of the others does hold


def test_undecided_settings_do_not_make_most_settings_hold():
    """Five that hold are all that are decided with the level, and five of eleven that were run."""
    assert doubtful([True] * 5 + [None] * 6, [False] * 10).outcome is Outcome.HOLDS
    assert doubtful([True] * 6 + [None] * 5, [False] * 10).outcome is Outcome.ONLY_IF


def read(held):
    """Trials of runs that are read in three ways, by setting."""
    return tuple(
        trial(one, {"run": f"{k:02d}", "pair": pair})
        for k, ways in enumerate(held)
        for pair, one in zip(("all", "free", "bed"), ways, strict=True)
    )


def test_readings_of_the_same_runs_are_counted_as_one_setting():
    """17 settings, 23 of whose readings hold: no share may have more than 17 settings."""
    held = [(True, True, False)] * 11 + [(True, None, False)] + [(None, None, None)] * 5
    found = Finding("one", read(held), readings=("pair",))
    assert sum(one is True for one in found.by_choice.values()) == 23
    one = found.deciding
    assert one is not None
    assert one.reading
    assert (one.inside, one.outside) == (Count(11, 17, 6), Count(0, 17, 5))
    assert one.in_words(found.tried(one)) == (
        "pair all or free (11 of 17 settings, 6 undecided; none of 17 read otherwise, 5 undecided)"
    )
    assert found.outcome is Outcome.HOLDS  # five readings otherwise are undecided


@given(
    st.lists(st.tuples(*[st.sampled_from([True, False, None])] * 3), min_size=1, max_size=9),
    st.sets(st.sampled_from(["all", "free", "bed"]), min_size=1, max_size=2),
    st.sampled_from([(), ("pair",)]),
)
def test_no_share_has_more_settings_than_were_run(held, levels, readings):
    found = Finding("one", read(held), readings=readings)
    for share in settings_within(found.by_choice, "pair", levels, readings):
        assert 0 <= share.holds <= share.of - share.undecided
        assert share.of <= len(found.by_setting)
    assert found.robustness.of == len(found.by_setting) == (len(held) if readings else 3 * len(held))


def test_trials_of_a_file_are_counted_as_those_of_a_finding(tmp_path):
    found = Finding("one", read([(True, None, False), (None, True, False)]), readings=("pair",))
    assert held_of(plain(found, tmp_path)["trials"]) == found.by_choice


@pytest.mark.parametrize(
    ("first", "words"),
    [
        ("fails", "; fails as first registered"),
        ("not judged", "; not judged as first registered"),
        ("holds", ""),
    ],
)
def test_a_verdict_says_what_the_bands_gave_as_they_were_registered_first(first, words, tmp_path):
    entry = {**plain(finding(True, False), tmp_path), "registered": {"first": first}}
    assert str(said(entry, str)) == f"holds as shipped, in 1 of 2 settings{words}"


def test_a_check_is_named_and_counted_beside_the_verdicts(tmp_path):
    check = {"registered": {"check": True}}
    entries = [
        plain(finding(True), tmp_path),
        {**plain(finding(True), tmp_path), **check},
        {**plain(finding(False), tmp_path), **check},
    ]
    assert str(said(entries[1], str)) == "holds (check)"
    assert str(said(entries[2], str)) == "fails (check)"
    assert tally(entries, lambda entry: said(entry, str)) == [(Outcome.HOLDS, "holds", 1, "")]
    assert checks(entries) == "2 checks, of which 1 fail"
    assert checks(entries[:1]) == ""


def test_findings_are_counted_by_what_ships_with_the_share_that_holds_in_most_settings(tmp_path):
    every = [
        finding(True, True, False),
        finding(True, False, None),
        finding(False, True, True),
        finding(None),
        swept([True] * 8, [False] * 8),  # half of the settings are not most of them
    ]
    entries = [plain(one, tmp_path) for one in every]
    counts = tally(entries, lambda entry: said(entry, str, "the only setting"))
    only = "holds as shipped, holds only if one choice is as named"
    assert counts == [
        (Outcome.HOLDS, "holds as shipped", 2, "1 holds in most settings"),
        (Outcome.ONLY_IF, only, 1, "none holds in most settings"),
        (Outcome.FAILS, "fails as shipped", 1, "1 holds in most settings"),
        (Outcome.UNDECIDED, "undecided as shipped", 1, ""),
    ]
