"""What a run takes of a case beside its scene: the first grains, the words of its timeline, and its end."""

import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ryusa.running.stops import Stop

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.record.schema import RecordSection, StopSection


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
        names += clump_files(case.grains, case.shapes)
        names += [wall.file for wall in case.walls if wall.file is not None]
        names += line_files(case)
        names += [feed.sedigraph for feed in case.feeds if isinstance(feed.sedigraph, str)]
        folder = case.path.resolve().parent
        found = {name: folder / name for name in names if _plain(name)}
    return found if sieve is None else found | {schema.SIEVE: sieve}


def _plain(name: str) -> bool:
    """Whether a name is that of a file in the folder or below it, which nothing of a run folder has."""
    taken, path = {".json", ".toml", ".vtkhdf", ".h5", ".txt", ".html", ".webp"}, Path(name)
    inside = not path.is_absolute() and not any(one.startswith(".") for one in path.parts)
    return inside and path.suffix not in taken and path.parts[0] not in {"parts", "pictures"}


def made_files(case: "Case") -> dict[str, bytes]:
    """What a case takes from other runs, by the names under which its run folder keeps it.

    The table of the first grains, where it starts from another run, and what a feeder reach supplies.
    """
    from ryusa.casefile.builders.schema import RunSection
    from ryusa.casefile.builders.table import bed_of_run, table_of
    from ryusa.casefile.row.reach_source import reach_of
    from ryusa.formats.csv import csv_frame, csv_head
    from ryusa.results import schema

    found = dict[str, bytes]()
    of_run = isinstance(case.build, RunSection) or bed_of_run(case.build) is not None
    table = table_of(case) if of_run else None
    if table is not None:
        found[schema.START] = csv_head(table) + csv_frame(table)
    if (reach := reach_of(case)) is not None:
        found[schema.REACH] = reach.to_bytes()
    return found


def origin_of_reach(made: Mapping[str, bytes]) -> dict[str, Any]:
    """The feeder reach in the provenance of a river: its run folder, window, and digest of what was taken.

    made : as `made_files` gives it; without a feeder reach there is nothing to say.
    """
    from ryusa.casefile.row.reach import FeederReach, digest_of
    from ryusa.results import schema

    if (content := made.get(schema.REACH)) is None:
        return {}
    reach = FeederReach.from_bytes(content)
    about = {"run": reach.name, "begin": reach.begin, "end": reach.end}
    return {"feeder_reach": about | {"sha256": digest_of(content)}}


def timeline_texts(case: "Case") -> list[str]:
    """Entries of the timeline as written in the case, with overrides applied; for the log."""
    from ryusa.casefile.overrides import with_overrides

    entries = with_overrides(tomllib.loads(case.text), case.overrides).get("timeline", [])
    if len(entries) != len(case.timeline):  # a case made in Python has no text
        entries = [{key: getattr(entry, key) for key in entry.model_fields_set} for entry in case.timeline]
    return [", ".join(f"{key} {one[key]}" for key in sorted(set(one) - {"at"})) for one in entries]


def stop_rule(stop: "StopSection", record: "RecordSection") -> Stop:
    """When the run of this case ends."""
    return Stop(
        time=math.inf if stop.time is None else stop.time,
        rest_speed=stop.rest.speed if stop.rest else 0.0,
        rest_for=stop.rest.duration if stop.rest else math.inf,
        saltations=stop.saltations, settle=record.settle,
        precision=stop.precision.limits() if stop.precision else {},
    )  # fmt: skip
