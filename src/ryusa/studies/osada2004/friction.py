"""Where a claim holds as the friction angle, which the paper does not give, is changed."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ryusa.studies.osada2004._parts import PHI, ROTATION

HOLDS, SOME, FAILS, OPEN, NONE = "holds", "holds elsewhere", "fails", "undecided", "not run"
MARKS = {HOLDS: "●", SOME: "◐", FAILS: "○", OPEN: "?", NONE: "·"}  # told apart without colour


@dataclass(frozen=True)
class AngleCell:
    """One claim at one friction angle."""

    word: str = NONE
    n_holds: int = 0  # settings of the other free choices under which it holds
    n: int = 0  # settings tried

    @property
    def mark(self) -> str:
        """Sign that survives grey print."""
        return MARKS[self.word]


@dataclass(frozen=True)
class AngleRow:
    """One claim, with rotation as it says or as it was chosen."""

    claim: str
    rotation: str
    cells: tuple[AngleCell, ...]
    holds: str  # friction angles at which it holds, in words


def by_angle(claims: Sequence[Mapping[str, Any]]) -> tuple[tuple[str, ...], tuple[AngleRow, ...]]:
    """Friction angles tried, and a line per claim and state of rotation that was tried at any.

    Parameters
    ----------
    claims : rows as the JSON file holds them.

    Notes
    -----
    A cell says what became of the claim with every other free choice as the case file ships; where it holds
    only with another choice changed too it says so.
    """
    tried = {
        value for one in claims for trial in one["trials"] if (value := trial["choices"].get(PHI)) is not None
    }
    angles = tuple(sorted(tried, key=degrees))
    lines: list[AngleRow] = []
    for one in claims:
        held = outcomes(one["trials"])
        if any(PHI in dict(key) for key in held):
            lines += _lines(one, held, angles)
    return angles, tuple(lines)


def outcomes(sweep: Sequence[Mapping[str, Any]]) -> dict[tuple[tuple[str, str], ...], str]:
    """What became of a claim under each set of choices: every part of it must hold."""
    parts: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for trial in sweep:
        parts.setdefault(tuple(trial["choices"].items()), []).append(trial["outcome"])
    return {key: FAILS if FAILS in got else OPEN if OPEN in got else HOLDS for key, got in parts.items()}


def _lines(
    claim: Mapping[str, Any], held: Mapping[tuple[tuple[str, str], ...], str], angles: Sequence[str]
) -> list[AngleRow]:
    shipped = dict(next(iter(held)))
    states = list(dict.fromkeys(dict(key).get(ROTATION, "") for key in held))
    lines: list[AngleRow] = []
    for state in states:
        base = {**shipped, ROTATION: state} if state else shipped
        cells: list[AngleCell] = []
        for angle in angles:
            here = [
                (key, word)
                for key, word in held.items()
                if dict(key).get(PHI) == angle and dict(key).get(ROTATION, "") == state
            ]
            cells.append(_cell(here, tuple({**base, PHI: angle}.items())))
        fits = [one for one, cell in zip(angles, cells, strict=True) if cell.word in {HOLDS, SOME}]
        asked = [one for one, cell in zip(angles, cells, strict=True) if cell.n]
        lines.append(AngleRow(claim["id"], state or rotation_of(claim), tuple(cells), ranges(fits, asked)))
    return lines


def _cell(
    here: Sequence[tuple[tuple[tuple[str, str], ...], str]], shipped: tuple[tuple[str, str], ...]
) -> AngleCell:
    n_holds = sum(word == HOLDS for _, word in here)
    if not here:
        return AngleCell()
    word = {key: one for key, one in here}.get(shipped, NONE)
    if word != HOLDS and n_holds:
        word = SOME
    elif word == NONE:
        word = FAILS if all(one == FAILS for _, one in here) else OPEN
    return AngleCell(word, n_holds, len(here))


def rotation_of(claim: Mapping[str, Any]) -> str:
    """Say what the claim itself says of rotation."""
    if (said := claim["settings"].get(ROTATION)) is not None:
        return str(said)
    found = re.search(r"rotation (locked or free|locked|free)", f"{claim['setup']}; {claim['statement']}")
    return "-" if found is None else {"locked or free": "both compared"}.get(found[1], found[1])


def ranges(fits: Sequence[str], tried: Sequence[str]) -> str:
    """Neighbours among the values tried become a range.

    >>> ranges(["20 deg", "30 deg"], ["10 deg", "20 deg", "30 deg", "40 deg"])
    '20 deg to 30 deg'
    """
    if not fits:
        return "nowhere tried"
    order = sorted(tried, key=degrees)
    runs: list[list[str]] = []
    for one in order:
        if one not in fits:
            continue
        before = order.index(one) - 1
        if runs and runs[-1][-1] == order[before]:
            runs[-1].append(one)
        else:
            runs.append([one])
    said = " and ".join(one[0] if len(one) == 1 else f"{one[0]} to {one[-1]}" for one in runs)
    return f"everywhere tried ({said})" if len(fits) == len(order) else said


def degrees(text: str) -> float:
    """Sort key of an angle written as "30 deg"; words come last.

    >>> degrees("30 deg")
    30.0
    """
    try:
        return float(text.split(maxsplit=1)[0])
    except (ValueError, IndexError):
        return float("inf")
