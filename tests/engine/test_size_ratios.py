"""Neighbour lists of grains of very different sizes: the pairs of all of them, by brute force."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import bits, run
from tests.kernel_variants import full_but

from ryusa.build import scene
from ryusa.engine.cpu.cell_list import APART, grids_by_size, levels_of
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import ContactTiming

SMALL = 1.0e-3


def mixture(largest, n_large, periodic, fixed, seed):
    """Small grains about large ones, at random and so overlapping, some of them fixed."""
    rng, side = np.random.default_rng(seed), 0.13
    d = np.concatenate([rng.uniform(1.8, 2.2, 3000), 2.0 * largest ** np.linspace(1.0, 0.5, n_large)]) * SMALL
    x = rng.uniform(0.0, side, (len(d), 3))
    order = rng.permutation(len(d))
    x, d = x[order], d[order]
    stands = np.zeros(len(d), bool)
    stands[rng.choice(len(d), fixed, replace=False)] = True
    period = (side, side) if periodic else (math.inf, math.inf)
    more = {"x_fixed": x[stands], "d_fixed": d[stands]} if fixed else {}
    timing = ContactTiming.EXACT
    fixed_, first = scene(
        x[~stands], d[~stands], period=period, allow_overlap=True, gravity=0.0, timing=timing,
        stiffness=1e-3, dt=1e-4,
        **more,
    )  # fmt: skip
    return replace(fixed_, overlap_limit=1e6), first


def touching(made):
    """Pairs that overlap, by brute force, one of them free."""
    fixed, state = made
    x = np.concatenate([state.x, fixed.x_fixed.reshape(-1, 3)])
    r = 0.5 * np.concatenate([fixed.d, fixed.d_fixed])
    found = set()
    for i in range(fixed.n_grain):
        way = x[i + 1 :] - x[i]
        for axis, length in enumerate(fixed.period):
            if math.isfinite(length):
                way[:, axis] -= length * np.round(way[:, axis] / length)
        near = np.flatnonzero((way**2).sum(axis=1) < (r[i] + r[i + 1 :]) ** 2)
        found |= {(i, int(i + 1 + k)) for k in near}
    return found


@pytest.mark.parametrize("periodic", full_but([True], [True, False]))
@pytest.mark.parametrize(
    ("largest", "n_large", "fixed"), [(15.0, 1, 0), (20.0, 3, 0), (10.0, 20, 300), (4.0, 100, 0)]
)
def test_every_pair_that_touches_is_met(largest, n_large, fixed, periodic):
    made = mixture(largest, n_large, periodic, fixed, seed=7)
    engine = CpuEngine()
    engine.load(*made)
    engine.advance(1).raise_if_any()
    held = engine.state().contacts
    found = {(min(a, b), max(a, b)) for a, b in zip(held.i.tolist(), held.j.tolist(), strict=True)}
    assert found == touching(made)


def test_threads_and_a_snapshot_leave_the_bits():
    made = mixture(20.0, 5, True, 0, seed=3)
    whole = bits(run(made, 60).state())
    assert bits(run(made, 60, threads=2).state()) == whole
    engine = run(made, 25)
    other = CpuEngine()
    other.load(made[0], engine.state())
    other.advance(35).raise_if_any()
    assert bits(other.state()) == whole


def test_a_boulder_leaves_the_cells_of_the_others_as_they_are():
    rng = np.random.default_rng(1)
    x, d = rng.uniform(0.0, 1.0, (1000, 3)), np.full(1000, 0.01)
    d[500] = 0.4
    ends = np.zeros(3), np.ones(3)
    grids = grids_by_size(x, d, np.arange(1000), 0.001, np.full(2, np.inf), *ends, 0.4)
    assert levels_of(d, 0.01)[500] == math.ceil(math.log2(40 / APART))
    assert len(grids.r_most) == 2
    assert grids.width[0, 0] < 0.1 < grids.width[1, 0]
    assert sorted(grids.order.tolist()) == list(range(1000))
