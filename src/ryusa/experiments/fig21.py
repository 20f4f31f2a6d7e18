"""Fig. 21: spin of a saltating grain against the way it went, rotation free and nothing resisting it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.experiments._experiment import Variant, Verdict
from ryusa.measure import Saltation, Spin, saltation, spin
from ryusa.results import Results

FIGURE = "fig21"
TITLE = "Spin of a saltating grain"
SHOWN: tuple[str, ...] = ("quantity", "value", "standard_error", "unit", "n", "steady")


@dataclass(frozen=True)
class Table:
    """Spin of all starts, and what each bounce did to it."""

    spin: Spin
    hops: Saltation  # from the first touch on, settling included

    def rows(self) -> list[dict[str, object]]:
        """Averages after settling."""
        return [*self.spin.rows(), self.hops["spin_before"].row(), self.hops["spin_after"].row()]


def cases() -> Sequence[Variant]:
    """One run with rotation free."""
    return (Variant("free", "paper/fig21.toml"),)


def measure(results: Mapping[str, Results]) -> Table:
    """Spin over the whole run, its growth included."""
    run = results["free"]
    return Table(spin(run), saltation(run, settle=0.0))


def expect(table: Table) -> Sequence[Verdict]:
    """Spin grows with every bed hit and reaches about 900 rad/s."""
    bounces = table.hops.bounces
    gain = bounces["omega_after"] - bounces["omega_before"]
    early = np.concatenate([gain[bounces["grain"] == g][:3] for g in np.unique(bounces["grain"])])
    mean = table.spin.averages["spin_absolute"]
    return (
        Verdict(
            "fig21",
            "spin grows at every hit on the bed",
            f"{int((early > 0).sum())} of the first {len(early)} bounces (three per start) and "
            f"{int((gain > 0).sum())} of all {len(gain)} add spin",
            bool((early > 0).mean() > 0.9),
        ),
        Verdict(
            "fig21",
            "reaches about 900 rad/s",
            f"mean {mean.value:.0f} ± {mean.error:.0f}, largest {table.spin.largest:.0f} rad/s, settled",
            675.0 < mean.value < 1125.0,
        ),
    )


def draw(table: Table) -> Mapping[str, Figure]:
    """Spin against distance, one start dark and the others faint."""
    return {"fig21": figures.spin(table.spin)}
