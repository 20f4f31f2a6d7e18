"""What the experiments about Ito's debris flow (fig17, fig17-free, fig18) share: choices, runs, judgement."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ryusa_studies.osada2004._debris_run import Debris
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run

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
DESIGN = design("debris", {LONGER: {one: longer_by(one) for one in (LONG, "3", "10")}})
SHIPPED = {name: level for name, level in DESIGN.base.items() if name != LONGER}
STANDS = 0.5  # share of grains and moments at rest, from which a flow has come to rest


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of free choices of the flow with the contacts of the paper, the shipped one first."""
    sets = [_without(one, LONGER) for one in long_settings(plan)]
    return list({tuple(one.items()): one for one in sets}.values())


long_settings = DESIGN.sets


def _without(chosen: Mapping[str, str], name: str) -> dict[str, str]:
    return {key: value for key, value in chosen.items() if key != name}


def run(chosen: Mapping[str, str], seed: int, changed: Mapping[str, str] | None = None) -> CaseRun:
    """One run with the contacts of the paper, whatever longer ones a setting names."""
    return paper_run(CASE, {**DESIGN.overrides(_without(chosen, LONGER)), **(changed or {})}, seed)


def flows(runs: Sequence[Debris]) -> bool:
    """Whether no run of a setting has come to rest."""
    return all(one.rest < STANDS for one in runs)


def mean(found: Found, plan: Plan, value: Value, chosen: Mapping[str, str]) -> float:
    """Mean over seeds of a number that decides nothing."""
    return float(np.mean([value(found[run(chosen, seed)]) for seed in plan.seeds]))
