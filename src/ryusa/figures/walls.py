"""Forces on walls over time."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.walls import AXES, WallForces

SMALL = 0.05  # of the largest force
LINES = ("-", (0, (4, 1.5)), (0, (1, 1.2)))


@style.house
def walls(found: WallForces) -> Figure:
    """Draw the force on each wall, and the power of those that move.

    Components that never reach 5 % of the largest force are left out.
    """
    least = SMALL * float(np.abs(found.force).max(initial=0.0))
    powered = bool(np.any(found.power != 0.0))
    figure, axes = style.new(1 + powered, width=4.8, height=2.6 + 1.6 * powered, sharex=True)
    for w, name in enumerate(found.names):
        colour = style.COLOURS[w % len(style.COLOURS)]
        for a, axis in enumerate(AXES):
            values = found.force[:, w, a]
            if np.abs(values).max(initial=0.0) > least:
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
            one.legend(fontsize=6.0, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes[-1].set_xlabel("time  $t$  (s)")
    return figure
