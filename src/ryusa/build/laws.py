"""Laws of a scene, from a case."""

import math
from dataclasses import replace
from typing import Any

from ryusa.build.assemble import Laws
from ryusa.build.column import zero_of
from ryusa.casefile.case import Case
from ryusa.casefile.choices import chosen
from ryusa.casefile.contact.values import is_hertz, law_of
from ryusa.casefile.facts import Derived
from ryusa.casefile.films import film_reach
from ryusa.casefile.grains.values import slab_width
from ryusa.casefile.record.values import events_of
from ryusa.casefile.shape import has_clumps
from ryusa.casefile.water.values import hindrance_exponent
from ryusa.laws.families import (
    Above,
    Arm,
    Buoyancy,
    Cap,
    Drag,
    DragOfForm,
    Hindrance,
    Lift,
    Magnus,
    Profile,
    Rebound,
    Rolling,
    Slip,
    WaterTorque,
)
from ryusa.model import ContactLaw, RollingLaw, Water
from ryusa.model.scene import Damping, EventRule


def laws_of(case: Case, derived: Derived, z_zero: float) -> Laws:
    """Laws of a case; `z_zero` [m] is the origin of the water profile if the case gives none."""
    return Laws(
        density=case.grains.density,
        a_3=case.grains.shape_volume,
        contact=contact_of(case),
        dt=derived.dt,
        rolling=rolling_of(case),
        water=water_of(case, derived, z_zero),
        g=derived.g,
        slope=derived.slope,
        rotation=case.motion.rotation == "free",
        plane_case=case.motion.plane,
        slab_width=slab_width(case) if case.motion.plane else math.nan,
        overlap_limit=case.domain.overlap_limit,
        events=EventRule[events_of(case).upper()],
        forces=case.record.forces,
        tracked=case.record.tracked,
        low=case.domain.low,
        high=case.domain.high,
    )


def contact_of(case: Case) -> ContactLaw:
    """Contact law of a case."""
    law, contact = law_of(case), case.contact
    if is_hertz(contact):
        return law
    law = replace(law, slip=Slip.of(contact.slip), cap=chosen(case, Cap))
    if contact.restitution is not None:
        return law
    eta_n, eta_s = contact.damping or 0.0, contact.shear_damping or 0.0
    return replace(law, damping=Damping.CONSTANTS, zeta_n=0.0, zeta_s=0.0, eta_n=eta_n, eta_s=eta_s)


def rolling_of(case: Case) -> RollingLaw:
    """Rolling friction of a case."""
    rolling = case.rolling
    return RollingLaw(
        model=Rolling.of(rolling.model),
        arm=chosen(case, Arm),
        coefficient=rolling.coefficient,
        stiffness_factor=rolling.stiffness_factor,
        zeta_r=rolling.damping_ratio,
        twisting=rolling.twisting_coefficient,
    )


def water_of(case: Case, derived: Derived, z_zero: float) -> Water:
    """Water of a case; profile NONE when dry."""
    water, found = case.water, derived
    if water is None:
        return Water()
    return Water(
        profile=Profile.of(water.profile),
        u_star=0.0 if math.isnan(found.u_star) else found.u_star,
        k_rough=found.k_rough,
        z_zero=zero_of(case.water, z_zero),
        u_uniform=water.speed or 0.0,
        depth=math.inf if water.depth is None else water.depth,
        above=Above.of(water.above),
        nu=water.viscosity,
        rho_w=water.density,
        drag=Drag.of(water.drag),
        drag_of_form=DragOfForm.of(water.drag_of_form) if has_clumps(case.grains) else DragOfForm.SPHERE,
        c_d=water.drag_coefficient,
        a_2=water.shape_area,
        c_m=water.added_mass,
        torque=WaterTorque.of(water.torque),
        rebound=Rebound.of(water.rebound),
        st_c=water.rebound_stokes,
        e_least=water.rebound_least,
        asperity=water.asperity or 0.0,
        film_reach=film_reach(case),
        **(column_laws_of(case) if water.profile == "column" else {}),
    )


def column_laws_of(case: Case) -> dict[str, Any]:
    """Fields of `Water` that apply to a column only."""
    water = case.water
    assert water is not None
    return {
        "buoyancy": Buoyancy.of(water.buoyancy),
        "hindrance": Hindrance.of(water.hindrance),
        "hindrance_exponent": hindrance_exponent(case),
        "lift": Lift.of(water.lift),
        "c_l": water.lift_coefficient,
        "magnus": Magnus.of(water.magnus),
    }
