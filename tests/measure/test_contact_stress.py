"""Contact stress of arrangements in equilibrium, whose stress follows from their weight."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import ndtr

from ryusa.errors import ResultsError
from ryusa.measure import contact_stress
from ryusa.results.schema import FORCE

D, M = 0.002, 1.11e-5
SIDE = 6 * D
AREA = SIDE * SIDE
GRAVITY = np.array([3.0, 0.0, -9.0])


@pytest.fixture
def resting(make):
    """A run of grains (n_grain, 3) with contacts (i, j, force on i), one fixed grain and a floor."""

    def build(x, contacts, v=None, n_frame=5, fixed=(0.0, 0.0, -10 * D), plane=False, water=None):
        x = np.broadcast_to(np.asarray(x, dtype=float), (n_frame, *np.shape(x)))
        v = np.zeros_like(x) if v is None else np.asarray(v, dtype=float)
        scene = replace(
            make.scene(x.shape[1]), plane_case=plane, period=(SIDE, SIDE), gravity=GRAVITY,
            x_fixed=np.array([fixed]), d_fixed=np.array([D]), fixed_active=np.ones(1, dtype=bool),
            plane_normal=np.array([[0.0, 0.0, 1.0]]), plane_point=np.zeros((1, 3)),
            plane_active=np.ones(1, dtype=bool), slab_width=D,
        )  # fmt: skip
        rows = np.array([(i, j, tuple(f)) for i, j, f in contacts], dtype=FORCE)
        return SimpleNamespace(
            case={"record": {}, "water": water}, scene=scene, contact_forces=lambda k: rows,
            frames=SimpleNamespace(t=0.01 * np.arange(n_frame), x=x, v=v, omega=0.0 * x),
        )  # fmt: skip

    return build


def pile(n=6, lean=0.3):
    """A leaning pile of grains on the floor, each held by the one below; forces of exact equilibrium."""
    step = D * np.array([lean, 0.1, math.sqrt(1.0 - lean**2 - 0.01)])
    x = np.arange(n)[:, None] * step + [0.0, 0.0, 0.5 * D]
    weight = M * GRAVITY
    contacts = [(k, k + 1, (n - 1 - k) * weight) for k in range(n - 1)]  # what lies above presses on k
    return x, [*contacts, (0, n + 1, -n * weight)]


def test_a_pile_at_rest_carries_the_weight_above_at_every_height(resting):
    for layer in (0.1, 0.5, 2.0):
        found = contact_stress(resting(*pile()), layer=layer)
        assert found.deviation < 1e-9
        assert found.deviation_along < 1e-9
        middle = np.abs(found.z - 3 * D).argmin()
        assert found.zz.value[middle] > 0.2 * 6 * M * 9.0 / AREA
        assert found.xz.value[middle] == pytest.approx(-found.zz.value[middle] / 3.0, rel=1e-9)
    assert found["bed_normal"].value == pytest.approx(6 * M * 9.0 / AREA, rel=1e-12)
    assert found["bed_shear"].value == pytest.approx(6 * M * 3.0 / AREA, rel=1e-12)


def test_what_presses_from_above_is_apart_from_what_carries_from_below(resting):
    """A grain on the floor under a fixed grain that pushes it down and along x."""
    lid = np.array([2.0e-4, 0.0, -5.0e-4])
    x = np.array([[D, D, 0.5 * D]])
    run = resting(x, [(0, 1, lid), (0, 2, -M * GRAVITY - lid)], fixed=(D, D, 1.4 * D))
    found = contact_stress(run)
    assert found["lid_normal"].value == pytest.approx(5.0e-4 / AREA, rel=1e-12)
    assert found["lid_shear"].value == pytest.approx(2.0e-4 / AREA, rel=1e-12)
    assert found["bed_normal"].value == pytest.approx((9.0 * M + 5.0e-4) / AREA, rel=1e-12)
    assert found["bed_shear"].value == pytest.approx((3.0 * M + 2.0e-4) / AREA, rel=1e-12)
    assert not any(one.name.startswith("lid") for one in contact_stress(resting(*pile())).averages.items)


def test_a_grain_held_too_weakly_is_found_by_the_balance(resting):
    x, contacts = pile()
    i, j, force = contacts[3]
    contacts[3] = i, j, 0.5 * force
    assert contact_stress(resting(x, contacts)).deviation > 0.05


def test_a_fixed_grain_carries_from_the_point_of_contact_on(resting):
    x = np.array([[D, D, 1.5 * D]])
    run = resting(x, [(0, 1, -M * GRAVITY)], fixed=(D, D, 0.6 * D))  # overlap 0.1 D: they touch at 1.05 D
    found = contact_stress(run, layer=0.01)
    assert found.deviation < 1e-6
    within = (found.z > 1.1 * D) & (found.z < 1.45 * D)
    np.testing.assert_allclose(found.zz.value[within], M * 9.0 / AREA, rtol=1e-3)
    assert np.abs(found.zz.value[(found.z < 1.0 * D) | (found.z > 1.55 * D)]).max() < 1e-3 * M * 9.0 / AREA


def test_the_sum_over_all_heights_is_the_stress_of_love_and_weber(resting):
    force, branch = np.array([1.0, -2.0, 3.0]) * 1e-3, np.array([-0.9, 0.2, -0.3]) * D
    x = np.array([[0.2 * D, D, 3 * D], [0.2 * D - branch[0], D - branch[1], 3 * D - branch[2]]])
    found = contact_stress(resting(x, [(0, 1, force)]), layer=0.3)
    for name, a, b in (("xx", 0, 0), ("yy", 1, 1), ("zz", 2, 2), ("xz", 0, 2), ("zx", 2, 0)):
        whole = getattr(found, name).value.sum() * found.length
        assert whole == pytest.approx(force[a] * branch[b] / AREA, rel=1e-6)
    level = x.copy()
    level[1, 2] = level[0, 2]  # a branch that is level, and one that is almost so
    for rise in (0.0, 1.0e-8 * D, 1.0e-5 * D):
        level[0, 2] = 3 * D + rise
        found = contact_stress(resting(level, [(0, 1, force)]), layer=0.3)
        assert found.xx.value.sum() * found.length == pytest.approx(force[0] * branch[0] / AREA, rel=1e-4)


def test_contacts_across_a_period_have_the_short_branch(resting):
    x = np.array([[0.4 * D, D, 3 * D], [SIDE - 0.5 * D, D, 3 * D]])
    found = contact_stress(resting(x, [(0, 1, (2e-3, 0.0, 0.0))]))
    assert found.xx.value.sum() * found.length == pytest.approx(2e-3 * 0.9 * D / AREA, rel=1e-4)


def test_motion_about_the_mean_is_the_kinetic_stress_and_drift_is_none(resting):
    rng = np.random.default_rng(1)
    n, n_frame = 300, 400
    x = rng.uniform(0, 1, (n, 3)) * [SIDE, SIDE, 10 * D] + [0, 0, 5 * D]
    root = np.linalg.cholesky([[0.04, 0.0, -0.01], [0.0, 0.02, 0.0], [-0.01, 0.0, 0.03]])
    v = rng.normal(size=(n_frame, n, 3)) @ root.T + [0.3, 0.0, 0.0]
    found = contact_stress(resting(x, [], v=v, n_frame=n_frame), layer=1.0)
    inside = (found.phi.value > 0.5 * found.phi.value.max()).nonzero()[0]
    density = M / (math.pi / 6 * D**3)
    for name, expected in (("xx", 0.04), ("yy", 0.02), ("zz", 0.03), ("xz", -0.01)):
        per_mass = getattr(found, name).value[inside] / (density * found.phi.value[inside])
        np.testing.assert_allclose(per_mass, expected, atol=0.0015)
    np.testing.assert_allclose(found.mu.value[inside], 0.01 / 0.03, atol=0.03)
    still = contact_stress(resting(x, [], v=np.broadcast_to([0.3, 0.0, 0.1], v.shape), n_frame=3), layer=1.0)
    assert np.abs(still.xx.value).max() < 1e-12


def test_shear_rate_and_inertial_number_of_a_linear_profile(resting):
    n, rate = 4000, 20.0
    z = np.linspace(0.0, 20 * D, n)
    x = np.stack([0 * z, 0 * z, z], axis=1)
    v = np.zeros((5, n, 3))
    v[:, :, 0] = rate * z
    squeeze = [(k, k + 60, (0.0, 0.0, -1e-3)) for k in range(0, n - 60)]
    found = contact_stress(resting(x, squeeze, v=v), layer=0.5)
    inside = (found.z > 5 * D) & (found.z < 15 * D)
    np.testing.assert_allclose(found.shear_rate[inside], rate, rtol=1e-3)
    density = M / (math.pi / 6 * D**3)
    expected = rate * D * np.sqrt(density / found.p.value[inside])
    np.testing.assert_allclose(found.inertial_number[inside], expected, rtol=1e-3)
    force = 1e-3 * 60 / AREA  # so many branches cross every height
    np.testing.assert_allclose(found.contact_zz.value[inside], force, rtol=1e-3)


def test_a_plane_scene_has_the_pressure_of_two_directions(resting):
    found = contact_stress(resting(*pile(), plane=True))
    np.testing.assert_allclose(found.p.value, 0.5 * (found.xx.value + found.zz.value), atol=1e-12)
    both = contact_stress(resting(*pile()))
    whole = (both.xx.value + both.yy.value + both.zz.value) / 3
    np.testing.assert_allclose(both.p.value, whole, atol=1e-12)


def test_water_has_no_balance_and_weight_is_that_above(resting):
    found = contact_stress(resting(*pile(), water={"profile": "log"}))
    assert math.isnan(found.deviation)
    assert "water" in found.averages.notes[1]
    one = contact_stress(resting([[0.0, 0.0, 4 * D]], []), layer=0.2)
    np.testing.assert_allclose(
        one.weight, M * 9.0 / AREA * ndtr((4 * D - one.z) / one.length), rtol=1e-9, atol=1e-12
    )
    assert one.deviation == pytest.approx(1.0, abs=1e-3)  # it falls
    assert len(one.rows()) == len(one.z)


def test_a_scene_open_along_x_is_refused(resting):
    run = resting(*pile())
    run.scene = replace(run.scene, period=(math.inf, SIDE))
    with pytest.raises(ResultsError, match="open along x"):
        contact_stress(run)
