"""From the complaints of pydantic to errors that name key, value, what is allowed and the nearest key."""

import re
from collections.abc import Sequence
from typing import Any

from pydantic import ValidationError

from ryusa.casefile.keys import builders, builders_with, description_at, dotted, item, keys_at, nearest_key
from ryusa.casefile.motion import too_steep
from ryusa.errors import CaseError
from ryusa.spelling import nearest_word
from ryusa.units import limit_as_typed, si_unit

_LONGEST_VALUE = 80
_MESSAGES = {
    "float_type": "must be a number, without quotes",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "bool_parsing": "must be true or false",
    "string_type": "must be text in quotes",
    "finite_number": "must be finite",
    "tuple_type": "must be a list in [ ]",
    "model_type": "must be a table of keys",
    "model_attributes_type": "must be a table of keys",
    "too_short": "has too few entries",
    "too_long": "has too many entries",
    "string_too_short": "must not be empty",
    "string_too_long": "is too long",
}
_LIMITS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}
_ELASTIC = (
    "unknown key; elastic spheres take contact.law = 'Hertz-Mindlin' with youngs_modulus and poisson_ratio, "
    "linear springs take contact.stiffness; see 'Normal force' and 'Elastic spheres' in docs/theory.md"
)
_LID = (
    "unknown key; a lid, a jack or a piston is one of [[walls]] with a servo, such as servo = "
    "{ direction = [0, 0, -1], pressure = '500 Pa', max_speed = '5 cm/s' }; see docs/lids.md"
)
_LIDS = {
    "lid",
    "lids",
    "jack",
    "jacks",
    "piston",
    "pistons",
    "press",
    "servo",
    "shear_box",
    "confining_pressure",
}
_AVERAGES = ("stop", "precision")  # the table whose keys are names of averages
_OTHER_CONTACT_LAWS = {
    *("young", "young_modulus", "elastic_modulus", "shear_modulus", "youngs", "e"),
    *("poisson", "poissons_ratio", "nu", "model", "hertz", "normal", "tangential"),
}


def faults(error: ValidationError, data: dict[str, Any]) -> list[CaseError]:
    """One `CaseError` per complaint; `data` is what the file held."""
    return [_fault(dict(one), data) for one in error.errors(include_url=False)]


def _fault(one: dict[str, Any], data: dict[str, Any]) -> CaseError:
    path = _plain(one["loc"])
    kind, context = one["type"], one.get("ctx", {})
    value = _value(data, path)
    if kind == "extra_forbidden":
        return _unknown_key((*_plain(one["loc"][:-1]), one["loc"][-1]), data)  # a key may look like a branch
    if kind == "missing" and isinstance(path[-1], int) and isinstance(short := _value(data, path[:-1]), list):
        such = f" such as {short[0]!r}" if short else ""
        allowed = f"needs {path[-1] + 1} entries{such}, and has {len(short)}: the last is missing"
        return CaseError(dotted(path[:-1]), short, allowed)
    if kind == "tuple_type" and isinstance(_item(data, path), dict):
        return CaseError(dotted(path), None, f"must be in double brackets, [[{dotted(path)}]], once for each")
    if kind == "missing":
        return CaseError(dotted(path), None, _missing(path, data))
    if kind in {"union_tag_invalid", "union_tag_not_found"}:
        value, names = _value(data, (*path, "kind")), list(builders())
        missing = "missing; " if value is None else ""
        allowed = f"{missing}must be one of {', '.join(names)}"
        return CaseError(dotted((*path, "kind")), value, allowed, nearest_word(value, names))
    if kind == "literal_error":
        words = str(context["expected"]).replace(" or ", ", ").split(", ")
        names = [word.strip().strip("'") for word in words]
        allowed = f"must be one of {', '.join(map(repr, names))}"
        return CaseError(dotted(path), value, allowed, nearest_word(value, names))
    if kind == "value_error":
        return CaseError(dotted(path), value, str(context.get("error", one["msg"])))
    if kind in _LIMITS and path[-1] == "slope" and isinstance(value, int | float):
        return too_steep(dotted(path), value)
    if kind in _LIMITS:
        words, side = _LIMITS[kind]
        limit = limit_as_typed(value, context[side], least=side in {"gt", "ge"})
        return CaseError(dotted(path), value, f"must be {words} {limit}")
    allowed = _MESSAGES.get(kind, str(one["msg"])).format(**context)
    return CaseError(dotted(path), value, allowed)


