import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.laws.collision import zeta_no_tension
from ryusa.laws.families import Cap, Slip
from ryusa.model import Scene
from ryusa.model.scene import ContactLaw
from ryusa_studies.osada2004.forward_euler import integrate, step

D = 0.002


def scene(gap, **how):
    """One free grain above one fixed grain."""
    law = ContactLaw(k_n=100.0, k_s=28.57, mu=0.5, e_n=0.7, e_s=0.7, zeta_n=0.11, zeta_s=0.11)
    m = 2650.0 * math.pi / 6.0 * D**3
    one = np.ones(1)
    return Scene(
        d=D * one, m=m * one, m_added=0 * one, m_weight=m * one, inertia=0.1 * m * D * D * one,
        x_fixed=np.zeros((1, 3)), d_fixed=D * one, fixed_active=np.ones(1, dtype=bool),
        plane_normal=np.zeros((0, 3)), plane_point=np.zeros((0, 3)), plane_active=np.zeros(0, dtype=bool),
        contact=law, dt=1e-6, gravity=np.array([0.0, 0.0, -9.8]), rotation=False, plane_case=True, **how,
    ), np.array([[0.0, 0.0, D + gap]])  # fmt: skip


@pytest.mark.parametrize("summed", [True, False])
def test_forward_differences_fall_freely_and_rebound_with_e_at_a_fine_step(summed):
    low, start = scene(0.001)
    dt = step(low, 1000.0)
    t, x = integrate(low, start, dt, 0.035, 2e-5, summed=summed)
    gap = x[:, 0, 2] - D
    falling = t < 0.012
    np.testing.assert_allclose(gap[falling], 0.001 - 4.9 * t[falling] ** 2, atol=2e-7)
    after = t > t[np.argmin(gap)]
    assert math.sqrt(gap[after].max() / 0.001) == pytest.approx(0.7, abs=0.02)


def test_forward_differences_add_energy_to_a_resting_grain_with_too_few_steps():
    low, start = scene(-1e-6)
    zeta = zeta_no_tension(0.7)
    stable = 0.929 * math.pi / (2.0 * zeta)
    moved = []
    for steps in (0.8 * stable / math.sqrt(2.0), 4.0 * stable):  # the step is a part of a free pair's contact
        dt = step(low, steps)
        _, x = integrate(low, start, dt, 0.3, 1e-4, summed=False)
        moved.append(np.ptp(x[-200:, 0, 2]))
    assert moved[0] > 1e-7
    assert moved[1] < 1e-10


def test_the_step_of_the_stiff_box_is_a_tenth_of_that_of_the_soft_one():
    low, _ = scene(0.0)
    assert step(low, 10.0, 1.0e4) == pytest.approx(0.1 * step(low, 10.0))


def test_forward_differences_slide_as_the_rule_says():
    def slipped(slip):
        """A grain that settles on two others, one of which it slides down on."""
        low, _ = scene(0.0)
        cap = Cap.TOTAL if slip is Slip.TOTAL else Cap.SPRING
        low = replace(
            low, contact=replace(low.contact, slip=slip, cap=cap, mu=0.2), d_fixed=D * np.ones(2),
            x_fixed=np.array([[0.0, 0.0, 0.0], [1.2 * D, 0.0, 0.0]]), fixed_active=np.ones(2, dtype=bool),
        )  # fmt: skip
        _, x = integrate(low, np.array([[0.3 * D, 0.0, 1.2 * D]]), step(low, 100.0), 0.02, 1e-4, summed=False)
        return x[-1, 0, 2]

    heights = {slip: slipped(slip) for slip in Slip}
    assert len(set(heights.values())) == len(Slip)  # each rule takes its own energy
    assert max(heights.values()) < 1.1 * D
