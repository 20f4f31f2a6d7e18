"""The paper's premise, films that show collisions of about 0.01 s: what a film of the model shows."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures.comparison import Axis, Curve, compared
from ryusa.measure import collisions
from ryusa.measure.apparent_contact import near_pairs, on_film
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.study import Finding, Trial, over_seeds, seeds_trial, short
from ryusa_studies.osada2004 import claims
from ryusa_studies.osada2004._film import (
    COLLISION,
    CUT,
    DESIGNS,
    FLOWS,
    FPS,
    JAPANESE,
    PART,
    RESOLUTION,
    RESOLUTIONS,
    SECTION,
    SEEN,
    SLOWER,
    TRANSLATION,
)
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run

FIGURE = "film"
TITLE = "Contact as a film of the model shows it"
CLAIMS = tuple(FLOWS)
E = 0.7  # restitution of all three flows
MEDIAN = "median of it"
STAY = "mean time within the resolution"
TOUCH = "mean collision time"


@dataclass(frozen=True)
class FilmNumbers:
    """Apparent contacts on one film.

    Attributes
    ----------
    mean, median : how long they last [s].
    stay : mean time that pairs are within the resolution, by all frames of the run [s].
    unseen : share of these stays that falls between two frames of the film [-].
    cut : share of the apparent contacts cut off by the end of the film [-].
    n : number of apparent contacts.
    per_stay : collisions that begin in a stay, mean [-].
    passes : share of the stays without a collision [-].
    """

    mean: float
    median: float
    stay: float
    unseen: float
    cut: float
    n: int
    per_stay: float
    passes: float


@dataclass(frozen=True)
class Filmed:
    """One run as films show it.

    Attributes
    ----------
    films : by resolution in diameters and frames per second.
    durations : apparent contacts of the film that is judged, in order of length [s].
    collision : mean duration of the contacts themselves [s].
    closing, relative : speeds of the two grains at first touch, along the line of centres and in all [m/s].
    d : diameter [m].
    """

    films: Mapping[tuple[float, float], FilmNumbers]
    durations: Floats
    collision: float
    closing: float
    relative: float
    d: float

    def film(self, resolution: float | None = None, fps: float = FPS) -> FilmNumbers:
        """One of the films; by default that of the base settings."""
        return self.films[_resolutions()[0] if resolution is None else resolution, fps]


def settings(claim: str, plan: Plan) -> list[dict[str, str]]:
    """Sets of choices that need runs of their own, the base first."""
    return DESIGNS[claim].sets(plan)


def run(claim: str, chosen: Mapping[str, str], seed: int) -> CaseRun:
    """One run of a flow."""
    design = DESIGNS[claim]
    chosen = {**design.base, **chosen}  # also the springs of the base have their keys
    return paper_run(FLOWS[claim].case, {**FLOWS[claim].changed, **design.overrides(chosen)}, seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Every flow, setting and seed."""
    return [run(claim, one, seed) for claim in FLOWS for one in settings(claim, plan) for seed in plan.seeds]


def measure(results: Results, one: CaseRun) -> Filmed:
    """Films of one run, at every resolution with the frames that are judged."""
    del one
    films: dict[tuple[float, float], FilmNumbers] = {}
    durations = np.zeros(0)
    for k, resolution in enumerate(_resolutions()):
        near = near_pairs(results, None, math.inf, resolution)
        for fps in (FPS, *(SLOWER if k == 0 else ())):
            found = on_film(near, fps)
            if not films:
                durations = np.sort(found.film.duration)
            films[resolution, fps] = FilmNumbers(
                found["apparent_time"].value,
                found.film.median,
                found["stay"].value,
                found["unseen"].value,
                found.film.cut_share,
                len(found.film.frames),
                found["collisions_per_stay"].value,
                float(np.mean(found.collisions == 0)) if len(found.collisions) else math.nan,
            )
    touch = collisions(results)
    closing, slip = touch.events["closing_begin"], np.linalg.norm(touch.events["slip_begin"], axis=1)
    return Filmed(
        films,
        durations,
        touch["duration"].value,
        touch["closing_speed"].value,
        float(np.hypot(closing, slip).mean()) if len(closing) else math.nan,
        float(results.scene.d.mean()),
    )


