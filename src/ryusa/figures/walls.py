"""Forces on walls over time."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.walls import AXES, WallForces

LINES = ("-", (0, (4, 1.5)), (0, (1, 1.2)))


@style.house
def walls(found: WallForces) -> Figure:
    """Draw the force on each wall, and the power of those that move; what stays zero is left out."""
    powered = bool(np.any(found.power != 0.0))
    figure, axes = style.new(1 + powered, width=4.8, height=2.6 + 1.6 * powered, sharex=True)
    for w, name in enumerate(found.names):
        colour = style.COLOURS[w % len(style.COLOURS)]
        for a, axis in enumerate(AXES):
            values = found.force[:, w, a]
            if np.any(values != 0.0):
                axes[0].plot(found.t, values, color=colour, ls=LINES[a], lw=0.9, label=f"{name}, {axis}")
        if np.any(found.power[:, w] != 0.0):
            axes[1].plot(found.t, found.power[:, w], color=colour, lw=0.9, label=name)
    axes[0].set_ylabel("force on the wall  (N)")
    if powered:
        axes[1].set_ylabel("power of the wall  (W)")
    for one in axes:
        one.axhline(0.0, color=style.FAINT, lw=0.4, zorder=0)
        one.margins(x=0.0)
        if one.lines[:-1]:
            one.legend(fontsize=6.0)
    axes[-1].set_xlabel("time  $t$  (s)")
    return figure
