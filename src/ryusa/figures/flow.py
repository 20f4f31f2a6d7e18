"""Mean speed of a bed over time."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ryusa.figures import style

Floats = NDArray[np.float64]
SpeedCurves = Mapping[str, tuple[Floats, Floats]]


@style.house
def speeds(
    panels: Mapping[str, SpeedCurves], d: float, flows: float, g: float = 9.8, note: str = ""
) -> Figure:
    """Draw the mean speed of the free grains along the bed over time, one panel per initial state.

    Parameters
    ----------
    panels : title -> name of a run -> time [s] and mean speed along the bed [m/s].
    d : mean diameter [m].
    flows : speed over sqrt(g d) above which the bed counts as flowing, drawn as a line.
    g : acceleration of gravity [m/s2].
    note : a line of text above.
    """
    every = [v for curves in panels.values() for _, v in curves.values()]
    most = max(float(np.max(v)) for v in every) / float(np.sqrt(g * d))
    figure, axes = style.new(1, len(panels), width=style.PAGE, height=2.7, sharey=True)
    names = list(dict.fromkeys(name for curves in panels.values() for name in curves))
    lines: dict[str, Line2D] = {}
    for panel, (title, curves) in zip(axes, panels.items(), strict=True):
        for name, (t, v) in curves.items():
            k = names.index(name)
            colour, line = style.COLOURS[k % 7], style.LINES[k % 4]
            (lines[name],) = panel.plot(t, v / np.sqrt(g * d), color=colour, ls=line, lw=1.0)
        panel.axhline(flows, color=style.FAINT, lw=0.7, ls=":")
        panel.set_yscale("symlog", linthresh=flows, linscale=0.5)
        panel.set_ylim(-0.5 * flows, 2.0 * most)
        panel.set_xlabel("time  $t$  (s)")
        panel.set_title(title)
        panel.margins(x=0.0)
    axes[0].set_ylabel(r"mean speed along the bed  $\bar v_x/\sqrt{g d}$  (–)")
    figure.legend(
        [lines[name] for name in names], names, loc="outside upper center", ncols=len(names),
        title=note or None, title_fontsize=6.5, fontsize=6.5,
    )  # fmt: skip
    return figure
