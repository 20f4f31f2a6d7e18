"""The sentence after Fig. 12: with the same restitution, contact time does not change how a grain hops."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa.study import Finding, Trial, short
from ryusa_studies.osada2004 import _saltation
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan
from ryusa_studies.osada2004._saltation import (
    K_N,
    LOCKED,
    SHARED,
    SHIPPED,
    SOFT,
    STIFF,
    Group,
    SaltationRun,
    mean,
)
from ryusa_studies.osada2004.figures.saltation import StiffnessSeries, over_stiffness_in_cm

FIGURE = "hops"
TITLE = "Jumps with the same restitution and other contact times"
CLAIMS = ("hops", "hops-impulse")
AGAINST = "other k_n"  # the choice; a name of its own, for it is a pair of stiffnesses
PARTS = {
    f"mean jump height over that at {STIFF}": "jump_height",
    f"largest jump height over that at {STIFF}": "highest",
    f"mean jump length over that at {STIFF}": "jump_length",
}
IMPULSE = "impulse"  # how that of a collision is read
PART_IMPULSE = f"impulse of a collision over that at {STIFF}"
IMPULSES = {"over mass and closing speed": "impact", "of a bounce, normal to the bed": "impulse_normal"}
AXES = {
    "jump_height": "mean height  (cm)",
    "highest": "largest height  (cm)",
    "jump_length": "mean length  (cm)",
}


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of choices, each with the stiffness set against 100 N/cm; where that is 100 N/cm too, 1 N/cm."""
    return [
        {**{name: one[name] for name in SHARED}, AGAINST: SOFT if one[K_N] == STIFF else one[K_N]}
        for one in _saltation.settings(plan, K_N)
    ]


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Both stiffnesses of every set of choices, and the series over stiffness."""
    sets = settings(plan)
    runs = [make(one, seed) for one in sets for seed in plan.seeds for make in (_other, _stiff)]
    runs += [_series(keys, seed) for keys in _saltation.series(plan).values() for seed in plan.seeds]
    return list(dict.fromkeys(runs))


def _other(chosen: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run({**chosen, K_N: chosen[AGAINST]}, LOCKED, seed)


def _stiff(chosen: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run({**chosen, K_N: STIFF}, LOCKED, seed)


def _series(keys: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run(SHIPPED, LOCKED, seed, keys)


measure = _saltation.measure


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Heights, lengths and impulses at another stiffness over those at the shipped one."""
    sets = settings(plan)
    pairs: list[tuple[Group, Group]] = [
        ([found[_other(one, seed)] for seed in plan.seeds], [found[_stiff(one, seed)] for seed in plan.seeds])
        for one in sets
    ]
    skims = [_saltation.skimming(other) for other, _ in pairs]

    def trials(claim: str, part: str, name: str, shown: Sequence[dict[str, str]]) -> list[Trial]:
        values = [_saltation.ratios(*pair, name) for pair in pairs]
        return _saltation.trials(claim, part, shown, values, skims)

    jumps = [one for part, name in PARTS.items() for one in trials("hops", part, name, sets)]
    impulses = [
        one
        for way, name in IMPULSES.items()
        for one in trials("hops-impulse", PART_IMPULSE, name, [{**chosen, IMPULSE: way} for chosen in sets])
    ]
    soft, base = pairs[0]
    sweep = _sweep(found, plan)
    return (
        finding(
            "hops",
            jumps,
            also=(
                f"as shipped, u t/d: {_saltation.listed({k: _travel(here) for k, here in sweep.items()})}",
                *(
                    f"as shipped, {words}: "
                    + _saltation.listed({k: mean(here, name, "m") for k, here in sweep.items()})
                    for words, name in (("mean jump height", "jump_height"), ("mean length", "jump_length"))
                ),
            ),
            soft=_travel(soft),
            base=_travel(base),
        ),
        finding(
            "hops-impulse",
            impulses,
            also=(
                "as shipped, impulse over mass and closing speed: "
                + _saltation.listed({k: mean(here, "impact", "-") for k, here in sweep.items()}),
            ),
        ),
    )


def _travel(runs: Group) -> str:
    return short(float(np.mean([one.travel for one in runs])))


def _sweep(found: Found, plan: Plan) -> dict[str, list[SaltationRun]]:
    """All seeds at every stiffness of the series, soft to stiff."""
    return {
        k: [found[_series(keys, seed)] for seed in plan.seeds] for k, keys in _saltation.series(plan).items()
    }


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per set of choices, stiffness and seed."""
    return [
        {
            **{name: one[name] for name in SHARED}, K_N: k, "seed": seed, "n_hops": len(run.found.hops),
            "travel": run.travel, "contact_time_s": run.value("contact_time"),
            "largest_height_m": run.highest, "mean_height_m": run.value("jump_height"),
            "mean_length_m": run.value("jump_length"), "impulse_over_mass_and_speed": run.impact,
            "impulse_of_a_bounce_N_s": run.value("impulse_normal"),
        }
        for one in settings(plan)
        for k, make in ((one[AGAINST], _other), (STIFF, _stiff))
        for seed in plan.seeds
        if (run := found[make(one, seed)])
    ]  # fmt: skip


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Heights and lengths against stiffness, with the band that counts as no change."""
    sweep = _sweep(found, plan)
    k = np.array([_saltation.stiffness(one) for one in sweep])
    same = band("hops", next(iter(PARTS)))
    panels: dict[str, list[StiffnessSeries]] = {}
    levels: list[tuple[float, float]] = []
    for name, words in AXES.items():
        means = [mean(here, name, "m") for here in sweep.values()]
        half = np.array([0.5 * (one.high - one.low) for one in means])
        values = np.array([one.value for one in means])
        panels[words] = [StiffnessSeries("rotation locked", k, 1e2 * values, 1e2 * half)]
        base = 1e2 * mean(sweep[STIFF], name, "m").value
        levels.append((same.low * base, same.high * base))
    return {"hops": over_stiffness_in_cm(panels, levels=levels, skim=_saltation.skims_below(sweep))}
