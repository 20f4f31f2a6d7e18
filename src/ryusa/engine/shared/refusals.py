"""What the CPU engine cannot carry, told before anything is stepped."""

import numpy as np

from ryusa.model import Scene
from ryusa.model.enums import Arm, Damping, Rebound, Rolling

_SHORTEST_PERIOD = 3.0  # in diameters: below, a pair could touch through two images


def refusals(scene: Scene) -> tuple[str, ...]:
    """Reasons why the engine cannot carry the scene; () when it can."""
    reasons: list[str] = []
    if scene.rolling.model == Rolling.EPSD and scene.rolling.arm == Arm.CONTACT_WIDTH:
        reasons.append(
            "the spring-dashpot-slider needs rolling.arm = 'reduced radius': its stiffness may not change"
        )
    if scene.water.rebound != Rebound.DRY and scene.contact.damping == Damping.CONSTANTS:
        reasons.append("an immersed rebound needs a restitution in air: contact.damping gives constants")
    largest = float(np.concatenate([scene.d, scene.d_fixed[scene.fixed_active]]).max(initial=0.0))
    for axis, length in zip("xy", scene.period, strict=True):
        if length < _SHORTEST_PERIOD * largest:
            reasons.append(f"the period in {axis} ({length:g} m) is shorter than 3 diameters ({largest:g} m)")
    for k, axis in enumerate("xy"):
        if np.isfinite(scene.period[k]) and np.any(scene.plane_normal[scene.plane_active, k] != 0.0):
            reasons.append(f"a plane stands across the periodic direction {axis}")
    return tuple(reasons)
