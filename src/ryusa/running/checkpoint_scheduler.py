"""When checkpoints are written, and the identity of the run that they belong to."""

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
from ryusa.running.checkpoint import CheckpointBlock, write_checkpoint
from ryusa.running.disk import disk_errors
from ryusa.running.stops import Stop

CHECKPOINT_INTERVAL = 300.0  # s of wall time between two checkpoints
_SHARE = 0.01  # of the run time that checkpoints may take: the interval grows if writing one takes long
# sections of a case that may differ on a resume with --force: no recorded number depends on them
FREE_KEYS = ("stop", "title")
# packages whose version can change the bits of a run
_PACKAGES = ("numpy", "numba", "llvmlite")


class CheckpointScheduler:
    """Writes the checkpoints of one run.

    Parameters
    ----------
    folder : the run folder.
    identity : identity of the run, see `run_identity`.
    scene : as the run began.
    every : wall time between two checkpoints [s]; inf writes only those that a signal requests.
    """

    def __init__(
        self,
        folder: Path,
        identity: Mapping[str, Any],
        scene: Scene,
        every: float = CHECKPOINT_INTERVAL,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._folder, self._identity, self._clock = folder, dict(identity), clock
        self._every = every
        self._wait, self._last = every, clock()
        self._first, self._scene = scene, (scene, "")
        self.size = 0  # of the last checkpoint [B]

    def due(self) -> bool:
        """True when the next checkpoint is due."""
        return self._clock() - self._last >= self._wait

    def write(self, state: CheckpointBlock, scene: Scene, parts: Mapping[str, CheckpointBlock]) -> None:
        """Write a checkpoint; the previous one is kept.

        Raises
        ------
        DiskFull, ResultsError : it was not written; the previous one remains valid.
        """
        begun = self._clock()
        if "scene" not in self._identity:
            self._identity["scene"] = scene_digest(self._first)
        if self._scene[0] is not scene or not self._scene[1]:
            self._scene = (scene, scene_digest(scene))
        identity = CheckpointBlock({**self._identity, "scene_now": self._scene[1]})
        try:
            with disk_errors(self._folder):
                self.size = write_checkpoint(
                    self._folder, CheckpointBlock.merged(identity=identity, state=state, **parts)
                )
        finally:
            self._last = self._clock()
            self._wait = max(self._every, (self._last - begun) / _SHARE)

    def remove_earlier(self) -> None:
        """Delete the checkpoint before the last one, as when the run is complete."""
        (self._folder / schema.CHECKPOINT_BEFORE).unlink(missing_ok=True)


def run_identity(
    origin: Mapping[str, Any],
    resolved: Mapping[str, Any],
    *,
    frames: float,
    stop: Stop,
    changes: Sequence[tuple[float, str]],
) -> dict[str, Any]:
    """Identity of a run, without its scene.

    Parameters
    ----------
    origin : provenance of the writing process.
    resolved : the case as case.json holds it.
    frames : time between frames [s].
    stop : when the run ends.
    changes : time [s] and text of each entry of the timeline.
    """
    return {
        "case": case_digest(resolved),
        "plan": {"frames": frames, "changes": [list(one) for one in changes]},
        "stop": asdict(stop),
        "code": code_versions(origin),
        "engine": origin["engine"],
    }


def code_versions(origin: Mapping[str, Any]) -> dict[str, str]:
    """Versions and processor on which the bits of a run depend, by readable names."""
    packages, machine = _table(origin.get("packages")), _table(origin.get("machine"))
    found = {"ryusa": origin.get("ryusa"), "commit": origin.get("commit")}
    found |= {name: packages.get(name) for name in _PACKAGES}
    found |= {"processor": machine.get("processor"), "architecture": machine.get("architecture")}
    return {name: str(value) for name, value in found.items()}


def _table(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def case_digest(resolved: Mapping[str, Any]) -> str:
    """Digest of a case as case.json holds it, without the keys of `FREE_KEYS`."""
    fixed = {name: one for name, one in resolved.items() if name not in FREE_KEYS}
    return hashlib.sha256(json.dumps(fixed, sort_keys=True).encode()).hexdigest()
