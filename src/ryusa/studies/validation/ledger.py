"""Ours on every reference: from runs to numbers, JSON, and one page that needs nothing but itself."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ryusa.figures import save
from ryusa.figures.comparison import Curve, compared
from ryusa.running import provenance
from ryusa.running.folder import refuse_if_not_writable, write_json
from ryusa.studies.validation import NAMES, Comparison, Error, Word, load
from ryusa.study import Fault, Level, StudyProgress, TaskResults, carry_out, noted
from ryusa.study.html import embedded, template, write_log, write_whole
from ryusa.study.origin import counted, json_number, missing_runs, origin, traces_of

FORMAT = 1  # of the JSON file
DIGITS = 6  # of a curve in the JSON file
MOST = 200  # points of a curve in the JSON file
LOOKS = {
    Word.WITHIN: ("yes", "●"),
    Word.MISSED: ("no", "○"),
    Word.SHOWN: ("waits", "–"),
    Word.UNDECIDED: ("open", "?"),
}


@dataclass(frozen=True)
class Row:
    """One comparison of a check; none where the check could not be judged."""

    check: str
    comparison: Comparison | None
    picture: Path | None = None
    problem: str = ""

    @property
    def id(self) -> str:
        """Name on the page, such as "water-alone/log-rough"."""
        name = self.check.replace("_", "-")
        return name if self.comparison is None else f"{name}/{self.comparison.id}"

    @property
    def word(self) -> Word:
        """The verdict."""
        return Word.UNDECIDED if self.comparison is None else self.comparison.word

    def plain(self, folder: Path) -> dict[str, Any]:
        """Give the row as the JSON file holds it; the picture relative to `folder`."""
        one = self.comparison
        top: dict[str, Any] = {
            "id": self.id,
            "check": self.check,
            "verdict": str(self.word),
            "problem": self.problem,
            "picture": "" if self.picture is None else self.picture.relative_to(folder).as_posix(),
        }
        if one is None:
            none = {key: [] for key in ("errors", "axes", "ours", "references", "beside")}
            words = {key: "" for key in ("source", "known", "said")}
            return {**top, "title": load(self.check).TITLE, **words, **none, "settings": {}}
        return {
            **top,
            "title": one.title,
            "source": one.source.words,
            "known": str(one.source.known),
            "errors": [_error(each) for each in one.errors],
            "settings": dict(one.settings),
            "said": one.said,
            "axes": [str(one.x), str(one.y)],
            "ours": [_line(each) for each in one.ours],
            "references": [_line(each) for each in one.references],
            "beside": [_line(each) for each in one.beside],
        }


@dataclass(frozen=True)
class Validation:
    """All comparisons, how they were made, and where."""

    rows: tuple[Row, ...]
    level: Level
    folder: Path
    problems: Mapping[str, str]  # runs that could not be carried out or measured
    counts: Mapping[str, Any]
    stem: str  # of its files: a quick one, or a part, never replaces the whole
    faults: Mapping[str, str] = field(default_factory=dict[str, str])  # what went wrong after the runs
    traces: Mapping[str, str] = field(default_factory=dict[str, str])

    @property
    def log(self) -> str:
        """Name of the file that holds the tracebacks; empty where there are none."""
        return f"{self.stem}-errors.log" if self.traces else ""

    def plain(self) -> dict[str, Any]:
        """Give it as the JSON file holds it."""
        return {
            "format": FORMAT,
            "level": str(self.level),
            "comparisons": [one.plain(self.folder) for one in self.rows],
            "problems": dict(self.problems),
            "faults": dict(self.faults),
            "errors_in": list(self.traces),
            "log": self.log,
            "provenance": origin(self.counts),
        }


def make(
    names: Sequence[str] | None,
    level: Level,
    folder: Path,
    *,
    jobs: int = 1,
    again: bool = False,
    say: StudyProgress | None = None,
) -> Validation:
    """Compute what is needed, set it against every reference, and draw it.

    Parameters
    ----------
    names : checks, of `NAMES`; None takes all.
    level : quick or full.
    folder : runs go into `folder/runs`, pictures into `folder/pictures`.
    jobs, again, say : as in `campaign.carry_out`.

    Raises
    ------
    KeyboardInterrupt : Ctrl-C; what was finished stays and is opened next time.
    """
    chosen = NAMES if names is None else tuple(dict.fromkeys(names))
    refuse_if_not_writable(folder)
    provenance.commit()  # read now: code that changes meanwhile is not what is running
    faults: dict[str, Fault] = {}
    works: dict[str, Any] = {}
    for name in chosen:
        with noted(faults, f"{name}: its runs"):
            works[name] = load(name).runs(level)
    campaign = carry_out(works, load, folder / "runs", jobs=jobs, again=again, say=say)
    rows = [row for name in chosen for row in _rows(name, campaign, level, folder, faults)]
    stem = "validation" + ("-quick" if level is Level.QUICK else "") + ("" if names is None else "-part")
    said = {what: one.words for what, one in faults.items()}
    return Validation(
        tuple(rows), level, folder, campaign.problems, counted(campaign, jobs), stem, said,
        traces_of(campaign, faults),
    )  # fmt: skip


def _rows(
    name: str, campaign: TaskResults, level: Level, folder: Path, faults: dict[str, Fault]
) -> Sequence[Row]:
    """Comparisons of one check; where a run failed, or comparing ends in an error, one row that says why."""
    asked, judging = f"{name}: its runs", f"{name}: comparing"
    if asked in faults:
        return (Row(name, None, problem=f"its runs could not be named: {faults[asked].words}"),)
    found, missing = campaign.found[name], campaign.missing.get(name, {})
    if missing:
        return (Row(name, None, problem=missing_runs(missing, len(found) + len(missing))),)
    comparisons: Sequence[Comparison] = ()
    with noted(faults, judging):
        comparisons = load(name).compare(found, level)
        for one in comparisons:
            Row(name, one).plain(folder)  # an error in a curve shows here, and not while writing
    if judging in faults:
        return (Row(name, None, problem=f"it could not be judged: {faults[judging].words}"),)
    rows: list[Row] = []
    for one in comparisons:
        drawing = f"{name}: picture of {one.id}"
        picture: Path | None = None
        with noted(faults, drawing, passing=(OSError,)):
            figure = compared(one.x, one.y, one.ours, one.references, one.beside)
            picture = save(figure, folder / "pictures" / f"{name}-{one.id}.png")
        rows.append(Row(name, one, picture, faults[drawing].words if drawing in faults else ""))
    return rows


def write(made: Validation, copy: Path | None = None) -> tuple[Path, ...]:
    """Write page and JSON into the folder, and a copy of the JSON where asked; each file whole.

    Raises
    ------
    OSError, ResultsError : a file cannot be written.
    """
    plain = made.plain()
    page = made.folder / f"{made.stem}.html"
    page.parent.mkdir(parents=True, exist_ok=True)
    files = [page, made.folder / f"{made.stem}.json"]
    if copy is not None:
        copy.parent.mkdir(parents=True, exist_ok=True)
        files.append(copy)
    for path in files[1:]:  # first: whatever becomes of the page, the numbers are kept
        write_json(path, plain)
    write_log(made.folder / f"{made.stem}-errors.log", made.traces)
    write_whole(page, render(plain, made.folder))
    return tuple(files)


def render(plain: Mapping[str, Any], folder: Path) -> str:
    """Make the page from what the JSON file holds; pictures' paths start from `folder`."""
    rows: list[dict[str, Any]] = plain["comparisons"]
    words = Counter(one["verdict"] for one in rows)
    titles = {name: load(name).TITLE for name in dict.fromkeys(one["check"] for one in rows)}
    return template(
        Path(__file__).with_name("page.html"), shown=error_in_words, asked=tolerance_in_words
    ).render(
        ledger=plain,
        command="ryusa validate",
        who="checks",
        counts=[(str(word), words[str(word)], *LOOKS[word]) for word in LOOKS if words[str(word)]],
        looks={str(word): look for word, look in LOOKS.items()},
        checks=[
            (
                title,
                [
                    {**one, "image": embedded(folder / one["picture"]) if one["picture"] else ""}
                    for one in rows
                    if one["check"] == name
                ],
            )
            for name, title in titles.items()
        ],
    )


