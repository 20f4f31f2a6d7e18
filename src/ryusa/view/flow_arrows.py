"""Arrows of the speed of the water along a row of columns, as a page shows them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.measure.flow_field import speeds_in_cells
from ryusa.results.water import WaterFrames
from ryusa.view.encode import Blob

ALONG, OVER = 40, 12  # arrows at most, along the row and over the depth
NONE, ZERO, STEPS = 0, 128, 127  # bytes: no water there; at rest; of the largest speed either way
REST = 1.0e-9  # speed below which water is at rest, without an arrow [m/s]
FEW = 1.0e-3  # share of the speeds that may lie above the largest shown, which then is theirs


def add_arrows(blob: Blob, found: WaterFrames, frames: NDArray[np.int64]) -> dict[str, Any]:
    """Add the speeds at some of the cells of a row as the array "arrows"; return what a page needs of them.

    Returns
    -------
    at : places x and z of the arrows [m]. The array has the speeds along x and upwards at them as bytes,
        shape (n_frame, n_arrow, 2): NONE where there is no water, else ZERO for rest and STEPS more or less
        for `fastest`.
    fastest : speed of the largest arrow [m/s].
    length : of that arrow [m], the distance between two along the row.
    """
    row = found.row
    n, dz = row.column.n, row.column.dz
    over = max(int((found.content[frames] > 0.0).any(axis=(0, 1)).sum()), 1)  # cells that are wet at any time
    along, up = (max(-(-size // most), 1) for size, most in ((row.n_segment, ALONG), (over, OVER)))
    some = np.ix_(np.arange(along // 2, row.n_segment, along), np.arange(up // 2, n, up))
    z = (row.bottom[:, None] + (np.arange(n) + 0.5) * dz)[some]
    x = np.broadcast_to(row.x[:, None], (row.n_segment, n))[some]
    speeds = np.stack([np.stack(speeds_in_cells(found, int(k)), axis=-1)[some] for k in frames])
    wet = np.isfinite(speeds[..., 0]).any(axis=0)
    speeds = speeds[:, wet]
    size = np.hypot(speeds[..., 0], speeds[..., 1])
    known = size[np.isfinite(size)]
    fastest = float(np.quantile(known, 1.0 - FEW)) if len(known) else 0.0
    if fastest < REST:
        speeds, wet, fastest = speeds[:, :0], np.zeros_like(wet), 1.0
    steps = np.clip(np.rint(STEPS * speeds / fastest), -STEPS, STEPS) + ZERO
    blob.add("arrows", np.where(np.isfinite(speeds), steps, NONE).astype(np.uint8))
    places = np.column_stack([x[wet], z[wet]]).round(6).tolist()
    return {"at": places, "fastest": fastest, "length": along * row.dx}
