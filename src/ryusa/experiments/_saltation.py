"""What the saltation experiments (fig7, spin-time, hops, fig20, fig21, eq13) share: case and choices."""

from collections.abc import Mapping
from dataclasses import dataclass

from ryusa.experiments._experiment import PHI, RATIO, SLIP, Plan, Variant, variant
from ryusa.measure import Saltation, Tracks, saltation, tracks
from ryusa.results import Results

CASE = "saltation"
HOPS = 30  # of each start, as in the paper
SHIPPED = {PHI: "30 deg", SLIP: "spring", RATIO: "2/7"}
KEYS = {PHI: "contact.friction_angle", SLIP: "contact.slip", RATIO: "contact.shear_ratio"}
VALUES = {"2/7": "0.2857", "15/200": "0.075"}  # ratios as the case file takes them
PHIS = ("10 deg", "15 deg", "20 deg", "25 deg", "30 deg", "35 deg", "40 deg")


@dataclass(frozen=True)
class Hops:
    """Hops of one run, and the path of its first start over a second after settling."""

    found: Saltation
    path: Tracks
    d: float  # [m]


def choices(plan: Plan) -> list[dict[str, str]]:
    """Sets of free choices tried, the shipped one first: one changed at a time; full: a grid."""
    phis = plan.pick(("30 deg",), ("10 deg", "20 deg", "30 deg", "40 deg"), PHIS)
    if plan.level == "full":
        sets = [
            {PHI: phi, SLIP: slip, RATIO: ratio}
            for slip in ("spring", "spring-drop", "total")
            for ratio in ("2/7", "15/200")
            for phi in phis
        ]
    else:
        sets = [{**SHIPPED, PHI: phi} for phi in phis]
        if plan.level == "standard":
            sets += [
                {**SHIPPED, SLIP: "spring-drop"},
                {**SHIPPED, SLIP: "total"},
                {**SHIPPED, RATIO: "15/200"},
            ]
    return [SHIPPED, *(one for one in sets if one != SHIPPED)]


def overrides(chosen: Mapping[str, str]) -> dict[str, str]:
    """Keys of the case that a set of choices changes; none for the shipped one."""
    return {
        KEYS[name]: VALUES.get(value, value)
        for name, value in chosen.items()
        if name in KEYS and SHIPPED[name] != value
    }


def run(
    chosen: Mapping[str, str], rotation: str, seed: int, more: Mapping[str, str] | None = None
) -> Variant:
    """One run of the case under a set of choices."""
    return variant(CASE, {**overrides(chosen), "motion.rotation": rotation, **(more or {})}, seed)


def hops(results: Results) -> Hops:
    """Measure one run."""
    found = saltation(results, hops=HOPS)
    begin = float(found.hops["t_begin"][0]) if len(found.hops) else 0.0
    return Hops(found, tracks(results, [0], begin, begin + 1.0), float(results.scene.d[0]))
