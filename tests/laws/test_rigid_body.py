"""Torque-free rotation: what it keeps, the period of the tumbling in closed form, order of convergence."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit
from scipy.special import ellipk

from ryusa.laws import rigid_body

component = st.floats(-1.0, 1.0)
MOMENTS = (1.0, 2.0, 3.0)
rotor_step = rigid_body.rotor_step  # globals of a compiled function
rotate_back = rigid_body.rotate_back
rotate = rigid_body.rotate
rotational_energy = rigid_body.rotational_energy


@njit
def _steps(l_x, l_y, l_z, i_1, i_2, i_3, dt, n):
    """Energy and angular momentum in the body frame after each step, from the body frame in space."""
    q = (1.0, 0.0, 0.0, 0.0)
    found = np.empty((n + 1, 4))
    for k in range(n + 1):
        found[k, 0] = rotational_energy(*q, l_x, l_y, l_z, 1.0 / i_1, 1.0 / i_2, 1.0 / i_3)
        found[k, 1:] = rotate_back(l_x, l_y, l_z, *q)
        if k < n:
            q = rotor_step(*q, l_x, l_y, l_z, 1.0 / i_1, 1.0 / i_2, 1.0 / i_3, dt)[:4]
    return found, q


def tumble(momentum, dt, n, moments=MOMENTS):
    """Energy, angular momentum in the body frame after each step, and the orientation at the end."""
    found, q = _steps(*momentum, *moments, dt, n)
    return found[:, 0], found[:, 1:], np.array(q)


def unit(values):
    q = np.array(values)
    return tuple((q / np.linalg.norm(q)).tolist())


@given(v=st.tuples(component, component, component), q=st.tuples(component, component, component))
def test_a_rotation_keeps_lengths_and_is_undone_by_its_inverse(v, q):
    q = unit((1.5, *q))
    there = rigid_body.rotate(*v, *q)
    assert math.hypot(*there) == pytest.approx(math.hypot(*v), rel=1e-14, abs=1e-300)
    assert rigid_body.rotate_back(*there, *q) == pytest.approx(v, rel=1e-14, abs=1e-15)


@given(w=st.tuples(component, component, component), q=st.tuples(component, component, component))
def test_angular_momentum_and_spin_are_inverse_and_give_the_energy(w, q):
    q = unit((1.5, *q))
    momentum = rigid_body.angular_momentum(*q, *w, *MOMENTS)
    over = [1.0 / one for one in MOMENTS]
    assert rigid_body.spin(*q, *momentum, *over) == pytest.approx(w, rel=1e-13, abs=1e-14)
    energy = rigid_body.rotational_energy(*q, *momentum, *over)
    assert energy == pytest.approx(0.5 * np.dot(w, momentum), rel=1e-13, abs=1e-15)


def test_a_step_backwards_undoes_a_step():
    q = unit((0.3, -0.2, 0.7, 0.4))
    args = (0.3, -1.2, 0.8, 1.0, 0.5, 1.0 / 3.0)
    there = rigid_body.rotor_step(*q, *args, 0.4)
    assert rigid_body.rotor_step(*there[:4], *args, -0.4)[:4] == pytest.approx(q, abs=1e-15)


def _no_squish(q, p, moments, dt):
    """The step as published, on the quaternion and the momenta conjugate to it."""
    permuted = {
        0: lambda a: np.array([-a[1], a[0], a[3], -a[2]]),
        1: lambda a: np.array([-a[2], -a[3], a[0], a[1]]),
        2: lambda a: np.array([-a[3], a[2], -a[1], a[0]]),
    }
    for k, share in ((2, 0.5), (1, 0.5), (0, 1.0), (1, 0.5), (2, 0.5)):
        q_k, p_k = permuted[k](q), permuted[k](p)
        angle = share * dt * float(p @ q_k) / (4.0 * moments[k])
        q, p = (np.cos(angle) * a + np.sin(angle) * a_k for a, a_k in ((q, q_k), (p, p_k)))
    return q, p


def test_the_step_is_that_of_the_published_scheme():
    momentum = (0.5, 1.0, 0.8)
    q = unit((0.3, -0.2, 0.7, 0.4))
    a, b, c = rigid_body.rotate_back(*momentum, *q)
    w, x, y, z = q
    rows = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]])
    published, p = np.array(q), 2.0 * rows @ np.array([a, b, c])
    for _ in range(50):
        published, p = _no_squish(published, p, MOMENTS, 0.2)
        q = rigid_body.rotor_step(*q, *momentum, *(1.0 / one for one in MOMENTS), 0.2)[:4]
    assert q == pytest.approx(published, abs=1e-13)


def test_energy_does_not_drift_in_a_hundred_thousand_steps():
    energy, body, q = tumble((0.5, 1.0, 0.8), 0.02, 100_000)
    first, last = energy[:20_000], energy[-20_000:]
    assert np.ptp(energy) / energy[0] < 1e-4  # it swings with the tumbling, of second order in the step
    for of in (np.min, np.max):  # and the swing stays where it was
        assert of(last) == pytest.approx(of(first), rel=1e-9)
    assert np.linalg.norm(body, axis=1) == pytest.approx(math.sqrt(1.89), rel=1e-14)
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=5e-16)


def test_energy_of_equal_moments_is_kept_to_round_off():
    energy, _, _ = tumble((0.5, 1.0, 0.8), 0.05, 100_000, (2.0, 2.0, 2.0))
    assert energy == pytest.approx(energy[0], rel=1e-14)


def _period(energy, l_l, moments):
    """Period of the angular momentum in the body frame; Landau & Lifshitz, Mechanics, section 37."""
    i_1, i_2, i_3 = moments
    if l_l < 2.0 * energy * i_2:  # it goes round axis 1: exchange the names of 1 and 3
        i_1, i_3 = i_3, i_1
    rate = math.sqrt((i_3 - i_2) * (l_l - 2.0 * energy * i_1) / (i_1 * i_2 * i_3))
    m = (i_2 - i_1) * (2.0 * energy * i_3 - l_l) / ((i_3 - i_2) * (l_l - 2.0 * energy * i_1))
    return 4.0 * ellipk(m) / rate


def _measured_period(values, dt):
    """Mean time between upward crossings of zero, each found to fourth order."""
    at = np.flatnonzero((values[1:-2] < 0.0) & (values[2:-1] >= 0.0)) + 1
    times = []
    for k in at:
        cubic = np.polyfit([-1.0, 0.0, 1.0, 2.0], values[k - 1 : k + 3], 3)
        roots = np.roots(cubic)
        real = roots[np.abs(roots.imag) < 1e-9].real
        times.append((k + real[np.argmin(np.abs(real - 0.5))]) * dt)
    assert len(times) > 3
    return (times[-1] - times[0]) / (len(times) - 1)


@pytest.mark.parametrize(
    "momentum",
    [(1e-3, 2.0, 0.0), (0.0, 2.0, 1e-3), (0.4, 1.0, 0.9)],
    ids=["flip-about-1", "flip-about-3", "large"],
)
def test_the_intermediate_axis_flips_with_the_period_of_the_closed_form(momentum):
    dt = 2e-3
    energy, body, _ = tumble(momentum, dt, 150_000)
    assert body[:, 1].min() < -0.9 * body[:, 1].max() < 0.0  # it turns over, all the way
    expected = _period(energy[0], float(np.dot(momentum, momentum)), MOMENTS)
    assert _measured_period(body[:, 1], dt) == pytest.approx(expected, rel=2e-6)


@pytest.mark.parametrize("axis", [0, 2])
def test_rotation_about_the_other_axes_is_stable(axis):
    momentum = [1e-3, 1e-3, 1e-3]
    momentum[axis] = 2.0
    _, body, _ = tumble(momentum, 0.01, 100_000)
    aside = np.delete(body, axis, axis=1)
    assert np.abs(aside).max() < 5e-3
    assert body[:, axis].min() > 1.99


def test_the_orientation_converges_with_the_second_order():
    answers = [tumble((0.5, 1.0, 0.8), 4.0 / n, n)[2] for n in (64, 128, 256, 8192)]
    errors = [np.linalg.norm(one - answers[-1]) for one in answers[:-1]]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(2.0, abs=0.02)


def test_a_symmetric_top_precesses_at_the_rate_of_the_closed_form():
    moments, momentum = (2.0, 2.0, 1.0), (0.6, 0.0, 1.0)
    _, body, _ = tumble(momentum, 1e-3, 100_000, moments)
    rate = momentum[2] * (1.0 / moments[2] - 1.0 / moments[0])  # of the momentum in the body, about axis 3
    assert _measured_period(body[:, 0], 1e-3) == pytest.approx(2.0 * math.pi / rate, rel=1e-6)


@njit
def _heavy_top(q, momentum, over, pull, arm, dt, n):
    """Energy and vertical angular momentum of a top that stands on its tip, kicked half a step each side."""
    l_x, l_y, l_z = momentum
    found = np.empty((n, 2))
    for k in range(n):
        x, y, z = rotate(0.0, 0.0, arm, *q)
        found[k, 0] = rotational_energy(*q, l_x, l_y, l_z, *over) + pull * z
        found[k, 1] = l_z
        l_x, l_y = l_x - 0.5 * dt * pull * y, l_y + 0.5 * dt * pull * x
        q = rotor_step(*q, l_x, l_y, l_z, *over, dt)[:4]
        x, y, z = rotate(0.0, 0.0, arm, *q)
        l_x, l_y = l_x - 0.5 * dt * pull * y, l_y + 0.5 * dt * pull * x
    return found


def test_a_heavy_top_keeps_its_energy_and_its_vertical_angular_momentum():
    q, over = unit((1.0, 0.3, 0.0, 0.0)), (1.0, 1.0, 2.0)
    momentum = rigid_body.rotate(0.0, 0.0, 3.0, *q)
    swings = []
    for dt in (0.02, 0.01):
        found = _heavy_top(q, momentum, over, 1.0, 0.8, dt, 100_000)
        energy = found[:, 0]
        assert (found[:, 1] == momentum[2]).all()
        for of in (np.min, np.max):
            assert of(energy[-20_000:]) == pytest.approx(of(energy[:20_000]), rel=1e-6)
        swings.append(np.ptp(energy))
    assert swings[0] / swings[1] == pytest.approx(4.0, rel=0.05)
