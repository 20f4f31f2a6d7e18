"""Case to scene and first state: places the first grains and draws every random number of the start."""

from ryusa.build.case import Built, build
from ryusa.build.change import change
from ryusa.build.script import scene

__all__ = ["Built", "build", "change", "scene"]
