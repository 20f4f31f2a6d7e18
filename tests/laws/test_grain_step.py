"""The step of a grain: the scheme, and what forces leave behind."""

import math

import numpy as np
import pytest

from ryusa.laws import drag, grain_step

M, DT, G = 1.1e-5, 1.0e-4, 9.8


def test_a_grain_that_sinks_under_stokes_drag_reaches_its_terminal_velocity_and_its_account_closes():
    d, rho_w, nu = 1.0e-4, 1000.0, 1.0e-6
    volume = math.pi / 6.0 * d**3
    m, weight, k_d = 2650.0 * volume, (2650.0 - rho_w) * volume, 3.0 * math.pi * rho_w * nu * d
    z, v = 0.0, 0.0
    pending = work = 0.0
    for step in range(4000):
        z_old = z
        after = 0.5 * 1e-5
        new, u = grain_step.translation_step(z, v, 0.0, -k_d * v, -weight * G, 1.0 / m, 1e-5)
        done, later = grain_step.work_of_force(0.0 if step == 0 else after, after, -k_d * v, v, u)
        held = grain_step.kinetic_energy(m, 0.0, 0.0, v, 0.0, 0.0, u)
        held += grain_step.potential_energy(weight, 0.0, 0.0, -G, 0.0, 0.0, z)
        work, pending = work + pending + done, later
        z, v = new, u
    assert z < z_old
    assert v == pytest.approx(-drag.terminal_velocity_stokes(1.65, G, d, nu), rel=1e-6)
    assert held == pytest.approx(work, rel=1e-4)  # the account begins half a step late


def test_the_work_of_a_force_by_half_intervals_is_the_gain_of_kinetic_energy():
    rng = np.random.default_rng(3)
    x, v = np.zeros(3), rng.normal(size=3)
    start = grain_step.kinetic_energy(M, *v, *v)
    total = 0.0
    for step in range(50):
        f = rng.normal(size=3)
        moved = [grain_step.translation_step(x[k], v[k], f[k], 0.0, 0.0, 1.0 / M, DT) for k in range(3)]
        x, u = (np.array(part) for part in zip(*moved, strict=True))
        for k in range(3):
            total += sum(grain_step.work_of_force(0.5 * DT, 0.5 * DT, f[k], v[k], u[k]))
        v = u
        assert grain_step.kinetic_energy(M, *v, *v) == pytest.approx(start + total, rel=1e-12), step


def test_a_spin_under_a_torque_that_resists_decays_as_the_scheme_says():
    inertia, k_t, w = 1.0e-11, 1.0e-8, 100.0
    for _ in range(100):
        w = grain_step.rotation_step(w, grain_step.resisted_torque(0.0, k_t, w), 1.0 / inertia, DT)
    assert w == pytest.approx(100.0 * (1.0 - DT * k_t / inertia) ** 100, rel=1e-12)


def test_a_grain_carried_by_accelerating_water_takes_no_impulse_of_added_mass():
    a, added = 3.0, 2.0e-6
    assert grain_step.flow_force(0.0, added, a) == added * a
    taken = grain_step.impulse_from_fluid(0.0, 0.0, added, a, 1.0, 1.0 + a * DT, DT)
    assert taken == pytest.approx(0.0, abs=1e-20)
    at_rest = grain_step.impulse_from_fluid(0.0, 0.0, added, a, 0.0, 0.0, DT)
    assert at_rest == pytest.approx(added * a * DT)


def test_a_grain_that_crosses_a_period_keeps_its_height_along_gravity():
    g = (G * math.sin(0.1), 0.0, -G * math.cos(0.1))
    there = grain_step.potential_energy(M, *g, 0.9, 0.0, 0.0)
    past = grain_step.potential_energy(M, *g, grain_step.unwrapped(-0.1, 1, 1.0), 0.0, 0.0)
    assert past == pytest.approx(there)
