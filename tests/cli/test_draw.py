"""Where `ryusa draw` writes: beside the run, never over another picture, and no large table unasked."""

import csv
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.cli import app
from ryusa.cli import draw as command
from ryusa.results import Results
from ryusa.running.runner import run


@pytest.fixture(scope="module")
def drop(tmp_path_factory):
    """A short run of one grain that falls."""
    folder = tmp_path_factory.mktemp("runs") / "drop"
    run(read(case_path("drop.toml"), {"stop.time": "3 ms", "record.settle": "0 s"}), folder, progress=False)
    return folder


@pytest.fixture
def folder(drop, tmp_path, monkeypatch):
    """A copy of it, beside an empty current folder."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return Path(shutil.copytree(drop, tmp_path / "drop"))


def call(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_a_picture_is_written_beside_its_run_and_says_where(folder):
    result = call("draw", folder, "energy")
    assert result.exit_code == 0, result.output
    picture = folder / "pictures" / "energy.png"
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert str(picture) in result.output.replace("\n", "")
    assert len(picture.with_suffix(".csv").read_text().splitlines()) > 1
    assert list(Path().iterdir()) == []


def test_a_run_with_pictures_is_opened_inspected_checked_and_resumed_as_before(folder):
    before = Results.open(folder)
    call("draw", folder, "energy")
    after = Results.open(folder)
    assert len(after.frames) == len(before.frames)
    assert (after.frames.x[-1] == before.frames.x[-1]).all()
    for words in (("inspect", folder), ("check", folder / "case.toml")):
        assert call(*words).exit_code == 0
    resumed = call("run", folder / "case.toml", "-o", folder, "--resume", "--set", "stop.time=4 ms", "-q",
                   "--set", "record.settle=0 s")  # fmt: skip
    assert resumed.exit_code == 0, resumed.output
    assert Results.open(folder).frames.t[-1] == pytest.approx(4e-3, rel=1e-3)
    assert (folder / "pictures" / "energy.png").exists()


def test_several_pictures_are_the_same_files_as_one_at_a_time(folder):
    for name in ("energy", "grains"):
        assert call("draw", folder, name).exit_code == 0
    result = call("draw", folder, "energy", "grains", "energy", "-o", "shown")
    assert result.exit_code == 0, result.output
    assert sorted(one.name for one in Path("shown").iterdir()) == [
        "energy.csv", "energy.png", "grains.csv", "grains.png",
    ]  # fmt: skip
    for one in Path("shown").iterdir():
        assert one.read_bytes() == (folder / "pictures" / one.name).read_bytes()


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("energy", "grain"), "grains"),
        (("energy", "grains", "--colour", "spin"), "--colour"),
        (("energy", "grains", "--csv", "all.csv"), "--csv"),
        (("energy", "grains", "-o", "all.png"), "--output"),
        (("energy", "-o", "shown"), "--output"),
    ],
)
def test_what_one_of_several_pictures_does_not_take_is_said_before_any_is_drawn(folder, words, named):
    result = call("draw", folder, *words)
    assert result.exit_code == 2
    assert named in result.output
    assert not (folder / "pictures").exists() and list(Path().iterdir()) == []


def test_a_large_table_is_written_on_request_only(folder, monkeypatch):
    monkeypatch.setattr(command, "MOST", 50.0)
    result = call("draw", folder, "energy")
    assert "--csv FILE writes them" in result.output
    assert not (folder / "pictures" / "energy.csv").exists()
    assert call("draw", folder, "energy", "--csv", "all.csv").exit_code == 0
    with Path("all.csv").open() as file:
        assert len(list(csv.DictReader(file))) == 3  # frames but the first, whose account is empty


def test_the_size_of_a_table_is_known_before_it_is_written(tmp_path):
    from ryusa.measure import write_csv

    rows = [{"grain": k, "x_m": k / 7.0, "moves": k % 2 == 0} for k in range(5000)]
    written = write_csv(tmp_path / "table.csv", rows).stat().st_size
    assert command._csv_size(rows) == pytest.approx(written, rel=0.1)
    assert command._csv_size([]) == 0.0


def test_a_new_run_in_the_folder_removes_the_pictures_of_the_earlier_one(folder):
    call("draw", folder, "energy")
    (folder / "pictures" / "mine.txt").write_text("kept")
    case = read(case_path("drop.toml"), {"stop.time": "2 ms", "record.settle": "0 s"})
    run(case, folder, progress=False, overwrite=True)
    assert [one.name for one in (folder / "pictures").iterdir()] == ["mine.txt"]


@pytest.mark.parametrize("name", ["pictures", "pictures/energy.png", "pictures/energy.csv"])
def test_a_link_in_a_run_folder_is_not_written_through(folder, tmp_path, name):
    aim = tmp_path / "elsewhere"
    if name == "pictures":
        aim.mkdir()
    else:
        (folder / "pictures").mkdir()
        aim.write_text("precious")
    (folder / name).symlink_to(aim)
    result = call("draw", folder, "energy")
    assert result.exit_code == 2
    assert "links are not followed" in result.output
    assert list(aim.iterdir()) == [] if aim.is_dir() else aim.read_text() == "precious"


def test_a_folder_that_cannot_be_written_names_the_way_out(folder):
    (folder / "pictures").write_text("a file where the folder should be")
    result = call("draw", folder, "energy")
    assert result.exit_code == 2
    assert "choose another with -o" in result.output
