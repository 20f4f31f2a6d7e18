"""Check that first grains keep to lanes and overlap neither each other nor walls; names the worst pair."""

from collections.abc import Sequence
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from ryusa.build.placement import Placement, unit_normal
from ryusa.build.walls import SolidWall
from ryusa.errors import CaseError
from ryusa.model import FaceKind
from ryusa.model.near_pairs import near_free_pairs
from ryusa.model.scene import Floats
from ryusa.model.wall_shape import nearest_on_face
from ryusa.model.walls import Ints, face_boxes

TOLERANCE = 1.0e-9  # of the smaller diameter
_AT_ONCE = 2_000_000  # pairs of a grain and a face near it


def lanes_of(placement: Placement, key: str) -> NDArray[np.intp]:
    """Lane of each free, then each fixed grain of a plane scene, numbered from 0 along y.

    Grains interact in their lane only: grains with exactly equal y share one, and lanes are at least the
    largest diameter apart.

    Raises
    ------
    CaseError : two grains neither share a lane nor are that far apart.
    """
    y = np.concatenate([placement.x[:, 1], placement.x_fixed[:, 1]])
    places, lanes = np.unique(y, return_inverse=True)
    gaps = np.diff(places)
    if np.any(near := gaps < placement.d_max * (1.0 - TOLERANCE)):
        k = int(np.argmax(near))
        who, other = (name(placement, int(np.argmax(lanes == lane))) for lane in (k, k + 1))
        raise CaseError(
            key,
            None,
            f"two lanes of a plane scene are {gaps[k]:.4g} m apart: {who} and {other}; y must be exactly "
            f"equal, or differ by the largest diameter, {placement.d_max:.4g} m, or more",
        )
    return np.asarray(lanes, dtype=np.intp).reshape(-1)


def refuse_overlaps(placement: Placement, key: str, plane: bool = False) -> None:
    """Raise a `CaseError` that names two first grains, or a grain and a plane, that overlap.

    In a plane scene grains overlap in x-z and only with others of their lane.
    """
    lanes = lanes_of(placement, key) if plane else None
    if placement.allow_overlap or not len(placement.d):
        return
    _against_walls(placement, key)
    n = len(placement.d)
    d = np.concatenate([placement.d, placement.d_fixed])
    x = np.concatenate([placement.x, placement.x_fixed])
    if lanes is not None:
        x[:, 1] = 2.0 * placement.d_max * lanes
    sides = np.array([*(p if np.isfinite(p) else 0.0 for p in placement.period), 0.0])
    for axis in (0, 1):
        if sides[axis] > 0.0:
            x[:, axis] = np.mod(x[:, axis], sides[axis])
            x[x[:, axis] >= sides[axis], axis] = 0.0
    pairs = near_free_pairs(x, d, sides, n)
    if not len(pairs):
        return
    i, j = pairs[:, 0], pairs[:, 1]
    apart = x[j] - x[i]
    for axis in (0, 1):
        if sides[axis] > 0.0:
            apart[:, axis] -= sides[axis] * np.round(apart[:, axis] / sides[axis])
    relative = ((d[i] + d[j]) / 2.0 - np.linalg.norm(apart, axis=1)) / np.minimum(d[i], d[j])
    worst = int(np.argmax(relative))
    if relative[worst] > TOLERANCE:
        first, second = sorted((int(i[worst]), int(j[worst])))
        count = int((relative > TOLERANCE).sum())
        who = name(placement, first)
        more = f"; {count} pairs overlap" if count > 1 else ""
        raise CaseError(
            key,
            None,
            f"first grains overlap: {who} and {name(placement, second)} by {relative[worst]:.3g} d{more}",
        )


def _against_walls(placement: Placement, key: str) -> None:
    for wall in placement.walls:
        relative = 0.5 - (placement.x - np.array(wall.point)) @ unit_normal(wall) / placement.d
        worst = int(np.argmax(relative))
        if relative[worst] > TOLERANCE:
            who = name(placement, worst)
            if relative.min() >= 0.5 and relative[worst] > 1.0:  # centres behind it, by more than their size
                raise CaseError(
                    key, None, f"{'all' if len(relative) > 1 else 'the'} first grains lie behind plane "
                    f"'{wall.name}': its normal points into the room of the grains; turn it round",
                )  # fmt: skip
            raise CaseError(
                key, None, f"first grains overlap: {who} and plane '{wall.name}' by {relative[worst]:.3g} d"
            )


def name(placement: Placement, grain: int) -> str:
    """Name of a grain for the user, with its position."""
    n = len(placement.d)
    x = placement.x[grain] if grain < n else placement.x_fixed[grain - n]
    where = "(" + ", ".join(f"{100.0 * c:.4g}" for c in x) + ") cm"
    if placement.names:
        return f"the grain {placement.names[grain]} at {where}"
    return f"{'free' if grain < n else 'fixed'} grain {grain} at {where}"


def refuse_overlaps_with_walls(placement: Placement, walls: Sequence[SolidWall], key: str) -> None:
    """Raise a `CaseError` that names a first grain and the wall that it overlaps most."""
    if placement.allow_overlap or not walls or not len(placement.d):
        return
    from scipy.spatial import KDTree

    tree, largest = KDTree(placement.x), 0.5 * float(placement.d.max())
    for wall in walls:
        low, high = face_boxes(wall.face, wall.kind)
        middle, reach = 0.5 * (low + high), 0.5 * np.linalg.norm(high - low, axis=1) + largest
        near = np.cumsum(tree.query_ball_point(middle, reach, return_length=True))
        chunk = near // _AT_ONCE  # so that few pairs are held at a time
        worst, grain = 0.0, -1
        for one in np.split(np.arange(len(near)), np.flatnonzero(np.diff(chunk)) + 1):
            found = tree.query_ball_point(middle[one], reach[one])
            face = np.repeat(one, [len(some) for some in found])
            k = np.fromiter(chain.from_iterable(found), np.int64, len(face))
            x = placement.x[k]
            close = np.all((x > low[face] - largest) & (x < high[face] + largest), axis=1)
            close &= _from_plane(wall, face, x) < 0.5 * placement.d[k]
            for f, i in zip(face[close].tolist(), k[close].tolist(), strict=True):
                x = placement.x[i]
                apart = float(np.linalg.norm(nearest_on_face(wall.face[f], int(wall.kind[f]), x) - x))
                relative = 0.5 - apart / float(placement.d[i])
                if relative > worst:
                    worst, grain = relative, i
        if worst > TOLERANCE:
            who = name(placement, grain)
            text = f"first grains overlap: {who} and wall '{wall.name}' by {worst:.3g} d"
            across = float((high.max(axis=0) - low.min(axis=0)).max())
            hint = f", or check its unit: it is {across:.3g} m long" if len(wall.face) > 1 else ""
            raise CaseError(key, None, f"{text}; move the wall or the grains{hint}")


def _from_plane(wall: SolidWall, face: Ints, x: Floats) -> Floats:
    """Distance of points from the planes of triangles [m]; 0 for other faces."""
    normal = np.cross(wall.face[:, 3:6], wall.face[:, 6:9])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    normal[wall.kind != FaceKind.TRIANGLE] = 0.0
    return np.abs(np.sum((x - wall.face[face, :3]) * normal[face], axis=1))
