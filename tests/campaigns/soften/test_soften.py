"""`ryusa soften` and `ryusa.soften`, on a case of seconds."""

import csv
import json
import re
import shutil

import pytest
from tests.measure.test_numbers_of_the_catalogue import RUNS as ELSEWHERE
from typer.testing import CliRunner

import ryusa
from ryusa.campaigns.calibrate.study_file import _refuse_quantity
from ryusa.campaigns.soften import Answer, study_of
from ryusa.cases import case_path
from ryusa.catalogue import MEASURES, load
from ryusa.cli import app
from ryusa.errors import CaseError

SHORT = {"stop.saltations": "5", "record.settle": "0.1 s", "build.starts": "2"}
SET = [word for key, value in SHORT.items() for word in ("--set", f"{key}={value}")]
MEASURE = ("--measure", "saltation", "--value", "jump_length")


def call(*words):
    return CliRunner().invoke(app, ["soften", *(str(word) for word in words)])


@pytest.fixture(scope="module")
def hop(tmp_path_factory):
    return shutil.copy(case_path("saltation.toml"), tmp_path_factory.mktemp("case") / "hop.toml")


@pytest.fixture(scope="module")
def done(hop, tmp_path_factory):
    """The command once, with its folder."""
    out = tmp_path_factory.mktemp("soften") / "out"
    return call(hop, *MEASURE, "--to", "60 %", "-o", out, "--seeds", 2, "-j", 1, *SET), out


def test_the_command_prints_errors_steps_saved_and_an_answer(done):
    result, out = done
    assert result.exit_code in {0, 3}, result.output
    assert "6 runs to make: about" in result.stderr
    for factor in ("1/4", "1/16", "1/64"):
        assert factor in result.stdout
    assert re.search(r"extrapolated to the stiffness of the case: 0\.\d+ m", result.stdout)
    assert "exponent p:" in result.stdout
    plain = json.loads((out / "soften.json").read_text(encoding="utf-8"))
    assert plain["softening"]["case_k_n"] == 1.0e4
    assert plain["softening"]["tolerance"] == "60 %"
    assert (result.exit_code == 3) == (plain["softening"]["answer"] == "cannot be said")
    assert plain["findings"][0]["decided_by"] in result.stdout.replace("\n", " ")


