"""Energy that a drum gives to its grains, and that they lose, over its turns."""

import math

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.mill import Mill


@style.house
def mill(found: Mill) -> Figure:
    """Draw torque over the turns, and the energy given by the drum and lost by the grains since the first."""
    figure, (upper, lower) = style.new(2, 1, width=4.8, height=3.6, sharex=True)
    turn = 2.0 * math.pi / found.rate
    turns = (found.t - found.t[0]) / turn
    upper.plot(turns, found.torque, color=style.COLOURS[0], lw=0.7)
    upper.axhline(float(found.torque.mean()), color="black", lw=0.8, ls=(0, (4, 1.5)), label="mean")
    upper.set_ylim(bottom=min(0.0, float(found.torque.min())))
    upper.set_ylabel("torque  (N m)")
    upper.legend(fontsize=6.0, loc="lower left")
    upper.annotate(
        f"{found.critical:.0%} of the critical speed", (1, 1), (0, 4), xycoords="axes fraction",
        textcoords="offset points", ha="right",
    )  # fmt: skip
    dt = float(np.diff(found.t).mean())
    curves = (("given by the drum", found.given, "-"), ("lost by the grains", found.lost, "--"))
    for k, (name, values, line) in enumerate(curves):
        label = f"{name}, mean {float(values.mean()):.3g} W"
        lower.plot(turns, np.cumsum(values) * dt, color=style.COLOURS[k], ls=line, label=label)
    lower.margins(x=0.0)
    lower.set_ylabel("energy  (J)")
    lower.set_xlabel("turns")
    lower.legend(fontsize=6.0, loc="upper left")
    return figure
