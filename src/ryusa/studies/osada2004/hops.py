"""The sentence after Fig. 12: with the same restitution, contact time does not change how a grain hops."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures.saltation import StiffnessSeries, over_stiffness_in_cm
from ryusa.results import Results
from ryusa.studies.osada2004 import _saltation
from ryusa.studies.osada2004._parts import CaseRun, Found, Plan
from ryusa.studies.osada2004._saltation import K_N, SHIPPED, SKIM, STIFF, STIFFNESSES, WIDE, SaltationRun
from ryusa.study import Band, Finding, Interval, Trial, over_seeds

FIGURE = "hops"
TITLE = "Jumps with the same restitution and other contact times"
CLAIMS = ("hops",)
AGAINST = "other k_n"  # the choice; a name of its own, for it is a pair of stiffnesses
SAME = Band(
    0.9,
    1.1,
    "-",
    f"do not change: 0.9 to 1.1 of the value at {STIFF}; the uncertainty of 30 hops from "
    "one initial state is 10 %",
)
PARTS = {
    f"mean jump height over that at {STIFF}": "jump_height",
    f"largest jump height over that at {STIFF}": "highest",
    f"mean jump length over that at {STIFF}": "jump_length",
}
AXES = {
    "jump_height": "mean height  (cm)",
    "highest": "largest height  (cm)",
    "jump_length": "mean length  (cm)",
}
FIRST = "1 N/cm"  # the paper's own second stiffness, that of fig6


def stiffnesses(plan: Plan) -> tuple[str, ...]:
    """Stiffnesses set against the shipped one, the quick one first."""
    return plan.pick((FIRST,), (FIRST, *(k for k in STIFFNESSES if k not in (FIRST, STIFF))))


def rotations(plan: Plan) -> tuple[str, ...]:
    """Locked as in the paper; full: free too."""
    return plan.pick(("locked",), ("locked",), ("locked", "free"))


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Every stiffness with many starts."""
    return [
        _run(k, seed, rotation)
        for rotation in rotations(plan)
        for k in every(plan, rotation)
        for seed in plan.seeds
    ]


def every(plan: Plan, rotation: str = "locked") -> list[str]:
    """Stiffnesses run, soft to stiff; free grains skim the softest bed for whole seconds."""
    sets = [{K_N: k} for k in (STIFF, *stiffnesses(plan))]
    return [k for k in _saltation.softest(sets) if rotation == "locked" or k != STIFFNESSES[0]]


def _run(k: str, seed: int, rotation: str = "locked") -> CaseRun:
    return _saltation.run({**SHIPPED, K_N: k}, rotation, seed, WIDE)


def measure(run: Results, one: CaseRun) -> SaltationRun:
    """Hops of all starts."""
    del one
    return _saltation.hops(run)


def _ratios(found: Found, plan: Plan, k: str, name: str, rotation: str = "locked") -> list[float]:
    return [
        found[_run(k, seed, rotation)].value(name) / found[_run(STIFF, seed, rotation)].value(name)
        for seed in plan.seeds
    ]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Mean and largest height and mean length at each stiffness over those at the shipped one."""
    trials: list[Trial] = []
    skims = [found[_run(k, plan.seeds[0])].travel > SKIM for k in stiffnesses(plan)]
    for part, name in PARTS.items():
        groups = [_ratios(found, plan, k, name) for k in stiffnesses(plan)]
        spreads = _saltation.pooled(groups, skims)
        trials += [
            Trial(part, {AGAINST: k}, over_seeds(values, "-", spread), SAME)
            for k, values, spread in zip(stiffnesses(plan), groups, spreads, strict=True)
        ]
    first = {k: found[_run(k, plan.seeds[0])] for k in every(plan)}
    softest = next(iter(first))
    soft, base = first[softest], first[STIFF]
    return (
        Finding(
            "hops",
            tuple(trials),
            "A stiff contact ends before the grain has moved along the bed, so only e and the law of "
            f"shear matter. During a soft contact it travels {soft.travel:.2g} d within a contact (u t/d "
            f"at {softest}; {base.travel:.2g} at {STIFF}), so it is deflected over the crest instead of "
            "thrown back, and its mean jump height decreases.",
            settings={"rotation": "locked", "starts": f"{WIDE['build.starts']} of 30 hops a seed"},
            also=(
                f"u t/d: {_saltation.listed({k: one.travel for k, one in first.items()}, '.2g')}",
                *(
                    f"rotation free, {part}: "
                    + _saltation.listed(
                        {
                            k: float(np.mean(_ratios(found, plan, k, name, "free")))
                            for k in every(plan, "free")
                        }
                    )
                    for part, name in PARTS.items()
                    if "free" in rotations(plan)
                ),
            ),
        ),
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per stiffness, state of rotation and seed."""
    return [
        {
            K_N: k, "rotation": rotation, "seed": seed, "n_hops": len(run.found.hops), "travel": run.travel,
            "contact_time_s": run.value("contact_time"), "largest_height_m": run.highest,
            "mean_height_m": run.value("jump_height"), "mean_height_error_m": run.found["jump_height"].error,
            "mean_length_m": run.value("jump_length"), "mean_length_error_m": run.found["jump_length"].error,
        }
        for rotation in rotations(plan)
        for k in every(plan, rotation)
        for seed in plan.seeds
        if (run := found[_run(k, seed, rotation)])
    ]  # fmt: skip


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Heights and lengths against stiffness, with the band that counts as no change."""
    panels: dict[str, list[StiffnessSeries]] = {}
    for name, words in AXES.items():
        for rotation in rotations(plan):
            k = np.array([_saltation.stiffness(one) for one in every(plan, rotation)])
            means = [_mean(found, plan, one, name, rotation) for one in every(plan, rotation)]
            half = np.array([0.5 * (one.high - one.low) for one in means])
            values = np.array([one.value for one in means])
            panels.setdefault(words, []).append(
                StiffnessSeries(f"rotation {rotation}", k, 1e2 * values, 1e2 * half)
            )
    base = [1e2 * _mean(found, plan, STIFF, name).value for name in AXES]
    levels = [(SAME.low * one, SAME.high * one) for one in base]
    runs = {one: found[_run(one, plan.seeds[0])] for one in every(plan)}
    skim = min((_saltation.stiffness(one) for one, run in runs.items() if run.travel < SKIM), default=0.0)
    return {"hops": over_stiffness_in_cm(panels, levels=levels, skim=skim)}


def _mean(found: Found, plan: Plan, k: str, name: str, rotation: str = "locked") -> Interval:
    return over_seeds([found[_run(k, seed, rotation)].value(name) for seed in plan.seeds], "m")
