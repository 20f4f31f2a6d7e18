"""Rods of moving grains at several times, and how many grains rods have: the form of the paper's fig22."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.figures.snapshot import CM, PLAIN, circles, grains
from ryusa.measure import Rods, Snapshot

MARKED = "#20262c"
OWN = 2  # smallest number of grains of a rod
MORE = 9  # rods of this many grains or more share a bar


@style.house
def rods(seen: Sequence[Snapshot], marked: Sequence[int]) -> Figure:
    """Draw several times one above the other; marked grains are black, as in the paper.

    Parameters
    ----------
    seen : snapshots of one run (`measure.snapshot`).
    marked : ids of the grains to follow.
    """
    first = seen[0]
    every = np.concatenate([one.x[:, 2] for one in seen])
    d = float(first.d.max())
    low = float(first.bed_x[:, 2].min() - 0.5 * d) if len(first.bed_x) else float(every.min()) - 0.5 * d
    high = float(every.max()) + 0.7 * d
    row = (style.PAGE - 0.6) * (high - low) / first.period
    figure, axes = style.new(
        len(seen), width=style.PAGE, height=0.5 + len(seen) * (row + 0.22), sharex=True, sharey=True
    )
    for panel, one in zip(axes, seen, strict=True):
        circles(panel, one.bed_x, one.bed_d, style.BED, "#8c8578", period=one.period)
        colours = np.where(np.isin(one.grains, marked), MARKED, PLAIN)
        grains(panel, one, colours)
        panel.set_xlim(0.0, one.period * CM)
        panel.set_ylim(low * CM, high * CM)
        panel.set_aspect("equal")
        panel.locator_params(axis="y", nbins=4)
        panel.set_title(f"$t$ = {one.t:.4g} s", loc="left", fontsize=6.5, pad=2.0)
    axes[-1].set_xlabel("distance along the bed  $x$  (cm), flow to the right")
    figure.supylabel(style.height("cm"), fontsize=8.0)
    return figure


@style.house
def rod_lengths(found: Mapping[str, Rods]) -> Figure:
    """Draw the share of moving grains in rods of n grains, with the null model, for each run."""
    figure, (bars, shares) = style.new(1, 2, width=style.PAGE, height=2.4)
    n = np.arange(OWN, MORE + 1)
    wide = 0.8 / len(found)
    for s, (name, one) in enumerate(found.items()):
        count = np.zeros(MORE + 1)
        for length in range(OWN, len(one.lengths)):
            count[min(length, MORE)] += length * one.lengths[length]
        whole = max(int(one.movers.sum()), 1)
        colour = style.COLOURS[s % len(style.COLOURS)]
        bars.bar(n + (s - 0.5 * (len(found) - 1)) * wide, count[OWN:] / whole, wide, color=colour, label=name)
        shares.bar([s - 0.18], [one.share], 0.34, color=colour)
        shares.bar([s + 0.18], [one.null_share], 0.34, color=colour, alpha=0.35)
    bars.set_xticks(n, [*(str(k) for k in n[:-1]), f"{MORE}+"])
    bars.set_xlabel("grains in a rod")
    bars.set_ylabel("share of the moving grains  (–)")
    bars.legend()
    shares.set_xticks(np.arange(len(found)), list(found))
    shares.set_ylabel("moving grains in rods  (–)\npale: displacements shuffled")
    shares.set_ylim(0.0, 1.0)
    return figure
