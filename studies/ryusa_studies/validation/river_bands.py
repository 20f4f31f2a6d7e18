"""How large the errors of a row of columns may be (`river`): registered before its first run.

Most limits are twice the error that a throw-away prototype of the same equations had on the same grid; the
reason names it. The others are round-off.
"""

import math
from collections.abc import Mapping

from ryusa.study.judge import Band, at_most


def _twice(error: float, unit: str = "-") -> Band:
    """Twice the error of the prototype."""
    return at_most(2.0 * error, f"twice the error of the prototype, {error:g}", unit)


STILL = at_most(1e-12, "round-off of the surface's slope", "m/s")
MASS = at_most(1e-14, "round-off of 10,000 steps")
SAME_BITS = at_most(0.0, "one period of one column is the column")
RITTER_DEPTH: Mapping[int, Band] = {  # by the thickness of a segment [mm]
    5: _twice(0.0013),
    10: _twice(0.0035),
}
RITTER_FRONT = _twice(0.05)  # where the depth is a hundredth of the first one: 0.96 of 1.01 m
STOKER: Mapping[str, tuple[Band, Band]] = {  # depth and speed of the plateau, by the depth ahead
    "0.02 m": (_twice(0.0004), _twice(0.002)),
    "0.002 m": (_twice(0.006), _twice(0.011)),
    "0.02 m, 20 levels": (_twice(0.004), _twice(0.014)),
}
STOKER_FRONT = at_most(0.02, "twice one segment of 10 mm", "m")
STOKER_FRONT_LEVELS = _twice(0.04)  # levels that do not mix are not one layer
UNIFORM: Mapping[str, tuple[Band, Band]] = {  # profile over the speed of the surface, and discharge; by slope
    "0.002": (_twice(3e-4), _twice(3e-4)),
    "0.01": (_twice(8e-3), _twice(3e-3)),
    "0.05": (_twice(4e-6), _twice(1e-5)),
}
BACKWATER = _twice(0.00008, "m")
BREAK_STEEP = _twice(0.003)  # depth on the steep reach
BREAK_BEFORE = _twice(0.017)  # depth before the jump
BREAK_BEHIND = _twice(0.002)  # depth behind it
JUMP_PLACE = _twice(0.11, "m")  # segments of 2 cm
DROP = at_most(0.001, "the prototype's 0.544 is exact in its three digits")
WEIR: Mapping[int, Band] = {  # against critical flow without loss, (2/3)**1.5; by segments of the crest
    1: _twice(0.011),
    2: _twice(0.070),
    3: _twice(0.096),
    5: _twice(0.116),
    10: _twice(0.127),
}
DARCY: Mapping[int, tuple[Band, Band]] = {  # discharge, and surface over the upper depth; by segments across
    20: (_twice(0.032), _twice(0.016)),
    40: (_twice(0.015), _twice(0.009)),
    80: (_twice(0.007), _twice(0.005)),
}
ERGUN: Mapping[int, Band] = {20: _twice(0.021), 40: _twice(0.009), 80: _twice(0.003)}
INCLINED = at_most(0.01, "the wall's logarithm at cos(10 deg) of its height: 0.5 % of the speed")
# Bed load in a row and in one column: two samples of four seeds differ by more than this many standard errors
# in one case of a hundred (Student, 6 degrees of freedom, both sides).
REACH_APART = at_most(3.71, "one comparison of a hundred by chance alone: Student, 6 degrees of freedom")
_SAYS = "more, and the comparison would say little"
REACH_ERROR: Mapping[str, Band] = {  # standard error of the difference over the mean
    "q_star": at_most(0.15, _SAYS),
    "discharge": at_most(0.03, _SAYS),
    "u_high": at_most(0.03, _SAYS),
    "u_low": at_most(0.15, _SAYS),
    "phi_low": at_most(0.15, _SAYS),
    "height": at_most(0.03, _SAYS),
}
REACH_CLOSES = at_most(1e-9, "round-off of the sums over grains")
# Discharge through settled grains in a row, against Ergun's law with their own concentration: 3 % allow for a
# concentration that varies between the layers.
OWN_PACKING = at_most(0.03, "grains of a packing meet concentrations that vary about their mean")
# A delta grows into a pool: its front moves by its balance if its shape is steady, and segments of three
# diameters leave some per cent of its way uncertain.
DELTA_KEPT = at_most(1e-12, "round-off of the sum of masses")
DELTA_SPEED = Band(0.95, 1.05, "-", "the shape of the front is steady: 5 %")
DELTA_ANGLE = Band(-2.0, 2.0, "deg", "the front is a slope at the angle of repose of the same grains")
# A wave of a loose bed against linear theory (design/0028) with the transport over even beds, nothing fitted.
EXNER_DECAY = Band(0.8, 1.2, "-", "20 %: 10 % allowed for dq_s/dS, and q_s adapts over 10 to 20 d")
EXNER_CELERITY: Mapping[str, Band] = {
    "tranquil": Band(0.0, math.inf, "m/s", "downstream below a Froude number of 1"),
    "rapid": Band(-math.inf, 0.0, "m/s", "upstream above it"),
}
EXNER_FROUDE: Mapping[str, Band] = {
    "critical": Band(0.9, 1.1, "-", "where the way of adaptation changes the decay to second order alone"),
    "tranquil": Band(0.6, 0.8, "-", "about 0.7"),
    "rapid": Band(1.25, 1.55, "-", "about 1.4"),
}
# The deposit behind a dam with the transport over even beds, nothing fitted (design/0028).
DAM_KEPT = at_most(1e-12, "round-off of the sum of volumes over the width", "m2")
DAM_SLOPE = Band(0.85, 1.15, "-", "15 %: 10 % allowed for dq_s/dS, 5 % for the slope of the bed")
DAM_VOLUME = Band(0.85, 1.15, "-", "15 %: as its slope, and half a diameter of the height of the dam")
AT_REST = at_most(1e-3, "a thousandth of a diameter in 0.2 s, on a level bed under still water")
# Debris flows (`river_debris`): formulae of steady flow, given what is measured in the same run.
DEBRIS_GROWTH = Band(0.8, 1.2, "-", "the flow still grows, and its bed creeps: 20 %")
DEBRIS_STOP = Band(0.7, 1.3, "-", "one depth and one speed for the whole flow: 30 %")
_MORE = "more grains than equilibrium, and the bed must rise"
DEBRIS_SIGN: Mapping[str, tuple[Band, Band]] = {  # concentration over that of equilibrium; rise of the bed
    "below": (at_most(1.0, "less than equilibrium"), Band(-math.inf, 0.0, "m/s", "the bed is eroded")),
    "above": (Band(1.0, math.inf, "-", _MORE), Band(0.0, math.inf, "m/s", "grains are deposited")),
}
# A grid holds nearly all of a debris flow back where a grain barely passes, and little where three pass.
GRID_HOLDS = Band(0.8, 1.0, "-", "Ikeya & Uehara 1980, as quoted: it jams below 1.5")
GRID_PASSES = at_most(
    0.2, "registered before the runs from memory, that it passes above 2 to 3; not found in a source"
)
GRID_FALLS = Band(-math.inf, 0.05, "-", "a rise of some grains of a hundred is chance")
# A bed that is fed half as much again as it carries on, with linear theory and the transport over even beds,
# nothing fitted (design/0028). The extra feed changes the slope by a third, which is not small.
OVERLOAD_RISE = Band(
    0.75, 1.25, "-", "25 %: 10 % allowed for dq_s/dS, and the change of slope is a third of it"
)
OVERLOAD_SHAPE = at_most(
    0.2, "a fifth: the bed fluctuates by a tenth of a diameter, and q_s adapts over 20 d"
)
# A dam break over a loose bed, by the signs that experiments give (design/0028); over a rigid bed none shows.
DAM_BREAK_SCOUR = Band(
    1.0,
    math.inf,
    "-",
    "at least one diameter: Capart & Young 1998, the wave scours; the bed is known to half of one",
)
DAM_BREAK_RISE = Band(
    0.05,
    math.inf,
    "-",
    "Capart & Young 1998: a jump forms near the centre of the wave; Ritter's surface falls",
)
DAM_BREAK_LEAD = Band(0.0, math.inf, "-", "grains lead: more of them at the front than at the gate")
DAM_BREAK_REACH = Band(0.9, 1.0, "-", "moving grains reach the surface at the front, to a tenth of the depth")
# A wall reflects a bore; the front of a debris flow strikes a dam.
BORE_DEPTH = at_most(0.01, "one layer in segments of a sixth of the depth")
BORE_WAY = at_most(0.02, "half a segment, and the time in which the bore forms")
FRONT_FORCE = Band(
    0.7, 1.3, "-", "30 %: one fluid with one speed, as for the way of a front, and hydrostatic pressure"
)
# The energy account of the water (design/0027): what is left over, and losses of known size.
ENERGY_CLOSES = at_most(1e-12, "round-off of the sums over cells and steps")
ENERGY_BORE = Band(0.98, 1.02, "-", "2 %: the depth behind the bore is known to half a per cent")
ENERGY_UNIFORM = at_most(1e-4, "the discharge of uniform flow is within 1e-5 of that of one column")
# A river fed by a reach over the same bed keeps its bed. The reach's q_s has a standard error of 1.4 % over
# 40 s, so 3.4 % over 7 s; two of them for what enters and two for what leaves are 9 %. 5 % are allowed for a
# bed that is not yet sorted by size as that of the reach is, and through which another share of water flows.
FEEDER_BED = Band(-0.15, 0.15, "-", "15 % of q_s: two standard errors at both ends, and 5 % for another bed")
FEEDER_PASSED = Band(
    0.96, 1.04, "-", "4 %: what moves within the period at one moment, over what passes in the record"
)
FEEDER_WAITING = at_most(0.01, "one grain of a hundred waits for a place at the end")
FEEDER_DISCHARGE = at_most(1e-12, "round-off of the sum over cells")
