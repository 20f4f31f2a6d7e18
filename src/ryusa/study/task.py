"""Tasks of a study: runs of case files, and calculations; each is kept in its own folder."""

import hashlib
import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from filecmp import cmp
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

from ryusa.cases import FOLDERS
from ryusa.errors import CaseError, ResultsError, RyusaError
from ryusa.results import Results, schema
from ryusa.running import provenance
from ryusa.running.folder import write_json
from ryusa.spelling import nearest_word

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.facts import Derived
    from ryusa.casefile.wall_time import WallTime

_BEGIN = 0.14  # s to start, open and measure a short run in a process that has compiled its code

_NUMBERS = "numbers.npz"  # of a calculation


@runtime_checkable
class Task(Protocol):
    """One run or calculation, small enough to be sent between processes; equal tasks are carried out once."""

    @property
    def folder(self) -> str:
        """Its folder, relative to that of all tasks."""
        ...

    @property
    def label(self) -> str:
        """Words for the progress line."""
        ...

    def cost(self) -> float:
        """Estimated core seconds, as such runs took on this machine."""
        ...

    def cost_by_rule(self) -> float:
        """Estimated core seconds by the rule of thumb alone: the same on every machine."""
        ...

    def disk(self) -> int:
        """Estimated size [bytes]."""
        ...

    def share(self, folder: Path) -> float | None:
        """Return the share that is done of a task carried out in `folder`; None if it does not tell."""
        ...

    def origin(self, folder: Path) -> dict[str, Any] | None:
        """Provenance of the same task, finished in `folder`; None if there is none."""
        ...

    def open(self, folder: Path) -> Any | None:
        """Return the result finished in `folder`; None if it is missing, of another task, or damaged."""
        ...

    def make(self, folder: Path, *, anew: bool = False) -> Any:
        """Carry out the task, keep it in `folder`, and return the result.

        An interrupt raises KeyboardInterrupt. An interrupted task is continued, or started again if `anew`.
        """
        ...


def _folder(name: str, said: str, changed: object) -> str:
    """Return a readable folder name, different for different settings."""
    words = re.sub(r"[^A-Za-z0-9.+-]+", "", said)[:60] or "as-shipped"
    return f"{name}/{words}-{hashlib.sha256(repr(changed).encode()).hexdigest()[:8]}"


