"""Fig. 7: mean contact time at the bed of a saltating grain against stiffness, with Eq. (8)."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from scipy import stats

from ryusa.experiments._experiment import Variant, Verdict
from ryusa.figures import Curve, Points, over_stiffness, turning
from ryusa.measure import Saltation, collisions, saltation, turned_time
from ryusa.measure.stability import BAND
from ryusa.measure.statistics import Floats
from ryusa.results import Results

FIGURE = "fig7"
TITLE = "Contact time of a saltating grain"
SHOWN: tuple[str, ...] = (
    "rotation", "k_n_N_per_m", "contact_time_s", "contact_time_error_s", "eq8_s", "eq8_damped_s",
    "jump_height_m", "jump_height_error", "jump_length_m", "jump_length_error",
    "highest_jump_m", "overlap_over_d", "travel",
)  # fmt: skip
SWEEP = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0)  # [N/cm]
SKIM = 0.3  # speed times contact time over diameter from which a grain skims the crests
LIKELY, UNLIKELY = 0.05, 0.001  # chances from which means are called the same, and different
LIKE = 0.1  # spread of largest jumps, over their mean, up to which they are called the same
REPORTED = ("jump_height", "jump_length", "speed", "contact_time_alone", "shear_ratio", "contacts_per_bounce")


@dataclass(frozen=True)
class Point:
    """One stiffness, one state of rotation."""

    rotation: str
    k_n: float  # [N/m]
    d: float  # [m]
    found: Saltation
    overlap: float  # largest over diameter, mean of the bounces [-]
    highest: float  # highest jump [m]
    turning: Floats  # u**2 t/(d v) of every lone bed contact [-]
    shortened: Floats  # its contact time over damped Eq. (8) [-]

    @property
    def travel(self) -> float:
        """Speed times contact time over diameter [-]."""
        return self.found["speed"].value * self.found.times.damped / self.d

    def row(self) -> dict[str, object]:
        """One line of the table."""
        row: dict[str, object] = {
            "rotation": self.rotation,
            "k_n_N_per_m": self.k_n,
            "n": len(self.found.hops),
        }
        row |= {"eq8_s": self.found.times.eq_8, "eq8_added_s": self.found.times.added}
        row |= {"eq8_damped_s": self.found.times.damped}
        time = self.found["contact_time"]
        row |= {"contact_time_s": time.value, "contact_time_error_s": time.error, "travel": self.travel}
        for name in REPORTED:
            one = self.found[name]
            row |= {f"{name}_{one.unit}": one.value, f"{name}_error": one.error}
        return row | {"highest_jump_m": self.highest, "overlap_over_d": self.overlap}


@dataclass(frozen=True)
class Table:
    """All stiffnesses, rotation locked first."""

    points: tuple[Point, ...]

    def rows(self) -> list[dict[str, object]]:
        """One line per run."""
        return [one.row() for one in self.points]

    def of(self, rotation: str) -> list[Point]:
        """Points of one state of rotation, soft to stiff."""
        return [one for one in self.points if one.rotation == rotation]


def cases() -> Sequence[Variant]:
    """The sweep with rotation locked as in the paper, and with rotation free."""
    return [
        Variant(f"{rotation}-{k:g}", "paper/fig07.toml", _overrides(k, rotation))
        for rotation in ("locked", "free")
        for k in SWEEP
    ]


def _overrides(k: float, rotation: str) -> dict[str, str]:
    return {"contact.stiffness": f"{k:g} N/cm", "motion.rotation": rotation}


def measure(results: Mapping[str, Results]) -> Table:
    """Hops of every run."""
    points: list[Point] = []
    for name, run in results.items():
        found = saltation(run, hops=30)
        d = float(run.scene.d[0])
        overlap = float(found.bounces["overlap"].mean()) / d if len(found.bounces) else math.nan
        highest = float(found.hops["rise"].max()) if len(found.hops) else math.nan
        touch = collisions(run, "bed")
        lone = np.isfinite(touch.restitution)
        shortened = (touch.duration / touch.expected)[lone]
        rotation, k_n = name.split("-")[0], run.scene.contact.k_n
        points.append(Point(rotation, k_n, d, found, overlap, highest, touch.turning[lone], shortened))
    return Table(tuple(points))


def expect(table: Table) -> Sequence[Verdict]:
    """Contact time as Eq. (8); rotation does not change it; jumps do not depend on it."""
    locked, free = table.of("locked"), table.of("free")
    stiff = [one for one in locked if one.travel < SKIM]
    off = [one.found["contact_time"].value / one.found.times.eq_8 - 1.0 for one in stiff]
    lone = [one.found["contact_time_alone"].value / one.found.times.damped - 1.0 for one in stiff]
    turned = [
        (a.overlap < BAND[1], b.found["contact_time"].value / a.found["contact_time"].value - 1.0)
        for a, b in zip(locked, free, strict=True)
        if a.travel < SKIM
    ]
    return (
        Verdict(
            "fig7",
            "mean contact time agrees with Eq. (8)",
            f"{_range(off)} off Eq. (8) where u t/d < {SKIM:g}; lone ones {_range(lone)} off its damped form",
            bool(off) and max(map(abs, off)) < 0.1,
        ),
        _turned("stiff enough for overlap/d < 0.01", [change for stable, change in turned if stable]),
        _turned(f"softer, u t/d < {SKIM:g}", [change for stable, change in turned if not stable]),
        *_same("stiff enough for overlap/d < 0.01", [one for one in stiff if one.overlap < BAND[1]]),
        *_same(f"softer too, u t/d < {SKIM:g}", stiff),
    )


def _turned(where: str, changes: Sequence[float]) -> Verdict:
    says = f"rotation does not change the contact time ({where})"
    found = f"free over locked {_range(changes)}"
    return Verdict("spin-time", says, found, max(map(abs, changes)) < 0.05 if changes else None)


def _same(where: str, points: Sequence[Point]) -> list[Verdict]:
    """Whether mean height and length are the same at all stiffnesses, by chi-squared over their errors."""
    verdicts: list[Verdict] = []
    for name, words in (("jump_height", "mean jump height"), ("jump_length", "mean jump length")):
        values = np.array([one.found[name].value for one in points])
        errors = np.array([one.found[name].error for one in points])
        weights = 1.0 / errors**2
        mean = float((weights * values).sum() / weights.sum())
        chi = float((((values - mean) / errors) ** 2).sum())
        p = float(stats.chi2.sf(chi, max(len(values) - 1, 1)))
        found = f"spreads by {_spread(values)} of its mean over stiffness; by chance with p = {p:.2g}"
        holds = True if p > LIKELY else False if p < UNLIKELY else None
        verdicts.append(Verdict("hops", f"{words} is the same ({where})", found, holds))
    highest = np.array([one.highest for one in points])
    found = f"largest jumps spread by {_spread(highest)} of their mean over stiffness"
    holds = bool(np.ptp(highest) < LIKE * highest.mean()) if len(highest) else None
    return [*verdicts, Verdict("hops", f"largest jump height is the same ({where})", found, holds)]


def _spread(values: Floats) -> str:
    return f"{100 * float(np.ptp(values) / values.mean()):.0f} %" if len(values) else "nothing"


def _range(values: Sequence[float]) -> str:
    return f"{100 * min(values):+.1f} to {100 * max(values):+.1f} %" if values else "nothing"


def draw(table: Table) -> Mapping[str, Figure]:
    """Contact time over stiffness: Eq. (8), its damped form in water, and the runs."""
    locked = table.of("locked")
    k = np.array([one.k_n for one in locked])
    curves = [
        Curve("Eq. (8)", k, np.array([one.found.times.eq_8 for one in locked])),
        Curve("Eq. (8), added mass and dashpot", k, np.array([one.found.times.damped for one in locked])),
    ]
    runs = [
        _points(f"rotation {rotation}", table.of(rotation), "contact_time") for rotation in ("locked", "free")
    ]
    theory = np.logspace(-3.0, 1.0, 81)
    dots = {f"rotation {rotation}": _dots(table.of(rotation)) for rotation in ("locked", "free")}
    return {
        "fig07": over_stiffness("time", curves, runs),
        "fig07-turning": turning(dots, (theory, turned_time(theory))),
    }


def _dots(points: Sequence[Point]) -> tuple[Floats, Floats]:
    """Contacts of all runs whose grain does not skim the crests."""
    kept = [one for one in points if one.travel < SKIM]
    return np.concatenate([one.turning for one in kept]), np.concatenate([one.shortened for one in kept])


def _points(label: str, points: Sequence[Point], name: str) -> Points:
    return Points(
        label,
        np.array([one.k_n for one in points]),
        np.array([one.found[name].value for one in points]),
        np.array([one.found[name].error for one in points]),
    )
