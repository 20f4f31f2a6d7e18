"""Grading curves: percent finer by mass over diameter, asked for and laid."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.sizes import Sizes

MM = 1.0e3  # millimetres in a metre
NAMED = (0.1, 0.5, 0.9)  # shares whose diameters are marked


@style.house
def sizes(found: Sizes) -> Figure:
    """Draw percent finer by mass over diameter, logarithmic: the curve asked for, and the grains laid.

    The curve laid is a step at every grain. Diameters D10, D50 and D90 of it are marked.
    """
    figure, (axes,) = style.new(width=4.4, height=3.2)
    axes.set_xscale("log")
    passed = np.concatenate([[0.0], np.cumsum(found.m) / found.m.sum()])
    low, high = float(found.d[0]), float(found.d[-1])
    if found.asked is not None:
        d, finer = found.asked.d * MM, found.asked.finer * 100.0
        axes.plot(d, finer, color=style.COLOURS[1], marker="o", ms=3.5, lw=1.2, label="asked for", zorder=2)
        low, high = min(low, float(found.asked.d[0])), max(high, float(found.asked.d[-1]))
    steps = np.concatenate([[0.5 * low], found.d, [2.0 * high]]) * MM
    axes.stairs(
        100.0 * passed, steps, baseline=None, color=style.COLOURS[0], lw=1.2, zorder=3,
        label=f"laid, {len(found.d):,} grain{'s' * (len(found.d) != 1)}",
    )  # fmt: skip
    laid = found.laid
    for share in NAMED:
        there = laid.diameter(share) * MM
        axes.plot([there, there], [0.0, 100.0 * share], color=style.FAINT, lw=0.6, ls=":", zorder=1)
        axes.annotate(
            f"$D_{{{round(100 * share)}}}$ = {there:.3g} mm", (there, 100.0 * share), xytext=(-4, 3),
            textcoords="offset points", ha="right", fontsize=6.5,
        )  # fmt: skip
    axes.set_xlim(0.7 * low * MM, 1.4 * high * MM)
    axes.set_ylim(0.0, 102.0)
    style.log_ticks(axes.xaxis)
    axes.set_xlabel("diameter  (mm)")
    axes.set_ylabel("finer by mass  (%)")
    style.legend_above(axes, 2)
    return figure
