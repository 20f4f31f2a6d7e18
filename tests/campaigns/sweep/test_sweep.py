"""`ryusa sweep` and `ryusa.sweep`, on a bed load of seconds."""

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

import ryusa
from ryusa.campaigns.sweep.measures import NEEDS
from ryusa.cases import case_path
from ryusa.catalogue import MEASURES, load
from ryusa.cli import app
from ryusa.errors import CaseError, ResultsError

SHORT = {
    "build.length": "3 cm", "build.layers": "2", "stop.time": "0.4 s", "record.settle": "0.1 s",
    "record.frames": "5 ms",
}  # fmt: skip
SET = [word for key, value in SHORT.items() for word in ("--set", f"{key}={value}")]
SLOPES = ("--over", "motion.slope=0.02,0.04")
ASKED = (*SLOPES, "--seeds", "2", "--measure", "transport", *SET)


def call(*words):
    return CliRunner().invoke(app, ["sweep", *(str(word) for word in words)])


def said(result):
    return " ".join(result.output.split())


@pytest.fixture(scope="module")
def bed(tmp_path_factory):
    return shutil.copy(case_path("bedload_3d.toml"), tmp_path_factory.mktemp("case") / "bed.toml")


@pytest.fixture(scope="module")
def done(bed, tmp_path_factory):
    """The command once, one run at a time, with its folder."""
    out = tmp_path_factory.mktemp("sweep") / "out"
    return call(bed, *ASKED, "-o", out, "-j", 1), out


def table(out):
    with (out / "sweep.csv").open() as file:
        return list(csv.DictReader(file))


@pytest.mark.full
def test_the_table_holds_every_run_and_every_setting(done):
    result, out = done
    assert result.exit_code == 0, result.output
    rows = [one for one in table(out) if one["quantity"] == "q_star"]
    assert [(one["motion.slope"], one["over"], one["seed"]) for one in rows] == [
        ("0.02", "run", "1"), ("0.02", "run", "2"), ("0.02", "seeds", ""),
        ("0.04", "run", "1"), ("0.04", "run", "2"), ("0.04", "seeds", ""),
    ]  # fmt: skip
    q = [float(one["value"]) for one in rows]
    assert q[2] == pytest.approx((q[0] + q[1]) / 2)
    assert q[5] > q[2] > 0.0  # the steeper bed carries more
    assert all(float(one["standard_error"]) > 0.0 for one in rows)
    assert all(Path(out / one["run"] / "case.json").is_file() for one in rows if one["run"])


@pytest.mark.full
def test_a_number_of_the_table_is_that_of_the_measure(done):
    _, out = done
    row = next(one for one in table(out) if one["quantity"] == "q_star")
    found = ryusa.Results.open(out / row["run"]).measure("transport")["q_star"]
    assert (float(row["value"]), float(row["standard_error"])) == (found.value, found.error)
    assert row["steady"] == str(found.steady)


@pytest.mark.full
def test_the_page_shows_the_table_the_effects_and_leads_to_every_run(done):
    _, out = done
    page = (out / "sweep.html").read_text(encoding="utf-8")
    links = re.findall(r'href="(runs/[^"]+/report.html)"', page)
    assert len(links) == 4
    for one in links:
        assert "<html" in (out / one).read_text(encoding="utf-8")
    assert (out / "pictures" / "transport-q_star.png").stat().st_size > 5_000
    assert page.count("data:image/png;base64,") == len(list((out / "pictures").glob("*.png")))
    assert "grains.spread" not in page  # only what differs is explained
    assert "water: tau_star" in page
    assert str(out) not in page


@pytest.mark.full
def test_finished_runs_are_opened_for_more_slopes_and_another_measure(done, bed):
    _, out = done
    before = (out / "sweep.csv").read_bytes()
    other = call(
        bed, "--over", "motion.slope=0.02,0.04,0.03", "--seeds", 2, "-m", "water", *SET, "-o", out, "-j", 1
    )
    assert other.exit_code == 0, other.output
    assert "2 runs to make" in other.stderr
    assert "(4 more are there and will be opened)" in other.stderr
    same = call(bed, *ASKED, "-o", out, "-j", 1)
    assert "nothing to run; 4 finished runs will be opened" in same.stderr
    assert (out / "sweep.csv").read_bytes() == before


def start(bed, out):
    """The command in a process group of its own, two runs at a time."""
    words = ["-c", "from ryusa.cli import main; main()", "sweep", bed, *ASKED, "-o", out, "-j", "2", "-q"]
    return subprocess.Popen([sys.executable, *words], start_new_session=True, stderr=subprocess.PIPE)


def wait_for(process, ready):
    """Wait until something is there, as long as the command runs."""
    for _ in range(2400):
        if ready() or process.poll() is not None:
            return
        time.sleep(0.05)


