"""Other units of mass, length and time give the same physics: answers scale by their declared units."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

EXPONENTS = {  # exponents of kg, m, s
    "-": (0, 0, 0),
    "bool": (0, 0, 0),
    "kg": (1, 0, 0),
    "m": (0, 1, 0),
    "s": (0, 0, 1),
    "m2": (0, 2, 0),
    "m3": (0, 3, 0),
    "m/s": (0, 1, -1),
    "m/s2": (0, 1, -2),
    "m2/s": (0, 2, -1),
    "kg/m3": (1, -3, 0),
    "kg m2": (1, 2, 0),
    "N": (1, 1, -2),
    "N/m": (1, 0, -2),
    "N s/m": (1, 0, -1),
    "N m": (1, 2, -2),
    "N m s": (1, 2, -1),
    "rad/s": (0, 0, -1),
    "rad/s2": (0, 0, -2),
}


# Arguments and answers of every law.
UNITS = {
    "collision.collision_time": "kg, N/m -> s",
    "collision.effective_mass": "kg, kg -> kg",
    "collision.effective_mass_tangential": "kg, m, kg m2, kg, m, kg m2, bool -> kg",
    "collision.omega_natural": "N/m, kg -> rad/s",
    "collision.damping_ratio": "N s/m, N/m, kg -> -",
    "collision.phase_to_largest": "- -> -",
    "collision.contact_time_tension": "-, rad/s -> s",
    "collision.contact_time_no_tension": "-, rad/s -> s",
    "collision.shortest_contact": "kg, N/m, -, bool -> s",
    "collision.restitution_tension": "- -> -",
    "collision.restitution_no_tension": "- -> -",
    "collision.zeta_tension": "- -> -",
    "collision.zeta_no_tension": "- -> -",
    "collision.overlap_max": "m/s, kg, N/m, - -> m",
    "collision.stiffness_for_overlap": "m, m/s, kg, - -> N/m",
    "collision.stiffness_for_time": "s, kg, -, bool -> N/m",
    "collision.step_limit": "-, rad/s -> s",
    "contact.normal_force": "m, m/s, N/m, N s/m -> N",
    "contact.normal_force_no_tension": "m, m/s, N/m, N s/m -> N",
    "contact.shear_strength": "N, N, - -> N",
    "contact.slip_spring": "N, N, N, - -> N",
    "contact.slip_scale": "N, N -> -",
    "contact.slide_spring": "N, N -> -, -, -",
    "contact.slide_spring_drop": "N, N -> -, -, -",
    "contact.slide_total": "N, N -> -, -, -",
    "contact.damping_in_steps": "N s/m, kg, s -> N s/m",
    "contact.damping": "-, N/m, kg -> N s/m",
    "drag.reynolds": "m/s, m, m2/s -> -",
    "drag.c_d_re_04": "- -> -",
    "drag.c_d_re_2": "- -> -",
    "drag.c_d_schiller_naumann": "- -> -",
    "drag.c_d_ferguson_church": "-, -, - -> -",
    "drag.c_d_ferguson_church_sphere": "- -> -",
    "drag.c_d_ferguson_church_sand": "- -> -",
    "drag.drag_factor": "m/s, -, kg/m3, -, m -> N s/m",
    "drag.volume": "m, - -> m3",
    "drag.added_mass": "kg/m3, -, m3 -> kg",
    "drag.submerged_mass": "kg, kg/m3, m3 -> kg",
    "drag.terminal_velocity_stokes": "-, m/s2, m, m2/s -> m/s",
    "drag.terminal_velocity_ferguson_church": "-, m/s2, m, m2/s, -, - -> m/s",
    "geometry.overlap": "m, m, m -> m",
    "geometry.arm": "m, m -> m",
    "geometry.wrap": "m, m -> m",
    "geometry.turn": "N, N, N, -, -, -, - -> N, N, N",
    "motion.inertia_sphere": "kg, m -> kg m2",
    "motion.acceleration": "N, N, N, kg, kg -> m/s2",
    "motion.acceleration_spin": "N m, kg m2 -> rad/s2",
    "motion.semi_implicit": "m, m/s, m/s2, s -> m, m/s",
    "motion.forward_euler": "m, m/s, m/s2, s -> m, m/s",
    "rolling.rolling_arm_width": "m, m, m -> m",
    "rolling.reduced_radius": "m, m -> m",
    "rolling.rolling_printed": "N, m -> N m",
    "rolling.rolling_constant": "N m, rad/s, kg m2, s -> N m",
    "rolling.inertia_spin": "kg m2, kg m2 -> kg m2",
    "rolling.inertia_rolling": "kg, m, kg m2, kg, m, kg m2 -> kg m2",
    "rolling.epsd_stiffness": "N/m, m, - -> N m",
    "rolling.epsd_damping": "N m, kg m2, - -> N m s",
    "rolling.epsd_spring": "N m, rad/s, N m, s -> N m",
    "rolling.slider_scale": "N m, N m -> -",
    "rolling.epsd_torque": "N m, rad/s, N m s, - -> N m",
    "reduced.reduced": "kg, kg -> kg",
    "slices.sphere_slice": "m, m, m -> m3",
    "slices.circle_slice": "m, m, m -> m2",
    "torque.reynolds_spin": "rad/s, m, m2/s -> -",
    "torque.torque_stokes": "rad/s, m, m2/s, kg/m3 -> N m s",
    "torque.torque_dennis": "rad/s, m, m2/s, kg/m3 -> N m s",
    "torque.torque_in_range": "rad/s, m, m2/s -> bool",
    "water.log_law_rough": "m, m/s, m -> m/s",
    "water.log_law_smooth": "m, m/s, m2/s -> m/s",
    "water.uniform": "m, m/s -> m/s",
    "water.u_star_from_tau_star": "-, kg/m3, kg/m3, m/s2, m -> m/s",
    "water.tau_star_from_u_star": "m/s, kg/m3, kg/m3, m/s2, m -> -",
    "water.u_star_from_slope": "m, -, m/s2 -> m/s",
}


@pytest.mark.parametrize("name", sorted(UNITS))
def test_units_are_declared_for_laws_that_exist(name, laws):
    assert name in laws


@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_other_units_of_mass_length_and_time_rescale_the_answer(law, data):
    assert law.name in UNITS, "declare the units of its arguments and answers above"
    units, answers = (side.split(", ") for side in UNITS[law.name].split(" -> "))
    factors = [4.0 ** data.draw(st.integers(-3, 3)) for _ in range(3)]  # kg, m, s

    def scale(unit):
        return math.prod(f**p for f, p in zip(factors, EXPONENTS[unit], strict=True))

    args = data.draw(law.draw())
    scaled = [a if unit == "bool" else a * scale(unit) for a, unit in zip(args, units, strict=True)]
    expected = [x * scale(unit) for x, unit in zip(law(*args), answers, strict=True)]
    assert law(*scaled) == pytest.approx(expected, rel=1e-11, nan_ok=True)
