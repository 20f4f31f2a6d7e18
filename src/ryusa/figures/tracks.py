"""Paths of grains over the bed, drawn to scale in stacked panels."""

import math
from collections.abc import Mapping
from dataclasses import replace
from textwrap import fill
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ryusa.figures import style
from ryusa.figures.snapshot import PLAIN, planes
from ryusa.measure import Snapshot, Tracks
from ryusa.model.scene import Bools, Floats

MM, CM = 1.0e3, 1.0e2  # millimetres and centimetres in a metre
TALLEST = 4.5  # height of all panels together [inch]
CAPTION = 130  # letters in a line of the caption
TICK = 0.15  # height that a number beside a panel needs [inch]
STEP = 1.0  # diameters between two frames above which the path between them is not known
DASHED = "dashed: between frames (dots) more than a diameter apart"
LOOSE = "blue grains: free, moving less than a diameter"
HIDDEN = "other free grains are not drawn"


@style.house
def tracks(
    found: Tracks,
    panels: int | None = None,
    exaggeration: float = 1.0,
    length: float | None = None,
    around: Snapshot | None = None,
) -> Figure:
    """Draw the paths of the centres of the chosen grains over the fixed and the loose bed.

    Parameters
    ----------
    found : paths (`measure.tracks`).
    panels : number of rows into which the path is cut; by default a row is about 40 diameters long.
    exaggeration : vertical over horizontal scale; with 1 grains are round. Stated in the figure if not 1.
    length : distance shown [m]; default all.
    around : scene whose planes are drawn; the caption says whether it holds grains that are not.

    Notes
    -----
    A path that is high for its length gets wider margins, so that the picture fits on a page. The loose bed
    is of the grains that lie still. Where a grain moves by more than a diameter between two frames, the path
    between them is not known: dots mark the frames, joined by a dashed line.
    """
    d = float(found.d[0]) if len(found.d) else 1.0
    x0 = float(np.nanmin(found.x)) - d
    total = (float(np.nanmax(found.x)) + d - x0) if length is None else length
    inside = found.x <= x0 + total
    top = float(found.z[inside].max()) + 0.8 * d
    under = [found.bed_z - 0.1 * d, found.loose_z - 0.6 * found.loose_d]
    bottom = float(np.concatenate(under).min()) if len(found.bed_z) else float(found.z.min()) - d
    # Smallest length of a row for each row drawn.
    each = (top - bottom) * exaggeration * (style.PAGE - 0.6) / TALLEST
    # With more rows, a row would be longer than its part of the path
    fit = max(math.floor(math.sqrt(total / each)), 1)
    rows = panels or min(max(math.ceil(total / (40.0 * d)), 1), fit, 8)
    span, tall = total / rows, each * rows
    if span < tall:
        x0, span = x0 - 0.5 * (tall - span), tall
    row = (style.PAGE - 0.6) * (top - bottom) / span * exaggeration
    figure, axes = style.new(rows, width=style.PAGE, height=0.67 + rows * (row + 0.27))
    for k, panel in enumerate(axes):
        low = x0 + k * span
        if around is not None:
            planes(panel, around.plane_point, around.plane_normal, (low, low + span, bottom, top), MM)
        _bed(panel, found, low, low + span)
        for c in range(found.x.shape[1]):
            _path(panel, found, c, low, low + span)
        panel.set_xlim(low * MM, (low + span) * MM)
        panel.set_ylim(bottom * MM, top * MM)
        panel.set_aspect(exaggeration)
        panel.locator_params(axis="y", nbins=_ticks(row), integer=True)
    axes[-1].set_xlabel("distance along the bed  $x$  (mm)")
    style.side_label(figure, style.height("mm"))
    axes[0].set_title(_caption(found, around), loc="left", fontsize=6.5)
    if exaggeration != 1.0:
        axes[0].set_title(f"vertical scale exaggerated {exaggeration:g} times", loc="right", fontsize=6.5)
    return figure


def _ticks(row: float) -> int:
    """Most intervals between the numbers beside a panel of some height [inch]."""
    return 8 if row >= 1.5 else max(min(int(row / TICK), 3), 1)


