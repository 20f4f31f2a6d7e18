"""Loads on dams over time."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.loads import Loads
from ryusa.spelling import known_word


@style.house
def loads(found: Loads, wall: Sequence[str] = ()) -> Figure:
    """Draw the horizontal force on each dam by width, and the height at which that of the water acts.

    Parameters
    ----------
    found : loads on dams.
    wall : names of the dams to be drawn; default all.

    Raises
    ------
    CaseError : no dam has that name.
    """
    for one in wall:
        known_word(one, found.names, "dam")
    at = [found.names.index(one) for one in dict.fromkeys(wall or found.names)]
    figure, axes = style.new(2 * len(at), width=4.8, height=0.8 + 2.3 * len(at), sharex=True)
    parts = {"water": found.water, "grains": found.grains}
    if np.any(found.grains != 0.0):
        parts["both"] = found.total
    for k, d in enumerate(at):
        panel, below = axes[2 * k], axes[2 * k + 1]
        for c, (name, of) in enumerate(parts.items()):
            values = of[:, d, 0] / found.width
            if np.any(values != 0.0):
                colour, line = style.COLOURS[c], style.LINES[c]
                panel.plot(found.t, values, color=colour, ls=line, lw=0.9, label=name)
        panel.set_title(found.names[d], fontsize=7.0, loc="left", pad=2.0)
        panel.set_ylabel("force along\n$x$  (N/m)")
        below.plot(found.t, 1e3 * found.height[:, d], color=style.COLOURS[0], lw=0.9)
        below.set_ylabel("water acts over\nthe toe at  (mm)")
        panel.legend(fontsize=6.0, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    for one in axes:
        one.axhline(0.0, color=style.FAINT, lw=0.4, zorder=0)
        one.margins(x=0.0)
    axes[-1].set_xlabel("time  $t$  (s)")
    figure.align_ylabels(axes)
    style.note(figure, "water: hydrostatic, from the level beside each face")
    return figure
