"""The CUDA engine in numba's simulator, where threads are Python's: few grains, few steps.

Not collected by itself: tests/engine/test_cuda.py runs this file in a process with NUMBA_ENABLE_CUDASIM=1,
which has to be said before numba is imported.
"""

import math
import os
import signal
import sys
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, bits
from tests.engine.reference import touching_pairs

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.cuda import device_state as store
from ryusa.engine.cuda.engine import CudaEngine
from ryusa.errors import GrainLost, ListUnsafe, NotANumber, OverlapTooLarge
from ryusa.laws.families import (
    Above,
    Arm,
    Buoyancy,
    Drag,
    Hindrance,
    Lift,
    Magnus,
    Profile,
    Rebound,
    Rolling,
    Slip,
    WaterTorque,
)
from ryusa.model import Book, RollingLaw, Water
from ryusa.model.fluid import A_X, EXTRA_X, N_SAMPLED, PHI, SHEAR, SUBMERGED, U
from ryusa.model.scene import EventRule
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

sys.setswitchinterval(2e-5)  # the simulator polls its threads: without this each wait costs 5 ms

FLOW = Water(
    profile=Profile.LOG_ROUGH, u_star=0.1, k_rough=D, depth=2.5 * D, above=Above.DRY, drag=Drag.RE_04,
    torque=WaterTorque.DENNIS,
)  # fmt: skip
FILM = Water(
    profile=Profile.STILL, drag=Drag.SCHILLER_NAUMANN, asperity=0.01 * D, film_reach=0.05 * D,
    rebound=Rebound.EXPONENTIAL, torque=WaterTorque.STOKES,
)  # fmt: skip
COLUMN = Water(
    profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, hindrance=Hindrance.DI_FELICE,
    buoyancy=Buoyancy.STRESS, lift=Lift.SAFFMAN_MEI, magnus=Magnus.LOTH, torque=WaterTorque.DENNIS,
)  # fmt: skip
KINDS = {
    "3D, records": {},
    "plane, records": {"plane_case": True},
    "dashpot dropped": {"slip": Slip.SPRING_DROP},
    "capped together": {"slip": Slip.TOTAL},
    "capped together, plane": {"slip": Slip.TOTAL, "plane_case": True},
    "may pull, walls": {"tension": True, "walls": True},
    "no rotation": {"rotation": False, "events": EventRule.NONE},
    "flow, rolling spring, records": {
        "water": FLOW, "rolling": RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, 0.1), "events": EventRule.ALL,
    },
    "rolling as printed": {"rolling": RollingLaw(Rolling.PRINTED, Arm.CONTACT_WIDTH, 0.3)},
    "rolling, constant, plane": {
        "rolling": RollingLaw(Rolling.CONSTANT, Arm.REDUCED_RADIUS, 0.1), "plane_case": True,
    },
    "films": {"water": FILM},
    "column": {"water": COLUMN, "events": EventRule.NONE},
}  # fmt: skip


def heap(plane_case=False, walls=False, seed=5, stir=0.1, **more):
    """Some twenty grains of several sizes that press on each other and on a rough bed, periodic."""
    rng = np.random.default_rng(seed)
    wide, deep, high = (5, 1, 4) if plane_case else (4, 3, 2)
    a, b, c = (
        g.ravel() for g in np.meshgrid(np.arange(wide), np.arange(deep), np.arange(high), indexing="ij")
    )
    pitch = 1.005 * D
    x = np.column_stack([a * pitch, b * pitch, (c + 0.97) * 0.985 * D])
    x += rng.uniform(-0.01, 0.01, x.shape) * D * [1.0, not plane_case, 1.0]
    bed = np.column_stack([a * pitch, b * pitch, rng.uniform(-0.02, 0.02, len(a)) * D])[c == 0]
    kind = {"events": EventRule.ALL, "friction": 0.3, "stiffness": 2e3} | more
    planes = [("lid", (0.0, 0.0, (high + 0.45) * D), (0.0, 0.0, -1.0))] if walls else []
    return scene(
        x, D * (1.0 + rng.uniform(-0.01, 0.005, len(x))), x_fixed=bed, d_fixed=D, planes=planes,
        v=rng.normal(0.0, stir, x.shape) * [1.0, not plane_case, 1.0], slope=math.radians(25.0),
        omega=rng.normal(0.0, 20.0, x.shape) * [not plane_case, 1.0, not plane_case],
        plane_case=plane_case, period=(wide * pitch, math.inf if plane_case else deep * pitch),
        allow_overlap=True, **kind,
    )  # fmt: skip


