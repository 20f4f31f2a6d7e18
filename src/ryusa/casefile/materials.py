"""[materials.NAME] and [[pairs]]: what grains and walls are made of, and contacts of two materials.

The material "grains" is what [grains], [contact] and [rolling] say; every other one differs from it in the
keys that it gives. A pair of materials is a case of its own, with a [contact] of its own (`case_of_pair`), so
that all that follows from a contact follows for each pair in the same way (design/0020).
"""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from ryusa.casefile.builders.schema import EmptySection
from ryusa.casefile.builders.table import made_of
from ryusa.casefile.builders.values import built_counts, size_range
from ryusa.casefile.contact.values import adhesion, friction, is_hertz, stiffness, timing
from ryusa.casefile.grains import OWN_SIZES, CurvePoints, GrainLength, Spread
from ryusa.casefile.quantities import (
    Density,
    EnergyDensity,
    Force,
    FrictionAngle,
    FrictionCoefficient,
    Number,
    Pressure,
    Stiffness,
    SurfaceEnergy,
)
from ryusa.casefile.section import Section, given
from ryusa.errors import CaseError
from ryusa.laws.families import Adhesion, ContactTiming
from ryusa.laws.materials import poisson_of_two, stiffness_of_two, young_of_two
from ryusa.spelling import nearest_word

if TYPE_CHECKING:
    from ryusa.casefile.case import Case

GRAINS = "grains"  # the material of [grains] and [contact]
MOST = 100  # materials: their numbers are int8
_OF_PAIRS = ("friction", "restitution", "rolling_coefficient")
_OF_ADHESION = Adhesion.all_takes()  # of pairs too, where the case has adhesion


class MaterialSection(Section):
    """A material of grains or walls; what it does not say is as in [grains], [contact] and [rolling]."""

    density: Annotated[Density, Field(ge=1.0, le=1.0e6)] | None = None
    """Density of grains of this material; of walls and fixed grains it means nothing."""
    diameter: GrainLength | None = None
    """Mean diameter of the grains of this material that feeds bring and grains.mixture lays; of walls and
    fixed grains it means nothing."""
    spread: Spread | None = None
    """Spread of their sizes about it, as grains.spread."""
    sieve_curve: CurvePoints | None = None
    """Their sizes by mass, in place of diameter and spread: pairs of diameter and percent finer, from 0 to
    100."""
    stiffness: Annotated[Stiffness, Field(ge=1.0e-9, le=1.0e15)] | None = None
    """Normal stiffness k_n of the linear spring between two grains of this material. Two materials give way
    as springs in series: 2/(1/k_a + 1/k_b)."""
    youngs_modulus: Annotated[Pressure, Field(ge=1.0, le=1.0e15)] | None = None
    """Young's modulus of elastic spheres; two materials combine as Hertz and Mindlin have it."""
    poisson_ratio: Annotated[Number, Field(ge=0, le=0.5)] | None = None
    """Poisson's ratio of elastic spheres."""
    friction_angle: FrictionAngle | None = None
    """Friction angle between two grains of this material."""
    friction: FrictionCoefficient | None = None
    """Friction coefficient between two grains of this material, instead of friction_angle."""
    restitution: Annotated[Number, Field(gt=0, le=1)] | None = None
    """Normal coefficient of restitution between two grains of this material."""
    rolling_coefficient: Annotated[Number, Field(ge=0)] | None = None
    """rolling.coefficient between two grains of this material."""
    pull_off_force: Annotated[Force, Field(ge=0, le=1.0e9)] | None = None
    """contact.pull_off_force between two grains of this material."""
    work_of_adhesion: Annotated[SurfaceEnergy, Field(ge=0, le=1.0e9)] | None = None
    """contact.work_of_adhesion between two grains of this material."""
    adhesion_density: Annotated[EnergyDensity, Field(ge=0, le=1.0e15)] | None = None
    """contact.adhesion_density between two grains of this material."""


