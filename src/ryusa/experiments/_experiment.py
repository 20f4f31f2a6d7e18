"""What an experiment is: the runs it needs, what it measures in each, what follows for the paper's claims."""

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property, lru_cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from matplotlib.figure import Figure

from ryusa.errors import CaseError
from ryusa.experiments._verdict import Finding
from ryusa.results import Results

if TYPE_CHECKING:
    from ryusa.casefile.schema import Case

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
    "fig19",
    "bed18",
    "fig20",
    "fig21",
    "eq13",
)

# Free choices that several experiments share; one set of them is sought that fits most claims together.
PHI = "friction angle"
SLIP = "slip rule"
RATIO = "k_s/k_n"
ROTATION = "rotation"  # only where the paper does not say it

Value = TypeVar("Value")


class Level(StrEnum):
    """How much is run."""

    QUICK = "quick"  # the case files as they are, one seed: indicative
    STANDARD = "standard"  # three seeds and the sweeps that decide a verdict
    FULL = "full"  # every sweep


@dataclass(frozen=True)
class Plan:
    """What a campaign is to cover."""

    level: Level = Level.STANDARD
    seeds: tuple[int, ...] = (1, 2, 3)

    def pick(self, quick: Value, standard: Value, full: Value | None = None) -> Value:
        """Give the value of this level; the full one takes the standard one where it has none."""
        if self.level is Level.QUICK:
            return quick
        return full if self.level is Level.FULL and full is not None else standard


@dataclass(frozen=True)
class Variant:
    """One run: a case file of `cases/paper/` and what is changed in it. Equal variants are one run."""

    case: str  # "fig19" is cases/paper/fig19.toml
    overrides: tuple[tuple[str, str], ...] = ()  # sorted; keys and values as `ryusa run --set` takes them

    @cached_property
    def folder(self) -> str:
        """Folder of the run below that of all runs: readable, and different for different overrides."""
        said = "-".join(re.sub(r"[^A-Za-z0-9.+]+", "", value) for _, value in self.overrides)
        digest = hashlib.sha256(repr(self.overrides).encode()).hexdigest()[:8]
        return f"{self.case}/{said[:60]}-{digest}" if said else f"{self.case}/as-shipped-{digest}"

    @property
    def label(self) -> str:
        """Words for the progress line."""
        return " ".join((self.case, *(value for _, value in self.overrides)))

    def read(self) -> "Case":
        """Give the checked case."""
        return _read(self)

    def get(self, key: str, default: str = "") -> str:
        """Value of one override as text."""
        return dict(self.overrides).get(key, default)


def variant(case: str, overrides: Mapping[str, str] | None = None, seed: int = 1) -> Variant:
    """Name one run.

    Parameters
    ----------
    case : "fig19" is cases/paper/fig19.toml.
    overrides : keys of the case and values as text with units.
    seed : the one seed of all its randomness.
    """
    changed = {**(overrides or {}), "seed": str(seed)}
    return Variant(case, tuple(sorted(changed.items())))


@lru_cache(maxsize=4096)
def _read(one: Variant) -> "Case":
    from ryusa.casefile.read import read

    return read(case_path(f"paper/{one.case}.toml"), dict(one.overrides))


Found = Mapping[Variant, Any]


class Experiment(Protocol):
    """A module that answers one figure or sentence of the paper.

    A module for which a run that breaks down is an answer (a law that makes energy) has one function more:
    `failed(error)` gives what is measured then, or None where this error is no answer. Without an answer such
    a run leaves the experiment undecided.
    """

    FIGURE: str  # how the paper calls it, such as "fig19"
    TITLE: str
    CLAIMS: tuple[str, ...]  # ids of `paper.CLAIMS` that it judges

    def cases(self, plan: Plan) -> Sequence[Variant]:
        """Runs it needs; none for a chart of closed forms."""
        ...

    def measure(self, run: Results, one: Variant) -> Any:
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
    module: Any = import_module(f"ryusa.experiments.{name}")
    return module


def case_path(name: str) -> Path:
    """Path of a case file that ships with the package, such as "paper/fig19.toml"."""
    return Path(__file__).resolve().parent.parent / "cases" / name
