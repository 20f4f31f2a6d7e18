"""ryusa (流砂): every grain of sand, gravel or debris in moving water, by the distinct element method."""

__version__ = "0.1.0"
