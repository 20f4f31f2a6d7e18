"""The page of a study: its ledger as one self-contained HTML file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ryusa.study.cost import code_in_words
from ryusa.study.html import embedded, is_wide, template, write_page
from ryusa.study.interval import short
from ryusa.study.ledger import Ledger
from ryusa.study.ledger_file import joined, kept_at, write_ledger
from ryusa.study.study import LOOKS, Study, limits_in_words
from ryusa.study.verdict_words import checks, tally

WHOLE_TABLE = 60  # rows; of a longer table the page shows the first HEAD
HEAD = 20
OPEN_SWEEP = 12  # rows; a longer sweep is folded


def write(ledger: Ledger, copy: Path | None = None) -> tuple[Path, ...]:
    """Write page and JSON into the folder of the ledger, and a copy of the JSON to `copy`.

    A ledger of some parts takes the place of these in a `copy` that has others. Each file appears complete or
    not at all.

    Raises
    ------
    OSError : a file cannot be written.
    ResultsError : `copy` exists and is no ledger of this study at this level.
    """
    plain = ledger.plain()
    page = ledger.folder / f"{ledger.stem}.html"
    kept = None if ledger.whole or copy is None else kept_at(copy, ledger.study, plain["level"])
    whole = plain if kept is None else joined(ledger.study, kept, plain)
    files = {ledger.folder / f"{ledger.stem}.json": plain, **({} if copy is None else {copy: whole})}
    for path, content in files.items():  # first, so that the numbers are kept if the page fails
        write_ledger(path, content)
    write_page(page, render(ledger.study, plain, ledger.tables, ledger.folder), ledger.traces)
    return (page, *files)


def render(
    study: Study,
    plain: Mapping[str, Any],
    tables: Mapping[str, Sequence[Mapping[str, object]]],
    folder: Path,
) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    study : the study.
    plain : its ledger as in the JSON file.
    tables : lines of the CSV table, by part.
    folder : folder that the paths of pictures are relative to.
    """
    findings: list[dict[str, Any]] = plain["findings"]
    first: dict[str, str] = {}  # part -> entry whose section holds its table
    for one in findings:
        first.setdefault(one["part"], one["id"])
    sections = [_section(study, one, first, tables, folder) for one in findings]
    page = template(study.template, interval=interval, limits=limits_in_words, asked=study.asked)
    context = {
        "ledger": plain,
        "title": study.title,
        "study": study,
        "findings": sections,
        "parts": [
            (study.part(name).TITLE, [one for one in sections if one["part"] == name]) for name in first
        ],
        "counts": [
            (headline, n, settings, *LOOKS[outcome])
            for outcome, headline, n, settings in tally(findings, study.said)
        ],
        "n_checks": checks(findings),
        "looks": {str(one): look for one, look in LOOKS.items()},
        "words": {str(one): word for one, word in study.words.items()},
        "open_sweep": OPEN_SWEEP,
        **study.context({**plain, "findings": sections}),
    }
    return page.render(context)


def _section(
    study: Study,
    entry: Mapping[str, Any],
    first: Mapping[str, str],
    tables: Mapping[str, Sequence[Mapping[str, object]]],
    folder: Path,
) -> dict[str, Any]:
    """An entry with the additional content of its section."""
    name = entry["part"]
    holder = first[name]
    rows = tables.get(name, ()) if holder == entry["id"] else ()
    base = as_shipped(entry)
    return {
        **entry,
        "said": study.said(entry),
        "checks": checks_of(entry),
        "facts": study.facts(entry),
        "images": [(one, embedded(folder / one)) for one in entry["pictures"] if not is_wide(folder / one)],
        "wide": [(one, embedded(folder / one)) for one in entry["pictures"] if is_wide(folder / one)],
        "hows": list(dict.fromkeys(one["how"] for one in base if one["n"] > 1 or one["choices"])),
        "base": base,
        "read_otherwise": read_otherwise(entry),
        "varied": list(dict.fromkeys(key for one in entry["trials"] for key in one["choices"])),
        "columns": list(dict.fromkeys(key for row in rows for key in row)),
        "rows": list(rows) if len(rows) < WHOLE_TABLE else list(rows[:HEAD]),
        "n_rows": len(rows),
        "file": f"{name}/{name}.csv",
        "holder": holder,
    }


