"""What every engine has to do, asked of each of them by its name; those that differ are held against the CPU.

CUDA is among them where there is a card, and alone where numba's simulator stands for one:
tests/engine/test_cuda.py runs this file so.
"""

import math
import os
import sys
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, bits
from tests.engine.heaps import KINDS, alike, apart, heap, loaded
from tests.engine.reference import touching_pairs
from tests.kernel_variants import full_but

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.engine.cuda.availability import unavailable
from ryusa.errors import GrainLost, ListUnsafe, NotANumber, OverlapTooLarge
from ryusa.laws.families import ContactTiming
from ryusa.model import EngineBlock, Term
from ryusa.model.fluid import N_SAMPLED
from ryusa.model.scene import EventRule

ENGINES = {
    "cpu": ("cpu", {"skin": 0.03}),
    "cpu, 2 threads": ("cpu", {"skin": 0.03, "threads": 2}),
    "toy": ("toy", {}),
}
SHOWN = ("exact timing, records", "exact timing, plane, may pull", "exact timing, column")  # by `make test`
if os.environ.get("NUMBA_ENABLE_CUDASIM") == "1":
    ENGINES = {"cuda": ("cuda", {"skin": 0.03})}
    sys.setswitchinterval(2e-5)  # the simulator polls its threads: without this each wait costs 5 ms
elif not unavailable():
    ENGINES["cuda"] = ("cuda", {"skin": 0.03})


@pytest.fixture(autouse=True)
def toy():
    registry.register("toy", "tests.engine.toy_engine:ToyEngine", "every pair, plainly")
    yield
    registry.forget("toy")


@pytest.fixture(params=ENGINES)
def create(request):
    """Creates the engine under test, again and again."""
    name, options = ENGINES[request.param]
    return lambda: registry.create(name, **options)


def needs(engine, fixed):
    """Pass over what the toy says that it cannot do; the engines of the package carry everything here."""
    if reasons := engine.refuses(fixed):
        assert engine.name == "toy", reasons
        pytest.skip(f"{engine.name}: {reasons[0]}")


@pytest.mark.parametrize("kind", full_but(SHOWN, KINDS))
def test_one_frozen_state_and_a_short_run_agree_with_the_cpu(create, kind):
    fixed, first = heap(**KINDS[kind])
    needs(create(), fixed)
    before = loaded(registry.create(), (fixed, first))
    before.advance(30).raise_if_any()
    frozen = before.state()
    theirs, mine = loaded(registry.create(), (fixed, frozen)), loaded(create(), (fixed, frozen))
    for engine in (theirs, mine):
        engine.advance(1).raise_if_any()
    a, b = mine.state(), theirs.state()
    assert len(b.contacts) > 20
    push, turn = b.v - frozen.v, b.omega - frozen.omega
    # a change of velocity is rounded at the size of v
    assert np.abs(a.v - b.v).max() < 1e-12 * np.abs(push).max() + 4e-16 * np.abs(b.v).max()
    assert np.abs(a.omega - b.omega).max() <= 1e-12 * np.abs(turn).max() + 4e-16 * np.abs(b.omega).max()
    for engine in (theirs, mine):
        engine.advance(11).raise_if_any()
    a, b = mine.state(), theirs.state()
    assert apart(a, b, fixed) < 1e-12 * D
    assert a.v == pytest.approx(b.v, rel=0.0, abs=1e-11 * np.abs(b.v).max())
    mine_in_order, in_order = (np.lexsort((one.contacts.j, one.contacts.i)) for one in (a, b))
    for name, array in vars(b.contacts).items():
        size = np.abs(np.nan_to_num(array)).max(initial=0.0)
        found = getattr(a.contacts, name)[mine_in_order]
        assert found == pytest.approx(array[in_order], rel=1e-8, abs=1e-9 * size), name
    alike(mine.tally(), theirs.tally(), 1e-11)
    ended = mine.events()
    assert ended["j"].tolist() == theirs.events()["j"].tolist()
    if a.fluid is not None:
        assert a.fluid.impulse == pytest.approx(b.fluid.impulse, rel=1e-9, abs=1e-20)


@pytest.mark.parametrize("timing", full_but([ContactTiming.EXACT], ContactTiming))
@pytest.mark.parametrize("events", full_but([EventRule.ALL], [EventRule.NONE, EventRule.ALL]))
def test_two_grains_rebound_with_e_and_as_on_the_cpu(create, events, timing):
    exact = timing == ContactTiming.EXACT
    made = scene(
        [[0.0, 0.0, 0.0], [1.0005 * D, 0.0, 0.0]], D, v=[[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]], gravity=0.0,
        restitution=0.7, events=events, timing=timing, steps_per_contact=8.0 if exact else 50.0,
    )  # fmt: skip
    needs(create(), made[0])
    records = []
    for engine in (create(), registry.create()):
        engine.load(*made)
        engine.advance(75).raise_if_any()
        v = engine.state().v[:, 0]
        assert v[1] - v[0] == pytest.approx(0.7 * 0.2, rel=1e-11 if exact else 2.8e-3)
        assert engine.tally().residual < (1e-11 if exact else 1e-4)
        found = engine.events()
        assert len(found) == (1 if events else 0)
        records.append([float(part) for one in found for field in one.tolist() for part in np.ravel(field)])
    assert records[0] == pytest.approx(records[1], rel=1e-9, abs=1e-15)


