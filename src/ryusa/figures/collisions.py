"""Duration of contacts, by kind of partner."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure import Collisions
from ryusa.model import Scene

BINS = 60
MOST = 4  # walls that are drawn each; more are drawn as one


@style.house
def collision_times(found: Collisions, scene: Scene) -> Figure:
    """Draw the distribution of contact times on a logarithmic axis, by partner, with what Eq. (8) expects.

    Parameters
    ----------
    found : `measure.collisions`.
    scene : tells free grains, fixed grains, planes and walls apart.
    """
    figure, (axes,) = style.new(height=2.3)
    j = found.events["j"]
    bed, planes, walls = scene.n_grain, scene.n_grain + scene.n_fixed, scene.n_partner - scene.n_face
    kinds = [("free grain", j < bed), ("fixed grain", (j >= bed) & (j < planes))]
    kinds.append(("plane", (j >= planes) & (j < walls)))
    if scene.walls is not None:
        of = np.where(j >= walls, scene.walls.wall[np.maximum(j - walls, 0)], -1)
        named = scene.walls.names if scene.n_wall <= MOST else ()
        kinds += [(f"wall {name}", of == w) for w, name in enumerate(named)] or [("wall", of >= 0)]
    good = np.isfinite(found.duration) & (found.duration > 0.0)
    ends = (found.duration[good].min(), found.duration[good].max()) if good.any() else (1.0e-4, 1.0e-3)
    edges = np.geomspace(0.9 * ends[0], 1.1 * ends[1], BINS + 1).tolist()
    for k, (name, chosen) in enumerate(kinds):
        times = found.duration[good & chosen]
        if len(times) == 0:
            continue
        colour = style.COLOURS[k]
        axes.hist(times, edges, histtype="stepfilled", color=colour, alpha=0.2, lw=0)
        axes.hist(times, edges, histtype="step", color=colour, lw=1.0, label=f"{name} ({len(times)})")
        expected = float(np.median(found.expected[good & chosen]))
        axes.axvline(expected, color=colour, lw=0.8, ls="--", label=f"expected {expected:.3g} s")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(edges[0], edges[-1])
    axes.set_ylim(0.8, None)  # single contacts remain visible
    axes.set_xlabel("contact time  $t$  (s)")
    axes.set_ylabel("number of contacts")
    axes.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, ncols=2, fontsize=6.3,
        title="partner; dashed: Eq. (8) with dashpot, single impact", title_fontsize=6.3,
        alignment="left",
    )  # fmt: skip
    return figure
