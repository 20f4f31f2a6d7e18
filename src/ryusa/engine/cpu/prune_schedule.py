"""When the candidate pairs are pruned anew, and with which reach: chosen from counted work.

The schedule is a row of doubles kept between calls. It never shows in the bits of a run.
"""

import math
from typing import Any

from ryusa.engine.shared.kernel import FAST, inner, kernel
from ryusa.engine.shared.skin import best_skin

SKIN = 0  # reach of the candidates beyond touch [m]
APPROACH = 1  # bound of how much two grains approached beyond what their velocities at the pruning give [m]
SINCE = 2  # steps since the pruning
CANDIDATES = 3  # pairs of all blocks
LEAST = 4  # smallest and largest skin [m]
MOST = 5
TOUCHING = 6  # pairs in touch at the pruning
AHEAD = 7  # steps that it should last
LASTS = 8  # largest number of steps that it lasts
IMAGE_ROOM = 9  # displacement of a pair before another periodic image is the nearest [m]
N_SCHEDULE = 10

# Measured, and fixed so that a run never depends on a clock [ns]: to test a pair of the Verlet list and a
# grain while pruning, to list a candidate, and to test it in a step.
COST_TEST, COST_GRAIN, COST_LIST, COST_CANDIDATE = 7.0, 5.0, 10.0, 3.0
LONGEST = 512.0  # steps after which the list is pruned even if nothing moves
SAFETY = 1.5  # steps that a list is pruned for, over those it should last
ROUNDED_UP = 1.000001  # what keeps a reach from falling short by round-off


@inner(fastmath=FAST, forceinline=False)
def plan_prune(schedule: Any, testing: float) -> None:
    """Choose reach and duration of the next list from the approach since the last pruning.

    Parameters
    ----------
    schedule : by the places named above; updated.
    testing : cost of testing all pairs of the Verlet list.
    """
    since = schedule[SINCE]
    if since == 0.0:
        return
    rate = schedule[APPROACH] / since
    skin = best_skin(
        schedule[SKIN], rate, testing + COST_LIST * schedule[CANDIDATES],
        COST_CANDIDATE * (schedule[CANDIDATES] - schedule[TOUCHING]),
    )  # fmt: skip
    skin = min(max(skin, schedule[LEAST]), schedule[MOST])
    schedule[SKIN] = skin
    schedule[AHEAD] = min(SAFETY * skin / rate, LONGEST) if rate > 0.0 else LONGEST


@kernel()
def steps_ahead(schedule: Any, displacement: float) -> float:
    """Steps that a list may last, given the displacement of the fastest grain in one step [m].

    In a period no longer than the nearest image of a partner stays the nearest.
    """
    if displacement > 0.0:
        free = (schedule[IMAGE_ROOM] - schedule[SKIN]) / (2.0 * displacement)
        return max(math.floor(min(schedule[AHEAD], free)), 1.0)
    return schedule[AHEAD]
