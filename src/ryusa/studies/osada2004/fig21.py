"""Fig. 21: spin of a saltating grain along its way; with the torque of the water too (open question iii)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures.saltation import SpinPath, spin_over_way
from ryusa.measure import saltation, spin
from ryusa.measure.spin import spin_against
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.studies.osada2004 import _saltation
from ryusa.studies.osada2004._parts import CaseRun, Found, Plan
from ryusa.studies.osada2004._saltation import PHI, SHIPPED, SLIP, SaltationRun
from ryusa.study import Band, Finding, Trial, over_seeds, pool

FIGURE = "fig21"
TITLE = "Spin of a saltating grain"
CLAIMS = ("fig21",)
QUOTED = 900.0  # [rad/s]
LEVEL = Band(0.75 * QUOTED, 1.25 * QUOTED, "rad/s", "about 900 rad/s: within a quarter, 675 to 1125 rad/s")
GROWS = Band(0.9, float("inf"), "-", "with every hit: at least nine hits in ten increase the spin")
EARLY = 3  # hits of each start that count as spinning up
WAY = 1.5  # shown [m]
STARTS = "start"  # the choice: how the grain begins, of which the paper says nothing
FLOWING, RESTING = "with the water", "at rest"
REST = {"build.start_speed": "0 m/s", "build.start_height": "0.1 cm"}
READING = "reading"
READINGS = {"while it spins up": "early", "at every hit for ever": "later"}
TORQUES = ("none", "Stokes", "Dennis")
JUMPS = {
    "jump height": "jump_height",
    "jump length": "jump_length",
    "shear over normal on the bed": "shear_ratio",
}


@dataclass(frozen=True)
class Spun:
    """Spin of one run.

    Attributes
    ----------
    hops : hops after settling.
    mean, largest : absolute spin after settling [rad/s].
    gains : what each hit added, by start, from its first touch on [rad/s].
    against : mean spin over rolling [-], the water's turn [rad/s], share beyond the range of Dennis [-].
    way : of the first start.
    """

    hops: SaltationRun
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


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of choices; the shipped one, and where shear is weak, started at rest too."""
    sets = _saltation.choices(plan)
    rest = plan.pick((), (SHIPPED,), (SHIPPED, {**SHIPPED, SLIP: "total", PHI: "10 deg"}))
    return [*({**one, STARTS: FLOWING} for one in sets), *({**one, STARTS: RESTING} for one in rest)]


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Rotation free: every set of choices, and the water's torque; locked to set bed shear against."""
    runs = [_run(one, seed) for one in settings(plan) for seed in plan.seeds]
    runs += [_torque(name, seed) for name in TORQUES for seed in plan.seeds]
    runs += [_locked(seed) for seed in plan.seeds]
    return list(dict.fromkeys(runs))


