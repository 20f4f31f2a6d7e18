"""First grains must not overlap: finds the worst pair and names both."""

import numpy as np
from scipy.spatial import KDTree

from ryusa.build.layout import Layout, unit
from ryusa.errors import CaseError

TOLERANCE = 1.0e-9  # of the smaller diameter


def refuse_overlaps(layout: Layout, key: str) -> None:
    """Raise a `CaseError` that names two first grains, or a grain and a plane, that overlap."""
    if layout.allow_overlap:
        return
    _against_walls(layout, key)
    n = len(layout.d)
    d = np.concatenate([layout.d, layout.d_fixed])
    x = np.concatenate([layout.x, layout.x_fixed])
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
