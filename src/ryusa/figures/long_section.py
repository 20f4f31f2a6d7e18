"""A row of columns: its long section at one moment, and depth over distance and time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.long_section import THIN, DepthHistory, Floats, LongSection

CM = 100.0  # centimetres in a metre
WATER, LINE, GROUND = "#0072B2", "#D55E00", "#8c6d3f"
DASHED = (0, (5, 2))


@style.house
def long_section(found: LongSection) -> Figure:
    """Draw bottom, water, energy line and critical depth by elevation, and below the Froude number.

    Elevations are vertical, so that water at rest is level whatever the slope of the x axis.
    """
    figure, (above, below) = style.new(
        2, width=style.PAGE, height=3.7, sharex=True, gridspec_kw={"height_ratios": (2.4, 1.0)}
    )
    x, wet = found.x, found.depth > THIN
    bottom, floor, bed, surface, energy = (
        found.elevation(z) * CM for z in (found.bottom, found.floor, found.bed, found.surface, found.energy)
    )
    critical = found.elevation(found.bed + found.critical) * CM
    step = x[1] - x[0] if len(x) > 1 else 1.0
    low = float(np.min(bottom))
    span = float(np.nanmax(np.concatenate([surface, energy[wet]]))) - low
    above.fill_between(x, bottom, low - 0.12 * span, color=style.BED, lw=0.0)
    above.fill_between(x, bottom, surface, where=wet.tolist(), color=WATER, alpha=0.22, lw=0.0)
    if (loose := found.bed > found.floor).any():
        above.fill_between(x, floor, bed, where=loose.tolist(), color=GROUND, alpha=0.6, lw=0.0)
        above.plot(x, bed, color=GROUND, lw=0.9, label="bed")
    for name, first, end in found.dams:
        _dam(above, name, first, end, x, step, bottom, floor)
    above.plot(x, bottom, color="#5a4a2f", lw=0.9)
    above.plot(x, np.where(wet, surface, np.nan), color=WATER, lw=1.2, label="surface")
    above.plot(x, np.where(wet, energy, np.nan), color=LINE, lw=0.8, ls=DASHED, label="energy line")
    steps = np.flatnonzero(np.diff(floor - bottom) != 0.0) + 1  # the critical depth is over the floor
    flows = np.where(wet & (found.critical > THIN), critical, np.nan)
    for k, (at, part) in enumerate(zip(np.split(x, steps), np.split(flows, steps), strict=True)):
        above.plot(at, part, color="black", lw=0.7, ls=":", label="critical depth" if k == 0 else None)
    above.set_ylabel("elevation  (cm)")
    above.set_ylim(low - 0.12 * span, low + 1.12 * span)
    above.legend(loc="upper right", ncols=4, fontsize=6.5)
    above.annotate(
        f"t = {found.t:.4g} s", (0, 1), (4, -4), xycoords="axes fraction", textcoords="offset points",
        va="top", fontsize=7.0,
    )  # fmt: skip
    below.axhline(1.0, color=style.FAINT, lw=0.6)
    below.plot(x, found.froude, color=WATER)
    below.set_ylabel("Froude  (–)")
    below.set_ylim(bottom=0.0)
    below.set_xlabel("distance along the row  $x$  (m)")
    below.margins(x=0.0)
    return figure


def _dam(
    axes: Axes, name: str, first: float, end: float, x: Floats, step: float, bottom: Floats, floor: Floats
) -> None:
    """Draw a dam with its name; one that lets water through as a shade."""
    inside = (x > first) & (x < end)
    low, top = bottom[inside], floor[inside]
    solid = bool((top > low).any())
    if solid:
        sides = np.column_stack([x[inside] - 0.5 * step, x[inside] + 0.5 * step]).ravel()
        axes.fill_between(sides, np.repeat(low, 2), np.repeat(top, 2), color=GROUND, lw=0.0, zorder=3)
    else:
        axes.axvspan(first, end, color=GROUND, alpha=0.25, lw=0.0)
    axes.annotate(
        name, (0.5 * (first + end), float(low.min())), (0, 2), textcoords="offset points", ha="center",
        va="bottom", fontsize=6.2, color="white" if solid else "black", zorder=4,
    )  # fmt: skip


@style.house
def x_t(found: DepthHistory) -> Figure:
    """Draw depth over distance and time; a line marks where the flow is critical."""
    figure, (axes,) = style.new(width=4.8, height=3.4)
    shown = np.where(found.depth > THIN, found.depth, np.nan) * CM
    drawn = axes.pcolormesh(
        found.x, found.t, shown, cmap="Blues", vmin=0.0, shading="nearest", rasterized=True
    )
    figure.colorbar(drawn, ax=axes, label="depth  (cm)", pad=0.02)
    filled = np.nan_to_num(found.froude)
    if len(found.t) > 1 and filled.min() < 1.0 < filled.max():
        axes.contour(found.x, found.t, filled, levels=[1.0], colors=LINE, linewidths=0.8)
        axes.plot([], [], color=LINE, lw=0.8, label="Froude number 1")
        axes.legend(loc="upper left", fontsize=6.5, frameon=True, framealpha=0.9, edgecolor="none")
    for _, first, end in found.dams:
        axes.axvspan(first, end, ymax=0.02, color=GROUND, lw=0.0)
    axes.set_xlabel("distance along the row  $x$  (m)")
    axes.set_ylabel("time  $t$  (s)")
    return figure
