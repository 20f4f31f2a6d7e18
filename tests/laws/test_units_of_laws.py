"""Other units of mass, length and time give the same physics: answers scale by their declared units."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

EXPONENTS = {  # exponents of kg, m, s
    "-": (0, 0, 0),
    "bool": (0, 0, 0),
    "kg": (1, 0, 0),
    "1/kg": (-1, 0, 0),
    "1/(kg m2)": (-1, -2, 0),
    "m": (0, 1, 0),
    "s": (0, 0, 1),
    "m2": (0, 2, 0),
    "m3": (0, 3, 0),
    "m/s": (0, 1, -1),
    "1/s": (0, 0, -1),
    "m/s2": (0, 1, -2),
    "m2/s": (0, 2, -1),
    "m2/s2": (0, 2, -2),
    "kg/m3": (1, -3, 0),
    "kg m2": (1, 2, 0),
    "N": (1, 1, -2),
    "Pa": (1, -1, -2),
    "N/m": (1, 0, -2),
    "m/N": (-1, 0, 2),
    "N s": (1, 1, -1),
    "J": (1, 2, -2),
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
    "contact.slide": "N, N, -, - -> -, -, -",
    "contact.damping_in_steps": "N s/m, kg, s -> N s/m",
    "contact.damping": "-, N/m, kg -> N s/m",
    "contact_step.contact_kinematics": (
        "bool, m, m, m, m, m, m/s, m/s, m/s, rad/s, rad/s, rad/s, rad/s, rad/s, rad/s, s"
        " -> -, -, -, m, m, m, m/s, m/s, m/s, m/s, -"
    ),
    "contact_step.normal_step": "m, m/s, N, bool, N, N/m, s -> N, N, -, -, J, J, J",
    "contact_step.normal_work_of_last_force": "m/s, N, N, bool, N, m/N, s -> J, J, J",
    "contact_step.tangential_step": (
        "bool, bool, bool, bool, -, -, -, -, N, N, -, m/s, m/s, m/s, N, N, N, N, N, N,"
        " N/m, m/N, N s/m, N, -, s, s -> N, N, N, N, N, N, -, J, J, J"
    ),
    "contact_step.contact_force": "bool, -, -, -, N, N, N, N -> N, N, N, N, N, N",
    "debris.equilibrium_concentration": "-, -, kg/m3, kg/m3 -> -",
    "debris.equilibrium_takahashi": "-, -, kg/m3, kg/m3, - -> -",
    "debris.collision_factor": "-, -, -, kg/m3, kg/m3 -> -",
    "debris.pore_factor": "-, - -> -",
    "debris.static_share": "-, - -> -",
    "debris.velocity_egashira": "m, m, -, -, -, -, -, kg/m3, kg/m3, m/s2, m -> m/s",
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
    "drag.terminal_velocity_soulsby": "-, m/s2, m, m2/s -> m/s",
    "drag.terminal_velocity_dietrich": "-, m/s2, m, m2/s -> m/s",
    "geometry.overlap": "m, m, m -> m",
    "geometry.arm": "m, m -> m",
    "geometry.wrap": "m, m -> m",
    "geometry.turn": "N, N, N, -, -, -, - -> N, N, N",
    "hindrance.exponent_rowe": "- -> -",
    "hindrance.exponent_garside": "- -> -",
    "hindrance.exponent_settling": "-, -, -, bool -> -",
    "hindrance.richardson_zaki": "m/s, -, -, bool -> m/s, -",
    "hindrance.wen_yu": "m/s, -, bool -> m/s, -",
    "hindrance.stokes_multiple": "- -> -",
    "hindrance.gidaspow": "m/s, -, m, m2/s, bool -> m/s, -",
    "hindrance.chi_di_felice": "- -> -",
    "hindrance.di_felice": "m/s, -, m, m2/s, bool -> m/s, -",
    "hindrance.power": "m/s, -, - -> m/s, -",
    "eddies.eddy_along": "-, -, m/s, 1/s -> m/s",
    "eddies.eddy_life": "1/s -> s",
    "eddies.eddy_drift": "m, 1/s -> m/s",
    "immersed.stokes_number": "m/s, kg, m, kg/m3, m2/s -> -",
    "immersed.stokes_number_yade": "m/s, m, kg/m3, kg/m3, m2/s -> -",
    "immersed.restitution_exponential": "-, -, - -> -",
    "immersed.restitution_davis": "-, -, m, m -> -",
    "immersed.lubrication_force": "m, m/s, m, m, m, kg/m3, m2/s -> N",
    "lift.lift_wiberg_smith": "m/s, m/s, -, kg/m3, -, m -> N",
    "lift.saffman_mei": "-, - -> -",
    "lift.lift_saffman_mei": "m/s, 1/s, m, m2/s, kg/m3 -> N s/m",
    "lift.magnus_rubinow_keller": "m, kg/m3 -> kg",
    "lift.magnus_loth": "m/s, rad/s, m, m2/s, kg/m3 -> kg",
    "lift.magnus_oesterle_dinh": "m/s, rad/s, m, m2/s, kg/m3 -> kg",
    "motion.inertia_sphere": "kg, m -> kg m2",
    "motion.acceleration": "N, N, N, 1/kg -> m/s2",
    "motion.acceleration_spin": "N m, 1/(kg m2) -> rad/s2",
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
    "transport.tau_star_from_stress": "Pa, kg/m3, kg/m3, m/s2, m -> -",
    "transport.q_star_from_q": "m2/s, -, m/s2, m -> -",
    "transport.q_from_q_star": "-, -, m/s2, m -> m2/s",
    "transport.d_star": "-, m/s2, m, m2/s -> -",
    "transport.tau_star_critical": "- -> -",
    "transport.rouse_number": "m/s, m/s, - -> -",
    "transport.q_star_meyer_peter_mueller": "- -> -",
    "transport.q_star_wong_parker": "- -> -",
    "transport.q_star_wong_parker_steep": "- -> -",
    "transport.q_star_ashida_michiue": "-, -, - -> -",
    "transport.tau_star_effective": "m/s, m, -, -, m/s2, m -> -",
    "transport.bedload_layer": "-, -, -, -, - -> -",
    "transport.q_star_egashira": "-, -, -, -, -, -, - -> -",
    "turbulence.length_prandtl": "m, - -> m",
    "turbulence.length_parabolic": "m, m, - -> m",
    "turbulence.length_van_driest": "m, m/s, m2/s, - -> m",
    "turbulence.length_growth_li_sawamoto": "-, -, m, - -> m",
    "turbulence.length_pore_egashira": "-, m, - -> m",
    "turbulence.eddy_viscosity": "m, 1/s, - -> m2/s",
    "turbulence.height_between": "m, m -> m",
    "turbulence.u_star_smooth": "m/s, m, m2/s -> m/s",
    "turbulence.wall_smooth": "m/s, m, m2/s -> m2/s2, m/s",
    "turbulence.wall_rough": "m/s, m, m -> m2/s2, m/s",
    "turbulence.speed_mean_rough": "m, m/s, m -> m/s",
    "turbulence.friction_gap_laminar": "- -> -",
    "turbulence.friction_blasius": "- -> -",
    "turbulence.friction_karman_prandtl": "- -> -",
    "turbulence.side_wall_drag": "m/s, -, m -> m/s2",
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
