"""Rows of `ryusa check` about the water: friction velocity, Reynolds numbers, settling velocity."""

import math

import numpy as np

from ryusa.casefile.builders.schema import DropSection
from ryusa.casefile.builders.table import table_of
from ryusa.casefile.case import Case
from ryusa.casefile.column.bed import water_over
from ryusa.casefile.facts import Derived
from ryusa.casefile.motion import slope_at_last
from ryusa.casefile.rows import ExplainRow, Flag, number
from ryusa.casefile.shape import shapes_of
from ryusa.casefile.water.schema import WaterSection
from ryusa.casefile.water.values import terminal_velocity
from ryusa.laws import drag, torque, water
from ryusa.laws.nonspherical import terminal_velocity_corey

ROUND, NATURAL = 6.0, 3.5  # roundness on the scale of Powers
LEAST_COREY = 0.2  # below, the fit of Dietrich does not hold
APART = 0.1  # relative difference between two speeds that is worth a note


def water_rows(case: Case, derived: Derived, origin: str) -> list[ExplainRow]:
    """Friction velocity (and its `origin`), roughness, settling velocity; none in a dry case."""
    wet = case.water
    if wet is None:
        return []
    rows = _shear(case, derived, wet, origin) if derived.u_star > 0.0 else []
    settling = terminal_velocity(case)
    if math.isfinite(settling):
        re = drag.reynolds(settling, derived.d, wet.viscosity)
        rows += [
            number("water", "settling velocity", settling, "m/s", f"of a single mean grain, drag {wet.drag}"),
            number("water", "grain Re", re, "-", "settling velocity times d/nu"),
        ]
        if case.grains.density > wet.density and derived.g > 0.0:
            rows.append(_of_natural_sand(case.grains.density, derived, wet, settling))
    return [*rows, *_of_clumps(case, derived, wet)]


def _of_natural_sand(density: float, derived: Derived, wet: WaterSection, settling: float) -> ExplainRow:
    """Settling velocity of natural sand of the mean diameter, beside that of the grains of the case."""
    ratio = density / wet.density - 1.0
    sand = drag.terminal_velocity_ferguson_church(ratio, derived.g, derived.d, wet.viscosity, 18.0, 1.0)
    origin, apart = "Ferguson & Church 2004, of this diameter", settling / sand - 1.0
    far: Flag = "note" if abs(apart) > APART else ""
    if far:
        origin += f"; the grains of the case settle {abs(apart):.0%} {'faster' if apart > 0.0 else 'slower'}"
        if wet.drag != "Ferguson-Church sand":
            origin += "; drag 'Ferguson-Church sand' is that of natural sand"
    return number("water", "settling velocity of natural sand", sand, "m/s", origin, far)


def _of_clumps(case: Case, derived: Derived, wet: WaterSection) -> list[ExplainRow]:
    """Settling velocity of each shape, with that of natural grains of its axes."""
    rows, ratio = list[ExplainRow](), case.grains.density / wet.density - 1.0
    for one in shapes_of(case):
        settling = terminal_velocity(case, one.clump)
        if not math.isfinite(settling):
            continue
        origin = f"of a mean grain of this shape, drag_of_form {wet.drag_of_form}"
        if one.clump.corey > LEAST_COREY:
            smooth, rough = (
                terminal_velocity_corey(
                    ratio, derived.g, derived.d, wet.viscosity, one.clump.corey, roundness
                )
                for roundness in (ROUND, NATURAL)
            )
            origin += (
                f"; Dietrich 1982 for c/sqrt(a b) = {one.clump.corey:.3g}: {smooth:.3g} m/s perfectly round, "
                f"{rough:.3g} m/s natural"
            )
        rows.append(number("water", f"settling velocity of '{one.name}'", settling, "m/s", origin))
    return rows


def _shear(case: Case, derived: Derived, wet: WaterSection, origin: str) -> list[ExplainRow]:
    rows = [number("water", "u_star", derived.u_star, "m/s", origin)]
    if not math.isnan(derived.tau_star):
        rows.append(number("water", "tau_star", derived.tau_star, "-", "u_star^2/((rho_s/rho_w - 1) g d)"))
    depth, tilt = water_over(case), slope_at_last(case.motion, case.timeline)
    if depth > 0.0 and tilt > 0.0:
        implied = water.u_star_from_slope(depth, tilt, derived.g)
        differs: Flag = "note" if abs(implied / derived.u_star - 1.0) > APART else ""
        if not math.isclose(implied, derived.u_star, rel_tol=1e-9):
            formula = "sqrt(g h sin(slope)), for comparison"
            rows.append(number("water", "u_star of slope and depth", implied, "m/s", formula, differs))
    rough = derived.u_star * derived.k_rough / wet.viscosity
    rows.append(number("water", "roughness Re", rough, "-", "u_star k_s/nu; hydraulically rough above 70"))
    return rows


def rotation_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Reynolds number of the fastest rotation at the start, where the water exerts a torque."""
    wet = case.water
    if wet is None or wet.torque == "none":
        return []
    spin, d = abs(case.build.spin) if isinstance(case.build, DropSection) else 0.0, derived.d
    if (table := table_of(case)) is not None:
        spins, sizes = np.abs(table.column("wy")), table.column("d")
        if not case.motion.plane:
            spins = np.sqrt(spins**2 + table.column("wx") ** 2 + table.column("wz") ** 2)
        fastest = int(np.argmax(np.where(table.fixed, 0.0, spins * sizes**2)))
        spin, d = float(spins[fastest]), float(sizes[fastest])
    if spin == 0.0:
        return []
    beyond = wet.torque == "Dennis" and not torque.torque_in_range(spin, d, wet.viscosity)
    origin = f"d^2 omega/nu at the start, omega = {spin:.4g} rad/s"
    origin += "; torque Dennis is fitted up to 4000 only" if beyond else ""
    re_r = torque.reynolds_spin(spin, d, wet.viscosity)
    return [number("water", "rotational Re", re_r, "-", origin, "warning" if beyond else "")]
