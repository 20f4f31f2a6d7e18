"""What an experiment is, and the one function that carries it out."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

from matplotlib.figure import Figure

from ryusa.errors import CaseError, ResultsError
from ryusa.figures import save
from ryusa.measure import write_csv
from ryusa.results import Results

NAMES = ("fig04", "fig06", "fig07", "fig08", "fig11", "fig12", "fig20", "fig21", "free_choices")


@dataclass(frozen=True)
class Variant:
    """One run of an experiment: a case file of `cases/paper/` and what is changed in it."""

    name: str
    case: str
    overrides: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True)
class Verdict:
    """A sentence of the paper, and whether what was found agrees with it."""

    claim: str  # id of the claim, as in paper.py
    says: str
    found: str
    holds: bool | None  # None: not enough to tell

    def row(self) -> dict[str, object]:
        """One line of a CSV table."""
        word = {True: "agrees", False: "disagrees", None: "undecided"}[self.holds]
        return {"claim": self.claim, "says": self.says, "found": self.found, "verdict": word}


class Table(Protocol):
    """What an experiment measured."""

    def rows(self) -> list[dict[str, object]]:
        """Lines of a CSV table."""
        ...


class Experiment(Protocol):
    """A module that answers one figure of the paper."""

    FIGURE: str
    TITLE: str
    SHOWN: tuple[str, ...]  # columns of the table that fit a terminal; none: the chart says it better

    def cases(self) -> Sequence[Variant]:
        """Runs it needs; none for a chart of closed forms."""
        ...

    def measure(self, results: Mapping[str, Results]) -> Any:
        """Turn the runs, by the names of their variants, into a table."""
        ...

    def expect(self, table: Any) -> Sequence[Verdict]:
        """Set the paper's sentences against the table."""
        ...

    def draw(self, table: Any) -> Mapping[str, Figure]:
        """Pictures by name."""
        ...


@dataclass(frozen=True)
class Outcome:
    """What an experiment left behind."""

    folder: Path
    table: Any
    verdicts: tuple[Verdict, ...]
    files: tuple[Path, ...]


def load(name: str) -> Experiment:
    """Return the experiment of that name (see NAMES)."""
    if name not in NAMES:
        raise CaseError("experiment", name, f"there are {', '.join(NAMES)}")
    module: Any = import_module(f"ryusa.experiments.{name}")
    return module


def run_experiment(
    name: str, folder: Path | str, threads: int = 1, *, progress: bool = True, again: bool = False
) -> Outcome:
    """Run the cases of an experiment, measure, draw, and write everything into one folder.

    Parameters
    ----------
    name : one of NAMES.
    folder : runs go into `folder/runs/<variant>`, table, pictures and verdicts into `folder`.
    threads : threads of the engine.
    progress : show a bar while running.
    again : run even what is there already; by default a finished run of the very same case is opened.
    """
    experiment = load(name)
    folder = Path(folder)
    results = {
        one.name: run_variant(one, folder / "runs" / one.name, threads, progress=progress, again=again)
        for one in experiment.cases()
    }
    table = experiment.measure(results)
    verdicts = tuple(experiment.expect(table))
    files = [write_csv(folder / f"{name}.csv", table.rows())]
    if verdicts:
        files.append(write_csv(folder / f"{name}-verdicts.csv", [one.row() for one in verdicts]))
    for picture, figure in experiment.draw(table).items():
        files += [save(figure, folder / f"{picture}.png"), save(figure, folder / f"{picture}.svg")]
    return Outcome(folder, table, verdicts, tuple(files))


def run_variant(
    one: Variant, folder: Path, threads: int = 1, *, progress: bool = True, again: bool = False
) -> Results:
    """Run one variant, or open it where the same case was finished there before."""
    from ryusa.casefile.read import read
    from ryusa.running.runner import run

    case = read(case_path(one.case), dict(one.overrides))
    old = None if again else _earlier(folder)
    if old is not None and old.complete and old.case == json.loads(json.dumps(case.resolved())):
        return old
    done = run(case, folder, threads=threads, progress=progress, overwrite=True)
    if not done.complete:  # a run that was stopped is no basis for a verdict
        raise KeyboardInterrupt
    return done


def _earlier(folder: Path) -> Results | None:
    """Open what lies there; a run that another version wrote or that is damaged counts as none."""
    if not (folder / "case.json").is_file():
        return None
    try:
        return Results.open(folder)
    except ResultsError:
        return None


def case_path(name: str) -> Path:
    """Path of a case file that ships with the package, such as "paper/fig06.toml"."""
    return Path(__file__).resolve().parent.parent / "cases" / name
