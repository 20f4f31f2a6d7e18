"""Arrays of a row of columns as its compiled functions take them: geometry, solids, grains, water, nappes."""

from typing import NamedTuple

from ryusa.model.arrays import Floats
from ryusa.water.exchange import Ints


class RowShape(NamedTuple):
    """Fixed geometry of a row; segments and stations are numbered downstream."""

    left: Ints  # segment upstream of each station, shape (n_station,)
    right: Ints  # segment downstream of it
    west: Ints  # station at the upstream end of each segment, shape (n_segment,)
    east: Ints  # station at its downstream end
    first: Ints  # lowest cell of each segment that is not solid, shape (n_segment,)
    shut: Ints  # lowest cell of each segment that grains can be in, above dams that seep too
    bed: Ints  # the segments from upstream on, ends included, but for those of air behind aerated sills
    kind: Ints  # OPEN, WALL or INFLOW of each station, shape (n_station,)
    bottom: Floats  # height of the bottom of each segment [m], shape (n_segment,)
    steep: Floats  # 1 + tan**2 of the angle between bottom and x axis at each station [-]
    inertia: Floats  # the same where the pressure is hydrostatic; 1 where one of its own turns the flow
    own: bool  # whether it has a pressure of its own
    inner: tuple[int, int]  # first segment that is not beyond an end, and last one plus one
    dx: float  # length of a segment [m]
    g_z: float  # gravity normal to the x axis [m/s2]


class RowEnds(NamedTuple):
    """What lies beyond the open ends: one segment each, filled anew before each step."""

    segment: Ints  # the segment, shape (n_end,)
    beside: Ints  # its neighbour in the row
    rule: Ints  # DEPTH_GIVEN or SAME_DEPTH
    depth: Floats  # depth for DEPTH_GIVEN, at an inlet over the dam or bed there [m]
    discharge: float  # through a station of kind INFLOW, the first [m2/s]
    shape: Floats  # profile of its speed, to any scale, shape (n,)


class RowMatrix(NamedTuple):
    """Fixed porous solid in the cells of the segments, each of shape (n_segment, n).

    Its force on the water per volume of mixture is rho (linear u + quadratic |u| u), with u in the pores.
    """

    phi: Floats  # concentration [-]
    linear: Floats  # [1/s]
    quadratic: Floats  # [1/m]


class RowGrains(NamedTuple):
    """Action of free grains during a step, as in `Sources`."""

    phi: Floats  # concentration of all grains, fixed ones included, in the segments [-], (n_segment, n)
    force: Floats  # at the stations [N/m3], shape (n_station, n)
    slope: Floats  # [N s/m4], shape (n_station, n)
    carried: Floats  # [-], shape (n_station, n)
    phi_w: Floats  # [m/s], shape (n_station, n)
    laden: bool  # whether there are grains or a porous solid


class RowWater(NamedTuple):
    """State of the water, overwritten by a step."""

    u: Floats  # speed along x [m/s], shape (n_station, n)
    volume: Floats  # water per area of a segment [m], shape (n_segment,)
    content: Floats  # the part in each cell [m], shape (n_segment, n)
    wet: Floats  # wet thickness of each cell [m], shape (n_segment, n)
    surface: Floats  # height of the surface above the bottom, plus z_low [m], shape (n_segment,)
    passed: Floats  # water that has passed each station [m2], shape (n_station,)


class NappeArrays(NamedTuple):
    """Aerated sills of an opened row, and what lands in a step; `n_all` counts the segments of air too."""

    air: Ints  # segment of air behind each sill, and the wall station behind it, shape (n_sill,)
    is_air: Ints  # 1 for such a segment, shape (n_all,)
    free: Ints  # 1 while the water falls freely, 0 while the pool drowns the sill, shape (n_sill,)
    high: Floats  # height of the water that leaves each sill times its discharge [m3/s], shape (n_sill,)
    lands: Floats  # water that lands on each segment, per area and time [m/s], shape (n_all,)
    along: Floats  # its momentum along x, over density and per area and time [m2/s2], shape (n_all,)
    upwards: Floats  # and upwards
    given: Floats  # the momentum along x that each cell of a station takes [m2/s2], shape (n_station, n)
    row: Floats  # work array, shape (n,)
