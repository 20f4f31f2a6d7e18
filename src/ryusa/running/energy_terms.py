"""Energy account of a run as lines of text, every term with its full name (docs/glossary.md)."""

import math
from collections.abc import Mapping

from ryusa.model import Term
from ryusa.model.tally import GIFTS, HELD, LOSSES

_HELD = dict(
    zip(
        HELD,
        ("translation", "rotation", "potential", "normal springs", "tangential springs", "rolling springs"),
        strict=True,
    )
)
_WORK = {
    Term.DASH_N: "normal dashpots",
    Term.DASH_S: "tangential dashpots",
    Term.SLIDE: "sliding friction",
    Term.ROLL: "rolling friction",
    Term.RELEASED_N: "normal springs at separation",
    Term.RELEASED_S: "tangential springs at separation",
    Term.RELEASED_R: "rolling springs at separation",
    Term.FILM: "liquid films",
    Term.DRAG: "drag",
    Term.TORQUE: "torque of the water",
    Term.LIFT: "lift",
    Term.FLOW: "pressure gradient and acceleration of the water",
    Term.WALL: "moving walls",
    Term.SWITCH: "changes of the scene",
    Term.STEP: "error of the time step",
}


def energy_lines(terms: Mapping[str, float]) -> list[tuple[str, str]]:
    """Headings and texts of the account; terms that are exactly zero are left out.

    Parameters
    ----------
    terms : energies by the names of summary.json [J], and `residual` [-]; nan where an engine keeps none.

    >>> energy_lines({"kinetic": 1.0, "start": 2.5, "slide": 1.5, "imbalance": 0.0, "residual": 0.0})[1]
    ('dissipated', '1.5 J: sliding friction 1.5')
    """
    held = {name: terms.get(key, 0.0) for key, name in _HELD.items()}
    lost = {_WORK[term]: terms.get(term.name.lower(), 0.0) for term in LOSSES}
    given = {_WORK[term]: terms.get(term.name.lower(), 0.0) for term in GIFTS}
    start = terms.get(Term.START.name.lower(), 0.0)
    if math.isnan(start):
        known = {name: value for name, value in held.items() if not math.isnan(value)}
        return [("energy now", _sum(known)), ("account", "not kept by this engine")]
    return [
        ("energy now", f"{_sum(held)}; at the start {start:.3g} J"),
        ("dissipated", _sum(lost)),
        ("work received", _sum(given)),
        (
            "imbalance",
            f"{terms['imbalance']:.2g} J, {terms['residual']:.1e} of the largest term of the energy account "
            "(terms: docs/glossary.md)",
        ),
    ]


def _sum(terms: Mapping[str, float]) -> str:
    """Sum of the terms [J], and each that is not zero."""
    shown = ", ".join(f"{name} {value:.3g}" for name, value in terms.items() if value != 0.0)
    return f"{sum(terms.values()):.3g} J{f': {shown}' if shown else ''}"
