"""One grain on a plane, on a bed, in water: answers known in closed form (validation.md, b and d)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, contact_law, run

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws import collision, drag
from ryusa.laws.families import Arm, Drag, Profile, Rolling, Slip, WaterTorque
from ryusa.model import RollingLaw, Term, Water

G = 9.80665
FLOOR = [("floor", (0, 0, 0), (0, 0, 1))]


def resting(law, v=0.0, omega=0.0, slope=0.0, rolling=None, d=D, **more):
    """A grain pressed into a floor as far as its weight wants, with a given speed and spin."""
    probe, _ = scene([[0.0, 0.0, 1.0]], d, contact=law)
    sunk = float(probe.m[0]) * G * math.cos(slope) / law.k_n
    return scene(
        [[0.0, 0.0, 0.5 * d - sunk]],
        d,
        v=[[v, 0.0, 0.0]],
        omega=[[0.0, omega, 0.0]],
        planes=FLOOR,
        contact=law,
        slope=slope,
        rolling=rolling,
        gravity=G,
        plane_case=True,
        allow_overlap=True,
        **more,
    )


@pytest.mark.full
def test_a_sliding_sphere_ends_rolling_at_five_sevenths_of_its_speed():
    mu, v = 0.3, 0.2
    law = contact_law(k_n=1e3, mu=mu, zeta_n=0.3, zeta_s=0.3, slip=Slip.SPRING_DROP)
    engine = CpuEngine()
    made = resting(law, v=v)
    engine.load(*made)
    until = 2.0 * v / (7.0 * mu * G)
    dt = made[0].dt
    engine.advance(int(0.5 * until / dt)).raise_if_any()
    half = engine.state()
    assert half.v[0, 0] == pytest.approx(v - mu * G * half.t, rel=2e-3)  # still sliding
    engine.advance(int(1.0 * until / dt)).raise_if_any()
    last = engine.state()
    assert last.v[0, 0] == pytest.approx(5.0 / 7.0 * v, rel=2e-3)
    assert last.omega[0, 1] * 0.5 * D == pytest.approx(last.v[0, 0], rel=3e-3)


MU_R = 0.05
MODELS = {
    "constant": RollingLaw(Rolling.CONSTANT, Arm.REDUCED_RADIUS, MU_R),
    "spring-dashpot-slider": RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, MU_R),
}


@pytest.mark.full
@pytest.mark.parametrize("rolling", MODELS.values(), ids=MODELS.keys())
def test_a_rolling_sphere_stops_where_rolling_friction_says(rolling):
    # without its dashpot, which would brake harder than the slider until the slider moves
    rolling, v = replace(rolling, zeta_r=0.0), 0.02
    law = contact_law(k_n=1e3, mu=0.5, zeta_n=0.3, zeta_s=0.3)
    made = resting(law, v=v, omega=v / (0.5 * D), rolling=rolling)
    brake = 5.0 / 7.0 * MU_R * G
    engine = run(made, int(1.5 * v / brake / made[0].dt))
    last = engine.state()
    assert last.x[0, 0] == pytest.approx(0.5 * v * v / brake, rel=2e-2)
    assert abs(last.v[0, 0]) < 5e-2 * v  # an undamped rolling spring swings on
    lost = engine.tally().terms[Term.ROLL]
    energy = 0.5 * float(made[0].m[0]) * v**2 * 1.4
    assert lost == pytest.approx(energy, rel=3e-2)


@pytest.mark.full
def test_without_rolling_friction_a_sphere_rolls_on():
    v = 0.02
    law = contact_law(k_n=1e3, mu=0.5, zeta_n=0.3, zeta_s=0.3)
    engine = run(resting(law, v=v, omega=v / (0.5 * D)), 20_000)
    assert engine.state().v[0, 0] == pytest.approx(v, rel=1e-3)


@pytest.mark.full
def test_eq_13_as_printed_brakes_a_rolling_sphere_and_then_drives_it_back():
    # M_f calls up the very shear torque that it opposes, whatever the spin: it never lets go, and
    # makes energy
    v = 0.02
    law = contact_law(k_n=1e3, mu=0.5, zeta_n=0.3, zeta_s=0.3)
    rolling = RollingLaw(Rolling.PRINTED, Arm.REDUCED_RADIUS, MU_R)
    made = resting(law, v=v, omega=v / (0.5 * D), rolling=rolling)
    stop = v / (5.0 / 7.0 * MU_R * G)
    engine = run(made, int(1.0 * stop / made[0].dt))
    lost = engine.tally().terms[Term.ROLL]
    assert abs(engine.state().v[0, 0]) < 0.02 * v
    engine.advance(int(0.5 * stop / made[0].dt)).raise_if_any()
    assert engine.state().v[0, 0] == pytest.approx(-0.5 * v, rel=0.03)
    assert engine.tally().terms[Term.ROLL] < lost


@pytest.mark.full
def test_eq_13_limited_to_the_torque_it_opposes_slows_the_spinning_up_and_lets_a_rolling_sphere_roll_on():
    mu, v = 0.3, 0.2
    law = contact_law(k_n=1e3, mu=mu, zeta_n=0.3, zeta_s=0.3, slip=Slip.SPRING_DROP)
    rolling = RollingLaw(Rolling.LIMITED, Arm.REDUCED_RADIUS, MU_R)
    turning = 2.5 * (mu - MU_R)  # of the underside against the sphere's own slowing down, mu
    until = v / ((mu + turning) * G)
    made = resting(law, v=v, rolling=rolling)
    engine = run(made, int(1.5 * until / made[0].dt))
    rolls = v * turning / (mu + turning)
    assert engine.state().v[0, 0] == pytest.approx(rolls, rel=3e-3)
    assert engine.state().omega[0, 1] * 0.5 * D == pytest.approx(rolls, rel=3e-3)
    engine.advance(int(3.0 * until / made[0].dt)).raise_if_any()
    assert engine.state().v[0, 0] == pytest.approx(rolls, rel=3e-3)
    # where f N exceeds the torque of the shear force the sphere slides and does not turn at all
    made = resting(law, v=v, rolling=replace(rolling, coefficient=2.0 * mu))
    engine = run(made, int(0.5 * v / (mu * G) / made[0].dt))
    assert abs(engine.state().omega[0, 1]) * 0.5 * D < 1e-3 * v
    assert engine.state().v[0, 0] == pytest.approx(0.5 * v, rel=2e-2)


@pytest.mark.full
@pytest.mark.parametrize("name", MODELS)
def test_a_grain_rests_on_an_incline_below_the_rolling_friction_and_not_above(name):
    law = contact_law(k_n=1e3, mu=0.5, zeta_n=0.3, zeta_s=0.3)
    steep, flat = math.atan(1.5 * MU_R), math.atan(0.5 * MU_R)
    t = 0.1
    down = resting(law, slope=steep, rolling=MODELS[name])
    last = run(down, int(t / down[0].dt)).state()
    a = 5.0 / 7.0 * G * (math.sin(steep) - MU_R * math.cos(steep))
    assert last.v[0, 0] == pytest.approx(a * last.t, rel=3e-2)
    held = resting(law, slope=flat, rolling=MODELS[name])
    last = run(held, int(t / held[0].dt)).state()
    free = 5.0 / 7.0 * G * math.sin(flat) * last.t
    assert abs(last.v[0, 0]) < 5e-3 * free


@pytest.mark.full
def test_a_spring_dashpot_slider_rests_and_a_constant_torque_creeps_with_the_step():
    # what the field says of types A and C (Ai et al. 2011): type A first lets the spin grow for a step
    flat = math.atan(0.5 * MU_R)

    def creep(name, per_contact):
        law = contact_law(k_n=1e3, mu=0.5, zeta_n=0.3, zeta_s=0.3)
        made = resting(law, slope=flat, rolling=MODELS[name], steps_per_contact=per_contact)
        engine = run(made, int(0.2 / made[0].dt))
        before = engine.state()
        engine.advance(int(0.1 / made[0].dt)).raise_if_any()
        after = engine.state()
        return (after.x[0, 0] - before.x[0, 0]) / (after.t - before.t)

    coarse, fine = creep("constant", 25.0), creep("constant", 50.0)
    assert coarse > 0.0
    assert fine / coarse == pytest.approx(0.5, rel=0.1)
    assert abs(creep("spring-dashpot-slider", 50.0)) < 1e-6 * fine


@pytest.mark.full
@pytest.mark.parametrize("heading", [0.0, 0.7, 2.5])
def test_rolling_friction_stops_a_sphere_in_3d_in_any_direction(heading):
    v = 0.02
    along = np.array([math.cos(heading), math.sin(heading), 0.0])
    law = contact_law(k_n=1e3, mu=0.5, zeta_n=0.3, zeta_s=0.3)
    probe, _ = scene([[0.0, 0.0, 1.0]], D, contact=law)
    sunk = float(probe.m[0]) * G / law.k_n
    spin = np.cross([0.0, 0.0, 1.0], along) * v / (0.5 * D)
    made = scene(
        [[0.0, 0.0, 0.5 * D - sunk]],
        D,
        v=[v * along],
        omega=[spin],
        planes=FLOOR,
        contact=law,
        gravity=G,
        rolling=MODELS["constant"],
        allow_overlap=True,
    )
    brake = 5.0 / 7.0 * MU_R * G
    last = run(made, int(1.5 * v / brake / made[0].dt)).state()
    assert last.x[0] @ along == pytest.approx(0.5 * v * v / brake, rel=1e-2)
    assert abs(last.x[0] @ np.cross(along, [0.0, 0.0, 1.0])) < 1e-9


C_D = {
    Drag.RE_04: drag.c_d_re_04,
    Drag.RE_2: drag.c_d_re_2,
    Drag.SCHILLER_NAUMANN: drag.c_d_schiller_naumann,
    Drag.FERGUSON_CHURCH_SPHERE: drag.c_d_ferguson_church_sphere,
    Drag.FERGUSON_CHURCH_SAND: drag.c_d_ferguson_church_sand,
}


@pytest.mark.parametrize("law", [Drag.CONSTANT, *C_D])
@pytest.mark.parametrize("d", [1.0e-4, 5.0e-4, 1.0e-3, 2.0e-3, 6.0e-3])
def test_a_grain_settles_at_the_terminal_velocity_of_its_drag_law(law, d):
    water = Water(profile=Profile.STILL, drag=law, c_d=0.4)
    weight = 1.65 * 1000.0 * math.pi / 6 * d**3 * G

    def balance(w):
        c_d = 0.4 if law == Drag.CONSTANT else C_D[law](drag.reynolds(w, d, 1e-6))
        return drag.drag_factor(w, c_d, 1000.0, math.pi / 4, d) * w - weight

    low, high = 1e-6, 5.0
    for _ in range(80):
        mid = 0.5 * (low + high)
        low, high = (mid, high) if balance(mid) < 0.0 else (low, mid)
    response = (2650.0 + 500.0) * math.pi / 6 * d**3 * low / weight
    dt = response / 200.0
    fixed, first = scene([[0.0, 0.0, 0.0]], d, water=water, gravity=G, dt=dt, plane_case=True)
    engine = run((replace(fixed, world_low=(-np.inf,) * 3), first), 4000)
    last = engine.state()
    assert -last.v[0, 2] == pytest.approx(low, rel=1e-8)
    account = engine.tally()
    assert account.terms[Term.DRAG] < 0.0
    assert account.residual < 1e-6
    if law == Drag.FERGUSON_CHURCH_SAND:
        assert low == pytest.approx(
            drag.terminal_velocity_ferguson_church(1.65, G, d, 1e-6, 18.0, 1.0), rel=1e-6
        )


def test_added_mass_slows_the_start_and_not_the_weight():
    water = Water(profile=Profile.STILL, drag=Drag.NONE, c_m=0.5)
    fixed, first = scene([[0.0, 0.0, 0.0]], D, water=water, gravity=G, dt=1e-5, plane_case=True)
    last = run((replace(fixed, world_low=(-np.inf,) * 3), first), 1000).state()
    assert last.v[0, 2] == pytest.approx(-(2650.0 - 1000.0) / (2650.0 + 500.0) * G * 0.01, rel=1e-9)


@pytest.mark.full
def test_a_slow_spin_decays_after_stokes():
    d, spin = 2.0e-4, 5.0
    tau = 2650.0 * (0.5 * d) ** 2 / (15.0 * 1e-3)
    water = Water(profile=Profile.STILL, drag=Drag.NONE, torque=WaterTorque.STOKES)
    fixed, first = scene(
        [[0.0, 0.0, 0.0]], d, omega=[[0.0, spin, 0.0]], water=water, gravity=0.0, dt=tau / 2000.0
    )
    engine = run((fixed, first), 4000)
    assert engine.state().omega[0, 1] == pytest.approx(spin * math.exp(-2.0), rel=1e-3)
    lost = 0.5 * float(fixed.inertia[0]) * spin**2 * (1.0 - math.exp(-4.0))
    assert -engine.tally().terms[Term.TORQUE] == pytest.approx(lost, rel=2e-3)
    assert engine.tally().residual < 1e-9


@pytest.mark.full
def test_a_fast_spin_decays_faster_than_stokes_by_the_ratio_of_dennis():
    spin, torques = 900.0, {}
    for law in (WaterTorque.STOKES, WaterTorque.DENNIS):
        water = Water(profile=Profile.STILL, drag=Drag.NONE, torque=law)
        made = scene([[0.0, 0.0, 0.0]], D, omega=[[0.0, spin, 0.0]], water=water, gravity=0.0, dt=1e-6)
        torques[law] = spin - run(made, 10).state().omega[0, 1]
    re = spin * D**2 / 1e-6
    ratio = (12.9 / math.sqrt(re) + 128.4 / re) / (64.0 * math.pi / re)
    assert torques[WaterTorque.DENNIS] / torques[WaterTorque.STOKES] == pytest.approx(ratio, rel=1e-3)


@pytest.mark.full
@pytest.mark.parametrize("rotation", [True, False])
def test_a_grain_leaves_a_bed_pocket_at_30_degrees_or_30_plus_phi(rotation):
    # exact for hard equal grains; stiff springs and a slow look keep it within 0.2 degrees
    # (findings.md, trap 1)
    phi = 20.0
    k_n = 2.0e4
    # a dashpot that stays while sliding would only let it creep away
    law = contact_law(k_n=k_n, mu=math.tan(math.radians(phi)), zeta_n=0.2, zeta_s=0.2, slip=Slip.SPRING_DROP)
    leaves = 30.0 if rotation else 30.0 + phi

    def gone(angle):
        slope = math.radians(angle)
        rest = D * math.cos(math.radians(30.0))
        made = scene(
            [[0.0, 0.0, rest - 1e-8]],
            D,
            x_fixed=[[-0.5 * D, 0.0, 0.0], [0.5 * D, 0.0, 0.0]],
            d_fixed=D,
            contact=law,
            slope=slope,
            gravity=G,
            rotation=rotation,
            plane_case=True,
            allow_overlap=True,
        )
        engine = CpuEngine()
        engine.load(*made)
        engine.advance(int(0.12 / made[0].dt)).raise_if_any()
        return engine.state().x[0, 0] > 0.02 * D

    assert not gone(leaves - 0.2)
    assert gone(leaves + 0.2)


@pytest.mark.full
def test_the_account_of_a_dropped_grain_closes():
    law = contact_law(zeta_n=collision.zeta_no_tension(0.7))
    made = scene([[0.0, 0.0, 3.0 * D]], D, x_fixed=[[0.0, 0.0, 0.0]], d_fixed=D, contact=law, gravity=G)
    engine = run(made, int(0.08 / made[0].dt))
    assert len(engine.events()) >= 2
    assert engine.tally().residual < 1e-3
