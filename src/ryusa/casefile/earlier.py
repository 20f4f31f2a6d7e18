"""Cases of runs made by earlier versions: what keys meant that their version did not have.

A default may change, and a key may be new. A run that is continued keeps what it was made with.
"""

from collections.abc import Mapping
from types import NoneType
from typing import Any

from pydantic import BaseModel

from ryusa.casefile.case import Case

BEFORE = {"contact.timing": "at steps"}  # of keys whose default is not what was done before there was the key


def completed(was: Mapping[str, Any], now: Mapping[str, Any]) -> dict[str, Any]:
    """Give a resolved case with the keys of the present one that it lacks.

    Parameters
    ----------
    was : a case as case.json holds it, written by this version or an earlier one.
    now : the present case in the same form.

    >>> completed({"contact": {"stiffness": 1.0e4}}, {"contact": {"timing": "exact"}})["contact"]["timing"]
    'at steps'
    >>> completed({"record": {"frames": 0.01}}, {"record": {"forces": True}})["record"]["forces"]
    False
    """
    found = dict(was)
    for section, given in was.items():
        field = Case.model_fields.get(section)
        kind = field.annotation if field is not None else None
        if isinstance(given, Mapping) and isinstance(kind, type) and issubclass(kind, BaseModel):
            known = now.get(section) or {}
            lacking = {key: one for key, one in _defaults(section, kind).items() if key in known}
            found[section] = lacking | dict(given)
    return found


def _defaults(section: str, kind: type[BaseModel]) -> dict[str, Any]:
    """Keys of a section that need not be given, as plain data."""
    optional = {name: one for name, one in kind.model_fields.items() if not one.is_required()}
    known = {one.alias or name: one.get_default(call_default_factory=True) for name, one in optional.items()}
    plain = {key: one for key, one in known.items() if isinstance(one, (bool, int, float, str, NoneType))}
    return {key: BEFORE.get(f"{section}.{key}", one) for key, one in plain.items()}


def kept_choices(was: Mapping[str, Any]) -> dict[str, str]:
    """Overrides with which the case file of an earlier run means what it meant then.

    >>> kept_choices({"contact": {"timing": "exact"}}), kept_choices({"contact": {}})
    ({'contact.timing': 'exact'}, {'contact.timing': 'at steps'})
    """
    split = {key: key.split(".") for key in BEFORE}
    return {
        key: str(was[section].get(name, BEFORE[key]))
        for key, (section, name) in split.items()
        if section in was
    }
