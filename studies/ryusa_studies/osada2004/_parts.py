"""Names of the parts of the study, the free choices that several share, and a run of one of their cases."""

from collections.abc import Mapping

from ryusa.cases import case_path
from ryusa.study import CaseRun, Found, Plan, case_run

__all__ = [
    "CLOSURE", "DRAG", "NAMES", "PACKING", "PARTING", "PHI", "RATIO", "ROTATION", "SLIP", "START", "CaseRun",
    "Found", "Plan", "paper_run",
]  # fmt: skip

NAMES = (
    "fig04", "fig05", "pair", "fig07", "spin_time", "film", "fig08", "fig10", "steps", "fig11", "fig12",
    "fig12_avalanche", "hops", "fig14", "fig15", "fig16", "fig17", "fig17_egashira", "fig17_free",
    "fig18", "long_contacts", "fig19", "bed18", "fig20", "fig21", "fig22", "fig22_free", "eq13",
    "rolling_friction", "rolling_blind", "water_torque", "debris_river",
)  # fmt: skip

# Free choices that several parts share: one name each, so that the page can lay them side by side.
PHI = "friction angle"
SLIP = "slip rule"
RATIO = "k_s/k_n"
ROTATION = "rotation"  # only where the paper does not say it
PARTING = "parting"  # whether the dashpot may pull
DRAG = "C_D"
CLOSURE = "water"  # what Eq. (9) or the column leaves open
PACKING = "packing"  # sizes, bed, depth, and how the grains were laid down
START = "start"  # how grains begin


def paper_run(case: str, overrides: Mapping[str, str] | None = None, seed: int = 1) -> CaseRun:
    """Name one run.

    Parameters
    ----------
    case : "fig19" is fig19.toml in the folder cases/ beside this file.
    overrides : keys of the case and values as text with units.
    seed : the one seed of all its randomness.
    """
    return case_run(case_path(f"paper/{case}.toml"), overrides, seed=seed)
