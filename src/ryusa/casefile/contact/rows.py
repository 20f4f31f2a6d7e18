"""Rows of `ryusa check` about contacts: stiffness, friction, damping."""

import math

from ryusa.casefile.case import Case
from ryusa.casefile.contact.impact import STABLE
from ryusa.casefile.contact.schema import ContactSection, OverlapStiffnessSection, TimeStiffnessSection
from ryusa.casefile.contact.speed import expected_speed
from ryusa.casefile.contact.values import adhesion, hertz_law, is_hertz, largest_overlap, law_of, parting
from ryusa.casefile.facts import Derived, PairValues
from ryusa.casefile.motion import MotionSection
from ryusa.casefile.rows import ExplainRow, Flag, number, word
from ryusa.laws import collision, hertz
from ryusa.laws.families import Adhesion, Slip
from ryusa.laws.rolling import torque_of_slipping_disc
from ryusa.model.contact_law import attraction_of, pull_off_of, rest_overlap_of, sticking_speed_of

FAR_APART = 1.5  # ratio of tangential to normal half period beyond which e_s is not defined


def contact_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Stiffness and friction."""
    rule, contact = case.contact.stiffness, case.contact
    if is_hertz(case.contact):
        return [*_elastic_rows(case, derived), *_friction_rows(case, derived)]
    origin = "contact.stiffness"
    if isinstance(rule, OverlapStiffnessSection):
        origin += f": overlap {rule.overlap:g} d in an impact at {rule.speed:g} m/s on a fixed grain"
    elif isinstance(rule, TimeStiffnessSection):
        origin += f": Eq. (8) gives {rule.collision_time:g} s on a fixed grain"
    shear = "contact.shear_stiffness"
    if contact.shear_stiffness is None:
        shear = f"{derived.k_s / derived.k_n:.4g} k_n (contact.shear_ratio)"
    return [
        number("contact", "normal stiffness k_n", derived.k_n, "N/cm", origin),
        number("contact", "tangential stiffness k_s", derived.k_s, "N/cm", shear),
        *_moduli_of_springs(case, derived),
        *_friction_rows(case, derived),
    ]


def _friction_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    angle = math.degrees(math.atan(derived.mu))
    rows = [number("contact", "friction mu", derived.mu, "-", f"tan(phi), phi = {angle:.3g} deg")]
    if case.contact.cohesion:
        rows.append(number("contact", "cohesion c", case.contact.cohesion, "N", "contact.cohesion, Eq. (4)"))
    rows.append(_coulomb_row(case.contact, derived))
    rows += _adhesion_rows(case, derived)
    if case.rolling.twisting_coefficient > 0.0:
        speed, radius = expected_speed(case)[0], 0.25 * derived.d
        width = math.sqrt(radius * largest_overlap(case, speed))  # of the contact of two spheres
        slipping = torque_of_slipping_disc(1.0, derived.mu, width) / radius
        origin = (
            f"rolling.twisting_coefficient; a disc that slips all over has {slipping:.3g} at the overlap of "
            f"an impact at {speed:.3g} m/s, 3 pi/16 mu a/R*"
        )
        rows.append(number("contact", "twisting coefficient", case.rolling.twisting_coefficient, "-", origin))
    return rows


def _coulomb_row(contact: ContactSection, derived: Derived) -> ExplainRow:
    """Whether the tangential force of a contact can exceed mu N, and by what."""
    rule, cap = Slip.of(contact.slip), contact.cap
    limit = "c + mu N" if contact.cohesion else "mu N"
    if "total" in rule.marks:
        return word("contact", "Coulomb limit", "holds", f"spring and dashpot together carry at most {limit}")
    beyond = list[str]()
    if derived.fixed.zeta_s > 0.0:
        beyond.append(
            "the tangential dashpot is left out of it until the contact slides"
            if "drop" in rule.marks
            else "the tangential dashpot is not limited: grains creep on slopes steeper than mu and a grain "
            "without friction is turned"
        )
    if cap != "total" and derived.fixed.zeta_n > 0.0:
        beyond.append("N is the force of the spring, which exceeds the whole normal force in unloading")
    if not beyond:
        return word("contact", "Coulomb limit", "holds", f"the spring carries at most {limit}; no dashpot")
    origin = f"with contact.slip '{rule.word}' a contact can carry more than {limit}: {'; '.join(beyond)}"
    return word("contact", "Coulomb limit", "can be exceeded", f"{origin}; 'total' holds it", "note")


def _adhesion_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """What adhesion does to a mean grain on a fixed one."""
    if adhesion(case.contact) is Adhesion.NONE:
        return []
    law, r, pair = law_of(case), 0.25 * derived.d, derived.fixed
    pull, rest, weight = pull_off_of(law, r), rest_overlap_of(law, r), derived.m_weight * derived.g
    stick, deep = sticking_speed_of(law, pair.m, r), rest / derived.d
    at_touch, slope = attraction_of(law, r)
    by_area = "4/27 (pi c R_e)^3/K^2, which falls with the square of Young's modulus; on a fixed grain"
    origin = by_area if slope > 0.0 else f"{adhesion(case.contact).about}; on a fixed grain"
    rows = [number("contact", "pull-off force", pull, "N", origin)]
    if weight > 0.0:
        bond = "pull-off force over the weight of a grain; above 1 a grain hangs from another"
        rows.append(number("contact", "Bond number", pull / weight, "-", bond))
    far: Flag = "warning" if deep > STABLE[1] else ""
    stiffer = "Young's modulus" if is_hertz(case.contact) else "k_n"
    origin = "overlap at which springs carry the attraction alone"
    origin += f"; above {STABLE[1]:g}: take a larger {stiffer}" if far else ""
    rows.append(number("contact", "overlap/d by adhesion", deep, "-", origin, far))
    shear = case.contact.cohesion + derived.mu * (at_touch + slope * rest)
    rows.append(
        number("contact", "shear strength without load", shear, "N", "c + mu times the push by adhesion")
    )
    if math.isinf(stick):
        rows.append(word("contact", "sticking speed", "none", "every head-on impact on a fixed grain sticks"))
    else:
        slower = "head-on impacts on a fixed grain up to this speed stick; faster ones lose more than e says"
        rows.append(number("contact", "sticking speed", stick, "m/s", slower))
    return rows


def _elastic_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Moduli of elastic spheres, and the linear springs that stand for them in one kind of impact."""
    law, pair = hertz_law(case), derived.fixed
    speed, _ = expected_speed(case)
    modulus = hertz.effective_modulus(law.youngs_modulus, law.poisson_ratio)
    shear = hertz.effective_shear_modulus(law.youngs_modulus, law.poisson_ratio)
    alike = collision.stiffness_for_overlap(largest_overlap(case, speed), speed, pair.m, pair.zeta_n)
    impact = f"in an impact at {speed:.3g} m/s on a fixed grain"
    given = "" if "poisson_ratio" in case.contact.model_fields_set else " (contact.poisson_ratio not given)"
    wall = "2 (1 - nu^2)/E of both; fixed grains and walls are of the same material"
    return [
        number("contact", "Young's modulus E", law.youngs_modulus, "Pa", "contact.youngs_modulus"),
        number("contact", "Poisson's ratio nu", law.poisson_ratio, "-", f"contact.poisson_ratio{given}"),
        number("contact", "effective modulus E_e", modulus, "Pa", f"1/E_e = {wall}"),
        number("contact", "effective shear modulus G_e", shear, "Pa", "k_s = 8 G_e a, a the contact radius"),
        number("contact", "k_n of the same contact time", derived.k_n, "N/cm", f"linear spring, {impact}"),
        number("contact", "k_n of the same overlap", alike, "N/cm", f"linear spring, {impact}"),
    ]