def complete(out):
    return [one for one in out.glob("runs/*/provenance.json") if '"complete"' in one.read_text()]


@pytest.mark.full
@pytest.mark.skipif(not hasattr(os, "killpg"), reason="kills a process group")
def test_a_sweep_killed_twice_gives_the_same_table_to_the_last_byte(done, bed, tmp_path):
    out = tmp_path / "out"
    for ready in (
        lambda: len(list(out.glob("runs/*/case.json"))) >= 1,
        lambda: len(complete(out)) >= 1,
    ):
        process = start(bed, out)
        wait_for(process, ready)
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        assert not (out / "sweep.csv").exists()
    last = start(bed, out)
    _, errors = last.communicate(timeout=300)
    assert last.returncode == 0, errors
    assert (out / "sweep.csv").read_bytes() == (done[1] / "sweep.csv").read_bytes()


@pytest.mark.full
def test_a_run_that_fails_costs_no_other(bed, tmp_path):
    out = tmp_path / "out"
    result = call(
        bed, "--over", "domain.overlap_limit=0.5,1e-9", "--seeds", 2, "-m", "transport", *SET, "-o", out,
        "-j", 1, "--no-pages",
    )  # fmt: skip
    assert result.exit_code == 3, result.output
    assert "2 runs could not be carried out or measured" in said(result)
    rows = table(out)
    good = [one for one in rows if one["setting"] == "1" and one["quantity"] == "q_star"]
    bad = [one for one in rows if one["setting"] == "2"]
    assert len(good) == 3
    assert [one["value"] for one in bad] == ["", ""]
    assert all("overlap" in one["problem"] for one in bad)
    page = (out / "sweep.html").read_text(encoding="utf-8")
    assert "2 of the runs or measures gave no numbers" in page
    assert not list(out.glob("runs/*/report.html"))


@pytest.mark.full
def test_a_measure_that_fails_costs_no_other_measure(bed, tmp_path):
    out = tmp_path / "out"
    words = ("--seeds", 1, "-m", "transport", "-m", "paths", *SET, "--set", "stop.time=0.2 s", "-j", 1)
    result = call(bed, *words, "--no-pages", "-o", out)
    assert result.exit_code == 3
    assert "seed 1: paths: no whole window of 1 s" in said(result)
    rows = table(out)
    (failed,) = [one for one in rows if one["problem"]]
    assert (failed["measure"], failed["value"]) == ("paths", "")
    assert all(one["value"] for one in rows if one["measure"] == "transport")


@pytest.mark.full
def test_a_changed_case_is_named_and_nothing_is_run(done, bed, tmp_path):
    out = shutil.copytree(done[1], tmp_path / "out")
    changed = tmp_path / "bed.toml"
    changed.write_text(Path(bed).read_text().replace("spread = 0.1 ", "spread = 0.2 "))
    result = call(changed, *ASKED, "-o", out, "-j", 1)
    assert result.exit_code == 2
    assert "the case has changed since 4 of its runs were made: grains.spread 0.1 is now 0.2" in said(result)
    assert "--again" in said(result)
    longer = call(bed, *SLOPES, "--seeds", 2, "-m", "transport", *SET, "--set", "stop.time=1 s", "-o", out)
    assert longer.exit_code == 2
    assert "stop.time 0.4 is now 1.0" in said(longer)


@pytest.mark.full
def test_a_folder_that_holds_another_sweep_or_something_else_is_refused(done, bed, tmp_path):
    _, out = done
    other = call(bed, "--over", "water.depth=4 cm,8 cm", "--seeds", 2, "-m", "transport", *SET, "-o", out)
    assert other.exit_code == 2
    assert "holds another sweep: over motion.slope, now water.depth" in said(other)
    (tmp_path / "thesis.txt").write_text("mine")
    foreign = call(bed, *ASKED, "-o", tmp_path)
    assert foreign.exit_code == 2
    assert "holds no sweep of ryusa, so it is not changed" in said(foreign)
    assert [one.name for one in tmp_path.iterdir()] == ["thesis.txt"]


