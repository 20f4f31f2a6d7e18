"""A study in a folder of the user's own: the example of its page, end to end, and what is refused."""

import json
import re
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ryusa.cases import case_path
from ryusa.cli import app
from ryusa.errors import CaseError, ResultsError
from ryusa.study import Plan, case_run
from ryusa.study.means import means
from ryusa.study.user import open_study

PAGE = Path(__file__).parents[2] / "docs" / "study-of-your-own.md"
WHOLE = '"""A title."""\ndef tasks(plan):\n    return []\ndef measure(results, task):\n    return {}\n'


def call(*words):
    return CliRunner().invoke(app, ["study", *(str(word) for word in words)])


@pytest.fixture
def folder(tmp_path):
    """The folder that the page tells the reader to make."""
    made = tmp_path / "friction"
    made.mkdir()
    shutil.copy(case_path("saltation.toml"), made / "hop.toml")
    return made


def write(folder, *blocks):
    (folder / "study.py").write_text("\n".join(blocks), encoding="utf-8")


def blocks():
    return re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.full
def test_the_study_of_the_page_runs_and_gets_means_intervals_and_a_picture(folder, tmp_path):
    plain, judged = blocks()
    write(folder, plain)
    out = tmp_path / "out"
    first = call(folder, "--quick", "--seeds", 2, "-o", out, "-j", 1, "-q")
    assert first.exit_code == 0, first.output
    assert "2 shown" in first.stdout
    ledger = json.loads((out / "ledger-quick.json").read_text(encoding="utf-8"))
    length, height = ledger["findings"]
    assert (length["id"], height["id"]) == ("jump-length", "jump-height")
    assert [one["choices"]["contact.friction_angle"] for one in length["trials"]] == ["10 deg", "40 deg"]
    for one in length["trials"]:
        assert one["low"] < one["value"] < one["high"]
        assert (one["unit"], one["n"]) == ("m", 2)
    assert (out / "friction" / "friction.csv").read_text(encoding="utf-8").count("\n") == 5
    page = (out / "ledger-quick.html").read_text(encoding="utf-8")
    assert "<h1>How far a saltating grain hops at other friction angles</h1>" in page
    assert page.count("data:image/png;base64,") == 2
    assert "Indicative" not in page
    write(folder, plain.replace("friction angles.", "friction angles, judged."), judged)
    (tmp_path / "again").mkdir()
    moved = shutil.move(folder, tmp_path / "again" / "friction")  # a process reads a study's file once
    second = call(moved, "--quick", "--seeds", 2, "-o", out, "-j", 1, "-q")
    assert second.exit_code == 0, second.output
    ledger = json.loads((out / "ledger-quick.json").read_text(encoding="utf-8"))
    assert ledger["provenance"]["runs_opened"] == 4
    assert [one["id"] for one in ledger["findings"]] == ["shorter"]


def test_the_list_names_every_run_and_runs_nothing(folder, tmp_path):
    write(folder, blocks()[0])
    result = call(folder, "--list", "-o", tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert result.stdout.count("hop ") == 12
    assert "12 runs to make" in result.stdout
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (None, r"holds no Python file, but no study\.py"),
        (
            WHOLE.replace("tasks", "task"),
            r"no function tasks\(plan\)\. Did you mean 'task' to be 'tasks'",
        ),
        (WHOLE.replace("measure", "number"), r"has no function measure\(results, task\)"),
        (WHOLE.replace('"""A title."""', ""), "has no docstring"),
        (WHOLE + "1 / 0\n", "study.py: line 6: ZeroDivisionError"),
        (WHOLE + "def (\n", "study.py: line 6: SyntaxError"),
    ],
)
def test_a_folder_that_is_no_study_is_refused_with_what_is_expected(tmp_path, text, said):
    if text is not None:
        write(tmp_path, text)
    with pytest.raises(ResultsError, match=said):
        open_study(tmp_path)
    assert call(tmp_path).exit_code == 2


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(ResultsError, match="there is no such folder"):
        open_study(tmp_path / "nowhere")


def test_a_case_file_that_is_not_there_is_named_with_those_beside_it(folder):
    with pytest.raises(CaseError, match=r"holds hop\.toml\. Did you mean 'hop\.toml'"):
        case_run(folder / "hops.toml")
    write(folder, blocks()[0].replace("hop.toml", "hops.toml"))
    result = call(folder, "-o", folder.parent / "out")
    assert result.exit_code == 2
    assert "there is no such file" in result.output


def test_numbers_without_a_name_are_refused_with_the_run_they_came_from(folder):
    run = case_run(folder / "hop.toml", {"contact.friction_angle": "10 deg"}, seed=1)
    with pytest.raises(ResultsError, match=r"hop 10 deg 1: measure gave float .* needs numbers by name"):
        means({run: 0.1}, "a study")


def test_a_mean_is_taken_over_the_seeds_of_a_setting_alone(folder):
    found = {
        case_run(folder / "hop.toml", {"contact.friction_angle": angle}, seed=seed): {"length [cm]": value}
        for angle, values in (("10 deg", (1.0, 3.0)), ("20 deg", (5.0, 7.0)))
        for seed, value in enumerate(values, 1)
    }
    (one,) = means(found, "a study")
    assert [trial.found.value for trial in one.trials] == [2.0, 6.0]
    assert {trial.found.unit for trial in one.trials} == {"cm"}
    assert one.settings == {"case": "hop"}
    assert one.chart is not None
    assert list(one.chart.ours[0].x) == [10.0, 20.0]
    assert Plan().pick(1, 2) == 2


def test_a_case_file_that_was_edited_is_read_and_derived_anew(tmp_path):
    text = case_path("drop.toml").read_text(encoding="utf-8")
    own = tmp_path / "drop.toml"
    own.write_text(text, encoding="utf-8")
    before = case_run(own)
    steps = before.derive().dt
    assert before.read().stop.time == 0.3
    own.write_text(
        text.replace('time = "0.3 s"', 'time = "40 s"').replace('"100 N/cm"', '"400 N/cm"'), encoding="utf-8"
    )
    after = case_run(own)
    assert after == before
    assert after.read().stop.time == 40.0
    assert after.derive().dt == pytest.approx(0.5 * steps, rel=0.01)


def test_a_file_that_a_case_names_is_read_anew_once_it_was_edited(tmp_path):
    """A finished run among other files is not that of the case, and a bad file is not passed over."""
    own = tmp_path / "river.toml"
    text = case_path("weir.toml").read_text(encoding="utf-8")
    text = re.sub(r"(?m)^bottom = .*$", 'bottom = "line.csv"', text)
    own.write_text(re.sub(r'(?m)^time = "[^"]*"', 'time = "0.2 s"', text), encoding="utf-8")
    line = tmp_path / "line.csv"
    line.write_text("x [m],z [m]\n0,0.18\n3,0\n6,0\n", encoding="utf-8")
    run, folder = case_run(own), tmp_path / "run"
    assert run.make(folder).complete
    assert run.open(folder) is not None
    line.write_text("x [m],z [m]\n0,0.19\n3,0\n6,0\n", encoding="utf-8")
    assert run.open(folder) is None
    assert run.origin(folder) is None
    line.write_text("x [m],z [m]\n0,9\n3,0\n6,0\n", encoding="utf-8")
    with pytest.raises(CaseError, match="is inclined to the x axis"):
        run.read()
