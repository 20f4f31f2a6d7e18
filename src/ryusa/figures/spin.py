"""Spin of grains over the distance they travelled, and its distribution."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure import Spin
from ryusa.measure.spin import TURN
from ryusa.model.scene import Floats

FEW = 3  # grains drawn one by one
BINS = 80


@style.house
def spin(found: Spin, grains: Sequence[int] | None = None, until: float | None = None) -> Figure:
    """Draw spin against distance, in rad/s at the left and turns per second at the right.

    Parameters
    ----------
    found : `measure.spin`.
    grains : ids of the grains drawn; default all of up to three, else the three that travelled farthest.
    until : distance shown [m]; default all.

    Notes
    -----
    Of more than three grains that turn a second panel shows the distribution over all of them and all frames
    after settling.
    """
    settled = found.omega[found.t >= found.settled]
    many = found.omega.shape[1] > FEW and bool(settled.any())
    figure, axes = style.new(
        1, 1 + many, width=style.PAGE if many else style.COLUMN, height=2.7, sharey=True,
        gridspec_kw={"width_ratios": [2.2, 1.0] if many else [1.0]},
    )  # fmt: skip
    _over_distance(axes[0], found, found.farthest(FEW) if grains is None else list(grains), until)
    if grains is None and found.omega.shape[1] > FEW:
        _legend(axes[0], f"the {FEW} of {found.omega.shape[1]} grains that travelled farthest")
    if many:
        _distribution(axes[1], found, settled)
    axes[0].set_ylabel("spin  $\\omega_y$  (rad/s)")
    if not found.omega.any():  # rotation is locked: an automatic scale would show round-off
        axes[0].set_ylim(-1.0, 1.0)
    axes[-1].tick_params(right=False, which="both")
    right = axes[-1].secondary_yaxis("right", functions=(_turns, _spin))
    right.set_ylabel("turns per second  (1/s)", fontsize=8.0)
    right.tick_params(labelsize=7.0, width=0.6, size=3.0, direction="in")
    return figure


def _over_distance(axes: Axes, found: Spin, grains: Sequence[int], until: float | None) -> None:
    far = float(np.abs(found.distance[:, grains]).max(initial=0.0)) if until is None else until
    unit, scale = ("m", 1.0) if far >= 0.1 else ("mm", 1.0e3)
    for order, g in enumerate(grains):
        x = found.distance[:, g]
        keep = x <= until if until is not None else np.ones(len(x), dtype=np.bool_)
        axes.plot(
            scale * x[keep], found.omega[keep, g], color=style.COLOURS[order % len(style.COLOURS)], lw=0.7,
            label=f"grain {g}", zorder=3.0 - 0.01 * order,
        )  # fmt: skip
    axes.axhline(0.0, color=style.FAINT, lw=0.5)
    axes.set_xlabel(f"distance along the bed  $x$  ({unit})")
    axes.margins(x=0.0)


def _distribution(axes: Axes, found: Spin, settled: Floats) -> None:
    """Probability density of the spin of all grains at all frames after settling; the mean is dashed."""
    axes.hist(
        settled.ravel(), BINS, density=True, orientation="horizontal", color=style.COLOURS[0], alpha=0.35
    )
    axes.set_xscale("log")
    axes.axhline(0.0, color=style.FAINT, lw=0.5)
    mean = found.averages["spin"].value
    axes.axhline(mean, color="black", lw=0.8, ls="--", label=f"mean {mean:.3g} rad/s")
    _legend(axes, f"all grains from $t$ = {found.settled:.3g} s on")
    axes.set_xlabel("probability density  (s/rad)")


def _legend(axes: Axes, title: str) -> None:
    """A legend above the panel."""
    axes.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, ncols=FEW, fontsize=6.3, title=title,
        title_fontsize=6.3, alignment="left", columnspacing=1.2,
    )  # fmt: skip


def _turns(omega: Any) -> Any:
    return omega / TURN


def _spin(turns: Any) -> Any:
    return turns * TURN
