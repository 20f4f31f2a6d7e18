"""Structures in a row of columns, dams and walls, and the load of water and grains on each."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.measure._run import Floats, Run
from ryusa.measure.bed_area import side_planes
from ryusa.measure.snapshot import scene_at
from ryusa.measure.walls import forces_of_frames
from ryusa.measure.water_on_faces import areas, in_pieces, water_line, water_on_triangles
from ryusa.model.arrays import Bools
from ryusa.model.row import RowDam
from ryusa.model.wall_shape import in_world, triangles_of
from ryusa.model.walls import Walls
from ryusa.model.welding import flipped_sides, rims, welded
from ryusa.results.water import WaterFrames

ROUND, SAME = 10.0, 1.0e-6  # heights of a dam that a mesh round it may be longer; share of its size


@dataclass(frozen=True)
class Structure:
    """A dam, or one of the [[walls]].

    Attributes
    ----------
    name : of it.
    dam : on which the water acts; None where it acts on a mesh, or on none.
    walls : names of the walls whose grains push it.
    mesh : whether the water acts on the faces of the wall.
    toe : x and z of the foot on its downstream side at the begin of the window [m].
    """

    name: str
    dam: RowDam | None
    walls: tuple[str, ...]
    mesh: bool
    toe: tuple[float, float]


def structures_of(run: Run, t: float) -> tuple[list[Structure], list[str]]:
    """Structures in the row of a run at time t [s], dams first, and what is to be said of their water."""
    row, scene = run.row.row, scene_at(run, t)
    dams = [one for one in row.dams if not one.porous]
    shapes = {str(one["name"]): str(one["shape"]) for one in run.case.get("walls") or []}
    corners = {} if scene.walls is None else {name: _corners(scene.walls, name, t) for name in shapes}
    meshes = [name for name, shape in shapes.items() if shape == "mesh"]
    found: list[Structure] = []
    said: list[str] = []
    around: set[str] = set()
    for one in dams:
        begin, end = (row.x_low + k * row.dx for k in (one.first, one.end))
        spare = ROUND * (one.crest - float(row.bottom[one.first]))
        shells = [
            name for name in meshes
            if (x := corners[name][:, :, 0]).min() < begin + row.dx and x.max() > end - row.dx
            and np.ptp(x) <= end - begin + spare
        ]  # fmt: skip
        names = () if scene.walls is None else scene.walls.names
        own = (one.name,) if one.name in names else ()
        if not own and not shells:
            said.append(f"no grain acts on {one.name}: it is no wall for them")
        if shells:
            said.append(
                f"{one.name} has the water, and the grains of {', '.join((*own, *shells))}: the mesh stands "
                "round it, and the water is counted once"
            )
        around.update(shells)
        toe = (row.x_low + one.end * row.dx, float(row.bottom[one.end - 1]))
        found.append(Structure(one.name, one, (*own, *shells), False, toe))
    for name in shapes:
        if name in around:
            continue
        mesh = name in meshes and not flipped_sides(welded(corners[name]))
        if name in meshes and not mesh:
            said.append(f"no water on {name}: its triangles are flipped against each other, so that they "
                        "have no outer side; mend the mesh")  # fmt: skip
        found.append(Structure(name, None, (name,), mesh, _toe(corners[name])))
    if dams:
        how = "hydrostatic, from the level" if row.hydrostatic else "with its own pressure in the cells"
        said.insert(0, f"water on dams: {how} beside each face; no blow of a bore, no uplift, no friction")
    if wet := [one.name for one in found if one.mesh]:
        without = "" if row.hydrostatic else ", without the pressure beyond it"
        said.append(
            f"water on {', '.join(wet)}: hydrostatic{without}, on the outer side of each triangle, none "
            "under a foot on the floor; the row is uniform across and flows through it, without drag"
        )
    if dry := [one.name for one in found if one.dam is None and shapes[one.name] != "mesh"]:
        said.append(f"no water on {', '.join(dry)}: it stands as high on the other side of a sheet")
    return found, said


def water_on_dam(frames: WaterFrames, dam: RowDam) -> Floats:
    """Load of the water on a dam at every frame, per width, as it stands beside it or has its own pressure.

    Returns
    -------
    Force along x and along z [N/m], moment about the toe that turns the dam downstream, and the part of it by
    the horizontal force [N], shape (n_frame, 4).
    """
    row, surface, floor = frames.row, np.asarray(frames.surface), frames.floor
    weight, n = row.column.rho_w * row.g_z, row.n_segment
    x_toe, z_toe = row.x_low + dam.end * row.dx, float(row.bottom[dam.end - 1])
    found = np.zeros((len(surface), 4))
    for station in range(dam.first, dam.end + 1):
        left, right = station - 1, station
        if not row.periodic and (left < 0 or right >= n):
            continue  # an end of the row stands there
        left, right = left % n, right % n
        low, side, sign = (left, right, 1.0) if floor[right] > floor[left] else (right, left, -1.0)
        level, foot, top = surface[:, low], float(floor[low]), float(floor[side])
        wet = np.clip(level, foot, top) - foot  # height of the face under water
        force = weight * wet * (level - foot - 0.5 * wet)
        lever = (level - foot) * wet**2 / 2.0 - wet**3 / 3.0  # about the foot of the face
        moment = weight * lever
        if not row.hydrostatic:
            more, turns = _beyond_on_face(frames, low, foot, top)
            force, moment = force + more, moment + turns
        moment = moment + force * (foot - z_toe)
        found[:, 0] += sign * force
        found[:, 3] += sign * moment
    found[:, 2] = found[:, 3]
    for k in range(dam.first, dam.end):
        above = weight * np.maximum(surface[:, k] - floor[k], 0.0) * row.dx
        if not row.hydrostatic:
            above = above + frames.pressure[:, k, 0 if row.solid is None else row.solid[k]] * row.dx
        found[:, 1] -= above
        found[:, 2] += above * (row.x[k] - x_toe)
    return found


def _beyond_on_face(frames: WaterFrames, low: int, foot: float, top: float) -> tuple[Floats, Floats]:
    """What the pressure beyond the hydrostatic one adds to a face, beside the segment `low`, at every frame.

    Returns
    -------
    Force [N/m] and moment about the foot of the face [N], shape (n_frame,) each. In the cell of the surface
    the pressure falls on a straight line to zero, as the row has it.
    """
    row, n = frames.row, frames.row.column.n
    dz, z = row.column.dz, row.bottom[low] + row.column.dz * np.arange(n)
    level, p = frames.surface[:, low], np.array(frames.pressure[:, low])
    last = np.clip(np.ceil((level - row.bottom[low]) / dz).astype(np.int64) - 1, 0, n - 1)
    every = np.arange(len(level))
    h = np.maximum(level - z[last], 0.0)
    p[every, last] = np.where(last > 0, p[every, last - 1] * 0.5 * h / (h + 0.5 * dz), 0.0)
    begin = np.maximum(foot, z)
    end = np.minimum(np.minimum(level, top)[:, None], z + dz)
    force = p * np.maximum(end - begin, 0.0)
    return force.sum(axis=1), (force * (0.5 * (begin + end) - foot)).sum(axis=1)


def water_on_mesh(run: Run, one: Structure, kept: slice) -> Floats:
    """Load of the water at rest on the outer side of a mesh at some frames, shape (n_frame, 4).

    As `water_on_dam`, for the whole mesh [N], [N m]. The outer side is that of the normals of its triangles
    by the order of their corners, of a closed mesh the one outside.
    """
    frames: WaterFrames = run.row
    line = water_line(frames)
    sides = None if math.isfinite(run.scene.period[1]) else side_planes(run.scene)
    length = frames.row.n_segment * frames.row.dx
    shifts = (-length, 0.0, length) if frames.row.periodic else (0.0,)
    times = np.asarray(frames.t, dtype=np.float64)
    found = np.zeros((len(times), 4))
    last, cut = np.zeros((0, 3, 3)), [(np.zeros((0, 3, 3)), np.zeros(0, np.int64))]
    for k in range(len(times))[kept]:
        walls = scene_at(run, float(times[k])).walls
        assert walls is not None
        if not walls.active[walls.names.index(one.name)]:
            continue
        corners = _corners(walls, one.name, float(times[k]))
        if not np.array_equal(corners, last):
            outer = corners[:, ::-1] if _inside_out(corners) else corners
            cut = [in_pieces(line, outer + np.array([dx, 0.0, 0.0]), sides) for dx in shifts]
            last = corners
        # a part on the other side of the period keeps its lever
        found[k] = sum(
            water_on_triangles(line, k, *part, (one.toe[0] + dx, one.toe[1]))
            for dx, part in zip(shifts, cut, strict=True)
        )
    return found[kept]


def of_grains(run: Run, structures: list[Structure], kept: slice) -> tuple[Floats, Bools]:
    """Load of the grains on each structure between frames, (n, n_structure, 3), and whether any touched it.

    Force along x and z [N], and moment about the toe that turns downstream [N m].
    """
    n = len(range(len(run.row.t))[kept]) - 1
    found, touched = np.zeros((n, len(structures), 3)), np.zeros(len(structures), np.bool_)
    if not any(one.walls for one in structures):
        return found, touched
    of = forces_of_frames(run, kept)  # their account is of a step earlier: times do not serve
    for s, one in enumerate(structures):
        for name in one.walls:
            w = of.names.index(name)
            force, arm = of.force[:, w], np.array(one.toe) - of.axis_point[w, [0, 2]]
            turn = of.torque[:, w, 1] - (arm[1] * force[:, 0] - arm[0] * force[:, 2])
            found[:, s] += np.stack([force[:, 0], force[:, 2], turn], axis=1)
            touched[s] |= name not in of.untouched
    return found, touched


def _corners(walls: Walls, name: str, t: float) -> Floats:
    """Corners of the triangles of a wall at time t [m]."""
    w = walls.names.index(name)
    corners, owner = triangles_of(walls)
    return in_world(walls, corners, owner, t)[owner == w]


def _toe(corners: Floats) -> tuple[float, float]:
    """Place of the last of the lowest points of triangles: x and z [m]."""
    points = corners.reshape(-1, 3)
    low = float(points[:, 2].min())
    base = points[points[:, 2] <= low + SAME * float(np.ptp(points, axis=0).max())]
    return float(base[:, 0].max()), low


def _inside_out(corners: Floats) -> bool:
    """Whether a mesh is closed and the normals of its triangles point inwards."""
    if rims(corners)[0]:
        return False
    return float((areas(corners) * (corners[:, 0] - corners.mean(axis=(0, 1)))).sum()) < 0.0
