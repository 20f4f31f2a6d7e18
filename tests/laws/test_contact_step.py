"""The step of a contact: geometry and kinematics, forces, and the account of their work."""

import math

import numpy as np
import pytest

from ryusa.laws import contact, contact_step
from ryusa.laws.collision import omega_natural, restitution_no_tension
from ryusa.laws.geometry import turn
from ryusa.laws.motion import semi_implicit

RNG = np.random.default_rng(18)
STATES = 2000
K_N, K_S, ETA_N, ETA_S, MU, DT = 1.0e4, 2.0e3, 0.1, 0.05, 0.4, 2.0e-6


def unit(v):
    return v / np.linalg.norm(v)


def pair(plane=False):
    """A random pair that touches: separation, radii, relative velocity, spins."""
    r_i, r_j = RNG.uniform(0.8e-3, 1.2e-3, 2)
    shape = np.array([1.0, 0.0, 1.0]) if plane else np.ones(3)
    d = unit(RNG.normal(size=3) * shape) * (r_i + r_j) * RNG.uniform(0.99, 1.0)
    w = RNG.normal(0.0, 50.0, (2, 3)) * (1.0 - shape if plane else 1.0)
    return d, r_i, r_j, RNG.normal(0.0, 0.1, 3) * shape, *w


def meet(plane, d, r_i, r_j, u, w_i, w_j):
    found = contact_step.contact_kinematics(plane, *d, r_i + r_j, r_i, *u, *w_i, *w_j, DT)
    n, (overlap, a_i, a_j, closing), s, twist = found[:3], found[3:7], found[7:10], found[10]
    return np.array(n), overlap, a_i, a_j, closing, np.array(s), twist


def tangential(plane, n, twist, f_n, e_n, held, s, p, q, total=False, drop=False):
    found = contact_step.tangential_step(
        plane, total, drop, False, *n, twist, f_n, e_n, held, *s, *p, *q, K_S, 1.0 / K_S, ETA_S, 0.0, MU,
        DT, 0.5 * DT,
    )  # fmt: skip
    return np.array(found[:3]), np.array(found[3:6]), *found[6:]


def test_with_grains_exchanged_normal_and_slip_are_opposite_and_the_rest_is_the_same():
    for _ in range(STATES):
        d, r_i, r_j, u, w_i, w_j = pair()
        n, overlap, a_i, a_j, closing, s, twist = meet(False, d, r_i, r_j, u, w_i, w_j)
        m, other, b_j, b_i, nearing, slip, turned = meet(False, -d, r_j, r_i, -u, w_j, w_i)
        assert m == pytest.approx(-n)
        assert slip == pytest.approx(-s, abs=1e-12)
        assert (other, nearing, turned) == pytest.approx((overlap, closing, -twist), abs=1e-12)
        assert (b_i, b_j) == pytest.approx((a_i, a_j), rel=0.01)
        assert a_i + a_j == pytest.approx(np.linalg.norm(d), rel=1e-14)


def test_a_pair_that_rotates_as_one_body_has_no_slip_and_no_closing_speed():
    for _ in range(STATES):
        d, r_i, r_j, _, w, _ = pair()
        found = meet(False, d, r_i, r_j, np.cross(w, -d), w, w)
        assert found[4] == pytest.approx(0.0, abs=1e-13)
        assert found[5] == pytest.approx(np.zeros(3), abs=1e-13)
        assert found[6] == pytest.approx(DT * (w @ found[0]), abs=1e-15)


@pytest.mark.parametrize("rule", [{}, {"total": True}, {"drop": True}])
def test_the_plane_and_the_3d_branch_agree_on_every_plane_state(rule):
    for _ in range(STATES):
        d, r_i, r_j, u, w_i, w_j = pair(plane=True)
        flat, deep = (meet(plane, d, r_i, r_j, u, w_i, w_j) for plane in (True, False))
        n = flat[0]
        t = np.array([n[2], 0.0, -n[0]])
        assert flat[1:5] == pytest.approx(deep[1:5], rel=1e-12)
        assert flat[5][0] * t == pytest.approx(deep[5], abs=1e-13)
        overlap, closing, held = flat[1], flat[4], float(RNG.random() < 0.9)
        e_n = K_N * overlap
        f_n = e_n + ETA_N * closing
        p, q = RNG.normal(0.0, MU * e_n), RNG.normal(0.0, 0.01)
        one = tangential(True, n, 0.0, f_n, e_n, held, flat[5], (p, 0.0, 0.0), (q, 0.0, 0.0), **rule)
        all_ = tangential(False, n, 0.0, f_n, e_n, held, deep[5], p * t, q * t, **rule)
        assert one[0][0] * t == pytest.approx(all_[0], abs=1e-12)
        assert one[1][0] * t == pytest.approx(all_[1], abs=1e-12)
        assert one[2:] == pytest.approx(all_[2:], rel=1e-9, abs=1e-15)
        force_plane = contact_step.contact_force(True, *n, f_n, *(one[0] + one[1]))
        force_space = contact_step.contact_force(False, *n, f_n, *(all_[0] + all_[1]))
        assert force_plane == pytest.approx(force_space, abs=1e-12)


