"""Fig. 17: Ito's debris flow over a rigid bed, rotation locked: concentration, ways of grains, contacts."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.study import Finding, Trial, seeds_trial, short
from ryusa_studies.osada2004 import _debris, _debris_run
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._debris import AMOUNT, SHIPPED
from ryusa_studies.osada2004._debris_run import NEAR_SURFACE, PARTNERS, Debris
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan

FIGURE = "fig17"
TITLE = "Ito's debris flow over a rigid bed: concentration, paths, contacts"
CLAIMS = ("fig17", "fig17-time", "fig17-e")
LAYER, PAIR = "near the surface", "which pair"
AMOUNTS = ("3", "4", "6")  # drawn beside the shipped one
# part of fig17 -> number of a layer
OF_SURFACE = {
    "concentration near the surface": "phi",
    "range of heights within 1 s, in diameters": "thrown",
    "mean time between collisions near the surface": "between",
}
# claim -> part, what is read of contacts, which of the closed forms it is held against
OF_CONTACTS = {
    "fig17-time": ("mean contact time", "time", 0),
    "fig17-e": ("mean restitution of contacts with a single partner", "e", 1),
}

measure = _debris_run.measure


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Every setting and seed; above the quick level also the amounts of grains that are drawn."""
    sets = [*_debris.settings(plan), *_amounts(plan)]
    return list(dict.fromkeys(_debris.run(one, seed) for one in sets for seed in plan.seeds))


def _amounts(plan: Plan) -> list[dict[str, str]]:
    return [SHIPPED, *({**SHIPPED, AMOUNT: one} for one in plan.pick((), AMOUNTS))]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Dense up to the surface, stirred up to the surface; contacts as the constants make them."""
    tried = [
        trial
        for layer in NEAR_SURFACE
        for part, name in OF_SURFACE.items()
        for trial in _trials(
            found, plan, "fig17", part, {LAYER: layer},
            lambda one, layer=layer, name=name: float(getattr(one.near_surface[layer], name)),
        )
    ]  # fmt: skip

    def text(value: str, scale: float = 1.0) -> str:
        return short(scale * _debris.mean(found, plan, lambda one: float(getattr(one, value)), SHIPPED))

    amounts = "; ".join(
        f"{one[AMOUNT]} layers: {short(_debris.mean(found, plan, _in_upper_third, one))} in the upper third, "
        f"{short(_debris.mean(found, plan, lambda run: run.speed, one))} m/s"
        for one in _amounts(plan)
    )
    return (
        finding(
            "fig17",
            tried,
            also=(
                f"effect of the number of grains, all else as shipped: {amounts}",
                f"as shipped: mean speed of the grains {text('speed')} m/s ({text('near_bed')} m/s near the "
                f"bed), flux {text('q', 1e4)} cm2/s; speed of the second half second over that of the first "
                f"{text('drift')}",
                "the experiment's nearly parallel layers are no number of ours; the band asks whether the "
                "simulated ways are not parallel",
            ),
            rms_z=text("rms_z", 100.0),
            steep=text("steep"),
        ),
        *(_of_contacts(found, plan, claim) for claim in OF_CONTACTS),
    )


def _in_upper_third(one: Debris) -> float:
    return one.near_surface[NEAR_SURFACE[0]].phi


def _trials(
    found: Found, plan: Plan, claim: str, part: str, reading: Mapping[str, str], value: _debris.Value
) -> list[Trial]:
    """One part of a claim by one reading of the same runs, under every setting."""
    limits = band(claim, part)
    return [
        seeds_trial(
            part, {**one, **reading}, [value(found[_debris.run(one, seed)]) for seed in plan.seeds], limits
        )
        for one in _debris.settings(plan)
    ]


def _of_contacts(found: Found, plan: Plan, claim: str) -> Finding:
    """Contact time or restitution of all contacts, and of each kind of pair."""
    part, what, which = OF_CONTACTS[claim]
    tried = [
        trial
        for pair in PARTNERS
        for trial in _trials(
            found, plan, claim, part, {PAIR: pair},
            lambda one, pair=pair: float(getattr(one.contacts[pair], what)),
        )
    ]  # fmt: skip
    runs: list[Debris] = [found[_debris.run(SHIPPED, seed)] for seed in plan.seeds]
    closed = ", ".join(f"{pair} {short(both[which])}" for pair, both in runs[0].closed.items())
    counts = ", ".join(
        f"{pair} {round(float(np.mean([one.contacts[pair].n for one in runs])))}" for pair in PARTNERS
    )
    alone = ", ".join(
        f"{pair} {short(float(np.mean([one.contacts[pair].alone for one in runs])))} s" for pair in PARTNERS
    )
    return finding(
        claim,
        tried,
        also=(
            f"contacts in a run as shipped: {counts}",
            f"mean contact time of contacts with a single partner, as shipped: {alone}",
        ),
        closed=closed,
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    return [
        {**one, "seed": seed, **_debris_run.row(found[_debris.run(one, seed)])}
        for one in _debris.settings(plan)
        for seed in plan.seeds
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Ways of two grains, and profiles for every amount of grains."""
    seed = plan.seeds[0]
    runs: dict[str, Debris] = {
        f"{one[AMOUNT]} layers": found[_debris.run(one, seed)] for one in _amounts(plan)
    }
    base: Debris = found[_debris.run(SHIPPED, seed)]
    return {
        "fig17": figures.tracks(base.path, panels=3),
        "fig17-profiles": figures.profiles(
            {name: runs[name].profile for name in sorted(runs)}, ("phi", "v_x", "flux")
        ),
    }
