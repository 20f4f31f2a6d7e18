"""The front of the grains that have moved, over time."""

from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.front import SHARE, Front


@style.house
def front(found: Front) -> Figure:
    """Draw the place of the first grain and of the front over time."""
    figure, (axes,) = style.new()
    axes.plot(found.t, found.first, ls="--", label="first grain")
    axes.plot(found.t, found.front, label=f"front, {SHARE:.0%} of the volume beyond it")
    axes.set_xlabel("time  $t$  (s)")
    axes.set_ylabel("distance  $x$  (m)")
    axes.margins(x=0.0)
    axes.legend(loc="lower right")
    return figure
