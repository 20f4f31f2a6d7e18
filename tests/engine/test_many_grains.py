"""Many grains: the same bits however they are stepped, memory that survives, accounts that close."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numba import typeof
from tests.engine.conftest import D, bits, contact_law, pile, run
from tests.engine.reference import accelerations, touching_pairs
from tests.kernel_variants import full_but

from ryusa.build import scene
from ryusa.engine.cpu import engine as cpu_engine
from ryusa.engine.cpu.block_exchange import number_crossing_pairs
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.shared.contact_instants import BEGAN
from ryusa.laws.families import Arm, ContactTiming, Drag, Profile, Rolling, Slip, WaterTorque
from ryusa.model import RollingLaw, Term, Water
from ryusa.model.scene import EventRule

WET = Water(
    profile=Profile.LOG_ROUGH, u_star=0.1, k_rough=D, depth=0.05, drag=Drag.RE_04, torque=WaterTorque.DENNIS
)
EPSD = RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, 0.1)
KINDS = {
    "3D": {"events": EventRule.NONE},
    "plane": {"plane_case": True, "events": EventRule.NONE},
    "plane, exact": {"timing": ContactTiming.EXACT, "plane_case": True, "events": EventRule.NONE},
    "plane, records": {"plane_case": True},
    "3D, wet, rolling friction, records": {"water": WET, "rolling": EPSD},
    "3D, exact, records": {"timing": ContactTiming.EXACT},
    "plane, exact, may pull, rolling friction": {
        "timing": ContactTiming.EXACT, "plane_case": True, "rolling": EPSD, "tension": True,
    },
}  # fmt: skip
SHOWN = ("3D, exact, records", "plane, exact, may pull, rolling friction")  # by `make test`


def test_a_scene_that_names_whose_contacts_it_records_needs_no_other_kernel():
    fixed, first = pile(n=60, timing=ContactTiming.EXACT)
    types = []
    for tracked in (np.zeros(0, bool), np.arange(fixed.n_grain) < 3):
        tracked.setflags(write=False)
        engine = CpuEngine()
        engine.load(replace(fixed, events=EventRule.TRACKED, tracked=tracked), first)
        types.append([typeof(array) for array in engine._grains])
    assert types[0] == types[1]


@pytest.mark.parametrize("kind", full_but(SHOWN, KINDS))
def test_any_number_of_threads_gives_the_same_bits(kind):
    made = pile(n=600, **KINDS[kind])
    outcome = []
    for threads in (1, 2, 3, 4):
        engine = run(made, 2500, threads)
        assert engine._n_list > 4  # the list was rebuilt several times on the way
        outcome.append((bits(engine.state()), engine.events().tobytes(), engine.tally()))
    assert all(o == outcome[0] for o in outcome)


@pytest.mark.parametrize("kind", full_but(SHOWN, KINDS))
def test_split_calls_and_a_resumed_snapshot_give_the_same_bits(kind):
    made = pile(n=400, **KINDS[kind])
    whole = run(made, 1200)
    split = CpuEngine()
    split.load(*made)
    for n in (1, 2, 97, 300, 150, 1, 49, 600):
        split.advance(n).raise_if_any()
    first = run(made, 777)
    early = first.events()
    resumed = CpuEngine(threads=2)
    resumed.load(made[0], first.state())
    resumed.advance(1200 - 777).raise_if_any()
    assert bits(split.state()) == bits(whole.state())
    assert bits(resumed.state()) == bits(whole.state())
    assert resumed.tally() == whole.tally() == split.tally()
    records = whole.events()
    assert split.events().tobytes() == records.tobytes()
    assert np.sort(np.concatenate([early, resumed.events()])).tobytes() == np.sort(records).tobytes()


def test_contacts_of_grains_that_were_moved_apart_are_found_within_reach_of_the_list():
    kept = KINDS[SHOWN[0]]
    made = pile(n=300, stir=0.05, **kept)
    state = run(made, 6000).state()
    assert len(state.contacts) > 50
    for apart, found in ((0.04, True), (3.0, False)):  # in diameters; the list reaches 0.1 beyond touch
        x = np.array(state.x)
        x[state.contacts.i[7], 2] += apart * D
        moved = replace(state, x=x, engine=None)
        engine = CpuEngine(threads=2)
        if found:
            engine.load(made[0], moved)
            after = engine.state().contacts
            for name in ("i", "j", "spring_s", "f_n", "event"):
                rows = [getattr(one, name)[np.lexsort((one.j, one.i))] for one in (state.contacts, after)]
                assert np.array_equal(*rows, equal_nan=True)
        else:
            with pytest.raises(AssertionError, match="is in touch and not in the list"):
                engine.load(made[0], moved)


@pytest.mark.full
def test_blocks_that_move_early_give_the_bits_of_blocks_that_wait(monkeypatch):
    monkeypatch.setattr(cpu_engine, "blocks_of", lambda n, plane_case: 8)
    made = pile(n=600, plane_case=True)
    outcome = []
    for threads in (1, 2, 8):  # of 8 threads each has one block, which waits for its neighbours
        engine = run(made, 600, threads)
        assert engine._pairs.span == 1
        outcome.append((bits(engine.state()), engine.tally()))
    assert all(o == outcome[0] for o in outcome)


def test_blocks_that_share_pairs_are_found_on_either_side():
    block_start, start = np.arange(0, 13, 2), np.arange(13)
    for pairs, span in (((0, 1), 0), ((0, 2), 1), ((0, 11), 1), ((0, 5), 2), ((3, 9), 3), ((2, 10), 2)):
        partners = np.arange(12, dtype=np.uint32)
        partners[pairs[0]] = pairs[1]
        found = number_crossing_pairs(12, block_start, start, partners, lambda task: [task(0, 6)])
        assert found[-1] == span
        assert len(found[1]) == (span > 0)


@pytest.mark.full
def test_an_account_without_block_accounts_is_continued_from_its_sum():
    made = pile(n=400)
    state = run(made, 700).state()
    assert len(state.engine.arrays["work"]) > 1
    engine, same = CpuEngine(), CpuEngine()
    engine.load(made[0], replace(state, engine=None))
    same.load(made[0], state)
    assert engine.tally().terms == pytest.approx(same.tally().terms, rel=1e-12)
    assert engine.tally().residual == pytest.approx(same.tally().residual, abs=1e-12)


@pytest.mark.full
@pytest.mark.parametrize("plane_case", [False, True])
@pytest.mark.parametrize("slip", list(Slip))
def test_forces_at_one_frozen_state_agree_with_a_plain_reference(plane_case, slip):
    dry, first = pile(n=300, plane_case=plane_case, slip=slip, stir=0.05, stiffness=2e3)
    engine = run((dry, first), 12_000)
    # the water comes when grains lie close: it would carry them apart
    fixed = replace(dry, water=WET, m_added=0.2 * dry.m, m_weight=0.6 * dry.m)
    engine.load(fixed, engine.state())
    engine.advance(20).raise_if_any()
    before = engine.state()
    engine.advance(1).raise_if_any()
    after = engine.state()
    a = (after.v - before.v) / fixed.dt
    spin_up = (after.omega - before.omega) / fixed.dt
    expected, expected_spin = accelerations(fixed, before)
    assert len(before.contacts) > 50
    # one step's change of velocity is rounded at the size of v: 1e-16 v/dt beside the largest acceleration
    assert a == pytest.approx(expected, rel=0.0, abs=1e-11 * np.abs(expected).max())
    assert spin_up == pytest.approx(expected_spin, rel=0.0, abs=1e-11 * np.abs(expected_spin).max())


def gas(n=216, seed=2, e=1.0):
    rng = np.random.default_rng(seed)
    side = round(n ** (1 / 3))
    pitch = 2.2 * D
    grid = np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) + 0.5
    v = rng.normal(0.0, 0.3, (n, 3))
    walls = [("floor", (0, 0, 0), (0, 0, 1)), ("lid", (0, 0, side * pitch), (0, 0, -1))]
    law = contact_law(k_n=1e4, mu=0.0, ratio=0.0, zeta_n=0.0)
    assert e == 1.0
    return scene(
        grid * pitch,
        D,
        v=v,
        planes=walls,
        contact=law,
        gravity=0.0,
        rotation=False,
        period=(side * pitch, side * pitch),
        events=EventRule.NONE,
    )


@pytest.mark.full
def test_an_elastic_gas_keeps_its_energy_over_1e5_steps():
    # each touch gives or takes its share of a step: a gas walks by some 6e-5, and several must not go one way
    last = []
    for seed in (2, 3, 4, 5):
        fixed, first = gas(seed=seed)
        engine = CpuEngine()
        engine.load(fixed, first)
        held = []
        for _ in range(20):
            engine.advance(5000).raise_if_any()
            account = engine.tally()
            held.append(account.held / account.terms[Term.START] - 1.0)
            assert account.residual < 1e-5
        assert engine.state().step == 100_000
        assert np.max(np.abs(held)) < 3e-4
        last.append(held[-1])
    assert abs(np.mean(last)) < 1e-4


@pytest.mark.full
def test_momentum_of_a_periodic_cloud_without_walls_is_kept_to_round_off():
    fixed, first = gas(125)
    fixed = replace(fixed, plane_active=np.zeros(2, np.bool_))
    engine = run((fixed, first), 5000)
    before = (fixed.m[:, None] * first.v).sum(axis=0)
    after = (fixed.m[:, None] * engine.state().v).sum(axis=0)
    assert engine.tally().terms[Term.DASH_N] == 0.0
    assert after == pytest.approx(
        before, rel=0.0, abs=1e-12 * float(np.abs(fixed.m[:, None] * first.v).sum())
    )


@pytest.mark.full
def test_of_three_mutual_contacts_only_the_one_that_ends_loses_its_history():
    # three touching grains; the third is pulled away: the memory of the two that stay goes on
    law = contact_law(mu=0.5, zeta_n=0.05, zeta_s=0.05)
    side = D * (1.0 - 2e-3)
    x = [[0.0, 0.0, 0.0], [side, 0.0, 0.0], [0.5 * side, 0.0, side * math.sqrt(0.75)]]
    v = [[0.0, 0.0, 0.01], [0.0, 0.0, -0.01], [0.0, 0.0, 0.0]]
    fixed, first = scene(x, D, v=v, contact=law, gravity=0.0, allow_overlap=True)
    engine = run((fixed, first), 5)
    state = engine.state()
    pairs = list(zip(state.contacts.i, state.contacts.j, strict=True))
    assert pairs == [(0, 1), (0, 2), (1, 2)]
    kept = state.contacts.spring_s[0].copy()
    assert np.linalg.norm(kept) > 0.0
    away = state.x.copy()
    away[2, 2] += 0.01 * D  # beyond touch of 0 and 1
    listed = replace(state, x=away)
    again = CpuEngine()
    again.load(fixed, listed)
    again.advance(1).raise_if_any()
    last = again.state().contacts
    assert list(zip(last.i, last.j, strict=True)) == [(0, 1)]
    slip = (state.v[0] - state.v[1])[2]
    assert abs(last.spring_s[0][2] - kept[2]) < 2.0 * law.k_s * abs(slip) * fixed.dt + 1e-3 * abs(kept[2])
    records = again.events()
    assert sorted((r["i"], r["j"]) for r in records) == [(0, 2), (1, 2)]
    # touched anew, the pair starts without a spring
    back = again.state()
    away = back.x.copy()
    away[2, 2] -= 0.01 * D
    third = CpuEngine()
    third.load(fixed, replace(back, x=away, engine=None))
    third.advance(1).raise_if_any()
    new = third.state().contacts
    fresh = np.linalg.norm(new.spring_s[1:], axis=1)
    assert np.all(fresh < 2.0 * law.k_s * 0.05 * fixed.dt)


@pytest.mark.full
@pytest.mark.parametrize("per_contact", [10.0, 20.0, 50.0])
def test_the_account_closes_at_coarse_steps_with_the_step_term(per_contact):
    made = pile(n=300, plane_case=True, stir=0.1, steps_per_contact=per_contact)
    account = run(made, int(0.1 / made[0].dt)).tally()
    lost = account.terms[Term.DASH_N]
    assert account.residual < 1e-3
    # each touch takes about (omega dt)**2/6 of its energy, each parting gives e**2 of that back
    assert abs(account.terms[Term.STEP]) < (math.pi / per_contact) ** 2 / 6.0 * lost / (1.0 - 0.49)


def test_the_residual_does_not_depend_on_where_the_origin_is():
    residuals = []
    for shift in (0.0, 1.0, 100.0):
        fixed, first = scene(
            [[shift, 0.0, 3.0 * D]],
            D,
            x_fixed=[[shift, 0.0, 0.0]],
            d_fixed=D,
            slope=0.1,
            steps_per_contact=20.0,
        )
        engine = run((fixed, first), 3000)
        tilted = replace(fixed, gravity=9.8 * np.array([math.sin(0.5), 0.0, -math.cos(0.5)]))
        engine.load(tilted, engine.state())
        engine.advance(3000).raise_if_any()
        account = engine.tally()
        assert abs(account.terms[Term.SWITCH]) > (0.0 if shift == 0.0 else shift * 1e-6)
        residuals.append(account.residual)
    assert residuals == pytest.approx([residuals[0]] * 3, rel=1e-2, abs=1e-9)
    assert residuals[0] < 1e-3


@pytest.mark.parametrize("kind", full_but(SHOWN, KINDS))
def test_the_energy_account_closes(kind):
    made = pile(
        n=300, **KINDS[kind], steps_per_contact=50.0
    )  # its residual falls with the square of the step
    engine = run(made, int(0.08 / made[0].dt))
    account = engine.tally()
    assert account.overlap_max > 0.0
    assert account.residual < 1e-4
    at_steps = (Term.RELEASED_N, Term.RELEASED_S)  # nothing is left in a spring that ends at its true instant
    exact = made[0].contact.timing == ContactTiming.EXACT
    for term in (Term.DASH_N, Term.DASH_S, Term.SLIDE, *at_steps):
        assert (account.terms[term] > 0.0) != (exact and term in at_steps)
    if "wet" in kind:
        assert account.terms[Term.ROLL] > 0.0
        assert account.terms[Term.TORQUE] < 0.0
        assert account.terms[Term.DRAG] != 0.0


@pytest.mark.full
def test_a_bed_at_rest_comes_to_rest():
    # a pile with friction and damping on a level bed: motion dies out and the account says where it went
    rolling = RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, 0.05)
    fixed, first = pile(n=96, seed=8, rolling=rolling, stir=0.05, stiffness=1e3)
    fixed = replace(fixed, gravity=np.array([0.0, 0.0, -9.8]))
    engine = run((fixed, first), int(1.0 / fixed.dt))
    weight = float(fixed.m.sum()) * 9.8 * D
    assert engine.tally().kinetic + engine.tally().spin < 1e-5 * weight
    assert engine.tally().residual < 1e-3


@pytest.mark.parametrize(
    ("timing", "steps", "left"),
    full_but([("exact", 10.0, 1e-4)], [("at steps", 50.0, 1e-3), ("exact", 10.0, 1e-4)]),
)
def test_removing_a_gate_ends_its_contacts_and_accounts_for_their_springs(timing, steps, left):
    law = contact_law(mu=0.5, zeta_n=0.2, zeta_s=0.2, timing=ContactTiming.of(timing))
    squeeze = 1e-3 * D
    walls = [
        ("floor", (0, 0, 0), (0, 0, 1)),
        ("gate", (0.5 * D - squeeze, 0, 0), (-1, 0, 0)),
        ("back", (-0.5 * D, 0, 0), (1, 0, 0)),
    ]
    fixed, first = scene(
        [[0.0, 0.0, 0.5 * D]], D, planes=walls, contact=law, gravity=9.8, allow_overlap=True,
        steps_per_contact=steps,
    )  # fmt: skip
    engine = run((fixed, first), int(80 * steps))
    assert engine.tally().n_contact == 3
    gate_at = engine.state().t
    engine.load(replace(fixed, plane_active=np.array([True, False, True])), engine.state())
    engine.advance(int(40 * steps)).raise_if_any()
    account = engine.tally()
    assert account.terms[Term.SWITCH] < 0.0
    assert engine.state().v[0, 0] > 0.0
    assert account.residual < left
    (record,) = [r for r in engine.events() if r["j"] == 2]
    assert record["t_end"] == record["t_part"] == gate_at
    assert record["impulse_n"] > 0.0
    assert math.isnan(record["closing_end"])


@pytest.mark.full
@pytest.mark.parametrize("model", [Rolling.PRINTED, Rolling.LIMITED, Rolling.CONSTANT, Rolling.EPSD])
def test_rotation_may_be_locked_and_freed_during_a_run_with_any_rolling_friction(model):
    fixed, first = pile(n=60, rolling=RollingLaw(model, Arm.REDUCED_RADIUS, 0.1), stir=0.1)
    engine = run((fixed, first), 8000)
    engine.load(replace(fixed, rotation=False), engine.state())
    engine.advance(2000).raise_if_any()
    assert engine.tally().spin == engine.tally().spring_r == 0.0
    engine.load(fixed, engine.state())
    engine.advance(2000).raise_if_any()
    assert engine.tally().spin > 0.0
    assert engine.tally().residual < 1e-3


@pytest.mark.full
def test_locking_rotation_during_a_run_removes_the_spin_from_the_account():
    fixed, first = scene([[0.0, 0.0, 0.0]], D, omega=[[0.0, 50.0, 0.0]], gravity=0.0)
    engine = run((fixed, first), 10)
    engine.load(replace(fixed, rotation=False), engine.state())
    engine.advance(10).raise_if_any()
    account = engine.tally()
    assert account.spin == 0.0
    assert account.terms[Term.SWITCH] == pytest.approx(-account.terms[Term.START], rel=1e-12)


def test_lanes_of_a_plane_scene_do_not_interact_whatever_the_range_of_the_list():
    def two(y):
        x = [[0.0, 0.0, 2.0 * D], [0.0, y, 2.0 * D], [0.0, 0.0, 3.5 * D]]
        bed = [[0.0, 0.0, 0.0], [0.0, y, 0.0]]
        v = [[0, 0, 0], [0.1, 0, 0], [0, 0, 0]]
        return scene(x, D, x_fixed=bed, d_fixed=D, plane_case=True, v=v, steps_per_contact=50.0)

    alone = scene(
        [[0.0, 0.0, 2.0 * D], [0.0, 0.0, 3.5 * D]],
        D,
        x_fixed=[[0.0, 0.0, 0.0]],
        d_fixed=D,
        plane_case=True,
        steps_per_contact=50.0,
    )
    expected = run(alone, 20_000).state().x[0, 2]
    for skin in (0.1, 1.0):
        engine = CpuEngine(skin=skin)
        engine.load(*two(1.0 * D))
        engine.advance(20_000).raise_if_any()
        assert engine.state().x[0, 2] == pytest.approx(expected, rel=1e-12)
        assert engine.state().x[1, 1] == 1.0 * D


def test_lanes_closer_than_a_diameter_are_refused():
    fixed, first = scene([[0.0, 0.0, 2.0 * D], [0.0, 1.5 * D, 2.0 * D]], D, plane_case=True)
    x = first.x.copy()
    x[1, 1] = 0.5 * D
    with pytest.raises(ValueError, match="less than a diameter"):
        CpuEngine().load(fixed, replace(first, x=x))


@pytest.mark.parametrize("per_contact", [400.0, 160.0])  # in the second grains fly far between two lists
@pytest.mark.parametrize("seed", range(8))
def test_the_list_finds_every_pair_that_a_search_of_all_pairs_finds(seed, per_contact):
    # sizes 1:6, fixed grains larger and smaller than free ones, periods or none, threads or none
    rng = np.random.default_rng(seed)
    n, plane_case, periodic = 120, bool(seed % 2), bool(seed % 4 < 2)
    side = 0.06 if plane_case else 0.03
    d = D * rng.uniform(0.5, 3.0, n)
    x = rng.uniform(0.0, side, (n, 3))
    bed = rng.uniform(0.0, side, (15, 3))
    if plane_case:
        x[:, 1] = bed[:, 1] = 0.0
    v = rng.normal(0.0, 0.5, (n, 3)) * ([1, 0, 1] if plane_case else [1, 1, 1])
    period = (side, math.inf if plane_case else side) if periodic else (math.inf, math.inf)
    fixed, first = scene(
        x,
        d,
        v=v,
        x_fixed=bed,
        d_fixed=D * rng.uniform(0.3, 4.0, 15),
        period=period,
        gravity=0.0,
        plane_case=plane_case,
        allow_overlap=True,
        stiffness=0.05,
        steps_per_contact=per_contact,
    )
    fixed = replace(fixed, overlap_limit=math.inf, world_low=(-math.inf,) * 3, world_high=(math.inf,) * 3)
    engine = CpuEngine(threads=1 + seed % 3)
    engine.load(fixed, first)
    for _ in range(12):
        before = engine.state()
        engine.advance(1).raise_if_any()
        after = engine.state().contacts
        expected, then = touching_pairs(fixed, before), after.state != BEGAN
        assert set(zip(after.i[then], after.j[then], strict=True)) == expected
        assert len(expected) > 5
        engine.advance(40).raise_if_any()
