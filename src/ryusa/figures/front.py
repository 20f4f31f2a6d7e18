"""The front of the grains that have moved, over time."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.errors import ResultsError
from ryusa.figures import style
from ryusa.measure.front import SHARE, Front


@style.house
def front(found: Front) -> Figure:
    """Draw the place of the first grain and of the front over time.

    Raises
    ------
    ResultsError : no grain has moved.
    """
    if not np.isfinite(found.first).any():
        raise ResultsError("no grain has moved: there is no front")
    figure, (axes,) = style.new(height=2.8)
    axes.plot(found.t, found.first, ls="--", label="first grain")
    axes.plot(found.t, found.front, label=f"front, {SHARE:.0%} of the volume beyond it")
    axes.set_xlabel("time  $t$  (s)")
    axes.set_ylabel("distance  $x$  (m)")
    axes.margins(x=0.0)
    style.legend_above(axes, 1)
    return figure
