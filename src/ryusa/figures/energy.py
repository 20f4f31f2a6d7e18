"""The energy account of a run over time."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure import Energy
from ryusa.measure.energy import TERMS

SUPPLIED, LOST = "-", (0, (4, 1.5))  # line of a term that is supplied, and of one that is lost
BLUE, RED, GREEN, PINK, SKY, AMBER, BLACK = style.COLOURS
# One colour per term, whatever else is drawn, so that pictures of several runs can be compared.
HELD = {
    "kinetic": BLUE,
    "spin": RED,
    "potential": GREEN,
    "spring_n": PINK,
    "spring_s": SKY,
    "spring_r": AMBER,
}
WORK = {
    "drag": BLUE, "torque": RED, "lift": GREEN, "flow": SKY, "wall": BLACK, "switch": AMBER, "step": PINK,
    "dash_n": BLUE, "dash_s": RED, "slide": GREEN, "roll": PINK, "film": SKY, "released_n": AMBER,
    "released_s": BLACK, "released_r": style.FAINT,
}  # fmt: skip


@style.house
def energy(found: Energy) -> Figure:
    """Draw the energy held (above), and supplied and lost (below); terms that stay zero are left out."""
    figure, (held, flow) = style.new(2, width=style.PAGE, height=4.3, sharex=True)
    unit, name = _prefix(found)
    for term, values in _alive(found.held):
        base = values[0] if term == "potential" else 0.0
        label = "potential, change" if term == "potential" else TERMS[term]
        held.plot(found.t, (values - base) / unit, color=HELD[term], label=label)
    for sign, word, line, terms in ((1.0, "+", SUPPLIED, found.given), (-1.0, "–", LOST, found.lost)):
        for term, values in _alive(terms):
            label = f"{word} {TERMS[term]}"
            flow.plot(found.t, sign * values / unit, ls=line, color=WORK[term], label=label)
    flow.plot(
        found.t,
        found.imbalance / unit,
        color="black",
        lw=0.8,
        ls=":",
        label=f"imbalance, at most\n{found.residual:.1e} of the largest term",
    )
    for axes, text in ((held, f"held  ({name})"), (flow, f"supplied (+), lost (–)  ({name})")):
        axes.axhline(0.0, color=style.FAINT, lw=0.4, zorder=0)
        axes.set_ylabel(text)
        axes.margins(x=0.0)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=6.3, labelspacing=0.4)
    flow.set_xlabel("time  $t$  (s)")
    return figure


def _alive(terms: dict[str, np.ndarray]) -> list[tuple[str, np.ndarray]]:
    return [(name, values) for name, values in terms.items() if np.any(values != 0.0)]


def _prefix(found: Energy) -> tuple[float, str]:
    """Unit for which the ticks are between 1 and 1000."""
    terms = [v for group in (found.lost, found.given) for v in group.values()]
    terms += [v - v[0] for name, v in found.held.items() if name == "potential" and len(v)]
    terms += [v for name, v in found.held.items() if name != "potential"]
    largest = max((float(np.abs(v).max()) for v in terms if len(v)), default=1.0)
    for unit, name in ((1.0, "J"), (1e-3, "mJ"), (1e-6, "µJ"), (1e-9, "nJ")):
        if largest >= unit:
            return unit, name
    return 1.0, "J"
