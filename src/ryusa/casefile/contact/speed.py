"""Impact speed to be expected in a case: stable range, contact time of elastic spheres, time step."""

import math

from ryusa.casefile.builders.schema import BoxSection, DropSection, FillSection, FlumeSection, PackingSection
from ryusa.casefile.builders.values import room, sizes
from ryusa.casefile.case import Case
from ryusa.casefile.contact.schema import OverlapStiffnessSection
from ryusa.casefile.grains.values import mass
from ryusa.casefile.water.values import terminal_velocity


def expected_speed(case: Case) -> tuple[float, str]:
    """Impact speed for judging the overlap [m/s], and where it comes from."""
    rule, build, g = case.contact.stiffness, case.build, case.motion.gravity
    if case.contact.expected_speed is not None:
        return case.contact.expected_speed, "contact.expected_speed"
    if isinstance(rule, OverlapStiffnessSection):
        return rule.speed, "contact.stiffness.speed"
    d = sizes(case)[0]
    m, m_added, m_weight, _ = mass(case, d)
    settling, buoyant = terminal_velocity(case), m_weight / (m + m_added)
    if isinstance(build, DropSection):
        fall = math.sqrt(build.speed**2 + 2.0 * g * (build.height or 0.0) * buoyant)
        if math.isfinite(settling) and settling < fall:
            return max(settling, build.speed), "settling velocity, which is below the speed of a free fall"
        return fall, "free fall from build.height with build.speed, without drag"
    if isinstance(build, BoxSection):
        height = build.height + build.layers * build.gap * room(case)
        if height > d:
            fastest = math.sqrt(2.0 * g * height * buoyant)
            return min(fastest, settling), "fall of the top layer through the free height below it"
    moved = [(one.velocity, one.surface_velocity) for one in case.walls]
    walls = max((math.hypot(*one) for both in moved for one in both if one is not None), default=0.0)
    if g == 0.0 and walls > 0.0:
        return walls, "speed of the fastest wall; there is no gravity"
    if isinstance(build, PackingSection | FlumeSection | BoxSection | FillSection):
        return math.sqrt(2.0 * g * d), "fall through one diameter, sqrt(2 g d)"
    if math.isfinite(settling):
        return settling, "settling velocity; most impacts of a saltating grain are slower"
    return math.sqrt(2.0 * g * d), "fall through one diameter, sqrt(2 g d)"