class PairSection(Section):
    """Contacts of two different materials.

    No law gives friction, restitution and adhesion of a pair from those of its two materials: where these
    differ, they have to be given here.
    """

    materials: tuple[str, str]
    """Names of the two; "grains" is the material of [grains] and [contact]."""
    friction_angle: FrictionAngle | None = None
    """Friction angle of the pair."""
    friction: FrictionCoefficient | None = None
    """Friction coefficient of the pair, instead of friction_angle."""
    restitution: Annotated[Number, Field(gt=0, le=1)] | None = None
    """Normal coefficient of restitution of the pair."""
    rolling_coefficient: Annotated[Number, Field(ge=0)] | None = None
    """rolling.coefficient of the pair."""
    pull_off_force: Annotated[Force, Field(ge=0, le=1.0e9)] | None = None
    """contact.pull_off_force of the pair."""
    work_of_adhesion: Annotated[SurfaceEnergy, Field(ge=0, le=1.0e9)] | None = None
    """contact.work_of_adhesion of the pair."""
    adhesion_density: Annotated[EnergyDensity, Field(ge=0, le=1.0e15)] | None = None
    """contact.adhesion_density of the pair."""


def names_of(case: "Case") -> tuple[str, ...]:
    """Materials of a case in the order of their numbers, "grains" first."""
    return (GRAINS, *case.materials)


def uses(case: "Case") -> Iterator[tuple[str, str]]:
    """Every key of the case that names a material, with that name."""
    if case.grains.bed_material is not None:
        yield "grains.bed_material", case.grains.bed_material
    for name in case.grains.mixture:
        yield f"grains.mixture.{name}", name
    for group, name in made_of(case).items():
        yield f"build.made_of.{group}", name
    for key in ("feeds", "planes", "walls"):
        for k, one in enumerate(getattr(case, key)):
            if one.material is not None:
                yield f"{key}.{k}.material", one.material


def free_materials(case: "Case") -> set[str]:
    """Materials of which there are free grains."""
    free = {feed.material or GRAINS for feed in case.feeds} | set(case.grains.mixture)
    free |= set(made_of(case).values())
    if not isinstance(case.build, EmptySection) and sum(case.grains.mixture.values()) < 1.0 - 1e-9:
        free.add(GRAINS)
    return free or {GRAINS}


def meeting(case: "Case") -> dict[tuple[str, str], bool]:
    """Pairs of materials that can meet, in the order of their numbers, and whether as two free grains."""
    order, free = names_of(case), free_materials(case)
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


def case_of_pair(case: "Case", a: str, b: str) -> "Case":
    """A case of one material, whose contacts are those of two materials.

    Its density is such that two equal grains have the effective mass of one of each, with added mass.
    """
    if not case.materials:
        return case
    contact = case.contact
    k_a, k_b = _stiffness(case, a), _stiffness(case, b)
    e_a, e_b = _young(case, a), _young(case, b)
    nu_a, nu_b = _poisson(case, a), _poisson(case, b)
    values = {key: _of_pair(case, a, b, key) for key in _keys_of_pairs(case)}
    changed: dict[str, Any] = {
        "friction": values["friction"], "friction_angle": None, "restitution": values["restitution"],
        **{key: values[key] for key in adhesion(case).takes},
    }  # fmt: skip
    if is_hertz(case):
        changed["youngs_modulus"] = young_of_two(e_a, nu_a, e_b, nu_b)
        changed["poisson_ratio"] = poisson_of_two(e_a, nu_a, e_b, nu_b)
    else:
        changed["stiffness"] = stiffness_of_two(k_a, k_b)
    added = 0.0 if case.water is None else case.water.density * case.water.added_mass
    heavy_a, heavy_b = density(case, a) + added, density(case, b) + added
    mean = density(case, a) if heavy_a == heavy_b else 2.0 * heavy_a * heavy_b / (heavy_a + heavy_b) - added
    return case.model_copy(
        update={
            "contact": contact.model_copy(update=changed),
            "rolling": case.rolling.model_copy(update={"coefficient": values["rolling_coefficient"]}),
            "grains": case.grains.model_copy(update={"density": mean, "mixture": {}, "bed_material": None}),
            "materials": {},
            "pairs": (),
        }
    )


def _keys_of_pairs(case: "Case") -> tuple[str, ...]:
    """Keys that belong to a pair and not to its materials."""
    return (*_OF_PAIRS, *adhesion(case).takes)


def lightest_of(case: "Case", a: str, b: str, free: bool) -> "Case":
    """The case of a pair with the density of its lighter grain, where only one of the two is free."""
    made = case_of_pair(case, a, b)
    if free or not case.materials:
        return made
    least = min(density(case, a), density(case, b))
    return made.model_copy(update={"grains": made.grains.model_copy(update={"density": least})})


