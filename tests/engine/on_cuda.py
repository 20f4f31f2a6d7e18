"""What is the CUDA engine's own; what it shares with every engine is asked in test_engines.py.

Not collected by itself: tests/engine/test_cuda.py runs this file with numba's simulator, where threads are
Python's, in a process with NUMBA_ENABLE_CUDASIM=1, which has to be said before numba is imported. On a card:
`pytest tests/engine/on_cuda.py tests/engine/test_engines.py -k cuda`.
"""

import os
import signal
import sys

import numpy as np
import pytest
from benchmarks import card_cost
from tests.engine.conftest import D
from tests.engine.heaps import KINDS, alike, apart, heap, loaded

from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.cuda import device_state as store
from ryusa.engine.cuda import run_status as F
from ryusa.engine.cuda.engine import CudaEngine
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

sys.setswitchinterval(2e-5)  # the simulator polls its threads: without this each wait costs 5 ms


@pytest.mark.parametrize(
    "kind", ["flow, rolling spring, records", "exact timing, capped together, rolling spring"]
)
def test_both_sides_of_every_pair_hold_the_same_bits(kind):
    engine = loaded(CudaEngine(), heap(**KINDS[kind]))
    engine.advance(5).raise_if_any()
    held = engine._device
    start, partners, live, eta, rows = (array.copy_to_host() for array in held.pairs)
    ids = held.bodies.ids.copy_to_host()
    found = {}
    for i in range(held.n):
        for k in range(start[i], start[i + 1]):
            if partners[k] < held.n:
                found.setdefault(frozenset((ids[i], ids[partners[k]])), []).append(
                    (live[k], eta[k].tobytes(), rows[k, :14].tobytes())
                )
    assert all(len(sides) == 2 and sides[0] == sides[1] for sides in found.values() if sides[0][0])
    assert sum(bool(sides[0][0]) for sides in found.values()) > 20


@pytest.mark.parametrize("kind", ["exact timing, films", "exact timing, plane, may pull"])
def test_a_list_renewed_between_kicks_and_shear_finds_the_pairs_that_touch_there(kind):
    made = heap(**KINDS[kind] | {"stir": 0.6})
    mine, theirs = loaded(CudaEngine(skin=0.03), made), loaded(CpuEngine(skin=0.03), made)
    for engine in (mine, theirs):
        engine.advance(25).raise_if_any()
    a, b = mine.state(), theirs.state()
    assert mine._n_list > 2
    assert apart(a, b, made[0]) < 1e-11 * D
    assert sorted(zip(a.contacts.i, a.contacts.j, a.contacts.state, strict=True)) == sorted(
        zip(b.contacts.i, b.contacts.j, b.contacts.state, strict=True)
    )
    alike(mine.tally(), theirs.tally(), 1e-10)


def test_grains_have_the_halves_of_a_whole_step_again_after_kicks_and_shear():
    engine = loaded(CudaEngine(), heap(**KINDS["exact timing"]))
    engine.advance(1).raise_if_any()
    half, before = engine._device.half, engine.state()
    engine.advance(1).raise_if_any()
    assert (engine._device.half, int(engine._status[F.KICKED])) == (half, 0)
    x, v = (getattr(engine._device.bodies, name).copy_to_host() for name in ("x", "v"))
    assert np.array_equal(np.sort(x[1 - half, : engine._n, 0]), np.sort(before.x[:, 0]))
    assert not np.array_equal(x[0], x[1]) and not np.array_equal(v[0], v[1])


@pytest.mark.parametrize(
    "kind", ["3D", "plane, records", "column", "exact timing, records", "twisting, rolling spring"]
)
def test_the_count_of_bytes_is_that_of_the_arrays_on_the_device(kind):
    fixed, first = heap(**KINDS[kind])
    engine = loaded(CudaEngine(), (fixed, first))
    engine.advance(12).raise_if_any()
    device, variant = engine._device, engine._variant
    small = (
        engine._d_status, engine._d_motion, engine._d_stats, engine._d_terms, engine._d_partial, device.c,
        *device.walls,
    )  # fmt: skip
    counted = card_cost.memory(
        fixed.n_grain, fixed.n_fixed, fixed.n_plane, variant, device.pairs.partners.shape[0],
        device._held.partners.shape[0], engine._room,
    )  # fmt: skip
    assert card_cost.allocated(engine) == counted + sum(one.size * one.dtype.itemsize for one in small)
    assert device.pairs.partners.shape[0] >= device.n_pair > 0
    assert device.pairs.rows.nbytes > device._held.rows.nbytes > 0


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


def test_an_engine_chosen_by_name_resumes_with_the_same_bits(tmp_path):
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
