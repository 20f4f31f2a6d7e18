"""What the water of a case does: friction velocity, speed over height, drag and settling velocity."""

import math

from ryusa.casefile.builders.values import sizes
from ryusa.casefile.case import Case
from ryusa.casefile.column.bed import water_over
from ryusa.casefile.facts import Derived
from ryusa.casefile.grains.values import mass
from ryusa.laws import drag, hindrance, water
from ryusa.laws._family import evaluate
from ryusa.laws.families import Drag, DragOfForm, Profile
from ryusa.model.clump import Clump, drag_form


def u_star_given(case: Case) -> float:
    """Friction velocity at water.zero given by water.tau_star or water.u_star [m/s]; nan without either."""
    wet = case.water
    if wet is None:
        return math.nan
    if wet.tau_star is not None:
        d, g = sizes(case)[0], case.motion.gravity
        return water.u_star_from_tau_star(wet.tau_star, case.grains.density, wet.density, g, d)
    return math.nan if wet.u_star is None else wet.u_star


def water_speed(case: Case, derived: Derived, z: float) -> float:
    """Speed of the water [m/s] at a height z above the zero of its profile [m]; 0 in a dry case."""
    wet = case.water
    if wet is None:
        return 0.0
    if wet.profile == "column":
        return _steady_speed(case, derived, z)
    if wet.depth is not None and z > wet.depth:
        if wet.above == "dry":
            return 0.0
        z = wet.depth if wet.above == "hold" else z
    return evaluate(
        Profile.of(wet.profile), z=z, u_star=derived.u_star, k_rough=derived.k_rough, nu=wet.viscosity,
        speed=wet.speed or 0.0,
    )  # fmt: skip


def _steady_speed(case: Case, derived: Derived, z: float) -> float:
    """Speed of a column in steady flow at height z above its bed [m/s], by its log law; 0 in still water."""
    wet, u_star = case.water, derived.u_star
    assert wet is not None
    if math.isnan(u_star):
        return 0.0
    z = min(z, water_over(case))
    if wet.column is not None and wet.column.bed == "smooth":
        return water.log_law_smooth(z, u_star, wet.viscosity)
    return water.log_law_rough(z, u_star, derived.k_rough)


def hindrance_exponent(case: Case) -> float:
    """Exponent of the hindrance [-]: the one given, or Rowe's n at the settling velocity of one grain."""
    wet = case.water
    assert wet is not None
    if wet.hindrance_exponent is not None:
        return wet.hindrance_exponent
    settling = terminal_velocity(case)
    if not math.isfinite(settling):
        settling = 0.0
    return hindrance.exponent_rowe(drag.reynolds(settling, sizes(case)[0], wet.viscosity))


def drag_coefficient(case: Case, re: float, form: Clump | None = None) -> float:
    """C_D of a case at a grain Reynolds number [-], of a sphere or of a clump."""
    wet = case.water
    assert wet is not None
    law, of_form = Drag.of(wet.drag), DragOfForm.of(wet.drag_of_form)
    if law == Drag.NONE:
        return 0.0
    if form is None or of_form == DragOfForm.SPHERE:
        return evaluate(law, re=re, c_d=wet.drag_coefficient)
    stokes, newton, sphericity = drag_form(of_form, form, case.grains.density / wet.density)
    return evaluate(of_form, re=re, stokes=stokes, newton=newton, sphericity=sphericity)


def terminal_velocity(case: Case, form: Clump | None = None) -> float:
    """Settling velocity of the mean grain [m/s]; inf without drag, nan for a grain that floats.

    Of a sphere, or of a clump of the same volume.
    """
    d, wet = sizes(case)[0], case.water
    m_weight = mass(case, d)[2]
    if wet is None or wet.drag == "none":
        return math.inf
    if m_weight < 0.0:
        return math.nan
    pull, low, high = m_weight * case.motion.gravity, 0.0, 1.0e4
    for _ in range(200):
        w = 0.5 * (low + high)
        if w in (low, high):  # no number lies between: further halving changes nothing
            break
        c_d = drag_coefficient(case, drag.reynolds(w, d, wet.viscosity), form)
        if drag.drag_factor(w, c_d, wet.density, wet.shape_area, d) * w > pull:
            high = w
        else:
            low = w
    return 0.5 * (low + high)
