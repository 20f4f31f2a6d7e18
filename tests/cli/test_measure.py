import csv
import json

import pytest
from typer.testing import CliRunner

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.cli import app
from ryusa.running.runner import run

CASES = case_path("saltation.toml").parent


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A short saltation of two starts."""
    folder = tmp_path_factory.mktemp("runs") / "short"
    overrides = {"build.starts": "2", "stop.time": "0.4 s", "record.settle": "0 s"}
    run(read(case_path("saltation.toml"), overrides), folder, progress=False)
    return folder


def call(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_measured_hops_are_printed_with_error_and_window_and_kept_as_csv(folder, tmp_path):
    table = tmp_path / "hops.csv"
    result = call("measure", folder, "saltation", "--csv", table)
    assert result.exit_code == 0, result.output
    assert "jump_height" in result.output
    assert "s.e." in result.output
    assert "window" in result.output
    with table.open() as file:
        rows = {row["quantity"]: row for row in csv.DictReader(file)}
    assert float(rows["contact_time"]["value"]) == pytest.approx(1.04e-4, rel=0.1)
    assert float(rows["contact_time"]["standard_error"]) > 0


@pytest.mark.parametrize("what", ["collisions", "spin", "energy", "tracks"])
def test_every_measure_prints_something_and_writes_csv(folder, tmp_path, what):
    result = call("measure", folder, what, "--csv", tmp_path / "out.csv")
    assert result.exit_code == 0, result.output
    assert len((tmp_path / "out.csv").read_text().splitlines()) > 1


def test_a_flow_has_a_profile_and_paths_within_a_window(folder, tmp_path):
    table = tmp_path / "profile.csv"
    result = call("measure", folder, "profile", "--begin", "0.1 s", "--layer", "1", "--layers", table)
    assert result.exit_code == 0, result.output
    assert "m2/s" in result.output
    assert table.read_text().startswith("z_m,z_over_d,phi,")
    result = call("measure", folder, "paths", "--window", "0.1 s", "--end", "0.3 s", "--series", table)
    assert result.exit_code == 0, result.output
    assert "reversals" in result.output
    assert len(table.read_text().splitlines()) == 1 + 3 * 2  # windows, grains


@pytest.mark.parametrize("what", ["tracks", "spin", "energy", "contacts", "hops", "profile"])
def test_every_picture_is_drawn_with_its_numbers_beside_it(folder, tmp_path, what):
    result = call("draw", folder, what, "-o", tmp_path / "picture.svg")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "picture.svg").read_text().startswith("<?xml")
    assert len((tmp_path / "picture.csv").read_text().splitlines()) > 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("measure", "{}", "saltacion"), "Did you mean 'saltation'"),
        (("measure", "{}", "saltation", "--settle", "1"), "missing unit"),
        (("measure", "{}", "saltation", "--rise", "-1"), "rise"),
        (("measure", "{}", "paths"), "no whole window of 1 s"),
        (("measure", "{}", "profile", "--layer", "0"), "--layer"),
        (("draw", "{}", "trakcs"), "Did you mean 'tracks'"),
        (("draw", "{}", "tracks", "--grain", "9"), "--grain"),
        (
            ("draw", "{}", "tracks", "--begin", "99 s"),
            "--begin = '99 s': lies after the last frame; the run holds 0 .. 0.4 s",
        ),
        (("measure", "{}", "profile", "--begin", "9 s"), "the run holds 0 .. 0.4 s"),
        (("measure", "{}", "profile", "--begin", "3 s", "--end", "0.2 s"), "the run holds"),
        (("measure", "{}", "profile", "--begin", "0.3 s", "--end", "0.2 s"), "must lie before --end, 0.2 s"),
        (("measure", "{}", "deposit"), "short: deposit: needs a run"),
        (("draw", "{}", "tracks", "--exaggeration", "0"), "exaggeration"),
        (("draw", "{}", "tracks", "-o", "picture.bmp"), ".png"),
        (("draw", "{}", "grains", "--at", "99 s"), "no frame at t = 99 s"),
        (("draw", "{}", "grains", "--colour", "sped"), "Did you mean 'speed'"),
        (("draw", "{}", "grains", "--lane", "7"), "no lane 7: there are 2"),
        (("measure", "{}", "surface", "--side", "up"), "--side"),
        (("measure", "{}", "vibration", "--threshold", "2"), "missing unit"),
        (("measure", "{}", "vibration", "--window", "1 us"), "frames in a window"),
        (("measure", "no-such-run", "saltation"), "no-such-run"),
        (
            ("measure", "{}", "saltation", "--layer", "1"),
            "saltation does not take it; it takes --settle, --rise",
        ),
        (("measure", "{}", "profile", "--at", "0 s"), "it takes --settle, --begin, --end, --layer"),
        (("measure", "{}", "energy", "--begin", "0 s"), "energy takes no options"),
        (("draw", "{}", "hops", "--lane", "0"), "hops takes no options"),
        (
            ("draw", "{}", "grains", "--begin", "0 s"),
            "grains does not take it; it takes --at, --colour, --lane",
        ),
    ],
)
def test_an_unknown_name_gives_one_message_and_exit_code_two(folder, words, message):
    result = call(*(word.format(folder) for word in words))
    assert result.exit_code == 2, result.output
    assert message in result.output
    assert "Traceback" not in result.output


def test_a_run_without_hops_says_so(folder):
    result = call("measure", folder, "saltation", "--settle", "99 s")
    assert result.exit_code == 2, result.output
    assert "hops over fixed grains after t = 99 s" in result.output


@pytest.fixture(scope="module")
def unsettled(tmp_path_factory):
    """A run that ended while it settled, as one does that is interrupted."""
    folder = tmp_path_factory.mktemp("runs") / "unsettled"
    run(read(case_path("drop.toml"), {"stop.time": "3 ms", "record.settle": "0 s"}), folder, progress=False)
    case = json.loads((folder / "case.json").read_text())
    case["record"]["settle"] = 1.0
    (folder / "case.json").write_text(json.dumps(case))
    return folder


@pytest.mark.parametrize(
    "words",
    [
        *(("draw", what) for what in ("tracks", "hops", "contacts", "profile")),
        *(("measure", what) for what in ("saltation", "collisions", "spin", "profile")),
    ],
)
def test_a_run_that_ended_while_settling_says_so(unsettled, words):
    result = call(words[0], unsettled, words[1])
    assert result.exit_code == 2, result.output
    assert "ends at t = 0.003 s" in result.output
    assert "record.settle = 1 s" in result.output


def test_a_run_that_ended_while_settling_is_measured_on_request(unsettled, tmp_path):
    assert call("measure", unsettled, "spin", "--settle", "0 s").exit_code == 0
    picture = tmp_path / "tracks.svg"
    assert call("draw", unsettled, "tracks", "--begin", "0 s", "-o", picture).exit_code == 0


@pytest.fixture(scope="module")
def heap(tmp_path_factory):
    """A small heap whose gate goes early."""
    folder = tmp_path_factory.mktemp("runs") / "heap"
    overrides = {
        "build.columns": "10",
        "build.layers": "8",
        "motion.rotation": "free",
        "stop.time": "0.5 s",
        "record.frames": "1 ms",
        "record.events": "all",
        "record.settle": "0 s",
    }
    run(read(case_path("heap.toml"), overrides), folder, progress=False)
    return folder


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("vibration",), "0.001 mean diameters, the default"),
        (("vibration", "--threshold", "2 um", "--window", "20 ms"), "within 0.02 s"),
        (("surface",), "right slope at t = 0.5 s"),
        (("surface", "--at", "0.35 s"), "stands like a wall"),
    ],
)
def test_a_packing_is_measured_with_its_threshold_and_doubts_stated(heap, tmp_path, words, said):
    result = call("measure", heap, *words, "--csv", tmp_path / "out.csv")
    assert result.exit_code == 0, result.output
    assert said in result.output
    assert len((tmp_path / "out.csv").read_text().splitlines()) > 1


@pytest.mark.parametrize(
    "words",
    [
        ("grains",),
        ("grains", "--at", "0.1 s", "--colour", "spin"),
        ("surface", "--at", "0.2 s"),
        ("vibration", "--grain", "3", "--grain", "7"),
        ("vibration",),
        ("contacts",),
        ("tracks", "--grain", "5"),
    ],
)
def test_a_packing_is_drawn(heap, tmp_path, words):
    table = tmp_path / "picture.csv"
    result = call("draw", heap, *words, "-o", tmp_path / "picture.svg", "--csv", table)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "picture.svg").read_text().startswith("<?xml")
    assert len(table.read_text().splitlines()) > 1


def test_rods_are_measured_over_a_time_asked_for(folder, tmp_path):
    result = call("measure", folder, "rods", "--window", "0.05 s", "--csv", tmp_path / "rods.csv")
    assert result.exit_code == 0, result.output
    assert "a rod: moving grains that touch (gap below 0.05 d) for 0.05 s" in result.output.replace("\n", " ")
    assert "null_share" in result.output


@pytest.fixture(scope="module")
def wet(tmp_path_factory):
    """A short flow of water over a small loose bed."""
    folder = tmp_path_factory.mktemp("runs") / "wet"
    overrides = {"build.columns": "8", "build.layers": "4", "stop.time": "0.2 s", "record.settle": "0.1 s"}
    run(read(CASES / "movable_bed.toml", overrides), folder, progress=False)
    return folder


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("water", ("tau_bed", "discharge", "extrapolated to the bed")),
        ("transport", ("q_star", "layer_thickness", "tau_star")),
        ("entrainment", ("deposition", "moving_speed")),
        ("stress", ("temperature", "xz [Pa]")),
    ],
)
def test_water_and_what_it_carries_are_measured(wet, tmp_path, what, words):
    table = tmp_path / f"{what}.csv"
    result = call("measure", wet, what, "--csv", table)
    assert result.exit_code == 0, result.output
    assert all(word in result.output for word in words)
    with table.open() as file:
        assert len(list(csv.DictReader(file))) > 5


@pytest.mark.parametrize("what", ["water", "transport", "grains"])
def test_water_and_what_it_carries_are_drawn(wet, tmp_path, what):
    result = call("draw", wet, what, "-o", tmp_path / "picture.svg")
    assert result.exit_code == 0, result.output
    drawn = (tmp_path / "picture.svg").read_text()
    assert {"water": "surface", "transport": "Wong", "grains": "speed"}[what] in drawn
    assert len((tmp_path / "picture.csv").read_text().splitlines()) > 5


def test_a_dry_run_has_no_water_to_measure(folder):
    result = call("measure", folder, "water", "--begin", "0 s")
    assert result.exit_code != 0
    assert "no column of water" in result.output
