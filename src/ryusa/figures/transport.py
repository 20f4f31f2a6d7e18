"""Transport rate over bed shear stress, with bed-load formulae."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ryusa.figures import style
from ryusa.measure import Transport

Floats = NDArray[np.float64]
INK = "#5a5a5a"
BINS = 100  # points of a line over time
DASHES = (*style.LINES, (0, (7, 1.2, 1, 1.2, 1, 1.2)), (0, (9, 3)), (0, (1, 3)))


@dataclass(frozen=True)
class Formula:
    """A transport formula, drawn as a line.

    Attributes
    ----------
    label : author and year.
    tau_star, q_star : dimensionless shear stress and transport rate [-], shape (n,); drawn only where q_star
        is positive.
    """

    label: str
    tau_star: Floats
    q_star: Floats


@dataclass(frozen=True)
class Rates:
    """Transport rates, measured in runs or in a flume.

    Attributes
    ----------
    label : name in the legend.
    tau_star, q_star : dimensionless shear stress and transport rate [-], shape (n,).
    error : standard error of q_star [-], the same shape; nan where unknown.
    tau_error : standard error of tau_star [-], the same shape; None if tau_star is prescribed.
    """

    label: str
    tau_star: Floats
    q_star: Floats
    error: Floats
    tau_error: Floats | None = None


@style.house
def transport(rates: Sequence[Rates], formulae: Sequence[Formula] = (), note: str = "") -> Figure:
    """Draw q_star over tau_star, both axes logarithmic.

    Parameters
    ----------
    rates : points with one standard error; a rate that is not positive is an arrow at the lower edge.
    formulae : grey lines, distinguished by their dashes.
    note : a line of text in the lower right corner.
    """
    figure, (axes,) = style.new(height=3.0)
    _chart(axes, rates, formulae, note)
    return figure


@style.house
def transport_of_run(found: Transport, formulae: Sequence[Formula] = (), name: str = "run") -> Figure:
    """Draw q_star of a run over time, and its mean against tau_star.

    Parameters
    ----------
    found : `measure.transport`.
    formulae : as in `transport`.
    name : of the run.

    Notes
    -----
    Frames are averaged over a hundredth of the time, because the passage of single grains dominates shorter
    times; the band is the mean with one standard error, with a star where the record is too short for it,
    and beside it stands whether the record is steady. A run without a tau_star has no second panel.
    """
    chart = found.tau_star > 0.0
    width, ratios = (style.PAGE, [1.15, 1.0]) if chart else (style.COLUMN, [1.0])
    figure, axes = style.new(
        1, len(ratios), width=width, height=3.0 if chart else 2.4, gridspec_kw={"width_ratios": ratios}
    )
    _over_time(axes[0], found)
    if chart:
        mean = found.averages["q_star"]
        one = np.array([found.tau_star]), np.array([mean.value]), np.array([mean.error])
        error = None if math.isnan(found.tau_error) else np.array([found.tau_error])
        _chart(axes[1], [Rates(name, *one, error)], formulae, "")
        for panel, text in zip(axes, ("(a)", "(b)"), strict=True):
            panel.annotate(
                text, (0, 1), (0, 3), xycoords="axes fraction", textcoords="offset points", weight="bold"
            )
    return figure


def _over_time(axes: Axes, found: Transport) -> None:
    every = max(len(found.t) // BINS, 1)
    parts = np.array_split(np.arange(len(found.t)), max(len(found.t) // every, 1))
    t = [float(found.t[part].mean()) for part in parts]
    q = [float((found.q_star[part] @ found.dt[part]) / found.dt[part].sum()) for part in parts]
    mean = found.averages["q_star"]
    axes.plot(t, q, color=style.COLOURS[0], lw=0.8)
    axes.axhline(mean.value, color=style.COLOURS[1], lw=0.9, ls="--")
    if np.isfinite(mean.error):
        low, high = mean.value - mean.error, mean.value + mean.error
        axes.axhspan(low, high, color=style.COLOURS[1], alpha=0.2, lw=0.0)
    axes.annotate(
        rf"mean {mean.value:.3g} $\pm$ {mean.error_text}" + f"\nsteady: {mean.verdict}",
        (1, 1), (-4, -4), "axes fraction", textcoords="offset points", ha="right", va="top", fontsize=6.5,
        color=style.COLOURS[1],
    )  # fmt: skip
    low, high = min(*q, 0.0), max(*q, 0.0)
    axes.set_ylim(low, high + 0.25 * (high - low) if high > low else 1.0)
    axes.set_xlim(float(found.t[0] - 0.5 * found.dt[0]), float(found.t[-1] + 0.5 * found.dt[-1]))
    axes.set_xlabel("time  $t$  (s)")
    axes.set_ylabel(r"transport rate  $q_*$  (–)")


def _chart(axes: Axes, rates: Sequence[Rates], formulae: Sequence[Formula], note: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    for k, one in enumerate(formulae):
        there = (one.q_star > 0.0) & (one.tau_star > 0.0)
        dashes: Any = DASHES[k % len(DASHES)]
        axes.plot(
            one.tau_star[there], one.q_star[there], ls=dashes, color=INK, lw=0.9, label=one.label, zorder=2
        )
    _limits(axes, rates, formulae)
    style.log_ticks(axes.xaxis)
    for k, one in enumerate(rates):
        _points(axes, one, k)
    axes.set_xlabel(r"shear stress  $\tau_* = \tau_b/((\sigma-\rho)\,g\,d)$  (–)")
    axes.set_ylabel(r"transport rate  $q_* = q/\sqrt{(\sigma/\rho-1)\,g\,d^3}$  (–)")
    if len(rates) + len(formulae) > 0:
        axes.legend(loc="upper left", fontsize=6.5)
    if note:
        axes.annotate(
            note, (1, 0), (-4, 4), "axes fraction", textcoords="offset points", ha="right", fontsize=6.5,
            color="#444444",
        )  # fmt: skip


def _points(axes: Axes, one: Rates, k: int) -> None:
    colour, marker = style.COLOURS[k % len(style.COLOURS)], style.MARKERS[k % len(style.MARKERS)]
    seen = one.q_star > 0.0
    low = np.minimum(np.nan_to_num(one.error), 0.999 * np.abs(one.q_star))  # lower end above zero
    high = np.nan_to_num(one.error)
    across = None if one.tau_error is None else np.nan_to_num(one.tau_error)[seen]
    axes.errorbar(
        one.tau_star[seen], one.q_star[seen], yerr=np.stack([low, high])[:, seen], xerr=across, fmt=marker,
        color=colour, mfc="white", mew=1.0, ms=4.2, capsize=1.8, elinewidth=0.8, lw=0, zorder=4,
        label=one.label,
    )  # fmt: skip
    for tau in one.tau_star[~seen]:
        axes.annotate(
            "", (float(tau), 0.0), (0, 11), axes.get_xaxis_transform(), textcoords="offset points",
            arrowprops={"arrowstyle": "->", "color": colour, "lw": 0.9},
        )  # fmt: skip


def _limits(axes: Axes, rates: Sequence[Rates], formulae: Sequence[Formula]) -> None:
    """Room for all points; lines that plunge to nothing at the threshold may leave at the bottom."""
    tau = np.concatenate([np.zeros(0), *(one.tau_star for one in (*formulae, *rates))])
    points = np.concatenate([np.zeros(0), *(one.q_star for one in rates)])
    lines = np.concatenate([np.zeros(0), *(one.q_star for one in formulae)])
    tau, points, lines = tau[tau > 0.0], points[points > 0.0], lines[lines > 0.0]
    if len(tau):
        axes.set_xlim(tau.min() / 1.15, tau.max() * 1.15)
    every = np.concatenate([points, lines])
    if len(every):
        floor = points.min() / 5.0 if len(points) else every.max() / 1.0e4
        axes.set_ylim(min(floor, every.max() / 1.0e2), every.max() * 6.0)
