"""TOML to a checked `Case`: every case file is read here."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ryusa.casefile.case import SCHEMA, Case
from ryusa.casefile.checks import check
from ryusa.casefile.faults import as_typed, faults
from ryusa.casefile.files import toml_text
from ryusa.casefile.overrides import parsed, with_overrides
from ryusa.casefile.toml_faults import encoding_fault, toml_fault
from ryusa.cases import FOLDERS, case_files
from ryusa.errors import CaseError
from ryusa.version import __version__

LARGEST_FILE = 4 << 20  # bytes; a table of many grains belongs in a CSV file
MOST_SCHEMA = 1000  # what is above is no schema that a later version has


def read(path: str | Path, overrides: Mapping[str, str] | None = None) -> Case:
    """Read and check a case file.

    Parameters
    ----------
    path : a TOML file.
    overrides : values set from outside, such as `{"contact.stiffness": "10 N/cm"}`; TOML or plain text.
        An override removes the other key for the same thing (`motion.slope_angle` removes `motion.slope`).

    Raises
    ------
    CaseError : the file is missing or unreadable, or holds faults; all faults found are reported together.
    """
    path = Path(path)
    try:
        if path.is_dir():
            raise CaseError(str(path), None, "is a folder; a case is a TOML file")
        if path.stat().st_size > LARGEST_FILE:
            raise CaseError(
                str(path), None, f"is larger than {LARGEST_FILE >> 20} MiB, the limit for a case file"
            )
        text = toml_text(path)
    except FileNotFoundError:
        raise CaseError(str(path), None, _not_found(path)) from None
    except UnicodeDecodeError as error:
        raise CaseError(str(path), None, encoding_fault(error)) from None
    except (OSError, ValueError) as error:
        raise CaseError(str(path), None, f"cannot be read: {error}") from None
    return read_text(text, overrides, path=path)


def _not_found(path: Path) -> str:
    """Name the command that writes the packaged case of that name, or one to start from."""
    name = path.as_posix().removesuffix(".toml")
    folder = name.rpartition("/")[0]
    if folder in FOLDERS and name in case_files(folder):
        return f"file not found; 'ryusa new {name}' writes the packaged case of that name"
    return "file not found; 'ryusa new saltation' writes a case to start from"


def read_text(text: str, overrides: Mapping[str, str] | None = None, *, path: Path | None = None) -> Case:
    """Read and check a case given as text; `path` names the file it came from."""
    source = path.name if path is not None else None
    try:
        data: dict[str, Any] = parsed(text)
    except (
        ValueError
    ) as error:  # TOMLDecodeError names line and column; numbers of thousands of digits end here too
        raise CaseError(source or "case", None, f"not valid TOML: {toml_fault(text, error)}") from None
    except RecursionError:
        raise CaseError(source or "case", None, "not valid TOML: nested too deeply") from None
    _refuse_newer(data.get("schema"), source)
    data = with_overrides(data, overrides or {})
    try:
        case = Case.model_validate(data)
    except ValidationError as error:
        raise CaseError.together(faults(error, data), source) from None
    case._text, case._path, case._overrides = text, path, dict(overrides or {})
    found = check(case, data)
    if found:
        raise CaseError.together([as_typed(one, data) for one in found], source)
    return case


def _refuse_newer(schema: Any, source: str | None) -> None:
    """Say which ryusa reads a case file of a later schema, whose keys this one may take for misspellings."""
    if isinstance(schema, int) and SCHEMA < schema < MOST_SCHEMA:
        allowed = f"needs ryusa {schema}.0 or later; this is ryusa {__version__}, which reads schema {SCHEMA}"
        raise CaseError("schema", schema, allowed, source=source)


def json_schema() -> dict[str, Any]:
    """JSON Schema of the case file, for editors."""
    schema = Case.model_json_schema(by_alias=True)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "ryusa case file"}


def json_schema_text() -> str:
    """Write the schema as docs/case.schema.json holds it."""
    return json.dumps(json_schema(), indent=1, sort_keys=True, ensure_ascii=False) + "\n"