def smallest_of(case: "Case", a: str, b: str) -> float:
    """Diameter of the smallest free grain in contacts of two materials [m]."""
    free = free_materials(case)
    names = [None if name == GRAINS else name for name in {a, b} if name in free]
    return min(size_range(case, name)[0] for name in names)


def of_material(case: "Case", name: str | None) -> "Case":
    """A case all of one material."""
    return case if name is None else case_of_pair(case, name, name)


def density(case: "Case", name: str) -> float:
    """Density of a material [kg/m3]."""
    own = case.materials[name].density if name != GRAINS else None
    return case.grains.density if own is None else own


def _stiffness(case: "Case", name: str) -> float:
    own = case.materials[name].stiffness if name != GRAINS else None
    if own is not None or is_hertz(case):
        return own or math.nan
    return stiffness(case)[0]


def _young(case: "Case", name: str) -> float:
    own = case.materials[name].youngs_modulus if name != GRAINS else None
    return own or case.contact.youngs_modulus or math.nan


def _poisson(case: "Case", name: str) -> float:
    own = case.materials[name].poisson_ratio if name != GRAINS else None
    return case.contact.poisson_ratio if own is None else own


def _own(case: "Case", section: MaterialSection | PairSection, key: str) -> float | None:
    """Value that a material or a pair gives itself."""
    if key == "friction" and section.friction_angle is not None:
        return math.tan(section.friction_angle)
    value: float | None = getattr(section, key)
    return value


def _of_material(case: "Case", name: str, key: str) -> float:
    """Value of a contact of a material with itself."""
    own = _own(case, case.materials[name], key) if name != GRAINS else None
    if own is not None:
        return own
    if key == "friction":
        return friction(case)
    if key in _OF_ADHESION:
        value: float | None = getattr(case.contact, key)
        return value or 0.0
    return case.rolling.coefficient if key == "rolling_coefficient" else case.contact.restitution or math.nan


def _of_pair(case: "Case", a: str, b: str, key: str) -> float:
    """Value of a contact of two materials; that of the first where nobody asks for it."""
    if a != b:
        for one in case.pairs:
            own = _own(case, one, key) if set(one.materials) == {a, b} else None
            if own is not None:
                return own
    return _of_material(case, a, key)


def check_materials(case: "Case") -> Iterator[CaseError]:
    """Find materials that are unknown, unused, or said twice, and pairs that lack a value."""
    if not case.materials:
        for key, name in uses(case):
            if name != GRAINS:
                yield CaseError(key, name, "is no material; there are no [materials.NAME]")
        for k, pair in enumerate(case.pairs):
            yield CaseError(f"pairs.{k}.materials", list(pair.materials), "needs [materials.NAME]")
        return
    known = names_of(case)
    faults = [*_names(case, known), *_keys(case), *_scene(case)]
    yield from faults
    if not faults:
        yield from _missing(case)


def _names(case: "Case", known: tuple[str, ...]) -> Iterator[CaseError]:
    listed, said = ", ".join(known), [name for _, name in uses(case)]
    if GRAINS in case.materials:
        yield CaseError(
            f"materials.{GRAINS}", None, "is what [grains], [contact] and [rolling] say; leave it out"
        )
    if len(known) > MOST:
        yield CaseError("materials", None, f"has {len(case.materials)} entries; at most {MOST - 1}")
    for key, name in uses(case):
        if name not in known:
            yield CaseError(key, name, f"must be a material: {listed}", nearest_word(name, known))
    seen: list[set[str]] = []
    for k, pair in enumerate(case.pairs):
        key, both = f"pairs.{k}.materials", set(pair.materials)
        for name in pair.materials:
            if name not in known:
                yield CaseError(key, name, f"must be two materials of: {listed}", nearest_word(name, known))
        if len(both) == 1:
            where = "[contact] and [rolling]" if GRAINS in both else f"[materials.{pair.materials[0]}]"
            yield CaseError(key, list(pair.materials), f"is one material: give its contacts in {where}")
        elif both in seen:
            yield CaseError(key, list(pair.materials), f"is given twice, also in pairs.{seen.index(both)}")
        seen.append(both)
    for name in case.materials:
        if name not in said and name != GRAINS:
            where = (
                "grains.mixture, build.made_of, grains.bed_material, or material of feeds, planes and walls"
            )
            yield CaseError(f"materials.{name}", None, f"is never used; give it in {where}")