@dataclass(frozen=True)
class CaseRun(Task):
    """One run: a case file and the changes to it. Equal tasks are one run."""

    case: str  # "fig19" is fig19.toml in the folder `cases`
    overrides: tuple[tuple[str, str], ...] = ()  # sorted; keys and values as `ryusa run --set` takes them
    cases: Path = FOLDERS[""]  # folder of the case file

    @property
    def folder(self) -> str:
        """Folder of the run, relative to that of all runs; different for different overrides."""
        said = "-".join(re.sub(r"[^A-Za-z0-9.+]+", "", value) for _, value in self.overrides)
        return _folder(self.case, said, self.overrides)

    @property
    def label(self) -> str:
        """Words for the progress line."""
        return " ".join((self.case, *(value for _, value in self.overrides)))

    def read(self) -> "Case":
        """Read and check the case."""
        own = [self.cases / f"{self.case}.toml"]
        beside = self._beside(_read(self, _stamps(own)))
        return _read(self, _stamps([*own, *beside])) if beside else _read(self, _stamps(own))

    def derive(self) -> "Derived":
        """Derive the numbers of the case."""
        own = self.cases / f"{self.case}.toml"
        return _derived(self, _stamps([own, *self._beside(self.read())]))

    def _beside(self, case: "Case") -> list[Path]:
        """The files that the case names."""
        from ryusa.running.case_files import files_beside

        return list(files_beside(case).values())

    def get(self, key: str, default: str = "") -> str:
        """Value of one override as text."""
        return dict(self.overrides).get(key, default)

    def cost(self) -> float:
        """Estimated core seconds of the run, as runs of its kind took on this machine."""
        return _BEGIN + self.wall_time().stepping

    def cost_by_rule(self) -> float:
        """Estimated core seconds of the run by the rule of thumb."""
        from ryusa.casefile.wall_time import wall_time_by_rule

        any_seed = self._of_any_seed()
        return _BEGIN + wall_time_by_rule(any_seed.read(), any_seed.derive()).stepping

    def wall_time(self) -> "WallTime":
        """Wall time that the run is expected to take on this machine."""
        from ryusa.casefile.wall_time import wall_time

        any_seed = self._of_any_seed()
        return wall_time(any_seed.read(), any_seed.derive())

    def disk(self) -> int:
        """Estimated size of the run [bytes]."""
        from ryusa.casefile.estimate import disk_in_all

        any_seed = self._of_any_seed()
        return disk_in_all(any_seed.read(), any_seed.derive())

    def _of_any_seed(self) -> "CaseRun":
        """The run with the seed of its case file, on which nothing depends that is known before it starts."""
        kept = tuple((key, value) for key, value in self.overrides if key != "seed" or not _is_seed(value))
        return replace(self, overrides=kept)

    def share(self, folder: Path) -> float | None:
        """Return the share of the simulated time, or of the hops, that is recorded; None if nothing is."""
        stop = self.read().stop
        try:
            summary = json.loads((folder / schema.SUMMARY).read_text(encoding="utf-8"))
            share = float(summary["t"]) / stop.time if stop.time is not None else 0.0
            if stop.saltations:
                share = max(share, min(summary["saltations"]) / stop.saltations)
        except (OSError, ValueError, KeyError, TypeError):
            return None
        return min(share, 1.0)

    def origin(self, folder: Path) -> dict[str, Any] | None:
        """Provenance of a finished run of the same case; None if there is none."""
        found = _origin(folder)
        try:
            case = json.loads((folder / schema.CASE_JSON).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return found if found is not None and self._is(case, folder) else None

    def open(self, folder: Path) -> Results | None:
        """Open a finished run of the same case; None if it is missing, damaged, or of another version."""
        if not (folder / schema.CASE_JSON).is_file():
            return None
        try:
            old = Results.open(folder)
        except (RyusaError, OSError):
            return None
        return old if old.complete and self._is(old.case, folder) else None

    def make(self, folder: Path, *, anew: bool = False) -> Results:
        """Run or continue it; a run stopped before its end raises KeyboardInterrupt."""
        from ryusa.running.runner import run

        resume = not anew and _origin(folder) is None  # a complete one could not be opened
        done = run(self.read(), folder, threads=1, progress=False, overwrite=True, resume=resume)
        if not done.complete:
            raise KeyboardInterrupt
        return done

    def _is(self, case: Mapping[str, Any], folder: Path) -> bool:
        """Whether the case in a run folder, with the files that it names, is the case of this run."""
        from ryusa.casefile.resolved import resolved
        from ryusa.running.case_files import files_beside

        now = self.read()
        if case != json.loads(json.dumps(resolved(now))):
            return False
        copies = {folder / name: path for name, path in files_beside(now).items()}
        return all(copy.is_file() and cmp(copy, path, shallow=False) for copy, path in copies.items())


def case_run(path: Path, overrides: Mapping[str, str] | None = None, *, seed: int | None = None) -> CaseRun:
    """Return the task for one run of a case file.

    Parameters
    ----------
    path : case file: `case_path("saltation.toml")` for one of the package, or a file of your own.
    overrides : case keys and their values as text with units, as for `ryusa run --set`.
    seed : seed of all random numbers; None for that of the case file.

    Raises
    ------
    CaseError : there is no such file; the message lists those in its folder.
    """
    if not path.is_file():
        beside = [one.name for one in sorted(path.parent.glob("*.toml"))]
        allowed = f"there is no such file. {path.parent} holds {', '.join(beside) or 'no case file'}"
        raise CaseError("case file", str(path), allowed, nearest_word(path.name, beside))
    changed = {**(overrides or {}), **({} if seed is None else {"seed": str(seed)})}
    return CaseRun(path.stem, tuple(sorted(changed.items())), path.parent)


def _is_seed(value: str) -> bool:
    """Whether a text is a seed that every case takes; of another, reading the case tells what is wrong."""
    return value.isascii() and value.isdecimal() and len(value) <= 18


Stamps = tuple[tuple[int, int], ...]


def _stamps(paths: Iterable[Path]) -> Stamps:
    """Times of the last change [ns] and sizes [bytes] of files; zeros for one that is missing."""
    found = [path.stat() if path.is_file() else None for path in paths]
    return tuple((0, 0) if one is None else (one.st_mtime_ns, one.st_size) for one in found)


@lru_cache(maxsize=4096)
def _read(one: CaseRun, _changed: Stamps) -> "Case":
    from ryusa.casefile.read import read

    return read(one.cases / f"{one.case}.toml", dict(one.overrides))


@lru_cache(maxsize=4096)
def _derived(one: CaseRun, _changed: Stamps) -> "Derived":
    from ryusa.casefile.derive import derive

    return derive(one.read())


Numbers = Mapping[str, Any]  # names to arrays and numbers


@dataclass(frozen=True)
class Calculation(Task):
    """One call of a function that needs no case file; the arrays that it returns are kept.

    The function takes the arguments by name and returns a mapping from names to arrays or numbers.
    """

    module: str  # such as "ryusa_studies.validation.suspension"
    function: str
    arguments: tuple[tuple[str, Any], ...] = ()  # sorted; numbers, words, tuples of them
    seconds: float = 0.1  # estimated core seconds

    @property
    def _module(self) -> str:
        """Module name in kept folders, without its package: results of earlier versions stay valid."""
        return self.module.replace("ryusa.campaigns.", "ryusa.", 1).replace("ryusa_studies.", "ryusa.", 1)

    @property
    def _name(self) -> str:
        return f"{self.module.rsplit('.', 1)[-1]}-{self.function}".replace("_", "-")

    @property
    def folder(self) -> str:
        """Folder of the arrays; readable, and different for different arguments."""
        said = "-".join(f"{value}" for _, value in self.arguments)
        return _folder(self._name, said, (self._module, self.function, self.arguments))

    @property
    def label(self) -> str:
        """Words for the progress line."""
        return " ".join((self._name, *(str(value) for _, value in self.arguments)))

    def cost(self) -> float:
        """Estimated core seconds."""
        return self.seconds

    def cost_by_rule(self) -> float:
        """Estimated core seconds."""
        return self.seconds

    def disk(self) -> int:
        """Size [bytes], small compared with any run."""
        return 20_000

    def share(self, folder: Path) -> float | None:
        """Return None: a calculation does not tell."""
        return None

    def origin(self, folder: Path) -> dict[str, Any] | None:
        """Provenance of the same calculation, finished; None if there is none."""
        found = _origin(folder)
        return found if found is not None and found.get("overrides") == self._said() else None

    def open(self, folder: Path) -> Numbers | None:
        """Open the kept arrays."""
        if self.origin(folder) is None:
            return None
        try:
            with np.load(folder / _NUMBERS, allow_pickle=False) as kept:
                return {name: kept[name] for name in kept.files}
        except (OSError, ValueError, KeyError):
            return None

    def make(self, folder: Path, *, anew: bool = False) -> Numbers:
        """Call the function and keep what it returns."""
        about = provenance.begin(threads=1, seed=None, engine=self._name, overrides=self._said())
        function = getattr(import_module(self.module), self.function)
        found = {name: np.asarray(value) for name, value in function(**dict(self.arguments)).items()}
        if odd := [name for name, value in found.items() if value.dtype.hasobject]:
            raise ResultsError(f"{self.label}: {', '.join(odd)} cannot be kept as an array")
        folder.mkdir(parents=True, exist_ok=True)
        np.savez(folder / _NUMBERS, allow_pickle=False, **found)
        write_json(folder / schema.PROVENANCE, {**about, "status": schema.COMPLETE, "end": provenance.now()})
        return found

    def _said(self) -> dict[str, str]:
        """Function and arguments as stored in the provenance."""
        return {"function": f"{self._module}.{self.function}", **{k: repr(v) for k, v in self.arguments}}


def calculation(function: Any, *, seconds: float = 0.1, **arguments: Any) -> Calculation:
    """Return the task for one call of a function of a module.

    >>> from ryusa.cases import case_path
    >>> calculation(case_path, name="drop.toml").label
    'cases-case-path drop.toml'
    """
    return Calculation(function.__module__, function.__name__, tuple(sorted(arguments.items())), seconds)


def _origin(folder: Path) -> dict[str, Any] | None:
    """Provenance of a finished task; None if there is none."""
    try:
        origin = json.loads((folder / schema.PROVENANCE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return origin if isinstance(origin, dict) and origin.get("status") == schema.COMPLETE else None
