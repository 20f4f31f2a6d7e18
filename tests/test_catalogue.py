"""A line of the catalogue is all that a measure or a picture needs beside its own file."""

import csv
import inspect
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

import ryusa.cli.draw
import ryusa.cli.measure
from ryusa import measure
from ryusa.casefile.read import read
from ryusa.catalogue import MEASURES, PICTURES, MeasureEntry, PictureEntry, load, option
from ryusa.cli import app
from ryusa.cli.measure_options import ALWAYS

ENTRIES = (*MEASURES, *PICTURES)

TOY = '''
"""Rate at which the mean height of the grains changes."""

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Sinking:
    t: np.ndarray
    z: np.ndarray

    def rows(self):
        return [{"t_s": float(t), "z_m": float(z)} for t, z in zip(self.t, self.z, strict=True)]


def sinking(run, begin=-math.inf, end=math.inf):
    t = np.asarray(run.frames.t)
    inside = (t >= begin) & (t <= end)
    return Sinking(t[inside], np.asarray(run.frames.x[:])[inside][:, :, 2].mean(axis=1))


def draw(found):
    from ryusa.figures import style

    figure, (axes,) = style.new()
    axes.plot(found.t, found.z)
    return figure
'''


def call(*words: object):
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short run of one grain that falls."""
    folder = tmp_path_factory.mktemp("runs") / "drop"
    case = Path(ryusa.__file__).parent / "cases" / "drop.toml"
    ryusa.run(read(case, {"stop.time": "3 ms", "record.settle": "0 s"}), folder, progress=False)
    return folder


@pytest.fixture
def toy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    (tmp_path / "toy_measure.py").write_text(TOY, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield "toy_measure"
    sys.modules.pop("toy_measure", None)


def keywords_of(entry: MeasureEntry | PictureEntry) -> dict[str, inspect.Parameter]:
    name = entry.measure if isinstance(entry, PictureEntry) and entry.measure else ""
    function = next((one.function for one in MEASURES if one.name == name), entry.function)
    return dict(inspect.signature(load(function)).parameters)


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: f"{type(entry).__name__}-{entry.name}")
def test_the_options_of_an_entry_are_keywords_of_its_function(entry: MeasureEntry | PictureEntry) -> None:
    parameters = keywords_of(entry)
    assert set(entry.options) <= set(parameters)
    if "begin" in entry.options:  # None stands for the settling time of the case
        assert (parameters["begin"].default is None) == entry.settled


@pytest.mark.parametrize("command", ["measure", "draw"])
def test_a_default_that_help_shows_is_that_of_the_function(command: str) -> None:
    entries = {"measure": MEASURES, "draw": PICTURES}[command]
    found = typer.main.get_command(app).commands[command]
    shown = {one.opts[0]: one.default for one in found.params if one.param_type_name == "option"}
    taken = {name for entry in entries for name in entry.given_as}
    assert taken | {f"--{name}" for name in ALWAYS} >= set(shown)
    assert taken <= set(shown)
    for entry in entries:
        for keyword in entry.options:
            default = shown[option(keyword)]
            assert default is None or default == keywords_of(entry)[keyword].default, (entry.name, keyword)


@pytest.mark.parametrize("entry", MEASURES, ids=lambda entry: entry.name)
def test_every_measure_of_the_catalogue_is_a_name_of_ryusa_measure(entry: MeasureEntry) -> None:
    module, _, name = entry.function.partition(":")
    assert module.startswith("ryusa.measure.")
    assert inspect.unwrap(getattr(measure, name)) is load(entry.function)


def test_names_are_used_once() -> None:
    for entries in (MEASURES, PICTURES):
        assert len({one.name for one in entries}) == len(entries)


def test_one_line_makes_a_new_measure_a_command(
    folder: Path, toy: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    line = MeasureEntry("sinking", f"{toy}:sinking", "rate of sinking", ("begin", "end"))
    monkeypatch.setattr(ryusa.cli.measure, "MEASURES", (*MEASURES, line))
    result = call("measure", folder, "sinking", "--begin", "1 ms", "--csv", tmp_path / "sinking.csv")
    assert result.exit_code == 0, result.output
    assert "z_m" in result.output
    with (tmp_path / "sinking.csv").open() as file:
        times = [float(row["t_s"]) for row in csv.DictReader(file)]
    assert times
    assert min(times) >= 1.0e-3
    result = call("measure", folder, "sinkin")
    assert "Did you mean 'sinking'" in result.output


def test_one_line_makes_a_new_picture_a_command(
    folder: Path, toy: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    measured = MeasureEntry("sinking", f"{toy}:sinking", "rate of sinking", ("begin", "end"))
    line = PictureEntry("sinking", f"{toy}:draw", "height over time", ("end",), measure="sinking")
    monkeypatch.setattr(ryusa.cli.draw, "MEASURES", (*MEASURES, measured))
    monkeypatch.setattr(ryusa.cli.draw, "PICTURES", (*PICTURES, line))
    result = call("draw", folder, "sinking", "--end", "2 ms", "-o", tmp_path / "sinking.svg")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "sinking.svg").exists()
    with (tmp_path / "sinking.csv").open() as file:
        assert max(float(row["t_s"]) for row in csv.DictReader(file)) <= 2.0e-3


def test_an_entry_that_needs_the_settling_time_refuses_a_run_that_ended_before(
    folder: Path, toy: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    line = MeasureEntry("sinking", f"{toy}:sinking", "rate of sinking", ("begin",), settled=True)
    monkeypatch.setattr(ryusa.cli.measure, "MEASURES", (line,))
    monkeypatch.setattr("ryusa.measure._run.settle_time", lambda _run: 1.0)
    result = call("measure", folder, "sinking")
    assert result.exit_code == 2
    assert "--begin 0s shows what is there" in result.output
    assert call("measure", folder, "sinking", "--settle", "0 s").exit_code == 0
    monkeypatch.setattr(ryusa.cli.measure, "MEASURES", (replace(line, settled=False),))
    assert "does not take it" in call("measure", folder, "sinking", "--settle", "0 s").output