def _run(chosen: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run(chosen, "free", seed, REST if chosen[STARTS] == RESTING else None)


def _torque(name: str, seed: int) -> CaseRun:
    return _saltation.run(SHIPPED, "free", seed, {} if name == "none" else {"water.torque": name})


def _locked(seed: int) -> CaseRun:
    return _saltation.run(SHIPPED, "locked", seed)


def measure(run: Results, one: CaseRun) -> Spun:
    """Spin after settling, and what every hit did to it from the first on."""
    found, bounces = spin(run), saltation(run, settle=0.0).bounces
    gain = bounces["omega_after"] - bounces["omega_before"]
    return Spun(
        _saltation.hops(run),
        found.averages["spin_absolute"].value,
        found.largest,
        tuple(gain[bounces["grain"] == g] for g in np.unique(bounces["grain"])),
        {item.name: item.value for item in spin_against(run).items},
        SpinPath(one.get("water.torque", "none"), found.distance[:, 0], found.omega[:, 0]),
    )


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """How fast it spins, and whether every hit adds to that; what the water's torque takes away."""
    sets = settings(plan)
    levels = [[found[_run(one, seed)].mean for seed in plan.seeds] for one in sets]
    shares = {
        name: [[found[_run(one, seed)].share(which) for seed in plan.seeds] for one in sets]
        for name, which in READINGS.items()
    }
    trials: list[Trial] = []
    for reading, groups in shares.items():
        for k, chosen in enumerate(sets):
            key = {**chosen, READING: reading}
            trials += [
                Trial("mean spin", key, over_seeds(levels[k], "rad/s", pool(levels)), LEVEL),
                Trial(
                    "share of hits that increase the spin",
                    key,
                    over_seeds(groups[k], "-", pool(groups)),
                    GROWS,
                ),
            ]
    base = [found[_run(sets[0], seed)] for seed in plan.seeds]
    rolling = float(np.mean([one.against["rolling"] for one in base]))
    after = [float(np.mean([one.after(hit) for one in base])) for hit in (1, 2, 3)]
    return (
        Finding(
            "fig21",
            tuple(trials),
            "A hit accelerates the spin until the point of contact is at rest: spin times radius is "
            f"{rolling:.2f} of the speed along the bed, so the spin follows from that speed. Beyond it "
            "there is no gain: later hits increase and decrease the spin alike.",
            settings={"rotation": "free", "k_n": "100 N/cm"},
            also=(
                f"spin after 1, 2 and 3 hits, mean of all starts: {after[0]:.0f}, {after[1]:.0f}, "
                f"{after[2]:.0f} rad/s; "
                f"largest after settling {max(one.largest for one in base):.0f} rad/s",
                *(_after_rest(found, plan) if len(sets) > 1 else ()),
                *(_words(found, plan, name) for name in TORQUES[1:]),
            ),
        ),
    )


def _after_rest(found: Found, plan: Plan) -> tuple[str, ...]:
    runs = [found[_run({**SHIPPED, STARTS: RESTING}, seed)] for seed in plan.seeds]
    means = ", ".join(f"{np.mean([one.after(hit) for one in runs]):.0f}" for hit in range(1, 7))
    return (f"started at rest: {means} rad/s after the first six hits",)


def removed(found: Found, plan: Plan, name: str) -> list[float]:
    """Share of the excess spin that a torque removes, by seed.

    Excess is spin beyond half the vorticity of the water at the grain, the spin at which the water would
    leave it alone. Beyond rolling at its own speed, v/(d/2), a grain without torque has none to remove.
    """
    shares: list[float] = []
    for seed in plan.seeds:
        dry, wet = found[_torque("none", seed)], found[_torque(name, seed)]
        shares.append(1.0 - (wet.mean - wet.against["water_turn"]) / (dry.mean - dry.against["water_turn"]))
    return shares


def _words(found: Found, plan: Plan, name: str) -> str:
    dry, wet = ([found[_torque(one, seed)] for seed in plan.seeds] for one in ("none", name))
    locked = [found[_locked(seed)] for seed in plan.seeds]
    turn = float(np.mean([one.against["water_turn"] for one in wet]))
    ratios = {
        words: float(np.mean([a.hops.value(key) / b.hops.value(key) for a, b in zip(wet, dry, strict=True)]))
        for words, key in JUMPS.items()
    }
    shear = [a.hops.value("bed_shear") / b.hops.value("bed_shear") for a, b in zip(wet, locked, strict=True)]
    beyond = max(one.against["beyond_dennis"] for one in wet)
    flag = f"; outside the fitted range in {100 * beyond:.1f} % of the time" if name == "Dennis" else ""
    return (
        f"water torque, {name}: mean spin {np.mean([one.mean for one in wet]):.0f} rad/s "
        f"({np.mean([one.hops.value('spin_before') for one in wet]):.0f} on landing), "
        f"{np.mean([one.against['rolling'] for one in wet]):.2f} of rolling at its own speed; it removes "
        f"{100 * float(np.mean(removed(found, plan, name))):.0f} % of the spin in excess of half the water's "
        f"vorticity ({turn:.0f} rad/s); over no torque: "
        + ", ".join(f"{words} {value:.2f}" for words, value in ratios.items())
        + f"; bed shear over that of locked grains {np.mean(shear):.2f}{flag}"
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per set of choices or torque, and seed."""
    runs = [
        ({**one, "water torque": "none"}, _run(one, seed), seed)
        for one in settings(plan)
        for seed in plan.seeds
    ]
    base = settings(plan)[0]
    runs += [
        ({**base, "water torque": name}, _torque(name, seed), seed)
        for name in TORQUES[1:]
        for seed in plan.seeds
    ]
    lines: list[dict[str, object]] = []
    for chosen, one, seed in runs:
        spun: Spun = found[one]
        lines.append(
            {
                **chosen, "seed": seed, "spin_rad_per_s": spun.mean, "largest_rad_per_s": spun.largest,
                "spin_over_rolling": spun.against["rolling"],
                "half_vorticity_rad_per_s": spun.against["water_turn"],
                "beyond_dennis_share": spun.against["beyond_dennis"],
                "adds_first_hits": spun.share("early"), "adds_later_hits": spun.share("later"),
                "after_1_hit_rad_per_s": spun.after(1), "after_3_hits_rad_per_s": spun.after(3),
                "jump_height_m": spun.hops.value("jump_height"),
                "jump_length_m": spun.hops.value("jump_length"),
                "bed_shear_N": spun.hops.value("bed_shear"), "shear_ratio": spun.hops.value("shear_ratio"),
            }
        )  # fmt: skip
    return lines


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Spin against distance, without torque of the water and with it; started at rest too."""
    seed = plan.seeds[0]
    words = {
        "none": "no torque of the water",
        "Stokes": "torque, Stokes",
        "Dennis": "torque, Dennis et al. 1980",
    }
    ways = [_named(found[_torque(name, seed)].way, words[name]) for name in TORQUES]
    if len(settings(plan)) > 1:
        ways.append(_named(found[_run({**SHIPPED, STARTS: RESTING}, seed)].way, "no torque, started at rest"))
    return {"fig21": spin_over_way(ways, QUOTED, WAY)}


def _named(way: SpinPath, label: str) -> SpinPath:
    return SpinPath(label, way.distance, way.omega)
