"""A run folder as read-only arrays."""

from ryusa.results.lazy import LazyFrames
from ryusa.results.read import Bed, Frame, Frames, Grains, Planes, Results

__all__ = ["Bed", "Frame", "Frames", "Grains", "LazyFrames", "Planes", "Results"]
