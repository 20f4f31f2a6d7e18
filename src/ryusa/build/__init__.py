"""From a case to its scene and initial state: places the first grains and draws their random numbers."""

from ryusa.build.array_materials import Material, MaterialPair
from ryusa.build.array_traffic import exit_box, exit_plane, feed_box, feed_disc
from ryusa.build.case import Built, build
from ryusa.build.change import change
from ryusa.build.clumps import random_orientations, with_clumps
from ryusa.build.from_arrays import scene
from ryusa.build.servo import Servo
from ryusa.build.walls import WallMotion, cylinder, disc, rectangle, ridges, triangles

__all__ = [
    "Built",
    "Material",
    "MaterialPair",
    "Servo",
    "WallMotion",
    "build",
    "change",
    "cylinder",
    "disc",
    "exit_box",
    "exit_plane",
    "feed_box",
    "feed_disc",
    "random_orientations",
    "rectangle",
    "ridges",
    "scene",
    "triangles",
    "with_clumps",
]
