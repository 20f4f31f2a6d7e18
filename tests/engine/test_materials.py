"""Contacts of several materials against closed forms, and against one material (design/0020).

All scenes here have rolling friction and records, also where nothing rolls: each combination of such choices
is a kernel that has to be compiled.
"""

import math
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from tests.engine.conftest import D, M, bits, elastic_law, pile, run
from tests.kernel_variants import full_but

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.cuda.engine import CudaEngine
from ryusa.engine.shared.contact_history import energies_of_springs
from ryusa.engine.shared.contact_instants import FREED
from ryusa.laws.collision import collision_time, zeta_for_restitution, zeta_tension
from ryusa.laws.families import Arm, ContactTiming, Rolling, Slip
from ryusa.laws.materials import poisson_of_two, young_of_two
from ryusa.model import Materials, RollingLaw, Scene
from ryusa.model.contact_law import hertz_stiffness_of
from ryusa.results.scene_file import read_scene, scene_digest, write_scene

SPEED, G = 0.5, 9.80665
TIMINGS = list(ContactTiming)
SLIDER = RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, coefficient=0.1)


def of_two(made: Scene, of, mixed, rolling=None, other=None) -> Scene:
    """The scene with two materials whose contact is `mixed`; `other` is that of the second with itself."""
    alike = made.contact
    materials = Materials(
        ("grains", "steel"), np.array(of, np.int8), (alike, mixed, mixed, other or alike),
        (made.rolling, rolling or made.rolling, rolling or made.rolling, made.rolling),
    )  # fmt: skip
    return replace(made, materials=materials)


def bouncing(law, e, **more):
    zeta_n, zeta_s = zeta_for_restitution(e, law.tension), zeta_tension(e)
    return replace(law, e_n=e, e_s=e, zeta_n=zeta_n, zeta_s=zeta_s, **more)


def head_on(partner, plane_case=False, **keys):
    """A grain about to meet a fixed grain, a plane or another grain head-on, without gravity."""
    first, v = [[0.0, 0.0, 1.02 * D]], [[0.0, 0.0, -SPEED]]
    other = {"x_fixed": [[0.0, 0.0, 0.0]], "d_fixed": D}
    if partner == "free":
        first, other = [*first, [0.0, 0.0, 0.0]], {}
        v = [[0.0, 0.0, -0.5 * SPEED], [0.0, 0.0, 0.5 * SPEED]]
    elif partner == "plane":
        other = {"planes": [("floor", (0, 0, 0.5 * D), (0, 0, 1))]}
    return scene(first, D, v=v, gravity=0.0, plane_case=plane_case, rolling=SLIDER, **other, **keys)


@pytest.mark.full
@pytest.mark.parametrize("plane_case", [True, False])
@pytest.mark.parametrize("partner", ["fixed", "plane", "free"])
@pytest.mark.parametrize("timing", TIMINGS)
def test_a_rebound_has_the_restitution_of_the_pair(timing, partner, plane_case):
    made, state = head_on(partner, plane_case, timing=timing, steps_per_contact=200.0)
    for e in (0.3, 0.9):
        two = of_two(made, [0, 1], bouncing(made.contact, e))
        (event,) = run((two, state), 2000).events()
        measured = -event["closing_end"] / event["closing_begin"]
        assert measured == pytest.approx(e, rel=1e-9 if timing is ContactTiming.EXACT else 4e-3)
        (alone,) = run((replace(two, materials=None), state), 2000).events()
        assert -alone["closing_end"] / alone["closing_begin"] == pytest.approx(0.7, abs=3e-3)


