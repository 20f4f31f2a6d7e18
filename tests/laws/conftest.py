"""Every law there is, found by looking, so that a new one is under test the day it is written.

A test that has an argument `law` runs once for each of them.
"""

import importlib
import inspect
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import pytest
from hypothesis import strategies as st

import ryusa.laws
from ryusa.compiled.function import Compiled

TABLES = {"families", "dispatch"}  # they choose among the laws


@dataclass(frozen=True)
class Law:
    """One law and what its signature says."""

    name: str  # module.function
    compiled: Any
    plain: Callable[..., Any]
    arguments: tuple[str, ...]
    kinds: tuple[type, ...]  # float or bool, as annotated

    def __call__(self, *args: Any) -> list[Any]:
        """Answers of the compiled law, always as a list."""
        return flat(self.compiled(*args))

    def draw(self) -> st.SearchStrategy[tuple[Any, ...]]:
        """Positive numbers of ordinary size for its arguments."""
        number = st.floats(0.01, 10.0)
        return st.tuples(*(st.booleans() if kind is bool else number for kind in self.kinds))


def flat(answer: Any) -> list[Any]:
    """An answer as a list of numbers."""
    return list(answer) if isinstance(answer, tuple) else [answer]


def modules() -> list[ModuleType]:
    """The modules of the laws room that hold laws."""
    names = [info.name for info in pkgutil.iter_modules(ryusa.laws.__path__) if not info.name.startswith("_")]
    names = [name for name in names if name not in TABLES]
    return [importlib.import_module(f"ryusa.laws.{name}") for name in sorted(names)]


def census() -> dict[str, Law]:
    """All laws by name."""
    found: dict[str, Law] = {}
    for module in modules():
        for name, thing in vars(module).items():
            if isinstance(thing, Compiled) and thing.py_func.__module__ == module.__name__:
                parameters = inspect.signature(thing.py_func).parameters
                full = f"{module.__name__.rsplit('.', 1)[1]}.{name}"
                kinds = tuple(parameter.annotation for parameter in parameters.values())
                found[full] = Law(full, thing.entry, thing.py_func, tuple(parameters), kinds)
    return found


LAWS = census()


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Give every law to a test that asks for `law`."""
    if "law" in metafunc.fixturenames:
        names = sorted(LAWS)
        metafunc.parametrize("law", [LAWS[name] for name in names], ids=names)


@pytest.fixture(scope="session")
def laws() -> dict[str, Law]:
    """All laws by name."""
    return LAWS
