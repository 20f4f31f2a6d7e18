"""The choice of each family of laws that is in force in a case, and keys that no choice in force takes."""

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, TypeVar

from ryusa.casefile.case import Case
from ryusa.casefile.contact.values import timing
from ryusa.casefile.row.values import stream, water_alone
from ryusa.casefile.section import Section, given
from ryusa.casefile.shape import has_clumps
from ryusa.errors import CaseError
from ryusa.laws._family import Family
from ryusa.laws.families import (
    FAMILIES,
    Above,
    Arm,
    Cap,
    ContactTiming,
    DragOfForm,
    Mixing,
    Rolling,
    SideWalls,
    Slip,
    Start,
    SurfaceRule,
)

F = TypeVar("F", bound=Family)

# Choices of keys that a case may leave out and that have no fixed default.
_DEFAULTS: dict[type[Family], Callable[[Case], Family]] = {
    ContactTiming: timing,
    Cap: lambda case: Cap.TOTAL if "total" in Slip.of(case.contact.slip).marks else Cap.SPRING,
    Arm: lambda case: (
        Arm.REDUCED_RADIUS if "spring" in Rolling.of(case.rolling.model).marks else Arm.CONTACT_WIDTH
    ),
    # a deposit may lie anywhere in a stream, and the length counts from its top
    Mixing: lambda case: Mixing.LI_SAWAMOTO if stream(case) else Mixing.of(case.column.mixing),
    SurfaceRule: lambda case: SurfaceRule.VOLUME if case.row is not None else SurfaceRule.DEPTH,
    Start: lambda case: (
        Start.REST
        if water_alone(case) or stream(case) or (case.water and case.water.drag == "none")
        else Start.STEADY
    ),
}
_ONLY_IN: dict[type[Family], Callable[[Case], bool]] = {  # cases of some kind
    DragOfForm: lambda case: has_clumps(case.grains) and case.water is not None and case.water.drag != "none"
}
_ONLY_WITH: dict[type[Family], str] = {Above: "depth", SideWalls: "side_walls"}  # another key of the section


def chosen(case: Case, family: type[F]) -> F:
    """The choice that a case makes in a family, or the default where its key is left out."""
    word = getattr(section_of(case, family), _leaf(family))
    default: Any = _DEFAULTS.get(family)
    return default(case) if word is None else family.of(word)


def section_of(case: Case, family: type[Family]) -> Section | None:
    """The section of a case that holds the key of a family; None in a dry case, or without that section."""
    top, *below = family.key.split(".")[:-1]
    if below == ["row"]:
        return case.row
    return case.column if below and case.water is not None else getattr(case, top)


def in_force(case: Case) -> dict[type[Family], Family]:
    """The choice of each family that has an effect in a case, in the order of the table of families."""
    found: dict[type[Family], Family] = {}
    dead: set[str] = set()  # keys without effect, with all below them
    for family in FAMILIES:
        section, other = section_of(case, family), _ONLY_WITH.get(family)
        parts = family.key.split(".")
        if section is None or dead & {".".join(parts[: k + 1]) for k in range(len(parts))}:
            continue
        if family in _ONLY_IN and not _ONLY_IN[family](case):
            continue
        if other is None or getattr(section, other) is not None:
            choice = found[family] = chosen(case, family)
            dead |= {f"{_section(family)}.{key}" for key in family.all_takes() if key not in choice.takes}
    return found


def check_choices(case: Case) -> Iterator[CaseError]:
    """Find keys that have no effect because no choice in force takes them."""
    found = in_force(case)
    reported: set[str] = set()
    for family in FAMILIES:
        section, above = section_of(case, family), _section(family)
        beside = _beside(family)
        if section is None or not any(one in found for one in beside):
            continue
        for key in family.all_takes():
            takers = [one for one in beside if key in one.all_takes()]
            if any(one in found and key in found[one].takes for one in takers):
                continue
            holder = section if key in type(section).model_fields else case.water
            path = f"{above if holder is section else 'water'}.{key}"
            if holder is not None and given(holder, key) and path not in reported:
                reported.add(path)
                value = getattr(holder, key)
                shown = None if isinstance(value, Section) else value
                yield CaseError(path, shown, f"has no effect with {_why(found, takers)}")


def _why(found: dict[type[Family], Family], takers: list[type[Family]]) -> str:
    """The choices that do not take a key, or that leave those families out that would."""
    words = [f"{_leaf(one)} '{found[one].word}'" for one in takers if one in found]
    for one in takers:
        for other, choice in found.items():
            if one not in found and _leaf(one) in other.all_takes() and _section(one) == _section(other):
                words.append(f"{_leaf(other)} '{choice.word}'")
    return " and ".join(words)


@cache
def _beside(family: type[Family]) -> tuple[type[Family], ...]:
    """Families whose keys stand in the section of a family, itself included."""
    return tuple(one for one in FAMILIES if _section(one) == _section(family))


@cache
def _leaf(family: type[Family]) -> str:
    return family.key.rsplit(".", 1)[1]


@cache
def _section(family: type[Family]) -> str:
    return family.key.rsplit(".", 1)[0]