def error_in_words(one: Mapping[str, Any]) -> str:
    """Say an error of the JSON file: its number with its unit.

    >>> error_in_words({"value": 0.0123456, "unit": "m/s"})
    '0.0123 m/s'
    """
    if one["value"] is None:
        return "no number"
    unit = "" if one["unit"] == "-" else f" {one['unit']}"
    return f"{one['value']:.3g}{unit}"


def tolerance_in_words(one: Mapping[str, Any]) -> str:
    """Say how large an error may be.

    >>> tolerance_in_words({"low": 0.0, "high": 0.02, "why": "half a cell"})
    'at most 0.02'
    >>> tolerance_in_words({"low": 1.9, "high": 2.1, "why": "central differences"})
    '1.9 to 2.1'
    """
    if not one["why"]:
        return "shown only"
    low, high = one["low"], one["high"]
    if high is None:
        return f"at least {low:g}"
    return f"at most {high:g}" if low in (0.0, None) else f"{low:g} to {high:g}"


def table(plain: Mapping[str, Any]) -> str:
    """Lines of the table of docs/validation.md, from what the JSON file holds.

    Of several errors it shows those that miss, or the one that comes nearest to its tolerance.
    """
    lines = ["| comparison | reference | error | may be | verdict |", "|---|---|---|---|---|"]
    for row in plain["comparisons"]:
        told = telling(row["errors"])
        more = len(row["errors"]) - len(told)
        errors = [f"{each['name']}: {error_in_words(each)}" for each in told]
        errors += [f"and {more} more"] if more else []
        asked = [tolerance_in_words(each) for each in told]
        cells = [f"{row['id']}: {row['title']}", row["source"], "<br>".join(errors), "<br>".join(asked)]
        cells.append(row["verdict"])
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


