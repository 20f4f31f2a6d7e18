"""Fig. 17: Ito's debris flow over a rigid bed, rotation locked: concentration, ways of grains, contacts."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.studies.osada2004 import _debris
from ryusa.studies.osada2004._debris import AMOUNT, PARTNERS, SETTLED, SHIPPED, Debris, each
from ryusa.studies.osada2004._parts import CaseRun, Found, Plan
from ryusa.study import Band, Finding, Trial, over_seeds, short

FIGURE = "fig17"
TITLE = "Ito's debris flow over a rigid bed: concentration, paths, contacts"
CLAIMS = ("fig17", "fig17-time", "fig17-e")
PAIR = "which pair"
SURFACE = Band(
    0.25,
    0.35,
    "-",
    "about 0.3 near the surface, where grains of the upper layer move: 0.25 to 0.35 in the upper third of "
    "the depth, 2.2 diameters",
)
UP_AND_DOWN = Band(
    1.0,
    float("inf"),
    "-",
    "thrown up and down: within 1 s grains of the upper third leave their layer, by more than one diameter",
)
SEVEN = Band(6.5e-5, 7.5e-5, "s", "about 7e-5 s: one digit, 6.5e-5 to 7.5e-5 s")
BOUNCE = Band(0.65, 0.75, "-", "about 0.7: one digit, 0.65 to 0.75")
# claim -> what is read of contacts, which of the closed forms it is held against, what is asked
OF_CONTACTS = {
    "fig17-time": ("mean contact time", "time", 0, SEVEN),
    "fig17-e": ("mean restitution of contacts with a single partner", "e", 1, BOUNCE),
}

measure = _debris.measure


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Every setting and seed."""
    return [_debris.run(one, seed) for one in _debris.settings(plan) for seed in plan.seeds]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Dense up to the surface, stirred up to the surface; contacts as the constants make them."""
    sets = _debris.settings(plan)
    tried = [
        *_debris.trials(
            found, plan, "concentration in the upper third", each(lambda one: one.near_surface), SURFACE, sets
        ),
        *_debris.trials(
            found, plan, "range of heights within 1 s, in diameters", each(lambda one: one.thrown),
            UP_AND_DOWN, sets,
        ),
    ]  # fmt: skip

    def text(value: str, scale: float = 1.0) -> str:
        return short(scale * _debris.mean(found, plan, lambda one: float(getattr(one, value)), SHIPPED))

    amounts = "; ".join(
        f"{one[AMOUNT]} layers: {short(_debris.mean(found, plan, lambda run: run.near_surface, one))} near "
        f"the surface, {short(_debris.mean(found, plan, lambda run: run.speed, one))} m/s"
        for one in sets
        if one == SHIPPED | {AMOUNT: one[AMOUNT]}
    )
    return (
        Finding(
            "fig17",
            tuple(tried),
            "The number of grains decides the concentration, because over a rigid bed none is deposited "
            "or eroded. Contacts of less than 0.1 ms throw every grain up and down, at "
            f"{text('rms_z', 100.0)} cm/s on average, {text('steep')} of its speed along the bed.",
            SETTLED,
            also=(
                f"effect of the number of grains: {amounts}",
                f"as shipped, in the uppermost diameter of the depth alone: {text('topmost')}",
                f"as shipped: mean speed of the grains {text('speed')} m/s ({text('near_bed')} m/s near the "
                f"bed), flux {text('q', 1e4)} cm2/s; speed of the second half second over that of the first "
                f"{text('drift')}",
                "the experiment's nearly parallel layers are no number of ours; the band asks whether the "
                "simulated ways are not parallel",
            ),
        ),
        *(_of_contacts(found, plan, claim) for claim in OF_CONTACTS),
    )


def _of_contacts(found: Found, plan: Plan, claim: str) -> Finding:
    """Contact time or restitution of all contacts, and of each kind of pair."""
    part, what, which, band = OF_CONTACTS[claim]
    runs: list[Debris] = [found[_debris.run(SHIPPED, seed)] for seed in plan.seeds]
    values = {pair: [float(getattr(one.contacts[pair], what)) for one in runs] for pair in PARTNERS}
    closed = ", ".join(f"{pair} {short(both[which])}" for pair, both in runs[0].closed.items())
    counts = ", ".join(
        f"{pair} {round(float(np.mean([one.contacts[pair].n for one in runs])))}" for pair in PARTNERS
    )
    alone = ", ".join(
        f"{pair} {short(float(np.mean([one.contacts[pair].alone for one in runs])))} s" for pair in PARTNERS
    )
    return Finding(
        claim,
        tuple(Trial(part, {PAIR: pair}, over_seeds(values[pair], band.unit), band) for pair in PARTNERS),
        "One spring and one dashpot cannot give the same contact time and restitution for all pairs: the "
        "effective mass is that of the grain on a fixed partner, and half of it between two free grains. "
        f"Closed forms, with added mass: {closed}; the paper's number lies between them.",
        {**SETTLED, **SHIPPED},
        also=(
            f"contacts in a run: {counts}",
            f"mean contact time of contacts with a single partner: {alone}",
        ),
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    return [
        {**one, "seed": seed, **_debris.row(found[_debris.run(one, seed)])}
        for one in _debris.settings(plan)
        for seed in plan.seeds
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Ways of two grains, and profiles for every amount of grains."""
    sets = [one for one in _debris.settings(plan) if one == SHIPPED | {AMOUNT: one[AMOUNT]}]
    seed = plan.seeds[0]
    runs: dict[str, Debris] = {f"{one[AMOUNT]} layers": found[_debris.run(one, seed)] for one in sets}
    base: Debris = found[_debris.run(SHIPPED, seed)]
    names = sorted(runs)
    return {
        "fig17": figures.tracks(base.path, panels=3),
        "fig17-profiles": figures.profiles(
            {name: runs[name].profile for name in names}, ("phi", "v_x", "flux")
        ),
    }