def told(fixed, seed=9):
    """Water at every grain, of every kind."""
    rng = np.random.default_rng(seed)
    seen = np.zeros((fixed.n_grain, N_SAMPLED))
    seen[:, U : U + 3] = rng.normal(0.2, 0.1, (fixed.n_grain, 3))
    seen[:, SHEAR], seen[:, PHI], seen[:, A_X] = 30.0, 0.3, rng.normal(0.0, 1.0, fixed.n_grain)
    seen[:, EXTRA_X : EXTRA_X + 2] = rng.normal(0.0, 1e-6, (fixed.n_grain, 2))
    seen[:, SUBMERGED] = rng.choice([0.0, 0.4, 1.0], fixed.n_grain)
    return seen


def loaded(engine, made):
    engine.load(*made)
    if made[0].water.profile == Profile.COLUMN:
        engine.set_fluid(told(made[0]))
    return engine


def alike(mine, theirs, share):
    """Every sum and extreme agrees to this share of the largest."""
    held = ("kinetic", "spin", "potential", "spring_n", "spring_s", "spring_r")
    size = max(abs(getattr(theirs, name)) for name in held)
    assert [getattr(mine, name) for name in held] == pytest.approx(
        [getattr(theirs, name) for name in held], rel=1e-9, abs=share * size
    )
    assert mine.books == pytest.approx(theirs.books, rel=1e-9, abs=share * max(map(abs, theirs.books)))
    for name in ("overlap_max", "speed_max", "spin_max", "t"):
        assert getattr(mine, name) == pytest.approx(getattr(theirs, name), rel=1e-9)
    assert (mine.n_contact, mine.overlap_grain) == (theirs.n_contact, theirs.overlap_grain)


@pytest.mark.parametrize("kind", KINDS)
def test_one_frozen_state_and_a_short_run_agree_with_the_cpu(kind):
    fixed, first = heap(**KINDS[kind])
    before = loaded(CpuEngine(), (fixed, first))
    before.advance(30).raise_if_any()
    frozen = before.state()
    theirs, mine = loaded(CpuEngine(), (fixed, frozen)), loaded(CudaEngine(), (fixed, frozen))
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
    assert np.abs(a.x - b.x).max() < 1e-12 * D
    assert a.v == pytest.approx(b.v, rel=0.0, abs=1e-11 * np.abs(b.v).max())
    order = np.lexsort((b.contacts.j, b.contacts.i))
    for name, array in vars(b.contacts).items():
        size = np.abs(np.nan_to_num(array)).max(initial=0.0)
        assert getattr(a.contacts, name) == pytest.approx(array[order], rel=1e-8, abs=1e-9 * size), name
    alike(mine.tally(), theirs.tally(), 1e-11)
    ended = mine.events()
    assert ended["j"].tolist() == theirs.events()["j"].tolist()
    if a.fluid is not None:
        assert a.fluid.impulse == pytest.approx(b.fluid.impulse, rel=1e-9, abs=1e-20)


