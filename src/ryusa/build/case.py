"""Builds a checked case: scene, initial state and the choices that the case does not state."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ryusa.build.assemble import assemble
from ryusa.build.belts import refuse_idle_belts
from ryusa.build.box import box
from ryusa.build.clumps import clumps_of
from ryusa.build.column import column_of
from ryusa.build.drop import drop
from ryusa.build.empty import empty
from ryusa.build.feeds import before_feeding, leaving_row, moving_with, with_feeds
from ryusa.build.fill import fill
from ryusa.build.flume import flume
from ryusa.build.laws import laws_of
from ryusa.build.materials import densities, materials_of, with_materials
from ryusa.build.overlaps import refuse_overlaps, refuse_overlaps_with_walls
from ryusa.build.packing import packing
from ryusa.build.passing_walls import refuse_passing_walls
from ryusa.build.placement import Placement, Wall
from ryusa.build.row import row_of
from ryusa.build.saltation import saltation
from ryusa.build.servo import servo_notes
from ryusa.build.stream import stream_bed, stream_walls
from ryusa.build.table import table
from ryusa.build.wall_checks import (
    refuse_crushing_servos,
    refuse_fast_walls,
    refuse_full_feeds,
    refuse_grains_beyond_exits,
    refuse_idle_servos,
)
from ryusa.build.walls import SolidWall, walls_of, with_room, with_walls
from ryusa.casefile.builders.table import key_of
from ryusa.casefile.case import Case
from ryusa.casefile.derive import derive
from ryusa.casefile.domain import PlaneSection
from ryusa.casefile.facts import Derived
from ryusa.casefile.record.schema import ChangeSection
from ryusa.casefile.shape import extent
from ryusa.casefile.unstated import unstated_notes
from ryusa.casefile.walls.schema import WallSection
from ryusa.casefile.without_effect import notes_without_effect
from ryusa.errors import CaseError
from ryusa.model import Scene, State
from ryusa.spelling import nearest_word

BUILDERS = {
    "drop": drop,
    "saltation": saltation,
    "table": table,
    "run": table,
    "packing": packing,
    "flume": flume,
    "box": box,
    "empty": empty,
    "fill": fill,
    "stream": stream_bed,
}


@dataclass(frozen=True)
class Built:
    """Initial condition of a run."""

    scene: Scene
    state: State
    notes: tuple[str, ...]  # choices that the case does not state


def build(case: Case, derived: Derived | None = None) -> Built:
    """Place the first grains of a case.

    Parameters
    ----------
    case : a checked case.
    derived : what follows from it; computed when not given.

    Raises
    ------
    CaseError : first grains overlap or lie between lanes, the timeline names an unknown group, or a wall, a
        feed or an exit cannot do what it is asked.
    """
    try:
        return _built(case, derived or derive(case))
    except CaseError as error:
        if error.source is not None or case.path is None:
            raise
        raise CaseError(
            error.key, error.value, error.allowed, error.nearest, others=error.others, source=case.path.name
        ) from error


def _built(case: Case, found: Derived) -> Built:
    placement = BUILDERS[case.build.kind](case, found)
    placement = _with_planes(placement, case.planes)
    key = key_of(case.build)
    reach = replace(placement, d=placement.d * extent(case))  # clumps, however they are turned
    refuse_overlaps(reach, key, case.motion.plane)
    walls = (*walls_of(case.folder, case.walls), *stream_walls(case))
    _refuse_taken_names(placement, walls)
    refuse_overlaps_with_walls(reach, walls, key)
    _refuse_unknown_groups(placement, case.walls, case.timeline)
    laws = replace(
        laws_of(case, found, placement.z_zero),
        flow=row_of(case, found, placement) or column_of(case, found, placement),
    )
    placement, traffic = with_feeds(placement, case, found)
    n_first = len(placement.d) if traffic is None else traffic.n_first
    of = materials_of(case, placement, n_first, traffic)
    if len(of):
        laws = replace(laws, density=densities(case, of[: len(placement.d)]))
    elif (own := placement.density) is not None:
        fed = np.full(len(placement.d) - len(own), case.grains.density)
        laws = replace(laws, density=np.concatenate([own, fed]))
    open_below, open_above = case.domain.low is None, case.domain.high is None
    scene, state = before_feeding(*assemble(placement, laws), traffic, open_below, open_above)
    scene = with_room(with_walls(scene, walls), open_below, open_above)
    scene = leaving_row(moving_with(scene))
    scene, state = clumps_of(case, with_materials(case, scene, of), state)
    refuse_fast_walls(case, scene)
    refuse_idle_belts(case, scene)
    passed = refuse_passing_walls(case, scene)
    refuse_idle_servos(case, scene, state)
    pressed = refuse_crushing_servos(scene)
    areas = servo_notes(
        scene, {k: one.servo.pressure for k, one in enumerate(case.walls) if one.servo and one.servo.pressure}
    )
    gone = refuse_grains_beyond_exits(scene, state)
    refuse_full_feeds(case, scene)
    said = (
        *placement.notes,
        *passed,
        *areas,
        *pressed,
        *gone,
        *notes_without_effect(case),
        *unstated_notes(case),
    )
    return Built(scene, state, said)


def _with_planes(placement: Placement, planes: tuple[PlaneSection, ...]) -> Placement:
    walls = tuple(Wall(plane.name, plane.point, plane.normal) for plane in planes)
    taken = {
        *(wall.name for wall in placement.walls),
        "grains",
        "bed",
        *(name for name, _, _ in placement.fixed_groups),
    }
    for number, wall in enumerate(walls):
        if wall.name in taken:
            raise CaseError(
                f"planes.{number}.name", wall.name, "is already used by the builder; choose another name"
            )
    return replace(placement, walls=(*placement.walls, *walls))


def _refuse_taken_names(placement: Placement, walls: Sequence[SolidWall]) -> None:
    taken = {"grains", *placement.groups()}
    for number, wall in enumerate(walls):
        if wall.name in taken:
            raise CaseError(
                f"walls.{number}.name", wall.name, "is the name of a plane or a group of grains already"
            )


def _refuse_unknown_groups(
    placement: Placement, walls: tuple[WallSection, ...], timeline: tuple[ChangeSection, ...]
) -> None:
    known = [name for name, (first, _) in placement.groups().items() if first >= len(placement.d)]
    known += [wall.name for wall in walls]
    for number, entry in enumerate(timeline):
        if entry.remove is not None and entry.remove not in known:
            there = ", ".join(known) or "there is none"
            allowed = f"must be a group of fixed grains, a plane or a wall: {there}"
            raise CaseError(
                f"timeline.{number}.remove", entry.remove, allowed, nearest_word(entry.remove, known)
            )
