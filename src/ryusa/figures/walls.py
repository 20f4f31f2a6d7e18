"""Forces on walls over time."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ryusa.errors import ResultsError
from ryusa.figures import style
from ryusa.measure.walls import AXES, WallForces
from ryusa.spelling import known_word

MOST = 8  # walls in one picture, unless they are named


@style.house
def walls(found: WallForces, wall: Sequence[str] = ()) -> Figure:
    """Draw the force on each wall in a panel of its own, and the power of those that move.

    Parameters
    ----------
    found : forces on walls.
    wall : names of the walls to be drawn; default all that felt a force. Of more than eight the eight that
        felt the largest are drawn, and a note names the others.

    Raises
    ------
    CaseError : no wall has that name.
    ResultsError : no wall felt a force.
    """
    for one in wall:
        known_word(one, found.names, "wall")
    shown, said = (list(dict.fromkeys(wall)), []) if wall else _chosen(found)
    if not shown:
        raise ResultsError(f"no grain touched a wall: {', '.join(found.names)}")
    at = [found.names.index(one) for one in shown]
    moving = [w for w in at if np.any(found.power[:, w] != 0.0)]
    n = len(at)
    figure, axes = style.new(n + bool(moving), width=4.8, height=1.0 + 1.3 * (n + bool(moving)), sharex=True)
    for panel, w in zip(axes, at, strict=False):
        _force(panel, found, w)
    if moving:
        for w in moving:
            colour = style.COLOURS[at.index(w) % len(style.COLOURS)]
            axes[-1].plot(found.t, found.power[:, w], color=colour, lw=0.9, label=found.names[w])
        axes[-1].set_ylabel("power of\nthe wall  (W)")
    style.over_time(figure, axes)
    for one in said:
        style.note(figure, one)
    return figure


def _force(axes: Axes, found: WallForces, w: int) -> None:
    """The components of the force on one wall that are not zero throughout."""
    for a, axis in enumerate(AXES):
        values = found.force[:, w, a]
        if np.any(values != 0.0):
            axes.plot(found.t, values, color=style.COLOURS[a], ls=style.LINES[a], lw=0.9, label=axis)
    if found.names[w] in found.untouched:
        axes.annotate("no grain touched it", (0.5, 0.6), xycoords="axes fraction", ha="center", fontsize=6.5)
    axes.set_title(found.names[w], fontsize=7.0, loc="left", pad=2.0)
    axes.set_ylabel("force  (N)")


def _chosen(found: WallForces) -> tuple[list[str], list[str]]:
    """Walls that are drawn where none is named, and what is to be said of the others."""
    felt = [one for one in found.names if one not in found.untouched]
    largest = dict(zip(found.names, np.abs(found.force).max(axis=(0, 2), initial=0.0).tolist(), strict=True))
    first = sorted(felt, key=lambda one: -largest[one])[:MOST]
    left = [one for one in felt if one not in first]
    said: list[str] = []
    if left:
        said.append(f"the {MOST} walls with the largest forces; --wall NAME draws another: {', '.join(left)}")
    if found.untouched:
        said.append(f"no grain touched: {', '.join(found.untouched)}")
    return [one for one in felt if one in first], said
