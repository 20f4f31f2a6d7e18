"""Rows of `ryusa check` about contacts: stiffness, friction, damping."""

import math
from typing import TYPE_CHECKING

from ryusa.casefile.contact.schema import OverlapStiffnessSection, TimeStiffnessSection
from ryusa.casefile.contact.values import PairValues
from ryusa.casefile.rows import ExplainRow, Flag, number, word

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.derive import Derived

FAR_APART = 1.5  # ratio of tangential to normal half period beyond which e_s is not defined


def contact_rows(case: "Case", derived: "Derived") -> list[ExplainRow]:
    """Stiffness and friction."""
    rule, contact = case.contact.stiffness, case.contact
    origin = "contact.stiffness"
    if isinstance(rule, OverlapStiffnessSection):
        origin += f": overlap {rule.overlap:g} d in an impact at {rule.speed:g} m/s on a fixed grain"
    elif isinstance(rule, TimeStiffnessSection):
        origin += f": Eq. (8) gives {rule.collision_time:g} s on a fixed grain"
    shear = "contact.shear_stiffness"
    if contact.shear_stiffness is None:
        shear = f"{derived.k_s / derived.k_n:.4g} k_n (contact.shear_ratio)"
    angle = math.degrees(math.atan(derived.mu))
    rows = [
        number("contact", "normal stiffness k_n", derived.k_n, "N/cm", origin),
        number("contact", "tangential stiffness k_s", derived.k_s, "N/cm", shear),
        number("contact", "friction mu", derived.mu, "-", f"tan(phi), phi = {angle:.3g} deg"),
    ]
    if contact.cohesion:
        rows.append(number("contact", "cohesion c", contact.cohesion, "N", "contact.cohesion, Eq. (4)"))
    return rows


def damping_rows(case: "Case", derived: "Derived") -> list[ExplainRow]:
    """Dashpots, the restitution they give and the half period of the tangential spring."""
    by_restitution, parting = not math.isnan(derived.e_n), case.contact.parting
    normal, shear = "contact.damping, a constant", "contact.shear_damping, a constant"
    if by_restitution:
        normal, shear = "2 zeta sqrt(k_n m_eff) for contact.restitution", "2 zeta_s sqrt(k_s m_t)"
    reached = f"contact.restitution, {parting}" if by_restitution else f"from eta_n and m_eff, {parting}"
    differ = not by_restitution and abs(derived.fixed.e - derived.free.e) > 0.02
    rows: list[ExplainRow] = []
    for name, pair in (("on a fixed grain", derived.fixed), ("between free grains", derived.free)):
        rows += [
            number("damping", f"normal dashpot eta_n {name}", pair.eta_n, "N s/cm", normal),
            number("damping", f"tangential dashpot eta_s {name}", pair.eta_s, "N s/cm", shear),
            number("damping", f"restitution e {name}", pair.e, "-", reached, "note" if differ else ""),
        ]
    rows.append(_half_period(case, "on a fixed grain", derived.fixed))
    if derived.meet:
        rows.append(_half_period(case, "between free grains", derived.free))
    return rows


def _half_period(case: "Case", name: str, pair: PairValues) -> ExplainRow:
    name = f"tangential half period {name}"
    if math.isinf(pair.t_shear):
        return word("damping", name, "none", "k_s = 0: no tangential spring")
    ratio = pair.t_shear / pair.t_undamped
    origin = f"{ratio:.3g} times the collision time, rotation {case.motion.rotation}"
    far: Flag = "" if 1.0 / FAR_APART <= ratio <= FAR_APART else "note"
    origin += "; too different for a tangential restitution" if far else ""
    return number("damping", name, pair.t_shear, "s", origin, far)
