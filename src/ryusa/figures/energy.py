"""The energy account of a run over time."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure import Energy

_NAMES = {
    "kinetic": "kinetic (with added mass)",
    "spin": "spin",
    "potential": "potential",
    "spring_n": "normal springs",
    "spring_s": "tangential springs",
    "spring_r": "rolling springs",
    "dash_n": "normal dashpots",
    "dash_s": "tangential dashpots",
    "slide": "sliding",
    "roll": "rolling friction",
    "released_n": "released normal springs",
    "released_s": "released shear springs",
    "released_r": "released rolling springs",
    "drag": "drag",
    "torque": "torque of the water",
    "lift": "lift",
    "switch": "timeline",
    "step": "the step",
}


@style.house
def energy(found: Energy) -> Figure:
    """Draw what is held (above) and what came and went (below); terms that stay zero are left out."""
    figure, (held, flow) = style.new(2, width=4.8, height=4.6, sharex=True)
    unit, name = _prefix(found)
    for k, (term, values) in enumerate(_alive(found.held)):
        base = values[0] if term == "potential" else 0.0
        label = "potential, change" if term == "potential" else _NAMES.get(term, term)
        held.plot(
            found.t, (values - base) / unit, style.LINES[k // 4], color=style.COLOURS[k % 7], label=label
        )
    order = 0
    for sign, word, terms in ((1.0, "+", found.given), (-1.0, "–", found.lost)):
        for term, values in _alive(terms):
            line = style.LINES[order // len(style.COLOURS)]
            colour = style.COLOURS[order % len(style.COLOURS)]
            label = f"{word} {_NAMES.get(term, term)}"
            flow.plot(found.t, sign * values / unit, line, color=colour, label=label)
            order += 1
    flow.plot(found.t, found.imbalance / unit, color="black", lw=0.8, ls=":", label="unexplained")
    for axes, text in ((held, f"held  ({name})"), (flow, f"given (+), lost (–)  ({name})")):
        axes.axhline(0.0, color=style.FAINT, lw=0.4, zorder=0)
        axes.set_ylabel(text)
        axes.margins(x=0.0)
    for axes in (held, flow):
        axes.legend(loc="lower left", fontsize=6.3, bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.2)
    flow.set_xlabel("time  $t$  (s)")
    at: Any = {"xycoords": "axes fraction", "textcoords": "offset points", "fontsize": 6.3}
    at["bbox"] = {"facecolor": "white", "alpha": 0.8, "lw": 0.0, "pad": 0.5}
    flow.annotate(f"residual {found.residual:.1e}", (0, 0), (4, 4), **at)
    return figure


def _alive(terms: dict[str, np.ndarray]) -> list[tuple[str, np.ndarray]]:
    return [(name, values) for name, values in terms.items() if np.any(values != 0.0)]


def _prefix(found: Energy) -> tuple[float, str]:
    """The unit that keeps the ticks between 1 and 1000."""
    terms = [v for group in (found.lost, found.given) for v in group.values()]
    terms += [v - v[0] for name, v in found.held.items() if name == "potential" and len(v)]
    terms += [v for name, v in found.held.items() if name != "potential"]
    largest = max((float(np.abs(v).max()) for v in terms if len(v)), default=1.0)
    for unit, name in ((1.0, "J"), (1e-3, "mJ"), (1e-6, "µJ"), (1e-9, "nJ")):
        if largest >= unit:
            return unit, name
    return 1.0, "J"