@pytest.mark.parametrize(
    "kind",
    full_but(
        SHOWN,
        [
            "3D",
            "3D, records",
            "column",
            "exact timing, records",
            "exact timing, capped together, rolling spring",
        ],
    ),
)
def test_run_again_split_or_resumed_it_gives_the_same_bits(create, kind):
    made = heap(**KINDS[kind] | {"stir": 0.5})
    needs(create(), made[0])

    def marched(parts, resume=False):
        engine = loaded(create(), made)
        early = []
        for k, part in enumerate(parts):
            engine.advance(part).raise_if_any()
            if resume and k == 0:
                early.append(engine.events())
                kept, engine = engine.state(), create()
                engine.load(made[0], kept)
                assert bits(engine.state()) == bits(kept)
        assert getattr(engine, "_n_list", 2) > (0 if resume else 1)  # where there is a list
        early.append(engine.events())
        return bits(engine.state()), np.sort(np.concatenate(early)).tobytes(), engine.tally()

    more = 20 if kind.startswith("exact") else 0  # lists reach farther there, and last longer
    whole = marched([26 + more])
    assert marched([1, 14, 2, 9 + more]) == whole
    assert marched([15, 11 + more], resume=True) == whole


@pytest.mark.full
@pytest.mark.parametrize("seed", range(4))
def test_it_finds_every_pair_that_a_search_of_all_pairs_finds(create, seed):
    rng = np.random.default_rng(seed)
    n, plane_case, periodic = 40, bool(seed % 2), seed < 2
    side = 0.03 if plane_case else 0.02
    x, bed = rng.uniform(0.0, side, (n, 3)), rng.uniform(0.0, side, (8, 3))
    if plane_case:
        x[:, 1] = bed[:, 1] = 0.0
    period = (side, math.inf if plane_case else side) if periodic else (math.inf, math.inf)
    fixed, first = scene(
        x, D * rng.uniform(0.5, 2.5, n), x_fixed=bed, d_fixed=D * rng.uniform(0.3, 3.0, 8), period=period,
        gravity=0.0, plane_case=plane_case, allow_overlap=True, stiffness=0.05, steps_per_contact=400.0,
        v=rng.normal(0.0, 1.0, (n, 3)) * [1.0, not plane_case, 1.0], events=EventRule.NONE,
    )  # fmt: skip
    fixed = replace(fixed, overlap_limit=math.inf, world_low=(-math.inf,) * 3, world_high=(math.inf,) * 3)
    engine = create()
    needs(engine, fixed)
    engine.load(fixed, first)
    for _ in range(3):
        before = engine.state()
        engine.advance(1).raise_if_any()
        after = engine.state()
        expected, found = touching_pairs(fixed, before), after.contacts
        begun = set(zip(found.i, found.j, strict=True)) - expected
        assert expected <= set(zip(found.i, found.j, strict=True))
        assert begun <= touching_pairs(fixed, after)  # with exact timing, contacts begin within the step
        assert len(expected) > 10
        engine.advance(4).raise_if_any()


@pytest.mark.full
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # inf - inf, which numpy's scalars tell of
def test_faults_name_grain_step_and_remedy_as_on_the_cpu(create):
    near, quiet = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.01 * D]], {"gravity": 0.0, "events": EventRule.NONE}
    quiet["timing"] = ContactTiming.AT_STEPS
    soft, first = scene(near, D, v=[[0, 0, 0], [0, 0, -2.0]], stiffness=100.0, **quiet)
    stiff, still = scene(near, D, v=[[0, 0, 0], [0, 0, -0.5]], **quiet)
    fast, thrown = scene([[0.0, 0.0, 0.0]], D, v=[[0.0, 0.0, -500.0]], **quiet)
    up, lost = scene(near, D, v=[[0.0] * 3, [0.0, 0.0, 1.0]], **quiet)
    burst = replace(stiff, contact=replace(stiff.contact, k_n=np.inf), overlap_limit=np.inf)
    for made, kind, steps in (
        ((replace(soft, overlap_limit=0.02), first), OverlapTooLarge, 60),
        ((burst, still), NotANumber, 60),
        ((fast, thrown), ListUnsafe, 3),
        ((replace(up, world_high=(np.inf, np.inf, 1.05 * D)), lost), GrainLost, 150),
    ):
        faults = []
        for engine in (create(), registry.create()):
            engine.load(*made)
            faults.append(engine.advance(steps).fault)
        mine, theirs = faults
        assert type(mine) is type(theirs) is kind
        assert (mine.grain, mine.partner) == (theirs.grain, theirs.partner)
        if kind is not GrainLost:  # which is seen when a list is made anew
            assert mine.step == theirs.step


