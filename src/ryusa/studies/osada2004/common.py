"""The one set of free choices that satisfies most claims together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from ryusa.studies.osada2004._parts import PHI, RATIO, ROTATION, SLIP
from ryusa.study import Finding

SHARED = (PHI, SLIP, RATIO, ROTATION)  # choices of the model itself; others belong to one set-up
FIXED = (PHI, SLIP, RATIO)  # said in a finding's settings, they were not varied: other values are untried


@dataclass(frozen=True)
class Common:
    """One set of choices, and the claims that hold, fail, or stay open under it."""

    choices: Mapping[str, str]
    holds: tuple[str, ...]
    fails: tuple[str, ...]
    undecided: tuple[str, ...]
    untried: tuple[str, ...]  # no run was made under this set

    def plain(self) -> dict[str, Any]:
        """Give it as the JSON file holds it."""
        return {
            "choices": dict(self.choices),
            "n_holds": len(self.holds),
            "holds": list(self.holds),
            "fails": list(self.fails),
            "undecided": list(self.undecided),
            "untried": list(self.untried),
        }


def common(findings: Sequence[Finding]) -> tuple[Common, ...]:
    """Every set of the choices that belong to the model, the one under which most claims hold first.

    A choice that belongs to one set-up (a threshold, an impact speed, a time window) is free for its claim:
    the claim holds if it holds for one value of it.
    A claim without contact friction (a head-on drop) counts for every value.

    Parameters
    ----------
    findings : what was found, one per claim.
    """
    shared = _shared(findings)
    values = {
        key: list(dict.fromkeys(v for one in findings for t in one.trials if (v := t.choices.get(key))))
        for key in shared
    }
    sets = [dict(zip(shared, chosen, strict=True)) for chosen in product(*values.values())]
    found = [_under(chosen, findings) for chosen in sets]
    return tuple(sorted(found, key=lambda one: (-len(one.holds), len(one.fails), len(one.untried))))


def _shared(findings: Sequence[Finding]) -> list[str]:
    tried = {key for one in findings for trial in one.trials for key in trial.choices}
    return [key for key in SHARED if key in tried]


def _under(chosen: Mapping[str, str], findings: Sequence[Finding]) -> Common:
    held: dict[str, list[str]] = {"holds": [], "fails": [], "undecided": [], "untried": []}
    for one in findings:
        outcomes = [
            outcome
            for key, outcome in one.by_choice.items()
            if all(chosen.get(name, value) == value for name, value in key)
            and all(chosen.get(name, value) == value for name, value in one.settings.items() if name in FIXED)
        ]
        if one.contradiction:
            word = "fails"
        elif not outcomes:
            word = "untried"
        elif True in outcomes:
            word = "holds"
        else:
            word = "undecided" if None in outcomes else "fails"
        held[word].append(one.id)
    return Common(chosen, *(tuple(held[word]) for word in ("holds", "fails", "undecided", "untried")))
