"""Reach of a neighbour list beyond touch, chosen from counted work."""

import math

from ryusa.engine.shared.kernel import FAST, kernel


@kernel(fastmath=FAST)
def best_skin(skin: float, closing: float, making: float, keeping: float) -> float:
    """Reach of a list beyond touch that costs least [m]; at most twice, at least half of what it is.

    Parameters
    ----------
    skin : its reach now [m].
    closing : how much nearer two grains may come in a step [m]: a list lasts skin/closing steps.
    making : cost of making the list.
    keeping : cost in each step of its pairs that do not touch; their number goes with the skin.

    Notes
    -----
    The cost of a step, making closing/s + keeping s/skin, is least at s = sqrt(making closing skin/keeping).
    """
    if keeping <= 0.0:
        return 2.0 * skin
    return min(max(math.sqrt(making * closing * skin / keeping), 0.5 * skin), 2.0 * skin)
