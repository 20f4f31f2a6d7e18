"""Spin of saltating grains over the distance they travelled."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure import Spin
from ryusa.measure.spin import TURN


@style.house
def spin(found: Spin, grains: Sequence[int] | None = None, until: float | None = None) -> Figure:
    """Draw spin against distance, in rad/s at the left and turns per second at the right.

    Parameters
    ----------
    found : `measure.spin`.
    grains : columns drawn; default all, the first one dark and the others faint.
    until : distance shown [m]; default all.
    """
    figure, (axes,) = style.new(height=2.5)
    columns = range(found.omega.shape[1]) if grains is None else grains
    far = float(np.abs(found.distance).max(initial=0.0)) if until is None else until
    unit, scale = ("m", 1.0) if far >= 0.1 else ("mm", 1.0e3)
    for order, g in enumerate(columns):
        x = found.distance[:, g]
        keep = x <= until if until is not None else np.ones(len(x), dtype=np.bool_)
        first = order == 0
        axes.plot(
            scale * x[keep], found.omega[keep, g], color=style.COLOURS[0] if first else "#9fb9cc",
            lw=0.9 if first else 0.5, zorder=3 if first else 2,
        )  # fmt: skip
    axes.axhline(0.0, color=style.FAINT, lw=0.5)
    axes.set_xlabel(f"distance along the bed  $x$  ({unit})")
    axes.set_ylabel("spin  $\\omega_y$  (rad/s)")
    axes.margins(x=0.0)
    if not found.omega.any():  # rotation is locked: an automatic scale would show round-off
        axes.set_ylim(-1.0, 1.0)
    axes.tick_params(right=False, which="both")
    right = axes.secondary_yaxis("right", functions=(_turns, _spin))
    right.set_ylabel("turns per second  (1/s)", fontsize=8.0)
    right.tick_params(labelsize=7.0, width=0.6, size=3.0, direction="in")
    return figure


def _turns(omega: Any) -> Any:
    return omega / TURN


def _spin(turns: Any) -> Any:
    return turns * TURN
