"""Groups of things of which pairs are linked: triangles at a side, sides of a rim, grains that touch."""

import numpy as np

from ryusa.model.walls import Ints


def groups(links: Ints, n: int) -> Ints:
    """Number of the group of each of n things; `links` are pairs of them, shape (k, 2).

    >>> groups(np.array([[0, 2], [3, 2]]), 5).tolist()
    [0, 1, 0, 0, 2]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(n, n))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)
