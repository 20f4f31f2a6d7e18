"""A split-bottom shear cell: the zone at the surface is an error function that follows the height."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Axis, Curve
from ryusa.laws.dense_flow import split_bottom_centre
from ryusa.measure import shear_zone
from ryusa.measure.shear_zone import zone
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import (
    Band,
    CaseRun,
    Finding,
    Found,
    Known,
    Level,
    Plan,
    Source,
    Task,
    case_run,
    comparison,
    misfit,
    over_seeds,
)
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "Split-bottom shear cell"
GRAINS = (2000, 3900)  # in the cell: some 2.6 and 5 diameters high
R_S, D = 0.05, 0.005  # radius of the disc and diameter of the case file [m]


def _run(grains: int, seed: int) -> CaseRun:
    return case_run(case_path("split_bottom.toml"), {"build.most": f"{grains}"}, seed=seed)


def tasks(plan: Plan) -> Sequence[Task]:
    """Runs of a minute, at the full level alone: the others have an hour on two cores."""
    if plan.level is not Level.FULL:
        return []
    return [_run(grains, seed) for seed in SAMPLING["split_bottom"].seeds(plan) for grains in GRAINS]


def measure(run: Results, one: CaseRun) -> dict[str, Floats | float]:
    """Zone at the surface [m], [-], what the fit and the balance of torques lack [-], and the profile."""
    del one
    found = shear_zone(run)
    return {
        "centre": found.centre, "width": found.width, "share": found.share, "height": found.height,
        "misfit": found.misfit, "change": found.change, "r": found.r, "turning": found.turning.value,
    }  # fmt: skip


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Form of the profile, and how its centre and its width change with the height of the grains."""
    if plan.level is not Level.FULL:
        return []
    seeds = SAMPLING["split_bottom"].seeds(plan)
    runs = {grains: [found[_run(grains, seed)] for seed in seeds] for grains in GRAINS}

    def each(key: str, grains: int) -> Floats:
        return np.array([float(one[key]) for one in runs[grains]])

    def more(key: str) -> list[float]:
        return ((each(key, GRAINS[1]) - each(key, GRAINS[0])) / D).tolist()

    def named(grains: int) -> str:
        return f"{each('height', grains).mean() / D:.1f} d high"

    curves, fits = [list[Curve](), list[Curve]()]
    for grains, of_seeds in runs.items():
        first = of_seeds[0]
        r = np.asarray(first["r"])
        curves.append(Curve(named(grains), r / R_S, np.asarray(first["turning"])))
        fit = zone(r, float(first["centre"]), float(first["width"]), float(first["share"]))
        fits.append(Curve(named(grains), r / R_S, fit))
    law = [split_bottom_centre(R_S, float(each("height", grains).mean())) / D for grains in GRAINS]
    said = ", ".join(f"{named(grains)}: {one:.2f} d" for grains, one in zip(GRAINS, law, strict=True))
    return [
        comparison(
            "zone", "Angular velocity of the surface over the radius",
            Source(
                "Fenistein & van Hecke 2003, and Fenistein, van de Meent & van Hecke 2004, abstracts: an "
                "error function; as the grains stand higher it widens and moves to the axis",
                Known.READ,
            ),
            Axis("distance from the axis over that of the split"),
            Axis("angular velocity over that of the disc"),
            curves, fits,
            [
                *(
                    misfit(
                        f"largest difference from an error function, {named(grains)}",
                        over_seeds(each("misfit", grains).tolist(), "-"), "-",
                        Band(-math.inf, 0.1, "-", "rings of half a grain, in a sixth of a turn"),
                    )
                    for grains in GRAINS
                ),
                misfit(
                    f"centre, {named(GRAINS[1])} less {named(GRAINS[0])}",
                    over_seeds(more("centre"), "d"), "d",
                    Band(-math.inf, 0.0, "d", "it moves to the axis"),
                ),
                misfit(
                    f"width, {named(GRAINS[1])} less {named(GRAINS[0])}",
                    over_seeds(more("width"), "d"), "d",
                    Band(0.0, math.inf, "d", "it widens"),
                ),
                *(
                    misfit(
                        f"centre, {named(grains)}",
                        over_seeds((each("centre", grains) / D).tolist(), "d"), "d",
                    )
                    for grains in GRAINS
                ),
            ],
            {
                "grains": "5 mm, +- 10 %", "friction": "0.5, also on the walls",
                "disc": "10 d in radius, 0.5 rad/s", "cylinder": "15 d in radius",
                "centre by the power 5/2, from memory": said,
            },
        ),
        comparison(
            "torque", "Torques of the walls and angular momentum of the grains",
            Source("conservation of angular momentum"),
            Axis("height", "d"), Axis("difference over the impulse of the disc"),
            [Curve("grains", np.array([each("height", one).mean() / D for one in GRAINS]),
                   np.array([each("change", one).mean() for one in GRAINS]))], [],
            [
                misfit(
                    "impulse of all walls and change of angular momentum, over the impulse of the disc",
                    over_seeds(np.max([each("change", one) for one in GRAINS], axis=0).tolist(), "-"), "-",
                    Band(-math.inf, 0.01, "-", "frames hold velocities half a step behind"),
                ),
            ],
        ),
    ]  # fmt: skip