@pytest.mark.full
@pytest.mark.parametrize("partner", ["fixed", "free", "plane"])
def test_two_elastic_spheres_touch_for_the_time_of_their_effective_modulus(partner):
    (e_a, nu_a), (e_b, nu_b) = (1.0e8, 0.3), (4.0e8, 0.1)
    m, r = {"fixed": (M, 0.25 * D), "free": (0.5 * M, 0.25 * D), "plane": (M, 0.5 * D)}[partner]
    mixed = elastic_law(
        SPEED, restitution=1.0, youngs_modulus=young_of_two(e_a, nu_a, e_b, nu_b),
        poisson_ratio=poisson_of_two(e_a, nu_a, e_b, nu_b),
    )  # fmt: skip
    one = elastic_law(SPEED, restitution=1.0, youngs_modulus=e_a, poisson_ratio=nu_a)
    modulus = 1.0 / ((1.0 - nu_a**2) / e_a + (1.0 - nu_b**2) / e_b)
    t_col = 2.8683 * (m * m / (r * modulus**2 * SPEED)) ** 0.2
    made, state = head_on(partner, contact=one, dt=t_col / 800.0)
    (event,) = run((of_two(made, [0, 1], mixed), state), 3000).events()
    assert event["t_end"] - event["t_begin"] == pytest.approx(t_col, rel=2e-3)
    # and the shear stiffness at the largest overlap, as Mindlin has it for two materials
    shear = [2.0 * (2.0 - nu) * (1.0 + nu) / e for e, nu in ((e_a, nu_a), (e_b, nu_b))]
    stiff, overlap = hertz_stiffness_of(mixed, r), event["overlap_max"]
    from ryusa.laws.hertz import mindlin_ratio

    k_s = mindlin_ratio(mixed.poisson_ratio) * stiff * math.sqrt(overlap)
    assert k_s == pytest.approx(8.0 / sum(shear) * math.sqrt(r * overlap), rel=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("e", [0.4, 0.8])
def test_elastic_spheres_of_two_materials_have_the_restitution_of_the_pair(e):
    one = elastic_law(SPEED, restitution=0.6)
    made, state = head_on("plane", contact=one, dt=1.0e-7)
    two = of_two(made, [0, 1], elastic_law(SPEED, restitution=e, youngs_modulus=2.0e8))
    (event,) = run((two, state), 4000).events()
    assert -event["closing_end"] / event["closing_begin"] == pytest.approx(e, rel=3e-3)


@pytest.mark.parametrize("partner", ["fixed", "free", "plane"])
def test_stiffness_of_a_pair_gives_its_contact_time(partner):
    made, state = head_on(partner, restitution=1.0, dt=2.0e-6)
    two = of_two(made, [0, 1], replace(made.contact, k_n=3.0e4, k_s=1.0e4))
    (event,) = run((two, state), 500).events()
    m = 0.5 * M if partner == "free" else M
    assert event["t_end"] - event["t_begin"] == pytest.approx(collision_time(m, 3.0e4), rel=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("force", ["linear", "linear at steps", "Hertz"])
def test_a_block_slides_to_rest_by_the_friction_of_the_pair(force):
    v, mu, n = 0.3, 0.2, 4000
    law = elastic_law(0.3, restitution=0.5, slip=Slip.TOTAL) if force == "Hertz" else None
    timing = ContactTiming.AT_STEPS if force == "linear at steps" else ContactTiming.EXACT
    planes = [("floor", (0, 0, 0), (0, 0, 1))]
    k = 1.0e4
    below = M * G / k
    if law is not None:
        below = (M * G / hertz_stiffness_of(law, 0.5 * D)) ** (2.0 / 3.0)
    made, state = scene(
        [[0.0, 0.0, 0.5 * D - below]], D, v=[[v, 0.0, 0.0]], planes=planes, rolling=SLIDER, contact=law,
        stiffness=k, timing=timing, slip=Slip.TOTAL, dt=5.0e-6, allow_overlap=True,
    )  # fmt: skip
    made = replace(made, inertia=1e9 * made.inertia)  # it does not turn
    two = of_two(made, [0, 1], replace(made.contact, mu=mu))
    engine = run((two, state), n)
    lost = (v - engine.state().v[0, 0]) / (n * made.dt)
    assert lost == pytest.approx(mu * G, rel=5e-3)
    alone = replace(made, contact=replace(made.contact, mu=mu))
    assert engine.tally().residual == pytest.approx(
        run((alone, state), n).tally().residual, rel=1e-9, abs=1e-12
    )


def test_rolling_friction_is_that_of_the_pair():
    """A ball that rolls on a plane is slowed by mu_r g/(1 + 2/5) where the torque is constant."""
    v, mu_r, n = 0.3, 0.05, 4000
    constant = RollingLaw(Rolling.CONSTANT, Arm.REDUCED_RADIUS, coefficient=0.01)
    planes = [("floor", (0, 0, 0), (0, 0, 1))]
    made, state = scene(
        [[0.0, 0.0, 0.5 * D - M * G / 1.0e4]], D, v=[[v, 0.0, 0.0]], omega=[[0.0, 2.0 * v / D, 0.0]],
        planes=planes, rolling=constant, dt=5.0e-6, allow_overlap=True,
    )  # fmt: skip
    two = of_two(made, [0, 1], made.contact, replace(constant, coefficient=mu_r))
    engine = run((two, state), n)
    lost = (v - engine.state().v[0, 0]) / (n * made.dt)
    assert lost == pytest.approx(mu_r * G / 1.4, rel=1e-2)


def mixed_pile(n=400, timing=ContactTiming.EXACT, hertz=False, plane_case=False):
    """A pile of two materials whose three contacts differ in all that may differ."""
    law = elastic_law(0.6, restitution=0.6) if hertz else None
    more = {"contact": law, "dt": 2.0e-6} if hertz else {"timing": timing}
    made, state = pile(n, plane_case, rolling=SLIDER, **more)
    of = np.arange(made.n_partner) % 2
    k = made.contact.k_n
    stiff = {"k_n": 0.7 * k, "k_s": 0.3 * k} if timing is ContactTiming.EXACT else {}
    stiff = {"youngs_modulus": 0.6e8, "poisson_ratio": 0.4} if hertz else stiff
    mixed = bouncing(made.contact, 0.5, mu=0.2, **stiff)
    other = bouncing(made.contact, 0.85, mu=0.7)
    return of_two(made, of, mixed, replace(SLIDER, coefficient=0.02), other), state


KINDS = {
    "exact": {},
    "at steps": {"timing": ContactTiming.AT_STEPS},
    "Hertz": {"hertz": True},
    "exact in a plane": {"plane_case": True},
}


@pytest.mark.parametrize("kind", full_but(["exact"], KINDS))
def test_the_account_closes_with_several_materials(kind):
    made = mixed_pile(**KINDS[kind])
    engine = run(made, 6000)
    tally = engine.tally()
    assert tally.n_contact > 8
    one = replace(made[0], materials=None)
    equal = of_two(one, made[0].materials.of, one.contact)
    usual = run((equal, made[1]), 6000).tally().residual  # of one material, which falls with the step
    assert tally.residual < max(2e-4, 1.5 * usual)
    held = engine.state()
    while (held.contacts.state >= FREED).any():
        engine.advance(1).raise_if_any()
        held, tally = engine.state(), engine.tally()
    found = energies_of_springs(made[0], held, np.arange(len(held.contacts)))
    assert found.normal == pytest.approx(tally.spring_n, rel=1e-9)
    assert found.tangential == pytest.approx(tally.spring_s, rel=1e-9)


@pytest.mark.parametrize("kind", full_but(["exact"], KINDS))
def test_threads_and_a_snapshot_leave_the_bits(kind):
    made = mixed_pile(**KINDS[kind])
    whole = run(made, 600).state()
    assert bits(run(made, 600, threads=2).state()) == bits(whole)
    engine = run(made, 350)
    other = CpuEngine()
    other.load(made[0], engine.state())
    other.advance(250).raise_if_any()
    assert bits(other.state()) == bits(whole)


@pytest.mark.full
@pytest.mark.parametrize("kind", KINDS)
def test_equal_materials_are_one_material(kind):
    made, state = mixed_pile(**KINDS[kind])
    one = replace(made, materials=None)
    equal = of_two(one, made.materials.of, one.contact)
    assert bits(run((equal, state), 400).state()) == bits(run((one, state), 400).state())


def test_materials_survive_a_file(tmp_path: Path):
    made, _ = mixed_pile(40)
    with h5py.File(tmp_path / "scene.h5", "w") as file:
        write_scene(file, made, 7, 0.5)
    step, t, read = read_scene(tmp_path / "scene.h5")
    assert (step, t) == (7, 0.5)
    assert scene_digest(read) == scene_digest(made)
    assert read.materials is not None
    assert read.materials.names == made.materials.names
    assert scene_digest(replace(made, materials=None)) != scene_digest(made)


def test_what_cannot_be_carried_is_refused_by_name():
    made, _ = mixed_pile(40)
    assert any("several materials" in reason for reason in CudaEngine().refuses(made))
    at_steps, _ = mixed_pile(40, timing=ContactTiming.AT_STEPS)
    soft = replace(at_steps.contact, k_n=1.0)
    (reason,) = CpuEngine().refuses(of_two(at_steps, at_steps.materials.of, soft))
    assert "contact.timing = 'exact'" in reason
    short = replace(made.materials, of=made.materials.of[1:])
    (reason,) = CpuEngine().refuses(replace(made, materials=short))
    assert "each of" in reason
