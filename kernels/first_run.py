"""The first run of a packaged case, short: every command that steps, reads or draws it."""

import os
import subprocess
from pathlib import Path

STEPS = 400


def first_run(ryusa: list[str], name: str, file: Path, run: Path) -> dict[str, float]:
    """Type the commands of a first run into a run folder.

    Parameters
    ----------
    ryusa : how ryusa is called.
    name, file : of the case.
    run : run folder; replaced.

    Returns
    -------
    took : processor time of each command [s].
    """
    from ryusa.casefile import derive
    from ryusa.casefile.read import read

    case = read(file)
    end, changes = STEPS * derive(case).dt, len(case.timeline)
    short = {"stop.time": f"{end!r} s", "record.frames": f"{end / 4!r} s", "record.settle": "0 s"}
    short |= {f"timeline.{k}.at": f"{end * (k + 1) / (changes + 1)!r} s" for k in range(changes)}
    later = {"stop.time": f"{1.5 * end!r} s"}
    commands = {
        "run": [file, "-o", run, "--overwrite", "--quiet", *_settings(short)],
        "resume": [run, "--quiet", "--force", *_settings(later)],  # feeds end with the first part
        "report": [run, "--quiet"],
        "film": [run, "--frames", "2", "--size", "480x270", "--quiet"],
    }
    took: dict[str, float] = {}
    for command, words in commands.items():
        before = os.times()
        done = subprocess.run(
            [*ryusa, command, *map(str, words)], check=False, capture_output=True, text=True
        )
        if done.returncode:
            raise SystemExit(f"{name}: ryusa {command} failed\n{done.stdout}{done.stderr}")
        after = os.times()
        took[command] = sum(after[2:4]) - sum(before[2:4])
    return took


def _settings(given: dict[str, str]) -> list[str]:
    return [word for key, value in given.items() for word in ("--set", f"{key}={value}")]
