"""What a run folder keeps of a case beside its text: the first grains, and the words of its timeline."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ryusa.casefile.case import Case


def table_beside(case: "Case") -> Path | None:
    """Path of the table of first grains if it can be copied beside the case in the run folder."""
    from ryusa.casefile.builders.schema import TableSection

    if not isinstance(case.build, TableSection) or case.path is None:
        return None
    name = case.build.file
    plain = Path(name).name == name and Path(name).suffix not in {".json", ".toml", ".vtkhdf", ".h5", ".txt"}
    return case.path.resolve().parent / name if plain and not name.startswith(".") else None


def sieve_beside(case: "Case") -> Path | None:
    """Path of the sieve curve of the grains, which the run folder keeps under a name of its own."""
    from ryusa.casefile.grading import sieve_file

    return sieve_file(case)


def start_of(case: "Case") -> Callable[[], bytes] | None:
    """Table of the first grains of a case that starts from another run."""
    from ryusa.casefile.builders.schema import RunSection
    from ryusa.casefile.builders.table import table_of
    from ryusa.formats.csv import csv_frame, csv_head

    table = table_of(case) if isinstance(case.build, RunSection) else None
    return None if table is None else lambda: csv_head(table) + csv_frame(table)


def timeline_texts(case: "Case") -> list[str]:
    """Entries of the timeline as written in the case, with overrides applied; for the log."""
    from ryusa.casefile.overrides import with_overrides

    entries = with_overrides(tomllib.loads(case.text), case.overrides).get("timeline", [])
    if len(entries) != len(case.timeline):  # a case made in Python has no text
        entries = [{key: getattr(entry, key) for key in entry.model_fields_set} for entry in case.timeline]
    return [", ".join(f"{key} {one[key]}" for key in sorted(set(one) - {"at"})) for one in entries]
