"""Write the ledger: JSON, and one page that needs nothing but itself."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ryusa.running.folder import write_json
from ryusa.studies.osada2004 import Word, load, short
from ryusa.studies.osada2004.friction import MARKS, by_angle
from ryusa.studies.osada2004.ledger import Ledger
from ryusa.studies.osada2004.paper import CLAIMS
from ryusa.study.html import embedded, is_wide, template, write_log, write_whole

WHOLE_TABLE = 60  # rows; of a longer table the page holds the first HEAD
HEAD = 20
BEST = 5  # sets of common choices shown
OPEN_SWEEP = 12  # rows; a longer sweep is folded
# verdict -> class of its colour, and a sign that survives grey print
LOOKS = {
    Word.REPRODUCED: ("yes", "●"),
    Word.ONLY_IF: ("partly", "◐"),
    Word.NOT: ("no", "○"),
    Word.CONTRADICTS: ("no", "✕"),
    Word.UNDECIDED: ("open", "?"),
    Word.LOST: ("waits", "–"),
}
# What the paper left open, the claims whose runs answer it, and a word in what they tell of it ("" is all).
QUESTIONS = (
    (
        "Rolling friction",
        "rolling-friction",
        "The paper's open question ii: Eq. (13) as a model of rolling friction, its coefficient to be found.",
        ("eq13",),
        "",
    ),
    (
        "Water torque",
        "water-torque",
        "The paper's open question iii: the torque of the water on a spinning grain.",
        ("fig21", "fig20"),
        "torque",
    ),
)


def write(ledger: Ledger, copy: Path | None = None) -> tuple[Path, ...]:
    """Write page and JSON into the folder of the ledger, and a copy of the JSON where asked.

    Each file is written beside its place and moved there whole.

    Raises
    ------
    OSError, ResultsError : a file cannot be written.
    """
    plain = ledger.plain()
    page = ledger.folder / f"{ledger.stem}.html"
    page.parent.mkdir(parents=True, exist_ok=True)
    files = [page, ledger.folder / f"{ledger.stem}.json"]
    if copy is not None:
        copy.parent.mkdir(parents=True, exist_ok=True)
        files.append(copy)
    for path in files[1:]:  # first: whatever becomes of the page, the numbers are kept
        write_json(path, plain)
    write_log(ledger.folder / f"{ledger.stem}-errors.log", ledger.traces)
    write_whole(page, render(plain, ledger.tables, ledger.folder))
    return tuple(files)


def render(
    plain: Mapping[str, Any], tables: Mapping[str, Sequence[Mapping[str, object]]], folder: Path
) -> str:
    """Make the page.

    Parameters
    ----------
    plain : the ledger as the JSON file holds it.
    tables : experiment -> lines of its table.
    folder : what the pictures' paths start from.
    """
    claims: list[dict[str, Any]] = plain["claims"]
    here = {one["id"] for one in claims}
    first: dict[str, str] = {}  # experiment -> claim whose section holds its table
    for one in claims:
        if one["experiment"]:
            first.setdefault(one["experiment"], one["id"])
    angles, lines = by_angle(claims)
    words = Counter(one["verdict"] for one in claims)
    return template(Path(__file__).with_name("page.html"), interval=interval).render(
        ledger=plain,
        command="ryusa paper",
        who="experiments",
        n_claims=len(CLAIMS),
        claims=[_section(one, first, tables, folder) for one in claims],
        counts=[(str(word), words[str(word)], *LOOKS[word]) for word in LOOKS if words[str(word)]],
        looks={str(word): look for word, look in LOOKS.items()},
        common=_best(plain["common_choices"]),
        angles=angles,
        lines=lines,
        marks=MARKS,
        questions=[
            (title, anchor, about, _answers(claims, ids, word))
            for title, anchor, about, ids, word in QUESTIONS
            if any(one in here for one in ids)
        ],
        open_sweep=OPEN_SWEEP,
    )


def _answers(claims: Sequence[Mapping[str, Any]], ids: Sequence[str], word: str) -> list[dict[str, Any]]:
    """Rows of these claims, with what they tell of a question; without the rows that tell nothing of it."""
    rows = {one["id"]: {**one, "told": [said for said in one["also"] if word in said]} for one in claims}
    return [rows[one] for one in ids if one in rows and (not word or rows[one]["told"])]


def _section(
    claim: Mapping[str, Any],
    first: Mapping[str, str],
    tables: Mapping[str, Sequence[Mapping[str, object]]],
    folder: Path,
) -> dict[str, Any]:
    """What the section of one claim shows beside the row itself."""
    name = claim["experiment"]
    holder = first.get(name, claim["id"])
    rows = tables.get(name, ()) if holder == claim["id"] else ()
    return {
        **claim,
        "title": load(name).TITLE if name else "",
        "images": [(one, embedded(folder / one)) for one in claim["pictures"] if not is_wide(folder / one)],
        "wide": [(one, embedded(folder / one)) for one in claim["pictures"] if is_wide(folder / one)],
        "hows": list(dict.fromkeys(one["how"] for one in claim["spread"])),
        "base": [one for one in claim["sweep"] if one["choices"] == claim["sweep"][0]["choices"]],
        "varied": list(dict.fromkeys(key for one in claim["sweep"] for key in one["choices"])),
        "columns": list(dict.fromkeys(key for row in rows for key in row)),
        "rows": list(rows) if len(rows) < WHOLE_TABLE else list(rows[:HEAD]),
        "n_rows": len(rows),
        "file": f"{name}/{name}.csv",
        "holder": holder,
    }


def _best(common: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """The first few sets; empty where no choice is shared."""
    return [one for one in common if one["choices"]][:BEST]


def interval(found: Mapping[str, Any]) -> str:
    """Say a number and its interval in words.

    >>> interval({"value": 2.0, "low": 1.0, "high": 3.0, "unit": "m"})
    '2 m (1 to 3)'
    """
    if found["value"] is None:
        return "no number"
    unit = "" if found["unit"] == "-" else f" {found['unit']}"
    middle = f"{short(found['value'])}{unit}"
    low, high = (short(end) if end is not None else "no limit" for end in (found["low"], found["high"]))
    return middle if low == high else f"{middle} ({low} to {high})"
