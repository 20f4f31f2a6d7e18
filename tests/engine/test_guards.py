"""Faults come out as named errors that tell grain, step and remedy; nothing is repaired in silence."""

from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, contact_law, pile

from ryusa.build import scene
from ryusa.engine.cpu import engine as cpu
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.errors import ContactSlotsFull, GrainLost, ListUnsafe, NotANumber, OverlapTooLarge
from ryusa.laws.families import Arm, Rolling
from ryusa.model import RollingLaw


def advance(made, n_steps, threads=1):
    engine = CpuEngine(threads=threads)
    engine.load(*made)
    return engine, engine.advance(n_steps)


def test_an_overlap_beyond_the_limit_names_both_partners():
    fixed, first = scene(
        [[0.0, 0.0, 0.0], [0.0, 0.0, 1.1 * D]], D, v=[[0, 0, 0], [0, 0, -2.0]], stiffness=100.0, gravity=0.0
    )
    _, flags = advance((replace(fixed, overlap_limit=0.1), first), 20_000)
    assert isinstance(flags.fault, OverlapTooLarge)
    assert (flags.fault.grain, flags.fault.partner) == (0, 1)
    assert "overlap_limit" in str(flags.fault)
    assert flags.fault.t == pytest.approx(flags.fault.step * fixed.dt)


def test_a_velocity_that_stops_being_finite_names_its_grain_and_step():
    # springs far too stiff for the step: the force overflows
    fixed, first = scene(
        [[0.0, 0.0, 0.0], [0.0, 0.0, 5 * D], [0.0, 0.0, 6 * D]],
        D,
        v=[[0, 0, 0]] * 2 + [[0, 0, -0.1]],
        gravity=0.0,
    )
    law = replace(fixed.contact, k_n=np.inf)
    engine, flags = advance((replace(fixed, contact=law, overlap_limit=np.inf), first), 10_000)
    assert isinstance(flags.fault, NotANumber)
    assert flags.fault.grain in {1, 2}
    assert 0 <= flags.fault.step < 10_000  # that in which they touch
    assert engine.state().x[0] == pytest.approx([0.0, 0.0, 0.0])


@pytest.mark.parametrize("what", ["x", "v", "omega"])
def test_a_state_that_is_not_finite_is_refused_before_any_step(what):
    fixed, first = scene([[0.0, 0.0, 0.0], [0.0, 0.0, 5 * D]], D, gravity=0.0)
    bad = getattr(first, what).copy()
    bad[1, 0] = np.nan
    with pytest.raises(NotANumber, match="grain 1"):
        CpuEngine().load(fixed, replace(first, **{what: bad}))


def test_a_grain_outside_the_domain_is_a_fault_that_names_it():
    fixed, first = scene(
        [[0.0, 0.0, 0.0], [3 * D, 0.0, 0.0]], D, v=[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]], gravity=0.0
    )
    fixed = replace(fixed, world_high=(np.inf, np.inf, 5 * D))
    _, flags = advance((fixed, first), 1_000_000)
    assert isinstance(flags.fault, GrainLost)
    assert flags.fault.grain == 1
    assert flags.fault.t == pytest.approx(5 * D / 1.0, rel=0.3)


def test_a_step_too_long_for_the_list_stops_the_run():
    fixed, first = scene([[0.0, 0.0, 0.0]], D, v=[[0.0, 0.0, -500.0]], gravity=0.0)
    _, flags = advance((fixed, first), 10)
    assert isinstance(flags.fault, ListUnsafe)
    assert flags.fault.grain == 0


def test_a_grain_far_away_does_not_slow_down_the_search():
    fixed, first = scene(
        [[0.0, 0.0, 0.0], [1e9, 0.0, 0.0], [0.0, 0.0, -1e7]], D, v=[[1.0, 0, 0]] * 3, gravity=0.0
    )
    fixed = replace(fixed, world_low=(-np.inf,) * 3, world_high=(np.inf,) * 3)
    engine, flags = advance((fixed, first), 5000)
    assert not flags
    assert engine.state().x[0, 0] == pytest.approx(5000 * fixed.dt, rel=1e-9)


def test_a_full_record_of_ended_contacts_is_a_fault_and_not_a_loss(monkeypatch):
    monkeypatch.setattr(cpu, "_RECORDS", 9)
    n = 8
    x = [[0.0, 0.0, 1.5 * D * k] for k in range(n)]
    angles = np.radians([-20.0, -10.0, 10.0, 20.0])
    normals = np.column_stack([-np.cos(angles), np.sin(angles), np.zeros(4)])
    planes = [(f"side {k}", tuple(-(0.5 * D - 1e-8) * a), tuple(a)) for k, a in enumerate(normals)]
    fixed, first = scene(x, D, gravity=0.0, planes=planes, v=[[-0.01, 0, 0]] * n, allow_overlap=True)
    _, flags = advance((fixed, first), 500)
    assert isinstance(flags.fault, ContactSlotsFull)


@pytest.mark.full
def test_no_contact_record_is_lost_however_small_the_buffer(monkeypatch):
    made = pile(n=200, plane_case=True)  # one block, whatever the buffer
    engine, _ = advance(made, 6000)
    whole = engine.events()
    monkeypatch.setattr(cpu, "_RECORDS", -170)
    small, flags = advance(made, 6000)
    assert not flags
    assert small._accounts.ended.shape[1] == 30
    assert len(whole) > 100
    assert small.events().tobytes() == whole.tobytes()


def test_an_engine_lists_the_laws_it_lacks():
    fixed, first = scene([[0.0, 0.0, 0.0]], D, contact=contact_law(), gravity=0.0, period=(2.5 * D, np.inf))
    assert "period in x" in CpuEngine().refuses(fixed)[0]
    rolling = RollingLaw(Rolling.EPSD, Arm.CONTACT_WIDTH, 0.1)
    assert "arm" in CpuEngine().refuses(replace(fixed, period=(np.inf, np.inf), rolling=rolling))[0]
    walled, _ = scene([[0.0, 0.0, 0.0]], D, planes=[("gate", (D, 0, 0), (-1, 0, 0))], gravity=0.0)
    assert CpuEngine().refuses(walled) == ()
    assert "across the periodic" in CpuEngine().refuses(replace(walled, period=(10 * D, np.inf)))[0]
    with pytest.raises(ValueError, match="period in x"):
        CpuEngine().load(fixed, first)
