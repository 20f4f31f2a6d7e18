"""Sizes of the grains that were laid, by mass, beside the sieve curve that was asked for."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import CaseError, ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.model import Scene
from ryusa.model.arrays import Bools
from ryusa.model.grading import SHARES, Grading, GradingFault, laid
from ryusa.printed import ByShape
from ryusa.spelling import nearest_word

OWN_SIZES = ("diameter", "spread", "sieve_curve")  # keys of a material of the case
HALF_PHI = math.sqrt(2.0)  # ratio of the sieves where the case asks for no curve


@dataclass(frozen=True, repr=False)
class Sizes(ByShape):
    """Sizes by mass of the free grains at the start of a run.

    Attributes
    ----------
    d, m : diameters [m], ascending, and masses [kg], shape (n_grain,).
    asked : the curve that was asked for, cut as the case cuts it; None where it asks for none.
    sieves : limits of the classes [m], ascending, shape (n_class + 1,): those of the curve, else every half
        phi.
    grains : number of grains of each class, shape (n_class,).
    mass : their mass [kg], shape (n_class,).
    difference : largest difference between the share finer that was laid and the one asked for [-]; nan
        without a curve.
    """

    d: Floats
    m: Floats
    asked: Grading | None
    sieves: Floats
    grains: NDArray[np.int64]
    mass: Floats
    difference: float

    @property
    def laid(self) -> Grading:
        """Curve that was laid; a grain counts half below its own diameter."""
        return laid(self.d, self.m)

    def pairs(self) -> list[tuple[str, str, float, float]]:
        """Name, unit, value laid and value asked for, nan where nothing was asked."""
        found: list[tuple[str, str, float, float]] = []
        curves = (self.laid, self.asked)
        for share in SHARES:
            there, asked = (math.nan if one is None else one.diameter(share) for one in curves)
            found.append((f"D{round(100 * share)}", "m", there, asked))
        for name, value in (("sorting", _geometric), ("sorting_phi", _folk_and_ward)):
            there, asked = (math.nan if one is None else value(one) for one in curves)
            found.append((name, "phi" if name == "sorting_phi" else "-", there, asked))
        mean, whole = float(self.d.mean()), float(self.m.sum())
        by_number = math.nan if self.asked is None else self.asked.mean_diameter
        return [
            *found,
            ("mean_by_number", "m", mean, by_number),
            ("smallest", "m", float(self.d[0]), math.nan if self.asked is None else float(self.asked.d[0])),
            ("largest", "m", float(self.d[-1]), math.nan if self.asked is None else float(self.asked.d[-1])),
            ("grains", "-", float(len(self.d)), math.nan),
            ("mass", "kg", whole, math.nan),
            ("largest_grain_share", "-", float(self.m[-1]) / whole, math.nan),
            ("largest_difference", "-", self.difference, math.nan),
        ]

    def quantities(self) -> list[tuple[str, float, str]]:
        """Name, value and unit: what was laid, and beside it what was asked for."""
        found: list[tuple[str, float, str]] = []
        for name, unit, there, asked in self.pairs():
            found.append((name, there, unit))
            if not math.isnan(asked):
                found.append((f"{name}, asked for", asked, unit))
        return found

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per quantity."""
        return [
            {"quantity": name, "unit": unit, "laid": there, "asked": asked}
            for name, unit, there, asked in self.pairs()
        ]

    def series(self) -> list[dict[str, object]]:
        """One dictionary per class between two sieves, finest first."""
        mass = float(self.m.sum())
        share = self.mass / mass
        finer = np.cumsum(share)
        asked = None if self.asked is None else [self.asked.share_below(one) for one in self.sieves.tolist()]
        return [
            {
                "d_low_m": float(self.sieves[k]),
                "d_high_m": float(self.sieves[k + 1]),
                "grains": int(self.grains[k]),
                "mass_kg": float(self.mass[k]),
                "share_laid": float(share[k]),
                "share_asked": math.nan if asked is None else asked[k + 1] - asked[k],
                "finer_laid": float(finer[k]),
                "finer_asked": math.nan if asked is None else asked[k + 1],
            }
            for k in range(len(share))
        ]


