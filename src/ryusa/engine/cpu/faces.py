"""Faces of walls: how they lie in memory, their nearest points, and the cells in which they are found."""

import math
from typing import Any, NamedTuple

import numpy as np

from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.wall_pose import N_POSE, NOW
from ryusa.laws.walls import nearest_on_cylinder, nearest_on_disc, nearest_on_triangle
from ryusa.model.scene import Floats
from ryusa.model.walls import FaceKind, Walls, across, face_boxes, largest_speed

# columns of a face: a corner or centre, two edges or axes, the unit normal, and
A, EDGE_1, EDGE_2, NORMAL = 0, 3, 6, 9
KIND, WALL, S_11, S_12 = 12, 13, 14, 15  # kind, wall, products of the edges; in their place radius, length
N_FACE = 16  # two cache lines
TRIANGLE, DISC, CYLINDER = int(FaceKind.TRIANGLE), int(FaceKind.DISC), int(FaceKind.CYLINDER)
_CELLS = 4.0  # cells of a grid over the faces in it
_HELD = 64.0  # entries in the cells over the faces: long faces beside many short ones make cells wider

# columns of CandidateArrays.met: how a grain and a face meet in this step
GAP = 0  # separation from the grain to its mirror image in the face [m], and its diameter
DRIFT = 4  # velocity of the mirror image, which moves with the wall and its surface [m/s]
POINT = 7  # nearest point, in the frame of the wall [m]
AWAY = 10  # unit normal from the face to the grain, in the world [-]
DISTANCE = 13  # from the centre of the grain [m]
BY = 14  # row of the contact that takes the place of this one, or minus the share of its force that it has
SLOT = 15  # number of the wall, and a half where the nearest point lies within the face; -1: a plane
OVERLAP, FORCE = 16, 17  # while contacts share their forces [m]
N_MET = 24  # three cache lines


class FaceArrays(NamedTuple):
    """Faces of all walls, each in the frame of its wall, and the grid of each wall."""

    first: int  # id of the first face
    rows: Any  # columns as above, (n_face, N_FACE)
    centre: Any  # middle of the box round each face [m], (n_face, 3)
    surface: Any  # (n_face,)
    motion: Any  # model.walls, (n_wall, N_MOTION)
    poses: Any  # shared/wall_pose.py, (n_wall, N_POSE); every thread writes the same numbers
    speed: float  # bound of the speed of any wall [m/s]
    grid_low: Any  # lowest corner of the grid of each wall [m], (n_wall, 3)
    grid_width: Any  # its cells [m], (n_wall, 3)
    grid_dims: Any  # (n_wall, 3)
    grid_first: Any  # place of the first cell of each wall in `cell_first`, (n_wall,)
    cell_first: Any  # faces of each cell are cell_face[cell_first[c]:cell_first[c + 1]]
    cell_face: Any
    cells_low: Any  # lowest and highest cell of each face, (n_face, 3) each
    cells_high: Any


def face_arrays(walls: Walls, first: int) -> FaceArrays:
    """Arrays of the faces of a scene whose first face has the id `first`."""
    grid = _grid(walls)
    return FaceArrays(
        first, grid.rows, grid.centre, walls.surface.astype(np.int64),
        np.array(walls.motion), np.zeros((walls.n_wall, N_POSE)), largest_speed(walls), *grid.cells,
    )  # fmt: skip


class _Grid(NamedTuple):
    """What follows from the faces alone, whatever their motion and the grains."""

    face: Floats  # of the walls, to know them again
    active: Any
    rows: Floats
    centre: Floats
    cells: tuple[Any, ...]  # the last eight of `FaceArrays`


_last: list[_Grid] = []  # a run with feeds loads the same walls at every instant