def test_the_list_explains_every_case_with_its_cost_and_runs_nothing(bed, tmp_path):
    result = call(bed, *ASKED, "--list", "-o", tmp_path / "out", "-j", 2)
    assert result.exit_code == 0, result.output
    assert "4 runs to make: about" in result.stdout
    assert "on the disk" in said(result)
    assert re.search(r"by number of cores: 1 in \d+ s, 2 in \d+ s", said(result))
    assert "water: tau_star" in result.stdout
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--over", "motion.slop=0.01,0.02"), r"motion.slop: unknown key. Did you mean 'motion.slope'"),
        (
            ("--over", "motion.slope=0.01,99"),
            r"motion.slope = 99: is the tangent of .*\(in 1 setting of 2: slope 99\)",
        ),
        (("--over", "grains.diameter=4 mm,0.4 cm"), r"settings 1 and 2 are the same case"),
        (("--over", "grains.diameter=4 mm,2"), r"grains.diameter = 2: missing unit.*in 1 setting of 2"),
        (("--over", "motion.slope=0.01", "--set", "motion.slope=0.02"), r"motion.slope: is set to one value"),
        (("--set", "seed=4"), r"set seed = '4': is given by the seeds"),
        (("--seeds", "0"), r"--seeds = '0': must be a number of seeds"),
        (("-m", "transports"), r"measure = 'transports'.*Did you mean 'transport'"),
        (("-m", "energy"), r"measure = 'energy'.*give a table, and no quantities"),
        (("-m", "transport"), r"measure = 'transport': stands there twice"),
        (("-m", "contact_stress"), r"measure = 'contact_stress': needs record.forces = true"),
        (("-m", "discharge"), r"needs \[\[feeds\]\] or \[\[exits\]\]"),
        (("-m", "surface"), r"needs a scene that is open along x"),
        (("--set", "stop.time=0.1 s"), r"record.settle = .0.1 s.: must be shorter than stop.time"),
        (("--on", "proceses"), r"on = 'proceses'.*Did you mean 'processes'"),
    ],
)
def test_what_cannot_be_swept_is_refused_before_any_work(bed, tmp_path, words, expected):
    out = tmp_path / "out"
    result = call(bed, "-m", "transport", *SET, *words, "-o", out)
    assert result.exit_code == 2
    assert re.search(expected, said(result)), result.output
    assert not out.exists()


def test_a_measure_is_needed(bed):
    result = call(bed, *SLOPES)
    assert result.exit_code == 2
    assert "measure: missing; must be one of saltation," in said(result)


def test_faults_of_several_settings_are_reported_together(bed, tmp_path):
    result = call(
        bed, "--over", "motion.slope=0.01,99", "--over", "grains.spread=0.1,2,3", "-m", "transport", *SET,
        "-o", tmp_path / "out",
    )  # fmt: skip
    assert "bed.toml: 3 faults" in said(result)
    assert "in 3 settings of 6: slope 99, spread 0.1; slope 99, spread 2; slope 99, spread 3" in said(result)
    assert "in 2 settings of 6: slope 0.01, spread 2; slope 99, spread 2" in said(result)


@pytest.mark.full
def test_a_script_gets_the_same_table(done, bed):
    pandas = pytest.importorskip("pandas")
    _, out = done
    found = ryusa.sweep(
        bed, {"motion.slope": [0.02, 0.04]}, "transport", seeds=2, overrides=SHORT, folder=out, progress=False
    )
    frame = found.to_pandas()
    kept = pandas.read_csv(out / "sweep.csv")
    assert list(frame.columns) == list(kept.columns)
    assert frame["value"].tolist() == kept["value"].tolist()
    assert len(found.runs) == 4
    assert "slope 0.04" in found._repr_html_()
    with pytest.raises(ResultsError, match="holds another sweep"):
        ryusa.sweep(bed, (), "transport", overrides=SHORT, folder=out, progress=False)
    with pytest.raises(CaseError, match="seeds = 0: must be one seed or more"):
        ryusa.sweep(bed, (), "transport", seeds=0, overrides=SHORT, folder=out)


@pytest.mark.full
def test_a_file_with_a_table_does_what_the_command_does(done, bed):
    _, out = done
    path = Path(bed).parent / "slopes.toml"
    lines = "\n".join(f'"{key}" = "{value}"' for key, value in SHORT.items())
    path.write_text(
        '[sweep]\ncase = "bed.toml"\nseeds = 2\nmeasure = "transport"\n'
        f"[[sweep.over]]\nmotion.slope = [0.02, 0.04]\n[sweep.set]\n{lines}\n"
    )
    before = (out / "sweep.csv").read_bytes()
    result = call(path, "-o", out, "-j", 1)
    assert result.exit_code == 0, result.output
    assert "nothing to run; 4 finished runs" in result.stderr
    assert (out / "sweep.csv").read_bytes() == before
    both = call(path, *SLOPES, "-o", out)
    assert "stands in slopes.toml, which has a table [sweep]" in said(both)
    kept = json.loads((out / "sweep.json").read_text(encoding="utf-8"))
    assert kept["settings"] == [{"motion.slope": "0.02"}, {"motion.slope": "0.04"}]


@pytest.mark.parametrize("entry", MEASURES, ids=lambda one: one.name)
def test_the_catalogue_says_which_measures_give_quantities_and_what_they_need(entry):
    kind = load(entry.function).__annotations__["return"]
    averages = "averages" in kind.__annotations__
    snapshot = entry.name in {"surface", "cone"}  # quantities of one moment
    assert entry.table == (not averages and not snapshot)
    assert set(entry.needs) <= set(NEEDS)
