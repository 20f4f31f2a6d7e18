"""The kinds of run that the fault campaign kills, small enough to be made many times: `cases/`."""

from collections.abc import Mapping
from pathlib import Path

from ryusa import Case
from ryusa.casefile.read import read

FOLDER = Path(__file__).parent / "cases"
KINDS = {path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.toml"))}
MESHES = {path.name: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.obj"))}


def case_of(kind: str, overrides: Mapping[str, str] | None = None) -> Case:
    """The case of a kind, beside the files that it names."""
    return read(FOLDER / f"{kind}.toml", overrides)
