"""Rows of `ryusa check` about the feeder reach of a river."""

import math

from ryusa.casefile.case import Case
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.motion import slope
from ryusa.casefile.row.reach import KEY
from ryusa.casefile.row.reach_source import fed_by_reach_in_all, reach_of
from ryusa.casefile.row.values import inlet_tilt, reach_froude
from ryusa.casefile.rows import ExplainRow, Flag, count, number

CLOSE = 0.01  # relative difference of slopes or of diameters from which `check` notes it
COARSE = 0.25  # of a diameter, error of a height from which `check` notes the frames of the reach
KNOWN = 0.1  # relative standard error of its transport from which `check` notes it


def reach_rows(case: Case) -> list[ExplainRow]:
    """Rows about what a feeder reach supplies; none without one."""
    reach, end = reach_of(case), case.stop.time
    if reach is None or end is None:
        return []
    share = reach.error / reach.solid_discharge if reach.solid_discharge > 0.0 else math.inf
    known = f"standard error {reach.error:.2g} m2/s, {100.0 * share:.2g} %, of {len(reach.t)} grains"
    froude = reach_froude(case)
    fast = "supercritical: nothing in the river acts back on it"
    slow = (
        "subcritical: the river's depth at its upper end is its own; where it differs from that of the "
        "reach, the load is not that which the flow carries there"
    )
    found = [
        number("water", "q_s of the reach", reach.solid_discharge, "m2/s", known, _if(share > KNOWN)),
        number("water", "depth of the reach", reach.depth, "cm", "over its bed line, mean"),
        number(
            "water", "Froude number of the reach", froude, "-", fast if froude > 1.0 else slow,
            _if(froude <= 1.0),
        ),
        number(
            "water", "record of the reach", reach.duration, "s",
            f"{KEY}; entered {end / reach.duration:.3g} times in stop.time",
        ),
        count("water", "grains from the reach", fed_by_reach_in_all(case), "crossings of its downstream end"),
    ]  # fmt: skip
    theirs, ours = math.tan(reach.slope), math.tan(slope(case.motion) - inlet_tilt(case))
    if abs(theirs - ours) > CLOSE * abs(theirs):
        about = (
            f"the bottom at the upper end of the river falls at {ours:.4g}: it carries on "
            f"{'less' if ours < theirs else 'more'} than the reach brings"
        )
        found.append(number("water", "slope of the reach", theirs, "-", about, "note"))
    d, mean = reference_diameter(case), float(reach.d.mean())
    if abs(mean - d) > CLOSE * d + 3.0 * float(reach.d.std()) / math.sqrt(len(reach.d)):
        about = f"mean of the grains that cross its end; that of [grains] is {100.0 * d:.4g} cm"
        found.append(number("water", "diameter of the reach's grains", mean, "cm", about, "note"))
    low = case.motion.gravity * reach.frames**2 / 8.0
    if low > COARSE * d:
        about = (
            f"between two frames of the reach a grain in flight crosses up to {100.0 * low:.2g} cm too low, "
            f"g dt^2/8: record its frames every {math.sqrt(8.0 * COARSE * d / case.motion.gravity):.2g} s"
        )
        found.append(number("water", "frames of the reach", reach.frames, "s", about, "note"))
    return found


def _if(noted: bool) -> Flag:
    return "note" if noted else ""