def _caption(found: Tracks, around: Snapshot | None) -> str:
    """The grains and the time shown, and what the picture leaves out, in words."""
    many = len(found.grains) > 8
    names = ", ".join(str(g) for g in found.grains[:8]) + (
        f", ... ({len(found.grains)} in all)" if many else ""
    )
    when = f", $t$ = {found.t[0]:.4g} to {found.t[-1]:.4g} s" if len(found.t) else ""
    text = f"grain{'s' if len(found.grains) > 1 else ''} {names}{when}"
    text += ", its outline at equal distances along the path" if len(found.grains) == 1 else ""
    drawn = len(found.grains) + len(found.loose_x)
    notes = [LOOSE] * bool(len(found.loose_x))
    notes += [HIDDEN] * (around is not None and len(around.grains) > drawn)
    notes += [DASHED] * bool(_far(found).any())
    return "\n".join([text, *([fill("; ".join(notes), CAPTION)] if notes else [])])


def _far(found: Tracks) -> Bools:
    """Steps between two frames that are longer than a diameter, (n_frame - 1, n_grain)."""
    return np.hypot(np.diff(found.x, axis=0), np.diff(found.z, axis=0)) > STEP * found.d


@style.house
def tracks_side_by_side(
    found: Mapping[str, Tracks], length: float, unit: Literal["mm", "cm"] = "mm"
) -> Figure:
    """Draw paths of several runs one above the other, all to the same scale and from the same x = 0.

    Parameters
    ----------
    found : name written into the panel -> paths.
    length : distance shown [m].
    unit : of both axes.
    """
    runs, scale = list(found.values()), {"mm": MM, "cm": CM}[unit]
    d = float(runs[0].d[0])
    shown = [np.where(one.x <= one.x[0, 0] + length, one.z, -math.inf) for one in runs]
    top = max(float(z.max()) for z in shown) + 0.8 * d
    bottom = min((float(one.bed_z.min()) for one in runs if len(one.bed_z)), default=0.0) - 0.1 * d
    row = (style.PAGE - 0.6) * (top - bottom) / length
    figure, axes = style.new(len(runs), width=style.PAGE, height=0.42 + len(runs) * (row + 0.25), sharex=True)
    for panel, (name, one) in zip(axes, found.items(), strict=True):
        # A multiple of the diameter, so that all beds are drawn alike.
        start = math.floor(float(one.x[0, 0]) / d) * d
        moved = replace(one, x=one.x - start, bed_x=one.bed_x - start)
        _bed(panel, moved, 0.0, length, scale)
        for c in range(moved.x.shape[1]):
            _path(panel, moved, c, 0.0, length, scale)
        panel.set_xlim(0.0, length * scale)
        panel.set_ylim(bottom * scale, top * scale)
        panel.set_aspect("equal")
        panel.locator_params(axis="y", nbins=min(_ticks(row), 4), integer=True)
        panel.set_title(name, loc="left", fontsize=7.5, weight="bold", pad=2.0)
    if any(_far(one).any() for one in runs):
        axes[0].set_title(DASHED, loc="right", fontsize=6.5)
    axes[-1].set_xlabel(f"distance along the bed  $x$  ({unit})")
    style.side_label(figure, style.height(unit))
    return figure


@style.house
def tracks_from_start(found: Mapping[str, Tracks], marks: float = 0.1, length: float | None = None) -> Figure:
    """Draw the paths of many grains one above another, each from its start: the form of the paper's fig16.

    Parameters
    ----------
    found : name of the run -> paths (`measure.tracks`), all within windows of equal length; one panel each.
    marks : time between the dots on a path [s]; a ring is the start.
    length : distance shown [m]; default that of the grain that went farthest in any run.

    Notes
    -----
    To scale. Paths are shifted vertically so that they do not cross: the longest lies on top.
    """
    runs = list(found.values())
    d = float(np.mean(runs[0].d))
    far = (max(float((one.x - one.x[:1]).max()) for one in runs) if length is None else length) / d
    laid = [_apart((one.z - one.z[:1]) / d, one.x[-1] - one.x[0]) for one in runs]
    top, bottom = max(float(z.max()) for z in laid) + 0.3, -0.3
    row = min((style.PAGE / len(runs) - 0.35) * (top - bottom) / (1.06 * far), 6.0)
    figure, axes = style.new(1, len(runs), width=style.PAGE, height=0.65 + row, sharex=True, sharey=True)
    for s, (panel, (name, one), z) in enumerate(zip(axes, found.items(), laid, strict=True)):
        x, colour = (one.x - one.x[:1]) / d, style.COLOURS[s % len(style.COLOURS)]
        dots = np.unique(np.searchsorted(one.t, np.arange(one.t[0] + marks, one.t[-1], marks)))
        panel.plot(x, z, color=colour, lw=0.8, solid_joinstyle="round")
        panel.plot(x[dots], z[dots], ".", color=colour, ms=3.5, mew=0.0)
        panel.plot(x[0], z[0], "o", color=colour, ms=3.0, mfc="white", mew=0.8)
        panel.set_xlim(-0.03 * far, 1.03 * far)
        panel.set_ylim(bottom, top)
        panel.set_aspect("equal")
        panel.set_title(name, loc="left", fontsize=7.5)
        panel.set_xlabel("distance from the start  $(x - x_0)/d$  (–)")
    axes[-1].set_title(f"a dot every {marks:g} s", loc="right", fontsize=6.5)
    axes[0].set_ylabel("height, paths set apart  $z/d$  (–)")
    return figure


