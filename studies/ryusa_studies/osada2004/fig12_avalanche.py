"""Fig. 12 in a flow: the share of the contacts of large grains that lie in the stable band."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.study import Finding, Trial, over_seeds, seeds_trial, short
from ryusa_studies.osada2004 import _avalanche
from ryusa_studies.osada2004._avalanche import FIRST, SHIPPED, SOFT, STIFF, WINDOW, RunPair
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import Found, Plan
from ryusa_studies.osada2004._shares import within_0_1

FIGURE = "fig12"
TITLE = "Contacts of large grains in the stable band, in an avalanche"
CLAIMS = ("fig12-avalanche",)
PARTS: Mapping[str, Callable[[RunPair], float]] = {
    f"contacts with the bed in the band, {SOFT}": lambda pair: pair.soft.bed_in_band,
    f"all contacts in the band, {SOFT}": lambda pair: pair.soft.in_band,
}
SHOWN: Mapping[str, Callable[[RunPair], float]] = {
    f"contacts with the bed in the band, {STIFF}": lambda pair: pair.stiff.bed_in_band,
    f"all contacts in the band, {STIFF}": lambda pair: pair.stiff.in_band,
}

tasks, measure, rows = _avalanche.tasks, _avalanche.measure, _avalanche.rows


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Most contacts of 0.01 s lie in the band."""
    judged: list[Trial] = []
    beside: list[Trial] = []
    for chosen, window in _avalanche.sets(plan):
        choices = {**chosen, WINDOW: window}
        runs = _avalanche.pairs(found, plan, chosen, window)
        for part, value in PARTS.items():
            one = seeds_trial(part, choices, [value(pair) for pair in runs], band("fig12-avalanche", part))
            judged.append(replace(one, found=within_0_1(one.found)))
        for part, value in SHOWN.items():
            shown = within_0_1(over_seeds([value(pair) for pair in runs], "-"))
            beside.append(Trial(part, choices, shown, None))
    base = _avalanche.pairs(found, plan, SHIPPED, FIRST)
    speed = short(sum(pair.soft.speed for pair in base) / len(base))
    return (finding("fig12-avalanche", judged, beside=beside, speed=speed),)


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Profiles of the flow whose contacts are counted."""
    (pair, *_) = _avalanche.pairs(found, plan, SHIPPED, FIRST)
    return {
        "fig12-avalanche": figures.profiles(
            {SOFT: pair.soft.profile, STIFF: pair.stiff.profile}, ("phi", "v_x")
        )
    }
