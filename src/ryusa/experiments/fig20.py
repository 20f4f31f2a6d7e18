"""Fig. 20: saltation with rotation locked and free, k_n = 100 N/cm; jumps and the shear on the bed."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.experiments import _saltation
from ryusa.experiments._experiment import Found, Plan, Variant
from ryusa.experiments._verdict import Band, Finding, Trial, over_seeds, pool
from ryusa.results import Results

FIGURE = "fig20"
TITLE = "Saltation with and without rotation"
CLAIMS = ("fig20", "fig20-shear")
WAY = 0.3  # shown of each path [m]
LARGER = Band(1.0, float("inf"), "-", "free over locked above 1")
HALF = Band(0.35, 0.65, "-", "about half: free over locked 0.35 to 0.65")
# part of the claim -> average
JUMPS = {
    "mean jump height, free over locked": "jump_height",
    "mean jump length, free over locked": "jump_length",
}
IMPULSE = "impulse"  # the choice that fig20-shear leaves open
SHEARS = {"per time": "bed_shear", "per bounce": "impulse_shear", "over the normal impulse": "shear_ratio"}


def cases(plan: Plan) -> Sequence[Variant]:
    """Locked and free for every set of choices and seed."""
    return [
        _saltation.run(chosen, rotation, seed)
        for chosen in _saltation.choices(plan)
        for rotation in ("locked", "free")
        for seed in plan.seeds
    ]


def measure(run: Results, one: Variant) -> _saltation.Hops:
    """Hops of all starts."""
    del one
    return _saltation.hops(run)


def ratios(found: Found, plan: Plan, name: str) -> list[list[float]]:
    """Free over locked of one average, by set of choices, then seed."""
    values: list[list[float]] = []
    for chosen in _saltation.choices(plan):
        runs = [
            [found[_saltation.run(chosen, rot, seed)] for rot in ("free", "locked")] for seed in plan.seeds
        ]
        values.append([free.found[name].value / locked.found[name].value for free, locked in runs])
    return values


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Free: higher and longer jumps, about half the shear on the bed."""
    sets = _saltation.choices(plan)
    jumps: list[Trial] = []
    for part, name in JUMPS.items():
        groups = ratios(found, plan, name)
        spread = pool(groups)
        jumps += [
            Trial(part, chosen, over_seeds(values, "-", spread), LARGER)
            for chosen, values in zip(sets, groups, strict=True)
        ]
    shears: list[Trial] = []
    for impulse, name in SHEARS.items():
        groups = ratios(found, plan, name)
        spread = pool(groups)
        shears += [
            Trial(
                "bed shear, free over locked",
                {**chosen, IMPULSE: impulse},
                over_seeds(values, "-", spread),
                HALF,
            )
            for chosen, values in zip(sets, groups, strict=True)
        ]
    return (
        Finding(
            "fig20",
            tuple(jumps),
            "A locked grain rubs at every hit and leaves slowly; a free one that has spun up rolls off, keeps "
            "its speed and meets the next crest harder. Friction angle, slip rule and k_s/k_n act on the locked "
            "grain alone.",
        ),
        Finding(
            "fig20-shear",
            tuple(shears),
            "The normal force on the bed is the same, so the shear force of the locked grain decides: as "
            "printed (cap on the spring, dashpot kept) it is too strong; a weaker one, by a small friction angle or "
            "a cap on spring and dashpot together, brings free and locked closer.",
        ),
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per average, run and set of choices."""
    return [
        {**chosen, "rotation": rotation, "seed": seed, **row}
        for chosen in _saltation.choices(plan)
        for rotation in ("locked", "free")
        for seed in plan.seeds
        for row in found[_saltation.run(chosen, rotation, seed)].found.rows()
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Paths of both, and how their jumps are distributed."""
    base = {
        f"rotation {rot}": found[_saltation.run(_saltation.SHIPPED, rot, plan.seeds[0])]
        for rot in ("locked", "free")
    }
    paths = {name: one.path for name, one in base.items()}
    d = next(iter(base.values())).d
    return {
        "fig20": figures.tracks_side_by_side(paths, WAY),
        "fig20-hops": figures.hops({name: one.found for name, one in base.items()}, d),
    }
