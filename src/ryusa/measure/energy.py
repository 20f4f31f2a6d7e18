"""The energy account of a run over time."""

from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.measure.table import lines
from ryusa.model import Term
from ryusa.model.tally import GIFTS, HELD, LOSSES, residual_of
from ryusa.printed import ByShape

TERMS = {
    "kinetic": "kinetic",
    "spin": "rotational",
    "potential": "potential, weight less buoyancy",
    "spring_n": "normal springs",
    "spring_s": "tangential springs",
    "spring_r": "rolling springs",
    "dash_n": "normal dashpots",
    "dash_s": "tangential dashpots",
    "slide": "sliding friction",
    "roll": "rolling friction",
    "released_n": "released at parting, normal springs",
    "released_s": "released at parting, tangential springs",
    "released_r": "released at parting, rolling springs",
    "film": "lubrication films",
    "drag": "drag",
    "torque": "torque of the water",
    "lift": "lift and Magnus force",
    "flow": "pressure, stress, acceleration of the water",
    "wall": "moving walls",
    "switch": "changes of the scene",
    "step": "finite time step",
}  # key of a term -> what it is, as printed and drawn


@dataclass(frozen=True, repr=False)
class Energy(ByShape):
    """Terms of the account at each frame [J], each of shape (n_frame,).

    Attributes
    ----------
    t : times [s].
    held : energy in motion, height and springs, by name.
    lost : summed losses, by name.
    given : summed gifts (drag, torque of the water, lift, switches, the step), by name.
    start : energy at the first step [J].
    imbalance : what the account cannot explain [J].
    """

    t: Floats
    held: dict[str, Floats]
    lost: dict[str, Floats]
    given: dict[str, Floats]
    start: float
    imbalance: Floats

    @property
    def residual(self) -> float:
        """Largest imbalance over the largest term of the account [-], both over all frames."""
        terms = {Term[name.upper()]: one for name, one in {**self.lost, **self.given}.items()}
        return residual_of(self.imbalance, self.held, {**terms, Term.START: self.start})

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per frame."""
        columns = {"t_s": self.t}
        columns |= {f"held_{name}_J": one for name, one in self.held.items()}
        columns |= {f"lost_{name}_J": one for name, one in self.lost.items()}
        columns |= {f"given_{name}_J": one for name, one in self.given.items()}
        columns["imbalance_J"] = self.imbalance
        return lines(columns)


def energy(run: Run) -> Energy:
    """Energy account of a run, from the tally the engine summed while stepping.

    A first frame taken before the first step, when nothing is booked yet, is left out.

    Raises
    ------
    ResultsError : the engine of the run kept no account.
    """
    tally = run.tally
    if len(tally["t"]) and np.isnan(tally["start"]).all():
        raise ResultsError("the engine of this run keeps no account of energy")
    # The energy at the start is that of the first step.
    unbooked = len(tally["t"]) > 1 and tally["start"][0] != tally["start"][-1]
    if unbooked or (len(tally["t"]) > 1 and not any(tally[name][0] for name in (*HELD, "start"))):
        tally = {name: values[1:] for name, values in tally.items()}
    held = {name: np.asarray(tally[name], dtype=np.float64) for name in HELD}
    lost = {term.name.lower(): np.asarray(tally[term.name.lower()], dtype=np.float64) for term in LOSSES}
    given = {term.name.lower(): np.asarray(tally[term.name.lower()], dtype=np.float64) for term in GIFTS}
    begin = np.asarray(tally["start"], dtype=np.float64)
    start = float(begin[-1]) if len(begin) else 0.0
    imbalance = sum(held.values()) - start - sum(given.values()) + sum(lost.values())
    t = np.asarray(tally["t"], dtype=np.float64)
    return Energy(t, held, lost, given, start, np.broadcast_to(np.asarray(imbalance), t.shape))
