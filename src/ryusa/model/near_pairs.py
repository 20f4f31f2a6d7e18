"""Pairs of grains that may touch, by a search that grains of very different sizes do not make large."""

import numpy as np
from numpy.typing import NDArray

from ryusa.model.arrays import Floats

Pairs = NDArray[np.int64]
ROUND_OFF = 1.0e-12
FEW = 4096  # pairs that are compared one by one sooner than a tree is built


def near_pairs(x: Floats, d: Floats, box: Floats, share: float = 0.0, gap: float = 0.0) -> Pairs:
    """All pairs of grains whose surfaces are closer than a gap, and some that are a little farther apart.

    Parameters
    ----------
    x : centres [m], shape (n, 3), within the box where it is periodic.
    d : diameters [m], shape (n,).
    box : periods in x, y and z [m], 0 where open, shape (3,).
    share, gap : gap over the mean of both diameters [-], and in addition [m].

    Returns
    -------
    pairs : places i < j in x, every pair once, shape (n_pair, 2).

    Notes
    -----
    Within the largest diameter of a grain there may be a million of a hundredth of its size, which are far
    from each other. Grains are therefore searched by halvings of the largest diameter, each class among
    itself and beside each larger one: what is found are a few pairs a grain, however wide the sizes are.
    """
    if len(d) < 2:
        return np.zeros((0, 2), np.int64)
    from scipy.spatial import KDTree  # the import takes a tenth of a second

    widest, wider = float(d.max()), 1.0 + share
    level = np.floor(np.log2(widest / d)).astype(np.int64)
    if not level.any():
        return np.asarray(KDTree(x, boxsize=box).query_pairs(wider * widest + gap, output_type="ndarray"))
    classes = [np.flatnonzero(level == k) for k in np.unique(level)]
    trees = [KDTree(x[one], boxsize=box) for one in classes]
    largest = [float(d[one].max()) for one in classes]
    found: list[Pairs] = []
    for a, (mine, tree) in enumerate(zip(classes, trees, strict=True)):
        found.append(mine[tree.query_pairs(wider * largest[a] + gap, output_type="ndarray")].reshape(-1, 2))
        for b in range(a):
            reach = 0.5 * wider * (largest[a] + largest[b]) + gap
            beside = tree.sparse_distance_matrix(trees[b], reach, output_type="ndarray")
            found.append(np.stack([mine[beside["i"]], classes[b][beside["j"]]], axis=1))
    return np.sort(np.concatenate(found), axis=1)


def near_free_pairs(x: Floats, d: Floats, box: Floats, free: int) -> Pairs:
    """The pairs of `near_pairs` of which at least one grain is among the first `free`, in any order.

    A few grains over a small bed are compared each with each, for which scipy need not be loaded.

    >>> x, d = np.array([[0.0, 0.0, 0.0], [0.9, 0.0, 0.0], [9.5, 0.0, 0.0]]), np.ones(3)
    >>> near_free_pairs(x, d, np.array([10.0, 0.0, 0.0]), 1).tolist()
    [[0, 1], [0, 2]]
    """
    if free * len(d) > FEW:
        pairs = near_pairs(x, d, box)
        return pairs[(pairs < free).any(axis=1)]
    apart = x[:free, None] - x
    round_box = np.where(box > 0.0, box, np.inf)
    apart -= np.where(box > 0.0, box, 0.0) * np.round(apart / round_box)
    reach = 0.5 * (d[:free, None] + d) * (1.0 + ROUND_OFF)
    near = np.triu((apart**2).sum(axis=2) <= reach**2, k=1)
    return np.argwhere(near)
