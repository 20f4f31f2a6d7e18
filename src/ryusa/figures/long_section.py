"""A row of columns: its long section, and what varies over distance and time."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ryusa.catalogue import QUANTITIES
from ryusa.errors import ResultsError
from ryusa.figures import style
from ryusa.measure.depth_history import DepthHistory
from ryusa.measure.long_section import THIN, Floats, LongSection
from ryusa.spelling import known_word

FEW_METRES = 3.0  # span of lengths from which they are drawn in metres, below in centimetres [m]
MUCH = 0.1  # transport per width from which it is drawn in m2/s, below in cm2/s [m2/s]
WATER, LINE, GROUND, HEAD = "#0072B2", "#D55E00", "#8c6d3f", "#7b1f6a"
DASHED, DOTTED = (0, (5, 2)), (0, (2.5, 1.5))
FAST = 6.0  # Froude number up to which its axis goes, or 1.2 times that of MOST wet segments: no film counts
FILM = 0.01  # of the greatest depth, below which water does not count for the ends of axes
SHARE = 0.995  # of the values that a colour scale covers
SAID = {"bed": "rise of the bed", "transport": "grains $q_s$"}
TRACE = 0.02  # of the greatest thickness of the bed, below which none is drawn
MOST = 0.9
CALM = 0.98  # of lines of heads that their axis covers: those of thin fast films would dwarf all else


@style.house
def long_section(
    found: LongSection,
    among: Sequence[LongSection] = (),
    *,
    height: float | None = None,
    words: str | None = None,
    alone: bool = False,
) -> Figure:
    """Draw bed, water, energy line and critical depth by elevation, below them Froude number and transport.

    Elevations are vertical, so that water at rest is level whatever the slope of the x axis. Of means, the
    bands are one standard error.

    Parameters
    ----------
    found : the section.
    among : other moments of the same run that the axes cover too, as in a film.
    height : of the figure [inch]; default by its panels.
    words : above the figure, in place of the time in it.
    alone : elevations alone, without Froude number and transport.
    """
    panels = 1 if alone else 3 if found.grains else 2
    figure, axes = style.new(
        panels, width=style.PAGE, height=height or (2.4, 3.8, 4.8)[panels - 1], sharex=True,
        gridspec_kw={"height_ratios": (2.4, 1.0, 1.0)[:panels]},
    )  # fmt: skip
    every = (found, *among)
    if words is not None:
        figure.suptitle(words, fontsize=8.0)
    _elevations(axes[0], found, every, timed=words is None)
    if not alone:
        _flow(axes[1:], found, every)
    x = found.x
    axes[-1].set_xlabel("distance along the row  $x$  (m)")
    half = 0.5 * (x[1] - x[0]) if len(x) > 1 else 0.5
    axes[-1].set_xlim(x[0] - half, x[-1] + half)
    figure.align_ylabels(axes)
    _note_exaggeration(figure, axes[0], _lengths(_drawn_heights(every))[0])
    return figure


def _flow(axes: Sequence[Axes], found: LongSection, every: Sequence[LongSection]) -> None:
    """Froude number, and the transport of grains where there are some; of several sections on axes of all."""
    axes[0].axhline(1.0, color=style.FAINT, lw=0.6)
    axes[0].plot(found.x, found.froude, color=WATER)
    _band(axes[0], found, "froude", 1.0, WATER)
    axes[0].set_ylabel("Froude  (–)")
    known = np.nan_to_num(np.concatenate([one.froude[_deep(one)] for one in every]))
    if len(every) > 1:
        axes[0].set_ylim(0.0, 1.05 * max(float(known.max(initial=0.0)), 1.05))
    most = max(FAST, 1.2 * float(np.quantile(known, MOST))) if len(known) else FAST
    axes[0].set_ylim(0.0, min(axes[0].get_ylim()[1], most))
    if found.grains:
        transport = np.concatenate([one.solid_discharge for one in every])
        scale, unit = _per_width(transport)
        axes[1].axhline(0.0, color=style.FAINT, lw=0.6)
        axes[1].plot(found.x, found.solid_discharge * scale, color=LINE)
        _band(axes[1], found, "solid_discharge", scale, LINE)
        axes[1].set_ylabel(f"grains  $q_s$\n({unit})")
        if len(every) > 1:
            low, high = (float(end(np.nan_to_num(transport))) * scale for end in (np.min, np.max))
            room = 0.05 * (high - low) or 1.0
            axes[1].set_ylim(low - room, high + room)


def _deep(found: LongSection) -> np.ndarray:
    """Segments whose water is no film beside the deepest."""
    return found.depth > max(THIN, FILM * float(found.depth.max(initial=0.0)))


def _drawn_heights(every: Sequence[LongSection]) -> Floats:
    return np.concatenate([one.elevation(np.maximum(one.surface, one.bottom)) for one in every])


def _note_exaggeration(figure: Figure, axes: Axes, scale: float) -> None:
    """Say how many times larger than lengths heights are drawn; `scale` is the factor of heights [1/m]."""
    figure.draw_without_rendering()  # lays the axes out
    drawn = axes.get_window_extent()
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    times = (drawn.height * scale / (high - low)) / (drawn.width / (right - left))
    axes.annotate(
        f"heights {times:.2g} times exaggerated" if times >= 1.05 else "to scale" if times > 0.95
        else f"heights drawn {times:.2g} times as large as lengths",
        (0, 1), (0, 12), xycoords="axes fraction", textcoords="offset points", fontsize=style.NOTE_SIZE,
    )  # fmt: skip


def _lengths(values: Floats) -> tuple[float, str]:
    """Factor and unit in which lengths [m] are drawn, by their span."""
    return (1.0, "m") if np.nanmax(values) - np.nanmin(values) > FEW_METRES else (100.0, "cm")


def _per_width(values: Floats) -> tuple[float, str]:
    """Factor and unit in which transport per width [m2/s] is drawn, by the largest."""
    return (1.0, "m²/s") if np.nanmax(np.abs(values)) > MUCH else (1.0e4, "cm²/s")


def _band(axes: Axes, found: LongSection, name: str, scale: float, colour: str) -> None:
    if name in found.error:
        mean, error = getattr(found, name) * scale, found.error[name] * scale
        axes.fill_between(found.x, mean - error, mean + error, color=colour, alpha=0.2, lw=0.0)


def _elevations(axes: Axes, found: LongSection, every: Sequence[LongSection], *, timed: bool) -> None:
    """Bottom, bed, water, energy line and dams; the axis covers all sections."""
    x, wet = found.x, found.depth > THIN
    scale, unit = _lengths(_drawn_heights(every))
    bottom, floor, bed, surface, energy = (
        found.elevation(z) * scale
        for z in (found.bottom, found.floor, found.bed, found.surface, found.energy)
    )
    critical = found.elevation(found.bed + found.critical) * scale
    step = x[1] - x[0] if len(x) > 1 else 1.0
    low = min(float(one.elevation(one.bottom).min()) for one in every) * scale
    highest = max(float(one.elevation(np.maximum(one.surface, one.bed)).max()) for one in every) * scale
    head = max(highest, *(_head(one) * scale for one in every))
    span = min(head, 2.0 * highest - low) - low
    edge = np.concatenate([x[:1] - 0.5 * step, x, x[-1:] + 0.5 * step])  # to the ends of the row
    ground = np.concatenate([bottom[:1], bottom, bottom[-1:]])
    axes.fill_between(edge, ground, low - 0.12 * span, color=style.BED, lw=0.0)
    wet = surface > floor  # a dry dam has its surface on its crest
    sides = np.column_stack([x - 0.5 * step, x + 0.5 * step])
    joined = wet[1:] & wet[:-1]
    joined[[one.segment for one in found.nappes]] = False
    along, under, top = _over_segments(sides, wet, joined, x, bottom, surface)
    axes.fill_between(along, under, top, color=WATER, alpha=0.22, lw=0.0)
    thick = found.bed - found.floor  # in the mean also of single grains that passed
    if found.grains and (loose := thick > TRACE * max(float(thick.max()), 0.0)).any():
        level = np.isclose(np.diff(floor - bottom), 0.0, atol=1e-9)  # not over the face of a dam
        joined = loose[1:] & loose[:-1] & level
        at, low_of, high_of = _over_segments(sides, loose, joined, x, floor, bed)
        axes.fill_between(at, low_of, high_of, color=GROUND, alpha=0.6, lw=0.0)
        axes.plot(at, high_of, color=GROUND, lw=0.9, label="bed")
    for name, first, end in found.dams:
        _dam(axes, name, first, end, x, step, bottom, floor)
    axes.plot(edge, ground, color="#5a4a2f", lw=0.9)
    axes.plot(along, top, color=WATER, lw=1.2, label="surface")
    for one in found.nappes:
        at, z = one.outline.T
        high = (z * math.cos(found.slope) - at * math.sin(found.slope)) * scale
        axes.fill(at, high, facecolor=(WATER, 0.22), edgecolor=WATER, lw=0.9)
    axes.plot(x, np.where(wet, energy, np.nan), color=LINE, lw=0.8, ls=DASHED, label="energy line")
    if found.pressure_head is not None:
        head = np.where(wet, found.elevation(found.pressure_head) * scale, np.nan)
        axes.plot(x, head, color=HEAD, lw=1.0, ls=DOTTED, zorder=3, label="pressure head at the floor")
    steps = np.flatnonzero(np.diff(floor - bottom) != 0.0) + 1  # the critical depth is over the floor
    flows = np.where(wet & (found.critical > THIN), critical, np.nan)
    for k, (at, part) in enumerate(zip(np.split(x, steps), np.split(flows, steps), strict=True)):
        axes.plot(at, part, color="black", lw=0.7, ls=":", label="critical depth" if k == 0 else None)
    axes.set_ylabel(f"elevation  ({unit})")
    axes.set_ylim(low - 0.12 * span, low + 1.05 * span)
    style.legend_above(axes, 5, loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=6.5)
    if not timed:
        return
    begin = "" if found.window is None else f"mean of {found.window[0]:.4g} s to "
    axes.annotate(
        f"{begin}{'' if begin else 't = '}{found.t:.4g} s", (0, 1), (0, 21), xycoords="axes fraction",
        textcoords="offset points", fontsize=7.0,
    )  # fmt: skip


def _head(found: LongSection) -> float:
    """Elevation below which most of the lines of heads lie [m]; -inf where all is dry."""
    wet, heads = _deep(found), [found.energy]
    if found.pressure_head is not None:
        heads.append(found.pressure_head)
    return max(float(np.quantile(found.elevation(one)[wet], CALM)) for one in heads) if wet.any() else -np.inf


def _over_segments(
    sides: Floats, drawn: np.ndarray, joined: np.ndarray, x: Floats, low: Floats, high: Floats
) -> list[Floats]:
    """Places, and two lines over some of the segments up to their sides, shape (n, 2), with gaps as nan."""
    lines = [_to_the_ends(line, joined) for line in (x, low, high)]
    lines[0][:, [0, 2]] = sides
    return [np.where(drawn[:, None], one, np.nan).ravel() for one in lines]


def _to_the_ends(line: Floats, joined: np.ndarray) -> Floats:
    """A line at begin, middle and end of each segment, then a gap where it does not go on; shape (n, 4)."""
    middle = 0.5 * (line[1:] + line[:-1])
    before, after = line.copy(), line.copy()
    before[1:], after[:-1] = np.where(joined, middle, line[1:]), np.where(joined, middle, line[:-1])
    gap = np.append(np.where(joined, after[:-1], np.nan), np.nan)
    return np.column_stack([before, line, after, gap])


def _dam(
    axes: Axes, name: str, first: float, end: float, x: Floats, step: float, bottom: Floats, floor: Floats
) -> None:
    """Draw a dam with its name; one that lets water through as a shade."""
    inside = (x > first) & (x < end)
    low, top = bottom[inside], floor[inside]
    if (top > low).any():
        sides = np.column_stack([x[inside] - 0.5 * step, x[inside] + 0.5 * step]).ravel()
        axes.fill_between(sides, np.repeat(low, 2), np.repeat(top, 2), color=GROUND, lw=0.0, zorder=3)
    else:
        axes.axvspan(first, end, color=GROUND, alpha=0.25, lw=0.0)
    axes.annotate(
        name, (0.5 * (first + end), float(low.min())), (0, -2), textcoords="offset points", ha="center",
        va="top", fontsize=6.2, zorder=4,
    )  # fmt: skip


@style.house
def x_t(found: DepthHistory, quantity: str | None = None) -> Figure:
    """Draw depth over distance and time, and with grains the change of the bed and their transport.

    Parameters
    ----------
    found : a history.
    quantity : only "depth", with a line where the flow is critical, "bed" or "transport"; default all that
        are not zero throughout.

    Raises
    ------
    CaseError : `quantity` is no such word.
    ResultsError : there are no grains whose bed or transport could be drawn, or one moment alone.
    """
    if len(found.t) < 2:
        raise ResultsError(f"{len(found.t)} frames: a picture over time needs two or more")
    if quantity is not None:
        known_word(quantity, QUANTITIES, "quantity")
    if quantity not in {None, "depth"} and not found.grains:
        raise ResultsError(f"the run has water alone; --quantity {quantity} needs grains")
    shown = (quantity,) if quantity else _not_zero(found)
    wide = 4.8 if len(shown) == 1 else style.PAGE
    figure, axes = style.new(1, len(shown), width=wide, height=3.4, sharey=True)
    draw = {"depth": _depth, "bed": _bed_change, "transport": _transport}
    for one, panel in zip(shown, axes, strict=True):
        draw[one](figure, panel, found, "right" if len(shown) == 1 else "top")
        for _, first, end in found.dams:
            panel.axvspan(first, end, ymax=0.02, color=GROUND, lw=0.0)
        panel.set_xlabel("distance along the row  $x$  (m)" if len(shown) == 1 else "$x$  (m)")
    axes[0].set_ylabel("time  $t$  (s)")
    left_out = [one for one in QUANTITIES if found.grains and not quantity and one not in shown]
    if left_out:
        style.note(figure, f"zero throughout and not drawn: {', '.join(SAID[one] for one in left_out)}")
    return figure


def _not_zero(found: DepthHistory) -> tuple[str, ...]:
    """The depth, and of what the grains do all that is not zero throughout."""
    changes = {"bed": found.bed_change, "transport": found.solid_discharge} if found.grains else {}
    return ("depth", *(name for name, values in changes.items() if np.nan_to_num(values).any()))


def _map(
    figure: Figure, axes: Axes, found: DepthHistory, values: Floats, label: str, side: Any, **how: Any
) -> None:
    """Colours over distance and time with their scale."""
    drawn = axes.pcolormesh(found.x, found.t, values, shading="nearest", rasterized=True, **how)
    low, high = drawn.get_clim()
    known, slack = values[np.isfinite(values)], 1.0e-6 * (high - low)
    beyond = bool((known < low - slack).any()), bool((known > high + slack).any())
    extend = ("neither", "max", "min", "both")[2 * beyond[0] + beyond[1]]
    figure.colorbar(drawn, ax=axes, label=label, pad=0.02, location=side, extend=extend)


def _depth(figure: Figure, axes: Axes, found: DepthHistory, side: str) -> None:
    scale, unit = _lengths(np.append(found.depth, 0.0))
    shown = np.where(found.depth > THIN, found.depth, np.nan) * scale
    _map(figure, axes, found, shown, f"depth  ({unit})", side, cmap="Blues", vmin=0.0)
    over_dams = np.any([(found.x > first) & (found.x < end) for _, first, end in found.dams], axis=0)
    # No line along a dam or a shore
    flowing = np.ma.masked_invalid(np.where(over_dams, np.nan, found.froude))
    if len(found.t) > 1 and len(found.x) > 1 and flowing.count() and flowing.min() < 1.0 < flowing.max():
        axes.contour(found.x, found.t, flowing, levels=[1.0], colors=LINE, linewidths=0.8)
        axes.plot([], [], color=LINE, lw=0.8, label="Froude number 1")
        axes.legend(loc="upper left", fontsize=6.5, frameon=True, framealpha=0.9, edgecolor="none")


def _bed_change(figure: Figure, axes: Axes, found: DepthHistory, side: str) -> None:
    scale, unit = _lengths(np.append(found.bed_change, 0.0))
    shown = found.bed_change * scale
    most = largest_but_few(shown)
    label = f"rise of the bed since {found.t[0]:.3g} s  ({unit})"
    _map(figure, axes, found, shown, label, side, cmap="BrBG_r", vmin=-most, vmax=most)


def _transport(figure: Figure, axes: Axes, found: DepthHistory, side: str) -> None:
    scale, unit = _per_width(np.array([largest_but_few(found.solid_discharge)]))
    shown = found.solid_discharge * scale
    most = largest_but_few(shown)
    label = f"grains  $q_s$  ({unit})"
    _map(figure, axes, found, shown, label, side, cmap="YlOrBr", vmin=0.0, vmax=most)


def largest_but_few(values: Floats | Sequence[float]) -> float:
    """What all but a few values do not exceed, without their sign; 1 where there are none or all are 0."""
    known = np.abs(np.asarray(values))
    known = known[np.isfinite(known)]
    return float(np.quantile(known, SHARE)) or 1.0 if len(known) else 1.0