@pytest.mark.parametrize("timing", full_but([ContactTiming.EXACT], ContactTiming))
def test_the_removal_of_a_gate_is_accounted_for_as_on_the_cpu(create, timing):
    gate, back = ("gate", (0.499 * D, 0, 0), (-1, 0, 0)), ("back", (-0.5 * D, 0, 0), (1, 0, 0))
    walls = [("floor", (0, 0, 0), (0, 0, 1)), gate, back]
    fixed, first = scene([[0.0, 0.0, 0.499 * D]], D, planes=walls, allow_overlap=True, timing=timing)
    engines = create(), registry.create()
    needs(engines[0], fixed)
    for engine in engines:
        engine.load(fixed, first)
        engine.advance(20).raise_if_any()
        engine.load(replace(fixed, plane_active=np.array([True, False, True])), engine.state())
        engine.advance(20).raise_if_any()
    mine, theirs = engines
    assert theirs.tally().terms[Term.SWITCH] < 0.0
    alike(mine.tally(), theirs.tally(), 1e-11)
    records = [engine.events()[["i", "j"]].tolist() for engine in engines]
    assert records[0] == records[1]
    assert (0, 2) in records[0]


@pytest.mark.full
def test_what_it_cannot_simulate_is_refused_with_its_reason(create):
    fixed, first = heap(**KINDS["3D"])
    short = replace(fixed, period=(2.0 * D, math.inf))
    assert "shorter than 3 diameters" in create().refuses(short)[0]
    with pytest.raises(ValueError, match="shorter than 3 diameters"):
        create().load(short, first)
    with pytest.raises(ValueError, match="no column of water"):
        loaded(create(), (fixed, first)).set_fluid(np.zeros((fixed.n_grain, N_SAMPLED)))
    with pytest.raises(NotANumber, match="grain 2"):
        create().load(
            fixed, replace(first, x=np.where(np.arange(len(first.x))[:, None] == 2, np.nan, first.x))
        )


@pytest.mark.parametrize("kind", full_but(SHOWN, ["3D", "3D, records", "exact timing, records"]))
def test_a_snapshot_of_the_cpu_is_continued_and_returned_with_its_account(create, kind):
    made = heap(**KINDS[kind])
    needs(create(), made[0])
    cpu = loaded(registry.create(), made)
    cpu.advance(100).raise_if_any()
    other = loaded(create(), (made[0], cpu.state()))
    other.advance(2).raise_if_any()
    back = loaded(registry.create(), (made[0], other.state()))
    back.advance(2).raise_if_any()
    cpu.advance(4).raise_if_any()
    assert apart(back.state(), cpu.state(), made[0]) < 1e-12 * D
    alike(back.tally(), cpu.tally(), 1e-11)


@pytest.mark.full
def test_a_snapshot_is_a_frame_with_contacts_and_cannot_be_written_to(create):
    made = heap(**KINDS["3D"])
    engine = loaded(create(), made)
    engine.advance(5).raise_if_any()
    frame, state = engine.grains(), engine.state()
    x, v, _ = engine.kinematics()
    assert np.array_equal(frame.x, state.x) and np.array_equal(x, state.x) and np.array_equal(v, state.v)
    assert (frame.step, frame.t) == (state.step, state.t) == (5, pytest.approx(5 * made[0].dt))
    assert state.tally == engine.tally()
    assert len(frame.contacts) == 0 < len(state.contacts)
    for array in (state.x, state.contacts.f_n, *(state.engine.arrays.values() if state.engine else ())):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0.0


@pytest.mark.full
def test_its_block_is_refused_by_version_and_range_and_that_of_another_engine_ignored(create):
    made = heap(**KINDS["3D"])
    engine = loaded(create(), made)
    engine.advance(5).raise_if_any()
    state, block = engine.state(), engine.state().engine
    foreign = EngineBlock("another", 7, {"x": np.zeros(3)}, {"skin": math.nan})
    create().load(made[0], replace(state, engine=foreign))
    if block is None:
        pytest.skip(f"{engine.name} needs nothing but the state")
    assert block.engine == engine.name
    listed = np.full((made[0].n_grain, 3), np.inf)
    numbers, arrays = dict(block.numbers), dict(block.arrays)
    for wrong, reason in (
        (replace(block, version=99), f"the block of engine '{engine.name}' has version 99, this one reads 1"),
        (replace(block, numbers=numbers | {"skin": 1.0}), "'skin' of engine .* is 1: must be 0 to"),
        (replace(block, numbers=numbers | {"travel": -1.0}), "'travel' of engine"),
        (replace(block, arrays=arrays | {"x_listed": listed}), "'x_listed' of engine .* not within"),
        (
            replace(block, arrays=arrays | {"x_listed": listed[:3]}),
            r"'x_listed' of engine .* expected",
        ),
    ):
        with pytest.raises(ValueError, match=reason):
            create().load(made[0], replace(state, engine=wrong))
