import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from typer.testing import CliRunner

import ryusa
from ryusa import build
from ryusa.cli import app
from ryusa.running import folder as folder_module
from ryusa.running import runner
from ryusa.version import commit


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def ryusa_(here: Path) -> Any:
    """Call the command line; an error that is not ours fails the test."""

    def call(*words: str) -> SimpleNamespace:
        result = CliRunner().invoke(app, list(words))
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return SimpleNamespace(code=result.exit_code, out=result.stdout, err=result.stderr)

    return call


@pytest.fixture
def drop(here: Path, ryusa_: Any) -> str:
    assert ryusa_("new", "drop").code == 0
    return "drop.toml"


def test_new_check_and_run_lead_to_a_run_folder(ryusa_: Any, drop: str, here: Path) -> None:
    assert "contact time on a fixed grain" in ryusa_("check", drop).out
    done = ryusa_("run", drop, "--set", "stop.time=20 ms", "--seed", "5")
    assert done.code == 0, done.err
    assert "grains.vtkhdf" in done.out
    assert "restitution: 0.7 set" in done.err
    results = ryusa.Results.open("runs/drop")
    assert results.complete
    assert len(results.frames) == 21
    assert results.provenance["seed"] == 5
    assert results.provenance["overrides"]["stop.time"] == "20 ms"
    assert results.case["seed"] == 5
    assert (here / "runs/drop/case.toml").read_bytes() == (here / drop).read_bytes()


def test_check_names_other_engines_for_a_case_that_takes_days(ryusa_: Any) -> None:
    assert ryusa_("new", "dense_3d").code == 0
    size = ("--set", "build.columns=1000", "--set", "build.rows=1000")
    said = " ".join(ryusa_("check", "dense_3d.toml", *size).out.split())
    assert "a long run about 4.9 days on 1 thread, by a rule of thumb (12,000,000 grains)" in said
    assert "--engine lammps (" in said
    assert "a long run" not in ryusa_("check", "dense_3d.toml").out


def test_new_lists_kinds_and_every_kind_reads(ryusa_: Any) -> None:
    listed = ryusa_("new").out.splitlines()
    cases = [line for line in listed if line.startswith("  ") and not line.startswith(("  ->", "     "))]
    kinds = [line.split()[0] for line in cases]
    assert {"drop", "saltation", "paper/fig19"} <= set(kinds)
    for number, kind in enumerate(kinds):
        assert ryusa_("new", kind, f"{number}.toml").code == 0
        ryusa.load(f"{number}.toml")


def test_new_does_not_overwrite_a_file(ryusa_: Any, drop: str, here: Path) -> None:
    (here / drop).write_text("mine")
    done = ryusa_("new", "drop")
    assert done.code == 2
    assert "exists already" in done.err
    assert (here / drop).read_text() == "mine"


@pytest.mark.parametrize("kind", ["dorp", "../drop", "/etc/passwd", "paper/../drop", ""])
def test_new_refuses_an_unknown_kind(ryusa_: Any, kind: str) -> None:
    done = ryusa_("new", kind)
    assert done.code == 2
    assert "must be one of" in done.err


def test_new_suggests_the_nearest_kind(ryusa_: Any) -> None:
    assert "Did you mean 'saltation'?" in ryusa_("new", "saltaton").err


