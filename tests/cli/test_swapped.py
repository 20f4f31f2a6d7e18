"""Arguments that a user mixes up: the run after what is asked of it, and a home folder within quotes."""

from pathlib import Path

import pytest

from ryusa.cli import at_home, main


@pytest.mark.parametrize(
    "typed", [("measure", "energy", "RUN"), ("draw", "tracks", "RUN"), ("draw", "tracks", "RUN", "spin")]
)
def test_a_run_given_last_is_told_to_come_first(typed, tmp_path: Path, capsys) -> None:
    (tmp_path / "run").mkdir()
    with pytest.raises(SystemExit) as found:
        main([str(tmp_path / "run") if one == "RUN" else one for one in typed])
    assert found.value.code == 2
    asked = " ".join(one for one in typed[1:] if one != "RUN")
    said = " ".join(capsys.readouterr().err.split())
    assert f"the run comes first: ryusa {typed[0]} {tmp_path / 'run'} {asked}" in said


def said_by(capsys, *typed: str) -> str:
    with pytest.raises(SystemExit) as found:
        main(typed)
    assert found.value.code == 2
    return " ".join(capsys.readouterr().err.split())


def test_a_measure_that_is_missing_is_named_and_not_the_run(capsys) -> None:
    assert "ryusa: WHAT: missing after runs/one; must be one of saltation" in said_by(
        capsys, "measure", "runs/one"
    )
    assert "Missing argument 'RUN'" in said_by(capsys, "measure", "energy")


@pytest.mark.parametrize(
    "command", [("measure",), ("draw",), ("view",), ("film",), ("inspect",), ("resume",)]
)
def test_what_is_no_run_is_told_where_runs_are(command, tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    what = ["energy"] if command[0] == "measure" else ["tracks"] if command[0] == "draw" else []
    Path("bed.toml").write_text("")
    Path("more").mkdir()
    assert "`ryusa run bed.toml` makes its run, runs/bed" in said_by(capsys, *command, "bed.toml", *what)
    for name in ("bed", *"abcdef"):
        (Path("runs") / name / "parts").mkdir(parents=True)
        (Path("runs") / name / "provenance.json").write_text("{}")
    assert "bed.toml: a case, not a run folder; its run is runs/bed" in said_by(
        capsys, *command, "bed.toml", *what
    )
    assert "it holds runs: runs/a, runs/b, runs/bed, runs/c, runs/d and 2 more" in said_by(
        capsys, *command, "runs", *what
    )
    assert "more: not a run folder of ryusa (" in said_by(capsys, *command, "more", *what)
    assert "none: no such run folder" in said_by(capsys, *command, "none", *what)


def test_a_tilde_within_quotes_means_home(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "beds").mkdir()
    with pytest.raises(SystemExit) as found:
        main(["new", "drop", "~/beds/one.toml"])
    assert found.value.code == 0
    assert (tmp_path / "beds" / "one.toml").is_file() and not (tmp_path / "~").exists()
    assert at_home("--output=~/beds") == f"--output={tmp_path / 'beds'}"
    assert at_home("--title=a ~/ b") == "--title=a ~/ b"


def test_an_unquoted_quantity_is_told_of_quotes(capsys) -> None:
    assert "blank stands in quotes, such as --set 'water.depth=2 cm'" in said_by(
        capsys, "check", "drop.toml", "--set", "water.depth=2", "cm"
    ).replace("│ ", "")
