"""Fig. 21: spin of a saltating grain along its way."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure

from ryusa.measure import saltation, spin
from ryusa.measure.spin import spin_against
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.study import Finding, Trial, over_seeds
from ryusa_studies.osada2004 import _saltation
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import START, CaseRun, Found, Plan
from ryusa_studies.osada2004._saltation import FLOWING, FREE, RESTING, SHIPPED
from ryusa_studies.osada2004._shares import within_0_1
from ryusa_studies.osada2004.figures.saltation import SpinPath, spin_over_way

FIGURE = "fig21"
TITLE = "Spin of a saltating grain"
CLAIMS = ("fig21",)
QUOTED = 900.0  # [rad/s]
EARLY = 3  # hits of each start that count as spinning up
WAY = 1.5  # shown [m]
HITS = 6  # whose spin is shown
READING = "reading"
READINGS = {"first three hits": "early", "later hits": "later"}
PART_SPIN = "mean spin"
PART_GROWS = "share of hits that increase the spin"


@dataclass(frozen=True)
class Spun:
    """Spin of one run.

    Attributes
    ----------
    mean, largest : absolute spin after settling [rad/s].
    gains : what each hit added, by start, from its first touch on [rad/s].
    against : mean spin over rolling [-], the water's turn [rad/s], share beyond the range of Dennis [-].
    way : of the first start.
    """

    mean: float
    largest: float
    gains: tuple[Floats, ...]
    against: Mapping[str, float]
    way: SpinPath

    def share(self, which: str) -> float:
        """Share of hits that add spin: "early" ones, or "later" ones."""
        cut = [one[:EARLY] if which == "early" else one[EARLY:] for one in self.gains]
        return float((np.concatenate(cut) > 0.0).mean())

    def after(self, hit: int) -> float:
        """Mean spin after so many hits [rad/s]."""
        return float(np.mean([one[:hit].sum() for one in self.gains]))


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Rotation free: every set of choices; as shipped but for the start, for the figure."""
    runs = [_run(one, seed) for one in _saltation.settings(plan) for seed in plan.seeds]
    runs += [_run({**SHIPPED, START: RESTING}, seed) for seed in plan.seeds]
    return list(dict.fromkeys(runs))


def _run(chosen: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run(chosen, FREE, seed)


def measure(run: Results, one: CaseRun) -> Spun:
    """Spin after settling, and what every hit did to it from the first on."""
    found, bounces = spin(run), saltation(run, settle=0.0).bounces
    gain = bounces["omega_after"] - bounces["omega_before"]
    return Spun(
        found.averages["spin_absolute"].value,
        found.largest,
        tuple(gain[bounces["grain"] == g] for g in np.unique(bounces["grain"])),
        {item.name: item.value for item in spin_against(run).items},
        SpinPath(one.get("water.torque", "none"), found.distance[:, 0], found.omega[:, 0]),
    )


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """How fast it spins, and whether every hit adds to that."""
    sets = _saltation.settings(plan)
    runs: list[list[Spun]] = [[found[_run(one, seed)] for seed in plan.seeds] for one in sets]
    trials: list[Trial] = []
    for reading, which in READINGS.items():
        read = [{**one, READING: reading} for one in sets]
        trials += _saltation.trials("fig21", PART_SPIN, read, [[one.mean for one in here] for here in runs])
        shares = [[one.share(which) for one in here] for here in runs]
        trials += [
            replace(one, found=within_0_1(one.found))
            for one in _saltation.trials("fig21", PART_GROWS, read, shares)
        ]
    base, rest = runs[0], [found[_run({**SHIPPED, START: RESTING}, seed)] for seed in plan.seeds]
    rolling = float(np.mean([one.against["rolling"] for one in base]))
    return (
        finding(
            "fig21",
            trials,
            also=(
                f"largest spin after settling {max(one.largest for one in base):.0f} rad/s",
                *(
                    f"as shipped, begun {words}: {after(here)} after the first {HITS} hits"
                    for words, here in ((FLOWING, base), (RESTING, rest))
                ),
            ),
            rolling=rolling,
        ),
    )


def after(runs: Sequence[Spun]) -> str:
    """Mean spin after each of the first hits, in words."""
    means = [over_seeds([one.after(hit) for one in runs], "rad/s") for hit in range(1, HITS + 1)]
    return ", ".join(str(one) for one in means)


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per set of choices and seed."""
    return [
        {**one, "seed": seed, **row(found[_run(one, seed)])}
        for one in _saltation.settings(plan)
        for seed in plan.seeds
    ]


def row(spun: Spun) -> dict[str, object]:
    """Numbers of one run."""
    return {
        "spin_rad_per_s": spun.mean, "largest_rad_per_s": spun.largest,
        "spin_over_rolling": spun.against["rolling"],
        "half_vorticity_rad_per_s": spun.against["water_turn"],
        "beyond_dennis_share": spun.against["beyond_dennis"],
        "adds_first_hits": spun.share("early"), "adds_later_hits": spun.share("later"),
        "after_1_hit_rad_per_s": spun.after(1), "after_3_hits_rad_per_s": spun.after(3),
    }  # fmt: skip


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Spin against distance, begun with the water and at rest."""
    ways = [
        replace(found[_run({**SHIPPED, START: start}, plan.seeds[0])].way, label=f"begun {start}")
        for start in (FLOWING, RESTING)
    ]
    return {"fig21": spin_over_way(ways, QUOTED, WAY)}
