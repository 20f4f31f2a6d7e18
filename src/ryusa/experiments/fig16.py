"""Fig. 16: ways of grains that meet bed and movers in turn, collision time 0.01 s and 0.0001 s."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.experiments import _avalanche
from ryusa.experiments._avalanche import FIRST, SHIPPED, SOFT, STIFF, Avalanche, Pair
from ryusa.experiments._experiment import Found, Plan, Variant
from ryusa.experiments._verdict import Band, Finding, Trial, short
from ryusa.results import Results

FIGURE = "fig16"
TITLE = "Ways of grains in a dry avalanche"
CLAIMS = ("fig16",)
MORE, LESS = float("inf"), 1.0
# part of the claim -> what it is of each run, and what is asked of 0.0001 s over 0.01 s
PARTS: dict[str, tuple[str, Band]] = {
    "turns of the vertical motion per second, 0.0001 s over 0.01 s": (
        "reversals", Band(1.0, MORE, "-", "very jagged: more turns, ratio above 1"),
    ),
    "way along the bed in 1 s, 0.0001 s over 0.01 s": (
        "advance", Band(0.0, LESS, "-", "shorter: ratio below 1"),
    ),
    "vertical way over advance, 0.0001 s over 0.01 s": (
        "jaggedness", Band(1.0, MORE, "-", "0.01 s nearer to parallel layers: ratio above 1"),
    ),
}  # fmt: skip
NONE = "no grain meets bed and movers in turn, or none advances, in one of the runs"


def cases(plan: Plan) -> Sequence[Variant]:
    """Both collision times under every choice."""
    return _avalanche.cases(plan)


def measure(run: Results, one: Variant) -> Avalanche:
    """Ways in every window."""
    del one
    return _avalanche.avalanche(run)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Jagged, short and not in layers."""
    tried = [
        _said(found, plan, one)
        for part, (name, band) in PARTS.items()
        for one in _avalanche.trials(found, plan, part, lambda pair, name=name: _ratio(pair, name), band)
    ]
    words = {
        name: tuple(
            short(_mean([getattr(run, name) for run in runs]))
            for runs in zip(
                *[(p.soft, p.stiff) for p in _avalanche.pairs(found, plan, SHIPPED, FIRST)], strict=True
            )
        )
        for name in ("reversals", "advance", "jaggedness", "n_turning")
    }
    return (
        Finding(
            "fig16",
            tuple(tried),
            f"In the first window, 0.01 s against 0.0001 s: {_versus(words['reversals'])} vertical turns a "
            f"second, {_versus(words['advance'])} m of way, {_versus(words['jaggedness'])} m up and down per "
            "metre of advance. A grain cannot bounce twice within one contact, so long contacts cut off the "
            "fast rattling and the losses that come with it.",
            {**_avalanche.SETTLED, "turns counted from": "0.02 d, frames of 10 ms"},
            also=(
                f"grains of the lowest layer that alternate, of {_avalanche.LOWEST}: "
                f"{_versus(words['n_turning'])}",
            ),
        ),
    )


def _ratio(pair: Pair, name: str) -> float:
    """Stiff over soft; nan where no grain alternates."""
    soft = getattr(pair.soft, name)
    return getattr(pair.stiff, name) / soft if soft != 0.0 else float("nan")


def _said(found: Found, plan: Plan, one: Trial) -> Trial:
    """A trial without a number fails: there are no such ways to compare."""
    if one.found.low == one.found.low:
        return one
    return Trial(one.part, one.choices, one.found, one.band, False, NONE)


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _versus(pair: tuple[str, ...]) -> str:
    return " against ".join(pair)


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run and window."""
    return _avalanche.rows(found, plan)


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Two ways of each run over the bed, as in the paper."""
    (pair, *_) = _avalanche.pairs(found, plan, SHIPPED, FIRST)
    ways = {f"(a) {SOFT}": pair.soft.path, f"(b) {STIFF}": pair.stiff.path}
    far = max(float((one.x - one.x[0, 0]).max()) for one in ways.values())
    return {"fig16": figures.tracks_side_by_side(ways, far + float(pair.soft.profile.d), "cm")}
