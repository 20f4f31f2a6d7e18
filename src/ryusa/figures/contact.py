"""Contact time and overlap against stiffness, with closed forms, measured points and the stable band."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ryusa.figures import style

Floats = NDArray[np.float64]
ContactQuantity = Literal["time", "overlap"]

_AXIS = {
    "time": "contact time  $t$  (s)",
    "overlap": "largest overlap  $\\delta_{\\max}/d$  (–)",
}


@dataclass(frozen=True)
class StiffnessCurve:
    """A line over stiffness.

    Attributes
    ----------
    label : written at its end, or in the legend.
    k_n : stiffness [N/m].
    y : contact time [s] or overlap over diameter [-].
    """

    label: str
    k_n: Floats
    y: Floats


@dataclass(frozen=True)
class StiffnessPoints:
    """Measured values over stiffness with their standard errors; same units as StiffnessCurve."""

    label: str
    k_n: Floats
    y: Floats
    error: Floats


@dataclass(frozen=True)
class StiffnessBand:
    """A region between two lines over stiffness.

    Attributes
    ----------
    labels : names of the soft and the stiff edge, written at their lower ends.
    k_low, y_low : the soft edge (large overlap).
    k_high, y_high : the stiff edge (small overlap).
    """

    labels: tuple[str, str]
    k_low: Floats
    y_low: Floats
    k_high: Floats
    y_high: Floats


@style.house
def over_stiffness(
    quantity: ContactQuantity,
    curves: Sequence[StiffnessCurve],
    points: Sequence[StiffnessPoints] = (),
    band: StiffnessBand | None = None,
    levels: tuple[float, float] | None = None,
    note: str = "",
) -> Figure:
    """Draw contact time or overlap against k_n, both axes logarithmic.

    Parameters
    ----------
    quantity : "time" or "overlap".
    curves : closed forms; with points they go into a legend, else each is labelled at its right end.
    points : measured values.
    band : a shaded region, such as the stable band.
    levels : two values of y between which the whole width is shaded.
    note : a line of text in the lower left corner (speed, density).
    """
    figure, (axes,) = style.new(height=2.75)
    axes.set_xscale("log")
    axes.set_yscale("log")
    if levels is not None:
        axes.axhspan(*levels, color=style.BAND, lw=0)
    if band is not None:
        _fill(axes, band)
    ordered = not points and len(curves) > 1
    for k, curve in enumerate(curves):
        colour: Any = style.shade(k / (len(curves) - 1)) if ordered else style.FAINT
        line = "-" if ordered else style.LINES[k % len(style.LINES)]
        axes.plot(curve.k_n, curve.y, line, color=colour, label=None if ordered else curve.label)
        if ordered:
            _label_end(axes, curve, colour)
    for k, one in enumerate(points):
        axes.errorbar(
            one.k_n, one.y, yerr=one.error, fmt=style.MARKERS[k], color=style.COLOURS[k], mfc="white",
            mew=1.0, capsize=1.8, elinewidth=0.8, lw=0, label=one.label,
        )  # fmt: skip
    axes.set_xlabel("normal stiffness  $k_n$  (N/m)")
    axes.set_ylabel(_AXIS[quantity])
    if curves:
        left, right = min(c.k_n.min() for c in curves), max(c.k_n.max() for c in curves)
        room = (right / left) ** 0.04 if points else 1.0
        axes.set_xlim(left / room, right * ((right / left) ** 0.17 if ordered else room))
    if not ordered:
        axes.legend(loc="best")
    if note:
        axes.annotate(
            note, (0, 0), (4, 4), "axes fraction", textcoords="offset points", fontsize=6.5, color="#444444"
        )
    return figure


@style.house
def turning(runs: Mapping[str, tuple[Floats, Floats]], closed: tuple[Floats, Floats]) -> Figure:
    """Draw contact times against how much the normal turns within a contact, one dot per contact.

    Parameters
    ----------
    runs : name in the legend -> turning u**2 t/(d v), contact time over its expected value [-].
    closed : the same two of the closed form for a smooth grain.
    """
    figure, (axes,) = style.new(height=2.75)
    for k, (name, (x, y)) in enumerate(runs.items()):
        axes.plot(
            x,
            y,
            style.MARKERS[k],
            color=style.COLOURS[k],
            ms=1.3,
            mew=0,
            alpha=0.55,
            label=name,
            rasterized=True,
        )
    axes.plot(*closed, color="black", lw=0.9, label="smooth grain, closed form")
    axes.set_xscale("log")
    axes.set_xlim(float(closed[0].min()), float(closed[0].max()))
    axes.set_ylim(0.0, 1.1)
    axes.set_xlabel("turning of the contact  $u^2 t/(d\\,v)$  (–)")
    axes.set_ylabel("contact time over damped Eq. (8)  (–)")
    axes.legend(loc="lower left", markerscale=4.0)
    return figure


def _fill(axes: Axes, band: StiffnessBand) -> None:
    x = np.concatenate([band.k_low, band.k_high[::-1]])
    y = np.concatenate([band.y_low, band.y_high[::-1]])
    axes.fill(x, y, color=style.BAND, lw=0)
    edges = ((band.k_low, band.y_low, band.labels[0]), (band.k_high, band.y_high, band.labels[1]))
    for k, edge, label in edges:
        axes.plot(k, edge, color="#7d9470", lw=0.8)
        end = int(np.argmin(edge))
        at = (float(k[end]), float(edge[end]))
        how: Any = {"textcoords": "offset points", "ha": "right", "va": "top", "fontsize": 6.5}
        axes.annotate(label, at, (-1, -1), color="#4c6340", **how)


def _label_end(axes: Axes, curve: StiffnessCurve, colour: Any) -> None:
    at = (float(curve.k_n[-1]), float(curve.y[-1]))
    axes.annotate(
        curve.label, at, xytext=(3, 0), textcoords="offset points", va="center", fontsize=6.5, color=colour
    )
