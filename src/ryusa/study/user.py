"""A study in a folder of the user: FOLDER/study.py, with its case files in the same folder."""

import hashlib
import sys
import traceback
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

from ryusa.errors import ResultsError
from ryusa.spelling import nearest_word
from ryusa.study.study import Study, StudyPart

FILE = "study.py"
NEEDED = {"tasks": "tasks(plan)", "measure": "measure(results, task)"}
HELP = (
    f"A study is a folder with {FILE}: a docstring, tasks(plan) and measure(results, task), and optionally "
    "judge(found, plan), rows(found, plan) and draw(found, plan); see docs/study-of-your-own.md"
)


class UserStudy(Study):
    """The study of one folder, with a single part named after the folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._digest = _digest(folder / FILE)
        self.name = folder.name
        self.title = str(self.part(self.name).TITLE)
        self.command = f"ryusa study {folder.name}"
        self.parts = (self.name,)

    def part(self, name: str) -> StudyPart:
        """Load study.py, once per process.

        Raises
        ------
        ResultsError : it has changed since the study began, so that runs would be measured differently.
        """
        del name
        path = self.folder / FILE
        if not _is_loaded(path) and _digest(path) != self._digest:
            raise ResultsError(
                f"{path}: has changed since the study began. The same command measures all runs with the "
                "changed file"
            )
        module: Any = load_module(path)
        return module


def open_study(folder: Path) -> UserStudy:
    """Open the study of a folder.

    Raises
    ------
    ResultsError : there is no study.py, it cannot be imported, or it lacks a function.
    """
    folder = folder.resolve()
    if folder.name == FILE:
        folder = folder.parent
    if not folder.is_dir():
        raise ResultsError(f"{folder}: there is no such folder. {HELP}")
    if not (folder / FILE).is_file():
        others = ", ".join(sorted(one.name for one in folder.glob("*.py"))) or "no Python file"
        raise ResultsError(f"{folder}: holds {others}, but no {FILE}. {HELP}")
    return UserStudy(folder)


def _is_loaded(path: Path) -> bool:
    """Whether this process has read the file of a study."""
    return _module_name(path) in sys.modules


def _module_name(path: Path) -> str:
    return f"ryusa_study_{hashlib.sha256(str(path).encode()).hexdigest()[:12]}"


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise ResultsError(f"{path}: cannot be read ({error.strerror or error})") from None


def load_module(path: Path) -> ModuleType:
    """Import the file of a study under a unique module name, the same in every process.

    Raises
    ------
    ResultsError : it cannot be imported, or lacks a function that a study needs.
    """
    name = _module_name(path)
    if name in sys.modules:
        return sys.modules[name]
    spec = spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ResultsError(f"{path}: cannot be imported. {HELP}")
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
        _check(path, module)
    except BaseException as error:
        del sys.modules[name]
        if isinstance(error, ResultsError) or not isinstance(error, Exception):
            raise
        raise ResultsError(f"{path}: {_where(error, path)}{type(error).__name__}: {error}") from None
    return module


def _check(path: Path, module: Any) -> None:
    """Refuse a file without the functions that every study needs."""
    for function, how in NEEDED.items():
        if callable(getattr(module, function, None)):
            continue
        own = [one for one, value in vars(module).items() if callable(value) and not one.startswith("_")]
        near = nearest_word(function, own)
        hint = f" Did you mean '{near}' to be '{function}'?" if near else ""
        raise ResultsError(f"{path}: has no function {how}.{hint} {HELP}")
    words = (module.__doc__ or "").strip()
    if not words:
        raise ResultsError(f"{path}: has no docstring; its first line is the title of the page. {HELP}")
    module.TITLE = words.splitlines()[0].rstrip(".")


def _where(error: Exception, path: Path) -> str:
    if isinstance(error, SyntaxError):
        return f"line {error.lineno}: "
    lines = [one.lineno for one in traceback.extract_tb(error.__traceback__) if one.filename == str(path)]
    return f"line {lines[-1]}: " if lines else ""
