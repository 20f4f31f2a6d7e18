"""The energy account of the water of a row: its terms, and what they leave over."""

from enum import IntEnum
from typing import Any

import numpy as np

from ryusa.model.arrays import Floats


class RowTerm(IntEnum):
    """Terms of the account, per width [J/m]: two changes since the start, what is given, what is lost.

    Energy given to the water and energy lost by it are positive. The equations are in `water.row_energy`.
    """

    KINETIC = 0  # change of (1/2) rho U**2 over stations, and with a pressure of its own of (1/2) rho W**2
    POTENTIAL = 1  # change of rho g_z z of the water, without that of the grains
    GRAVITY = 2  # given by gravity along the axis
    DRIVER = 3  # given by an imposed pressure gradient
    UPSTREAM = 4  # given at the upstream end: energy that enters, and work of pressure
    DOWNSTREAM = 5  # the same at the downstream end; negative where water leaves
    GRAINS = 6  # given by the forces of grains, without that of the slope of the surface
    DISPLACED = 7  # given by grains that displace water
    BED = 8  # lost by the shear stress at the bottom
    SIDE = 9  # lost at side walls
    SHEAR = 10  # lost by the stress between cells
    POROUS = 11  # lost by the drag of a porous solid
    FALL = 12  # lost where water falls, plunges, strikes a wall or a dam, or leaves a cell that runs dry
    UPWIND = 13  # lost by momentum that is carried with the speed upstream of a border between cells
    LATE = 14  # lost by the implicit step in time
    SURFACE = 15  # lost by the explicit surface, of which pressure of its own is one; negative at times


N_ROW_TERM = len(RowTerm)
CHANGES = (RowTerm.KINETIC, RowTerm.POTENTIAL)
ROW_GIFTS = (
    RowTerm.GRAVITY, RowTerm.DRIVER, RowTerm.UPSTREAM, RowTerm.DOWNSTREAM, RowTerm.GRAINS, RowTerm.DISPLACED,
)  # fmt: skip
ROW_LOSSES = (
    RowTerm.BED, RowTerm.SIDE, RowTerm.SHEAR, RowTerm.POROUS, RowTerm.FALL, RowTerm.UPWIND, RowTerm.LATE,
    RowTerm.SURFACE,
)  # fmt: skip


def row_imbalance(account: Floats) -> Any:
    """What the terms leave over [J/m]: changes - gifts + losses; account (..., N_ROW_TERM)."""
    sign = np.ones(N_ROW_TERM)
    sign[list(ROW_GIFTS)] = -1.0
    return account @ sign
