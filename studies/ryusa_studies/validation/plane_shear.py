"""Plane shear at constant pressure: friction over the inertial number."""

from collections.abc import Sequence

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.figures.plane_shear import GLASS_BEADS
from ryusa.laws.dense_flow import mu_of_inertial_number
from ryusa.measure import plane_shear
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampled import SampledRuns, SeedNumbers

TITLE = "Plane shear at constant pressure"
DECLARED = declared(__file__)
SPEEDS = {0.12: 1.4, 0.3: 1.0, 0.8: 0.8}  # of the lid [m/s], and length of a run [s]
CONTROL = 0.12  # speed at which grains without friction are sheared too [m/s]
FRICTION = 0.5  # of the case file


def _changed(speed: float, friction: float) -> dict[str, str]:
    # less stiff than the case: k_n/(P d) of 2500, three quarters of the steps
    return {
        "walls.1.velocity": f'["{speed:g} m/s", "0 m/s", "0 m/s"]',
        "contact.friction": f"{friction:g}", "contact.stiffness": "2500 N/m",
        "stop.time": f"{SPEEDS[speed]:g} s",
    }  # fmt: skip


SMOOTH = "without friction"
RUNS = SampledRuns(
    "plane_shear", "shear_cell.toml",
    {**{one: _changed(one, FRICTION) for one in SPEEDS}, SMOOTH: _changed(CONTROL, 0.0)},
)  # fmt: skip
tasks = RUNS.tasks


def measure(run: Results, one: CaseRun) -> dict[str, float]:
    """Friction, inertial number and concentration [-], and what steady linear shear does not have [-]."""
    del one
    found = plane_shear(run)
    return {
        "mu": found.mu, "inertial": found.inertial, "phi": found["phi"].value,
        "curvature": found.curvature, "unbalanced": abs(found.base + 1.0),
    }  # fmt: skip


@RUNS.judge
def judge(runs: SeedNumbers) -> Sequence[Finding]:
    """Friction beside the law of glass beads, and whether the shear was linear and steady."""

    def over_law(setting: object) -> Floats:
        law = [mu_of_inertial_number(float(one), *GLASS_BEADS) for one in runs("inertial", setting)]
        return runs("mu", setting) / np.array(law)

    speeds = list(SPEEDS)
    inertial = runs.means("inertial", speeds)
    fine = np.geomspace(0.5 * inertial.min(), 2.0 * inertial.max(), 60)
    law = np.array([mu_of_inertial_number(float(one), *GLASS_BEADS) for one in fine])
    return [
        DECLARED["friction"].finding(
            [
                Curve("grains", inertial, runs.means("mu", speeds)),
                Curve("without friction", runs.means("inertial", [SMOOTH]), runs.means("mu", [SMOOTH])),
            ],
            [Curve("glass beads", fine, law)],
            {
                "friction": {f"{speed:g}": over_law(speed) for speed in SPEEDS},
                "control": over_law(SMOOTH),
            },
        ),
        DECLARED["steady"].finding(
            [Curve("grains", inertial, runs.means("phi", speeds))], [],
            {key: np.max([runs(key, one) for one in speeds], axis=0) for key in ("curvature", "unbalanced")},
        ),
    ]  # fmt: skip
