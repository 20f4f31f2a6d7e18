"""A second process compiles pieces into the store, and its failure costs nothing but time."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np
import pytest
from tests.compiled.makers import make_scale

from ryusa.compiled import beside, processor, store, tiers, waiting
from ryusa.compiled.beside import Beside, Wanted
from ryusa.compiled.function import compiled
from ryusa.compiled.piece import LentType, call, lend

LENT = LentType(numba.typeof((np.ones(2), np.ones(2))))


@compiled()
def scaled(piece, held):
    call(piece, (1, lend(held)))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A store without anything in it, here and in the other process, and two cores."""
    empty = store.Store(tmp_path, processor.own())
    monkeypatch.setenv("RYUSA_CACHE", str(tmp_path))
    monkeypatch.setattr(store, "own", lambda: empty)
    monkeypatch.setattr(tiers, "in_order", lambda: (empty,))
    monkeypatch.setattr(beside, "cores", lambda: 2)
    return tmp_path


@pytest.fixture
def started(monkeypatch):
    """The processes that were started."""
    found, start = [], subprocess.Popen

    def popen(*given, **more):
        found.append(start(*given, **more))
        return found[-1]

    monkeypatch.setattr(subprocess, "Popen", popen)
    return found


def scale_by(factor):
    made = Beside([Wanted(make_scale, (factor,), (numba.types.int64, LENT))])
    (piece,) = made.pieces()
    held = np.ones(2), np.ones(2)
    scaled(piece, held)
    return held[0].tolist()


def test_the_other_process_compiles_and_this_one_loads(folder, started):
    assert scale_by(2.0) == [1.0, 2.0]
    assert [one.returncode for one in started] == [0]
    (kept,) = (one for one in store.own().listed() if one.about["kind"] == "piece")
    assert "make_scale" in kept.about["name"]
    assert kept.about["seconds"] > 0.0  # in the other process
    scale_by(2.0)
    assert len(started) == 1  # the store has it


def test_all_threads_of_a_run_may_ask_at_once(folder, started):
    (piece,) = Beside([Wanted(make_scale, (8.0,), (numba.types.int64, LENT))]).pieces()
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: piece.address, range(4)))
    assert len(set(found)) == 1
    assert [one.returncode for one in started] == [0]
    assert waiting.left() == 0.0


def test_a_process_that_breaks_off_is_made_up_for(folder, started, monkeypatch):
    monkeypatch.setattr(sys, "executable", "/bin/false")
    assert scale_by(3.0) == [1.0, 3.0]
    assert [one.returncode for one in started] == [1]


def test_one_core_or_a_closed_store_start_no_process(folder, started, monkeypatch):
    monkeypatch.setattr(beside, "cores", lambda: 1)
    assert scale_by(4.0) == [1.0, 4.0]
    monkeypatch.setattr(beside, "cores", lambda: 2)
    store.own().writable = False
    assert scale_by(5.0) == [1.0, 5.0]
    assert not started


def test_a_run_that_breaks_off_leaves_no_process_behind(folder, started):
    made = Beside([Wanted(make_scale, (6.0,), (numba.types.int64, LENT))])
    del made
    assert started[0].returncode is not None


def test_waiting_for_it_is_told_and_counted_as_compiling(folder, started):
    before, told = waiting.done(), []
    with waiting.told(told.append):
        scale_by(7.0)
    assert [one for one in told if one and "make_scale" in one]
    assert told[-1] is None
    assert waiting.done().since(before).functions >= 1