def sizes(run: Run, material: str | None = None) -> Sizes:
    """Sizes by mass of the free grains, beside the sieve curve of the case.

    Parameters
    ----------
    material : only the grains of this material, beside its own curve; all when not given, which have no one
        curve where a material has sizes of its own.

    Raises
    ------
    ResultsError : the run holds no grain, or case.json a curve that cannot be.
    CaseError : there is no such material.

    Notes
    -----
    D10 is the diameter below which a tenth of the mass lies; a grain counts half below its own diameter, and
    between two grains the curve is straight over log d. `sorting` is sqrt(D84/D16); `sorting_phi` the
    inclusive graphic standard deviation (phi84 - phi16)/4 + (phi95 - phi5)/6.6 of Folk & Ward 1957, of
    percentiles counted from the coarse end.
    """
    scene = run.scene
    chosen = scene.heads if material is None else scene.heads & _of_material(scene, material)
    d, m = (one[chosen] for one in scene.of_heads())
    order = np.argsort(d, kind="stable")
    d, m = np.asarray(d[order]), np.asarray(m[order])
    if not len(d):
        raise ResultsError("the run holds no free grain" + (f" of {material}" if material else ""))
    asked = _asked(run.case, material)
    sieves = asked.d if asked is not None else _half_phi(float(d[0]), float(d[-1]))
    which = np.searchsorted(sieves[1:-1], d, side="right")
    n = len(sieves) - 1
    return Sizes(
        d=d,
        m=m,
        asked=asked,
        sieves=sieves,
        grains=np.bincount(which, minlength=n),
        mass=np.asarray(np.bincount(which, weights=m, minlength=n), dtype=np.float64),
        difference=math.nan if asked is None else _difference(d, m, asked),
    )


def _of_material(scene: Scene, material: str) -> Bools:
    """Which free spheres are of a material, shape (n_grain,)."""
    names = ("grains",) if scene.materials is None else scene.materials.names
    if material not in names:
        allowed = f"must be a material of the run: {', '.join(names)}"
        raise CaseError("material", material, allowed, nearest_word(material, names))
    if scene.materials is None:
        return np.ones(scene.n_grain, np.bool_)
    return np.asarray(scene.materials.of[: scene.n_grain] == names.index(material))


def _asked(case: Any, material: str | None) -> Grading | None:
    """Curve of the case as case.json holds it: pairs of diameter [m] and percent finer."""
    grains = case.get("grains") or {} if isinstance(case, dict) else {}
    made = case.get("materials") or {} if isinstance(case, dict) else {}
    own = {name for name, one in made.items() if any(one.get(key) is not None for key in OWN_SIZES)}
    if material in own:
        grains = {"sieve_curve": made[material].get("sieve_curve")}
    elif material is None and own:
        return None
    points = grains.get("sieve_curve") if isinstance(grains, dict) else None
    if points is None:
        return None
    try:
        whole = Grading.of([(float(d), float(percent) / 100.0) for d, percent in points])
        return whole.cut(float(grains.get("finest") or 0.0), float(grains.get("coarsest") or math.inf))
    except (GradingFault, TypeError, ValueError) as error:
        key = "grains" if material not in own else f"materials.{material}"
        raise ResultsError(f"case.json: {key}.sieve_curve cannot be read: {error}") from None


def _half_phi(low: float, high: float) -> Floats:
    """Sieves of 2^(k/2) mm around all sizes [m]."""
    first = math.floor(math.log(1.0e3 * low, HALF_PHI) + 1.0e-9)
    last = max(math.ceil(math.log(1.0e3 * high, HALF_PHI) - 1.0e-9), first + 1)
    return np.array([1.0e-3 * HALF_PHI**k for k in range(first, last + 1)])


def _difference(d: Floats, m: Floats, asked: Grading) -> float:
    """Largest difference between the steps of the curve laid and the curve asked for [-]."""
    after = np.cumsum(m) / m.sum()
    before = after - m / m.sum()
    there = np.interp(np.log(d), np.log(asked.d), asked.finer)
    return float(max(np.abs(after - there).max(), np.abs(there - before).max()))


def _geometric(curve: Grading) -> float:
    return curve.sorting


def _folk_and_ward(curve: Grading) -> float:
    phi = {percent: -math.log2(1.0e3 * curve.diameter(1.0 - percent / 100.0)) for percent in (5, 16, 84, 95)}
    return (phi[84] - phi[16]) / 4.0 + (phi[95] - phi[5]) / 6.6