def _keys(case: "Case") -> Iterator[CaseError]:
    """Find keys of materials and pairs that contradict each other, or have no effect."""
    elastic, sections = is_hertz(case), [(f"materials.{name}", one) for name, one in case.materials.items()]
    every: list[tuple[str, MaterialSection | PairSection]] = [*sections]
    every += [(f"pairs.{k}", one) for k, one in enumerate(case.pairs)]
    for key, one in every:
        if given(one, "friction") and given(one, "friction_angle"):
            yield CaseError(
                f"{key}.friction", None, f"excludes {key}.friction_angle; give only one of the two"
            )
        if given(one, "rolling_coefficient") and case.rolling.model == "none":
            value = one.rolling_coefficient
            yield CaseError(f"{key}.rolling_coefficient", value, "has no effect with rolling.model = 'none'")
        for name in _OF_ADHESION:
            if given(one, name) and name not in adhesion(case).takes:
                yield CaseError(
                    f"{key}.{name}", getattr(one, name),
                    f"has no effect with contact.adhesion = '{case.contact.adhesion}'",
                )  # fmt: skip
    law = case.contact.law
    for key, one in sections:
        for name in ("youngs_modulus", "poisson_ratio") if not elastic else ("stiffness",):
            if given(one, name):
                yield CaseError(
                    f"{key}.{name}", getattr(one, name), f"has no effect with contact.law '{law}'"
                )
        at_steps = timing(case) is not ContactTiming.EXACT
        if given(one, "stiffness") and not elastic and at_steps:
            yield CaseError(
                f"{key}.stiffness", one.stiffness,
                "needs contact.timing = 'exact': linear springs that begin and end at steps are all alike",
            )  # fmt: skip
    free = free_materials(case)
    for key, one in sections:
        for name in ("density", *OWN_SIZES):
            if given(one, name) and key.partition(".")[2] not in free:
                value = getattr(one, name) if name in {"density", "diameter"} else None
                yield CaseError(f"{key}.{name}", value, "has no effect: no free grain is of this material")
    shares = sum(case.grains.mixture.values())
    if shares > 1.0 + 1e-9:
        yield CaseError("grains.mixture", None, f"has shares that sum to {shares:g}, more than 1")
    if case.grains.mixture and made_of(case):
        yield CaseError("grains.mixture", None, "excludes build.made_of; give only one of the two")
    if case.grains.mixture and isinstance(case.build, EmptySection):
        yield CaseError("grains.mixture", None, "has no effect with builder 'empty'; give feeds a material")


def _scene(case: "Case") -> Iterator[CaseError]:
    """Find what materials cannot be used with."""
    if case.contact.restitution is None:
        yield CaseError("contact.damping", None, "cannot be used with [materials]: give contact.restitution")
    for k, entry in enumerate(case.timeline):
        for key in ("friction", "friction_angle"):
            if getattr(entry, key) is not None:
                yield CaseError(
                    f"timeline.{k}.{key}", getattr(entry, key),
                    "cannot be used with [materials], whose pairs have a friction each",
                )  # fmt: skip
    if case.water is not None and case.water.profile == "column":
        for name, one in case.materials.items():
            if one.density is not None:
                yield CaseError(
                    f"materials.{name}.density", one.density,
                    "cannot be used with a column of water, whose grains have one density",
                )  # fmt: skip


def _missing(case: "Case") -> Iterator[CaseError]:
    """Find pairs that meet, whose materials differ in a value that no pair gives."""
    entries = [set(one.materials) for one in case.pairs]
    pairs = meeting(case)
    for a, b in pairs:
        k = entries.index({a, b}) if {a, b} in entries else -1
        for key in _keys_of_pairs(case):
            values = [_of_material(case, name, key) for name in (a, b)]
            asked = k >= 0 and _own(case, case.pairs[k], key) is not None
            if values[0] != values[1] and not asked:
                text = f"missing; {a} has {values[0]:.4g} and {b} {values[1]:.4g}, and no law mixes them"
                text += "" if k >= 0 else f': give [[pairs]] with materials = ["{a}", "{b}"]'
                yield CaseError(f"pairs.{k}.{key}" if k >= 0 else f"pairs ({a}, {b}): {key}", None, text)
    for k, pair in enumerate(case.pairs):
        if not {pair.materials, pair.materials[::-1]} & set(pairs):
            yield CaseError(f"pairs.{k}.materials", list(pair.materials), "has no effect: the two never meet")
