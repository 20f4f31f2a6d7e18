"""ryusa, run like a peer: in a process of its own, by the door a user's script takes."""

import hashlib
import json
import os
import sys
from dataclasses import dataclass, field
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

from peer import Job
from workloads import TOTAL

ALONE = ", one thread"
AT_STEPS, EXACT = "at steps", "exact"


ROOMS = ("laws", "model", "engine", "water", "running", "results")  # what a timed run runs through


def digest() -> str:
    """Digest of the sources of those rooms: figures hold as long as it stays."""
    root = Path(str(files("ryusa")))
    found = hashlib.sha256()
    for path in sorted(path for room in ROOMS for path in root.joinpath(room).rglob("*.py")):
        found.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    return found.hexdigest()[:16]


@dataclass(frozen=True)
class Ryusa:
    """ryusa with the slip rule of a peer; finds its own skin."""

    slip: str = TOTAL
    timing: str = AT_STEPS  # when contacts begin and end
    cache: Path | None = None  # where compiled kernels are kept; numba's own place when not given
    alone: bool = False  # on one thread beside others of more, for the efficiency
    label: str = ""
    skins: dict[str, tuple[float, ...]] = field(default_factory=dict)
    share: float = 1.0

    @property
    def name(self) -> str:
        exact = "" if self.timing == AT_STEPS else f", {self.timing}"
        return f"ryusa ({self.slip}{exact}){ALONE if self.alone else ''}"

    def version(self) -> str:
        from ryusa.version import commit

        return f"{version('ryusa')} ({(commit() or '?')[:9]})"

    def command(self, job: Job, folder: Path) -> tuple[list[str], dict[str, str]]:
        environment = dict(os.environ)
        if self.cache is not None:
            environment["NUMBA_CACHE_DIR"] = str(self.cache)
        ours = Path(__file__).resolve().parent / "ours.py"
        return [
            sys.executable,
            str(ours),
            json.dumps(job.plain() | {"slip": self.slip, "timing": self.timing}),
        ], environment

    def read(self, job: Job, folder: Path, said: str) -> tuple[float, dict[str, Any]]:
        found = json.loads(said.splitlines()[-1])
        return float(found.pop("loop")), found
