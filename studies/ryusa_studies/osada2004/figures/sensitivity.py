"""Sensitivity of results to choices: one row per choice, one panel per result."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure import Average


@dataclass(frozen=True)
class SensitivityRow:
    """One row: a choice and its results, by series (such as rotation locked and free)."""

    label: str
    results: Mapping[str, Sequence[Average]]  # series -> one average per panel


@style.house
def sensitivity(rows: Sequence[SensitivityRow], titles: Sequence[str], scales: Sequence[float]) -> Figure:
    """Draw every result with its standard error; vertical lines mark the values of the first row, the base.

    Parameters
    ----------
    rows : base first.
    titles : axis label of each panel.
    scales : factor of the averages of each panel (such as 1/d).
    """
    n = len(titles)
    figure, axes = style.new(1, n, width=style.PAGE, height=0.75 + 0.145 * len(rows), sharey=True)
    names = list(dict.fromkeys(name for row in rows for name in row.results))
    y = -np.arange(len(rows), dtype=np.float64)
    for k, (panel, title, scale) in enumerate(zip(axes, titles, scales, strict=True)):
        for s, name in enumerate(names):
            colour, shift = style.COLOURS[s], 0.14 * (0.5 * (len(names) - 1) - s) * 2
            base = rows[0].results.get(name)
            if base is not None:
                panel.axvline(base[k].value * scale, color=colour, lw=0.6, ls="--", zorder=1)
            at = [j for j, row in enumerate(rows) if name in row.results]
            values = np.array([rows[j].results[name][k].value for j in at]) * scale
            errors = np.array([rows[j].results[name][k].error for j in at]) * scale
            panel.errorbar(
                values, y[at] + shift, xerr=errors, fmt=style.MARKERS[s], ms=2.6, lw=0, elinewidth=0.8,
                color=colour, mfc="white", mew=0.8, label=name,
            )  # fmt: skip
        panel.set_xlabel(title, fontsize=7.0)
        left, right = panel.get_xlim()
        if left < 0.5 * right:
            panel.set_xlim(min(0.0, left), right)
        panel.margins(x=0.08)
        panel.tick_params(axis="y", length=0)
        panel.locator_params(axis="x", nbins=3)
        for edge in y[::2]:
            panel.axhspan(edge - 0.5, edge + 0.5, color="#f4f4f4", lw=0, zorder=0)
    axes[0].set_yticks(y, [row.label for row in rows])
    axes[0].set_ylim(y[-1] - 0.6, y[0] + 0.6)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=len(labels))
    return figure
