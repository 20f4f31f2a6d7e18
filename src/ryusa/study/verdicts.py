"""Verdicts of two ledgers of one study: which changed, and which contradict each other."""

from collections.abc import Mapping, Sequence
from typing import Any

from ryusa.errors import ResultsError
from ryusa.study.judge import Outcome

# Outcomes that decide nothing, so that they contradict no other.
OPEN = (Outcome.UNDECIDED, Outcome.SHOWN)


def changed(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[dict[str, str]]:
    """Lines with id, old and new verdict of every finding whose verdict differs; "none" if it is in one only.

    >>> one = {"id": "gas/haff", "outcome": "holds", "verdict": "within"}
    >>> changed({"findings": [one]}, {"findings": [{**one, "outcome": "undecided", "verdict": "undecided"}]})
    [{'id': 'gas/haff', 'old': 'within', 'new': 'undecided'}]
    """
    before, now = _by_id(old), _by_id(new)
    return [
        {"id": name, "old": _verdict(before.get(name)), "new": _verdict(now.get(name))}
        for name in dict.fromkeys([*now, *before])
        if _outcome(before.get(name)) != _outcome(now.get(name))
    ]


def contradictions(one: Mapping[str, Any], other: Mapping[str, Any]) -> list[dict[str, str]]:
    """The changed verdicts that contradict each other: both decided, and different.

    Two ledgers from disjoint seeds have none if the verdicts repeat.
    """
    first, second = _by_id(one), _by_id(other)
    both = {
        name
        for name in first.keys() & second.keys()
        if _outcome(first[name]) not in OPEN and _outcome(second[name]) not in OPEN
    }
    return [line for line in changed(one, other) if line["id"] in both]


def refuse_other_study(old: Mapping[str, Any], study: str) -> None:
    """Compare only ledgers of one study.

    Raises
    ------
    ResultsError : the ledger is of another study.
    """
    if old["study"] != study:
        raise ResultsError(f"the ledger to compare with is of '{old['study']}', not of '{study}'")


def against(old: Mapping[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    """What a ledger keeps of an earlier one that it is compared with."""
    refuse_other_study(old, new["study"])
    made = old["provenance"]
    parts = {one["part"] for one in new["findings"]}  # all, or those that were asked for
    old = {**old, "findings": [one for one in old["findings"] if one["part"] in parts]}
    seeds: Sequence[int] = old["seeds"]
    return {
        "made": made.get("made", ""),
        "commit": made.get("commit") or "",
        "level": old["level"],
        "seeds": list(seeds),
        "changed": changed(old, new),
        "contradictions": [line["id"] for line in contradictions(old, new)],
    }


def _by_id(ledger: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    return {one["id"]: one for one in ledger["findings"]}


def _outcome(finding: Mapping[str, Any] | None) -> str:
    return "" if finding is None else finding["outcome"]


def _verdict(finding: Mapping[str, Any] | None) -> str:
    return "none" if finding is None else finding["verdict"]
