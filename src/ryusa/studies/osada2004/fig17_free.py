"""The sentences after fig. 17: without a deposit locking does no harm, free grains run away."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.studies.osada2004 import _debris
from ryusa.studies.osada2004._debris import AMOUNT, FREE, LOCKED, SETTLED, SHIPPED, START, Debris, each
from ryusa.studies.osada2004._parts import PHI, SLIP, CaseRun, Found, Plan
from ryusa.study import Band, Finding, Trial, over_seeds, pool, short

FIGURE = "fig17"
TITLE = "Ito's debris flow with rotation locked and free"
CLAIMS = ("fig17-lock", "fig17-free")
NOTHING = float("-inf")  # the interval about a share of nothing reaches below it
APART = Band(NOTHING, 0.05, "-", "no harm: no rigid clusters; at most 5 % of the movers in rods")
NO_DEPOSIT = Band(NOTHING, 0.01, "-", "without a deposit: at most 1 % of grains and moments at rest")
TOO_FAST = Band(
    1.5, float("inf"), "-", "far too large near the bed: at least 1.5 times the speed of locked grains"
)
OFF = Band(1.1, float("inf"), "-", "cannot be met: a flux at least 10 % above that of locked grains")
CURES: dict[str, dict[str, str]] = {
    "water torque, Dennis": {"water.torque": "Dennis"},
    "rolling friction, mu_r 0.2": {
        "rolling.model": "spring-dashpot-slider", "rolling.coefficient": "0.2",
    },
}  # fmt: skip
WITH = "rotation free, with"

measure = _debris.measure


def locked_settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of choices for locked grains that make a flow: begun at rest they lie down as a deposit."""
    return [one for one in _debris.settings(plan) if one[START] == SHIPPED[START]]


def free_settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of choices under which grains that turn are held against locked ones."""
    changes = plan.pick(
        (),
        ((AMOUNT, ("4",)), (SLIP, ("total",))),
        ((AMOUNT, ("3", "4", "6")), (PHI, ("20 deg", "40 deg")), (SLIP, ("total", "spring-drop"))),
    )
    return [SHIPPED, *({**SHIPPED, name: value} for name, values in changes for value in values)]


def _free(chosen: Mapping[str, str], seed: int, cure: str = "") -> CaseRun:
    return _debris.run(chosen, seed, {"motion.rotation": "free", **CURES.get(cure, {})})


def _cures(plan: Plan) -> Sequence[str]:
    return plan.pick((), tuple(CURES))


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Locked grains under every setting, free ones under some."""
    return [
        *(_debris.run(one, seed) for one in locked_settings(plan) for seed in plan.seeds),
        *(_free(one, seed) for one in free_settings(plan) for seed in plan.seeds),
        *(_free(SHIPPED, seed, cure) for cure in _cures(plan) for seed in plan.seeds),
    ]


def _ratios(
    found: Found, plan: Plan, value: Callable[[Debris], float], chosen: Mapping[str, str], cure: str = ""
) -> list[float]:
    """Free over locked, seed by seed."""
    return [
        value(found[_free(chosen, seed, cure)]) / value(found[_debris.run(chosen, seed)])
        for seed in plan.seeds
    ]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Locked grains move apart from one another; free ones lose the grip on the bed."""
    sets, turning = locked_settings(plan), free_settings(plan)
    tried = [
        *_debris.trials(found, plan, "movers in rods", each(lambda one: one.rods), APART, sets),
        *_debris.trials(found, plan, "grains at rest", each(lambda one: one.rest), NO_DEPOSIT, sets),
    ]
    parts: tuple[tuple[str, Callable[[Debris], float], Band], ...] = (
        ("grain speed near the bed, free over locked", lambda one: one.near_bed, TOO_FAST),
        ("flux, free over locked", lambda one: one.q, OFF),
    )
    faster: list[Trial] = []
    beside: list[Trial] = []
    for part, value, band in parts:
        groups = [_ratios(found, plan, value, one) for one in turning]
        spread = pool(groups)
        faster += [
            Trial(part, dict(one), over_seeds(values, band.unit, spread), band)
            for one, values in zip(turning, groups, strict=True)
        ]
        beside += [
            Trial(part, {WITH: cure}, over_seeds(_ratios(found, plan, value, SHIPPED, cure), band.unit), band)
            for cure in _cures(plan)
        ]

    def text(rotation: str, name: str) -> str:
        pick = _free if rotation == FREE else _debris.run
        values = [float(getattr(found[pick(SHIPPED, seed)], name)) for seed in plan.seeds]
        return short(sum(values) / len(values))

    both = partial(_both, text)
    return (
        Finding(
            "fig17-lock",
            tuple(tried),
            "Harm would be grains that move as a rigid body because they cannot roll past each other, as "
            "in fig22. In a flow without a deposit contacts last less than 0.1 ms, and no two grains stay "
            "together.",
            {**SETTLED, "rotation": LOCKED, "rods": "gap below 0.05 d and bearing within 15 deg for 0.075 s"},
            also=(
                f"movers in rods, as shipped: {text(LOCKED, 'rods')}; with shuffled paths "
                f"{text(LOCKED, 'null')}",
                "the measured profiles that the paper fitted are not in its text; the judgement is "
                "whether locking binds grains together",
            ),
        ),
        Finding(
            "fig17-free",
            tuple(faster),
            "A grain that rotates rolls over the fixed grains instead of sliding: it loses less momentum "
            f"to the bed, and the flow is faster. As shipped: {both('near_bed', 'm/s')} near the bed, "
            f"{both('speed', 'm/s')} on average.",
            {
                **SETTLED,
                "rotation": FREE,
                "held against": "the same with rotation locked, which the paper fitted",
            },
            also=(
                "the free flow is not steady: speed of the second half second over that of the first "
                f"{both('drift', '')}",
                f"concentration near the surface: {both('near_surface', '')}",
            ),
            beside=tuple(beside),
        ),
    )


def _both(text: Callable[[str, str], str], name: str, unit: str) -> str:
    return f"{text(FREE, name)} against {text(LOCKED, name)} {unit}".strip()


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    named = [
        (one, LOCKED, seed, _debris.run(one, seed)) for one in locked_settings(plan) for seed in plan.seeds
    ]
    named += [(one, FREE, seed, _free(one, seed)) for one in free_settings(plan) for seed in plan.seeds]
    named += [
        (SHIPPED, f"{FREE}, {cure}", seed, _free(SHIPPED, seed, cure))
        for cure in _cures(plan)
        for seed in plan.seeds
    ]
    return [
        {**one, "rotation": rotation, "seed": seed, **_debris.row(found[which])}
        for one, rotation, seed, which in named
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Profiles of locked and free grains, and of what could slow the free ones."""
    seed = plan.seeds[0]
    runs: dict[str, Debris] = {
        LOCKED: found[_debris.run(SHIPPED, seed)],
        FREE: found[_free(SHIPPED, seed)],
        **{f"{FREE}, {cure}": found[_free(SHIPPED, seed, cure)] for cure in _cures(plan)},
    }
    shown = {name: one.profile for name, one in runs.items()}
    return {"fig17-free": figures.profiles(shown, ("phi", "v_x", "spin"))}
