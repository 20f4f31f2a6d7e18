"""Checks of a feeder reach: a run that can supply a river, with the same grains, contacts and water."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

from ryusa.casefile.case import Case
from ryusa.casefile.column.packed import packed
from ryusa.casefile.contact.resolved import resolved_contact
from ryusa.casefile.row.ends import width_of
from ryusa.casefile.row.reach import END, KEY, NAME
from ryusa.casefile.row.reach_source import reach_of, run_of_reach
from ryusa.casefile.row.values import stream
from ryusa.casefile.shape import has_clumps
from ryusa.errors import CaseError
from ryusa.model.row import AGREE

# Keys of the sections that may differ: the flow follows from ends and bottom, and grids are their own.
_FREE = {
    "contact": {"expected_speed", "friction_angle"},  # friction is compared
    "water": {"tau_star", "u_star", "zero", "speed", "depth", "above", "roughness", "column", "row"},
    "column": {
        "cell", "bottom", "bed", "surface", "drive", "pressure_gradient", "discharge", "start", "interval",
    },
}  # fmt: skip
_TABLES = {"column": "water.column"}  # of a section, where its name is another


def check_reach(case: Case) -> Iterator[CaseError]:
    """Find a feeder reach that is missing, cannot supply a river, or is unlike this one."""
    keys = case.row
    if keys is None:
        return
    for side, end in (("upstream", keys.upstream), ("downstream", keys.downstream)):
        if end is None:
            continue
        if end.end != END and end.run is not None:
            yield CaseError(f"water.row.{side}.run", end.run, f"has no effect with end '{end.end}'")
        if end.end == END and side == "upstream" and end.run is None:
            yield CaseError(KEY, None, f"missing; end '{END}' needs the run folder of the reach")
    name = run_of_reach(case.row)
    if name is None:
        return
    if not stream(case):
        yield CaseError(
            "water.row.upstream.end", END, "brings grains, which enter a row with build.kind = 'stream' alone"
        )
        return
    try:
        reach = reach_of(case)
    except CaseError as error:
        yield error
        return
    assert reach is not None
    if case.materials or has_clumps(case.grains):
        yield CaseError(KEY, name, "brings spheres of one material, and this case has others: take one")
    for kind, entries in (("feeds", case.feeds), ("exits", case.exits)):
        for k, one in enumerate(entries):
            if one.name == NAME:
                yield CaseError(f"{kind}.{k}.name", NAME, "is the name of the feed of the feeder reach")


def check_unlike_reach(case: Case) -> Iterator[CaseError]:
    """Find what differs between a case without other faults and its reach."""
    reach, build = reach_of(case), case.build
    if reach is None or build.kind != "stream" or (width := width_of(case)) is None:
        return
    run = reach.name
    if not math.isclose(width, reach.width, rel_tol=AGREE):
        yield CaseError(
            KEY, run, f"is a bed {reach.width:g} m wide, and water.row.width is {width:g} m: must agree"
        )
    if build.walls != reach.side_walls:
        has, here = ("side walls", "none") if reach.side_walls else ("no side walls", "some")
        yield CaseError(KEY, run, f"has {has}, and this river has {here} (build.walls): must agree")
    if reach.case is None:  # the river keeps what it took, and was compared then
        return
    wet = case.water
    assert wet is not None
    ours: dict[str, Mapping[str, Any]] = {
        "grains": {"density": case.grains.density},
        "motion": {"gravity": case.motion.gravity, "rotation": case.motion.rotation},
        "contact": resolved_contact(case),
        "rolling": case.rolling.model_dump(mode="json"),
        "water": wet.model_dump(mode="json"),
        "column": case.column.model_dump(mode="json") | {"packed": packed(case)},
    }
    theirs = {name: reach.case.get(name) or {} for name in ours}
    theirs["column"] = theirs["water"].get("column") or {}
    for section, known in ours.items():
        table = _TABLES.get(section, section)
        for key, one in known.items():
            other = theirs[section].get(key)
            if key in _FREE.get(section, ()) or one is None or other is None or _alike(one, other):
                continue
            yield CaseError(
                KEY, run, f"has {table}.{key} = {_shown(other)}, and this case {_shown(one)}: reach "
                "and river must have the same grains, contacts and water",
            )  # fmt: skip
            return


def _alike(one: Any, other: Any) -> bool:
    """Whether two values agree, numbers to round-off."""
    numbers = all(isinstance(x, int | float) and not isinstance(x, bool) for x in (one, other))
    return math.isclose(one, other, rel_tol=AGREE) if numbers else bool(one == other)


def _shown(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else f"{value!r}"
