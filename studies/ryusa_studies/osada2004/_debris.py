"""What the experiments about Ito's debris flow (fig17, fig17-free, fig18) share: choices, runs, judgement."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ryusa.study import Design, Factor, Trial
from ryusa_studies.osada2004._debris_run import Debris
from ryusa_studies.osada2004._factors import DRAG_LAW, PARTING_RULE, SLIP_RULE, friction_angle, n_settings
from ryusa_studies.osada2004._parts import CLOSURE, PACKING, START, CaseRun, Found, Plan, paper_run

CASE = "fig17"
Value = Callable[[Debris], float]
LOCKED, FREE = "locked", "free"
AMOUNT = "layers of grains put in"
LONGER = "contacts longer by"
K_N, K_S, ETA_N, ETA_S = 200.0, 15.0, 1.0e-3, 1.0e-4  # of the paper [N/cm], [N s/cm]
LONG = "30"  # times, in the case fig18


def longer_by(times: str) -> dict[str, str]:
    """Constants that make contacts of the case fig18 so many times as long as those of fig17.

    Springs are divided by the square of it and dashpots by it, so that restitution and k_s/k_n stay.
    """
    s = float(times)
    keys = {
        "contact.stiffness": f"{K_N / s**2:.5g} N/cm",
        "contact.shear_stiffness": f"{K_S / s**2:.5g} N/cm",
        "contact.damping": f"{ETA_N / s:.5g} N s/cm",
        "contact.shear_damping": f"{ETA_S / s:.5g} N s/cm",
        "time.steps_per_contact": "30",  # which resolve the drag too, as contacts are shorter than in fig18
    }
    return {} if times == LONG else keys


# The free choices of fig17, fig17-lock, fig17-free and fig18: one design, so that they share their runs.
DESIGN = Design(
    (
        Factor(AMOUNT, {"5": {}, **{one: {"build.layers": one} for one in ("3", "4", "6")}}),
        PARTING_RULE,
        Factor(START, {"on their way": {}, "at rest": {"build.speed": "0 m/s"}}),
        Factor(
            CLOSURE,
            {
                "Li-Sawamoto over a rough bed": {},
                "eddies in pores, k_f 0.16": {"water.column.pore_eddies": "0.16"},
                "parabolic mixing length": {
                    "water.column": '{ start = "rest", bed = "rough", mixing_length = "parabolic" }'
                },
                "no wall law, drag of the fixed grains": {
                    "water.zero": "1.635 mm",
                    "water.column": '{ start = "rest", bed = "moving", mixing_length = "Li-Sawamoto", '
                    "packed = 0.5 }",
                },
                "roughness 0.5 d": {"water.roughness": "1.09 mm"},
                "roughness 2 d": {"water.roughness": "4.36 mm", "water.column.cell": "0.436 mm"},
                "buoyancy by weight": {"water.buoyancy": "weight"},
                "hindrance Richardson-Zaki": {"water.hindrance": "Richardson-Zaki"},
            },
        ),
        Factor(
            PACKING,
            {
                "flat bed, equal grains": {},
                "bed of random height": {"build.bed": "random"},
                "sizes within 10 %": {"grains.spread": "0.1"},
            },
        ),
        friction_angle(),
        DRAG_LAW,
        SLIP_RULE,
        Factor(LONGER, {LONG: {}, **{one: longer_by(one) for one in ("3", "10")}}),
    )
)
SHIPPED = {name: level for name, level in DESIGN.base.items() if name != LONGER}
STANDS = 0.5  # share of grains and moments at rest, from which a flow has come to rest
SETTLED = {
    "d": "0.218 cm",
    "tau_star": "1.08",
    "depth": "1.48 cm",
    "slope": "15.2 deg",
    "k_n, k_s": "200, 15 N/cm",
    "eta_n, eta_s": "0.001, 0.0001 N s/cm",
    "k_s/k_n": "0.075",
    "rotation": "locked",
    "window": "1 to 2 s",
}


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of free choices of the flow with the contacts of the paper, the shipped one first."""
    sets = [_without(one, LONGER) for one in long_settings(plan)]
    return list({tuple(one.items()): one for one in sets}.values())


def long_settings(plan: Plan) -> list[dict[str, str]]:
    """The same with how much longer the contacts of fig18 are."""
    return DESIGN.settings(n_settings(plan))


def _without(chosen: Mapping[str, str], name: str) -> dict[str, str]:
    return {key: value for key, value in chosen.items() if key != name}


def run(chosen: Mapping[str, str], seed: int, changed: Mapping[str, str] | None = None) -> CaseRun:
    """One run with the contacts of the paper, whatever longer ones a setting names."""
    return paper_run(CASE, {**DESIGN.overrides(_without(chosen, LONGER)), **(changed or {})}, seed)


def flows(runs: Sequence[Debris]) -> bool:
    """Whether no run of a setting has come to rest."""
    return all(one.rest < STANDS for one in runs)


def as_share(trial: Trial) -> Trial:
    """Cut the interval of a share to what a share can be."""
    low, high = max(0.0, trial.found.low), min(1.0, trial.found.high)
    return replace(trial, found=replace(trial.found, low=low, high=high))


def mean(found: Found, plan: Plan, value: Value, chosen: Mapping[str, str]) -> float:
    """Mean over seeds of a number that decides nothing."""
    return float(np.mean([value(found[run(chosen, seed)]) for seed in plan.seeds]))
