"""Mass that entered, left and is there, over time."""

from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.discharge import Discharge

DASHED = (0, (4, 1.5))


@style.house
def discharge(found: Discharge) -> Figure:
    """Draw the mass that passed each feed and exit, and what is there; broken lines are the mean rates."""
    figure, axes = style.new(2, width=4.8, height=4.2, sharex=True)
    passed = {f"in by {name}": one for name, one in found.by_feed.items()}
    passed |= {f"out by {name}": one for name, one in found.by_exit.items()}
    since = found.t - found.t[0]
    for k, (name, mass) in enumerate(passed.items()):
        colour = style.COLOURS[k % len(style.COLOURS)]
        axes[0].plot(found.t, mass, color=colour, lw=0.9, label=name)
        if mass[-1] > mass[0]:
            mean = mass[0] + (mass[-1] - mass[0]) * since / since[-1]
            axes[0].plot(found.t, mean, color=colour, ls=DASHED, lw=0.6)
    if any(mass[-1] > mass[0] for mass in passed.values()):
        axes[0].plot([], [], color="black", ls=DASHED, lw=0.6, label="mean rate")
    axes[0].set_ylabel("mass that passed  (kg)")
    axes[1].plot(found.t, found.m, color=style.COLOURS[-1], lw=0.9)
    axes[1].set_ylabel("mass there  (kg)")
    axes[1].set_xlabel("time  $t$  (s)")
    for one in axes:
        one.margins(x=0.0)
        one.set_ylim(bottom=0.0)
    axes[0].legend(fontsize=6.0)
    return figure
