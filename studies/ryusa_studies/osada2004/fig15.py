"""Fig. 15: grain speed over height of a dry avalanche, and the flux, collision time 0.01 s and 0.0001 s."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.measure import Profiles, average
from ryusa.study import Band, Finding, Trial, exact, over_seeds, short
from ryusa_studies.osada2004 import _avalanche
from ryusa_studies.osada2004._avalanche import (
    FIRST,
    SHIPPED,
    SOFT,
    STIFF,
    WINDOWS,
    Numbers,
    RunPair,
    apart,
    each,
    faster,
    faster_by_layer,
    together,
    unlike,
)  # fmt: skip
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import PHI, ROTATION, SLIP, Found, Plan
from ryusa_studies.osada2004._shares import halves
from ryusa_studies.osada2004.fig14 import ALIKE
from ryusa_studies.osada2004.fig14 import PART as ALIKE_PART
from ryusa_studies.osada2004.figures import SensitivityRow, sensitivity

FIGURE = "fig15"
TITLE = "Grain speed and flux of a dry avalanche"
CLAIMS = ("fig15", "fig15-flux")
CM = 100.0  # centimetres in a metre
FASTER = f"speed of {SOFT} minus that of {STIFF}"
DEPTH_MEAN, LEAST = f"{FASTER}, mean over the depth", f"{FASTER}, least of all layers"
FLUX = f"flux over the whole depth, {SOFT} over {STIFF}"
ABOUT, WHOLE = band("fig15", DEPTH_MEAN), band("fig15", LEAST)
MORE = band("fig15-flux", FLUX)
LOCKED = {**SHIPPED, ROTATION: "locked", PHI: "20 deg"}
CAPS = ("spring", "total")

tasks, measure, rows = _avalanche.tasks, _avalanche.measure, _avalanche.rows


def depth_mean(found: Sequence[RunPair]) -> float:
    """How much faster the runs with long contacts are, mean over the layers [cm/s]."""
    return CM * float(faster(found).mean())


def least(part: str, chosen: Mapping[str, str], found: Sequence[RunPair], limits: Band) -> Trial:
    """Judge the layer in which the runs with long contacts are least ahead.

    Every layer has an interval over seeds. Larger in every layer needs each of them to be larger (Berger
    1982, Technometrics 24, 295), so the lower limits stay as they are; that some layer is not larger is
    found among many, so the upper limits hold for all of them together (Bonferroni).
    """
    by_layer = [[CM * float(x) for x in of_layer] for of_layer in faster_by_layer(found).T]
    if not by_layer:
        return Trial(part, chosen, exact(math.nan, limits.unit), limits, note="no layer that both fill")
    alone = [over_seeds(one, limits.unit) for one in by_layer]
    jointly = [over_seeds(one, limits.unit, confidence=1.0 - 0.05 / len(alone)) for one in by_layer]
    worst = min(alone, key=lambda one: one.value)
    both = replace(
        worst,
        low=min(one.low for one in alone),
        high=min(one.high for one in jointly),
        how=f"least of {len(alone)} layers, each {worst.how}; upper limit after Bonferroni",
    )
    by_half = halves(
        range(len(found)), lambda half: min(float(np.mean([x[k] for k in half])) for x in by_layer), limits
    )
    return Trial(part, chosen, both, limits, halves=by_half)


soft_speed = each(lambda pair: pair.soft.speed)  # of all grains, with long contacts [m/s]
stiff_speed = each(lambda pair: pair.stiff.speed)


def flux_of(pair: RunPair) -> float:
    """Flux over the whole depth, long over short contacts [-]."""
    return pair.soft.q / pair.stiff.q


flux_ratio = each(flux_of)

# results drawn of every choice, with their axis
PANELS: dict[str, Numbers] = {
    "faster by (cm/s)": depth_mean,
    f"speed, {SOFT} (m/s)": soft_speed,
    f"speed, {STIFF} (m/s)": stiff_speed,
    "concentrations differ by": unlike,
}


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """About 100 cm/s faster with long contacts, and with that more transport."""
    flow = _avalanche.flows(found, plan)
    tried = partial(_avalanche.trials, found, plan)
    tried_sets = _avalanche.settings(plan)

    def text(value: Numbers, chosen: Mapping[str, str]) -> str:
        """Value in all windows."""
        return " and ".join(short(_avalanche.mean(found, plan, chosen, one, value)) for one in WINDOWS)

    slow, fast = (short(_avalanche.creep(LOCKED, time)) for time in (STIFF, SOFT))
    base = _avalanche.pairs(found, plan, SHIPPED, FIRST)
    rate, touching = (
        " against ".join(short(float(np.mean(values))) for values in zip(*both, strict=True))
        for both in (
            [(one.soft.rate, one.stiff.rate) for one in base],
            [(one.soft.touching, one.stiff.touching) for one in base],
        )
    )
    tops = [one for one in tried_sets if one[SLIP] != "spring"]
    left = "; ".join(f"{_avalanche.label(one)}: {text(depth_mean, one)} cm/s" for one in tops)
    windows = " and ".join(WINDOWS)
    words: dict[str, Any] = {"slow": slow, "fast": fast, "rate": rate, "touching": touching}
    return (
        finding(
            "fig15",
            [*tried(DEPTH_MEAN, together(depth_mean), ABOUT), *tried(LEAST, least, WHOLE), *flow],
            also=(
                *(
                    f"speed, {_avalanche.label(one)}: {text(soft_speed, one)} m/s with {SOFT}, "
                    f"{text(stiff_speed, one)} m/s with {STIFF}, at {windows}"
                    for one in tried_sets
                ),
                *((f"faster by, without the uncapped dashpot: {left}",) if left else ()),
            ),
            shipped=text(depth_mean, SHIPPED),
            windows=windows,
            **words,
        ),
        finding(
            "fig15-flux",
            [*tried(FLUX, apart(flux_of), MORE), *tried(ALIKE_PART, together(unlike), ALIKE), *flow],
            also=[
                f"flux ratio, {_avalanche.label(one)}: {text(flux_ratio, one)} at {windows}"
                for one in tried_sets
            ],
            shipped=text(flux_ratio, SHIPPED),
            windows=windows,
            **words,
        ),
    )


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Speed against height, as in the paper; slip rules of locked grains; what every choice does."""
    pictures = {"fig15": figures.profiles(_profiles(found, plan, {"": SHIPPED}), ("v_x",))}
    tried = _avalanche.settings(plan)
    locked = {f"{one[SLIP]}, ": one for one in ({**LOCKED, SLIP: slip} for slip in CAPS) if one in tried}
    if locked:
        pictures["fig15-locked"] = figures.profiles(_profiles(found, plan, locked), ("phi", "v_x"))
    if len(tried) > 1:
        lines = [
            SensitivityRow(
                _avalanche.label(one),
                {
                    window: [
                        average(name, "-", [[value([x])] for x in _avalanche.pairs(found, plan, one, window)])
                        for name, value in PANELS.items()
                    ]
                    for window in WINDOWS
                },
            )
            for one in tried
        ]
        pictures["fig15-choices"] = sensitivity(lines, tuple(PANELS), (1.0,) * len(PANELS))
    return pictures


def _profiles(found: Found, plan: Plan, chosen: Mapping[str, Mapping[str, str]]) -> dict[str, Profiles]:
    """Profiles of the first seed and window with both collision times, by name of the set and time."""
    first = {name: _avalanche.pairs(found, plan, one, FIRST)[0] for name, one in chosen.items()}
    return {
        f"{name}{time}": one.profile
        for name, pair in first.items()
        for time, one in ((SOFT, pair.soft), (STIFF, pair.stiff))
    }
