"""Loads on dams and walls over time."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.loads import Loads
from ryusa.spelling import known_word

MOST = 4  # structures in one picture, unless they are named
LEAST = 0.05  # of the largest force, below which its point of action is not drawn

PARTS: dict[str, Any] = {
    name: {"color": style.COLOURS[c], "ls": style.LINES[c]}
    for c, name in enumerate(("water", "grains", "total"))
}


@style.house
def loads(found: Loads, wall: Sequence[str] = ()) -> Figure:
    """Draw the horizontal force on each structure by width, its largest mean, and where it acts.

    Parameters
    ----------
    found : loads on dams and walls.
    wall : names of those to be drawn; default all, of more than four those with the largest forces.

    Raises
    ------
    CaseError : no dam or wall has that name.
    """
    for one in wall:
        known_word(one, found.names, "dam or wall")
    first = np.argsort(-np.abs(found.largest[:, 1]))[:MOST]
    at = [found.names.index(one) for one in dict.fromkeys(wall)] if wall else np.sort(first).tolist()
    figure, axes = style.new(2 * len(at), width=4.8, height=0.9 + 2.5 * len(at), sharex=True)
    for k, s in enumerate(at):
        _force(axes[2 * k], found, s)
        _place(axes[2 * k + 1], found, s)
    style.over_time(figure, axes)
    if left := [name for s, name in enumerate(found.names) if s not in at and not wall]:
        style.note(
            figure, f"the {MOST} with the largest forces; --wall NAME draws another: {', '.join(left)}"
        )
    style.note(figure, "water: hydrostatic, from the level beside each face")
    if np.any(found.grains[:, at, 0] != 0.0):
        style.note(figure, "grains act at their moment over their force along x: weight on a crest lowers it")
    return figure


def _force(panel: Axes, found: Loads, s: int) -> None:
    """Force of water and grains on a structure, its largest mean, and formulae for that of a front."""
    parts = {"water": found.water[:, s, 0], "grains": found.grains[:, s, 0]}
    parts = {name: of for name, of in parts.items() if np.any(of != 0.0)}
    if len(parts) > 1:
        parts["total"] = found.total[:, s, 0]
    for name, of in parts.items():
        panel.plot(found.t, of / found.width, **PARTS[name], lw=0.9, label=name)
    begin, largest = found.largest[s] / (1.0, found.width)
    panel.plot(
        [begin, begin + found.window], [largest, largest], color=style.COLOURS[-1], lw=2.2, marker="|",
        ms=5.0, solid_capstyle="butt", label=f"largest mean\nover {found.window:.3g} s",
    )  # fmt: skip
    if (front := found.fronts[s]) is not None:
        for c, (name, force) in enumerate(list(front.forces.items())[1:]):
            label = name if "bore" in name else r"$\rho u^2 h$ of the front"
            panel.axhline(force, color=style.FAINT, ls=style.LINES[c + 2], lw=0.8, label=label)
    panel.set_title(found.names[s], fontsize=7.0, loc="left", pad=2.0)
    panel.set_ylabel("force along\n$x$  (N/m)")


def _place(panel: Axes, found: Loads, s: int) -> None:
    """Heights over the toe at which the forces act, where they are not too small to tell."""
    forces = {"water": found.water, "grains": found.grains, "total": found.total}
    acting = [name for name in ("water", "grains") if np.any(forces[name][:, s, 0] != 0.0)]
    for name, height in found.acts_at.items():
        if name not in (acting if len(acting) < 2 else forces):
            continue
        force = np.abs(forces[name][:, s, 0])
        drawn = np.where(force > LEAST * np.abs(found.total[:, s, 0]).max(), 1e3 * height[:, s], np.nan)
        if np.isfinite(drawn).any():
            panel.plot(found.t, drawn, **PARTS[name], lw=0.9, label=name)
    panel.set_ylabel("acts over the\ntoe at  (mm)")
