"""Sizes of a box of grains: how wide, how deep, how many fixed grains in floor and walls."""

import math
from dataclasses import dataclass

from ryusa.casefile.builders.schema import BoxSection

SPARE = 2  # wall grains above the lattice
ROUND_OFF = 1.0e-9  # of a diameter, forgiven before a length takes one more grain


@dataclass(frozen=True)
class BoxPlan:
    """What floor, walls and lattice of a box measure; counts along y are 1 in a plane scene."""

    pitch: tuple[float, float, float]  # of the lattice [m]
    wide: float  # inner width, back wall to gate [m]
    deep: float  # period in y [m]; meaningless in a plane scene
    n_wide: int  # fixed grains along x between back wall and gate
    n_deep: int  # fixed grains along y
    n_floor: int  # fixed grains of the floor along x; 0 over a plane
    n_back: int  # fixed grains in one stack of the back wall; 0 for a plane
    n_gate: int  # fixed grains in one stack of the gate; 0 for a plane

    @property
    def n_fixed(self) -> int:
        """Fixed grains in all."""
        return self.n_deep * (self.n_floor + self.n_back + self.n_gate)


def box_plan(build: BoxSection, d: float, room: float, plane: bool) -> BoxPlan:
    """Plan of a box of grains of mean diameter d, each within a sphere of diameter `room` [m]."""
    pitch = room * (1.0 + build.gap)
    wide, deep = build.columns * pitch, build.rows * pitch
    n_wide, n_deep = fitting(wide, d), 1 if plane else fitting(deep, d)
    if build.floor == "grains" or build.walls == "grains":
        wide, deep = n_wide * d, n_deep * d
    n_floor = n_wide + fitting(build.run_out, d) if build.floor == "grains" else 0
    n_back, n_gate = 0, 0
    if build.walls == "grains":
        under = d * (1.0 + build.floor_height) if n_floor else 0.0
        n_back = n_gate = fitting(under + build.height + build.layers * pitch, d) + SPARE
        n_gate -= int(stands_on_floor(build))
    return BoxPlan(
        pitch=(wide / build.columns, pitch if plane else deep / build.rows, pitch),
        wide=wide,
        deep=deep,
        n_wide=n_wide,
        n_deep=n_deep,
        n_floor=n_floor,
        n_back=n_back,
        n_gate=n_gate,
    )


def stands_on_floor(build: BoxSection) -> bool:
    """Whether a gate of grains stands on the floor's grains, for these go on beneath it."""
    return build.floor == "grains" and build.run_out > 0.0


def fitting(length: float, d: float) -> int:
    """Fewest touching grains of diameter d that are as long as a length, both [m].

    >>> fitting(0.0066, 0.002), fitting(0.006, 0.002)
    (4, 3)
    """
    return math.ceil(length / d - ROUND_OFF)


def hole(build: BoxSection, plane: bool) -> float:
    """Largest grain, in mean diameters, that could slip through a floor or wall of grains."""
    if build.floor != "grains" and build.walls != "grains":
        return 0.0
    rise = build.floor_height if build.floor == "grains" else 0.0
    if not plane:  # amid four grains of a square
        return math.sqrt(2.0 + rise * rise) - 1.0
    return math.sqrt(1.0 + max(rise * rise, 0.25 if rise else 0.0)) - 1.0  # uneven floor, or beside a wall
