"""Heights and lengths of hops: histograms of one or several runs."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure import Saltation

LEAST = 0.1  # diameters that the axes show at least: a grain that falls straight goes no way


@style.house
def hops(runs: Mapping[str, Saltation], d: float) -> Figure:
    """Draw the shares of jump heights and lengths, in diameters; a dashed line marks each mean.

    Parameters
    ----------
    runs : name shown in the legend -> what was measured.
    d : diameter [m].
    """
    figure, panels = style.new(1, 2, width=style.PAGE, height=2.3)
    for axes, field, text in (
        (panels[0], "rise", "jump height above take-off  $h/d$  (–)"),
        (panels[1], "length", "jump length  $\\ell/d$  (–)"),
    ):
        largest = max((float(one.hops[field].max()) for one in runs.values() if len(one.hops)), default=d) / d
        edges = np.linspace(0.0, max(largest * 1.001, LEAST), 21).tolist()
        for k, (name, one) in enumerate(runs.items()):
            values = one.hops[field] / d
            if len(values) == 0:
                continue
            colour = style.COLOURS[k % len(style.COLOURS)]
            share = np.full(len(values), 1.0 / len(values))
            axes.hist(values, edges, weights=share, histtype="stepfilled", color=colour, alpha=0.18, lw=0)
            axes.hist(values, edges, weights=share, histtype="step", color=colour, lw=1.0,
                      label=f"{name} ({len(values)} hops, dashed: mean)")  # fmt: skip
            axes.axvline(float(values.mean()), color=colour, lw=0.9, ls="--")
        axes.set_xlabel(text)
        axes.set_xlim(0.0, None)
        axes.set_ylim(0.0, None)
    panels[0].set_ylabel("share of hops  (–)")
    style.legend_above(panels[0], 3)
    return figure


@style.house
def contact_times(found: Saltation) -> Figure:
    """Draw the distribution of bed contact times over Eq. (8), with its damped form."""
    figure, (axes,) = style.new(height=2.6)
    ratio = found.contact_time / found.times.eq_8
    if len(ratio):
        axes.hist(ratio, 60, color=style.COLOURS[0], alpha=0.75, lw=0)
        axes.axvline(float(ratio.mean()), color=style.COLOURS[1], label=f"mean {ratio.mean():.3f}")
    added, damped = found.times.added / found.times.eq_8, found.times.damped / found.times.eq_8
    wet = added != 1.0  # a dry grain has no added mass
    if wet:
        axes.axvline(added, color="black", lw=0.8, ls="--", label=f"Eq. (8) with added mass {added:.3f}")
    text = "and with dashpot" if wet else "Eq. (8) with dashpot"
    axes.axvline(damped, color="black", lw=0.8, ls=":", label=f"{text} {damped:.3f}")
    axes.set_xlabel("contact time over Eq. (8) of the dry grain  (–)")
    axes.set_ylabel("number of bed contacts")
    style.legend_above(axes, 1, fontsize=6.5)
    return figure
