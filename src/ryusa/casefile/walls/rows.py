"""Rows of `ryusa check` about [[walls]], their motion, their belts and their meshes."""

import math
from pathlib import Path

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.contact.values import friction
from ryusa.casefile.facts import Derived
from ryusa.casefile.row.meshes import Boxes, dam_rows
from ryusa.casefile.rows import ExplainRow, count, word
from ryusa.casefile.section import given
from ryusa.casefile.walls.mesh import box_of, mesh_of
from ryusa.casefile.walls.schema import ServoSection, Vector, WallSection

WIDE = 1.0e4  # from which the size of a wall is doubted


def wall_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Shape, size and motion of each wall."""
    rows: list[ExplainRow] = []
    meshes: Boxes = []
    for k, wall in enumerate(case.walls):
        key = f"walls.{k}"
        low, high = box_of(case.folder, wall, key)
        size = " x ".join(f"{100.0 * one:.4g}" for one in high - low)
        ratio = float((high - low).max()) / derived.d_max
        wide = f"; {ratio:.3g} of the largest grains across"
        doubt = f", more than {WIDE:g}: check its lengths and units" if ratio > WIDE else ""
        about, flag = f"{wall.shape}{wide}{doubt}", "warning" if doubt else ""
        rows.append(word("walls", f"{wall.name}: size in x, y, z", f"{size} cm", about, flag))
        if wall.shape == "mesh":
            meshes.append((wall.name, low, high))
            rows += mesh_rows(case.folder, derived, wall, key)
        moves = [name for name in ("velocity", "angular_velocity", "amplitude") if given(wall, name)]
        if moves:
            rows.append(word("walls", f"{wall.name}: moves", _motion_text(wall), ", ".join(moves)))
        rows += belt_rows(case, wall)
        if wall.servo is not None:
            rows.append(word("walls", f"{wall.name}: presses with", servo_text(wall.servo), "servo"))
    return rows + dam_rows(case, meshes, derived.d_max)


def _motion_text(wall: WallSection) -> str:
    parts: list[str] = []
    if wall.velocity is not None:
        parts.append(f"{math.hypot(*wall.velocity):.4g} m/s")
    if wall.angular_velocity is not None:
        rate = math.hypot(*wall.angular_velocity)
        parts.append(f"{rate:.4g} rad/s ({60.0 * rate / (2.0 * math.pi):.4g} rpm)")
    if wall.amplitude is not None and wall.frequency is not None:
        parts.append(f"{100.0 * math.hypot(*wall.amplitude):.4g} cm at {wall.frequency:g} Hz")
    return ", ".join(parts)


def servo_text(servo: ServoSection) -> str:
    """What a servo is asked, in words."""
    asked = f"{servo.pressure:.4g} Pa" if servo.pressure is not None else f"{servo.force or 0.0:.4g} N"
    towards = ", ".join(f"{one:g}" for one in servo.direction)
    return f"{asked} towards ({towards}), at most {servo.max_speed:.4g} m/s"


_OFF = 0.01  # of the speed: more of it normal to a flat wall is told


def belt_rows(case: Case, wall: WallSection) -> list[ExplainRow]:
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


def _row(case: Case, wall: WallSection, velocity: Vector, when: str, key: str) -> ExplainRow:
    """Speed along the wall, and when a grain that is dragged along has it."""
    given, notes, flag = math.hypot(*velocity), [key], ""
    speed = _along(wall, velocity)
    if math.sqrt(max(given**2 - speed**2, 0.0)) > _OFF * given:
        flag = "warning"
        notes.append(
            f"its part along the wall: of {given:.4g} m/s the rest is normal to it and has no effect"
        )
    # friction on a material of its own is another
    mu, g = friction(case.contact) if wall.material is None else math.nan, case.motion.gravity
    if mu == 0.0:
        flag = "warning"
        notes.append("without friction it takes no grain along")
    elif speed > 0.0 and mu * g > 0.0:
        after = f"{speed / (mu * g):.3g} s and {100.0 * speed**2 / (2.0 * mu * g):.3g} cm"
        notes.append(f"level, with friction {mu:.3g}, a grain that does not roll has it after {after}")
    return word("walls", f"{wall.name}: surface runs{when} at", f"{speed:.4g} m/s", "; ".join(notes), flag)


def _along(wall: WallSection, velocity: Vector) -> float:
    """Speed along a flat wall [m/s]; all of it on other shapes, whose faces have several directions."""
    if wall.shape == "rectangle" and wall.sides is not None:
        normal = np.cross(*wall.sides)
    elif wall.shape == "disc" and wall.normal is not None:
        normal = np.array(wall.normal, dtype=float)
    else:
        return math.hypot(*velocity)
    return float(np.linalg.norm(np.cross(normal / np.linalg.norm(normal), velocity)))


def mesh_rows(folder: Path, derived: Derived, wall: WallSection, key: str) -> list[ExplainRow]:
    """Triangles of a mesh, what was left out, and where it is open."""
    mesh = mesh_of(folder, wall, key)
    found = [count("walls", f"{wall.name}: triangles", len(mesh.corners), f"{wall.file}, in {wall.unit}")]
    if mesh.empty:
        about = "triangles of no area in the file; they are left out"
        found.append(count("walls", f"{wall.name}: left out", mesh.empty, about, "note"))
    if mesh.doubled:
        about = "triangles with the corners of another one in the file; each is taken once"
        found.append(count("walls", f"{wall.name}: doubled", mesh.doubled, about, "note"))
    single, wide, several = mesh.rims
    if single:
        where = "1 rim" if len(wide) == 1 else f"{len(wide)} rims"
        widest = f"{100.0 * float(wide.max(initial=0.0)):.3g} cm across"
        about = (
            f"sides that one triangle has alone, in {where}, the widest {widest}: the mesh is a sheet, or "
            f"has holes that grains may pass; the smallest grain is {100.0 * derived.d_min:.3g} cm"
        )
        found.append(count("walls", f"{wall.name}: open sides", single, about, "note"))
    if several:
        about = "sides that more than two triangles share: corners there are not smoothed"
        found.append(count("walls", f"{wall.name}: shared sides", several, about, "note"))
    if mesh.flipped_sides:
        about = (
            "sides at which one of two triangles is flipped: that plays no part, grains touch both sides of "
            "a triangle and no force depends on the order of its corners"
        )
        found.append(count("walls", f"{wall.name}: flipped sides", mesh.flipped_sides, about))
    return found
