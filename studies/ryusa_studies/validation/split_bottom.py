"""A split-bottom shear cell: the zone at the surface is an error function that follows the height."""

from collections.abc import Sequence

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.laws.dense_flow import split_bottom_centre
from ryusa.measure import shear_zone
from ryusa.measure.shear_zone import zone
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampled import SampledRuns, SeedNumbers

TITLE = "Split-bottom shear cell"
DECLARED = declared(__file__)
GRAINS = (2000, 3900)  # in the cell: some 2.6 and 5 diameters high
R_S, D = 0.05, 0.005  # radius of the disc and diameter of the case file [m]


RUNS = SampledRuns("split_bottom", "split_bottom.toml", {one: {"build.most": f"{one}"} for one in GRAINS})
tasks = RUNS.tasks


def measure(run: Results, one: CaseRun) -> dict[str, Floats | float]:
    """Zone at the surface [m], [-], what the fit and the balance of torques lack [-], and the profile."""
    del one
    found = shear_zone(run)
    return {
        "centre": found.centre, "width": found.width, "share": found.share, "height": found.height,
        "misfit": found.misfit, "change": found.change, "r": found.r, "turning": found.turning.value,
    }  # fmt: skip


@RUNS.judge
def judge(runs: SeedNumbers) -> Sequence[Finding]:
    """Form of the profile, and how its centre and its width change with the height of the grains."""
    low, high = GRAINS

    def more(key: str) -> Floats:
        return (runs(key, high) - runs(key, low)) / D

    def named(grains: int) -> str:
        return f"{runs('height', grains).mean() / D:.1f} d high"

    curves, fits = [list[Curve](), list[Curve]()]
    for grains, of_seeds in runs.of.items():
        first = of_seeds[0]
        r = np.asarray(first["r"])
        curves.append(Curve(named(grains), r / R_S, np.asarray(first["turning"])))
        fit = zone(r, float(first["centre"]), float(first["width"]), float(first["share"]))
        fits.append(Curve(named(grains), r / R_S, fit))
    law = [split_bottom_centre(R_S, float(runs("height", grains).mean())) / D for grains in GRAINS]
    said = ", ".join(f"{named(grains)}: {one:.2f} d" for grains, one in zip(GRAINS, law, strict=True))
    return [
        DECLARED["zone"].finding(
            curves, fits,
            {
                "form": {named(grains): runs("misfit", grains) for grains in GRAINS},
                "centre": more("centre"), "width": more("width"),
                "at": {named(grains): runs("centre", grains) / D for grains in GRAINS},
            },
            law=said, high=named(high), low=named(low),
        ),
        DECLARED["torque"].finding(
            [Curve("grains", runs.means("height", GRAINS) / D, runs.means("change", GRAINS))], [],
            {"change": np.max([runs("change", one) for one in GRAINS], axis=0)},
        ),
    ]  # fmt: skip
