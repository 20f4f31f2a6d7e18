"""[materials.NAME] and [[pairs]]: what grains and walls are made of, and contacts of two materials.

The material "grains" is what [grains], [contact] and [rolling] say; every other one differs from it in the
keys that it gives. A pair of materials is a case of its own, with a [contact] of its own (`case_of_pair`), so
that all that follows from a contact follows for each pair in the same way (design/0020).
"""

import math
from collections.abc import Iterator
from typing import Any

from ryusa.casefile.builders.schema import EmptySection
from ryusa.casefile.builders.table import made_of
from ryusa.casefile.builders.values import built_counts, size_range
from ryusa.casefile.case import Case
from ryusa.casefile.contact.schema import ContactSection
from ryusa.casefile.contact.values import adhesion, friction, is_hertz, stiffness
from ryusa.casefile.materials.schema import MaterialSection, PairSection
from ryusa.laws.families import Adhesion
from ryusa.laws.materials import poisson_of_two, stiffness_of_two, young_of_two

GRAINS = "grains"  # the material of [grains] and [contact]
OF_ADHESION = Adhesion.all_takes()  # keys of pairs where the case has adhesion
# Keys that belong to a pair and not to its materials: section and name of the one that holds for "grains".
OF_PAIRS = {
    "friction": ("contact", "friction"),
    "restitution": ("contact", "restitution"),
    "rolling_coefficient": ("rolling", "coefficient"),
    **{key: ("contact", key) for key in OF_ADHESION},
}
SAID_ALSO = {"friction": ("friction", "friction_angle")}  # keys that give one of them


def names_of(materials: dict[str, MaterialSection]) -> tuple[str, ...]:
    """Materials of a case in the order of their numbers, "grains" first."""
    return (GRAINS, *materials)


def uses(case: Case) -> Iterator[tuple[str, str]]:
    """Every key of the case that names a material, with that name."""
    if case.grains.bed_material is not None:
        yield "grains.bed_material", case.grains.bed_material
    for name in case.grains.mixture:
        yield f"grains.mixture.{name}", name
    for group, name in made_of(case.build).items():
        yield f"build.made_of.{group}", name
    for key in ("feeds", "planes", "walls"):
        for k, one in enumerate(getattr(case, key)):
            if one.material is not None:
                yield f"{key}.{k}.material", one.material


def free_materials(case: Case) -> set[str]:
    """Materials of which there are free grains."""
    free = {feed.material or GRAINS for feed in case.feeds} | set(case.grains.mixture)
    free |= set(made_of(case.build).values())
    if not isinstance(case.build, EmptySection) and sum(case.grains.mixture.values()) < 1.0 - 1e-9:
        free.add(GRAINS)
    return free or {GRAINS}


def meeting(case: Case) -> dict[tuple[str, str], bool]:
    """Pairs of materials that can meet, in the order of their numbers, and whether as two free grains."""
    order, free = names_of(case.materials), free_materials(case)
    bed = {case.grains.bed_material or GRAINS}
    bed |= {one.material or GRAINS for one in (*case.planes, *case.walls)}
    meet = bool(case.feeds) or built_counts(case)[2]
    found: dict[tuple[str, str], bool] = {}
    for k, a in enumerate(order):
        for b in order[k:]:
            both = meet and a in free and b in free
            if both or (a in free and b in bed) or (b in free and a in bed):
                found[a, b] = both
    return found