def _apart(z: Floats, advance: Floats) -> Floats:
    """Heights (n_frame, n_grain), shifted so that paths do not overlap; the shortest path is the lowest."""
    z, level = z.copy(), 0.0
    for c in np.argsort(advance):
        z[:, c] += level - z[:, c].min()
        level = float(z[:, c].max()) + 0.25
    return z


def _bed(axes: Axes, found: Tracks, low: float, high: float, scale: float = MM) -> None:
    """Grains of the fixed and the loose bed within the panel, repeated periodically."""
    for x, z, d, face, rim in (
        (found.loose_x, found.loose_z, found.loose_d, PLAIN, "#8fa3b5"),
        (found.bed_x, found.bed_z, found.bed_d, style.BED, "#8c8578"),
    ):
        copies = np.zeros(1)
        if math.isfinite(found.period) and len(x):
            first, last = (low - x.max()) / found.period, (high - x.min()) / found.period
            copies = found.period * np.arange(math.floor(first), math.ceil(last) + 1)
        at = x[:, None] + copies
        which, copy = np.nonzero((at > low - d[:, None]) & (at < high + d[:, None]))
        size, centres = d[which] * scale, np.column_stack([at[which, copy], z[which]]) * scale
        axes.add_collection(
            EllipseCollection(
                size, size, np.zeros(len(size)), units="xy", offsets=centres, offset_transform=axes.transData,
                facecolor=face, edgecolor=rim, linewidth=0.3, zorder=1.0,
            )
        )  # fmt: skip


def _path(axes: Axes, found: Tracks, column: int, low: float, high: float, scale: float = MM) -> None:
    x, z, d = found.x[:, column], found.z[:, column], float(found.d[column])
    near = (x >= low - d) & (x <= high + d)
    if not near.any():
        return
    colour = style.COLOURS[column % len(style.COLOURS)]
    # a gap while the grain is outside the panel, after the first frame outside
    drawn = near.copy()
    drawn[1:] |= near[:-1]
    drawn[:-1] |= near[1:]
    far = np.flatnonzero(_far(found)[:, column])
    x_shown = np.where(drawn, x, np.nan) * scale
    x_known, z_known = (np.insert(one, far + 1, np.nan) for one in (x_shown, z * scale))
    axes.plot(x_known, z_known, color=colour, lw=0.9, solid_joinstyle="round")
    if len(far):
        ends = np.stack([far, far + 1], axis=1)
        gaps = np.full((2, len(far), 3), np.nan)
        gaps[:, :, :2] = x_shown[ends], z[ends] * scale
        axes.plot(*gaps.reshape(2, -1), color=colour, lw=0.6, ls=(0, (2.5, 2.5)), alpha=0.7)
        seen = np.unique(ends)
        axes.plot(x_shown[seen], z[seen] * scale, ".", color=colour, ms=3.2, mew=0.0)
    # the grain's outline at equal distances along its path, so that its size can be seen
    if found.x.shape[1] == 1:
        ways = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(z)))])
        marks = np.unique(np.searchsorted(ways, np.arange(0.0, ways[-1], 2.5 * d)))
        marks = marks[near[marks]]
        rings = [Circle((float(x[k]) * scale, float(z[k]) * scale), 0.5 * d * scale) for k in marks]
        axes.add_collection(
            PatchCollection(rings, facecolor="none", edgecolor=colour, linewidth=0.35, alpha=0.55)
        )
