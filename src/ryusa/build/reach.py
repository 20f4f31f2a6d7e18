"""Grains and water that a feeder reach supplies at the upper end of a river."""

import math

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.row.reach import NAME, FeederReach
from ryusa.casefile.row.reach_source import reach_of, repeated
from ryusa.casefile.row.values import bottom_points, inlet_depth, inlet_tilt, row_plan
from ryusa.model import Arrivals, Feed
from ryusa.model.arrays import Floats
from ryusa.model.row import EndKind, RowEnd


def reach_feed(case: Case, number: int, first: int) -> tuple[Feed, Arrivals, Floats] | None:
    """Feed of a feeder reach, when and where its grains come, and their diameters [m]; None without one.

    Parameters
    ----------
    number : of the feed.
    first : id of its first grain.

    Notes
    -----
    Directions and heights of the reach belong to its bed, which is its x axis; here they are turned to the
    bottom at the upper end, and heights are taken along z.
    """
    reach, end = reach_of(case), case.stop.time
    if reach is None or end is None:
        return None
    came, tilt = repeated(case, reach), inlet_tilt(case)
    v, omega = _turned(reach.v[came.which], tilt), _turned(reach.omega[came.which], tilt)
    d = reach.d[came.which]
    arrivals = Arrivals(
        number, came.t, came.y, reach.height[came.which] / math.cos(tilt), v, omega,
    )  # fmt: skip
    for name in ("t", "y", "height", "v", "omega"):
        getattr(arrivals, name).flags.writeable = False
    plan, (x, z) = row_plan(case), bottom_points(case)[0]
    fastest = v[int(np.argmax(np.linalg.norm(v, axis=1)))]
    feed = Feed(
        NAME, low=(x, 0.0, z), high=(x + float(d.max()), reach.width, z + plan.n_cell * plan.cell),
        velocity=(float(fastest[0]), float(fastest[1]), float(fastest[2])), rate=len(d) / end, end=end,
        first=first, count=len(d),
    )  # fmt: skip
    return feed, arrivals, d


def reach_end(case: Case, reach: FeederReach) -> RowEnd:
    """The inlet that lets in the mean flow of a feeder reach, with its profile over the bed."""
    plan = row_plan(case)
    z = (np.arange(plan.n_cell) + 0.5) * plan.cell
    profile = np.interp(z * math.cos(inlet_tilt(case)), reach.z, reach.u)
    profile.flags.writeable = False
    depth = inlet_depth(case)
    return RowEnd(
        EndKind.DISCHARGE,
        discharge=reach.discharge,
        profile=profile,
        depth=math.nan if depth is None else depth,
    )


def _turned(vectors: Floats, angle: float) -> Floats:
    """Vectors of the reach along a bottom that rises at an angle to the x axis [rad], shape (n, 3)."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = vectors.T
    return np.ascontiguousarray(np.stack([c * x - s * z, y, s * x + c * z], axis=1))
