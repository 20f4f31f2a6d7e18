"""Pairs in touch or nearly so at a frame, from positions alone."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ryusa.model import Scene
from ryusa.model.near_pairs import Pairs, near_free_pairs, near_pairs
from ryusa.model.wall_contacts import touched_surfaces

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def touching_pairs(x: Floats, scene: Scene, t: float = 0.0, gap: float = 0.0) -> tuple[Ints, Ints]:
    """Ids i, j of the pairs that overlap, shape (n_pair,) each, every pair once.

    Parameters
    ----------
    x : centres of the free grains [m], shape (n_grain, 3).
    scene, t : the scene that holds then; time [s], which tells where moving walls are.
    gap : pairs that are nearer than this count too, over the mean of both diameters; at a plane or wall over
        that of the grain [-].

    Returns
    -------
    i, j : i is a free grain; j is a free grain, a fixed grain, a plane or a face, with the ids of the scene.
    """
    return _touching(x, scene, t, partial(_near, gap=gap), gap)


def _near(x: Floats, d: Floats, box: Floats, free: int, gap: float) -> Pairs:
    pairs = near_pairs(x, d, box, share=gap)
    return pairs[(pairs < free).any(axis=1)]


def _touching(
    x: Floats,
    scene: Scene,
    t: float,
    near_of: Callable[[Floats, Floats, Floats, int], Pairs],
    gap: float = 0.0,
) -> tuple[Ints, Ints]:
    """As `touching_pairs`; `near_of` gives pairs that may be near, one of them free, and i < j."""
    n, there = scene.n_grain, np.flatnonzero(scene.fixed_active)
    if n == 0:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    here = np.arange(n) if scene.traffic is None else np.flatnonzero(np.isfinite(x[:, 0]))  # nan: away
    every = np.concatenate([x[here], scene.x_fixed[there].reshape(-1, 3)])
    d = np.concatenate([scene.d[here], scene.d_fixed[there]])
    ids = np.concatenate([here, n + there])
    if not len(here):
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    box = np.array([*(p if math.isfinite(p) else 0.0 for p in scene.period), 0.0])  # 0: open
    for axis in np.flatnonzero(box):
        every[:, axis] %= box[axis]
        every[every[:, axis] >= box[axis], axis] = 0.0  # round-off of the line above
    i, j = near_of(every, d, box, len(here)).T
    way = every[j] - every[i]
    way -= np.where(box > 0.0, box * np.round(way / np.where(box > 0.0, box, 1.0)), 0.0)
    near = (way**2).sum(axis=1) < (0.5 * (1.0 + gap) * (d[i] + d[j])) ** 2
    firsts, partners = [ids[i[near]]], [ids[j[near]]]
    for found, partner in zip(touched_surfaces(x, scene, t, gap), (firsts, partners), strict=True):
        partner.append(found)
    return np.concatenate(firsts).astype(np.int64), np.concatenate(partners).astype(np.int64)


def contacts_per_grain(x: Floats, scene: Scene, t: float = 0.0) -> Ints:
    """Number of grains, fixed grains, planes and walls that each free grain overlaps, shape (n_grain,).

    Parameters
    ----------
    x, scene, t : as in `touching_pairs`.
    """
    i, j = _touching(x, scene, t, near_free_pairs)
    n = scene.n_grain
    return np.bincount(i, minlength=n) + np.bincount(j[j < n], minlength=n)
