"""What the water of a case does: its speed over height, its drag, and how fast a grain settles in it."""

import math
from collections.abc import Iterator

from ryusa.casefile.derive import mass
from ryusa.casefile.grains import sizes, water_over
from ryusa.casefile.schema import Case
from ryusa.errors import CaseError
from ryusa.laws import drag, hindrance, water
from ryusa.model.column import STIFF


def water_speed(case: Case, z: float) -> float:
    """Speed of the water [m/s] at a height z above the zero of its profile [m]; 0 when dry."""
    wet = case.water
    if wet is None:
        return 0.0
    if wet.profile == "column":
        return _steady_speed(case, z)
    if wet.depth is not None and z > wet.depth:
        if wet.above == "dry":
            return 0.0
        z = wet.depth if wet.above == "hold" else z
    if wet.profile == "log rough":
        return water.log_law_rough(z, case.derived.u_star, case.derived.k_rough)
    if wet.profile == "log smooth":
        return water.log_law_smooth(z, case.derived.u_star, wet.viscosity)
    return water.uniform(z, wet.speed) if wet.speed is not None else 0.0


def _steady_speed(case: Case, z: float) -> float:
    """Speed to expect of a steady column [m/s], z above its bed, by its log law; 0 in still water."""
    wet, u_star = case.water, case.derived.u_star
    assert wet is not None
    if math.isnan(u_star):
        return 0.0
    z = min(z, water_over(case))
    if wet.column is not None and wet.column.bed == "smooth":
        return water.log_law_smooth(z, u_star, wet.viscosity)
    return water.log_law_rough(z, u_star, case.derived.k_rough)


def hindrance_exponent(case: Case) -> float:
    """Exponent of a case's hindrance [-]: the one given, or Rowe's n of a lone grain's settling velocity."""
    wet = case.water
    assert wet is not None
    if wet.hindrance_exponent is not None:
        return wet.hindrance_exponent
    settling = terminal_velocity(case)
    if not math.isfinite(settling):
        settling = 0.0
    return hindrance.exponent_rowe(drag.reynolds(settling, sizes(case)[0], wet.viscosity))


def drag_coefficient(case: Case, re: float) -> float:
    """C_D of a case at a grain Reynolds number [-]."""
    assert case.water is not None
    if case.water.drag == "constant":
        return case.water.drag_coefficient
    if case.water.drag == "none":
        return 0.0
    return _C_D[case.water.drag](re)


_C_D = {
    "24/Re+0.4": drag.c_d_re_04,
    "24/Re+2": drag.c_d_re_2,
    "Schiller-Naumann": drag.c_d_schiller_naumann,
    "Ferguson-Church sphere": drag.c_d_ferguson_church_sphere,
    "Ferguson-Church sand": drag.c_d_ferguson_church_sand,
}


def terminal_velocity(case: Case) -> float:
    """Settling velocity of the mean grain [m/s]; inf when nothing holds it, nan when it floats."""
    d, wet = sizes(case)[0], case.water
    m_weight = mass(case, d)[2]
    if wet is None or wet.drag == "none":
        return math.inf
    if m_weight < 0.0:
        return math.nan
    pull, low, high = m_weight * case.motion.gravity, 0.0, 1.0e4
    for _ in range(200):
        w = 0.5 * (low + high)
        c_d = drag_coefficient(case, drag.reynolds(w, d, wet.viscosity))
        if drag.drag_factor(w, c_d, wet.density, wet.shape_area, d) * w > pull:
            high = w
        else:
            low = w
    return 0.5 * (low + high)


def check_drag_step(case: Case) -> Iterator[CaseError]:
    """Find a time step too long for the drag of the smallest grain, alone and at its settling velocity.

    Drag is explicit: beyond one drag time in a step a slip changes its sign, beyond two it grows without end.
    An exchange of a column takes at least one step, and no more than a quarter of that time.
    """
    wet, dt = case.water, case.derived.dt
    if wet is None or wet.drag == "none":
        return
    d, speed = sizes(case)[1], terminal_velocity(case)
    if not 0.0 < speed < math.inf:
        speed = 1.0e-3 * wet.viscosity / d  # no weight: slow enough for Stokes' drag
    c_d = drag_coefficient(case, drag.reynolds(speed, d, wet.viscosity))
    rate = drag.drag_factor(speed, c_d, wet.density, wet.shape_area, d) / sum(mass(case, d)[:2])
    column = wet.profile == "column"
    most = STIFF if column else 1.0
    if dt * rate > most:
        key = "steps_per_contact" if case.time.step is None else "step"
        share = f"a quarter of that, {most / rate:.3g} s" if column else "that"
        yield CaseError(
            f"time.{key}",
            getattr(case.time, key),
            f"dt = {dt:.3g} s is too long for the water: drag stops the smallest grain within "
            f"{1.0 / rate:.3g} s, and dt must be below {share}; take a shorter step, larger grains or a "
            "thinner fluid",
        )