def as_typed(fault: CaseError, data: dict[str, Any]) -> CaseError:
    """The fault of a check, with value and lengths, speeds and so on in the words of the file.

    Checks know SI numbers. The value becomes what the file holds, and quantities of its kind in the message
    take its unit: of "2 mm", "at least 0.004 m" becomes "at least 4 mm".
    """
    path = [int(part) if part.isdecimal() else part for part in fault.key.split(".")]
    typed = _value(data, path)
    if fault.value is None or isinstance(fault.value, str) or not isinstance(typed, str | list):
        return fault
    first = typed if isinstance(typed, str) else str(next(iter(typed), ""))
    allowed, unit = fault.allowed, si_unit(first)

    def in_its_unit(found: re.Match[str]) -> str:
        least = re.search("at least|above|greater", allowed[: found.start()]) is not None
        numbers = [limit_as_typed(first, float(one), least=least) for one in found.groups() if one]
        return " to ".join([*(one.split(" ", 1)[0] for one in numbers[:-1]), numbers[-1]])

    if unit:
        number = r"([-+]?[0-9]+\.?[0-9]*(?:e[-+]?[0-9]+)?)"
        allowed = re.sub(
            rf"(?<![\w.]){number}(?: to {number})? {re.escape(unit)}(?![\w/])", in_its_unit, allowed
        )
    return CaseError(fault.key, typed, allowed, fault.nearest)


def _unknown_key(path: tuple[str | int, ...], data: dict[str, Any]) -> CaseError:
    """Unknown key, with the nearest one, the builder that has it, or why there is none."""
    name = str(path[-1])
    if path[0] == "contact" and name.lower() in _OTHER_CONTACT_LAWS:
        return CaseError(dotted(path), None, _ELASTIC)
    if name.lower() in _LIDS and path[0] not in ("walls", "build"):
        return CaseError(dotted(path), None, _LID)
    if path[0] == "build" and len(path) == 2 and (others := builders_with(name)):
        kind = _value(data, ("build", "kind"))
        words = " and ".join(f"'{other}'" for other in others)
        return CaseError(dotted(path), None, f"unknown key; builder '{kind}' has none, {words} has")
    allowed = f"; must be one of {', '.join(keys_at(path[:-1], data))}" if path[:-1] == _AVERAGES else ""
    return CaseError(dotted(path), None, f"unknown key{allowed}", nearest_key(path, data))


def _plain(loc: Sequence[str | int]) -> tuple[str | int, ...]:
    """Drop the names of union branches, which are no keys."""
    parts = [part for part in loc if not (isinstance(part, str) and part.startswith("<"))]
    if len(parts) > 1 and parts[0] == "build" and parts[1] in builders():
        del parts[1]
    return tuple(parts)


def _item(data: Any, path: Sequence[str | int]) -> Any:
    for part in path:
        data = item(data, part)
    return data


def _value(data: Any, path: Sequence[str | int]) -> Any:
    data = _item(data, path)
    try:
        return None if isinstance(data, dict) or len(repr(data)) > _LONGEST_VALUE else data
    except ValueError:  # a whole number of thousands of digits
        return None


def _missing(path: Sequence[str | int], data: dict[str, Any]) -> str:
    about = description_at(path, data)
    return f"missing; {about[0].lower()}{about[1:].rstrip('.')}" if about else "missing"