@pytest.mark.parametrize("rule", [{}, {"total": True}, {"drop": True}])
def test_the_tangential_force_is_capped_and_the_work_of_sliding_is_the_energy_lost_by_the_spring(rule):
    slid = 0
    for _ in range(STATES):
        d, r_i, r_j, u, w_i, w_j = pair()
        n, overlap, _, _, closing, s, twist = meet(False, d, r_i, r_j, u, w_i, w_j)
        e_n = K_N * overlap
        p = MU * e_n * RNG.uniform(0.98, 1.0) * unit(np.cross(n, RNG.normal(size=3)))
        e, b, share, _, sliding, released = tangential(
            False, n, twist, e_n + ETA_N * closing, e_n, 1.0, s, p, np.zeros(3), **rule
        )
        turned = np.array(turn(*p, *n, twist))
        capped = e + b if rule.get("total") else e
        assert np.linalg.norm(capped) <= MU * e_n * (1.0 + 1e-12)
        assert capped @ n == pytest.approx(0.0, abs=1e-9)
        assert released == 0.0
        if share < 1.0:
            slid += 1
            left = (p @ p - e @ e) / (2.0 * K_S)  # energy that left the spring
            force = turned + e + (b if rule.get("total") else 0.0)  # one of both is capped as a whole
            assert sliding == pytest.approx(left - 0.5 * DT * s @ force, rel=1e-9, abs=1e-18)
        else:
            assert sliding == 0.0
            assert e == pytest.approx(turned - K_S * s * DT, abs=1e-15)
    assert 0.1 * STATES < slid < 0.9 * STATES


def test_a_contact_without_normal_force_has_no_tangential_force():
    e, b, share, _, sliding, released = tangential(
        False, (0.0, 0.0, 1.0), 0.0, 0.0, 0.1, 0.0, (0.1, 0.0, 0.0), (0.01, 0.0, 0.0), np.zeros(3)
    )
    assert not e.any() and not b.any() and share == 0.0 and sliding == 0.0
    assert released == pytest.approx(0.5 * 1e-4 / K_S - 0.5 * DT * 1e-3)


@pytest.mark.parametrize("least", [0.0, -math.inf])
@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.3])
def test_one_collision_agrees_with_the_oscillator_and_its_account_closes(least, zeta):
    m = 1.0e-5
    eta = contact.damping_in_steps(contact.damping(zeta, K_N, m), m, DT)
    x, v = 1.3e-9, -1.0  # the gap, and the speed at which it grows
    first = 0.5 * m * v * v
    f_old = d_old = 0.0
    was = False
    dashpot = released = step = 0.0
    for _ in range(200):
        f_n, e_n, _, touching, *work = contact_step.normal_step(
            -x, -v, contact.normal_force(-x, -v, K_N, eta), was, least, K_N, 0.5 * DT
        )
        before = contact_step.normal_work_of_last_force(
            -v, f_old, d_old, was and touching == 0.0, least, 1.0 / K_N, 0.5 * DT
        )
        dashpot, released, step = (
            total + a + b for total, a, b in zip((dashpot, released, step), work, before, strict=True)
        )
        x, v = semi_implicit(x, v, f_n / m, DT)
        f_old, d_old, was = f_n, f_n - e_n, touching > 0.0
    assert 0.5 * m * v * v == pytest.approx(first - dashpot - released + step, rel=1e-12, abs=1e-20)
    assert DT * omega_natural(K_N, m) < 0.1
    if least == 0.0:
        assert v == pytest.approx(restitution_no_tension(zeta), abs=1e-2)  # of one phase of first touch
        assert released != 0.0 or zeta == 0.0
    else:
        assert released == 0.0


def test_force_and_torques_keep_momentum_and_angular_momentum():
    for _ in range(STATES):
        d, r_i, r_j, u, w_i, w_j = pair()
        n, _, a_i, a_j, _, s, _ = meet(False, d, r_i, r_j, u, w_i, w_j)
        found = contact_step.contact_force(False, *n, RNG.normal(), *s)
        force, torque = np.array(found[:3]), np.array(found[3:])
        assert torque == pytest.approx(np.cross(n, s), abs=1e-14)
        assert np.cross(-d, force) + (a_i + a_j) * torque == pytest.approx(np.zeros(3), abs=1e-15)
