"""Checks of [water] that need more than one key."""

import math
from collections.abc import Iterator

from ryusa.casefile.builders.table import lightest_in_file
from ryusa.casefile.builders.values import sizes
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.grains.values import mass
from ryusa.casefile.materials.values import density
from ryusa.casefile.motion import may_rotate
from ryusa.casefile.row.values import stream
from ryusa.casefile.shape import KEY as SHAPE
from ryusa.casefile.shape import has_clumps, shapes_of
from ryusa.casefile.water.values import drag_coefficient, terminal_velocity
from ryusa.errors import CaseError
from ryusa.laws import drag
from ryusa.laws.families import Profile
from ryusa.model.column import STIFF


def check_water(case: Case) -> Iterator[CaseError]:
    """Find keys of the water that are missing or contradict each other."""
    water = case.water
    if water is None:
        if case.grains.buoyant:
            yield CaseError("grains.buoyant", True, "has no effect without [water]")
        return
    takes = Profile.of(water.profile).takes
    shear = water.tau_star is not None or water.u_star is not None
    if "u_star" in takes and not shear and water.profile != "column":
        text = f"missing; profile '{water.profile}' needs tau_star or u_star"
        yield CaseError("water.tau_star", None, text)
    if "speed" in takes and water.speed is None:
        yield CaseError("water.speed", None, f"missing; profile '{water.profile}' needs it")
    floats = case.grains.density < water.density and not case.grains.buoyant  # reported below
    if water.tau_star is not None and case.grains.density <= water.density and not floats:
        yield CaseError(
            "water.tau_star", water.tau_star, "needs grains denser than water; give u_star instead"
        )
    if water.above != "continue" and water.depth is None and water.profile != "column":
        yield CaseError("water.depth", None, f"missing; above = '{water.above}' needs it")
    if "drag_of_form" in water.model_fields_set and not has_clumps(case.grains):
        yield CaseError("water.drag_of_form", water.drag_of_form, f"has no effect without clumps ({SHAPE})")
    if water.torque != "none" and not may_rotate(case.motion, case.timeline):
        yield CaseError("water.torque", water.torque, "needs motion.rotation = 'free'")
    yield from _that_floats(case, water.density)
    if water.depth is not None and not stream(case) and water.depth < (d := reference_diameter(case)):
        yield CaseError(
            "water.depth", water.depth, f"covers no grain: at least their diameter, {d:.4g} m, is needed, "
            "since drag and buoyancy are those of immersed grains",
        )  # fmt: skip


def _that_floats(case: Case, of_water: float) -> Iterator[CaseError]:
    """Find grains lighter than the water that nobody asked for, or the word for them where all sink."""
    own = {"grains.density": case.grains.density}
    own |= {f"materials.{name}.density": density(case, name) for name in case.materials}
    lightest = min(own, key=lambda key: own[key])
    rho, key = own[lightest], lightest
    try:
        of_file = lightest_in_file(case).grains.density
    except CaseError:  # reported with the file
        of_file = math.inf
    if of_file < rho:
        rho, key = of_file, "build.file"
    if rho < of_water and not case.grains.buoyant:
        yield CaseError(
            key, rho, f"is lighter than the water, {of_water:g} kg/m3, so that such grains rise and float; "
            "say grains.buoyant = true if they are meant to, or mend the density (quartz 2650 kg/m3)",
            f"{rho:g} g/cm3" if of_water < 1000.0 * rho < 2.0e4 else None,
        )  # fmt: skip
    elif case.grains.buoyant and rho >= of_water:
        yield CaseError("grains.buoyant", True, "has no effect: no grain is lighter than the water")


def check_drag_step(case: Case, derived: Derived) -> Iterator[CaseError]:
    """Find a time step too long for the drag on the smallest grain, alone and at its settling velocity.

    Drag is explicit: with a step above one relaxation time the relative velocity changes its sign, above two
    it grows without bound. A column exchanges momentum once a step at most, and needs a quarter of that time.
    """
    wet, dt = case.water, derived.dt
    if wet is None or wet.drag == "none":
        return
    d, speed = sizes(case)[1], terminal_velocity(case)
    if not 0.0 < speed < math.inf:
        speed = 1.0e-3 * wet.viscosity / d  # without weight: slow enough for Stokes' drag
    re = drag.reynolds(speed, d, wet.viscosity)
    c_d = max(drag_coefficient(case, re, form) for form in (None, *(one.clump for one in shapes_of(case))))
    rate = drag.drag_factor(speed, c_d, wet.density, wet.shape_area, d) / sum(mass(case, d)[:2])
    column = wet.profile == "column"
    most = STIFF if column else 1.0
    if dt * rate > most:
        key = "steps_per_contact" if case.time.step is None else "step"
        limit = f"a quarter of that, {most / rate:.3g} s" if column else "that"
        yield CaseError(
            f"time.{key}",
            getattr(case.time, key),
            f"dt = {dt:.3g} s is too long for the drag, which slows the smallest grain within "
            f"{1.0 / rate:.3g} s; dt must be below {limit}. Take a shorter step, larger grains or a less "
            "viscous fluid",
        )
