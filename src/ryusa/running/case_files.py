"""What a run folder keeps of a case beside its text: the first grains, and the words of its timeline."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ryusa.casefile.case import Case


def files_beside(case: "Case") -> dict[str, Path]:
    """Paths of first grains, clumps, meshes and sieve curve by the names of their copies."""
    from ryusa.casefile.builders.schema import TableSection
    from ryusa.casefile.grading import sieve_file
    from ryusa.casefile.row.values import line_files
    from ryusa.casefile.shape import clump_files
    from ryusa.results import schema

    sieve, found = sieve_file(case), dict[str, Path]()
    if case.path is not None:
        names = [case.build.file] if isinstance(case.build, TableSection) else []
        names += clump_files(case)
        names += [wall.file for wall in case.walls if wall.file is not None]
        names += line_files(case)
        folder = case.path.resolve().parent
        found = {name: folder / name for name in names if _plain(name)}
    return found if sieve is None else found | {schema.SIEVE: sieve}


def _plain(name: str) -> bool:
    """Whether a name is that of a file in the folder or below it, which nothing of a run folder has."""
    taken, path = {".json", ".toml", ".vtkhdf", ".h5", ".txt", ".html", ".webp"}, Path(name)
    inside = not path.is_absolute() and not any(one.startswith(".") for one in path.parts)
    return inside and path.suffix not in taken and path.parts[0] not in {"parts", "pictures"}


def start_of(case: "Case") -> Callable[[], bytes] | None:
    """Table of the first grains of a case that starts from another run."""
    from ryusa.casefile.builders.schema import RunSection
    from ryusa.casefile.builders.table import bed_of_run, table_of
    from ryusa.formats.csv import csv_frame, csv_head

    of_run = isinstance(case.build, RunSection) or bed_of_run(case) is not None
    table = table_of(case) if of_run else None
    return None if table is None else lambda: csv_head(table) + csv_frame(table)


def timeline_texts(case: "Case") -> list[str]:
    """Entries of the timeline as written in the case, with overrides applied; for the log."""
    from ryusa.casefile.overrides import with_overrides

    entries = with_overrides(tomllib.loads(case.text), case.overrides).get("timeline", [])
    if len(entries) != len(case.timeline):  # a case made in Python has no text
        entries = [{key: getattr(entry, key) for key in entry.model_fields_set} for entry in case.timeline]
    return [", ".join(f"{key} {one[key]}" for key in sorted(set(one) - {"at"})) for one in entries]
