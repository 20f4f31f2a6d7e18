"""Area of bed that grains stand on, or of a sample between upright walls."""

import math

import numpy as np

from ryusa.measure._run import Run
from ryusa.model import Scene
from ryusa.model.plane_section import rim_of, section_area

LEAST = 10  # grains from which their hull tells how far they reach
TENTHS = (0.1, 0.9)  # shares of the grains below whose heights walls must be upright, to
UPRIGHT = 0.01  # this share of the area of a section


def area_of(run: Run, first: int, scene: Scene, lanes: int) -> float:
    """Area of bed, all lanes together, or of the sample between upright walls [m2]; inf where it is open.

    Between walls it is that of the section at the middle height of the grains in frame `first`, seen from
    their middle; inf where those at the heights of the lowest and highest tenth differ by 1 % or more, or
    where grains lie round more than is seen, as in a ring.
    """
    along, across = float(scene.period[0]), _width(scene, lanes)
    if scene.plane_case or math.isfinite(along * across):
        return along * across
    x = np.asarray(run.frames.x[first], dtype=np.float64)
    heights = np.nanquantile(x[:, 2], (0.5, *TENTHS))
    middle, up, t = np.nanmean(x, axis=0), np.array([0.0, 0.0, 1.0]), float(run.frames.t[first])
    area, *others = [section_area(scene, np.array([*middle[:2], z]), up, t) for z in heights]
    if not all(abs(one - area) < UPRIGHT * area for one in others):
        return math.inf
    there = x[np.isfinite(x[:, 0])]
    return math.inf if len(there) > LEAST and rim_of(there, up)[1] > area else area


def area_of_stretch(scene: Scene, lanes: int, between: tuple[float, float]) -> float:
    """Area of a stretch of bed [m2]; inf where it has no width or no length."""
    length = between[1] - between[0]
    return length * _width(scene, lanes) if length > 0.0 else math.inf


def _width(scene: Scene, lanes: int) -> float:
    """Width of bed across the flow, in a period or between planes [m]; inf where there is none."""
    if scene.plane_case:
        return lanes * (scene.slab_width if math.isfinite(scene.slab_width) else float(scene.d.mean()))
    if math.isfinite(scene.period[1]):
        return float(scene.period[1])
    sides = side_planes(scene)
    return math.inf if sides is None else sides[1] - sides[0]


def side_planes(scene: Scene) -> tuple[float, float] | None:
    """Places y of the planes that face each other across the flow [m]; None without two of them."""
    facing = scene.plane_normal[:, 1] * scene.plane_active
    right, left = (scene.plane_point[facing == side, 1] for side in (1.0, -1.0))
    return (float(right.max()), float(left.min())) if len(right) and len(left) else None
