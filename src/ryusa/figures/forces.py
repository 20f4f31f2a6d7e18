"""Network of contact forces over the grains, each line as wide as its normal force is large."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ryusa.figures import style
from ryusa.figures.snapshot import CM, circles, panel
from ryusa.measure import Bounds, ContactNetwork

FILL, RIM = "#f3f6f8", "#b3bdc6"  # of grains beneath the lines
ONE, SLIDES, PULLS = "#1f3a5f", style.COLOURS[1], style.COLOURS[2]
LEGEND, CAPTION = 0.17, 0.11  # height of the legend, and of a line of the caption [inch]
WIDEST = 6.0  # of a line [pt], and not wider than this share of the mean diameter:
SHARE = 0.6


@style.house
def forces(found: ContactNetwork, bounds: Bounds | None = None) -> Figure:
    """Draw each contact as a line between centres, or to a plane, whose width is its normal force to scale.

    Parameters
    ----------
    found : `measure.contact_network`.
    bounds : box that is shown, such as `measure.bounds` gives for a whole run; default that of the moment.
    """
    seen = found.seen
    figure, axes = panel(seen, LEGEND + 3.0 * CAPTION, bounds)
    circles(axes, seen.x, seen.d, FILL, RIM, period=seen.period, zorder=2.0)
    largest = float(np.abs(found.f_n).max(initial=0.0))
    if largest > 0.0:
        per_newton = _widest(figure, axes, seen.d) / largest
        groups = [
            (found.sliding & (found.f_n >= 0.0), SLIDES, "sliding"),
            (found.f_n < 0.0, PULLS, "pulling"),
        ]
        other = ~(found.sliding | (found.f_n < 0.0))
        groups.insert(0, (other, ONE, "sticking" if found.recorded else ""))
        scale = _round_below(largest)
        handles = [Line2D([], [], color="black", lw=per_newton * scale, label=_newtons(scale))]
        for chosen, colour, label in groups:
            _lines(axes, found, chosen, per_newton, colour)
            if label and chosen.any():
                handles.append(Line2D([], [], color=colour, lw=2.0, label=label))
        axes.legend(
            handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(handles), fontsize=7.0,
            borderaxespad=0.15, borderpad=0.1, handlelength=1.4, columnspacing=1.0,
        )  # fmt: skip
    lines = _caption(found, largest)
    text = "; ".join(lines) if figure.get_figwidth() > style.COLUMN else "\n".join(lines)
    figure.supxlabel(text, fontsize=CAPTION * 72.0 / 1.3, color="#444444")
    return figure


def _lines(axes: Axes, found: ContactNetwork, chosen: np.ndarray, per_newton: float, colour: str) -> None:
    """Lines of some contacts, again on the other side where they cross a periodic limit."""
    ends = CM * np.stack([found.begin[chosen], found.end[chosen]], axis=1)[:, :, [0, 2]]
    widths = per_newton * np.abs(found.f_n[chosen])
    period = CM * found.seen.period
    if math.isfinite(period):
        low, high = ends[:, 1, 0] < 0.0, ends[:, 1, 0] > period
        ends = np.concatenate([ends, ends[low] + [period, 0.0], ends[high] - [period, 0.0]])
        widths = np.concatenate([widths, widths[low], widths[high]])
    axes.add_collection(
        LineCollection(list(ends), linewidths=widths, colors=colour, capstyle="round", zorder=3.0)
    )


def _widest(figure: Figure, axes: Axes, d: np.ndarray) -> float:
    """Width of the line of the largest force [pt]."""
    figure.draw_without_rendering()  # places the axes
    left, right = axes.get_xlim()
    points = axes.get_window_extent().width / figure.dpi * 72.0 / (right - left)  # per cm
    return min(WIDEST, SHARE * points * CM * float(d.mean()))


def _round_below(value: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that is not above a value.

    >>> _round_below(0.0034), _round_below(5.0)
    (0.002, 5.0)
    """
    power = 10.0 ** math.floor(math.log10(value))
    return float(
        f"{max(one for one in (1.0, 2.0, 5.0) if one * power <= value * (1.0 + 1.0e-9)) * power:.1g}"
    )


def _newtons(force: float) -> str:
    r"""A force in N, with a power of ten where it is small or large.

    >>> _newtons(0.02), _newtons(2.0e-5)
    ('0.02 N', '$2 \\times 10^{-5}$ N')
    """
    power = math.floor(math.log10(force))
    if -3 <= power <= 3:
        return f"{force:g} N"
    return f"${force / 10.0**power:.2g} \\times 10^{{{power}}}$ N"


def _caption(found: ContactNetwork, largest: float) -> list[str]:
    """How many contacts are shown, where, how their forces were had, and the largest."""
    lines = [f"{len(found.i)} contact{'s' * (len(found.i) != 1)}"]
    if found.slice_y is not None:
        low, high = (f"{CM * one:.3g}" for one in found.slice_y)
        lines[0] += f" that touch in slice {found.slice} of {found.slices}, $y$ = {low} to {high} cm"
    if found.recorded:
        lines.append("forces as recorded, of the step before the frame")
    else:
        lines.append("$f_n$ = $k_n$ times overlap, without dashpot: record.forces is false")
    if largest > 0.0:
        lines.append(f"largest $f_n$ {_newtons(float(f'{largest:.3g}'))}")
    return lines
