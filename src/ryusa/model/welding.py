"""Corners and sides that triangles have in common, found by sorting: no search, whatever their number."""

import math

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.model.groups import groups
from ryusa.model.walls import Ints

_WELD = 1e-9  # of the size of a mesh: nearer corners are one


def welded(corners: Floats, period: tuple[float, float] = (math.inf, math.inf)) -> Ints:
    """Numbers of the distinct corners of triangles, (n, 3); `corners` have shape (n, 3, 3) [m].

    >>> welded(np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [0, 1, 0]]])).tolist()
    [[0, 2, 1], [2, 3, 1]]
    """
    points = corners.reshape(-1, 3)
    if not len(points):
        return np.zeros((0, 3), np.int64)
    step = _WELD * max(float(np.ptp(points, axis=0).max()), 1e-300)
    units = np.round((points - points.min(axis=0)) / step).astype(np.int64)
    for k in range(2):
        if math.isfinite(period[k]):
            units[:, k] = np.mod(units[:, k], round(period[k] / step))
    # one coordinate after the other: sorting rows as such takes ten times as long
    number = np.unique(units[:, 0], return_inverse=True)[1].ravel()
    for k in (1, 2):
        number = np.unique(number * (int(units[:, k].max()) + 1) + units[:, k], return_inverse=True)[
            1
        ].ravel()
    return number.reshape(-1, 3).astype(np.int64)


def sides_of(number: Ints) -> Ints:
    """A number for each side of each triangle, the same in all that share it: sides 01, 12, then 20; (3 n,).

    Parameters
    ----------
    number : of the corners of each triangle, (n, 3).
    """
    most = int(number.max(initial=0)) + 1
    pairs = [(number[:, k], number[:, (k + 1) % 3]) for k in range(3)]
    return np.concatenate([np.minimum(a, b) * most + np.maximum(a, b) for a, b in pairs])


def flipped_sides(number: Ints) -> int:
    """Sides that two triangles share and both run in the same direction, so that their normals disagree.

    Parameters
    ----------
    number : of the corners of each triangle, (n, 3).

    >>> flipped_sides(np.array([[0, 1, 2], [1, 3, 2]])), flipped_sides(np.array([[0, 1, 2], [2, 3, 1]]))
    (0, 1)
    """
    up = np.concatenate([number[:, k] < number[:, (k + 1) % 3] for k in range(3)])
    _, side, times = np.unique(sides_of(number), return_inverse=True, return_counts=True)
    rising = np.bincount(side.ravel(), weights=up, minlength=len(times))
    return int(np.count_nonzero((times == 2) & (rising != 1.0)))


def first_of_each(number: Ints) -> Ints:
    """Triangles that have three corners which no earlier one has, in their order."""
    most = int(number.max(initial=0)) + 1
    low, middle, high = np.sort(number, axis=1).T
    pair = np.unique(low * most + middle, return_inverse=True)[1].ravel()
    return np.sort(np.unique(pair * most + high, return_index=True)[1])


def open_sides(corners: Floats) -> tuple[Floats, Ints, Ints]:
    """Sides that one triangle has alone.

    Returns
    -------
    points : ends of each [m], shape (k, 2, 3).
    rim : number of the rim that it is part of, shape (k,).
    times : how many triangles have each side, open or not.
    """
    number = welded(corners)
    _, first, times = np.unique(sides_of(number), return_index=True, return_counts=True)
    alone = first[times == 1]
    if not len(alone):
        return np.zeros((0, 2, 3)), np.zeros(0, np.int64), times
    triangle, k = alone % len(corners), alone // len(corners)
    after = (k + 1) % 3
    points = np.stack([corners[triangle, k], corners[triangle, after]], axis=1)
    ends = np.stack([number[triangle, k], number[triangle, after]], axis=1)
    at = np.unique(ends, return_inverse=True)[1].reshape(-1, 2)
    return points, groups(at, int(at.max()) + 1)[at[:, 0]], times


def rims(corners: Floats) -> tuple[int, Floats, int]:
    """Open sides of triangles, how wide each rim of such sides is [m], and sides shared by more than two.

    A rim goes round a hole, or round a mesh that is a sheet; its width is the diagonal of the box round it.

    >>> single, wide, several = rims(np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]]))
    >>> single, [round(one, 3) for one in wide.tolist()], several
    (3, [1.414], 0)
    """
    points, rim, times = open_sides(corners)
    n = int(rim.max(initial=-1)) + 1
    low, high = np.full((n, 3), math.inf), np.full((n, 3), -math.inf)
    np.minimum.at(low, rim, points.min(axis=1))
    np.maximum.at(high, rim, points.max(axis=1))
    return len(points), np.linalg.norm(high - low, axis=1), int((times > 2).sum())
