"""Force of the water at rest of a row of columns on triangles, as those of a mesh."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ryusa.measure._run import Floats
from ryusa.results.water import WaterFrames

Ints = NDArray[np.int64]
NUDGE = 1.0e-9  # of a piece of the row


class WaterLine(NamedTuple):
    """Surface and floor of a row as straight pieces along x, two for each segment.

    Attributes
    ----------
    x : ends of the pieces [m], shape (n_piece, 2).
    surface : heights there at each frame [m], shape (n_frame, n_piece, 2).
    floor : of the bottom, with the dams that let no water through, there [m], shape (n_piece, 2).
    weight : of water per volume, rho g_z [N/m3].
    foot : height over the floor up to which a side that faces it stands on it [m].
    """

    x: Floats
    surface: Floats
    floor: Floats
    weight: float
    foot: float


def water_line(frames: WaterFrames) -> WaterLine:
    """Water between the middles of segments, level from the last of them to a dam or an end of the row."""
    row, solid = frames.row, frames.row.solid_cells()[frames.row.inner]
    n, open_ends = row.n_segment, not row.periodic
    same = solid == np.roll(solid, -1)  # as the segment behind
    if open_ends:
        same[-1] = False

    def ends(values: Floats) -> Floats:
        behind = np.where(same, 0.5 * (values + np.roll(values, -1, axis=-1)), values)
        before = np.where(np.roll(same, 1), np.roll(behind, 1, axis=-1), values)
        pieces = np.stack([before, values, values, behind], axis=-1)
        return np.asarray(pieces.reshape(*values.shape[:-1], 2 * n, 2), dtype=np.float64)

    low = row.x_low + 0.5 * row.dx * np.arange(2 * n, dtype=np.float64)
    return WaterLine(
        np.stack([low, low + 0.5 * row.dx], axis=1), ends(np.asarray(frames.surface, dtype=np.float64)),
        ends(frames.floor), row.column.rho_w * row.g_z, 0.5 * row.column.dz,
    )  # fmt: skip


def kept(corners: Floats, value: Floats) -> tuple[Floats, Ints]:
    """The parts of triangles in which something that varies linearly over each is above 0.

    Parameters
    ----------
    corners : [m], shape (n, 3, 3).
    value : at the corners, shape (n, 3).

    Returns
    -------
    corners : of triangles that turn the same way [m], shape (m, 3, 3).
    number : of the triangle of which each is a part, shape (m,).

    >>> corner = np.array([[[0.0, 0, 0], [2, 0, 0], [0, 2, 0]]])
    >>> kept(corner, corner[:, :, 0] - 1.0)[0].tolist()  # beyond x = 1
    [[[2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]]]
    """
    above = value > 0.0
    count = above.sum(axis=1)
    parts, numbers = [corners[count == 3]], [np.flatnonzero(count == 3)]
    for alone, whole in ((True, 1), (False, 2)):  # one corner is above, or one is not
        number = np.flatnonzero(count == whole)
        first = np.argmax(above[number] == alone, axis=1)
        order = (first[:, None] + np.arange(3)) % 3
        at, v = corners[number[:, None], order], value[number[:, None], order]
        share = (v[:, :1] / (v[:, :1] - v[:, 1:]))[:, :, None]
        cut = at[:, :1] + share * (at[:, 1:] - at[:, :1])
        if alone:
            parts.append(np.concatenate([at[:, :1], cut], axis=1))
        else:
            parts.append(np.stack([cut[:, 0], at[:, 1], at[:, 2]], axis=1))
            parts.append(np.stack([cut[:, 0], at[:, 2], cut[:, 1]], axis=1))
        numbers += [number] * (1 if alone else 2)
    return np.concatenate(parts), np.concatenate(numbers)


def in_pieces(
    line: WaterLine, corners: Floats, sides: tuple[float, float] | None = None
) -> tuple[Floats, Ints]:
    """Triangles cut to the pieces of a row, where water may reach them.

    Parameters
    ----------
    line : the water.
    corners : of triangles [m], shape (n, 3, 3).
    sides : y of the side walls [m], beyond which no water is; None where the row has none.

    Returns
    -------
    corners, piece : of triangles [m], shape (m, 3, 3), and the number of the piece of each, shape (m,). Left
        out is what lies outside the row, in its floor, or on the floor and faces it.
    """
    if sides is not None:
        corners = kept(corners, corners[:, :, 1] - sides[0])[0]
        corners = kept(corners, sides[1] - corners[:, :, 1])[0]
    first, last = corners[:, :, 0].min(axis=1), corners[:, :, 0].max(axis=1)
    aside = NUDGE * float(np.ptp(line.x[0]))
    found, pieces = [np.zeros((0, 3, 3))], [np.zeros(0, np.int64)]
    for k, (begin, end) in enumerate(line.x.tolist()):
        here = corners[(last >= begin - aside) & (first <= end + aside)]
        for border, sign in ((begin, 1.0), (end, -1.0)):
            # a side just at a border meets the water of the piece that it faces
            x = here[:, :, 0] + aside * np.sign(areas(here)[:, :1])
            here = kept(here, sign * (x - border))[0]
        floor = np.interp(here[:, :, 0], line.x[k], line.floor[k])
        stands = line.foot * (areas(here)[:, 2:] < 0.0)
        here = kept(here, here[:, :, 2] - floor - stands)[0]
        found.append(here)
        pieces.append(np.full(len(here), k))
    return np.concatenate(found), np.concatenate(pieces)


def areas(corners: Floats) -> Floats:
    """Normal of each triangle times its area, by the right-hand rule of its corners [m2]."""
    a, b, c = corners.transpose(1, 0, 2)
    return np.asarray(0.5 * np.cross(b - a, c - a))


def water_on_triangles(
    line: WaterLine, frame: int, corners: Floats, piece: Ints, toe: tuple[float, float]
) -> Floats:
    """Load of the water on the sides of triangles to which their normals point, at one frame.

    Parameters
    ----------
    line, frame : the water, and the number of the frame.
    corners, piece : as `in_pieces` gives them.
    toe : x and z of the point about which moments are taken [m].

    Returns
    -------
    Force along x and along z [N], moment about the toe that turns downstream, and the part of it by the
    horizontal force [N m], shape (4,).

    Notes
    -----
    p = rho g_z (surface - z) where that is above 0, which is linear over a triangle, so that the integrals
    of p, p x and p z over what is wet are exact: with sums over the corners i of a triangle of area A,
    int p x = (A/12) (sum p_i x_i + sum p_i sum x_i).
    """
    corners, number = kept(corners, _depth(line, frame, corners, piece))
    p = line.weight * _depth(line, frame, corners, piece[number])
    total, push = p.sum(axis=1), -areas(corners)
    x, z = corners[:, :, 0] - toe[0], corners[:, :, 2] - toe[1]
    of_x, of_z = (((p * one).sum(axis=1) + total * one.sum(axis=1)) / 12.0 for one in (x, z))
    flat = float(push[:, 0] @ of_z)
    force_x, force_z = (float(push[:, k] @ total) / 3.0 for k in (0, 2))
    return np.array([force_x, force_z, flat - push[:, 2] @ of_x, flat])


def _depth(line: WaterLine, frame: int, corners: Floats, piece: Ints) -> Floats:
    """Depth of the corners of triangles under the surface [m], (n, 3); negative above it."""
    (begin, end), surface = line.x[piece].T, line.surface[frame, piece]
    share = (corners[:, :, 0] - begin[:, None]) / (end - begin)[:, None]
    return np.asarray(surface[:, :1] + share * np.diff(surface, axis=1) - corners[:, :, 2])
