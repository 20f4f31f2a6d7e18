"""First grains keep to their lanes and do not overlap: finds the worst pair and names both."""

import numpy as np
from numpy.typing import NDArray

from ryusa.build.layout import Layout, unit
from ryusa.errors import CaseError

TOLERANCE = 1.0e-9  # of the smaller diameter


def lanes_of(layout: Layout, key: str) -> NDArray[np.intp]:
    """Lane of each free, then each fixed grain of a plane scene, numbered from 0 along y.

    Grains meet in their lane only: those whose y is exactly equal share one, and lanes stand at least the
    largest diameter apart.

    Raises
    ------
    CaseError : two grains neither share a lane nor stand that far apart.
    """
    y = np.concatenate([layout.x[:, 1], layout.x_fixed[:, 1]])
    places, lanes = np.unique(y, return_inverse=True)
    gaps = np.diff(places)
    if np.any(near := gaps < layout.d_max * (1.0 - TOLERANCE)):
        k = int(np.argmax(near))
        who, other = (name(layout, int(np.argmax(lanes == lane))) for lane in (k, k + 1))
        raise CaseError(
            key,
            None,
            f"two lanes of a plane scene are {gaps[k]:.4g} m apart: {who} and {other}; y must be exactly "
            f"equal, or differ by the largest diameter, {layout.d_max:.4g} m, or more",
        )
    return np.asarray(lanes, dtype=np.intp).reshape(-1)


def refuse_overlaps(layout: Layout, key: str, plane: bool = False) -> None:
    """Raise a `CaseError` that names two first grains, or a grain and a plane, that overlap.

    In a plane scene grains overlap in x-z and only with others of their lane.
    """
    from scipy.spatial import KDTree  # a tenth of a second, and few need it

    lanes = lanes_of(layout, key) if plane else None
    if layout.allow_overlap:
        return
    _against_walls(layout, key)
    n = len(layout.d)
    d = np.concatenate([layout.d, layout.d_fixed])
    x = np.concatenate([layout.x, layout.x_fixed])
    if lanes is not None:
        x[:, 1] = 2.0 * layout.d_max * lanes
    sides = np.array([*(p if np.isfinite(p) else 0.0 for p in layout.period), 0.0])
    for axis in (0, 1):
        if sides[axis] > 0.0:
            x[:, axis] = np.mod(x[:, axis], sides[axis])
            x[x[:, axis] >= sides[axis], axis] = 0.0
    pairs = KDTree(x, boxsize=sides).query_pairs(float(d.max()), output_type="ndarray")
    pairs = pairs[(pairs[:, 0] < n) | (pairs[:, 1] < n)]
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
        who = name(layout, first)
        more = f"; {count} pairs overlap" if count > 1 else ""
        raise CaseError(
            key,
            None,
            f"first grains overlap: {who} and {name(layout, second)} by {relative[worst]:.3g} d{more}",
        )


def _against_walls(layout: Layout, key: str) -> None:
    for wall in layout.walls:
        relative = 0.5 - (layout.x - np.array(wall.point)) @ unit(wall) / layout.d
        worst = int(np.argmax(relative))
        if relative[worst] > TOLERANCE:
            who = name(layout, worst)
            raise CaseError(
                key, None, f"first grains overlap: {who} and plane '{wall.name}' by {relative[worst]:.3g} d"
            )


def name(layout: Layout, grain: int) -> str:
    """Name a grain as the user knows it, with its position."""
    n = len(layout.d)
    x = layout.x[grain] if grain < n else layout.x_fixed[grain - n]
    where = "(" + ", ".join(f"{100.0 * c:.4g}" for c in x) + ") cm"
    if layout.names:
        return f"the grain {layout.names[grain]} at {where}"
    return f"{'free' if grain < n else 'fixed'} grain {grain} at {where}"
