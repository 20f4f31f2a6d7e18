"""The free surface of a heap over its grains, with the slope fitted to it."""

import math

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.figures.snapshot import CM, PLAIN, grains, panel
from ryusa.measure import HeapSurface, Snapshot

AWAY = "#f4f2ee"  # grains that do not belong to the heap
FITTED, OTHER = "#D55E00", "#0072B2"


@style.house
def surface(seen: Snapshot, found: HeapSurface) -> Figure:
    """Draw the heap, the highest point of each bin, and the slope between the heights it is fitted to.

    Parameters
    ----------
    seen, found : `measure.snapshot` and `measure.surface` of the same moment.
    """
    figure, axes = panel(seen)
    colours = np.where(np.isin(seen.grains, found.grains), PLAIN, AWAY)
    grains(axes, seen, colours)
    if math.isfinite(found.angle):
        for share in found.fit:
            height = found.floor + share * (found.crest - found.floor)
            axes.axhline(height * CM, color=style.FAINT, lw=0.5, ls=":", zorder=3)
            axes.annotate(
                f"{share:g} of the height", (1, height * CM), (-3, 1.5),
                xycoords=("axes fraction", "data"), textcoords="offset points", ha="right", fontsize=5.5,
                color=style.FAINT, annotation_clip=False,
            )  # fmt: skip
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
    axes.legend(
        loc="center right" if found.side == "right" else "center left",
        fontsize=5.8,
        handletextpad=0.2,
        labelspacing=0.25,
    )
    axes.annotate(
        _words(found), (1, 1), (0, 4), xycoords="axes fraction", textcoords="offset points", ha="right",
        fontsize=7.0,
    )  # fmt: skip
    return figure


def _words(found: HeapSurface) -> str:
    if not math.isfinite(found.angle):
        return "no slope fitted: " + found.flags[-1].partition(":")[0]
    known = [one for one in (found.angle, *found.angles.values()) if math.isfinite(one)]
    text = f"{math.degrees(found.angle):.1f}° ± {math.degrees(found.error):.1f}°"
    if len(known) > 1:
        text += f"  (other ranges {math.degrees(min(known)):.1f}° to {math.degrees(max(known)):.1f}°)"
    return text if not found.flags else f"{text}\n{found.flags[0].partition(':')[0]}"
