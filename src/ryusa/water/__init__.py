"""Water over a bed as a column of cells: closures, driving force, implicit time step, steady flow."""

from ryusa.water.drive import discharge, driving_stress, friction_velocity
from ryusa.water.solve import advance
from ryusa.water.steady import steady

__all__ = ["advance", "discharge", "driving_stress", "friction_velocity", "steady"]
