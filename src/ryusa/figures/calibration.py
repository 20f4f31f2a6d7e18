"""Pictures of a calibration: the posterior of the parameters, the emulators, observed and predicted."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ryusa.figures import style

Floats = NDArray[np.float64]

BINS = 30
SHOWN = 1500  # points of a panel of two parameters
TICKS = 4
PANELS = 3  # side by side


@dataclass(frozen=True)
class CalibratedParameter:
    """One parameter as it is drawn.

    Attributes
    ----------
    label : with its unit.
    values : a sample of the posterior, shape (n,), row by row that of the other parameters.
    prior : a sample of the prior, shape (n,).
    low, high : ends of the range of the prior.
    """

    label: str
    values: Floats
    prior: Floats
    low: float
    high: float


@style.house
def parameters_picture(parameters: Sequence[CalibratedParameter]) -> Figure:
    """Draw the posterior of every parameter beside its prior, and every two of them together."""
    n = len(parameters)
    width = style.COLUMN if n == 1 else style.PAGE
    figure, panels = style.new(n, n, width=width, height=max(2.4, width / n * 0.85 * n if n > 1 else 2.4))
    for row, below in enumerate(parameters):
        for column, beside in enumerate(parameters):
            panel = panels[row * n + column]
            if column > row:
                panel.set_visible(False)
                continue
            panel.xaxis.set_major_locator(MaxNLocator(TICKS))
            if column == row:
                _marginal(panel, below, legend=row == 0)
            else:
                panel.plot(
                    beside.values[:SHOWN], below.values[:SHOWN], ".", ms=1.6, mew=0.0, alpha=0.5,
                    color=style.COLOURS[0], rasterized=True,
                )  # fmt: skip
                panel.set_ylim(below.low, below.high)
                panel.yaxis.set_major_locator(MaxNLocator(TICKS))
            panel.set_xlim(beside.low, beside.high)
            if row == n - 1:
                panel.set_xlabel(beside.label)
            if column == 0 and row > 0:
                panel.set_ylabel(below.label)
    return figure


def _marginal(panel: Axes, one: CalibratedParameter, *, legend: bool) -> None:
    _densities(panel, one.prior, one.values, np.linspace(one.low, one.high, BINS + 1))
    panel.set_ylabel("density")
    if legend:
        panel.legend(fontsize=6.5)


def _densities(panel: Axes, prior: Floats, posterior: Floats, edges: Floats) -> None:
    """Draw the distribution of a sample of the prior as a line, and that of the posterior filled."""
    for values, fill, name in ((prior, False, "prior"), (posterior, True, "posterior")):
        heights, _ = np.histogram(values, edges, density=True)
        panel.stairs(
            heights, edges, fill=fill, color=style.COLOURS[0] if fill else style.COLOURS[6], lw=0.9,
            alpha=0.55 if fill else 1.0, label=name,
        )  # fmt: skip
    panel.set_yticks([])
    panel.set_ylim(0.0, None)


@dataclass(frozen=True)
class EmulatedTarget:
    """One quantity as runs and emulator give it.

    Attributes
    ----------
    label : with its unit.
    measured, predicted, sd : value of every run, what the other runs predict for it, and the standard
        deviation of that with the scatter between seeds, shape (n,).
    """

    label: str
    measured: Floats
    predicted: Floats
    sd: Floats


@style.house
def emulators_picture(targets: Sequence[EmulatedTarget]) -> Figure:
    """Draw what the other runs predict for each run over what it gave."""
    figure, panels, _ = _panels(len(targets), 2.7)
    for panel, one in zip(panels, targets, strict=False):
        ends = [
            min(one.measured.min(), (one.predicted - one.sd).min()),
            max(one.measured.max(), (one.predicted + one.sd).max()),
        ]
        panel.plot(ends, ends, color=style.FAINT, lw=0.8, zorder=1)
        panel.errorbar(
            one.measured, one.predicted, yerr=one.sd, fmt="o", ms=2.6, mfc="none", mew=0.7, elinewidth=0.6,
            color=style.COLOURS[0],
        )  # fmt: skip
        panel.set_xlabel(f"run: {one.label}")
        panel.set_ylabel("from the other runs, ± s.d.")
        panel.xaxis.set_major_locator(MaxNLocator(TICKS))
        panel.yaxis.set_major_locator(MaxNLocator(TICKS))
    return figure


def _panels(count: int, height: float) -> tuple[Figure, list[Axes], int]:
    """A figure of so many panels, each of that height [inch], and how many stand in a row."""
    columns = min(count, PANELS)
    rows = math.ceil(count / columns)
    width = style.COLUMN if columns == 1 else style.PAGE
    figure, panels = style.new(rows, columns, width=width, height=height * rows)
    for panel in panels[count:]:
        panel.set_visible(False)
    return figure, panels[:count], columns


@dataclass(frozen=True)
class PredictedTarget:
    """One quantity over prior and posterior.

    Attributes
    ----------
    label : with its unit.
    prior, posterior : samples, shape (n,).
    observed : observed value and its standard error; None without one.
    """

    label: str
    prior: Floats
    posterior: Floats
    observed: tuple[float, float] | None


@style.house
def predicted_picture(targets: Sequence[PredictedTarget]) -> Figure:
    """Draw every quantity over the prior and over the posterior, with what was observed."""
    figure, panels, columns = _panels(len(targets), 2.3)
    for k, (panel, one) in enumerate(zip(panels, targets, strict=False)):
        both = np.concatenate([one.prior, one.posterior])
        edges = np.linspace(both.min(), both.max(), 2 * BINS + 1)
        _densities(panel, one.prior, one.posterior, edges)
        if one.observed is not None:
            value, error = one.observed
            panel.axvspan(value - error, value + error, color=style.COLOURS[1], alpha=0.3, lw=0.0)
            panel.axvline(value, color=style.COLOURS[1], lw=0.9, label="observed ± s.e.")
        panel.set_xlabel(one.label)
        panel.xaxis.set_major_locator(MaxNLocator(TICKS))
        if k % columns == 0:
            panel.set_ylabel("density")
        if k == 0 or (one.observed is not None and all(two.observed is None for two in targets[:k])):
            panel.legend(fontsize=6.5)
    return figure
