"""A small sweep of bed load that tests carry out in several ways, and what they look at."""

import json
import shutil
import subprocess
import sys
import time
from pathlib import Path

from ryusa.cases import case_path

CASE = "be'd $(touch harm).toml"  # a name that would do harm in a shell that is not careful
OUT = "o'ut $(touch harm)"
PLACE = 'it\'s $(touch harm) `touch harm` "a" & b'
SHORT = {
    "build.length": "3 cm", "build.layers": "2", "stop.time": "4 s", "record.settle": "1 s",
    "record.frames": "20 ms",
}  # fmt: skip
STUDY = """'Twice a number.'
from ryusa.study import calculation

def twice(x):
    return {"y": 2.0 * x}

def tasks(plan):
    return [calculation(twice, x=float(seed)) for seed in plan.seeds]

def measure(results, task):
    raise AssertionError("there is no run")

def rows(found, plan):
    return [{"x": dict(task.arguments)["x"], "y": float(one["y"])} for task, one in found.items()]

def judge(found, plan):
    return []
"""
PATIENCE = 300.0  # s: the machine may be busy


def words(out):
    """Arguments of `ryusa` for the sweep, in the folder of its case."""
    settings = [word for key, value in SHORT.items() for word in ("--set", f"{key}={value}")]
    return ["sweep", CASE, "--over", "motion.slope=0.02,0.04", "--seeds", "2", "-m", "transport", *settings,
            "-o", str(out), "--no-pages"]  # fmt: skip


def start(place, *more):
    """The sweep as a command of its own."""
    command = [sys.executable, "-c", "from ryusa.cli import main; main()", *words(OUT), *more]
    return subprocess.Popen(command, cwd=place, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def finish(process):
    """Exit code, and all that it said."""
    said, errors = process.communicate(timeout=PATIENCE)
    return process.returncode, said + errors


def new_place(folder):
    """A folder with an awkward name and the case in it."""
    place = Path(folder) / PLACE
    place.mkdir()
    shutil.copy(case_path("bedload_3d.toml"), place / CASE)
    return place


def table(place):
    return (place / OUT / "sweep.csv").read_bytes()


def table_by_processes(folder):
    """The table as processes of this machine make it."""
    place = new_place(folder)
    code, said = finish(start(place, "-j", "1", "-q"))
    assert code == 0, said
    return table(place)


def wait_until(ready, process=None):
    """Wait until something is so, as long as a command runs."""
    late = time.monotonic() + PATIENCE
    while not ready():
        assert time.monotonic() < late, "waited too long"
        if process is not None and process.poll() is not None:
            raise AssertionError("ended too early: " + "".join(process.communicate()))
        time.sleep(0.05)


def states(place):
    """Status of every run."""
    kept = (place / OUT).glob("runs/*/provenance.json")
    return [json.loads(one.read_text())["status"] for one in kept]


def under_way(place):
    """Simulated time of every run that has begun [s]."""
    times = [json.loads(one.read_text())["t"] for one in (place / OUT).glob("runs/*/summary.json")]
    return [one for one in times if 0.0 < one < 4.0]


def continued(place):
    """Number of runs that went on from a checkpoint."""
    kept = (json.loads(one.read_text()) for one in (place / OUT).glob("runs/*/provenance.json"))
    return sum(bool(one.get("resumed")) for one in kept)


def harmed(folder):
    """Files that a careless shell would have made."""
    return list(Path(folder).rglob("harm"))
