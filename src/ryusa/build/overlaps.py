"""Check that first grains keep to lanes and do not overlap; names the pair with the largest overlap."""

import numpy as np
from numpy.typing import NDArray

from ryusa.build.placement import Placement, unit_normal
from ryusa.errors import CaseError
from ryusa.model.near_pairs import near_free_pairs

TOLERANCE = 1.0e-9  # of the smaller diameter


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
