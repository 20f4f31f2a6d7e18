"""walls.surface_velocity: walls whose surface runs, as that of a belt, and what is wrong with them."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ryusa.casefile.contact.values import friction
from ryusa.casefile.rows import ExplainRow, word
from ryusa.errors import CaseError

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.walls import WallSection

Vector = tuple[float, float, float]
_OFF = 0.01  # of the speed: more of it normal to a flat wall is told


def check_belts(case: "Case") -> Iterator[CaseError]:
    """Find walls whose surface cannot run, and moves that would let it."""
    shape = {wall.name: wall.shape for wall in case.walls}
    asked = [(f"walls.{k}", wall.name, wall.surface_velocity) for k, wall in enumerate(case.walls)]
    asked += [
        (f"timeline.{k}.move", entry.move.wall, entry.move.surface_velocity)
        for k, entry in enumerate(case.timeline)
        if entry.move is not None
    ]
    for key, name, velocity in asked:
        if velocity is not None and shape.get(name) == "ridges":
            yield CaseError(
                f"{key}.surface_velocity", list(velocity),
                "cannot run over ridges, which would stand still: give velocity, with which they move along; "
                "a smooth belt is a rectangle",
            )  # fmt: skip


def belt_rows(case: "Case", wall: "WallSection") -> list[ExplainRow]:
    """Speed of the surface of a wall, and of each move of the timeline that starts, changes or stops it."""
    rows: list[ExplainRow] = []
    runs = wall.surface_velocity is not None and any(wall.surface_velocity)
    if wall.surface_velocity is not None and runs:
        rows.append(_row(case, wall, wall.surface_velocity, "", "surface_velocity"))
    for k, entry in enumerate(case.timeline):
        if entry.move is None or entry.move.wall != wall.name:
            continue
        velocity, when = entry.move.surface_velocity or (0.0, 0.0, 0.0), f" from {entry.at:.4g} s on"
        if any(velocity):
            rows.append(_row(case, wall, velocity, when, f"timeline.{k}.move.surface_velocity"))
        elif runs:
            name = f"{wall.name}: surface stands still{when}"
            rows.append(word("walls", name, "0 m/s", f"timeline.{k}.move gives it no surface_velocity"))
        runs = any(velocity)
    return rows


def _row(case: "Case", wall: "WallSection", velocity: Vector, when: str, key: str) -> ExplainRow:
    """Speed along the wall, and when a grain that is dragged along has it."""
    given, notes, flag = math.hypot(*velocity), [key], ""
    speed = _along(wall, velocity)
    if math.sqrt(max(given**2 - speed**2, 0.0)) > _OFF * given:
        flag = "warning"
        notes.append(
            f"its part along the wall: of {given:.4g} m/s the rest is normal to it and has no effect"
        )
    # friction on a material of its own is another
    mu, g = friction(case) if wall.material is None else math.nan, case.motion.gravity
    if mu == 0.0:
        flag = "warning"
        notes.append("without friction it takes no grain along")
    elif speed > 0.0 and mu * g > 0.0:
        after = f"{speed / (mu * g):.3g} s and {100.0 * speed**2 / (2.0 * mu * g):.3g} cm"
        notes.append(f"level, with friction {mu:.3g}, a grain that does not roll has it after {after}")
    return word("walls", f"{wall.name}: surface runs{when} at", f"{speed:.4g} m/s", "; ".join(notes), flag)


def _along(wall: "WallSection", velocity: Vector) -> float:
    """Speed along a flat wall [m/s]; all of it on other shapes, whose faces have several directions."""
    if wall.shape == "rectangle" and wall.sides is not None:
        normal = np.cross(*wall.sides)
    elif wall.shape == "disc" and wall.normal is not None:
        normal = np.array(wall.normal, dtype=float)
    else:
        return math.hypot(*velocity)
    return float(np.linalg.norm(np.cross(normal / np.linalg.norm(normal), velocity)))
