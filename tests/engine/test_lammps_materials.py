"""Several materials in LAMMPS: held against closed forms and against the CPU engine."""

from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, M, contact_law, elastic_law
from tests.engine.test_lammps import (
    ASKEW,
    CARRIED,
    NO_SPIN,
    SPINS,
    STILL,
    continued,
    needs_lammps,
    pair,
    sliding_block,
    stepped,
)

from ryusa.build import Material, MaterialPair, scene
from ryusa.engine import registry
from ryusa.engine.lammps.commands import laws
from ryusa.engine.lammps.grain_types import grain_types
from ryusa.engine.lammps.refusals import refusals_of_lammps
from ryusa.laws.collision import zeta_for_restitution, zeta_tension
from ryusa.laws.families import Arm, Drag, Profile, Rolling, Slip
from ryusa.laws.materials import poisson_of_two, young_of_two
from ryusa.model import Materials, RollingLaw, Water
from ryusa.model.contact_law import contact_time_of
from ryusa.model.scene import EventRule

G = 9.80665
SLIDER = RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, 0.1, zeta_r=0.0)
FLOOR = [("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]


def of_two(made, of, mixed, other=None, rolling=None):
    """The scene with two materials whose contact is `mixed`; `other` is that of the second with itself."""
    alike, rolls = made.contact, rolling or made.rolling
    materials = Materials(
        ("grains", "steel"), np.array(of, np.int8), (alike, mixed, mixed, other or alike),
        (made.rolling, rolls, rolls, made.rolling),
    )  # fmt: skip
    return replace(made, materials=materials)


def bouncing(law, e, **more):
    return replace(law, e_n=e, e_s=e, zeta_n=zeta_for_restitution(e, False), zeta_s=zeta_tension(e), **more)


@pytest.mark.full
@needs_lammps
@pytest.mark.parametrize("partner", ["free", "fixed", "plane"])
@pytest.mark.parametrize("of", [[0, 1], [1, 0]])
def test_a_head_on_collision_of_a_pair_is_that_of_the_cpu_to_round_off(partner, of):
    made, first = pair(partner, [[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]], NO_SPIN, restitution=0.7)
    for e in (0.3, 0.9):
        two = of_two(made, of, bouncing(made.contact, e))
        mine, theirs = stepped((two, first), 125)
        assert mine.v[0, 0] / -0.1 == pytest.approx(e, abs=1e-2)
        assert mine.v == pytest.approx(theirs.v, rel=0.0, abs=1e-14)


@pytest.mark.full
@needs_lammps
@pytest.mark.parametrize("partner", ["free", "fixed", "plane"])
def test_an_oblique_collision_takes_friction_and_rolling_of_the_pair(partner):
    rolls = replace(SLIDER, coefficient=0.02)
    found = []
    for friction in (0.05, 0.3):
        made, first = pair(partner, ASKEW, SPINS, stiffness=1e8, friction=1.0, rolling=SLIDER)
        two = of_two(made, [0, 1], replace(made.contact, mu=friction), rolling=rolls)
        mine, theirs = stepped((two, first), 125)
        assert np.abs(theirs.omega - first.omega).max() > 0.5
        assert np.abs(mine.v - theirs.v).max() < 1e-4 * 0.1
        assert np.abs(mine.omega - theirs.omega).max() < 1e-4 * 50.0
        found.append(mine.omega)
    assert np.abs(found[0] - found[1]).max() > 0.5


@pytest.mark.full
@needs_lammps
@pytest.mark.parametrize("partner", ["free", "fixed", "plane"])
@pytest.mark.parametrize("e", [1.0, 0.7])
def test_elastic_spheres_of_two_materials_touch_as_on_the_cpu(partner, e):
    (e_a, nu_a), (e_b, nu_b) = (1.0e8, 0.3), (4.0e8, 0.1)
    own = {"slip": Slip.TOTAL, "friction": 0.3, "restitution": e}
    mixed = elastic_law(
        0.2, youngs_modulus=young_of_two(e_a, nu_a, e_b, nu_b),
        poisson_ratio=poisson_of_two(e_a, nu_a, e_b, nu_b), **own,
    )  # fmt: skip
    one = elastic_law(0.2, youngs_modulus=e_a, poisson_ratio=nu_a, **own)
    dt = contact_time_of(mixed, 0.5 * M, 0.25 * D, 0.2) / 50.0
    x, v = [[0.0, 0.0, 0.0], [1.0001 * D, 0.0, 0.0]], ASKEW
    other = {"x_fixed": x[1:], "d_fixed": D} if partner == "fixed" else {}
    if partner == "plane":
        other = {"planes": [("wall", (0.5001 * D, 0.0, 0.0), (-1.0, 0.0, 0.0))]}
    n = 2 if partner == "free" else 1
    made, first = scene(
        x[:n], D, v=v[:n], contact=one, dt=dt, gravity=0.0, rotation=False, events=EventRule.NONE, **other
    )
    n_steps = int(1.0e-4 * D / 0.1 / dt) + 150
    mine, theirs = stepped((of_two(made, [0, 1], mixed, one), first), n_steps)
    assert theirs.v[0, 0] < 0.0 and abs(theirs.v[0, 2] + 0.08) > 0.003
    # with dashpots but for the constant correction (test_lammps_elastic)
    assert np.abs(mine.v - theirs.v).max() / 0.1 < (1e-12 if e == 1.0 else 1e-4)


@needs_lammps
def test_a_block_slides_to_rest_by_the_friction_of_its_wall():
    v, mu, n = 0.3, 0.2, 4000
    law = contact_law(k_n=1e4, slip=Slip.TOTAL, mu=0.6)
    made, first = scene(
        [[0.0, 0.0, 0.5 * D - M * G / 1e4]], D, v=[[v, 0.0, 0.0]], planes=FLOOR, contact=law, rotation=False,
        events=EventRule.NONE, dt=5.0e-6, allow_overlap=True,
    )  # fmt: skip
    engine = registry.create("lammps")
    engine.load(of_two(made, [0, 1], replace(law, mu=mu)), first)
    engine.advance(n).raise_if_any()
    assert (v - engine.grains().v[0, 0]) / (n * made.dt) == pytest.approx(mu * G, rel=5e-3)


def crowd(elastic=False, **more):
    """Grains, bed and floor of three materials that slide over each other without dashpots and turning."""
    x, v, bed = sliding_block()
    given = {"friction": 0.5, "restitution": 1.0, "stiffness": 2e3, "steps_per_contact": 20.0, **CARRIED}
    young = {}
    if elastic:
        law = elastic_law(0.5, youngs_modulus=1e7, slip=Slip.TOTAL, friction=0.5, restitution=1.0)
        dt = contact_time_of(law, 0.5 * M, 0.25 * D, 0.5) / 40.0
        given, young = {"contact": law, "dt": dt, "events": EventRule.NONE}, {"youngs_modulus": 2e7}
    return scene(
        x, D, v=v, x_fixed=bed, d_fixed=D,
        period=(5.1 * D, 5.1 * D), rotation=False, slope=0.4,
        planes=[("floor", (0.0, 0.0, 0.3 * D), (0.0, 0.0, 1.0))],
        materials=[
            Material("heavy", density=4000.0, friction=0.3, **young), Material("rock", friction=0.8),
            Material("steel", friction=0.2, **young),
        ],
        pairs=[
            MaterialPair(pair, friction=mu) for pair, mu in {
                ("grains", "heavy"): 0.4, ("grains", "rock"): 0.7, ("heavy", "rock"): 0.6,
                ("grains", "steel"): 0.1, ("heavy", "steel"): 0.05,
            }.items()
        ],
        made_of={
            "grains": ["grains", "heavy", "heavy"] * 25, "bed": ["rock"] * 12 + ["grains"] * 13,
            "floor": "steel",
        },
        allow_overlap=True, **given, **more,
    )  # fmt: skip


@pytest.mark.full
@needs_lammps
@pytest.mark.parametrize("elastic", [False, True])
def test_a_crowd_of_several_materials_and_densities_keeps_the_paths_of_the_cpu(elastic):
    made = crowd(elastic)
    mine, theirs = stepped(made, 400)
    assert np.abs(theirs.image[:, 0]).max() >= 1
    assert np.abs(theirs.v[:, 0] - made[1].v[:, 0]).max() > 0.3
    assert mine.v == pytest.approx(theirs.v, rel=0.0, abs=3e-8)  # 1e-16 has grown by collisions
    materials = made[0].materials
    alone = replace(
        made[0], materials=replace(materials, contact=(made[0].contact,) * len(materials.contact))
    )
    assert np.abs(stepped((alone, made[1]), 400)[1].v - theirs.v).max() > 1e-2  # and the pairs matter


@pytest.mark.full
@needs_lammps
def test_the_energy_of_springs_is_that_of_the_pairs():
    made = crowd(elastic=True)
    engines = registry.create("lammps"), registry.create("cpu")
    for engine in engines:
        engine.load(*made)
        engine.advance(60).raise_if_any()
    mine, theirs = engines[0].tally(), engines[1].tally()
    # LAMMPS has that of the present places, the CPU engine that of the last force: a step before
    engines[0].load(made[0], made[1])
    engines[0].advance(59).raise_if_any()
    before = engines[0].tally()
    assert before.spring_n == pytest.approx(theirs.spring_n, rel=1e-9)
    assert mine.spring_n > 0.0 and mine.spring_n != before.spring_n


@pytest.mark.full
@needs_lammps
@pytest.mark.parametrize("water", [None, STILL], ids=["dry", "added mass"])
def test_grains_of_two_densities_collide_as_on_the_cpu(water):
    made = scene(
        [[0.0, 0.0, 0.0], [1.0001 * D, 0.0, 0.0]], D, v=[[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]], gravity=0.0,
        water=water, materials=[Material("heavy", density=7800.0)],
        made_of={"grains": ["grains", "heavy"]}, **CARRIED,
    )  # fmt: skip
    assert made[0].m[1] > 2.0 * made[0].m[0]
    mine, theirs = stepped(made, 200)
    assert (mine.v[1, 0] - mine.v[0, 0]) / 0.2 == pytest.approx(0.7, abs=1e-2)
    assert mine.v == pytest.approx(theirs.v, rel=0.0, abs=1e-14)


@pytest.mark.full
@needs_lammps
def test_grains_of_two_densities_fall_through_water_as_on_the_cpu():
    made = scene(
        [[0.0, 0.0, 1.0], [3.0 * D, 0.0, 1.0]], D, water=Water(profile=Profile.STILL, drag=Drag.RE_04),
        materials=[Material("heavy", density=7800.0)], made_of={"grains": ["grains", "heavy"]}, **CARRIED,
    )  # fmt: skip
    made = replace(made[0], world_low=(-np.inf,) * 3), made[1]
    mine, theirs = stepped(made, 2_000)
    assert theirs.v[1, 2] < 1.1 * theirs.v[0, 2] < 0.0
    assert mine.v == pytest.approx(theirs.v, abs=1e-13)


@needs_lammps
def test_a_snapshot_goes_on_with_its_materials():
    whole, second = continued(crowd(elastic=True))
    assert second.grains().v == pytest.approx(whole.grains().v, rel=0.0, abs=1e-10)


def test_types_are_of_one_material_and_of_similar_mass():
    made = crowd()[0]
    types = grain_types(made)
    assert types.material.tolist() == [0, 1] and types.fixed.tolist() == [0, 2]
    assert (made.materials.of[: made.n_grain] == types.material[types.of]).all()
    beyond = made.materials.of[made.n_grain : made.n_grain + made.n_fixed]
    assert (beyond == types.fixed[types.of_fixed]).all()
    assert types.m == pytest.approx([M, M * 4000.0 / 2650.0])
    texts = laws(made, types)
    words = {tuple(one.split()[1:3]): one for one in texts if one.startswith("pair_coeff")}
    assert len(words) == 4 * 5 // 2
    mu = {pair: float(one.split(" linear_history ")[1].split()[2]) for pair, one in words.items()}
    assert mu["1", "2"] == pytest.approx(0.4) and mu["2", "4"] == pytest.approx(0.6)
    assert [float(one.split(" linear_history ")[1].split()[2]) for one in texts if "wall/gran" in one] == [
        pytest.approx(0.1), pytest.approx(0.05),
    ]  # fmt: skip


def many(n):
    """A row of grains of n materials and three sizes over a floor."""
    d = np.repeat([0.7 * D, 0.85 * D, D], n)
    x = 1.5 * D * np.arange(3 * n)[:, None] * [1.0, 0.0, 0.0]
    names = ["grains", *(f"m{k}" for k in range(1, n))]
    return scene(
        x, d, planes=[("floor", (0.0, 0.0, -0.55 * D), (0.0, 0.0, 1.0))], made_of={"grains": names * 3},
        materials=[Material(name) for name in names[1:]], v=0.0 * x - [0.0, 0.0, 0.1], stiffness=100.0,
        **CARRIED,
    )  # fmt: skip


@pytest.mark.full
@needs_lammps
@pytest.mark.parametrize("n, types", [(3, 27), (14, 28), (28, 28)])
def test_as_many_types_as_lammps_has_groups_for_are_carried(n, types):
    made = many(n)
    assert grain_types(made[0]).n == types and refusals_of_lammps(made[0]) == ()
    mine, theirs = stepped(made, 1_000)
    assert theirs.v[:, 2].max() > 0.03
    # in one class of masses that differ 2.9 times the correction of the lag, 4e-3 of the dashpot, is off by
    # 0.7 of itself at most
    assert np.abs(mine.v - theirs.v).max() < 2e-3 * 0.1


def test_more_materials_of_free_grains_than_types_are_refused():
    (reason,) = refusals_of_lammps(many(29)[0])
    assert reason == "free grains of 29 materials: 28 would be carried"


def test_what_a_pair_does_not_carry_is_refused_by_its_names_where_the_two_can_meet():
    made = crowd()[0]
    assert refusals_of_lammps(made) == ()
    laws_of = list(made.materials.contact)
    hard = bouncing(made.contact, 0.1)
    names, n = made.materials.names, made.materials.n
    never, meets = names.index("rock") * n + names.index("steel"), names.index("heavy")
    laws_of[never] = hard
    alone = replace(made, materials=replace(made.materials, contact=tuple(laws_of)))
    assert refusals_of_lammps(alone) == ()
    laws_of[meets] = laws_of[meets * n] = hard
    (reason,) = refusals_of_lammps(replace(made, materials=replace(made.materials, contact=tuple(laws_of))))
    assert reason == "contact.restitution 0.1 of 'grains' and 'heavy': from 0.14 on it would be carried"
