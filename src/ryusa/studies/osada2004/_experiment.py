"""What an experiment is: the runs it needs, what it measures in each, what follows for the paper's claims."""

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any, Protocol

from matplotlib.figure import Figure

from ryusa.cases import FOLDERS
from ryusa.errors import CaseError
from ryusa.results import Results
from ryusa.study import CaseRun, Level, Plan
from ryusa.study.judge import Finding

__all__ = [
    "NAMES",
    "PHI",
    "RATIO",
    "ROTATION",
    "SLIP",
    "CaseRun",
    "Experiment",
    "Found",
    "Level",
    "Plan",
    "load",
    "paper_run",
]

NAMES = (
    "fig04",
    "fig05",
    "pair",
    "fig07",
    "spin_time",
    "fig08",
    "fig10",
    "steps",
    "fig11",
    "fig12",
    "hops",
    "fig14",
    "fig15",
    "fig16",
    "fig17",
    "fig17_free",
    "fig18",
    "fig19",
    "bed18",
    "fig20",
    "fig21",
    "fig22",
    "eq13",
)

# Free choices that several experiments share; one set of them is sought that fits most claims together.
PHI = "friction angle"
SLIP = "slip rule"
RATIO = "k_s/k_n"
ROTATION = "rotation"  # only where the paper does not say it


def paper_run(case: str, overrides: Mapping[str, str] | None = None, seed: int = 1) -> CaseRun:
    """Name one run.

    Parameters
    ----------
    case : "fig19" is fig19.toml in the folder cases/ beside this file.
    overrides : keys of the case and values as text with units.
    seed : the one seed of all its randomness.
    """
    changed = {**(overrides or {}), "seed": str(seed)}
    return CaseRun(case, tuple(sorted(changed.items())), FOLDERS["paper"])


Found = Mapping[CaseRun, Any]


class Experiment(Protocol):
    """A module that answers one figure or sentence of the paper.

    A module for which a run that breaks down is an answer (a law that makes energy) has one function more:
    `failed(error)` gives what is measured then, or None where this error is no answer. Without an answer such
    a run leaves the experiment undecided.
    """

    FIGURE: str  # how the paper calls it, such as "fig19"
    TITLE: str
    CLAIMS: tuple[str, ...]  # ids of `paper.CLAIMS` that it judges

    def cases(self, plan: Plan) -> Sequence[CaseRun]:
        """Runs it needs; none for a chart of closed forms."""
        ...

    def measure(self, run: Results, one: CaseRun) -> Any:
        """Numbers of one run, small enough to be sent between processes."""
        ...

    def judge(self, found: Found, plan: Plan) -> Sequence[Finding]:
        """Set the paper's sentences against what was measured; one finding per claim."""
        ...

    def rows(self, found: Found, plan: Plan) -> list[dict[str, object]]:
        """Lines of the CSV table."""
        ...

    def draw(self, found: Found, plan: Plan) -> Mapping[str, Figure]:
        """Pictures by name, in the paper's own form."""
        ...


def load(name: str) -> Experiment:
    """Return the experiment of that name (see NAMES)."""
    if name not in NAMES:
        raise CaseError("experiment", name, f"there are {', '.join(NAMES)}")
    module: Any = import_module(f"ryusa.studies.osada2004.{name}")
    return module
