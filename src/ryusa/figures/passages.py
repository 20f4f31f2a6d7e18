"""Mass that passed each feed and exit, grain by grain, and what feeds owe."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.passages import Passages
from ryusa.model.feeds import IN

DASHED = (0, (4, 1.5))


@style.house
def passages(found: Passages) -> Figure:
    """Draw the mass that passed since the begin of the window, and below it the backlog, where there are any.

    Feeds are drawn with full lines, exits with broken ones.
    """
    in_debt = [one for one in found.gates if one.owed_n.any()]
    panels = 2 if in_debt else 1
    figure, axes = style.new(panels, width=4.8, height=2.6 + 1.5 * (panels - 1), sharex=True)
    begin, end = found.window
    colours = {one.label: style.COLOURS[k % len(style.COLOURS)] for k, one in enumerate(found.gates)}
    for one in found.gates:
        t = np.concatenate([[begin], one.t, [end]])
        mass = np.concatenate([[0.0], np.cumsum(one.m)])
        line = "-" if one.way == IN else DASHED
        axes[0].step(t, np.append(mass, mass[-1]), where="post", color=colours[one.label], ls=line,
                     lw=0.9, label=one.label)  # fmt: skip
    axes[0].set_ylabel("mass that passed  (kg)")
    axes[0].legend(fontsize=6.0)
    for one in in_debt:
        axes[1].step(found.instants, one.owed, where="post", color=colours[one.label], lw=0.9,
                     label=one.name)  # fmt: skip
    if in_debt:
        axes[1].set_ylabel("mass owed  (kg)")
        axes[1].legend(fontsize=6.0)
    for one in axes:
        one.set_xlim(begin, end)
        one.set_ylim(bottom=0.0)
    axes[-1].set_xlabel("time  $t$  (s)")
    return figure
