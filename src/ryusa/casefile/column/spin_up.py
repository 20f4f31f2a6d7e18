"""How long the water of a column needs to come up to speed, beside the settling time of the case."""

import math

from ryusa.casefile.case import Case
from ryusa.casefile.column.bed import water_over
from ryusa.casefile.column.schema import ColumnSection
from ryusa.casefile.facts import Derived
from ryusa.casefile.record.schema import ChangeSection
from ryusa.casefile.rows import ExplainRow, Flag, number
from ryusa.laws.spin_up import spin_up_laminar, spin_up_turbulent
from ryusa.laws.turbulence import speed_mean_rough
from ryusa.laws.water import log_law_smooth

REACHED = 0.95  # share of the steady speed at which the water counts as up to speed
FIRST_MODE = 96.0 / math.pi**4  # share of the mean speed that the slowest mode of viscous water lacks at rest


def steady_speed(case: Case, keys: ColumnSection, u_star: float, k_rough: float) -> float:
    """Mean speed of turbulent water over its bed in steady flow, without moving grains [m/s]; nan if unknown.

    Over a smooth bed the speed at depth/e, which is the mean of a logarithmic profile; else the mean of
    Eq. (9), over a loose bed with the roughness of the case.
    """
    depth, wet = water_over(case), case.water
    assert wet is not None
    if keys.bed == "smooth":
        return log_law_smooth(depth / math.e, u_star, wet.viscosity) or math.nan
    return speed_mean_rough(depth, u_star, k_rough) or math.nan


def spin_up_rows(case: Case, derived: Derived, keys: ColumnSection) -> list[ExplainRow]:
    """Time that the water needs from rest; where it starts in steady flow, the time in which it adapts.

    None for drive = "discharge", which holds the discharge from the first step on.

    Notes
    -----
    Of the water alone: grains that move, and side walls, slow the water down and shorten the time. From
    U = U_steady tanh(t/T) (`laws.spin_up`) 95 % are reached after 1.83 T; tests/water/test_spin_up.py
    compares this with columns that were stepped.
    """
    wet = case.water
    assert wet is not None
    if keys.drive == "discharge":
        return []
    depth = water_over(case)
    if keys.mixing == "none":
        scale = spin_up_laminar(depth, wet.viscosity)
        needed, decay, words = scale * math.log(FIRST_MODE / (1.0 - REACHED)), scale, "4 h^2/(pi^2 nu)"
    else:
        speed = steady_speed(case, keys, derived.u_star, derived.k_rough)
        scale = spin_up_turbulent(speed, depth, derived.u_star)
        needed, decay = scale * math.atanh(REACHED), 0.5 * scale
        words = f"U h/u_star^2, U = {speed:.3g} m/s in steady flow"
    if not math.isfinite(needed):
        return []
    # after the last change of slope the water adapts once more
    changed = max([change.at for change in case.timeline if _tilts(change)], default=0.0)
    left, alone = case.record.settle - changed, "; of water alone, moving grains shorten it"
    if keys.start == "rest" or (keys.start is None and wet.drag == "none"):
        short = left < needed
        origin = f"from rest to {REACHED:.0%} of steady flow, {needed / scale:.3g} T, T = {words}{alone}"
        if short:
            origin += (
                f"; record.settle, {case.record.settle:g} s, is shorter: averages will include the start"
            )
        return [number("water", "time to come up to speed", needed, "s", origin, "warning" if short else "")]
    flag: Flag = "note" if left < decay else ""
    origin = f"the water starts in steady flow; a difference from it decays as exp(-t/{decay:.3g} s)"
    share = "T/2, T = " if keys.mixing != "none" else ""
    origin += f", {share}{words}{alone}"
    if flag:
        origin += f"; record.settle is {case.record.settle:g} s: see whether averages are steady"
    return [number("water", "time to adapt", decay, "s", origin, flag)]


def _tilts(change: "ChangeSection") -> bool:
    return change.slope is not None or change.slope_angle is not None
