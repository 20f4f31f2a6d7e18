"""An older case file in the words of this version, with its comments."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ryusa.casefile.case import SCHEMA
from ryusa.casefile.checks import RIVALS
from ryusa.casefile.overrides import parsed, with_overrides
from ryusa.casefile.read import read_text
from ryusa.casefile.resolved import resolved
from ryusa.errors import CaseError

COMMENTS = r"^(?:[ \t]*(?:#.*)?\r?\n)*"  # and empty lines, from where a search begins
# Values that keys without one had in development versions, where they are others since. The step comes before
# the timing, whose check needs it.
BEFORE = {
    "contact.slip": '"spring"',
    "water.drag": '"24/Re+0.4"',
    "time.steps_per_contact": "50",
    "contact.timing": '"at steps"',
}


@dataclass(frozen=True)
class Upgrade:
    """A case file rewritten.

    Attributes
    ----------
    text : the file; as it was where nothing is to be done.
    written : lines that were put in, by dotted key.
    open : keys that the file leaves out, with the value they had before ryusa 1.
    """

    text: str
    written: dict[str, str]
    open: dict[str, str]


def upgrade(text: str, *, path: Path | None = None, as_before: bool = False) -> Upgrade:
    """Write the schema into a case file of a development version; a file that has one stays as it is.

    Parameters
    ----------
    text : of the case file.
    path : where it is, for the files that it names.
    as_before : also write the values that the file leaves out and that were others before ryusa 1.

    Raises
    ------
    CaseError : the case cannot be read, or a line must be written by hand.
    """
    case, data = read_text(text, path=path), parsed(text)
    if "schema" in data:
        return Upgrade(text, {}, {})
    found = _others_before(text, data, path, resolved(case))
    lines = {"schema": str(SCHEMA)} | (found if as_before else {})
    rewritten = text
    for key, value in lines.items():
        rewritten = _with_line(rewritten, key, value)
    return Upgrade(rewritten, lines, {} if as_before else found)


def _others_before(text: str, data: dict[str, Any], path: Path | None, was: dict[str, Any]) -> dict[str, str]:
    """Keys left out that had another value before, where that changes the resolved case `was`."""
    found: dict[str, str] = {}
    for key, value in BEFORE.items():
        section, leaf = key.split(".")
        rivals = {one for pair in RIVALS[section] if leaf in pair for one in pair}
        if (rivals | {leaf}) & set(data.get(section, ())) or (section == "water" and "water" not in data):
            continue
        try:
            then = resolved(read_text(text, found | {key: value}, path=path))
        except CaseError:  # has no effect here
            continue
        if then != was:
            found[key], was = value, then
    return found


def _with_line(text: str, key: str, value: str) -> str:
    """The text with one key more: at the head of its section, of the file, or in a section at the end.

    Raises
    ------
    CaseError : the section is written in another way, such as { }.
    """
    end = "\r\n" if "\r\n" in text else "\n"
    section, _, leaf = key.rpartition(".")
    line = f"{leaf} = {value}{end}"
    head = rf"^[ \t]*\[[ \t]*{section}[ \t]*\][ \t]*(#.*)?$\r?\n?" if section else COMMENTS
    if place := re.search(head, text, flags=re.MULTILINE):
        before, after = text[: place.end()], text[place.end() :]
    else:
        before, after, line = text, "", f"{end}[{section}]{end}{line}"
    gap = end if before and not before.endswith("\n") else ""
    rewritten = f"{before}{gap}{line}{after}"
    try:
        same = parsed(rewritten) == with_overrides(parsed(text), {key: value})
    except ValueError:
        same = False
    if not same:
        raise CaseError(key, None, f"cannot be put into this file by a program: write {leaf} = {value}")
    return rewritten
