"""Fig. 20: saltation with rotation locked and free, k_n = 100 N/cm; jumps and the shear on the bed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.experiments._experiment import Variant, Verdict
from ryusa.measure import Average, Saltation, Tracks, saltation, tracks
from ryusa.results import Results

FIGURE = "fig20"
TITLE = "Saltation with and without rotation"
SHOWN: tuple[str, ...] = ("rotation", "quantity", "value", "standard_error", "unit", "n", "steady")
WAY = 0.3  # shown of each path [m]
SURE = 2.0  # standard errors by which two means must differ to be called different


@dataclass(frozen=True)
class Table:
    """Hops and paths, locked and free."""

    hops: Mapping[str, Saltation]
    paths: Mapping[str, Tracks]

    def rows(self) -> list[dict[str, object]]:
        """One line per average and state of rotation."""
        return [{"rotation": name, **row} for name, one in self.hops.items() for row in one.rows()]


def cases() -> Sequence[Variant]:
    """The same case, locked and free."""
    return [Variant(name, "paper/fig20.toml", {"motion.rotation": name}) for name in ("locked", "free")]


def measure(results: Mapping[str, Results]) -> Table:
    """Hops of all starts; the path of the first, over a second after settling."""
    hops = {name: saltation(run, hops=30) for name, run in results.items()}
    paths: dict[str, Tracks] = {}
    for name, run in results.items():
        begin = float(hops[name].hops["t_begin"][0]) if len(hops[name].hops) else 0.0
        paths[name] = tracks(run, [0], begin, begin + 1.0)
    return Table(hops, paths)


def expect(table: Table) -> Sequence[Verdict]:
    """Free: higher and longer jumps, about half the shear on the bed."""
    locked, free = table.hops["locked"], table.hops["free"]
    return (
        _larger("fig20", "free jumps are higher", locked["jump_height"], free["jump_height"]),
        _larger("fig20", "free jumps are longer", locked["jump_length"], free["jump_length"]),
        _half("bed shear per time", locked["bed_shear"], free["bed_shear"]),
        _half("bed shear per bounce", locked["impulse_shear"], free["impulse_shear"]),
        _half("shear over normal impulse", locked["shear_ratio"], free["shear_ratio"]),
    )


def _larger(claim: str, says: str, locked: Average, free: Average) -> Verdict:
    gap = (free.value - locked.value) / (free.error**2 + locked.error**2) ** 0.5
    found = f"{_show(locked)} locked, {_show(free)} free: {gap:+.1f} standard errors"
    return Verdict(claim, says, found, None if abs(gap) < SURE else gap > 0.0)


def _half(what: str, locked: Average, free: Average) -> Verdict:
    share = free.value / locked.value
    error = share * ((free.error / free.value) ** 2 + (locked.error / locked.value) ** 2) ** 0.5
    says = "bed shear resistance falls to about half"
    return Verdict("fig20-shear", says, f"{what}: {share:.2f} ± {error:.2f} of locked", 0.35 < share < 0.65)


def _show(one: Average) -> str:
    return f"{one.value:.3g} ± {one.error:.1g} {one.unit}"


def draw(table: Table) -> Mapping[str, Figure]:
    """Paths of both, and how their jumps are distributed."""
    d = float(table.paths["locked"].d[0])
    paths = {f"rotation {name}": one for name, one in table.paths.items()}
    hops = {f"rotation {name}": one for name, one in table.hops.items()}
    return {"fig20": figures.tracks_side_by_side(paths, WAY), "fig20-hops": figures.hops(hops, d)}
