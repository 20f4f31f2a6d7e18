"""Placement of the first grains, the fixed grains and the walls, as every builder returns it."""

import math
from dataclasses import dataclass, field

import numpy as np

from ryusa.model.scene import Bools, Floats

LANE = 3.0  # distance between lanes in a plane scene, in largest diameters
ROOM_ABOVE, ROOM_BELOW, ROOM_ASIDE = 1000.0, 10.0, 1000.0  # of the default world box, in largest diameters


@dataclass(frozen=True)
class Wall:
    """A plane wall."""

    name: str
    point: tuple[float, float, float]  # [m]
    normal: tuple[float, float, float]  # any length


@dataclass(frozen=True)
class Placement:
    """First grains, fixed grains and walls, without their laws."""

    d: Floats  # free grains [m], (n,)
    x: Floats  # [m], (n, 3)
    v: Floats  # [m/s], (n, 3)
    omega: Floats  # [rad/s], (n, 3)
    d_fixed: Floats = field(default_factory=lambda: np.zeros(0))
    x_fixed: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    fixed_groups: tuple[tuple[str, int, int], ...] = ()  # name, first, count among fixed grains
    free_groups: tuple[tuple[str, int, int], ...] = ()
    walls: tuple[Wall, ...] = ()
    period: tuple[float, float] = (float("inf"), float("inf"))  # [m]
    z_zero: float = 0.0  # zero of the water profile when the case gives none [m]
    notes: tuple[str, ...] = ()  # choices that the case does not state
    endless: bool = False  # no boundary along x: a grain may roll far along a plane
    allow_overlap: bool = False
    names: tuple[str, ...] = ()  # names of free, then fixed grains in errors; () numbers them
    density: Floats | None = None  # of free grains [kg/m3], (n,); None: that of the case

    @property
    def d_max(self) -> float:
        """Largest diameter, fixed grains included [m]."""
        return float(max(self.d.max(initial=0.0), self.d_fixed.max(initial=0.0)))

    def groups(self) -> dict[str, tuple[int, int]]:
        """Slices of ids by name: free grains, bed, their parts, and planes."""
        n, n_fixed = len(self.d), len(self.d_fixed)
        found = {"grains": (0, n)}
        if n_fixed:
            found["bed"] = (n, n + n_fixed)
        found |= {name: (first, first + count) for name, first, count in self.free_groups}
        found |= {name: (n + first, n + first + count) for name, first, count in self.fixed_groups}
        found |= {wall.name: (n + n_fixed + k, n + n_fixed + k + 1) for k, wall in enumerate(self.walls)}
        return found

    def box(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Default domain [m]: wide margins, and no bounds along periodic axes and an endless x."""
        every = np.concatenate(
            [self.x, self.x_fixed, np.array([wall.point for wall in self.walls]).reshape(-1, 3)]
        )
        if not len(every):  # water alone
            return (-math.inf, -math.inf, -math.inf), (math.inf, math.inf, math.inf)
        d, low, high = self.d_max, every.min(axis=0), every.max(axis=0)
        below = [float(low[k] - ROOM_ASIDE * d) for k in (0, 1)]
        above = [float(high[k] + ROOM_ASIDE * d) for k in (0, 1)]
        for k in (0, 1):
            if np.isfinite(self.period[k]) or (k == 0 and self.endless):
                below[k], above[k] = -float("inf"), float("inf")
        floor, roof = float(low[2] - ROOM_BELOW * d), float(high[2] + ROOM_ABOVE * d)
        return (below[0], below[1], floor), (above[0], above[1], roof)


def at_rest(n: int) -> Floats:
    """Zeros of shape (n, 3), for grains at rest."""
    return np.zeros((n, 3))


def unit_normal(wall: Wall) -> Floats:
    """Unit normal of a wall."""
    normal = np.array(wall.normal, dtype=np.float64)
    return np.asarray(normal / np.linalg.norm(normal))


def mask(n: int, ids: tuple[int, ...]) -> Bools:
    """Mask that is True at the ids; empty if there are none."""
    found = np.zeros(n if ids else 0, dtype=np.bool_)
    found[list(ids)] = True
    return found
