import pytest
from typer.testing import CliRunner

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.cli import app
from ryusa.running.runner import run


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "short"
    changes = {"build.starts": "2", "stop.time": "0.1 s", "record.settle": "0 s"}
    run(read(case_path("saltation.toml"), changes), folder, progress=False)
    return folder


def call(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_the_page_lies_in_the_run_folder_and_is_named(folder):
    result = call("view", folder)
    assert result.exit_code == 0, result.output
    assert str(folder / "view.html") in result.output
    assert (folder / "view.html").read_text().startswith("<!DOCTYPE html>")


def test_the_page_goes_where_it_is_asked_for(folder, tmp_path):
    result = call("view", folder, "-o", tmp_path / "new" / "page.html", "--begin", "20 ms", "--end", "40ms")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "new" / "page.html").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-o", "page.pdf"], "must end in .html"),
        (["--begin", "20"], "--begin = '20': missing unit"),
        (["--size", "10"], "--size = '10': missing unit: needs a quantity in byte, such as '5 MB'"),
        (["--size", "1 kB"], "--size = '1 kB': must be 400 kB to 2e+06 kB"),
        (["--begin", "20 s"], "the run holds 0 .. 0.1 s"),
    ],
)
def test_what_cannot_be_done_is_refused_with_its_reason(folder, words, said):
    result = call("view", folder, *words)
    assert result.exit_code != 0
    assert said in result.stderr


def test_a_run_that_is_replaced_leaves_no_page_of_the_old_one(tmp_path):
    changes = {"build.starts": "2", "stop.time": "0.02 s", "record.settle": "0 s"}
    case = read(case_path("saltation.toml"), changes)
    run(case, tmp_path / "run", progress=False)
    assert call("view", tmp_path / "run").exit_code == 0
    run(case, tmp_path / "run", progress=False, overwrite=True)
    assert not (tmp_path / "run" / "view.html").exists()
