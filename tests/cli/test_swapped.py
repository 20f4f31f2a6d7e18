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
