"""Free choices that the paper leaves open, with their levels; a part takes those that touch its claims."""

from ryusa.study import Factor, Plan
from ryusa_studies.osada2004._parts import CLOSURE, DRAG, PARTING, PHI, RATIO, ROTATION, SLIP

STANDARD, FULL = 16, 32  # settings beside the one as shipped: whole blocks of the design


def n_settings(plan: Plan) -> int:
    """Settings beside the one as shipped: the same number for every part of the study."""
    return plan.pick(0, STANDARD, FULL)


def friction_angle(key: str = "contact.friction_angle") -> Factor:
    """Friction angle of grains; the paper never gives it."""
    return Factor(PHI, {"30 deg": {}, **{one: {key: one} for one in ("10 deg", "20 deg", "40 deg")}})


SLIP_RULE = Factor(
    SLIP, {"spring": {}, "spring-drop": {"contact.slip": "spring-drop"}, "total": {"contact.slip": "total"}}
)
PARTING_RULE = Factor(PARTING, {"no tension": {}, "tension": {"contact.parting": "tension"}})
STIFFNESS_RATIO = Factor(RATIO, {"2/7": {}, "15/200": {"contact.shear_ratio": "0.075"}})
# only where the paper does not say it; else a part compares both
ROTATION_FREE = Factor(ROTATION, {"free": {}, "locked": {"motion.rotation": "locked"}})
DRAG_LAW = Factor(
    DRAG,
    {
        "24/Re+0.4": {},
        "24/Re+2": {"water.drag": "24/Re+2"},
        "Schiller-Naumann": {"water.drag": "Schiller-Naumann"},
    },
)
# Eq. (9): where z begins, and the roughness, for the profile that grains do not change
LOG_LAW = Factor(
    CLOSURE,
    {
        "z from d/4 below the crest, k_s = d": {},
        "z from the crest": {"water.zero": "0.2 cm"},
        "z from the centres": {"water.zero": "0.1 cm"},
        "k_s = 2 d": {"water.roughness": "0.4 cm"},
    },
)
