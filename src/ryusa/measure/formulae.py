"""Classical bed-load formulae for the grains and slope of a run, to compare its transport rate with."""

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from ryusa.laws import debris
from ryusa.laws import transport as laws
from ryusa.measure._run import Floats, Run
from ryusa.measure.snapshot import scene_at

BELOW, ABOVE = 4.0, 4.0  # how far the lines reach to either side of a run's tau_star, as factors
LEAST, MOST = 0.03, 1.0  # and how far at least
THRESHOLD = 0.05  # of Ashida & Michiue, as its docstring says
C_S, ALPHA, K_D, K_F = 0.3, 0.25, 0.0828, 0.16  # of Egashira, Miyamoto & Itoh


class FormulaCurve(NamedTuple):
    """One formula: its author, dimensionless shear stress and transport rate [-], shapes (n,)."""

    label: str
    tau_star: Floats
    q_star: Floats


def _ashida_michiue(tau_star: float) -> float:
    return laws.q_star_ashida_michiue(tau_star, tau_star, THRESHOLD)


_LAWS: dict[str, Callable[[float], float]] = {
    "Meyer-Peter & Müller 1948": laws.q_star_meyer_peter_mueller,
    "Wong & Parker 2006": laws.q_star_wong_parker,
    "Ashida & Michiue 1972": _ashida_michiue,
}


def predicted(tau_star: float) -> dict[str, float]:
    """Dimensionless transport rate [-] by each formula for a dimensionless shear stress [-], by its author.

    >>> [f"{one:.4f}" for one in predicted(0.2).values()]
    ['0.4788', '0.2318', '0.5702']
    """
    return {name: law(tau_star) for name, law in _LAWS.items()}


class MeasuredShear(Protocol):
    """What the lines of formulae need of a measured transport, as `measure.transport` gives it."""

    @property
    def t(self) -> Floats:
        """Times of the frames [s]."""
        ...

    @property
    def tau_star(self) -> float:
        """Shields number of the bed [-]."""
        ...

    @property
    def excess(self) -> float:
        """Submerged specific density of the grains, sigma/rho - 1 [-]."""
        ...


def classical(run: Run, found: MeasuredShear) -> list[FormulaCurve]:
    """Meyer-Peter & Mueller, Wong & Parker, Ashida & Michiue, and Egashira where the run has a slope.

    Parameters
    ----------
    run : its slope, friction and restitution go into Egashira's formula, which has depth beyond all layers.
    found : `measure.transport` of it.

    Notes
    -----
    All for a plane bed without bed forms. Egashira's speaks of bed load, not of debris flow: it ends where
    the slope leaves no layer.
    """
    middle = found.tau_star if found.tau_star > 0.0 else math.sqrt(LEAST * MOST)
    tau = np.geomspace(min(LEAST, middle / BELOW), max(MOST, middle * ABOVE), 240)
    rates = [predicted(float(one)) for one in tau]
    lines = [FormulaCurve(name, tau, np.array([one[name] for one in rates])) for name in _LAWS]
    scene = scene_at(run, float(found.t[0]))
    slope = math.atan2(float(scene.gravity[0]), -float(scene.gravity[2]))
    contact = run.case.get("contact") or {}
    e, angle = contact.get("restitution"), math.atan(scene.contact.mu)
    if found.excess > 0.0 and slope > 0.0 and e is not None:
        ratio = 1.0 + found.excess
        f = debris.collision_factor(C_S, float(e), K_D, ratio, 1.0) + debris.pore_factor(C_S, K_F)
        q = np.array([laws.q_star_egashira(one, slope, angle, C_S, ALPHA, f, 1.0e9) for one in tau])
        if np.isfinite(q).all():
            lines.append(FormulaCurve("Egashira et al. 1997", tau, q))
    return lines
