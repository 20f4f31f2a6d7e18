"""Open question iii of the paper: how much spin of a saltating grain the torque of the water removes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from matplotlib.figure import Figure

from ryusa.results import Results
from ryusa.study import Finding, over_seeds
from ryusa_studies.osada2004 import _saltation, fig21
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan
from ryusa_studies.osada2004._saltation import (
    FREE,
    LOCKED,
    RE,
    SHIPPED,
    TORQUE,
    SaltationRun,
    mean,
)
from ryusa_studies.osada2004.fig20 import SHEAR, SHEARS
from ryusa_studies.osada2004.fig21 import QUOTED, WAY, Spun
from ryusa_studies.osada2004.figures.saltation import spin_over_way

FIGURE = "fig21"
TITLE = "Torque of the water on a saltating grain"
CLAIMS = ("water-torque", "water-torque-half", "water-torque-shear")
PART = "share of the excess spin removed"
PART_SHEAR = "bed shear, free in water that turns grains over locked"
EXCESS = "excess"  # what spin is too much
VORTICITY, ALL = "beyond half the vorticity", "all spin"
LAWS = {"Stokes": "torque, Stokes", "Dennis": "torque, Dennis et al. 1980"}


@dataclass(frozen=True)
class Turned:
    """Hops and spin of one run."""

    hops: SaltationRun
    spun: Spun

    def excess(self, way: str) -> float:
        """Mean spin that is too much [rad/s].

        Half the vorticity of the water at the grain is the spin at which the water would leave it alone.
        """
        return self.spun.mean - (self.spun.against["water_turn"] if way == VORTICITY else 0.0)


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of choices, each with a law of torque and a Reynolds number."""
    return _saltation.settings(plan, TORQUE, RE)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """For every set of choices: free with the torque, free without, and locked; both laws as shipped."""
    runs = [
        make(one, seed) for one in settings(plan) for seed in plan.seeds for make in (_wet, _dry, _locked)
    ]
    runs += [_wet(one, seed) for one in _laws().values() for seed in plan.seeds]
    return list(dict.fromkeys(runs))


def _laws() -> dict[str, dict[str, str]]:
    return {law: {**SHIPPED, TORQUE: law} for law in LAWS}


def _without(chosen: Mapping[str, str]) -> dict[str, str]:
    return {name: value for name, value in chosen.items() if name != TORQUE}


def _wet(chosen: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run(chosen, FREE, seed)


def _dry(chosen: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run(_without(chosen), FREE, seed)


def _locked(chosen: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run(_without(chosen), LOCKED, seed)


def measure(run: Results, one: CaseRun) -> Turned:
    """Hops and spin."""
    return Turned(_saltation.hops(run), fig21.measure(run, one))


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Share of the excess spin that is gone with the torque; what is left of the shear on the bed."""
    sets = settings(plan)
    removed = {way: [_removed(found, plan, one, way) for one in sets] for way in (VORTICITY, ALL)}
    shares = {
        claim: [
            trial
            for way, values in removed.items()
            for trial in _saltation.trials(claim, PART, [{**one, EXCESS: way} for one in sets], values)
        ]
        for claim in CLAIMS[:2]
    }
    shears = [
        trial
        for way, name in SHEARS.items()
        for trial in _saltation.trials(
            "water-torque-shear",
            PART_SHEAR,
            [{**one, SHEAR: way} for one in sets],
            [_shear(found, plan, one, name) for one in sets],
        )
    ]
    beyond = over_seeds(
        [found[_wet(sets[0], seed)].spun.against["beyond_dennis"] for seed in plan.seeds], "-"
    )
    return (
        finding(
            "water-torque",
            shares["water-torque"],
            also=(
                f"share of the time beyond the range of the torque of Dennis et al.: {beyond}",
                *(_spins(found, plan, law) for law in LAWS),
            ),
        ),
        finding(
            "water-torque-half",
            shares["water-torque-half"],
            also=[
                f"torque of {law}, as shipped, of the spin {way}: "
                f"{over_seeds(_removed(found, plan, one, way), '-')} removed"
                for law, one in _laws().items()
                for way in (VORTICITY, ALL)
            ],
        ),
        finding(
            "water-torque-shear",
            shears,
            also=[
                f"torque of {law}, as shipped: {way} {over_seeds(_shear(found, plan, one, name), '-')} of "
                "that of locked grains"
                for law, one in _laws().items()
                for way, name in SHEARS.items()
            ],
        ),
    )


def _removed(found: Found, plan: Plan, chosen: Mapping[str, str], way: str) -> list[float]:
    """Share of the excess spin that the torque removes, by seed."""
    return [
        1.0 - found[_wet(chosen, seed)].excess(way) / found[_dry(chosen, seed)].excess(way)
        for seed in plan.seeds
    ]


def _shear(found: Found, plan: Plan, chosen: Mapping[str, str], name: str) -> list[float]:
    return [
        found[_wet(chosen, seed)].hops.value(name) / found[_locked(chosen, seed)].hops.value(name)
        for seed in plan.seeds
    ]


def _spins(found: Found, plan: Plan, law: str) -> str:
    """What one law does to the case as it ships otherwise."""
    runs: list[Turned] = [found[_wet(_laws()[law], seed)] for seed in plan.seeds]
    landing = mean([one.hops for one in runs], "spin_before", "rad/s")
    high = mean([one.hops for one in runs], "jump_height", "m")
    return (
        f"torque of {law}, as shipped: mean spin {over_seeds([one.spun.mean for one in runs], 'rad/s')}, on "
        f"landing {landing}; mean jump height {high}"
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per set of choices, kind of run and seed."""
    return [
        {
            **one, "rotation": rotation, "water_torque": torque or one[TORQUE], "seed": seed,
            **fig21.row(run.spun), "jump_height_m": run.hops.value("jump_height"),
            "jump_length_m": run.hops.value("jump_length"), "bed_shear_N": run.hops.value("bed_shear"),
            "bed_friction_N": run.hops.value("bed_friction"), "shear_ratio": run.hops.value("shear_ratio"),
        }
        for one in settings(plan)
        for rotation, torque, make in ((FREE, "", _wet), (FREE, "none", _dry), (LOCKED, "none", _locked))
        for seed in plan.seeds
        if (run := found[make(one, seed)])
    ]  # fmt: skip


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Spin against distance, without torque of the water and with it."""
    seed = plan.seeds[0]
    ways = [replace(found[_dry(SHIPPED, seed)].spun.way, label="no torque of the water")]
    ways += [replace(found[_wet(one, seed)].spun.way, label=LAWS[law]) for law, one in _laws().items()]
    return {"water-torque": spin_over_way(ways, QUOTED, WAY)}
