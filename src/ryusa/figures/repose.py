"""The free surface of a heap over its grains, with the slope fitted to it."""

import math

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.figures.snapshot import CM, PLAIN, grains, panel
from ryusa.measure import HeapSurface, Snapshot

AWAY = "#f4f2ee"  # grains that do not belong to the heap
LEGEND = 0.13  # height of the legend [inch]
FITTED, OTHER = "#D55E00", "#0072B2"


@style.house
def surface(seen: Snapshot, found: HeapSurface) -> Figure:
    """Draw the heap, the highest point of each bin, and the slope between the heights it is fitted to.

    Parameters
    ----------
    seen, found : `measure.snapshot` and `measure.surface` of the same moment.
    """
    figure, axes = panel(seen, LEGEND)
    colours = np.where(np.isin(seen.grains, found.grains), PLAIN, AWAY)
    grains(axes, seen, colours)
    if math.isfinite(found.angle):
        for share in found.fit:
            height = found.floor + share * (found.crest - found.floor)
            axes.axhline(height * CM, color=style.FAINT, lw=0.5, ls=":", zorder=3, label=_fit(found))
    axes.axhline(found.floor * CM, color="black", lw=0.5, ls="--", zorder=3)
    for inside, colour, name in ((False, OTHER, "surface"), (True, FITTED, "in the fit")):
        chosen = found.inside == inside
        axes.plot(
            found.x[chosen] * CM, found.z[chosen] * CM, "o", ms=2.4, mfc="white", mec=colour,
            mew=0.7, zorder=5, label=name,
        )  # fmt: skip
    axes.plot(found.line[:, 0] * CM, found.line[:, 1] * CM, color=FITTED, lw=1.4, zorder=4)
    axes.plot([found.toe * CM], [found.floor * CM], "^", color="black", ms=3.5, ls="none", zorder=5,
              clip_on=False, label="toe")  # fmt: skip
    names = dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    axes.legend(
        names.values(), names.keys(), loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=len(names),
        fontsize=5.8, handletextpad=0.5, columnspacing=0.8, handlelength=1.2, borderpad=0.0,
        borderaxespad=2.4,
    )  # fmt: skip
    axes.annotate(
        _words(found), (1, 1), (0, 4), xycoords="axes fraction", textcoords="offset points", ha="right",
        fontsize=7.0,
    )  # fmt: skip
    return figure


def _fit(found: HeapSurface) -> str:
    """Between which heights the slope is fitted, in words."""
    low, high = found.fit
    return f"{low:g} and {high:g} of the height"


def _words(found: HeapSurface) -> str:
    if not math.isfinite(found.angle):
        return "no slope fitted: " + found.flags[-1].partition(":")[0]
    known = [one for one in (found.angle, *found.angles.values()) if math.isfinite(one)]
    text = f"{math.degrees(found.angle):.1f}° ± {math.degrees(found.error):.1f}°"
    if len(known) > 1:
        text += f"  (other ranges {math.degrees(min(known)):.1f}° to {math.degrees(max(known)):.1f}°)"
    return text if not found.flags else f"{text}\n{found.flags[0].partition(':')[0]}"
