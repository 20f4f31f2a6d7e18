"""Charts of single contacts in the paper's form: over k_n in N/cm, impact speed, steps per contact."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ryusa.figures import style
from ryusa.figures.contact import StiffnessBand, StiffnessCurve, StiffnessPoints

Floats = NDArray[np.float64]
DropQuantity = Literal["time", "overlap", "ratio"]

QUOTED = "Osada et al. 2004"
_PER_CM = 0.01  # N/m -> N/cm
_AXIS = {
    "time": "contact time  $t$  (s)",
    "overlap": "largest overlap  $(RS_{ij})_{\\max}/d$  (–)",
    "ratio": "contact time over Eq. (8)  (–)",
}


@dataclass(frozen=True)
class QuotedPoint:
    """A number given by the paper, as a point in a chart: y as drawn, k_n [N/m]; `of` names the grain."""

    k_n: float
    y: float
    of: str


@dataclass(frozen=True)
class ReboundCurve:
    """Restitution over steps per contact, with its range over the phases of first touch."""

    steps: Floats
    e: Floats
    low: Floats
    high: Floats


@style.house
def drop_chart(
    quantity: DropQuantity,
    lines: Sequence[StiffnessCurve],
    runs: Sequence[StiffnessPoints],
    *,
    quoted: Sequence[QuotedPoint] = (),
    band: StiffnessBand | None = None,
    levels: tuple[float, float] | None = None,
    words: tuple[str, str] = ("", ""),
    legend: Literal["inside", "above"] = "inside",
) -> Figure:
    """Draw runs as points and closed forms as lines over k_n in N/cm.

    Parameters
    ----------
    quantity : what y is; "ratio" has a linear axis, the others a logarithmic one.
    lines, runs : closed forms and measured values, k_n in N/m; the k-th of each share colour and label.
    quoted : points given by the paper.
    band : shaded region between two lines over k_n.
    levels : two values of y between which the whole width is shaded.
    words : name of the lines in the legend, and a note (speed, restitution) above the frame.
    legend : inside the frame at the lower left, or above it where points fill the frame.
    """
    figure, (axes,) = style.new(height=2.9)
    axes.set_xscale("log")
    if quantity != "ratio":
        axes.set_yscale("log")
    if levels is not None:
        axes.axhspan(*levels, color=style.BAND, lw=0)
    if band is not None:
        _fill(axes, band)
    many = max(len(lines), len(runs)) > 4
    n = max(len(lines), len(runs))
    colours: list[Any] = [style.shade(k / (n - 1)) if many else style.COLOURS[k] for k in range(n)]
    for k, one in enumerate(lines):
        alone = len(lines) == 1 and len(runs) > 1
        label = words[0] or one.label if k == 0 else None
        axes.plot(
            one.k_n * _PER_CM, one.y, color="black" if alone else colours[k], lw=0.9, label=label, zorder=1.5
        )
    for k, one in enumerate(runs):
        axes.plot(
            one.k_n * _PER_CM, one.y, style.MARKERS[k % len(style.MARKERS)], color=colours[k], mfc="white",
            mew=1.0, ms=3.6, label=one.label,
        )  # fmt: skip
    for k, one in enumerate(quoted):
        axes.plot(
            one.k_n * _PER_CM, one.y, "*", color=style.COLOURS[1], ms=9.0, mec="black", mew=0.5, ls="none",
            label=f"{QUOTED}, {one.of}" if k == 0 else None, zorder=5,
        )  # fmt: skip
    axes.set_xlabel("normal stiffness  $k_n$  (N/cm)")
    axes.set_ylabel(_AXIS[quantity])
    axes.margins(x=0.03)
    look = {"fontsize": 6.3, "labelspacing": 0.3, "handlelength": 1.4}
    if legend == "above":
        figure.legend(loc="outside upper left", ncols=2, **look)
    else:
        axes.legend(loc="lower left", **look)
    if words[1]:
        axes.set_title(words[1], loc="right", fontsize=6.5, color="#444444", pad=3.0)
    return figure


@style.house
def over_speed(
    lines: Sequence[tuple[str, Floats, Floats]],
    hits: tuple[Floats, Floats] | None,
    *,
    levels: tuple[float, float] | None = None,
    wanted: float | None = None,
    note: str = "",
) -> Figure:
    """Draw the largest overlap of runs against the impact speed, both axes logarithmic.

    Parameters
    ----------
    lines : label, speeds [m/s] and overlaps over d [-] of drops.
    hits : the same two of every bed contact of a saltating grain, as a cloud.
    levels : band of overlaps that is shaded.
    wanted : overlap that the paper gives, as a dashed line.
    note : above the frame.
    """
    figure, (axes,) = style.new(height=2.7)
    axes.set_xscale("log")
    axes.set_yscale("log")
    if levels is not None:
        axes.axhspan(*levels, color=style.BAND, lw=0)
    if wanted is not None:
        axes.axhline(wanted, color=style.COLOURS[1], lw=0.9, ls="--", label=f"{QUOTED}: {wanted:g}")
    if hits is not None:
        axes.plot(
            *hits, ".", color=style.FAINT, ms=2.5, mew=0, label="saltating grain, every hit", rasterized=True
        )
    for k, (label, speed, overlap) in enumerate(lines):
        axes.plot(
            speed, overlap, style.MARKERS[k], ls="-", lw=0.7, color=style.COLOURS[(0, 2, 3)[k]], mfc="white",
            mew=1.0, label=label,
        )  # fmt: skip
    ticks = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.set_xlim(0.015, 2.5)
    axes.set_ylim(2.0e-4, 0.1)
    axes.set_xlabel("impact speed  (m/s)")
    axes.set_ylabel(_AXIS["overlap"])
    axes.legend(loc="upper left", fontsize=6.3, labelspacing=0.3)
    if note:
        axes.set_title(note, loc="right", fontsize=6.5, color="#444444", pad=3.0)
    return figure


@style.house
def rebounds(
    schemes: Mapping[str, ReboundCurve], asked: float, off: float, least: float, note: str = ""
) -> Figure:
    """Draw restitution against steps per contact; bars span all phases of first touch.

    Parameters
    ----------
    schemes : name in the legend -> restitution found.
    asked, off : restitution of the case, and the deviation still considered normal (shaded) [-].
    least : steps per contact required by the paper (dashed).
    note : above the frame.
    """
    figure, (axes,) = style.new(height=3.2)
    axes.set_xscale("log")
    axes.axhspan(asked - off, asked + off, color=style.BAND, lw=0)
    axes.axhline(1.0, color=style.FAINT, lw=0.7, ls=":")
    axes.axvline(least, color="black", lw=0.7, ls="--")
    for k, (name, one) in enumerate(schemes.items()):
        axes.errorbar(
            one.steps, one.e, yerr=np.maximum([one.e - one.low, one.high - one.e], 0.0), ms=3.4, lw=0.7,
            marker=style.MARKERS[k], color=style.COLOURS[k], mfc="white", mew=0.9, capsize=1.8,
            elinewidth=0.8, label=name,
        )  # fmt: skip
    ticks = sorted({float(step) for one in schemes.values() for step in one.steps})
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.set_ylim(0.0, 2.0)
    axes.set_xlabel("steps per contact, contact time over $\\Delta t$  (–)")
    axes.set_ylabel("restitution got  (–)")
    how: Any = {"textcoords": "offset points", "fontsize": 6.3, "color": "#444444"}
    axes.annotate(f"{QUOTED}: at least {least:g}", (least, 2.0), (3, -9), **how)
    axes.annotate("gains energy", (ticks[-1], 1.0), (0, 2), ha="right", **how)
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", fontsize=6.3, labelspacing=0.3)
    if note:
        axes.set_title(note, loc="right", fontsize=6.5, color="#444444", pad=3.0)
    return figure


def _fill(axes: Axes, band: StiffnessBand) -> None:
    """Shade a region and name its soft edge at its upper end, its stiff edge at its lower one."""
    k = np.concatenate([band.k_low, band.k_high[::-1]]) * _PER_CM
    axes.fill(k, np.concatenate([band.y_low, band.y_high[::-1]]), color=style.BAND, lw=0)
    edges = (
        (band.k_low, band.y_low, band.labels[0], "bottom"),
        (band.k_high, band.y_high, band.labels[1], "top"),
    )
    for x, y, label, side in edges:
        axes.plot(x * _PER_CM, y, color="#7d9470", lw=0.9, ls="--", zorder=1.4)
        end = int(np.argmax(y) if side == "bottom" else np.argmin(y))
        at = (float(x[end]) * _PER_CM, float(y[end]))
        how: Any = {"textcoords": "offset points", "ha": "right", "va": side, "fontsize": 6.3}
        axes.annotate(label, at, (0, 1), color="#4c6340", **how)