def _grid(walls: Walls) -> _Grid:
    """Rows and cells of faces, those of the last walls again where the faces are the same arrays."""
    known = _last[0] if _last else None
    if known is not None and known.face is walls.face and np.array_equal(known.active, walls.active):
        return known
    n, n_wall = walls.n_face, walls.n_wall
    low, high = face_boxes(walls.face, walls.kind)
    dims, grid_low, width = np.ones((n_wall, 3), np.int64), np.zeros((n_wall, 3)), np.ones((n_wall, 3))
    cells_low, cells_high = np.zeros((n, 3), np.int64), np.zeros((n, 3), np.int64)
    for w in range(n_wall):
        mine = np.flatnonzero(walls.wall == w)
        if not (walls.active[w] and len(mine)):
            continue
        bottom, top = low[mine].min(axis=0), high[mine].max(axis=0)
        size = top - bottom
        volume = float(np.prod(np.maximum(size, 1e-3 * size.max())))
        cell = max((volume / (_CELLS * len(mine))) ** (1 / 3), 1e-12)
        while True:
            dims[w] = np.minimum(np.floor(size / cell) + 1.0, 1e9).astype(np.int64)
            cells_low[mine] = np.clip((low[mine] - bottom) // cell, 0, dims[w] - 1)
            cells_high[mine] = np.clip((high[mine] - bottom) // cell, 0, dims[w] - 1)
            held = float(np.prod(cells_high[mine] - cells_low[mine] + 1.0, axis=1).sum())
            if (
                np.prod(dims[w].astype(float)) <= _CELLS * len(mine) + 64.0
                and held <= _HELD * len(mine) + 1e6
            ):
                break
            cell *= 1.26
        # one cell along an axis is as wide as the wall: wider, its middle would not be that of the wall,
        # which decides on the images that are searched (append_faces)
        grid_low[w], width[w] = bottom, np.where(dims[w] > 1, cell, np.maximum(size, 1e-3 * cell))
    cells = np.prod(dims, axis=1)
    grid_first = np.concatenate([[0], np.cumsum(cells)])
    spans = (cells_high - cells_low + 1) * walls.face_active[:, None]
    times = np.prod(spans, axis=1)
    faces = np.repeat(np.arange(n), times)
    k = np.arange(len(faces)) - np.repeat(np.cumsum(times) - times, times)
    _, n_y, n_z = spans[faces].T
    a, b, c = (cells_low[faces] + np.column_stack([k // (n_y * n_z), k // n_z % n_y, k % n_z])).T
    w = walls.wall[faces]
    every = grid_first[w] + (a * dims[w, 1] + b) * dims[w, 2] + c
    first = np.concatenate([[0], np.cumsum(np.bincount(every, minlength=int(grid_first[-1])))])
    found = _Grid(
        walls.face, walls.active, _rows(walls), 0.5 * (low + high),
        (grid_low, width, dims, grid_first[:-1].copy(), first, faces[np.argsort(every, kind="stable")],
         cells_low, cells_high),
    )  # fmt: skip
    _last[:] = [found]
    return found


def _rows(walls: Walls) -> Floats:
    rows = np.zeros((walls.n_face, N_FACE))
    rows[:, :9], rows[:, KIND], rows[:, WALL] = walls.face, walls.kind, walls.wall
    b, c = walls.face[:, 3:6], walls.face[:, 6:9]
    flat = walls.kind == TRIANGLE
    rows[:, NORMAL : NORMAL + 3] = np.where(flat[:, None], np.cross(b, c), b)
    length = np.linalg.norm(rows[:, NORMAL : NORMAL + 3], axis=1)
    rows[:, NORMAL : NORMAL + 3] /= length[:, None]
    rows[:, S_11] = np.where(flat, np.sum(b * b, axis=1), c[:, 0])
    rows[:, S_12] = np.where(flat, np.sum(b * c, axis=1), c[:, 1])
    for f in np.flatnonzero(~flat):  # some direction across the axis, for a point on it
        rows[f, EDGE_2 : EDGE_2 + 3] = across(rows[f, NORMAL : NORMAL + 3])
    return rows


@inner(fastmath=FAST, forceinline=True)
def in_frame(w: int, at: int, x: float, y: float, z: float, poses: Any) -> tuple[float, float, float]:
    """A point of the world in the frame of wall w, whose pose is in columns from `at` on."""
    x, y, z = x - poses[w, at + 9], y - poses[w, at + 10], z - poses[w, at + 11]
    return (
        poses[w, at] * x + poses[w, at + 3] * y + poses[w, at + 6] * z,
        poses[w, at + 1] * x + poses[w, at + 4] * y + poses[w, at + 7] * z,
        poses[w, at + 2] * x + poses[w, at + 5] * y + poses[w, at + 8] * z,
    )


@inner(fastmath=FAST, forceinline=True)
def in_world(w: int, at: int, x: float, y: float, z: float, poses: Any) -> tuple[float, float, float]:
    """A point of the frame of wall w in the world."""
    return (
        poses[w, at] * x + poses[w, at + 1] * y + poses[w, at + 2] * z + poses[w, at + 9],
        poses[w, at + 3] * x + poses[w, at + 4] * y + poses[w, at + 5] * z + poses[w, at + 10],
        poses[w, at + 6] * x + poses[w, at + 7] * y + poses[w, at + 8] * z + poses[w, at + 11],
    )


@inner(fastmath=FAST, forceinline=True)
def nearest_image(f: int, x: float, y: float, l_x: float, l_y: float, centre: Any) -> tuple[float, float]:
    """Coordinates of the image of a point that is nearest to face f, in a frame that is not turned."""
    if l_x < math.inf:
        x -= math.floor((x - centre[f, 0]) / l_x + 0.5) * l_x
    if l_y < math.inf:
        y -= math.floor((y - centre[f, 1]) / l_y + 0.5) * l_y
    return x, y


@inner(fastmath=FAST, forceinline=True)
def nearest_of_face(
    f: int, x: float, y: float, z: float, rows: Any
) -> tuple[float, float, float, float, float, float, float, float]:
    """Nearest point of face f [m], unit normal from there to the point given, and their distance [m].

    Over the face the normal is that of the face to the last bit, and the distance as to a plane. The last
    number is 1 where the nearest point lies within the face, 0 on an edge or a corner.
    """
    d_x, d_y, d_z = x - rows[f, A], y - rows[f, A + 1], z - rows[f, A + 2]
    n_x, n_y, n_z = rows[f, NORMAL], rows[f, NORMAL + 1], rows[f, NORMAL + 2]
    along = d_x * n_x + d_y * n_y + d_z * n_z
    inside, kind, within = 0.0, rows[f, KIND], 0.0
    s_11, s_12 = rows[f, S_11], rows[f, S_12]
    p_x, p_y, p_z = rows[f, EDGE_1], rows[f, EDGE_1 + 1], rows[f, EDGE_1 + 2]
    q_x, q_y, q_z = rows[f, EDGE_2], rows[f, EDGE_2 + 1], rows[f, EDGE_2 + 2]
    if kind == TRIANGLE:
        v, w, inside = nearest_on_triangle(
            d_x * p_x + d_y * p_y + d_z * p_z, d_x * q_x + d_y * q_y + d_z * q_z, s_11, s_12,
            q_x * q_x + q_y * q_y + q_z * q_z,
        )  # fmt: skip
        m_x, m_y, m_z = v * p_x + w * q_x, v * p_y + w * q_y, v * p_z + w * q_z
    else:
        a_x, a_y, a_z = d_x - along * n_x, d_y - along * n_y, d_z - along * n_z
        away = math.sqrt(a_x * a_x + a_y * a_y + a_z * a_z)
        h = 0.0
        if kind == DISC:
            share = nearest_on_disc(away, s_11)
            inside = 1.0 if share == 1.0 else 0.0
        else:
            if away == 0.0:  # on the axis every direction is as good
                a_x, a_y, a_z, away = q_x, q_y, q_z, 1.0
            h, share = nearest_on_cylinder(along, away, s_11, s_12)
            within = 1.0 if 0.0 < h < s_12 else 0.0
        m_x, m_y, m_z = h * n_x + share * a_x, h * n_y + share * a_y, h * n_z + share * a_z
    c_x, c_y, c_z = rows[f, A] + m_x, rows[f, A + 1] + m_y, rows[f, A + 2] + m_z
    if inside != 0.0:
        side = -1.0 if along < 0.0 else 1.0
        return c_x, c_y, c_z, side * n_x, side * n_y, side * n_z, side * along, 1.0
    d_x, d_y, d_z = d_x - m_x, d_y - m_y, d_z - m_z
    distance = math.sqrt(d_x * d_x + d_y * d_y + d_z * d_z)
    if distance > 0.0:
        n_x, n_y, n_z = d_x / distance, d_y / distance, d_z / distance
    return c_x, c_y, c_z, n_x, n_y, n_z, distance, within


@inner(fastmath=FAST, forceinline=False)
def _cell(x: float, low: float, width: float, n: int) -> int:
    return int(min(max(math.floor((x - low) / width), -1.0), float(n)))


@inner(fastmath=FAST, forceinline=False)
def distance_to(
    f: int,
    x: float,
    y: float,
    z: float,
    l_x: float,
    l_y: float,
    poses: Any,
    rows: Any,
    centre: Any,
) -> float:
    """Distance of a point from face f [m]."""
    x, y, z = in_frame(int(rows[f, WALL]), NOW, x, y, z, poses)
    x, y = nearest_image(f, x, y, l_x, l_y, centre)
    return nearest_of_face(f, x, y, z, rows)[6]


@inner(fastmath=FAST, forceinline=False)
def append_faces(
    x: float, y: float, z: float, reach: float, l_x: float, l_y: float, faces: FaceArrays, partners: Any,
    used: int,
) -> int:  # fmt: skip
    """Append faces nearer than `reach` [m] to a point; the new count, or -1 where `partners` is too short.

    The order follows from the point alone: images, cells, then faces in the order of their ids. A face in
    several cells is taken in the lowest that it and the box round the point both have.
    """
    # arrays one by one: references to a tuple of them would be counted for every face (design/0005)
    rows, first_id, cells_low = faces.rows, faces.first, faces.cells_low
    cell_first, cell_face, dims, poses = faces.cell_first, faces.cell_face, faces.grid_dims, faces.poses
    grid_low, grid_width, grid_first = faces.grid_low, faces.grid_width, faces.grid_first
    images_x, images_y = 1 if l_x == math.inf else 3, 1 if l_y == math.inf else 3
    begin = used
    for w in range(len(poses)):
        f_x, f_y, f_z = in_frame(w, NOW, x, y, z, poses)
        n_x, n_y, n_z = dims[w, 0], dims[w, 1], dims[w, 2]
        # a wall may have moved by any number of periods: from the image nearest to its middle, one either way
        if images_x > 1:
            middle = grid_low[w, 0] + 0.5 * n_x * grid_width[w, 0]
            f_x -= math.floor((f_x - middle) / l_x + 0.5) * l_x
        if images_y > 1:
            middle = grid_low[w, 1] + 0.5 * n_y * grid_width[w, 1]
            f_y -= math.floor((f_y - middle) / l_y + 0.5) * l_y
        for image in range(images_x * images_y):
            q_x = f_x if images_x == 1 else f_x + (image // images_y - 1) * l_x
            q_y = f_y if images_y == 1 else f_y + (image % images_y - 1) * l_y
            low, width = grid_low[w, 0], grid_width[w, 0]
            a_0, a_1 = max(_cell(q_x - reach, low, width, n_x), 0), _cell(q_x + reach, low, width, n_x)
            low, width = grid_low[w, 1], grid_width[w, 1]
            b_0, b_1 = max(_cell(q_y - reach, low, width, n_y), 0), _cell(q_y + reach, low, width, n_y)
            low, width = grid_low[w, 2], grid_width[w, 2]
            c_0, c_1 = max(_cell(f_z - reach, low, width, n_z), 0), _cell(f_z + reach, low, width, n_z)
            for a in range(a_0, min(a_1, n_x - 1) + 1):
                for b in range(b_0, min(b_1, n_y - 1) + 1):
                    for c in range(c_0, min(c_1, n_z - 1) + 1):
                        cell = grid_first[w] + (a * n_y + b) * n_z + c
                        for k in range(cell_first[cell], cell_first[cell + 1]):
                            f = cell_face[k]
                            if (
                                a != max(a_0, cells_low[f, 0])
                                or b != max(b_0, cells_low[f, 1])
                                or c != max(c_0, cells_low[f, 2])
                                or nearest_of_face(f, q_x, q_y, f_z, rows)[6] >= reach
                            ):
                                continue
                            known = False
                            for p in range(begin, used):
                                known = known or partners[p] == first_id + f
                            if known:  # met through another image
                                continue
                            if used >= len(partners):
                                return -1
                            partners[used] = first_id + f
                            used += 1
    return used
