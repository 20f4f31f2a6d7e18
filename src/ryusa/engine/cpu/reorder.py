"""Grains brought back into the period, and moved to the order of cells; any share of them by any thread."""

import math
from typing import Any

import numpy as np

from ryusa.compiled.borrow import borrow
from ryusa.engine.cpu.arrays import GrainArrays
from ryusa.engine.cpu.simd.vec4 import copy4
from ryusa.engine.shared.array_memory import zeros
from ryusa.engine.shared.kernel import kernel


@kernel(nogil=True)
def wrap_grains(
    lo: int, hi: int, x: Any, image: Any, ids: Any, period: Any, low: Any, high: Any, bounds: Any
) -> int:
    """Bring grains lo..hi-1 back into the period, and count it.

    `bounds` gets their lowest and highest coordinates, (2, 3). Returns the lowest id outside the world, from
    `low` to `high`, or -1.
    """
    lost = -1
    bounds[0], bounds[1] = np.inf, -np.inf
    for i in range(lo, hi):
        for k in range(2):
            length = period[k]
            if length < np.inf:
                shift = math.floor(x[i, k] / length)
                if shift != 0.0:
                    x[i, k] -= shift * length
                    image[i, k] += int(shift)
        inside = True
        for k in range(3):
            inside = inside and low[k] <= x[i, k] <= high[k]
            bounds[0, k], bounds[1, k] = min(bounds[0, k], x[i, k]), max(bounds[1, k], x[i, k])
        if not inside and (lost < 0 or ids[i] < lost):
            lost = ids[i]
    return lost


def _like(array: np.ndarray) -> np.ndarray:
    return zeros(array.dtype, *array.shape)


def like(n: int, old: GrainArrays) -> GrainArrays:
    """Room for n free grains in another order, with the fixed ones of `old`; `v_pruned` is shared."""
    both = zeros(np.float64, len(old.x), 8)
    new = {
        name: _like(getattr(old, name))
        for name in ("m", "inertia", "per_m", "per_inertia", "ids", "image", "n_touching", "fluid", "impulse")
    }
    for name in ("m_bare", "m_weight"):
        mass = getattr(old, name)
        new[name] = new["m"][:n] if np.may_share_memory(mass, old.m) else _like(mass)
    grains = old._replace(x=zeros(np.float64, len(old.x), 4), v=both[:, :4], w=both[:, 4:], **new)
    for name in ("x", "v", "w", "m", "inertia", "ids"):
        getattr(grains, name)[n:] = getattr(old, name)[n:]
    return grains


@kernel(nogil=True)
def move_grains(
    lo: int, hi: int, order: Any, old: GrainArrays, new: GrainArrays, place_of: Any, listed: Any
) -> None:
    """Copy to places lo..hi-1 the grains that `order` names, by place in `old`.

    `place_of` gets the new place of each old one, `listed` the positions [m] by new place.
    """
    old, new = borrow(old), borrow(new)
    with_fluid, counted = len(old.fluid) > 0, len(old.n_touching) > 0
    for p in range(lo, hi):
        i = order[p]
        place_of[i] = p
        copy4(new.x, 4 * p, old.x, 4 * i)
        copy4(new.v, 8 * p, old.v, 8 * i)
        copy4(new.w, 8 * p, old.w, 8 * i)
        for k in range(3):
            listed[p, k] = old.x[i, k]
        new.m[p], new.m_bare[p], new.m_weight[p] = old.m[i], old.m_bare[i], old.m_weight[i]
        new.inertia[p], new.per_m[p], new.per_inertia[p] = old.inertia[i], old.per_m[i], old.per_inertia[i]
        new.ids[p] = old.ids[i]
        if counted:
            new.n_touching[p] = old.n_touching[i]
        new.image[p, 0], new.image[p, 1] = old.image[i, 0], old.image[i, 1]
        if with_fluid:
            for k in range(old.fluid.shape[1]):
                new.fluid[p, k] = old.fluid[i, k]
            for k in range(old.impulse.shape[1]):
                new.impulse[p, k] = old.impulse[i, k]
