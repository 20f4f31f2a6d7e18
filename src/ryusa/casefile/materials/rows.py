"""What `ryusa check` says of materials and their contacts."""

from ryusa.casefile.case import Case
from ryusa.casefile.contact.values import adhesion, friction, is_hertz, stiffness
from ryusa.casefile.materials.sizes import size_rows
from ryusa.casefile.materials.values import GRAINS, case_of_pair, density, meeting
from ryusa.casefile.rows import ExplainRow, number, word
from ryusa.casefile.section import given

_ADHESION_UNITS = {"pull_off_force": "N", "work_of_adhesion": "J/m2", "adhesion_density": "J/m3"}


def material_rows(case: Case) -> list[ExplainRow]:
    """Contacts of each two materials that meet."""
    rows: list[ExplainRow] = []
    for name in case.materials:
        if given(case.materials[name], "density"):
            rows.append(number("materials", f"density of {name}", density(case, name), "kg/m3", "density"))
    for name in case.materials:
        rows += size_rows(case, name)
    for name, share in case.grains.mixture.items():
        rows.append(
            number("materials", f"share of {name}", share, "-", "grains.mixture, by number, at random")
        )
    if not case.materials:
        return rows
    entries = [set(one.materials) for one in case.pairs]
    for a, b in meeting(case):
        one = case_of_pair(case, a, b)
        origin = f"[materials.{a}]" if a == b else f"the same in {a} and {b}"
        origin = "[contact]" if a == b == GRAINS else origin
        if {a, b} in entries and a != b:
            origin = f"pairs.{entries.index({a, b})}"
        values = f"mu {friction(one.contact):.4g}, e {one.contact.restitution:.4g}"
        if case.rolling.model != "none":
            values += f", rolling {one.rolling.coefficient:.4g}"
        for key in adhesion(case.contact).takes:
            values += f", {key} {getattr(one.contact, key):.4g} {_ADHESION_UNITS[key]}"
        if is_hertz(case.contact):
            e, nu = one.contact.youngs_modulus, one.contact.poisson_ratio
            values += f", E {e:.4g} Pa, nu {nu:.3g} if both were alike"
        else:
            values += f", k_n {stiffness(one)[0]:.4g} N/m"
        rows.append(word("materials", f"{a} on {b}", values, origin))
    return rows
