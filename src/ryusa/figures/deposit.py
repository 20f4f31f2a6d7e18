"""A deposit over time: what came, went and is stored, and the slope of its bed."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.errors import ResultsError
from ryusa.figures import style
from ryusa.measure.deposit import Deposit

CM2 = 1.0e4  # square centimetres in a square metre


@style.house
def deposit(found: Deposit) -> Figure:
    """Draw volumes that came, went and are stored over time, and the slope with the error of its fit.

    Of the two what holds nothing is left out, and a note says so.

    Raises
    ------
    ResultsError : grains neither came, went nor were stored, and no bed had a slope.
    """
    lines = (("came", found.brought), ("stored", found.stored), ("went", found.passed))
    volumes, slopes = any(volume.any() for _, volume in lines), bool(np.isfinite(found.slope).any())
    if not volumes and not slopes:
        raise ResultsError("no grains came, went or were stored, and there was no bed that has a slope")
    figure, axes = style.new(volumes + slopes, height=0.6 + 1.7 * (volumes + slopes), sharex=True)
    if volumes:
        for (name, volume), line in zip(lines, style.LINES, strict=False):
            axes[0].plot(found.t, volume * CM2, ls=line, label=name)
        axes[0].set_ylabel("grains per width  (cm²)")
        style.legend_above(axes[0], 3)
    else:
        style.note(figure, "no grains came, went or were stored")
    if slopes:
        low, high = found.slope - found.slope_error, found.slope + found.slope_error
        axes[-1].plot(found.t, found.slope)
        axes[-1].fill_between(found.t, low, high, alpha=0.2, lw=0.0)
        axes[-1].set_ylabel("slope of the bed  (–)")
    else:
        style.note(figure, "no bed that has a slope")
    axes[-1].set_xlabel("time  $t$  (s)")
    axes[-1].margins(x=0.0)
    return figure
