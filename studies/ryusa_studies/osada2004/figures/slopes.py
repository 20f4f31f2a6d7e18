"""Slope of heaps over a friction angle or coefficient, with the slopes reported by the paper."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style


@dataclass(frozen=True)
class Slope:
    """One series: slopes of all seeds over the varied quantity, and the slope reported by the paper [deg]."""

    label: str
    paper: tuple[float, ...]
    points: Sequence[tuple[float, Sequence[float]]]  # abscissa, slopes; nan for a heap that stands as a wall


@style.house
def slopes(
    series: Sequence[Slope], text: str = "friction angle  $\\phi$  (deg)", log: bool = False
) -> Figure:
    """Draw every seed as a faint dot and the mean as a symbol; heaps that stand as a wall at the top edge.

    Parameters
    ----------
    series : slopes, one colour each.
    text : label of the abscissa.
    log : abscissa on a logarithmic scale.
    """
    figure, (axes,) = style.new(width=1.45 * style.COLUMN, height=3.0)
    known = [value for one in series for _, values in one.points for value in values if np.isfinite(value)]
    top = max([45.0, *(value + 8.0 for value in known)])
    for number, one in enumerate(series):
        colour, mark = style.COLOURS[number % len(style.COLOURS)], style.MARKERS[number % len(style.MARKERS)]
        aside = number - 0.5 * (len(series) - 1)  # so that symbols of several series do not overlap
        means: list[tuple[float, float]] = []
        for place, values in sorted(one.points, key=lambda point: point[0]):
            x = place * 1.03**aside if log else place + 0.35 * aside
            at = np.asarray(values, dtype=np.float64)
            kept = at[np.isfinite(at)]
            axes.plot(np.full(len(kept), x), kept, ".", ms=3.0, color=colour, alpha=0.5)
            if len(kept) < len(at):
                axes.plot([x], [top - 2.0], mark, ms=4.0, mfc="white", mec=colour, mew=0.9)
            if len(kept):
                means.append((x, float(kept.mean())))
        axes.plot(*np.array(means).reshape(-1, 2).T, marker=mark, lw=0.9, color=colour, label=one.label)
    quoted = sorted({angle for one in series for angle in one.paper})
    for angle in quoted:
        axes.axhline(angle, color="black", lw=0.7, ls="--", zorder=1)
        axes.annotate(
            f"Osada et al. 2004: {angle:g}°", (1, angle), (-3, 2), xycoords=("axes fraction", "data"),
            textcoords="offset points", ha="right", fontsize=6.0,
        )  # fmt: skip
    axes.annotate(
        "open marks: stands like a wall", (0.02, 0.985), xycoords="axes fraction", va="top", fontsize=6.0
    )
    axes.set_ylim(0.0, top)
    if log:
        axes.set_xscale("log")
    axes.set_xlabel(text)
    axes.set_ylabel("final slope  (deg)")
    figure.legend(loc="outside upper center", ncols=2, fontsize=6.5)
    return figure
