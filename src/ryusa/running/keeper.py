"""When a checkpoint is written, and whose it is."""

import hashlib
import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ryusa.model import Scene
from ryusa.results import schema
from ryusa.results.scene_file import scene_digest
from ryusa.running.checkpoint import Kept, write_checkpoint
from ryusa.running.disk import disk
from ryusa.running.stops import Stop

EVERY = 300.0  # s of wall time between two checkpoints
_SHARE = 0.01  # of the time of a run that checkpoints may take: dear ones are written less often
MAY_CHANGE = (
    "stop",
    "title",
)  # of a case, for who insists: no number that was written depends on it
# what a version of the numbers is made of; the rest of the environment cannot change a bit of them
_PACKAGES = ("numpy", "numba", "llvmlite")


class Keeper:
    """Writes the checkpoints of one run.

    Parameters
    ----------
    folder : the run folder.
    identity : whose checkpoint it is, see `identity_of`.
    scene : as the run began.
    every : wall time between two [s]; inf for none but those asked for.
    """

    def __init__(
        self,
        folder: Path,
        identity: Mapping[str, Any],
        scene: Scene,
        every: float = EVERY,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._folder, self._identity, self._clock = folder, dict(identity), clock
        self._every = every
        self._wait, self._last = every, clock()
        self._first, self._scene = scene, (scene, "")
        self.size = 0  # of the last one [B]

    def due(self) -> bool:
        """Whether it is time for one."""
        return self._clock() - self._last >= self._wait

    def write(self, state: Kept, scene: Scene, parts: Mapping[str, Kept]) -> None:
        """Write one; the one before stays.

        Raises
        ------
        DiskFull, ResultsError : it was not written; the one before is the last good one.
        """
        begun = self._clock()
        if "scene" not in self._identity:
            self._identity["scene"] = scene_digest(self._first)
        if self._scene[0] is not scene or not self._scene[1]:
            self._scene = (scene, scene_digest(scene))
        identity = Kept({**self._identity, "scene_now": self._scene[1]})
        try:
            with disk(self._folder):
                self.size = write_checkpoint(
                    self._folder, Kept.together(identity=identity, state=state, **parts)
                )
        finally:
            self._last = self._clock()
            self._wait = max(self._every, (self._last - begun) / _SHARE)

    def remove(self) -> None:
        """Take the checkpoints away: the run is complete."""
        for name in (schema.CHECKPOINT, schema.CHECKPOINT_BEFORE):
            (self._folder / name).unlink(missing_ok=True)


def identity_of(
    origin: Mapping[str, Any],
    resolved: Mapping[str, Any],
    *,
    frames: float,
    stop: Stop,
    changes: Sequence[tuple[float, str]],
) -> dict[str, Any]:
    """Whose checkpoint it is, beside the scene.

    Parameters
    ----------
    origin : provenance of the process that writes.
    resolved : the case as case.json holds it.
    frames : time between frames [s].
    stop : when the run ends.
    changes : time [s] and words of each entry of the timeline.
    """
    return {
        "case": case_digest(resolved),
        "plan": {"frames": frames, "changes": [list(one) for one in changes]},
        "stop": asdict(stop),
        "code": code_of(origin),
        "engine": origin["engine"],
    }


def code_of(origin: Mapping[str, Any]) -> dict[str, str]:
    """Versions and processor that the bits of a run depend on, by the names a user knows."""
    packages, machine = _table(origin.get("packages")), _table(origin.get("machine"))
    found = {"ryusa": origin.get("ryusa"), "commit": origin.get("commit")}
    found |= {name: packages.get(name) for name in _PACKAGES}
    found |= {"processor": machine.get("processor"), "architecture": machine.get("architecture")}
    return {name: str(value) for name, value in found.items()}


def _table(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def case_digest(resolved: Mapping[str, Any]) -> str:
    """Digest of a case as case.json holds it, less what may change without changing what was written."""
    kept = {name: one for name, one in resolved.items() if name not in MAY_CHANGE}
    return hashlib.sha256(json.dumps(kept, sort_keys=True).encode()).hexdigest()