def checks_of(entry: Mapping[str, Any]) -> Mapping[str, str]:
    """Why a number of an entry is a check, by the name of the number; those that decide are not in it."""
    return (entry.get("registered") or {}).get("checks", {})


def earlier_of(entry: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Registered entries that were replaced, with the verdict by each."""
    return (entry.get("registered") or {}).get("earlier", [])


def as_shipped(entry: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Trials of the case file as it ships, by the first reading of its runs."""
    return [one for one in entry["trials"] if one["choices"] == entry["trials"][0]["choices"]]


def read_otherwise(entry: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Judged trials of the case file as it ships, by other readings of its runs than the first."""
    if not entry["trials"]:
        return []
    readings, first = entry["readings"], entry["trials"][0]["choices"]
    return [
        {**one, "choices": {name: one["choices"][name] for name in readings}}
        for one in entry["trials"]
        if one["choices"] != first
        and one["outcome"] != "shown"
        and all(one["choices"][name] == value for name, value in first.items() if name not in readings)
    ]


def interval(found: Mapping[str, Any]) -> str:
    """A number and its interval as text.

    >>> interval({"value": 2.0, "low": 1.0, "high": 3.0, "unit": "m"})
    '2 m (1 to 3)'
    """
    if found["value"] is None:
        return "no number"
    unit = "" if found["unit"] == "-" else f" {found['unit']}"
    middle = f"{short(found['value'])}{unit}"
    low, high = (short(end) if end is not None else "no limit" for end in (found["low"], found["high"]))
    return middle if low == high else f"{middle} ({low} to {high})"


def made_by(plain: Mapping[str, Any]) -> str:
    """Day, commit and number of runs of a ledger, and of each part that was made at another time."""
    made = plain["provenance"]
    parts = "".join(f"; {name}: {_made_by(one)}" for name, one in sorted(made.get("parts", {}).items()))
    return f"{_made_by(made)}{parts}"


def _made_by(made: Mapping[str, Any]) -> str:
    code = f"commit {code_in_words(made['commit'])}" if made.get("commit") else f"ryusa {made['ryusa']}"
    return f"{made['made'][:10]}, {code}, {made['runs_made'] + made['runs_opened']} runs"


def summary(study: Study, plain: Mapping[str, Any]) -> str:
    """Return a Markdown table with one line per number, readable in the repository and in `git diff`.

    For a finding with a sweep it lists the case file as it ships; the sweep is in the ledger itself. Bands
    that were replaced follow, each with its dates and the verdict by it.
    """
    lines = ["| finding | number | value and interval | asked | verdict |", "|---|---|---|---|---|"]
    for one in plain["findings"]:
        rows = [[*_number_cells(study, one, each), ""] for each in as_shipped(one)] or [[""] * 4]
        rows[0][3] = str(study.said(one))
        rows += [[*_earlier_cells(each), f"by it: {each['outcome']}"] for each in earlier_of(one)]
        for k, cells in enumerate(rows):
            row = [one["id"] if k == 0 else "", *cells]
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |")
    return "\n".join(lines)


def _number_cells(study: Study, entry: Mapping[str, Any], trial: Mapping[str, Any]) -> list[str]:
    """Number, its value with interval and note, and what is asked of it."""
    found = interval(trial) + (f", {trial['note']}" if trial["note"] else "")
    why = checks_of(entry).get(trial["part"])
    return [trial["part"], found, study.asked(trial) + (f". A check: {why}" if why else "")]


def _earlier_cells(each: Mapping[str, Any]) -> list[str]:
    """An entry that was replaced: number with dates, what it came out as where no ledger has it, limits."""
    number = f"{each['number']} (as registered on {each['date']}, until {each['replaced']})"
    return [number, each["came_out"], f"{each['limits']}: {each['reason']}"]
