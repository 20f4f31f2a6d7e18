"""When the candidate pairs are pruned anew, and with which reach: chosen from counted work.

The schedule is a row of doubles kept between calls. It never shows in the bits of a run.
"""

import math
from typing import Any

from ryusa.engine.shared.kernel import inner, kernel
from ryusa.engine.shared.skin import best_skin

# The near list's own clock, kept between calls; it never shows in the bits.
SKIN = 0  # reach of the near list beyond touch [m]
APPROACH = 1  # how much nearer two grains may be than if each had kept its velocity since then [m]
SINCE = 2  # steps since
CANDIDATES = 3  # lanes of all blocks
LEAST = 4  # smallest and largest skin [m]
MOST = 5
TOUCHING = 6  # pairs in touch when it was cut
AHEAD = 7  # steps it should last
LASTS = 8  # steps it does last at most
IMAGE_ROOM = 9  # how far a pair may move before another image of it is the nearer one [m]
N_SCHEDULE = 10

# Measured, and fixed so that a run never depends on a clock [ns]: to look at a pair of the wide list and at a
# grain while the near list is cut, to list a near pair, and to look at it in a step.
COST_LOOK, COST_GRAIN, COST_LAY, COST_NEAR = 7.0, 5.0, 10.0, 3.0
LONGEST_CUT = 512.0  # steps after which the near list is cut though nothing moves
LOOK_AHEAD = 1.5  # steps a near list is cut for, over those it should last
ROUNDED_UP = 1.000001  # what keeps a reach from falling short by round-off


@inner()
def plan_prune(schedule: Any, look: float) -> None:
    """Choose reach and time ahead of the next near list from how the last one fared.

    Parameters
    ----------
    clock : places K_ of rows.py.
    look : cost of looking at all pairs of the wide list.
    """
    since = schedule[SINCE]
    if since == 0.0:
        return
    rate = schedule[APPROACH] / since
    skin = best_skin(
        schedule[SKIN], rate, look + COST_LAY * schedule[CANDIDATES],
        COST_NEAR * (schedule[CANDIDATES] - schedule[TOUCHING]),
    )  # fmt: skip
    skin = min(max(skin, schedule[LEAST]), schedule[MOST])
    schedule[SKIN] = skin
    schedule[AHEAD] = min(LOOK_AHEAD * skin / rate, LONGEST_CUT) if rate > 0.0 else LONGEST_CUT


@kernel()
def steps_ahead(schedule: Any, way: float) -> float:
    """Steps a near list may last, where the fastest grain goes `way` in one [m].

    In a period no more than leave the nearest image of a partner the one that matters.
    """
    if way > 0.0:
        return max(
            math.floor(min(schedule[AHEAD], (schedule[IMAGE_ROOM] - schedule[SKIN]) / (2.0 * way))), 1.0
        )
    return schedule[AHEAD]
