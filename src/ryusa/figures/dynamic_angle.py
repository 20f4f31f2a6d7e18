"""Angle of the grains in a drum over time."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.dynamic_angle import DynamicAngle


@style.house
def dynamic_angle(found: DynamicAngle) -> Figure:
    """Draw the angle of the surface and that of the centre of mass over time, with their means."""
    figure, (axes,) = style.new(width=4.8, height=2.4)
    for k, (name, values) in enumerate((("surface", found.surface), ("centre of mass", found.mass))):
        colour, mean = style.COLOURS[k], float(np.nanmean(np.degrees(values)))
        axes.plot(found.t, np.degrees(values), color=colour, lw=0.8, label=f"{name}, mean {mean:.1f}°")
        axes.axhline(mean, color=colour, lw=0.6, ls=(0, (4, 1.5)))
    axes.margins(x=0.0)
    axes.set_ylabel("angle to the horizontal  (°)")
    axes.set_xlabel("time  $t$  (s)")
    axes.legend(fontsize=6.0, ncols=2, loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2)
    axes.annotate(
        rf"$\omega^2 R/g$ = {found.froude:.3g}", (1, 1), (0, 4), xycoords="axes fraction",
        textcoords="offset points", ha="right",
    )  # fmt: skip
    return figure
