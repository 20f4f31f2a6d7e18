"""State of the time loop between two calls of the engine: its part of a checkpoint."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import CheckpointError
from ryusa.model import EVENT, Scene
from ryusa.running.checkpoint import CheckpointBlock


@dataclass(frozen=True)
class LoopState:
    """All that the loop needs to continue as if it had not been stopped."""

    t_zero: float  # time of step 0 [s]
    first: int  # step of frame 0
    frame: int  # number of the next frame
    changed: int  # entries of the timeline applied
    resting: bool  # all grains have been at rest for long enough
    hopped: bool  # every grain has made the required saltations
    since: float | None  # time since which all grains are slow [s]
    wall: float  # wall time so far [s]
    parted: NDArray[np.float64]  # when each grain last left the bed [s], shape (n_grain,)
    hops: NDArray[np.int64]  # saltations by grain, shape (n_grain,)
    gathered: NDArray[np.void]  # contacts that ended and are not yet recorded, dtype EVENT
    compiled: float  # wall time in which the run compiled [s]

    def to_block(self) -> CheckpointBlock:
        """Convert to numbers and arrays for a checkpoint."""
        arrays = {"parted": self.parted, "hops": self.hops, "gathered": self.gathered}
        return CheckpointBlock(
            {name: value for name, value in vars(self).items() if name not in arrays}, arrays
        )

    @staticmethod
    def from_block(block: CheckpointBlock, scene: Scene) -> "LoopState":
        """Read from a checkpoint.

        Raises
        ------
        CheckpointError : a value is missing, or has another type or shape.
        """
        about, arrays, n = block.values, block.arrays, scene.n_grain
        try:
            since, gathered = about["since"], arrays["gathered"]
            state = LoopState(
                t_zero=float(about["t_zero"]), first=int(about["first"]), frame=int(about["frame"]),
                changed=int(about["changed"]), resting=bool(about["resting"]), hopped=bool(about["hopped"]),
                since=None if since is None else float(since), wall=float(about["wall"]),
                parted=arrays["parted"], hops=arrays["hops"], gathered=gathered,
                compiled=float(about["compiled"]),
            )  # fmt: skip
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise CheckpointError(
                f"the state of the loop in the checkpoint is incomplete ({error})"
            ) from error
        ids = (gathered["i"], gathered["j"]) if gathered.dtype == EVENT else ()
        last = scene.n_partner
        if (
            (state.parted.shape, state.parted.dtype) != ((n,), np.dtype(np.float64))
            or (state.hops.shape, state.hops.dtype) != ((n,), np.dtype(np.int64))
            or not ids
            or gathered.ndim != 1
            or any(len(one) and not (one.min() >= 0 and one.max() < last) for one in ids)
            or any(len(one) and one.max() >= n for one in ids[:1])
            or not (np.isfinite(state.t_zero) and 0.0 <= state.compiled <= state.wall < 1e12)
            or not all(0 <= one < 2**53 for one in (state.first, state.frame, state.changed))
            or not math.isfinite(state.since or 0.0)
        ):
            raise CheckpointError("the state of the loop in the checkpoint does not match the scene")
        return state
