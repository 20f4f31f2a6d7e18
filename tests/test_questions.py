"""Every packaged case is found by a question, and what a question tells to type and to read exists."""

import re
from pathlib import Path

from typer.testing import CliRunner

from ryusa.cases import case_files
from ryusa.cases.questions import QUESTIONS
from ryusa.catalogue import MEASURES, PICTURES
from ryusa.cli import app


def test_every_packaged_case_answers_a_question_and_no_other_is_named() -> None:
    named = [case for one in QUESTIONS for case in one.cases]
    assert sorted(named) == sorted(case_files())  # and each once


def test_commands_name_measures_and_pictures_that_exist() -> None:
    known = {one.name for one in (*MEASURES, *PICTURES)}
    words = [command.split() for one in QUESTIONS for command in one.commands]
    asked = [word[3] for word in words if word[:2] in (["ryusa", "measure"], ["ryusa", "draw"])]
    assert asked and set(asked) <= known
    commands = {name for word in words if word[0] == "ryusa" for name in word[1:2]}
    help_ = CliRunner().invoke(app, ["--help"]).output
    assert all(name in help_ for name in commands)


def test_every_question_leads_to_a_heading_of_a_page() -> None:
    docs = Path(__file__).parents[1] / "docs"
    for one in QUESTIONS:
        page, _, heading = one.page.partition("#")
        found = re.findall(r"^#+ (.+)$", (docs / page).read_text(encoding="utf-8"), re.MULTILINE)
        assert not heading or heading in {title.lower().replace(" ", "-") for title in found}, one.page


def test_new_without_a_name_lists_the_cases_by_question() -> None:
    shown = CliRunner().invoke(app, ["new"]).output
    for one in QUESTIONS:
        assert one.asked in shown
    assert all(name in shown for name in case_files())
    assert "paper/fig19" in shown
    assert shown.index("How fast does my hopper empty?") < shown.index("hopper  ")
    assert max(map(len, shown.splitlines())) <= 120


def test_words_of_the_trade_lead_to_cases() -> None:
    from ryusa.cases.questions import OTHER_WORDS

    assert set(OTHER_WORDS.values()) <= set(case_files()) and not set(OTHER_WORDS) & set(case_files())
    for word, case in (("lid", "shear_cell"), ("shear box", "direct_shear"), ("Jack", "shear_cell")):
        failed = CliRunner().invoke(app, ["new", word])
        assert failed.exit_code != 0 and f"Did you mean '{case}'?" in failed.output


def test_a_key_for_a_lid_is_answered_with_the_wall_that_is_one() -> None:
    import pytest

    from ryusa.casefile import read_text
    from ryusa.cases import case_path
    from ryusa.errors import CaseError

    text = case_path("drop.toml").read_text(encoding="utf-8")
    for key in ("lid", "jack"):
        with pytest.raises(CaseError, match="servo = ") as caught:
            read_text(f"{text}\n[{key}]\npressure = '1 kPa'\n")
        assert "docs/lids.md" in str(caught.value)
