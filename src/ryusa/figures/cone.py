"""A round heap: height over distance from its axis, with the slope fitted to all its sides."""

import math

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.cone import Cone

CM = 100.0
FITTED, OTHER = "#D55E00", "#0072B2"


@style.house
def cone(found: Cone) -> Figure:
    """Draw the highest grain of each cell over its distance from the axis, and the fitted slope."""
    figure, (axes,) = style.new(width=4.8, height=2.4)
    for inside, colour, name in ((False, OTHER, "highest grain of a cell"), (True, FITTED, "in the fit")):
        chosen = found.inside == inside
        axes.plot(
            found.r[chosen] * CM, found.z[chosen] * CM, ".", ms=3.0, color=colour, alpha=0.6, label=name
        )
    axes.plot(
        found.ring_r * CM, found.ring_z * CM, "o", ms=4.0, mfc="white", mec="black", label="mean of a ring"
    )
    r, z = found.r[found.inside], found.z[found.inside]
    ends = np.array([r.min(), r.max()])
    axes.plot(ends * CM, (z.mean() - math.tan(found.angle) * (ends - r.mean())) * CM, color="black", lw=1.2)
    axes.axvline(found.foot * CM, color=style.FAINT, lw=0.8, ls=":", label="foot")
    axes.set_xlim(0.0, 1.05 * found.foot * CM)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("distance from the axis  (cm)")
    axes.set_ylabel("height above the floor  (cm)")
    style.legend_above(axes, 4, fontsize=6.0, columnspacing=1.2)
    axes.annotate(
        f"{math.degrees(found.angle):.1f}° ± {math.degrees(found.error):.1f}°", (1, 1), (0, 4),
        xycoords="axes fraction", textcoords="offset points", ha="right",
    )  # fmt: skip
    return figure
