from collections.abc import Callable
from pathlib import Path

import pytest

from ryusa.casefile import Case, read_text
from ryusa.cases import FOLDERS, case_files

DRY = """
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "locked"
[build]
kind = "drop"
height = "1 cm"
[stop]
time = "0.1 s"
"""


@pytest.fixture
def text() -> str:
    return DRY


@pytest.fixture
def case() -> Callable[..., Case]:
    """Read the small dry case with keys set: `case(**{"contact.stiffness": "1 N/cm"})`."""

    def read(**keys: str) -> Case:
        return read_text(DRY, keys)

    return read


@pytest.fixture
def packaged() -> list[Path]:
    """Every case file of the package: the general ones and those of each study."""
    return [path for folder in FOLDERS for path in case_files(folder).values()]
