"""Where the loop stands between two calls of the engine: its part of a checkpoint."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import CheckpointError
from ryusa.model import EVENT, Scene
from ryusa.running.checkpoint import Kept


@dataclass(frozen=True)
class Place:
    """Everything the loop would know at this step, had it never been stopped."""

    t_zero: float  # time of step 0 [s]
    first: int  # step of frame 0
    frame: int  # number of the next frame
    changed: int  # entries of the timeline done
    resting: bool  # all grains have been at rest for long enough
    hopped: bool  # every grain has done its saltations
    since: float | None  # since when all grains are slow [s]
    wall: float  # spent so far [s]
    parted: NDArray[np.float64]  # when each grain last left the bed [s], shape (n_grain,)
    hops: NDArray[np.int64]  # saltations by grain, shape (n_grain,)
    gathered: NDArray[np.void]  # contacts that ended since the last stretch was handed over, dtype EVENT

    def kept(self) -> Kept:
        """As numbers and arrays."""
        arrays = {"parted": self.parted, "hops": self.hops, "gathered": self.gathered}
        return Kept({name: value for name, value in vars(self).items() if name not in arrays}, arrays)

    @staticmethod
    def of(kept: Kept, scene: Scene) -> "Place":
        """From a checkpoint.

        Raises
        ------
        CheckpointError : something is missing, or of another kind or shape.
        """
        about, arrays, n = kept.about, kept.arrays, scene.n_grain
        try:
            since, gathered = about["since"], arrays["gathered"]
            place = Place(
                t_zero=float(about["t_zero"]), first=int(about["first"]), frame=int(about["frame"]),
                changed=int(about["changed"]), resting=bool(about["resting"]), hopped=bool(about["hopped"]),
                since=None if since is None else float(since), wall=float(about["wall"]),
                parted=arrays["parted"], hops=arrays["hops"], gathered=gathered,
            )  # fmt: skip
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise CheckpointError(f"the checkpoint does not say where the loop stood ({error})") from error
        ids = (gathered["i"], gathered["j"]) if gathered.dtype == EVENT else ()
        last = n + scene.n_fixed + scene.n_plane
        if (
            (place.parted.shape, place.parted.dtype) != ((n,), np.dtype(np.float64))
            or (place.hops.shape, place.hops.dtype) != ((n,), np.dtype(np.int64))
            or not ids
            or gathered.ndim != 1
            or any(len(one) and not (one.min() >= 0 and one.max() < last) for one in ids)
            or any(len(one) and one.max() >= n for one in ids[:1])
            or not (np.isfinite(place.t_zero) and 0.0 <= place.wall < 1e12)
            or not all(0 <= one < 2**53 for one in (place.first, place.frame, place.changed))
            or not math.isfinite(place.since or 0.0)
        ):
            raise CheckpointError("the checkpoint's place of the loop does not fit the scene")
        return place
