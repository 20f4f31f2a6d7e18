"""The one set of free choices that satisfies most claims together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from ryusa.experiments import Finding


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


def common(findings: Sequence[tuple[str, Finding]]) -> tuple[Common, ...]:
    """Every set of the choices that several experiments share, the one under which most claims hold first.

    A choice that one experiment alone makes (a threshold, an impact speed) is free for its claim: the claim
    holds if it holds for one value of it. A claim that does not depend on a choice counts for every value.

    Parameters
    ----------
    findings : name of the experiment and what it found, one pair per claim.
    """
    shared = _shared(findings)
    values = {
        key: list(dict.fromkeys(v for _, one in findings for t in one.trials if (v := t.choices.get(key))))
        for key in shared
    }
    sets = [dict(zip(shared, chosen, strict=True)) for chosen in product(*values.values())]
    found = [_under(chosen, [one for _, one in findings]) for chosen in sets]
    return tuple(sorted(found, key=lambda one: (-len(one.holds), len(one.fails), len(one.untried))))


def _shared(findings: Sequence[tuple[str, Finding]]) -> list[str]:
    users: dict[str, set[str]] = {}
    for experiment, one in findings:
        for trial in one.trials:
            for key in trial.choices:
                users.setdefault(key, set()).add(experiment)
    return [key for key, who in users.items() if len(who) > 1]


def _under(chosen: Mapping[str, str], findings: Sequence[Finding]) -> Common:
    held: dict[str, list[str]] = {"holds": [], "fails": [], "undecided": [], "untried": []}
    for one in findings:
        outcomes = [
            outcome
            for key, outcome in one.by_choice.items()
            if all(chosen.get(name, value) == value for name, value in key)
        ]
        if one.contradiction:
            word = "fails"
        elif not outcomes:
            word = "untried"
        elif True in outcomes:
            word = "holds"
        else:
            word = "undecided" if None in outcomes else "fails"
        held[word].append(one.claim)
    return Common(chosen, *(tuple(held[word]) for word in ("holds", "fails", "undecided", "untried")))
