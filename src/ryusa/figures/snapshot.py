"""Grains at one moment in the x-z plane, to scale, with bed, planes and the edges of walls."""

import math
from typing import Any, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from ryusa.figures import style
from ryusa.measure import Bounds, Snapshot
from ryusa.measure.repose import STILL, G
from ryusa.model.scene import Floats

CM = 100.0  # centimetres in a metre
WET, SURFACE = "#e8f1f8", "#0072B2"  # water, and its surface
PLAIN, RIM, SOLID = "#cfdce8", "#3c4a57", "#d8d4cc"
EDGE = "#6f695f"  # of planes and walls
WIDE = 2.2  # ratio of the sides above which a picture is two columns wide
METRES = 3.0  # width above which a picture has its lengths in metres [m]
LEVEL = 1.0e-4  # angle up to which the x axis is level [rad]
SLIM, LOW = 0.75, 9.0  # smallest and largest width over height
BAR = 0.065  # height of the colour bar [inch]
AROUND, ABOVE = 0.62, 0.16  # height of labels around the panel, and of a colour bar with its ticks [inch]

Colour = Literal["speed", "spin", "none"]
Box = tuple[float, float, float, float]  # left, right, bottom, top [m]


@style.house
def snapshot(seen: Snapshot, colour: Colour = "speed", bounds: Bounds | None = None) -> Figure:
    """Draw grains as circles, coloured by their speed or spin or all alike.

    Parameters
    ----------
    seen : `measure.snapshot`. Rows in y are drawn one before the other, the nearest (smallest y) last.
    colour : "speed", "spin" (about y, positive rolls towards +x) or "none".
    bounds : box and colour scale, such as `measure.bounds` gives for a run; default those of the moment.
    """
    bounds = bounds or seen.bounds
    figure, axes = panel(seen, 0.0 if colour == "none" else ABOVE, bounds)
    if colour == "none":
        grains(axes, seen, PLAIN)
        return figure
    if colour == "speed":
        values, text, hue = seen.speed, "speed  (m/s)", "YlGnBu"
        still = STILL * math.sqrt(G * float(seen.d.mean())) if len(seen.d) else 1.0
        # So that noise of grains at rest does not fill the scale
        scale = Normalize(0.0, max(bounds.speed, still))
    else:
        values, text, hue = seen.spin, "spin  $\\omega_y$  (rad/s)", "RdBu_r"
        most = max(bounds.spin, 1.0)
        scale = Normalize(-most, most)
    shown = ScalarMappable(scale, mpl.colormaps[hue])
    grains(axes, seen, shown.to_rgba(values))
    _bar(figure, axes, shown, text)
    return figure


def panel(seen: Snapshot, above: float = 0.0, bounds: Bounds | None = None) -> tuple[Figure, Axes]:
    """Axes in cm with bed, planes and time; `above` [inch] of free height above; sized to fit the bounds."""
    box = _box(bounds or seen.bounds, seen.period)
    wide, high = box[1] - box[0], box[3] - box[2]
    width = style.PAGE if wide / high >= WIDE else style.COLUMN
    figure, (axes,) = style.new(width=width, height=(width - 0.55) * high / wide + AROUND + above)
    axes.set_xlim(box[0] * CM, box[1] * CM)
    axes.set_ylim(box[2] * CM, box[3] * CM)
    axes.set_aspect("equal")
    inclined = abs(seen.fall) > LEVEL
    falls = f", falls by {math.degrees(seen.fall):.3g}°" if inclined else ""
    axes.set_xlabel(f"$x${falls}  (cm)")
    axes.set_ylabel("$z$ normal to $x$  (cm)" if inclined else "$z$ above datum  (cm)")
    axes.tick_params(top=False, right=False)
    _in_metres(axes, wide)
    text = f"$t$ = {seen.t:.4g} s" + (f", lane {seen.lane} of {seen.lanes}" if seen.lanes > 1 else "")
    axes.annotate(text, (0, 1), (0, 4), xycoords="axes fraction", textcoords="offset points", fontsize=7.0)
    if math.isfinite(seen.surface):
        _water(axes, seen.surface, box, seen.period)
    if len(seen.along_row):
        _row(axes, seen.along_row)
    planes(axes, seen.plane_point, seen.plane_normal, box, CM)
    if len(seen.wall_lines):
        edges, y = CM * seen.wall_lines[:, :, [0, 2]], seen.wall_lines[:, :, 1].max(axis=1)
        before = y <= seen.x[:, 1].min(initial=math.inf)  # as seen along y
        for chosen, zorder in ((~before, 0.6), (before, 2.5)):
            axes.add_collection(LineCollection([*edges[chosen]], colors=EDGE, lw=0.9, zorder=zorder))
    circles(axes, seen.bed_x, seen.bed_d, style.BED, "#8c8578", period=seen.period)
    return figure, axes


def _in_metres(axes: Axes, wide: float) -> None:
    """Label axes of a picture that is some metres wide [m] in metres, although they are in centimetres."""
    if wide > METRES:
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter(lambda value, _: f"{value / CM:g}".replace("-", "\N{MINUS SIGN}"))
            axis.set_label_text(axis.get_label_text().replace("(cm)", "(m)"))


def grains(axes: Axes, seen: Snapshot, colours: Any, zorder: float = 2.0) -> None:
    """Draw the free grains; `colours` is one or one per grain."""
    circles(axes, seen.x, seen.d, colours, RIM, period=seen.period, zorder=zorder)


