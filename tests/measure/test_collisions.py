"""Oblique impacts on a fixed grain, held against the same laws integrated in polar coordinates."""

import math

import numpy as np
import pytest

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.measure import collisions, turned_time
from ryusa.running.runner import run

SMOOTH = {"contact.friction_angle": "0 deg", "contact.restitution_shear": "1.0"}


def impact(folder, stiffness, steps, **more):
    """Strike a fixed grain from straight above at 0.3 m/s, with 0.7 m/s along; dry, no weight to speak of."""
    overrides = {
        "contact.stiffness": f"{stiffness} N/cm",
        "contact.friction_angle": "30 deg",
        "contact.slip": "spring",  # what `reference` integrates
        "motion.gravity": "1e-9 m/s2",
        "build.height": "0 cm",
        "build.speed": "0.3 m/s",
        "build.speed_along": "0.7 m/s",
        "time.steps_per_contact": str(steps),
        "stop.time": "10 ms",
        "record.settle": "0 s",
        **more,
    }
    results = run(read(case_path("drop.toml"), overrides), folder, progress=False)
    return results, collisions(results, "bed")


def reference(scene, speed, along, turning=True, n=4000):
    """Restitution from the same laws in polar coordinates about the fixed grain (Runge-Kutta)."""
    law, m, d = scene.contact, float(scene.m[0]), float(scene.d[0])
    spins = scene.rotation == 1
    inertia = 0.1 * m * d * d
    m_t = 1.0 / (1.0 / m + 0.25 * d * d / inertia) if spins else m
    eta_n, eta_s = (2.0 * z * math.sqrt(k * w) for z, k, w in
                    ((law.zeta_n, law.k_n, m), (law.zeta_s, law.k_s, m_t)))  # fmt: skip

    def rate(state):
        r, v_r, v_t, spring, omega = state
        overlap, slip = d - r, v_t - 0.5 * r * omega
        f_n = max(law.k_n * overlap - eta_n * v_r, 0.0)
        cap = law.mu * law.k_n * overlap
        stuck = abs(spring) < cap or spring * slip < 0.0
        f_s = -(min(max(spring, -cap), cap) + eta_s * slip) if f_n > 0.0 else 0.0
        turn = v_t / r if turning else 0.0
        return np.array(
            [v_r, f_n / m + v_t * turn, f_s / m - v_r * turn, law.k_s * slip if stuck else 0.0,
             -0.5 * r * f_s / inertia if spins else 0.0]
        )  # fmt: skip

    h = 1.5 * math.pi * math.sqrt(m / law.k_n) / n
    state = np.array([d, -speed, along, 0.0, 0.0])
    for _ in range(n):
        a = rate(state)
        b = rate(state + 0.5 * h * a)
        c = rate(state + 0.5 * h * b)
        last, state = state, state + h / 6.0 * (a + 2.0 * b + 2.0 * c + rate(state + h * c))
        cap = law.mu * law.k_n * max(d - state[0], 0.0)
        state[3] = min(max(state[3], -cap), cap)
        if state[0] >= d:
            share = (d - last[0]) / (state[0] - last[0])
            return (last[1] + share * (state[1] - last[1])) / speed
    raise AssertionError("still in touch")


@pytest.mark.parametrize("more", [{}, SMOOTH, {"motion.rotation": "free"}], ids=["locked", "smooth", "free"])
@pytest.mark.parametrize("stiffness", [100, 1600])
def test_an_oblique_impact_gives_the_restitution_that_its_turning_normal_leaves(tmp_path, more, stiffness):
    run_, found = impact(tmp_path / "run", stiffness, 2000, **more)
    assert len(found.events) == 1
    expected = reference(run_.scene, 0.3, 0.7)
    assert reference(run_.scene, 0.3, 0.7, turning=False) == pytest.approx(0.7, abs=2e-4)
    assert found.restitution[0] == pytest.approx(expected, abs=4e-4)
    lost = expected - 0.7
    assert (lost > 0.0) == (more is SMOOTH)  # shear takes speed along the bed; without it the turning adds


def test_the_effect_of_rotation_of_the_normal_halves_at_four_times_the_stiffness(tmp_path):
    for more in ({}, SMOOTH):
        off = []
        for k in (100, 400, 1600):
            run_, _ = impact(tmp_path / f"{k}-{len(more)}", k, 50, **more)
            off.append(reference(run_.scene, 0.3, 0.7) - 0.7)
        assert np.array(off[:-1]) / np.array(off[1:]) == pytest.approx([2.0, 2.0], abs=0.35)


def test_a_smooth_elastic_oblique_impact_lasts_as_long_as_its_closed_form_says(tmp_path):
    more = SMOOTH | {"contact.restitution": "1.0"}
    for k in (100, 1600):
        _, found = impact(tmp_path / str(k), k, 2000, **more)
        share = (found.duration / found.expected)[0]
        assert found.turning[0] == pytest.approx(0.49 * found.expected[0] / (0.002 * 0.3), rel=2e-3)
        assert share == pytest.approx(turned_time(found.turning)[0], abs=2e-3)
        assert found.restitution[0] == pytest.approx(1.0, abs=2e-3)


def test_the_rotation_of_the_normal_is_known_only_for_fixed_partners(tmp_path):
    overrides = {
        "build.partner": "free",
        "build.speed": "0.3 m/s",
        "stop.time": "10 ms",
        "record.settle": "0 s",
    }
    results = run(read(case_path("drop.toml"), overrides), tmp_path / "run", progress=False)
    assert np.isnan(collisions(results).turning).all()
