"""Bed load over a wide bed, against the profiles that Maurin, Chauchat & Frey 2016 computed."""

import math
from collections.abc import Sequence
from io import StringIO

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.measure import profiles, transport
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Interval, Level, Plan, Task, case_run
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.frey import Measured, Profile, pooled_profile, rms
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "Bed load over a wide bed"
DECLARED = declared(__file__)
D, EXCESS, G = 6.0e-3, 1.5, 9.81  # of the case file [m], [-], [m/s2]
SURFACE = 27.5  # height of the water over the base [d]
LAYER = 1.0 / 12.0  # of our profiles [d]
TOP = 0.3  # concentration at the height from which profiles are counted: the bases are not the same
BELOW = 4.0  # depth from which profiles are compared [d]
SCALE = math.sqrt(EXCESS * G * D**3)


def tasks(plan: Plan) -> Sequence[Task]:
    """Independent runs of the case; none at the quick level."""
    if plan.level is Level.QUICK:
        return []
    sampling = SAMPLING["maurin"]
    time = {"stop.time": f"{sampling.length(plan.level):g} s"}
    return [case_run(case_path("validation/maurin.toml"), time, seed=seed) for seed in sampling.seeds(plan)]


def published() -> Profile:
    """Heights over the base [d], concentration [-] and speed of the beads [m/s]."""
    text = case_path("validation/maurin_2016.csv").read_text(encoding="utf-8")
    table = np.genfromtxt(StringIO(text), delimiter=",", comments="#", skip_header=4)
    return table[:, 0], table[:, 1], table[:, 2]


def rate(z: Floats, phi: Floats, u: Floats) -> float:
    """Transport rate q_star of a profile [-]; z in diameters."""
    return float(np.trapezoid(phi * u, z)) * D / SCALE


def top(z: Floats, phi: Floats) -> float:
    """Height at which the concentration falls below 0.3 for the last time, in the unit of z."""
    last = int(np.flatnonzero(phi >= TOP)[-1])
    return float(np.interp(-TOP, -phi[last : last + 2], z[last : last + 2]))


def measure(run: Results, one: CaseRun) -> dict[str, Floats | float]:
    """Profiles of the beads, their transport rate, and the depth of the water over them."""
    del one
    found = profiles(run, layer=LAYER)
    z, phi = found.z / D, found.phi.value
    carried = transport(run, tau_star=math.nan)
    return {
        "z": z, "phi": phi, "u": np.nan_to_num(found.v_x.value),
        "q_star": float(carried.averages["q"].value) / SCALE,
        "depth": SURFACE - top(z, phi), "time": float(found.t[-1] - found.t[0]),
    }  # fmt: skip


def _from_top(z: Floats, phi: Floats, u: Floats) -> Profile:
    return z - top(z, phi), phi, u


def _pooled(runs: Sequence[Measured]) -> Profile:
    return _from_top(*pooled_profile(runs))


def _rms(runs: Sequence[Measured], column: int) -> Interval:
    """Both counted from the top of the bed."""
    return rms(runs, _from_top(*published()), column, -BELOW, _pooled)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Transport rate, concentration and speed over height."""
    runs: list[Measured] = [found[one] for one in tasks(plan)]
    if not runs:
        return []
    theirs = published()
    q = rate(*theirs)
    z, phi, u = _pooled(runs)
    z_ref, phi_ref, u_ref = _from_top(*theirs)
    window = (z >= -BELOW - 1.0) & (z <= float(z_ref.max()))
    said = {
        "runs": len(runs), "time": float(runs[0]["time"]), "q": q, "depth": SURFACE - top(*theirs[:2]),
    }  # fmt: skip
    return [
        DECLARED["phi"].finding(
            [Curve("ryusa", z[window], phi[window])], [Curve("r2d6s2", z_ref, phi_ref)],
            {
                "q_star": [float(one["q_star"]) / q for one in runs], "rms": _rms(runs, 1),
                "depth": [float(one["depth"]) for one in runs],
            },
            **said,
        ),
        DECLARED["u"].finding(
            [Curve("ryusa", z[window], u[window])], [Curve("r2d6s2", z_ref, u_ref)], {"rms": _rms(runs, 2)},
            **said,
        ),
    ]  # fmt: skip
