"""Speeds and pressure of the water within a row of columns."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.figures.long_section import GROUND, WATER, largest_but_few
from ryusa.measure._run import Floats
from ryusa.measure.flow_field import FlowField

ARROWS = 34, 13  # at most, along the row and over the depth
LONGEST = 0.28  # of an arrow of the speed that all but a few do not exceed [inch]
SMALL = 1.0e-9  # speed below which water is at rest [m/s]


class Scales(NamedTuple):
    """What axes, arrows and colours reach."""

    speed: float  # that all but a few do not exceed [m/s]
    pressure: float  # the same, without its sign [Pa]
    top: float  # of surface and bed over the x axis [m]


def scales_of(moments: Sequence[FlowField]) -> Scales:
    """Scales that cover several moments of a run, as in a film."""
    speeds = np.concatenate([np.hypot(one.u, one.w).ravel() for one in moments])
    pressures = [one.pressure.ravel() for one in moments if one.pressure is not None]
    pressure = largest_but_few(np.concatenate(pressures)) if pressures else 0.0
    top = max(float(np.maximum(one.surface, one.bed).max()) for one in moments)
    return Scales(largest_but_few(speeds), pressure, top)


@style.house
def flow_field(
    found: FlowField, scales: Scales | None = None, *, height: float = 3.0, words: str | None = None
) -> Figure:
    """Draw arrows of the speed over colours of the pressure, or of the speed where it is hydrostatic.

    Heights are over the x axis and normal to it. Arrows point along the path on the picture, whatever its
    scales, and are as long as the speed.

    Parameters
    ----------
    scales : that axes, arrows and colours have; default those of this moment.
    height : of the figure [inch].
    words : above the figure, in place of the time in it.
    """
    figure, axes = style.new(1, width=style.PAGE, height=height)
    scales = scales or scales_of([found])
    x, own, most = found.x, found.pressure, scales.speed
    step = x[1] - x[0] if len(x) > 1 else 1.0
    edges, speed = np.append(x - 0.5 * step, x[-1] + 0.5 * step), np.hypot(found.u, found.w)
    dz = found.z[0, 1] - found.z[0, 0]
    if own is None:
        values, label, low, high, colours = speed, "speed  (m/s)", 0.0, most, "Blues"
    else:
        values, label, colours = own, "pressure beyond the hydrostatic one  (Pa)", "RdBu_r"
        high = scales.pressure
        low = -high
    # corners of cells; each segment has heights of its own, so that between two lies a strip without colour
    corners = np.column_stack([found.z - 0.5 * dz, found.z[:, -1] + 0.5 * dz])
    z, sides = np.repeat(corners, 2, axis=0), np.repeat(edges, 2)[1:-1]
    shown = np.full((2 * len(x) - 1, values.shape[1]), np.nan)
    shown[::2] = values
    drawn = axes[0].pcolormesh(
        np.broadcast_to(sides[:, None], z.shape), 100.0 * z, shown, vmin=low, vmax=high, cmap=colours,
        rasterized=True,
    )  # fmt: skip
    figure.colorbar(drawn, ax=axes[0], label=label, pad=0.02, extend="max" if own is None else "both")
    _lines(axes[0], found, edges)
    low = 100.0 * float(found.floor.min())
    high = 100.0 * scales.top
    axes[0].set_xlim(edges[0], edges[-1])
    axes[0].set_ylim(low - 0.03 * (high - low), high + 0.06 * (high - low))
    axes[0].set_xlabel("distance along the row  $x$  (m)")
    axes[0].set_ylabel("height over the x axis  (cm)")
    if words is None:
        axes[0].annotate(
            f"t = {found.t:.4g} s", (0, 1), (0, 3), xycoords="axes fraction", textcoords="offset points",
            fontsize=7.0,
        )  # fmt: skip
    else:
        figure.suptitle(words, fontsize=8.0)
    style.legend_above(axes[0], 3, loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=6.5)
    figure.draw_without_rendering()  # lays the axes out
    _arrows(axes[0], found, most)
    return figure


def _lines(axes: Axes, found: FlowField, edges: Floats) -> None:
    """Surface, bed and floor, level over each segment where it is solid."""
    axes.stairs(
        100.0 * found.floor,
        edges,
        baseline=100.0 * float(found.floor.min()) - 1e3,
        fill=True,
        color=style.BED,
        lw=0.0,
    )
    wet = found.surface > found.floor
    axes.plot(found.x, np.where(wet, 100.0 * found.surface, np.nan), color=WATER, lw=1.2, label="surface")
    if (found.bed > found.floor).any():
        bed = np.where(found.bed > found.floor, 100.0 * found.bed, np.nan)
        axes.plot(found.x, bed, color=GROUND, lw=1.0, label="bed")


def _arrows(axes: Axes, found: FlowField, most: float) -> None:
    """Arrows at some of the cells with water."""
    wet = np.isfinite(found.u)
    if not wet.any() or not float(np.nanmax(np.hypot(found.u, found.w))) > SMALL:
        return
    cells = np.flatnonzero(wet.any(axis=0))
    every = [max(-(-size // few), 1) for size, few in zip((len(found.x), len(cells)), ARROWS, strict=True)]
    some = np.ix_(np.arange(every[0] // 2, len(found.x), every[0]), cells[every[1] // 2 :: every[1]])
    at, there = np.broadcast_to(found.x[:, None], wet.shape)[some], wet[some]
    u, w = found.u[some][there], found.w[some][there]
    box, (left, right), (low, high) = axes.get_window_extent(), axes.get_xlim(), axes.get_ylim()
    along, up = u * box.width / (right - left), 100.0 * w * box.height / (high - low)
    size = np.hypot(along, up)
    longer = LONGEST / most * np.divide(np.hypot(u, w), size, out=np.zeros(len(u)), where=size > 0.0)
    drawn = axes.quiver(
        at[there], 100.0 * found.z[some][there], along * longer, up * longer, scale=1.0, scale_units="inches",
        width=0.0014, headwidth=4.0, headlength=4.5, minlength=0.5, color="black", zorder=3,
    )  # fmt: skip
    shown = float(f"{most:.1g}")
    axes.quiverkey(
        drawn,
        0.40,
        1.04,
        shown * LONGEST / most,
        f"{shown:g} m/s",
        labelpos="E",
        fontproperties={"size": 6.5},
    )
