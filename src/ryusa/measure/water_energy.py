"""The energy account of the water in a row of columns over time."""

from dataclasses import dataclass

import numpy as np

from ryusa.measure._run import Floats, Run
from ryusa.measure.long_section import row_of
from ryusa.measure.table import lines
from ryusa.model.row_energy import CHANGES, ROW_GIFTS, ROW_LOSSES, RowTerm, row_imbalance
from ryusa.printed import ByShape

WATER_TERMS = {
    "kinetic": "kinetic",
    "potential": "potential",
    "gravity": "gravity along the axis",
    "driver": "imposed pressure gradient",
    "upstream": "upstream end",
    "downstream": "downstream end",
    "grains": "forces of grains",
    "displaced": "displacement by grains",
    "bed": "shear stress at the bottom",
    "side": "side walls",
    "shear": "stress between cells",
    "porous": "drag of porous solids",
    "fall": "falls, walls and dams",
    "upwind": "scheme: momentum from upstream",
    "late": "scheme: implicit step",
    "surface": "scheme: explicit surface",
}  # key of a term -> what it is, as printed


@dataclass(frozen=True, repr=False)
class WaterEnergy(ByShape):
    """Terms of the account since the start, per width, at each frame [J/m], each of shape (n_frame,).

    Attributes
    ----------
    t : times [s].
    changed : changes of kinetic and potential energy, by name.
    lost : energy that the water has lost, by name.
    given : energy that it was given, by name; negative where it gave.
    imbalance : what the terms leave over.
    """

    t: Floats
    changed: dict[str, Floats]
    lost: dict[str, Floats]
    given: dict[str, Floats]
    imbalance: Floats

    @property
    def residual(self) -> float:
        """Largest imbalance over the largest term [-], both over all frames."""
        every = (one for group in (self.changed, self.lost, self.given) for one in group.values())
        largest = max(float(np.abs(one).max(initial=0.0)) for one in every)
        return float(np.abs(self.imbalance).max(initial=0.0)) / largest if largest > 0.0 else 0.0

    def quantities(self) -> list[tuple[str, float, str]]:
        """Terms at the end that are not zero, and what is left over: name, value, unit."""
        groups = (("change", self.changed), ("supplied", self.given), ("lost", self.lost))
        found = [
            (f"{group}: {WATER_TERMS[name]}", float(one[-1]), "J/m")
            for group, terms in groups
            for name, one in terms.items()
            if one[-1] != 0.0
        ]
        return [*found, ("largest imbalance over largest term", self.residual, "-")]

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per frame."""
        columns = {"t_s": self.t}
        for key, group in (("changed", self.changed), ("lost", self.lost), ("given", self.given)):
            columns |= {f"{key}_{name}_J_m": one for name, one in group.items()}
        columns["imbalance_J_m"] = self.imbalance
        return lines(columns)


def water_energy(run: Run) -> WaterEnergy:
    """Energy account of the water in a row of columns, as its steps summed it.

    Raises
    ------
    ResultsError : the run has no row of columns.
    """
    found = row_of(run)
    account = found.energy

    def named(terms: tuple[RowTerm, ...]) -> dict[str, Floats]:
        return {term.name.lower(): account[:, term] for term in terms}

    return WaterEnergy(found.t, named(CHANGES), named(ROW_LOSSES), named(ROW_GIFTS), row_imbalance(account))