def telling(errors: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Errors of the JSON file that miss; else the one that uses most of its tolerance, or the first.

    >>> small = {"name": "a", "value": 0.1, "low": 0.0, "high": 1.0, "within": True}
    >>> [one["name"] for one in telling([small, {**small, "name": "b", "value": 0.2}])]
    ['b']
    """
    missed = [one for one in errors if one["within"] is False]
    judged = [one for one in errors if one["within"]]
    return missed or sorted(judged, key=_used)[-1:] or list(errors[:1])


def _used(one: Mapping[str, Any]) -> float:
    """Share of its tolerance that an error uses [-]; one without an upper end uses none."""
    low, high = one["low"] or 0.0, one["high"]
    if high is None:
        return 0.0
    return abs(one["value"] - 0.5 * (low + high)) / (0.5 * (high - low)) if low else one["value"] / high


def _error(one: Error) -> dict[str, Any]:
    band = one.tolerance
    return {
        "name": one.name,
        "value": json_number(one.value),
        "unit": one.unit,
        "low": None if band is None else json_number(band.low),
        "high": None if band is None else json_number(band.high),
        "why": "" if band is None else band.why,
        "within": one.within,
    }


def _line(one: Curve) -> dict[str, Any]:
    """A curve with as many points and digits as a reader of the file needs."""
    step = max(1, -(-len(one.x) // MOST))
    return {
        "name": one.name,
        "x": [float(f"{value:.{DIGITS}g}") for value in one.x[::step]],
        "y": [float(f"{value:.{DIGITS}g}") for value in one.y[::step]],
    }
