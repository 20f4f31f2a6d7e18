"""What is wrong with [materials.NAME] and [[pairs]]."""

from collections.abc import Iterator

from ryusa.casefile.builders.schema import EmptySection
from ryusa.casefile.builders.table import made_of
from ryusa.casefile.case import Case
from ryusa.casefile.contact.values import adhesion, is_hertz, timing
from ryusa.casefile.grains.schema import OWN_SIZES
from ryusa.casefile.materials.schema import MaterialSection, PairSection
from ryusa.casefile.materials.values import (
    GRAINS,
    OF_ADHESION,
    free_materials,
    keys_of_pairs,
    meeting,
    names_of,
    own_value,
    uses,
    value_of,
)
from ryusa.casefile.section import given
from ryusa.errors import CaseError
from ryusa.laws.families import ContactTiming
from ryusa.spelling import nearest_word

MOST = 100  # materials: their numbers are int8


def check_materials(case: Case) -> Iterator[CaseError]:
    """Find materials that are unknown, unused, or said twice, and pairs that lack a value."""
    if not case.materials:
        for key, name in uses(case):
            if name != GRAINS:
                yield CaseError(key, name, "is no material; there are no [materials.NAME]")
        for k, pair in enumerate(case.pairs):
            yield CaseError(f"pairs.{k}.materials", list(pair.materials), "needs [materials.NAME]")
        return
    known = names_of(case.materials)
    faults = [*_names(case, known), *_keys(case), *_scene(case)]
    yield from faults
    if not faults:
        yield from _missing(case)


def _names(case: Case, known: tuple[str, ...]) -> Iterator[CaseError]:
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


def _keys(case: Case) -> Iterator[CaseError]:
    """Find keys of materials and pairs that contradict each other, or have no effect."""
    sections = [(f"materials.{name}", one) for name, one in case.materials.items()]
    elastic = is_hertz(case.contact)
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
        for name in OF_ADHESION:
            if given(one, name) and name not in adhesion(case.contact).takes:
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
    if case.grains.mixture and made_of(case.build):
        yield CaseError("grains.mixture", None, "excludes build.made_of; give only one of the two")
    if case.grains.mixture and isinstance(case.build, EmptySection):
        yield CaseError("grains.mixture", None, "has no effect with builder 'empty'; give feeds a material")


def _scene(case: Case) -> Iterator[CaseError]:
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


def _missing(case: Case) -> Iterator[CaseError]:
    """Find pairs that meet, whose materials differ in a value that no pair gives."""
    entries = [set(one.materials) for one in case.pairs]
    pairs = meeting(case)
    for a, b in pairs:
        k = entries.index({a, b}) if {a, b} in entries else -1
        for key in keys_of_pairs(case.contact):
            values = [value_of(case, name, key) for name in (a, b)]
            asked = k >= 0 and own_value(case.pairs[k], key) is not None
            if values[0] != values[1] and not asked:
                text = f"missing; {a} has {values[0]:.4g} and {b} {values[1]:.4g}, and no law mixes them"
                text += "" if k >= 0 else f': give [[pairs]] with materials = ["{a}", "{b}"]'
                yield CaseError(f"pairs.{k}.{key}" if k >= 0 else f"pairs ({a}, {b}): {key}", None, text)
    for k, pair in enumerate(case.pairs):
        if not {pair.materials, pair.materials[::-1]} & set(pairs):
            yield CaseError(f"pairs.{k}.materials", list(pair.materials), "has no effect: the two never meet")