def _moduli_of_springs(case: Case, derived: Derived) -> list[ExplainRow]:
    """Young's modulus of the elastic spheres that stand for linear springs in one kind of impact."""
    (speed, _), pair, nu = expected_speed(case), derived.fixed, case.contact.poisson_ratio
    if not 0.0 < speed < math.inf:
        return []
    r, overlap = 0.25 * derived.d, largest_overlap(case, speed)
    alike = {
        "overlap": hertz.stiffness_hertz_for_overlap(overlap, speed, pair.m, pair.zeta_n),
        "contact time": hertz.stiffness_hertz_for_time(pair.t_undamped, speed, pair.m, 0.0, True),
    }
    origin = f"elastic spheres, nu = {nu:g}, in an impact at {speed:.3g} m/s on a fixed grain"
    return [
        number("contact", f"E of the same {what}", hertz.modulus_for_stiffness(stiff, r, nu), "Pa", origin)
        for what, stiff in alike.items()
    ]


def damping_rows(contact: ContactSection, motion: MotionSection, derived: Derived) -> list[ExplainRow]:
    """Dashpots, the restitution they give and the half period of the tangential spring."""
    by_restitution, ends = not math.isnan(derived.e_n), parting(contact)
    normal, shear = "contact.damping, a constant", "contact.shear_damping, a constant"
    if by_restitution:
        normal, shear = "2 zeta sqrt(k_n m_eff) for contact.restitution", "2 zeta_s sqrt(k_s m_t)"
    if is_hertz(contact):
        normal, shear = (
            f"{law}, at the largest overlap at the expected speed"
            for law in ("sqrt(5) zeta sqrt(K m_eff) x^0.25", "2 zeta_s sqrt(k_s m_t)")
        )
    reached = f"contact.restitution, {ends}" if by_restitution else f"from eta_n and m_eff, {ends}"
    reached += "" if adhesion(contact) is Adhesion.NONE else ", less with adhesion"
    differ = not by_restitution and abs(derived.fixed.e - derived.free.e) > 0.02
    rows: list[ExplainRow] = []
    for name, pair in (("on a fixed grain", derived.fixed), ("between free grains", derived.free)):
        rows += [
            number("damping", f"normal dashpot eta_n {name}", pair.eta_n, "N s/cm", normal),
            number("damping", f"tangential dashpot eta_s {name}", pair.eta_s, "N s/cm", shear),
            number("damping", f"restitution e {name}", pair.e, "-", reached, "note" if differ else ""),
        ]
    rows.append(_half_period(contact, motion, "on a fixed grain", derived.fixed))
    if derived.meet:
        rows.append(_half_period(contact, motion, "between free grains", derived.free))
    return rows


def _half_period(contact: ContactSection, motion: MotionSection, name: str, pair: PairValues) -> ExplainRow:
    name = f"tangential half period {name}"
    if math.isinf(pair.t_shear):
        return word("damping", name, "none", "k_s = 0: no tangential spring")
    ratio = pair.t_shear / pair.t_undamped
    origin = f"{ratio:.3g} times the collision time, rotation {motion.rotation}"
    origin += ", at the largest overlap" if is_hertz(contact) else ""
    far: Flag = "" if 1.0 / FAR_APART <= ratio <= FAR_APART else "note"
    origin += "; too different for a tangential restitution" if far else ""
    return number("damping", name, pair.t_shear, "s", origin, far)
