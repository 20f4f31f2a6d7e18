"""[contact] with everything that follows from it, as case.json holds it."""

import math
from typing import Any

from ryusa.casefile.case import Case
from ryusa.casefile.contact.speed import expected_speed
from ryusa.casefile.contact.values import friction, is_hertz, restitution, stiffness, timing


def resolved_contact(case: Case) -> dict[str, Any]:
    """Keys of [contact] in SI, with what follows from others filled in."""
    found: dict[str, Any] = case.contact.model_dump(mode="json", by_alias=True)
    found["timing"] = timing(case).word
    if is_hertz(case.contact):
        found["expected_speed"] = expected_speed(case)[0]
    else:
        k_n, k_s = stiffness(case)
        found |= {"stiffness": k_n, "shear_stiffness": k_s, "shear_ratio": k_s / k_n}
    mu, (e_n, e_s, _, _) = friction(case.contact), restitution(case.contact)
    found |= {"friction": mu, "friction_angle": math.atan(mu)}
    if not math.isnan(e_n):
        found |= {"restitution": e_n, "restitution_shear": e_s}
    return found
