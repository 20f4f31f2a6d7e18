from dataclasses import replace

import numpy as np
import pytest

from ryusa.errors import CaseError, EnergyCreated
from ryusa.model import State, Tally, Term
from ryusa.model.tally import N_TERM
from ryusa.results import Results
from ryusa.running import folder as folder_module
from ryusa.running.folder import available_memory, refuse_if_too_large
from ryusa.running.guards import NO_REST, energy_created
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop


def account(kinetic, start=0.0):
    terms = [0.0] * N_TERM
    terms[Term.START] = start
    return Tally(0.0, kinetic, 0.0, 0.0, 0.0, 0.0, 0.0, tuple(terms), 0.004, 0, 0, 1.0, 1.0, 0)


def moving(n=3):
    v = np.zeros((n, 3))
    v[1, 0] = 7.0
    return State(x=np.zeros((n, 3)), v=v, omega=np.zeros((n, 3)), step=40, t=0.5)


def test_created_energy_names_the_fastest_grain_step_time_and_remedy(scene):
    fault = energy_created(scene, moving(), account(kinetic=1.0, start=0.2))
    assert isinstance(fault, EnergyCreated)
    assert (fault.grain, fault.step, fault.t) == (1, 40, 0.5)
    assert "gained 0.8 J that no force supplied" in str(fault)
    assert "steps_per_contact" in fault.hint


def test_energy_given_by_the_step_counts_as_created_too(scene):
    boiling = account(kinetic=1.0, start=0.2)
    terms = list(boiling.terms)
    terms[Term.STEP], terms[Term.SLIDE] = 3.0, 2.2
    boiling = replace(boiling, terms=tuple(terms))
    assert boiling.residual < 1e-9
    fault = energy_created(scene, moving(), boiling)
    assert fault is not None
    assert "gained 3 J that no force supplied" in str(fault)


def test_what_a_step_gives_and_a_dashpot_takes_at_rest_under_a_load_is_no_fault(scene):
    terms = [0.0] * N_TERM
    terms[Term.STEP], terms[Term.DASH_N] = 3.0, 3.0
    for kinetic, fails in ((1e-12, False), (1e-3, True)):
        tally = replace(account(kinetic), terms=tuple(terms))
        rest = NO_REST.after(tally)
        assert (energy_created(scene, moving(), tally, rest) is not None) is fails
        assert (rest is NO_REST) is fails


def test_after_a_rest_only_what_is_gained_since_counts(scene):
    """Grains are drawn along once they have rested: the work is 1 J, and the step gives 0.1 or 0.9 J more."""
    terms = [0.0] * N_TERM
    terms[Term.STEP], terms[Term.DASH_N] = 3.0, 3.0
    rest = NO_REST.after(replace(account(1e-12), terms=tuple(terms)))
    for more, fails in ((0.1, False), (0.9, True)):
        after = list(terms)
        after[Term.STEP] += more
        after[Term.DASH_N] += 0.5 + more
        after[Term.SLIDE] = 0.5
        after[Term.WALL] = 1.0
        tally = replace(account(1e-2), terms=tuple(after))
        assert (energy_created(scene, moving(), tally, rest) is not None) is fails
        assert energy_created(scene, moving(), tally) is not None


@pytest.mark.parametrize("tally", [account(1.0, 1.0), account(1.0, 0.6), account(0.2, 1.0), account(1e-12)])
def test_constant_or_decreasing_energy_and_round_off_at_rest_are_no_fault(scene, tally):
    assert energy_created(scene, moving(), tally) is None


def test_a_run_that_creates_energy_stops_and_keeps_its_frames(scene, state, engine, tmp_path, monkeypatch):
    tally = engine.tally
    monkeypatch.setattr(
        engine, "tally", lambda: account(1.0) if engine.state().step >= 500 else account(1.0, 1.0)
    )
    with pytest.raises(EnergyCreated):
        run_scene(
            scene, state, tmp_path / "run", frames=1e-3, stop=Stop(time=0.01), engine=engine, progress=False
        )
    results = Results.open(tmp_path / "run")
    assert results.status == "failed"
    assert results.frames.step[-1] == 500
    assert tally is not None


def test_more_memory_than_there_is_is_refused_before_the_first_grain(monkeypatch):
    monkeypatch.setattr(folder_module, "available_memory", lambda: 1e9)
    refuse_if_too_large(0.9e9, 10)
    with pytest.raises(CaseError, match=r"need 2 GB of memory; 1 GB are available"):
        refuse_if_too_large(2e9, 10**6)


def test_the_memory_of_a_scene_made_by_hand_is_checked_too(scene, state, engine, tmp_path, monkeypatch):
    monkeypatch.setattr(folder_module, "available_memory", lambda: 2e3)
    with pytest.raises(CaseError, match="Take fewer grains"):
        run_scene(scene, state, tmp_path / "run", frames=1e-3, stop=Stop(time=0.01), engine=engine)
    assert not (tmp_path / "run").exists()


def test_free_memory_is_a_number_of_bytes_if_the_system_reports_it():
    there = available_memory()
    assert there is None or 1e6 < there < 1e15