def test_table_picture_and_page_are_written(done):
    _, out = done
    with (out / "soften" / "soften.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["k_n_N_per_m"]) for row in rows] == [2500.0, 625.0, 156.25]
    for row in rows:
        seeds = [float(row["seed 1"]), float(row["seed 2"])]
        assert float(row["mean"]) == pytest.approx(sum(seeds) / 2.0)
        assert 0.0 < float(row["overlap_over_d"]) < 0.5
    assert float(rows[0]["overlap_over_d"]) < float(rows[2]["overlap_over_d"])
    assert (out / "soften" / "error.png").stat().st_size > 5_000
    page = (out / "soften.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 1
    assert "saltation jump_length of hop" in page


def test_axe_finds_no_fault_on_the_page(done, faults_of):
    assert faults_of(done[1] / "soften.html") == []


def test_finished_runs_are_opened_for_another_number_and_tolerance(done, hop):
    first, out = done
    assert first.exit_code in {0, 3}
    other = call(
        hop, "-m", "saltation", "--value", "jump_height", "--to", "0.2 mm", "--against", "hard", "-o", out,
        "--seeds", 2, "-j", 1, *SET,
    )  # fmt: skip
    assert other.exit_code in {0, 3}, other.output
    assert "nothing to run; 6 finished runs" in other.stderr
    assert "against hard grains" in " ".join(other.stdout.split()) or "hard" in other.stdout
    plain = json.loads((out / "soften.json").read_text(encoding="utf-8"))
    assert plain["softening"]["against"] == "hard"
    assert plain["softening"]["tolerance"] == "0.0002 m"


def test_a_script_gets_the_same_answer_as_the_command(done, hop):
    _, out = done
    found = ryusa.soften(
        hop, "saltation", "60 %", value="jump_length", seeds=2, overrides=SHORT, folder=out, progress=False
    )
    kept = json.loads((out / "soften.json").read_text(encoding="utf-8"))["softening"]
    assert str(found.answer) == kept["answer"]
    assert found.fit is not None
    assert found.fit.exponents.low == kept["exponent"]["low"]
    assert [one.factor for one in found.runs] == [4.0, 16.0, 64.0]
    assert isinstance(found.answer, Answer)


def test_a_stiffness_at_which_grains_overlap_too_far_is_named_and_not_judged(hop, tmp_path):
    result = call(
        hop, *MEASURE, "--to", "20 %", "-o", tmp_path / "out", "--seeds", 2, "-j", 1, *SET, "-q",
        "--set", "domain.overlap_limit=0.02", "--softer", "2,16,64",
    )  # fmt: skip
    assert result.exit_code == 3
    said = " ".join(result.output.split())
    assert "1 of 3 stiffnesses gave a number in every run" in said
    assert "overlap" in said


def test_the_list_names_every_run_and_runs_nothing(hop, tmp_path):
    result = call(hop, *MEASURE, "--to", "5 %", "--list", "-o", tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert "9 runs to make" in result.stdout
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("-m", "transports", "--to", "5 %"), r"measure = 'transports'.*Did you mean 'transport'"),
        (("-m", "energy", "--to", "5 %"), r"measure = 'energy'.*give no number"),
        (("-m", "collisions", "--to", "5 %"), r"measure = 'collisions'.*no number with a limit for hard"),
        (("-m", "saltation", "--to", "5 %"), r"value: missing; saltation has jump_height,"),
        (("-m", "saltation", "--value", "jump", "--to", "5 %"), r"value = 'jump'.*Did you mean 'jump_"),
        ((*MEASURE, "--to", "5"), r"to = '5': missing unit.*such as '2 %'"),
        ((*MEASURE, "--to", "5 deg"), r"to = '5 deg': wrong unit"),
        ((*MEASURE, "--to", "0 %"), r"to = '0 %': must be greater than 0"),
        ((*MEASURE, "--to", "5 %", "--seeds", "1"), r"seeds = 1: must be two or more"),
        ((*MEASURE, "--to", "5 %", "--softer", "4,16"), r"softer = '4,16': must be three or more"),
        ((*MEASURE, "--to", "5 %", "--softer", "0.5,4,16"), r"softer = '0.5,4,16'.*from 1 to"),
        ((*MEASURE, "--to", "5 %", "--softer", "a,b,c"), r"--softer = 'a,b,c': must be numbers"),
        ((*MEASURE, "--to", "5 %", "--against", "hart"), r"against = 'hart'.*Did you mean 'hard'"),
        ((*MEASURE, "--to", "5 %", "--set", "contact.k=1"), r"contact.k"),
    ],
)
def test_what_cannot_be_asked_is_refused_with_what_is_allowed(hop, words, said):
    result = call(hop, *words)
    assert result.exit_code == 2
    assert re.search(said, " ".join(result.output.split())), result.output


def test_a_case_that_cannot_be_softened_is_refused_before_any_run(tmp_path):
    drop = shutil.copy(case_path("drop.toml"), tmp_path / "drop.toml")
    with pytest.raises(CaseError, match="cannot be softened"):
        study_of(drop, "spin", "5 %", value="spin")


def names_and_units(found):
    rows = (found.averages if hasattr(found, "averages") else found).rows()
    return {(row["quantity"], row["unit"]) for row in rows}


@pytest.fixture(scope="module")
def runs(hop, tmp_path_factory):
    """A run of each kind that measures with numbers need."""
    folder = tmp_path_factory.mktemp("runs")
    flume = {
        "build.length": "3 cm", "build.layers": "2", "stop.time": "0.5 s", "record.settle": "0.1 s",
        "record.frames": "10 ms", "record.forces": "true",
    }  # fmt: skip
    heap = {"build.columns": "8", "build.layers": "8", "stop.time": "0.6 s"}
    every = {
        "saltation": ("saltation", SHORT), "spin": ("saltation", SHORT), "surface": ("heap", heap),
        "discharge": ("poured_heap", {"stop.time": "0.5 s"}), "": ("bedload_3d", flume),
    }  # fmt: skip
    made = {}
    for name, changes in every.values():
        if name not in made:
            case = ryusa.load(case_path(f"{name}.toml"), changes)
            made[name] = ryusa.run(case, folder / name, progress=False)
    return {one.name: made[every.get(one.name, every[""])[0]] for one in MEASURES if one.numbers}


@pytest.mark.full
@pytest.mark.parametrize(
    "entry",
    [one for one in MEASURES if one.numbers and one.name not in ELSEWHERE],
    ids=lambda one: one.name,
)
def test_the_numbers_of_the_catalogue_are_those_that_the_measure_gives(entry, runs):
    more = {"window": 0.1} if entry.name in {"paths", "rods"} else {}
    found = load(entry.function)(runs[entry.name], **more)
    assert set(entry.numbers) <= names_and_units(found)
    for name, _ in names_and_units(found):
        _refuse_quantity("", entry.name, name)  # none that there is is refused