def test_two_grains_rebound_as_asked_and_as_on_the_cpu():
    made = scene(
        [[0.0, 0.0, 0.0], [1.0005 * D, 0.0, 0.0]], D, v=[[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]], gravity=0.0,
        restitution=0.7,
    )  # fmt: skip
    records = []
    for engine in (CudaEngine(), CpuEngine()):
        engine.load(*made)
        engine.advance(75).raise_if_any()
        (record,) = engine.events()
        assert -record["closing_end"] / record["closing_begin"] == pytest.approx(0.7, abs=2e-3)
        assert engine.tally().residual < 1e-4
        records.append([float(part) for field in record.tolist() for part in np.ravel(field)])
    assert records[0] == pytest.approx(records[1], rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("kind", ["3D, records", "column"])
def test_run_again_split_or_resumed_it_gives_the_same_bits(kind):
    made = heap(stir=0.5, **KINDS[kind])

    def marched(parts, resume=False):
        engine = loaded(CudaEngine(skin=0.03), made)
        early = []
        for k, part in enumerate(parts):
            engine.advance(part).raise_if_any()
            if resume and k == 0:
                early.append(engine.events())
                kept, engine = engine.state(), CudaEngine(skin=0.03)
                engine.load(made[0], kept)
                assert bits(engine.state()) == bits(kept)
        assert engine._n_list > (0 if resume else 1)
        early.append(engine.events())
        return bits(engine.state()), np.sort(np.concatenate(early)).tobytes(), engine.tally()

    whole = marched([26])
    assert marched([1, 14, 2, 9]) == whole
    assert marched([15, 11], resume=True) == whole


def test_both_sides_of_every_pair_hold_the_same_bits():
    engine = loaded(CudaEngine(), heap(**KINDS["flow, rolling spring, records"]))
    engine.advance(5).raise_if_any()
    held = engine._device
    start, partners, live, _, rows = (array.copy_to_host() for array in held.pairs)
    ids = held.bodies.ids.copy_to_host()
    found = {}
    for i in range(held.n):
        for k in range(start[i], start[i + 1]):
            if partners[k] < held.n:
                found.setdefault(frozenset((ids[i], ids[partners[k]])), []).append(
                    (live[k], rows[k, :14].tobytes())
                )
    assert all(len(sides) == 2 and sides[0] == sides[1] for sides in found.values() if sides[0][0])
    assert sum(bool(sides[0][0]) for sides in found.values()) > 20


def test_grains_may_outnumber_threads(monkeypatch):
    made, ended = heap(**KINDS["3D, records"]), []
    for _ in range(2):
        engine = loaded(CudaEngine(), made)
        engine.advance(4).raise_if_any()
        ended.append((engine.state(), engine.tally()))
        monkeypatch.setattr(store, "MOST_BLOCKS", 2)  # of three
    (a, first), (b, second) = ended
    assert all(np.array_equal(getattr(a, name), getattr(b, name)) for name in ("x", "v", "omega"))
    alike(second, first, 1e-14)


@pytest.mark.parametrize("seed", range(4))
def test_the_list_finds_every_pair_that_a_search_of_all_pairs_finds(seed):
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
        v=rng.normal(0.0, 1.0, (n, 3)) * [1.0, not plane_case, 1.0],
    )  # fmt: skip
    fixed = replace(fixed, overlap_limit=math.inf, world_low=(-math.inf,) * 3, world_high=(math.inf,) * 3)
    engine = CudaEngine(skin=0.05)
    engine.load(fixed, first)
    for _ in range(3):
        before = engine.state()
        engine.advance(1).raise_if_any()
        after = engine.state().contacts
        expected = touching_pairs(fixed, before)
        assert set(zip(after.i, after.j, strict=True)) == expected
        assert len(expected) > 10
        engine.advance(4).raise_if_any()
    assert engine._n_list > 0


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # inf - inf, which numpy's scalars tell of
def test_faults_name_grain_step_and_remedy_as_on_the_cpu():
    near = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.01 * D]]
    soft, first = scene(near, D, v=[[0, 0, 0], [0, 0, -2.0]], stiffness=100.0, gravity=0.0)
    stiff, still = scene(near, D, v=[[0, 0, 0], [0, 0, -0.5]], gravity=0.0)
    fast, thrown = scene([[0.0, 0.0, 0.0]], D, v=[[0.0, 0.0, -500.0]], gravity=0.0)
    up, lost = scene(near, D, v=[[0.0] * 3, [0.0, 0.0, 1.0]], gravity=0.0)
    burst = replace(stiff, contact=replace(stiff.contact, k_n=np.inf), overlap_limit=np.inf)
    for made, kind, steps in (
        ((replace(soft, overlap_limit=0.02), first), OverlapTooLarge, 60),
        ((burst, still), NotANumber, 60),
        ((fast, thrown), ListUnsafe, 3),
        ((replace(up, world_high=(np.inf, np.inf, 1.05 * D)), lost), GrainLost, 150),
    ):
        faults = []
        for engine in (CudaEngine(), CpuEngine()):
            engine.load(*made)
            faults.append(engine.advance(steps).fault)
        mine, theirs = faults
        assert type(mine) is type(theirs) is kind
        assert (mine.grain, mine.partner) == (theirs.grain, theirs.partner)
        if kind is not GrainLost:  # which is seen when the list is made anew
            assert mine.step == theirs.step