def _water(axes: Axes, surface: float, box: Box, period: float) -> None:
    """Shade the water within the period, and mark its surface with the usual triangle."""
    low, high = box[2] * CM, surface * CM
    ends = np.array([max(box[0], 0.0), min(box[1], period)] if math.isfinite(period) else box[:2]) * CM
    axes.fill_between(ends, low, high, color=WET, lw=0.0, zorder=0.2)
    axes.plot(ends, [high, high], color=SURFACE, lw=0.8, zorder=0.4)
    x = 0.97 * ends[1] + 0.03 * ends[0]
    axes.plot([x], [high], marker=7, ms=4.5, color=SURFACE, mew=0.0, zorder=3.0)  # with its tip on the line


def _row(axes: Axes, along: Floats) -> None:
    """Shade the water and the dams of a row of columns, and draw its surface."""
    x, bottom, floor, surface = (CM * along).T
    half = 0.5 * (x[1] - x[0]) if len(x) > 1 else 0.0
    at = np.concatenate([x[:1] - half, x, x[-1:] + half])  # to the ends of the first and the last segment
    bottom_at, surface_at = (np.concatenate([z[:1], z, z[-1:]]) for z in (bottom, surface))
    axes.fill_between(
        at, bottom_at, surface_at, where=np.isfinite(surface_at).tolist(), color=WET, lw=0.0, zorder=0.2
    )
    axes.plot(at, surface_at, color=SURFACE, lw=0.8, zorder=0.4)
    for k in np.flatnonzero(floor > bottom):
        corners = [(x[k] - half, bottom[k]), (x[k] + half, bottom[k]), (x[k] + half, floor[k])]
        corners.append((x[k] - half, floor[k]))
        axes.add_patch(Polygon(np.array(corners), closed=True, fc=SOLID, ec="none", zorder=0.5))


def circles(
    axes: Axes, x: Any, d: Any, face: Any, rim: str, *, period: float = math.inf, zorder: float = 1.0
) -> None:
    """Circles to scale at x [m], the farthest (largest y) first, repeated across periodic limits."""
    which, shift = np.arange(len(d)), np.zeros(len(d))
    if math.isfinite(period):
        low, high = np.flatnonzero(x[:, 0] < 0.5 * d), np.flatnonzero(x[:, 0] > period - 0.5 * d)
        which = np.concatenate([which, low, high])
        shift = np.concatenate([shift, np.full(len(low), period), np.full(len(high), -period)])
    order = np.argsort(-x[which, 1], kind="stable")
    which, shift = which[order], shift[order]
    size, places = CM * d[which], CM * (x[which][:, [0, 2]] + np.outer(shift, [1.0, 0.0]))
    axes.add_collection(
        EllipseCollection(
            size, size, np.zeros(len(size)), units="xy", offsets=places, offset_transform=axes.transData,
            facecolor=face[which] if isinstance(face, np.ndarray) else face, edgecolor=rim,
            linewidth=0.3 if len(d) < 1500 else 0.1, zorder=zorder,
        )
    )  # fmt: skip


def planes(axes: Axes, point: Any, normal: Any, box: Box, unit: float) -> None:
    """Shade the solid behind each plane within a box [m]; `unit` is the number of axis units per metre."""
    left, right, bottom, top = box
    corners = np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
    for p, n in zip(np.asarray(point)[:, [0, 2]], np.asarray(normal)[:, [0, 2]], strict=True):
        outside = (corners - p) @ n
        shape: list[Any] = []
        edge: list[Any] = []
        for k in range(4):  # clip the box by the plane
            a, b = k, (k + 1) % 4
            if outside[a] <= 0.0:
                shape.append(corners[a])
            if (outside[a] <= 0.0) != (outside[b] <= 0.0):
                cut = corners[a] + outside[a] / (outside[a] - outside[b]) * (corners[b] - corners[a])
                shape.append(cut)
                edge.append(cut)
        if len(shape) > 2:
            axes.add_patch(Polygon(np.array(shape) * unit, closed=True, fc=SOLID, ec="none", zorder=0.5))
        if len(edge) == 2:
            ends = np.array(edge) * unit
            axes.plot(ends[:, 0], ends[:, 1], color=EDGE, lw=0.9, zorder=0.6)


def _box(bounds: Bounds, period: float) -> Box:
    """Box to be shown [m]: the bounds with a margin."""
    left, right, bottom, top = bounds.left, bounds.right, bounds.bottom, bounds.top
    room = 1.6 * bounds.d_max
    if not math.isfinite(period):
        left, right = left - room, right + room
    bottom, top = bottom - 0.3 * room, top + 0.5 * room
    ratio = (right - left) / (top - bottom)
    if ratio < SLIM:  # a narrow column gets margins at its sides
        more = 0.5 * (SLIM * (top - bottom) - (right - left))
        left, right = left - more, right + more
    elif ratio > LOW:  # a long bed gets a margin above
        top = bottom + (right - left) / LOW
    return left, right, bottom, top


def _bar(figure: Figure, axes: Axes, shown: ScalarMappable, text: str) -> None:
    """A narrow colour bar above the right half of the panel; arrows stand for the values beyond its ends."""
    width, height = figure.get_size_inches()
    inner = height - AROUND - ABOVE
    beside = axes.inset_axes((0.62, 1.0 + 0.05 / inner, 0.38, BAR / inner))
    extend = "both" if shown.get_clim()[0] < 0.0 else "max"
    bar = figure.colorbar(shown, cax=beside, orientation="horizontal", extend=extend)
    bar.ax.xaxis.set_ticks_position("top")
    bar.ax.tick_params(labelsize=6.0, size=2.0, width=0.5, pad=1.5)
    bar.ax.locator_params(nbins=4 if width > 5.0 else 3)
    bar.outline.set_linewidth(0.4)  # pyright: ignore[reportCallIssue]
    bar.ax.annotate(
        text, (0, 0.5), (-4, 0), xycoords="axes fraction", textcoords="offset points", ha="right",
        va="center", fontsize=7.0,
    )  # fmt: skip
