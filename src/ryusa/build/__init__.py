"""From a case to its scene and initial state: places the first grains and draws their random numbers."""

from ryusa.build.case import Built, build
from ryusa.build.change import change
from ryusa.build.from_arrays import scene
from ryusa.build.walls import WallMotion, cylinder, disc, rectangle, ridges, triangles

__all__ = [
    "Built",
    "WallMotion",
    "build",
    "change",
    "cylinder",
    "disc",
    "rectangle",
    "ridges",
    "scene",
    "triangles",
]
