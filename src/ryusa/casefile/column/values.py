"""Friction velocity of a column of water in steady flow."""

import math

from ryusa.casefile.case import Case
from ryusa.casefile.column.bed import water_over
from ryusa.casefile.column.packed import packed
from ryusa.casefile.motion import slope_at_last
from ryusa.casefile.water.values import u_star_given
from ryusa.laws import water


def column_u_star(case: Case, k_rough: float) -> float:
    """Friction velocity of a column at the top of its bed in steady flow [m/s]; nan if nothing drives it.

    A discharge is taken as that of Eq. (9), whose mean over the depth is the speed at depth/e. The driver
    "tau_star" gives the stress at the zero of the water; the water in the pores of loose grains above that
    level is driven too.
    """
    wet = case.water
    assert wet is not None
    keys, depth = case.column, water_over(case)
    if not depth > 0.0:
        return math.nan
    if keys.discharge is not None:
        unit = water.log_law_rough(depth / math.e, 1.0, k_rough)
        return abs(keys.discharge) / depth / unit if unit > 0.0 else math.nan
    along = case.motion.gravity * math.sin(slope_at_last(case.motion, case.timeline))
    pull = along + (keys.pressure_gradient or 0.0) / wet.density
    if keys.drive == "tau_star" and wet.depth is not None:
        if depth == wet.depth:
            return u_star_given(case)
        within = depth + max(wet.depth - depth, 0.0) * (1.0 - packed(case))
        pull += (u_star_given(case) ** 2 - along * within) / wet.depth
    return math.sqrt(abs(pull) * depth) or math.nan