BAD = {
    "unknown key": (("contact.stifness=1 N/cm",), ["contact.stifness", "unknown key", "contact.stiffness"]),
    "wrong unit": (("grains.diameter=2 kg",), ["grains.diameter", "2 kg"]),
    "missing unit": (("grains.diameter=0.002",), ["grains.diameter", "unit"]),
    "negative": (("contact.stiffness=-100 N/cm",), ["contact.stiffness", "-100 N/cm"]),
    "not a number": (("contact.restitution=nan",), ["contact.restitution", "finite"]),
    "absurd step": (("time.step=1 s",), ["time.step", "1 s"]),
    "tiny step": (("time.step=1e-15 s",), ["time.step", "1e-15 s"]),
    "no key": (("contact",), ["--set", "KEY=VALUE"]),
    "frames that fit on no disk": (("record.frames=10 us", "stop.time=1e8 s"), ["record.frames", "are free"]),
    "rolling friction on locked grains": (("rolling.model=constant",), ["rolling"]),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_setting_is_one_message_and_exit_code_2(ryusa_: Any, drop: str, here: Path, name: str) -> None:
    settings, words = BAD[name]
    done = ryusa_("run", drop, *(word for setting in settings for word in ("--set", setting)))
    assert done.code == 2, done
    assert "Traceback" not in done.err
    assert done.err.startswith("ryusa: ")
    assert len(done.err.strip().splitlines()) <= 3
    assert all(word in done.err for word in words), done.err
    assert not (here / "runs").exists()


def test_overlapping_first_grains_are_refused(ryusa_: Any, drop: str, here: Path) -> None:
    (here / "grains.csv").write_text("x [mm],y [mm],z [mm],d [mm]\n0,0,5,2\n1,0,5,2\n")
    text = (here / drop).read_text(encoding="utf-8").splitlines()
    start = text.index("[build]")
    end = next(k for k in range(start + 1, len(text)) if text[k].startswith("["))
    text[start:end] = ["[build]", 'kind = "table"', 'file = "grains.csv"']
    (here / "table.toml").write_text("\n".join(text), encoding="utf-8")
    for command in ("check", "run"):
        done = ryusa_(command, "table.toml")
        assert done.code == 2
        assert "overlap" in done.err


def test_a_missing_case_file_is_named(ryusa_: Any) -> None:
    for command in ("check", "run"):
        done = ryusa_(command, "nowhere.toml")
        assert done.code == 2
        assert "nowhere.toml" in done.err


def test_a_folder_that_cannot_be_written_is_named(ryusa_: Any, drop: str, here: Path) -> None:
    (here / "file").write_text("")
    done = ryusa_("run", drop, "-o", "file/run")
    assert done.code == 2
    assert "file/run: cannot be written" in done.err


def test_ten_gigabytes_of_frames_do_not_start_on_a_small_disk(
    ryusa_: Any, drop: str, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(folder_module, "free_bytes", lambda place: 3 * 10**9)
    done = ryusa_("run", drop, "--set", "record.frames=10 us", "--set", "stop.time=300 s")
    assert done.code == 2
    assert "GB" in done.err
    assert not (here / "runs").exists()


def test_an_existing_run_is_refused_unless_overwritten(ryusa_: Any, drop: str) -> None:
    short = ("--set", "stop.time=2 ms", "--quiet")
    assert ryusa_("run", drop, *short).code == 0
    refused = ryusa_("run", drop, *short)
    assert refused.code == 2
    assert "--overwrite" in refused.err
    assert ryusa_("run", drop, *short, "--overwrite").code == 0


@pytest.mark.parametrize("threads", ["0", "-1"])
def test_a_run_needs_a_thread(ryusa_: Any, drop: str, threads: str) -> None:
    ryusa_("run", drop, "--set", "stop.time=2 ms", "-o", "made", "--quiet")
    for command in (("run", drop), ("resume", "made"), ("warm", drop)):
        done = ryusa_(*command, "--threads", threads)
        assert done.code == 2
        assert f"threads = {threads}: must be at least 1" in done.err


def test_quiet_hides_no_warning_of_the_physics(ryusa_: Any, drop: str) -> None:
    soft = ("--set", "contact.stiffness=0.5 N/cm", "--set", "stop.time=0.2 s")
    said = ryusa_("run", drop, *soft, "-o", "loud")
    done = ryusa_("run", drop, *soft, "-q", "-o", "out")
    warnings = [line for line in said.err.splitlines() if line.startswith("warning: ")]
    assert warnings
    assert done.err.splitlines() == warnings
    assert done.out == ""


def test_quiet_prints_nothing(ryusa_: Any, drop: str) -> None:
    done = ryusa_("run", drop, "-q", "-o", "out", "--set", "stop.time=2 ms")
    assert (done.code, done.out, done.err) == (0, "", "")


def test_a_fault_while_stepping_has_exit_code_3_and_one_message(ryusa_: Any, drop: str) -> None:
    done = ryusa_("run", drop, "-o", "out", "--set", "domain.overlap_limit=1e-5")
    assert done.code == 3
    assert done.err.count("overlap is") == 1
    assert "Traceback" not in done.err
    assert ryusa.Results.open("out").status == "failed"


def test_ctrl_c_ends_with_exit_code_5_and_readable_frames(
    ryusa_: Any, drop: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def engine(named: str | None, threads: int) -> Any:
        from ryusa.engine.cpu.engine import CpuEngine

        class Interrupted(CpuEngine):
            def advance(self, n_steps: int) -> Any:
                flags = super().advance(n_steps)
                if self.state().t > 0.01:
                    os.kill(os.getpid(), signal.SIGINT)
                return flags

        return Interrupted(threads)

    monkeypatch.setattr(runner, "_engine", engine)
    done = ryusa_("run", drop, "-o", "out")
    assert done.code == 5
    assert "ryusa resume out" in done.out
    results = ryusa.Results.open("out")
    assert results.status == "stopped"
    assert len(results.frames) > 5
    assert "Ctrl-C" in results.provenance["message"]


def test_ctrl_c_before_the_first_step_ends_with_exit_code_130(
    ryusa_: Any, drop: str, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def swallowed(case: Any, derived: Any) -> Any:
        with suppress(KeyboardInterrupt):  # as a callback of the compiler does
            os.kill(os.getpid(), signal.SIGINT)
        return built(case, derived)

    built = build.build
    monkeypatch.setattr(build, "build", swallowed)
    done = ryusa_("run", drop)
    assert done.code == 130
    assert "ryusa: interrupted: Ctrl-C before the first step" in done.err
    assert not (here / "runs").exists()


def test_ctrl_c_in_any_command_is_one_line_and_exit_code_130(
    ryusa_: Any, drop: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(build, "build", interrupted)
    done = ryusa_("check", drop)
    assert (done.code, done.err) == (130, "ryusa: interrupted\n")


def test_a_bug_is_not_swallowed(ryusa_: Any, drop: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError("a bug")

    monkeypatch.setattr(runner, "run", fail)
    with pytest.raises(ZeroDivisionError):
        ryusa_("run", drop)


def test_the_schema_is_json(ryusa_: Any) -> None:
    assert "grains" in json.loads(ryusa_("schema").out)["properties"]


def test_the_version_is_that_of_the_package_with_its_commit(ryusa_: Any) -> None:
    known = commit() or "unknown"
    assert ryusa_("--version").out.strip() == f"ryusa {ryusa.__version__} (commit {known})"


def test_the_installed_program_shows_no_traceback(here: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", "from ryusa.cli import main; main()", "run", "nowhere.toml"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("ryusa: ")
    assert "Traceback" not in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys\nfrom ryusa.cli import main\n"
        "try:\n main(['--help'])\nexcept SystemExit: pass\n"
        "heavy = {'numba', 'h5py', 'matplotlib', 'pint', 'numpy'}\n"
        "print('HEAVY', *sorted({m.partition('.')[0] for m in sys.modules} & heavy))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip().splitlines()[-1] == "HEAVY"


def test_a_stopped_run_is_resumed_by_either_command_and_inspect_shows_its_state(
    ryusa_: Any, drop: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from ryusa.running import loop

    asked: list[float] = []
    advance = loop.Loop._advance

    def watched(self: Any, n_steps: int) -> None:
        advance(self, n_steps)
        if asked and self._t > asked[0]:
            asked.pop()
            os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr(loop.Loop, "_advance", watched)
    asked.append(0.01)
    assert ryusa_("run", drop, "-o", "out", "--resume").code == 5
    said = ryusa_("inspect", "out").out
    assert "stopped: SIGTERM at t = 0.01" in said
    assert "checkpoint.h5 at step" in said
    assert "ryusa resume out" in said
    asked.append(0.02)
    assert ryusa_("resume", "out").code == 5
    done = ryusa_("run", drop, "-o", "out", "--resume")
    assert done.code == 0
    assert "resumed at step" in done.err
    said = ryusa_("inspect", "out").out
    assert said.count("resumed ") == 2
    assert "complete: reached" in said
    assert "of the largest term of the energy account" in said
    again = ryusa_("resume", "out")
    assert (again.code, "the run is already complete" in again.err) == (0, True)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["resume", "nowhere"], "nowhere: no such run folder"),
        (["inspect", "nowhere"], "nowhere: no such run folder"),
        (["run", "drop.toml", "--checkpoint", "soon"], "soon"),
        (["run", "drop.toml", "--checkpoint", "0 s"], "must be longer than 0 s"),
        (["run", "drop.toml", "--checkpoint", "-5 min"], "must be longer than 0 s"),
    ],
)
def test_an_invalid_resume_or_option_is_one_line(ryusa_: Any, drop: str, words: list[str], said: str) -> None:
    done = ryusa_(*[drop if word == "drop.toml" else word for word in words])
    assert done.code == 2
    assert said in done.err
    assert "Traceback" not in done.err
