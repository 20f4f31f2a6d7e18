"""A deposit over time: what came, went and is stored, and the slope of its bed."""

from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.deposit import Deposit

CM2 = 1.0e4  # square centimetres in a square metre


@style.house
def deposit(found: Deposit) -> Figure:
    """Draw volumes that came, went and are stored over time, and the slope with the error of its fit."""
    figure, (above, below) = style.new(2, height=3.8, sharex=True)
    lines = (("came", found.brought), ("stored", found.stored), ("went", found.passed))
    for (name, volume), line in zip(lines, style.LINES, strict=False):
        above.plot(found.t, volume * CM2, ls=line, label=name)
    above.set_ylabel("volume of grains per width\n(cm²)")
    above.legend(loc="upper left")
    below.plot(found.t, found.slope)
    below.fill_between(
        found.t, found.slope - found.slope_error, found.slope + found.slope_error, alpha=0.2, lw=0.0
    )
    below.set_ylabel("slope of the bed  (–)")
    below.set_xlabel("time  $t$  (s)")
    below.margins(x=0.0)
    return figure
