"""A run folder as read-only arrays."""

from ryusa.results.frames import BodyFrames, Frame, Frames
from ryusa.results.lazy import LazyFrames
from ryusa.results.presentation import Results
from ryusa.results.read import Bed, Grains, Planes

__all__ = ["Bed", "BodyFrames", "Frame", "Frames", "Grains", "LazyFrames", "Planes", "Results"]
