"""Fig. 6: the path of one grain that saltates over a line of fixed, touching grains, k_n = 1 N/cm."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.experiments._experiment import Variant, Verdict
from ryusa.measure import Saltation, Tracks, saltation, tracks
from ryusa.results import Results

FIGURE = "fig6"
TITLE = "Path of a saltating grain"
SHOWN: tuple[str, ...] = ("quantity", "value", "standard_error", "unit", "n", "steady")


@dataclass(frozen=True)
class Table:
    """The path of the first start from its settling to its thirtieth hop, and the hops of all starts."""

    path: Tracks
    hops: Saltation

    def rows(self) -> list[dict[str, object]]:
        """Averages over all starts."""
        return self.hops.rows()


def cases() -> Sequence[Variant]:
    """One soft run."""
    return (Variant("1-N-per-cm", "paper/fig06.toml"),)


def measure(results: Mapping[str, Results]) -> Table:
    """Path and hops after settling."""
    run = results["1-N-per-cm"]
    found = saltation(run, hops=30)
    mine = found.hops[found.hops["grain"] == 0]
    begin, end = (float(mine["t_begin"][0]), float(mine["t_end"][-1])) if len(mine) else (0.0, float("inf"))
    return Table(tracks(run, [0], begin, end), found)


def expect(table: Table) -> Sequence[Verdict]:
    """The paper draws a grain that goes on hopping; it gives no number."""
    n = int((table.hops.hops["grain"] == 0).sum())
    return (Verdict("fig6", "30 saltations after settling", f"{n} of the first start", n >= 30),)


def draw(table: Table) -> Mapping[str, Figure]:
    """Tracks to scale, and how heights and lengths are distributed."""
    d = float(table.path.d[0])
    return {
        "fig06": figures.tracks(table.path),
        "fig06-hops": figures.hops({"k_n = 1 N/cm": table.hops}, d),
    }
