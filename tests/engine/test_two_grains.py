"""Two grains, or one and a fixed one, against the damped oscillator (validation.md, c)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, contact_law, momentum, run
from tests.kernel_variants import full_but

from ryusa.build import scene
from ryusa.laws import collision
from ryusa.laws.families import ContactTiming, Drag, Profile, Slip
from ryusa.model import Term, Water

SPEED = 0.5  # [m/s]


def head_on(e, partner="fixed", tension=False, water=None, phase=0.0, per_contact=50.0, speed=SPEED):
    """A grain flies at another without gravity; `phase` shifts first touch by part of a step."""
    zeta = collision.zeta_for_restitution(e, tension)
    law = contact_law(zeta_n=zeta, tension=tension)
    probe, _ = scene([[0.0, 0.0, 0.01]], D, contact=law, water=water)
    m = float(probe.m[0] + probe.m_added[0])
    m_eff = m if partner == "fixed" else 0.5 * m
    t_col = collision.contact_time(zeta, math.sqrt(law.k_n / m_eff), tension)
    dt = t_col / per_contact
    gap = (3.0 + phase) * speed * dt
    common = {"contact": law, "dt": dt, "gravity": 0.0, "rotation": False, "plane_case": True, "water": water}
    if partner == "fixed":
        made = scene(
            [[0.0, 0.0, D + gap]], D, v=[[0.0, 0.0, -speed]], x_fixed=[[0.0, 0.0, 0.0]], d_fixed=D, **common
        )
    else:
        made = scene(
            [[0.0, 0.0, 0.0], [0.0, 0.0, D + gap]],
            D,
            v=[[0.0, 0.0, 0.5 * speed], [0.0, 0.0, -0.5 * speed]],
            **common,
        )
    engine = run(made, int(3 + 2.5 * per_contact))
    (event,) = engine.events()
    return event, t_col, engine


STILL = Water(profile=Profile.STILL, drag=Drag.NONE)


@pytest.mark.full
@pytest.mark.parametrize("tension", [False, True])
@pytest.mark.parametrize("partner", ["fixed", "free"])
@pytest.mark.parametrize("water", [None, STILL], ids=["dry", "added mass"])
@pytest.mark.parametrize("e", [0.3, 0.7, 0.9])
def test_the_measured_restitution_is_that_of_the_case(e, partner, tension, water):
    got, times = [], []
    for phase in np.arange(20) / 20.0:
        event, t_col, _ = head_on(e, partner, tension, water, phase)
        assert event["alone"] == 1.0
        got.append(-event["closing_end"] / event["closing_begin"])
        times.append((event["t_end"] - event["t_begin"]) / t_col)
    assert np.mean(got) == pytest.approx(e, abs=2.0e-3)
    assert np.max(np.abs(np.array(got) - e)) < 1.5e-2
    # the dashpot sees a velocity half a step old, which stiffens the pair by zeta omega_0 dt
    # (laws.damping_in_steps)
    assert np.mean(times) == pytest.approx(1.0, abs=5.0e-3 if e >= 0.7 else 1.3e-2)


@pytest.mark.full
def test_error_of_restitution_falls_at_least_with_the_step():
    errors = []
    for per_contact in (50.0, 500.0):
        got = [head_on(0.7, phase=k / 8.0, per_contact=per_contact)[0] for k in range(8)]
        errors.append(max(abs(-g["closing_end"] / g["closing_begin"] - 0.7) for g in got))
    assert errors[1] < 1.0e-3
    assert errors[1] < 0.12 * errors[0]


@pytest.mark.full
def test_largest_overlap_follows_from_speed_mass_and_damping():
    event, _, engine = head_on(0.7, per_contact=400.0)
    scene_, law = engine._scene, engine._scene.contact
    expected = collision.overlap_max(SPEED, scene_.m[0], law.k_n, law.zeta_n)
    assert event["overlap_max"] == pytest.approx(expected, rel=5e-3)
    assert engine.tally().overlap_max == pytest.approx(expected / D, rel=5e-3)


@pytest.mark.full
def test_spring_energy_released_without_tension_is_the_known_share():
    _, _, engine = head_on(0.7, per_contact=1000.0)
    terms, law, m = engine.tally().terms, engine._scene.contact, float(engine._scene.m[0])
    impact = 0.5 * m * SPEED**2
    # overlap left when the force ends: k x = -eta v, with v = -e v0 (Schwager & Poeschel 2007)
    eta = 2.0 * law.zeta_n * math.sqrt(law.k_n * m)
    left = eta * 0.7 * SPEED / law.k_n
    assert terms[Term.RELEASED_N] / impact == pytest.approx(
        0.5 * law.k_n * left**2 / impact, rel=1.5e-2
    )  # left within a step
    assert terms[Term.RELEASED_N] / impact == pytest.approx(0.029, abs=1e-3)  # paper.md, readings
    assert terms[Term.DASH_N] / impact == pytest.approx(1.0 - 0.49 - 0.0293, abs=2e-3)
    assert engine.tally().residual < 1e-4


@pytest.mark.full
def test_impulse_of_a_contact_is_the_change_of_momentum():
    event, _, engine = head_on(0.7)
    change = float(engine._scene.m[0]) * (event["v_end"] - event["v_begin"])
    assert event["impulse"] == pytest.approx(change, rel=1e-12, abs=1e-18)
    assert event["impulse_n"] == pytest.approx(change[2], rel=1e-12)


def oblique(angle, law, rotation=True, per_contact=400.0, speed=SPEED):
    """Impact on a plane at `angle` from its normal; returns tangential speed and spin after it."""
    probe, _ = scene([[0.0, 0.0, 1.0]], D, contact=law)
    t_col = collision.collision_time(float(probe.m[0]), law.k_n)
    v = [[speed * math.sin(angle), 0.0, -speed * math.cos(angle)]]
    made = scene(
        [[0.0, 0.0, 0.5 * D + 1e-7]],
        D,
        v=v,
        planes=[("floor", (0, 0, 0), (0, 0, 1))],
        contact=law,
        dt=t_col / per_contact,
        gravity=0.0,
        rotation=rotation,
    )
    engine = run(made, int(1.5 * per_contact))
    (event,) = engine.events()
    return event, engine


@pytest.mark.full
@pytest.mark.parametrize("slip", [Slip.SPRING_DROP, Slip.TOTAL])
def test_gross_sliding_follows_the_sliding_law(slip):
    # exact for a cap on the total, and on the spring with tension and the dashpot dropped (validation.md, a)
    e, mu, angle = 0.7, 0.1, math.radians(60.0)
    tension = slip == Slip.SPRING_DROP
    zeta = collision.zeta_for_restitution(e, tension)
    law = contact_law(mu=mu, zeta_n=zeta, zeta_s=0.1, slip=slip, tension=tension)
    event, _ = oblique(angle, law)
    e_t = 1.0 - mu * (1.0 + e) / math.tan(angle)
    spin = 2.5 * mu * (1.0 + e) * SPEED * math.cos(angle) / (0.5 * D)
    assert event["v_end"][0] == pytest.approx(e_t * SPEED * math.sin(angle), rel=5e-3)
    assert event["omega_end"][1] == pytest.approx(spin, rel=2e-2)
    # slides throughout: tan(angle) is far beyond (7/2) mu (1 + e)
    assert event["t_slide"] > 0.95 * (event["t_end"] - event["t_begin"])


@pytest.mark.full
def test_gross_sliding_without_tension_has_a_smaller_impulse_if_the_spring_is_capped():
    # only the spring feeds the cap: (1 + e) becomes (1 + e) - 4 zeta**2 e (validation.md, a)
    e, mu, angle = 0.7, 0.1, math.radians(60.0)
    zeta = collision.zeta_no_tension(e)
    law = contact_law(mu=mu, zeta_n=zeta, slip=Slip.SPRING_DROP)
    event, _ = oblique(angle, law, per_contact=1000.0)
    share = (1.0 + e) - 4.0 * zeta**2 * e
    lost = SPEED * math.sin(angle) - event["v_end"][0]
    assert lost == pytest.approx(mu * share * SPEED * math.cos(angle), rel=4e-3)


@pytest.mark.full
@pytest.mark.parametrize("rotation", [True, False])
def test_a_sticking_impact_changes_the_tangential_speed_as_derived(rotation):
    ratio, angle = 2.0 / 7.0 if rotation else 0.6, math.radians(30.0)
    law = contact_law(ratio=ratio, mu=1.0e3, zeta_n=0.0)
    event, _ = oblique(angle, law, rotation=rotation, per_contact=1000.0, speed=0.05)
    stiff = 3.5 * ratio if rotation else ratio
    slip = math.cos(math.pi * math.sqrt(stiff))
    assert event["slip_end"][0] / event["slip_begin"][0] == pytest.approx(slip, abs=4e-3)


@pytest.mark.full
@pytest.mark.parametrize("rotation", [True, False])
@pytest.mark.parametrize("ratio", [0.1, 2.0 / 7.0, 0.6])
def test_damped_sticking_gives_the_restitution_of_the_tangential_oscillator(rotation, ratio):
    # x'' + 2 zeta w x' + w**2 x = 0 from x = 0: what is left of the slip when the normal force ends
    e, zeta_s = 0.7, collision.zeta_tension(0.7)
    law = contact_law(ratio=ratio, mu=1.0e3, zeta_n=collision.zeta_no_tension(e), zeta_s=zeta_s)
    event, engine = oblique(math.radians(30.0), law, rotation=rotation, per_contact=2000.0, speed=0.02)
    m = float(engine._scene.m[0])
    t = collision.contact_time_no_tension(law.zeta_n, math.sqrt(law.k_n / m))
    w = math.sqrt(law.k_s * (3.5 if rotation else 1.0) / m)
    damped = w * math.sqrt(1.0 - zeta_s**2)
    left = math.exp(-zeta_s * w * t) * (math.cos(damped * t) - zeta_s * w / damped * math.sin(damped * t))
    assert event["slip_end"][0] / event["slip_begin"][0] == pytest.approx(left, abs=4e-3)


@pytest.mark.full
def test_an_oblique_impact_in_3d_is_the_plane_one_turned():
    law = contact_law(mu=0.3, zeta_n=0.1, zeta_s=0.1)
    flat, _ = oblique(math.radians(40.0), law)
    turn = 0.7
    v = SPEED * np.array(
        [
            math.sin(0.698131700797732) * math.cos(turn),
            math.sin(0.698131700797732) * math.sin(turn),
            -math.cos(0.698131700797732),
        ]
    )
    t_col = collision.collision_time(float(scene([[0, 0, 1.0]], D, contact=law)[0].m[0]), law.k_n)
    made = scene(
        [[0.0, 0.0, 0.5 * D + 1e-7]],
        D,
        v=[v],
        planes=[("floor", (0, 0, 0), (0, 0, 1))],
        contact=law,
        dt=t_col / 400.0,
        gravity=0.0,
    )
    (event,) = run(made, 600).events()
    along = event["v_end"][0] * math.cos(turn) + event["v_end"][1] * math.sin(turn)
    assert along == pytest.approx(flat["v_end"][0], rel=1e-9)
    assert event["v_end"][2] == pytest.approx(flat["v_end"][2], rel=1e-12)


@pytest.mark.parametrize("timing", full_but([ContactTiming.EXACT], ContactTiming))
def test_the_plane_kernel_agrees_with_the_3d_kernel(timing):
    law = contact_law(mu=0.3, zeta_n=0.1, zeta_s=0.1, timing=timing)
    ends = []
    for plane_case in (True, False):
        made = scene(
            [[0.0, 0.0, 0.0], [1.6e-3, 0.0, 1.3e-3]],
            D,
            v=[[0.1, 0.0, 0.2], [-0.3, 0.0, -0.4]],
            omega=[[0.0, 90.0, 0.0], [0.0, -30.0, 0.0]],
            contact=law,
            gravity=0.0,
            plane_case=plane_case,
        )
        state = run(made, 400).state()
        ends.append(np.hstack([state.x, state.v, state.omega * 1e-3]))
    assert ends[0] == pytest.approx(ends[1], rel=1e-9, abs=1e-15)


@pytest.mark.full
@pytest.mark.parametrize("plane_case", [True, False])
def test_angular_momentum_of_a_free_pair_is_kept_to_round_off(plane_case):
    law = contact_law(mu=0.4, zeta_n=0.1, zeta_s=0.2)
    y = 0.0 if plane_case else 0.4e-3
    v = np.array([[0.2, y * 100, 0.1], [-0.3, 0.0, -0.4]])
    omega = np.array([[0.0, 300.0, 0.0], [0.0, -100.0, 0.0]])
    if not plane_case:
        omega += [[50.0, 0.0, 20.0], [0.0, 0.0, 70.0]]
    made = scene(
        [[0.0, 0.0, 0.0], [1.2e-3, y, 1.62e-3]],
        [D, 1.2 * D],
        v=v,
        omega=omega,
        contact=law,
        gravity=0.0,
        plane_case=plane_case,
        allow_overlap=True,
    )
    fixed, first = made

    engine = run(made, 2000)
    last = engine.state()
    assert len(engine.events()) >= 1
    # sums of 2,000 steps, each rounded at the size of m v (5e-6 kg m/s) and m v x (1e-8 kg m2/s)
    for before, after, size in zip(momentum(fixed, first), momentum(fixed, last), (5e-6, 1e-8), strict=True):
        assert after == pytest.approx(before, rel=0.0, abs=1e-11 * size)


@pytest.mark.full
@pytest.mark.parametrize(("spin", "angle"), [((900.0, 0.0, 0.0), 1.2), ((0.0, 60.0, -20.0), 0.02)])
def test_the_spring_of_a_pair_that_rotates_as_a_whole_rotates_with_it(spin, angle):
    # turned about its normal the positions stay; turned about another axis straight steps slip by k_s
    # d angle**3 only
    law = contact_law(mu=1e3, zeta_n=0.0)
    axis = np.array(spin) / np.linalg.norm(spin)
    half = 0.5 * (D - 1e-3 * D) * np.array([1.0, 0.0, 0.0])
    x = np.array([-half, half])
    steps = 4000
    dt = angle / float(np.linalg.norm(spin)) / steps
    fixed, first = scene(
        x, D, v=np.cross(spin, x), omega=[spin, spin], contact=law, gravity=0.0, allow_overlap=True, dt=dt
    )
    heavy = replace(
        fixed, m=fixed.m * 1e12, inertia=fixed.inertia * 1e12
    )  # forces do not move them: pure turning
    engine = run((heavy, first), 1)
    state = engine.state()
    force = np.array([0.0, 3e-2, -4e-2])
    engine.load(heavy, replace(state, contacts=replace(state.contacts, spring_s=np.array([force]))))
    engine.advance(steps).raise_if_any()
    expected = (
        force * math.cos(angle)
        + np.cross(axis, force) * math.sin(angle)
        + axis * (axis @ force) * (1.0 - math.cos(angle))
    )
    assert engine.state().contacts.spring_s[0] == pytest.approx(expected, abs=3e-3 * np.linalg.norm(force))