def _resolutions() -> list[float]:
    return [float(one.removesuffix(" d")) for one in RESOLUTIONS]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Whether each flow shows about 0.01 s on its film."""
    return [_finding(found, plan, claim) for claim in FLOWS]


def _finding(found: Found, plan: Plan, claim: str) -> Finding:
    sets = settings(claim, plan)
    runs = [[found[run(claim, one, seed)] for seed in plan.seeds] for one in sets]

    def ms(value: Callable[[Filmed], float], k: int = 0) -> str:
        return f"{short(1e3 * float(np.mean([value(one) for one in runs[k]])))} ms"

    def plain(value: Callable[[Filmed], float]) -> str:
        return short(float(np.mean([value(one) for one in runs[0]])))

    eps = _resolutions()[0]
    stays = "; ".join(
        f"{ms(lambda one: one.film().stay, k)} for collisions of {ms(lambda one: one.collision, k)}"
        + (f" ({others})" if others else "")
        for k, one in enumerate(sets)
        for others in [", ".join(v for name, v in one.items() if v != sets[0][name] and name != COLLISION)]
    )
    slower = " and ".join(f"{one:g}" for one in SLOWER)
    return Finding(
        claim,
        (*_judged(sets, runs), *_shown(sets, runs)),
        "The model filmed itself; no film of an experiment was measured. A film does not show a collision "
        "but that two grains are near each other. Mean time that pairs are "
        f"within {eps:g} d: {stays}.",
        {
            "flow": claims.CLAIMS[claim].setup,
            "restitution": f"{E:g}",
            "springs": "those of the figure; 100 times as stiff for 1e-5 s",
        },
        readings=(RESOLUTION,),
        also=(
            f"the paper, {SECTION}: {JAPANESE} {TRANSLATION}",
            f"in closed form, at the mean speeds of first touch: straight rebound within {eps:g} d "
            f"{ms(lambda one: eps * one.d / one.closing * (1.0 + 1.0 / E))}, closing at "
            f"{plain(lambda one: one.closing)} m/s; d/v, pivoting over the neighbour, "
            f"{ms(lambda one: one.d / one.relative)}, v = {plain(lambda one: one.relative)} m/s",
            f"base settings: {plain(lambda one: one.film().n)} apparent contacts on the film, the median "
            f"{ms(lambda one: one.film().median)}; missed between two frames "
            f"{plain(lambda one: one.film().unseen)} of the stays, cut off by the end of the film "
            f"{plain(lambda one: one.film().cut)} of the apparent contacts; "
            f"{plain(lambda one: one.film().per_stay)} collisions in a stay, none in "
            f"{plain(lambda one: one.film().passes)} of the stays",
            f"not judged are films of {slower} frames per second: whatever the grains do, what is seen lasts "
            f"{' and '.join(f'{1e3 / one:g}' for one in SLOWER)} ms or more",
        ),
    )


def _judged(sets: Sequence[Mapping[str, str]], runs: Sequence[Sequence[Filmed]]) -> list[Trial]:
    """The film that is judged, at every resolution; nan where too many contacts are cut off by its end."""
    trials: list[Trial] = []
    for words, eps in zip(RESOLUTIONS, _resolutions(), strict=True):
        films = [[one.film(eps) for one in group] for group in runs]
        means = [[one.mean if one.cut <= CUT else math.nan for one in group] for group in films]
        for one, values, group in zip(sets, means, films, strict=True):
            lost = max(film.cut for film in group)
            note = f"{100.0 * lost:.0f} % are cut off by the end of the film" if lost > CUT else ""
            trial = seeds_trial(PART, {**one, RESOLUTION: words}, values, SEEN)
            trials.append(replace(trial, note=note))
    return trials


def _shown(sets: Sequence[Mapping[str, str]], runs: Sequence[Sequence[Filmed]]) -> list[Trial]:
    """What is not judged, at the resolution of the base."""
    shown: dict[str, Callable[[Filmed], float]] = {
        MEDIAN: lambda one: one.film().median,
        STAY: lambda one: one.film().stay,
        **{f"the same on a film of {fps:g} frames per second": partial(_mean_at, fps) for fps in SLOWER},
        TOUCH: lambda one: one.collision,
    }
    trials: list[Trial] = []
    for part, value in shown.items():
        trials += [
            Trial(
                part,
                {**one, RESOLUTION: RESOLUTIONS[0]},
                over_seeds([value(filmed) for filmed in group], "s"),
                None,
            )
            for one, group in zip(sets, runs, strict=True)
        ]
    return trials


def _mean_at(fps: float, one: Filmed) -> float:
    return one.film(fps=fps).mean


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run and film."""
    return [
        {
            "flow": claim, **one, "seed": seed, "resolution_d": resolution, "fps": fps,
            **asdict(film), "collision_s": filmed.collision, "closing_m_per_s": filmed.closing,
            "relative_m_per_s": filmed.relative,
        }
        for claim in FLOWS
        for one in settings(claim, plan)
        for seed in plan.seeds
        for filmed in [found[run(claim, one, seed)]]
        for (resolution, fps), film in filmed.films.items()
    ]  # fmt: skip


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Share of the apparent contacts that last longer than a time, for each flow and collision time."""
    curves: list[Curve] = []
    for claim in FLOWS:
        sets = settings(claim, plan)
        for time in dict.fromkeys(one[COLLISION] for one in sets):
            runs = [run(claim, one, seed) for one in sets if one[COLLISION] == time for seed in plan.seeds]
            lasting = np.sort(np.concatenate([found[one].durations for one in runs]))
            longer = 1.0 - np.arange(1, len(lasting) + 1) / max(len(lasting), 1)
            curves.append(Curve(f"{claim.removeprefix('film-')}, collisions of {time}", lasting, longer))
    edges = [Curve(f"{one:g} s", np.full(2, one), np.array([0.0, 1.0])) for one in (SEEN.low, SEEN.high)]
    return {
        "film": compared(
            Axis("time in contact on a film of the model", "s", log=True),
            Axis("share that lasts longer"),
            curves,
            [],
            edges,
        )
    }