def test_a_gate_that_goes_is_booked_and_its_record_closed_as_on_the_cpu():
    gate, back = ("gate", (0.499 * D, 0, 0), (-1, 0, 0)), ("back", (-0.5 * D, 0, 0), (1, 0, 0))
    walls = [("floor", (0, 0, 0), (0, 0, 1)), gate, back]
    fixed, first = scene([[0.0, 0.0, 0.499 * D]], D, planes=walls, allow_overlap=True)
    engines = CudaEngine(), CpuEngine()
    for engine in engines:
        engine.load(fixed, first)
        engine.advance(20).raise_if_any()
        engine.load(replace(fixed, plane_active=np.array([True, False, True])), engine.state())
        engine.advance(20).raise_if_any()
    mine, theirs = engines
    assert theirs.tally().books[Book.SWITCH] < 0.0
    alike(mine.tally(), theirs.tally(), 1e-11)
    records = [engine.events()[["i", "j"]].tolist() for engine in engines]
    assert records[0] == records[1]
    assert (0, 2) in records[0]


def test_what_the_engine_cannot_carry_is_refused_with_its_reason():
    fixed, first = heap()
    short = replace(fixed, period=(2.0 * D, math.inf))
    assert "shorter than 3 diameters" in CudaEngine().refuses(short)[0]
    with pytest.raises(ValueError, match="shorter than 3 diameters"):
        CudaEngine().load(short, first)
    with pytest.raises(ValueError, match="no column of water"):
        loaded(CudaEngine(), (fixed, first)).set_fluid(np.zeros((fixed.n_grain, N_SAMPLED)))


def test_a_snapshot_goes_from_one_engine_to_the_other_with_its_account():
    made = heap(**KINDS["3D, records"])
    cpu = loaded(CpuEngine(), made)
    cpu.advance(100).raise_if_any()
    cuda = loaded(CudaEngine(), (made[0], cpu.state()))
    cuda.advance(2).raise_if_any()
    back = loaded(CpuEngine(), (made[0], cuda.state()))
    back.advance(2).raise_if_any()
    cpu.advance(4).raise_if_any()
    assert back.state().x == pytest.approx(cpu.state().x, rel=0.0, abs=1e-12 * D)
    alike(back.tally(), cpu.tally(), 1e-11)


def test_a_run_chosen_by_name_goes_on_from_its_checkpoint_with_the_same_bits(tmp_path):
    fixed, first = heap(stir=0.5)

    def go(name, steps, **more):
        stop = Stop(time=(steps - 0.5) * fixed.dt)
        return run_scene(
            fixed,
            first,
            tmp_path / name,
            frames=6 * fixed.dt,
            stop=stop,
            engine="cuda",
            progress=False,
            **more,
        )

    whole = go("whole", 12)
    assert whole.provenance["engine"] == "cuda"
    assert whole.complete
    assert len(whole.frames) == 3

    class Cut(CudaEngine):
        def advance(self, n_steps):
            if self._step >= 6:
                os.kill(os.getpid(), signal.SIGINT)
            return super().advance(n_steps)

    stop = Stop(time=11.5 * fixed.dt)
    part = run_scene(
        fixed, first, tmp_path / "cut", frames=6 * fixed.dt, stop=stop, engine=Cut(), progress=False
    )
    assert not part.complete
    gone_on = go("cut", 12, resume=True)
    assert gone_on.complete
    assert gone_on.frames.x[-1].tobytes() == whole.frames.x[-1].tobytes()
    assert gone_on.frames.v[-1].tobytes() == whole.frames.v[-1].tobytes()