def case_of_pair(case: Case, a: str, b: str) -> Case:
    """A case of one material, whose contacts are those of two materials.

    Its density is such that two equal grains have the effective mass of one of each, with added mass.
    """
    if not case.materials:
        return case
    k_a, k_b = _stiffness(case, a), _stiffness(case, b)
    e_a, e_b = _young(case.contact, case.materials, a), _young(case.contact, case.materials, b)
    nu_a, nu_b = _poisson(case.contact, case.materials, a), _poisson(case.contact, case.materials, b)
    changed: dict[str, dict[str, Any]] = {"contact": {"friction_angle": None}, "rolling": {}}
    for key in keys_of_pairs(case.contact):
        section, name = OF_PAIRS[key]
        changed[section][name] = _of_pair(case, a, b, key)
    if is_hertz(case.contact):
        changed["contact"]["youngs_modulus"] = young_of_two(e_a, nu_a, e_b, nu_b)
        changed["contact"]["poisson_ratio"] = poisson_of_two(e_a, nu_a, e_b, nu_b)
    else:
        changed["contact"]["stiffness"] = stiffness_of_two(k_a, k_b)
    added = 0.0 if case.water is None else case.water.density * case.water.added_mass
    heavy_a, heavy_b = density(case, a) + added, density(case, b) + added
    mean = density(case, a) if heavy_a == heavy_b else 2.0 * heavy_a * heavy_b / (heavy_a + heavy_b) - added
    return case.model_copy(
        update={
            "contact": case.contact.model_copy(update=changed["contact"]),
            "rolling": case.rolling.model_copy(update=changed["rolling"]),
            "grains": case.grains.model_copy(update={"density": mean, "mixture": {}, "bed_material": None}),
            "materials": {},
            "pairs": (),
        }
    )


def keys_of_pairs(contact: ContactSection) -> tuple[str, ...]:
    """Those of `OF_PAIRS` that act in a case."""
    return tuple(key for key in OF_PAIRS if key not in OF_ADHESION or key in adhesion(contact).takes)


def lightest_of(case: Case, a: str, b: str, free: bool) -> Case:
    """The case of a pair with the density of its lighter grain, where only one of the two is free."""
    made = case_of_pair(case, a, b)
    if free or not case.materials:
        return made
    least = min(density(case, a), density(case, b))
    return made.model_copy(update={"grains": made.grains.model_copy(update={"density": least})})


def smallest_of(case: Case, a: str, b: str) -> float:
    """Diameter of the smallest free grain in contacts of two materials [m]."""
    free = free_materials(case)
    names = [None if name == GRAINS else name for name in {a, b} if name in free]
    return min(size_range(case, name)[0] for name in names)


def of_material(case: Case, name: str | None) -> Case:
    """A case all of one material."""
    return case if name is None else case_of_pair(case, name, name)


def density(case: Case, name: str) -> float:
    """Density of a material [kg/m3]."""
    own = case.materials[name].density if name != GRAINS else None
    return case.grains.density if own is None else own


def _stiffness(case: Case, name: str) -> float:
    own = case.materials[name].stiffness if name != GRAINS else None
    if own is not None or is_hertz(case.contact):
        return own or math.nan
    return stiffness(case)[0]


def _young(contact: ContactSection, materials: dict[str, MaterialSection], name: str) -> float:
    own = materials[name].youngs_modulus if name != GRAINS else None
    return own or contact.youngs_modulus or math.nan


def _poisson(contact: ContactSection, materials: dict[str, MaterialSection], name: str) -> float:
    own = materials[name].poisson_ratio if name != GRAINS else None
    return contact.poisson_ratio if own is None else own


def own_value(section: MaterialSection | PairSection, key: str) -> float | None:
    """Value that a material or a pair gives itself."""
    if key == "friction" and section.friction_angle is not None:
        return math.tan(section.friction_angle)
    value: float | None = getattr(section, key)
    return value


def value_of(case: Case, name: str, key: str) -> float:
    """Value of a contact of a material with itself."""
    own = own_value(case.materials[name], key) if name != GRAINS else None
    if own is not None:
        return own
    if key == "friction":
        return friction(case.contact)
    section, leaf = OF_PAIRS[key]
    value: float | None = getattr(getattr(case, section), leaf)
    return value or (math.nan if key == "restitution" else 0.0)


def _of_pair(case: Case, a: str, b: str, key: str) -> float:
    """Value of a contact of two materials; that of the first where nobody asks for it."""
    if a != b:
        for one in case.pairs:
            own = own_value(one, key) if set(one.materials) == {a, b} else None
            if own is not None:
                return own
    return value_of(case, a, key)
