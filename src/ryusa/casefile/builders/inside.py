"""Builder 'fill' with `inside`: the wall that is filled, and the cells of the lattice that lie in it."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from ryusa.casefile.builders.schema import FillSection
from ryusa.casefile.walls.mesh import Mesh, mesh_of
from ryusa.casefile.walls.schema import WallSection
from ryusa.errors import CaseError
from ryusa.model.arrays import Floats
from ryusa.model.closed_mesh import MeshFault
from ryusa.model.enclosure import ROUND_OFF, CylinderInside, Enclosure, Grid, MeshInside
from ryusa.model.walls import Ints
from ryusa.spelling import nearest_word

MOST_CELLS = 10_000_000  # of the lattice round a wall
_FEW = 4096  # cells up to which the lattice is moved by half a cell to see where most grains fit
_TOUCH = 1.0e-10  # of a grain, forgiven where it touches the wall
_REMEDY = "give build.low and build.high instead"


@dataclass(frozen=True)
class CellsInside:
    """Cells of a lattice in which grains lie wholly inside a wall.

    Attributes
    ----------
    grid : the lattice round the wall.
    numbers : of the cells, ascending: the lowest layer first.
    free : distance by which a sphere in the middle of each is clear of the wall [m].
    """

    grid: Grid
    numbers: Ints
    free: Floats


def enclosure_of(folder: Path, walls: tuple[WallSection, ...], build: FillSection) -> Enclosure:
    """The inside of the wall that builder 'fill' names.

    Raises
    ------
    CaseError : there is no such wall, it has no inside, or its mesh does not say what is inside.
    """
    assert build.inside is not None
    names = [wall.name for wall in walls]
    if build.inside not in names:
        allowed = f"must be one of [[walls]]: {', '.join(names) or 'there is none'}"
        raise CaseError("build.inside", build.inside, allowed, nearest_word(build.inside, names))
    number = names.index(build.inside)
    wall, key = walls[number], f"walls.{number}"
    if wall.shape == "cylinder":
        if wall.at is None or wall.axis is None or wall.radius is None or not any(wall.axis):
            _refuse_missing(wall, key, ("at", "axis", "radius"))
            raise CaseError(f"{key}.axis", None, "must not be zero")
        assert wall.at is not None and wall.axis is not None and wall.radius is not None
        return CylinderInside(wall.at, wall.axis, wall.radius)
    if wall.shape != "mesh":
        text = f"is a {wall.shape}, which has no inside; must be a mesh or a cylinder, or {_REMEDY}"
        raise CaseError("build.inside", wall.name, text.replace("a ridges", "a plate with ridges"))
    _refuse_missing(wall, key, ("file", "unit"))
    try:
        return _inside_of_mesh(mesh_of(folder, wall, key))
    except MeshFault as error:
        raise CaseError("build.inside", wall.name, f"{error}; {_REMEDY}, or mend the mesh") from None


def _refuse_missing(wall: WallSection, key: str, needs: tuple[str, ...]) -> None:
    for one in needs:
        if getattr(wall, one) is None:
            text = f"missing; shape '{wall.shape}' needs {', '.join(needs)}"
            raise CaseError(f"{key}.{one}", None, text)


@lru_cache(maxsize=8)
def _inside_of_mesh(mesh: Mesh) -> MeshInside:
    return MeshInside.of(mesh.corners)  # once for each mesh


def cells_inside(enclosure: Enclosure, pitch: float, room: float, whole: bool) -> CellsInside:
    """Cells of width `pitch` that hold a sphere of diameter `room` [m] inside; with `whole`, that lie inside.

    Notes
    -----
    The lattice stands in the middle of the box round the wall, on its bottom. One of few cells is also tried
    half a cell aside along each axis, and the place with most grains is taken.

    Raises
    ------
    CaseError : so many cells that one would wait.
    """
    many = np.floor((enclosure.high - enclosure.low) / pitch * (1.0 + ROUND_OFF))
    if many.prod() > MOST_CELLS:
        text = f"the box round it has {many.prod():.3g} cells of a grain, at most {MOST_CELLS:,} are laid"
        raise CaseError("build.inside", None, f"{text}; take larger grains, or {_REMEDY}")
    return _cells_inside(enclosure, pitch, room, whole)


@lru_cache(maxsize=8)
def _cells_inside(enclosure: Enclosure, pitch: float, room: float, whole: bool) -> CellsInside:
    best: CellsInside | None = None
    for grid in _grids(enclosure, pitch):
        # a grain that is clear of the wall by half the diagonal of its gap has all the gap to be displaced
        away = enclosure.clearance(grid, 0.5 * room + math.sqrt(0.75) * (pitch - room))
        fits = enclosure.holds(grid) if whole else away >= (0.5 - _TOUCH) * room
        numbers = np.flatnonzero(fits)
        if best is None or len(numbers) > len(best.numbers):
            best = CellsInside(grid, numbers, np.maximum(away[numbers] - 0.5 * room, 0.0))
    assert best is not None
    return best


def _grids(enclosure: Enclosure, pitch: float) -> Iterator[Grid]:
    low, high = enclosure.low, enclosure.high
    n_x, n_y, n_z = (int(one) for one in (high - low) / pitch * (1.0 + ROUND_OFF))
    middle = 0.5 * (low + high)
    few = 0 < n_x * n_y * n_z <= _FEW
    for less in np.ndindex(2, 2, 3) if few else [(0, 0, 0)]:
        shape = (max(n_x - less[0], 0), max(n_y - less[1], 0), max(n_z - less[2] // 2, 0))
        x, y, z = (middle - 0.5 * pitch * np.array(shape)).tolist()
        yield Grid((x, y, z if less[2] else float(low[2])), pitch, shape)
