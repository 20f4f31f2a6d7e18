"""Frames of a run as few bytes: whole numbers, differences in time, bytes split by place, deflate."""

import zlib
from collections.abc import Callable
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.colors import to_hex
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.results import Results
from ryusa.view.colouring import COLOURINGS, Colouring, Floats, value_range

STEPS_PER_DIAMETER = 100  # positions are rounded to this part of the smallest diameter shown
LEVELS = 64  # of a colour scale
_MOST = 2.0**28  # largest whole number of a position: second differences must fit 32 bits


class Blob:
    """Compressed arrays one behind the other, and what a reader must know of each."""

    def __init__(self) -> None:
        self.contents: dict[str, dict[str, Any]] = {}
        self._pieces: list[bytes] = []
        self._size = 0

    def add(self, name: str, array: NDArray[Any], **how: Any) -> None:
        """Add the bytes of an array under a name."""
        packed = zlib.compress(array.tobytes(), 9)
        kind = {"shape": list(array.shape), "type": array.dtype.name}
        self.contents[name] = {"from": self._size, "bytes": len(packed), **kind, **how}
        self._pieces.append(packed)
        self._size += len(packed)

    def bytes(self) -> bytes:
        """All of it."""
        return b"".join(self._pieces)


def positions(
    results: Results,
    frames: NDArray[np.int64],
    grains: NDArray[np.int64],
    progress: Callable[[int], None],
) -> tuple[NDArray[np.int32], Floats]:
    """Unwrapped centres as whole numbers.

    Returns
    -------
    whole : shape (n_frame, n_grain, 3).
    quantum : length of one [m], shape (3,). A period is a whole number of them, so that a grain can be taken
        back into the period without a rounding error.
    """
    scene = results.scene
    there = presence(results, frames, grains)
    quantum = np.full(3, float(scene.d[grains].min()) / STEPS_PER_DIAMETER)
    for axis, period in enumerate(scene.period):
        if np.isfinite(period):
            quantum[axis] = period / np.ceil(period / quantum[axis])
    whole = np.empty((len(frames), len(grains), 3), dtype=np.int32)
    for row, k in enumerate(frames):
        x = results.frames.x[int(k)][grains] / quantum
        if there is not None:
            x[~there[row]] = 0.0
        wrong = np.flatnonzero(~(np.abs(x) < _MOST).all(axis=1))
        if len(wrong):
            grain = int(grains[wrong[0]])
            raise ResultsError(
                f"{results.folder}: grain {grain} is at {results.frames.x[int(k), grain]} m in the frame at "
                f"t = {results.frames.t[int(k)]:g} s; what is farther than {_MOST * quantum.min():.3g} m "
                "from the origin, or not a number, cannot be shown"
            )
        whole[row] = np.rint(x)
        progress(row)
    if there is not None:
        _fill(whole, there)
    return whole, quantum


def presence(
    results: Results, frames: NDArray[np.int64], grains: NDArray[np.int64]
) -> NDArray[np.bool_] | None:
    """Whether grains are there in frames, shape (n_frame, n_grain); None where they always are."""
    if results.scene.traffic is None:
        return None
    return np.stack([np.isfinite(results.frames.x[int(k)][grains, 0]) for k in frames])


def _fill(whole: NDArray[np.int32], there: NDArray[np.bool_]) -> None:
    """Put a grain that is away where it was last, or else where it will be first, or is another one."""
    n_frame, n_grain = there.shape
    row = np.arange(n_frame)[:, None]
    last = np.maximum.accumulate(np.where(there, row, -1), axis=0)
    following = np.minimum.accumulate(np.where(there, row, n_frame)[::-1], axis=0)[::-1]
    source = np.where(last >= 0, last, np.minimum(following, n_frame - 1))
    whole[:] = whole[source, np.arange(n_grain)]
    seen = np.argwhere(there)
    if len(seen):
        whole[:, ~there.any(axis=0)] = whole[tuple(seen[0])]


def add_positions(blob: Blob, whole: NDArray[np.int32]) -> None:
    """Second differences in time, axis by axis, signs in the lowest bit, bytes split by their place."""
    change = whole.astype(np.int64)
    change[1:] = np.diff(whole, axis=0)
    change[2:] = np.diff(change[1:], axis=0)
    folded = np.where(change < 0, -2 * change - 1, 2 * change).astype(np.uint32).transpose(2, 0, 1)
    places = max(1, (int(folded.max(initial=0)).bit_length() + 7) // 8)
    split = np.stack([(folded >> (8 * place)) & 255 for place in range(places)]).astype(np.uint8)
    blob.add("x", split, places=places)


def add_colours(
    blob: Blob, results: Results, frames: NDArray[np.int64], grains: NDArray[np.int64]
) -> list[dict[str, Any]]:
    """Add the levels of every colouring; return its words, scale and colours for the page."""
    return [_colouring(blob, one, results, frames, grains) for one in COLOURINGS]


def _colouring(
    blob: Blob,
    one: Colouring,
    results: Results,
    frames: NDArray[np.int64],
    grains: NDArray[np.int64],
) -> dict[str, Any]:
    chosen = frames[:1] if one.steady else frames
    values = np.stack([one.values(results, int(k))[grains] for k in chosen])
    there = np.isfinite(values)
    low, high = value_range(one, values if there.all() else values[there], results.scene)
    values = np.where(there, values, low)
    if one.word != "height":  # the page has the heights already
        level = np.rint((values - low) / (high - low) * (LEVELS - 1))
        level = np.clip(level, 0, LEVELS - 1).astype(np.uint8)
        change = np.diff(level, axis=0, prepend=np.zeros_like(level[:1]))  # modulo 256
        whole, differences = (len(zlib.compress(each.tobytes(), 6)) for each in (level, change))
        if differences < whole:
            blob.add(one.word, change, differences=True)
        else:
            blob.add(one.word, level, differences=False)
    return {
        "word": one.word, "label": one.label, "unit": one.unit,
        "low": low * one.scale, "high": high * one.scale,
        "colours": [to_hex(colour) for colour in mpl.colormaps[one.colours](np.linspace(0.0, 1.0, LEVELS))],
    }  # fmt: skip
