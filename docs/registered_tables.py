"""Tables of bands and texts that were changed after they were registered, with the verdict by each entry."""

from collections.abc import Mapping, Sequence
from typing import Any

from ryusa.study.page import as_shipped, earlier_of, interval
from ryusa.study.registration import NOT_JUDGED, RegisteredClaim
from ryusa.study.study import Study

BANDS = "| row | number | first entry, by it | later entry, by it | what changed |"
TEXTS = "| row | text | changed on | why | verdict by the wording before |"


def changed_bands(study: Study, ledger: Mapping[str, Any]) -> str:
    """Every entry of a band that was replaced and the one in force, with what the kept numbers are by both.

    A row that the ledger has not run is judged by neither.
    """
    lines, run = [BANDS, "|" + "---|" * 5], set[str]()
    for one in ledger["findings"]:
        numbers = {each["part"]: each for each in (*reversed(one["beside"]), *reversed(as_shipped(one)))}
        lines += [_band(one["id"], each, numbers) for each in earlier_of(one)]
        claim = study.registration.of(one["id"]) if study.registration else None
        run |= {claim.id} if claim else set()
    for claim in _claims(study):
        if claim.id not in run:
            lines += [_band(claim.id, each, {}) for each in claim.replaced()]
    return "\n".join(lines)


def changed_texts(study: Study) -> str:
    """Every text that was changed; rows that the same change touched share a line."""
    rows: dict[tuple[str, str, str, str], list[str]] = {}
    for claim in _claims(study):
        for one in claim.changed:
            rows.setdefault((one.text, one.date, one.why, one.effect or NOT_JUDGED), []).append(claim.id)
    return "\n".join([TEXTS, "|" + "---|" * 5, *(_line(", ".join(ids), *row) for row, ids in rows.items())])


def _claims(study: Study) -> Sequence[RegisteredClaim]:
    return [] if study.registration is None else list(study.registration.claims.values())


def _band(row: str, each: Mapping[str, Any], numbers: Mapping[str, Any]) -> str:
    """A line for one entry that was replaced."""
    now = numbers.get(each["part"])
    name = each["part"] if each["number"] == each["part"] else f"{each['part']}; at first: {each['number']}"
    first = _judged(each["limits"], each["date"], numbers.get(each["number"]), each["outcome"])
    last = _judged(each["now"], each["last"], now, now["outcome"] if now else NOT_JUDGED)
    came = f" ({each['came_out']})" if each["came_out"] else ""
    return _line(row, name, first + came, last, each["why"])


def _judged(limits: str, date: str, number: Mapping[str, Any] | None, outcome: str) -> str:
    found = "" if number is None else f"{number['note'] or interval(number)}, "
    return f"{limits} ({date}): {found}{outcome}"


def _line(*cells: str) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
