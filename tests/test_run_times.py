"""How long runs took here is kept, asked for by kind, and never in the way."""

import json
import os
from dataclasses import replace

import pytest

import ryusa
from ryusa import run_times
from ryusa.casefile import derive
from ryusa.casefile.read import read
from ryusa.casefile.wall_time import (
    SECONDS_PER_RUN,
    keep_wall_time,
    kind_of_run,
    seconds_per_step,
    wall_time,
    wall_time_by_rule,
)
from ryusa.cases import case_path
from ryusa.compiled import store
from ryusa.study import case_run
from ryusa.study.cost import basis_of


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """The file of an empty record."""
    monkeypatch.delenv("RYUSA_RUN_TIMES")
    monkeypatch.setattr(store, "folder", lambda: tmp_path / "cache")
    return tmp_path / "cache" / "run_times.json"


@pytest.fixture
def case():
    return read(case_path("heap.toml"))


def test_the_latest_of_each_kind_are_kept_and_others_are_left_alone(kept):
    assert run_times.ratios_of("plane") == ()
    for k in range(1, 13):
        run_times.add("plane", float(k))
    run_times.add("3D", 0.5)
    assert run_times.ratios_of("plane") == tuple(float(k) for k in range(4, 13))
    assert run_times.ratios_of("3D") == (0.5,)
    for kind in range(run_times._MOST):
        run_times.add(f"kind {kind}", 1.0)
    assert run_times.ratios_of("plane") == () and run_times.ratios_of("kind 0") == (1.0,)


def test_what_another_process_added_is_merged(kept):
    run_times.add("plane", 1.0)
    (key,) = held = json.loads(kept.read_text())
    kept.write_text(json.dumps({**held, key: [1.0, 3.0], key.replace("plane", "3D"): [2.0]}))
    run_times.add("plane", 5.0)
    assert run_times.ratios_of("plane") == (1.0, 3.0, 5.0) and run_times.ratios_of("3D") == (2.0,)


def test_a_ratio_of_another_kind_of_processor_does_not_count(kept):
    run_times.add("plane", 1.0)
    (key,) = json.loads(kept.read_text())
    kept.write_text(json.dumps({f"another{key}": [2.0]}))
    assert run_times.ratios_of("plane") == ()


@pytest.mark.parametrize(
    "text", ["", "{", "[1, 2]", "null", '{"a": 3}', "\0\0", '{"KEY": [1.0, "x", -2, null]}']
)
def test_a_damaged_record_is_taken_for_what_is_whole_in_it(kept, text):
    run_times.add("plane", 1.0)
    (key,) = json.loads(kept.read_text())
    kept.write_text(text.replace("KEY", key))
    expected = (1.0,) if "KEY" in text else ()
    assert run_times.ratios_of("plane") == expected
    run_times.add("plane", 2.0)
    assert run_times.ratios_of("plane") == (*expected, 2.0)


@pytest.mark.parametrize("ratio", [0.0, -1.0, float("nan"), float("inf")])
def test_what_is_no_ratio_is_not_kept(kept, ratio):
    run_times.add("plane", ratio)
    assert not kept.exists()


def test_a_folder_that_cannot_be_written_is_no_fault(kept, case):
    kept.parent.mkdir()
    kept.parent.chmod(0o500)
    try:
        run_times.add("plane", 1.0)
        wall_time(case, derive(case))
    finally:
        kept.parent.chmod(0o700)
    if os.geteuid():  # root writes everywhere
        assert not kept.exists()
    kept.unlink(missing_ok=True)
    kept.parent.rmdir()
    kept.parent.write_text("a file where the folder would be")
    run_times.add("plane", 1.0)
    assert run_times.ratios_of("plane") == ()


def test_nothing_is_kept_or_asked_for_where_it_is_switched_off(kept, monkeypatch):
    run_times.add("plane", 1.0)
    monkeypatch.setenv("RYUSA_RUN_TIMES", "off")
    assert run_times.ratios_of("plane") == ()
    run_times.add("plane", 2.0)
    monkeypatch.delenv("RYUSA_RUN_TIMES")
    assert run_times.ratios_of("plane") == (1.0,)


def test_an_estimate_is_the_median_of_runs_of_the_kind_over_the_rule(kept, case):
    derived, steps = derive(case), 100_000
    rule = wall_time(case, derived)
    assert rule == wall_time_by_rule(case, derived)
    assert "no run of this kind yet on this machine" in rule.origin and "factor of 2" in rule.origin
    each = steps * seconds_per_step(case, derived)
    for ratio in (2.0, 1.0, 4.0):
        keep_wall_time(
            case, derived, steps, SECONDS_PER_RUN + ratio * each, derived.n_sphere, threads=1, engine="cpu"
        )
    found = wall_time(case, derived)
    assert found.stepping == pytest.approx(2.0 * rule.stepping, rel=1e-3)
    assert (found.runs, found.low, found.high) == (
        3,
        pytest.approx(0.5, rel=1e-3),
        pytest.approx(2.0, rel=1e-3),
    )
    assert found.origin.startswith("from 3 runs of this kind on this machine (plane, dry, ")
    assert found.origin.endswith("which took 0.5 to 2 of it")
    assert wall_time_by_rule(case, derived) == rule
    assert wall_time(case, derived, threads=2).stepping == pytest.approx(0.5 * rule.stepping)


def test_a_run_that_was_fed_for_a_while_counts_the_grains_that_were_there(kept):
    case = read(case_path("flume.toml"))
    derived, steps = derive(case), 10**6
    few = replace(derived, n_sphere=derived.n_sphere // 10)
    each = steps * seconds_per_step(case, few)
    keep_wall_time(case, derived, steps, SECONDS_PER_RUN + each, few.n_sphere, threads=1, engine="cpu")
    assert run_times.ratios_of(kind_of_run(case)) == (1.0,)


def test_a_run_of_less_than_three_seconds_tells_nothing(kept, case):
    keep_wall_time(case, derive(case), 10, 2.9, 500, threads=1, engine="cpu")
    assert not kept.exists()


def test_threads_engine_dimension_water_and_contacts_make_a_kind(case):
    others = [
        read(case_path(f"{name}.toml")) for name in ("dense_3d", "bedload_3d", "river", "weir", "saltation")
    ]
    kinds = {kind_of_run(one) for one in (case, *others)}
    kinds |= {kind_of_run(case, 2), kind_of_run(case, 1, "lammps")}
    kinds.add(kind_of_run(read(case_path("heap.toml"), {"contact.timing": "at steps"})))
    assert len(kinds) == 9


def test_a_run_keeps_its_time_and_check_study_and_progress_ask_for_it(kept, tmp_path, monkeypatch):
    monkeypatch.setattr("ryusa.casefile.wall_time.LEAST", 0.0)
    monkeypatch.setattr("ryusa.casefile.wall_time.SECONDS_PER_RUN", 0.0)  # or the clock decides what is kept
    short = {"stop.time": "0.4 s"}
    task = case_run(case_path("drop.toml"), short)
    assert basis_of([task]) == "by rule of thumb"
    case = task.read()
    ryusa.run(case, tmp_path / "run", progress=False)
    (ratio,) = run_times.ratios_of(kind_of_run(case))
    assert ratio > 0.0
    found = wall_time(case, derive(case))
    (row,) = [one for one in ryusa.casefile.explain(case) if one.name == "wall time"]
    assert row.value == found.seconds and row.origin == found.origin
    assert task.wall_time() == found and task.cost() == pytest.approx(found.stepping, abs=0.2)
    assert task.cost_by_rule() == pytest.approx(wall_time_by_rule(case, derive(case)).stepping, abs=0.2)
    assert basis_of([task]) == "as runs of the same kinds took on this machine"
    ryusa.run(case, tmp_path / "run", progress=False, resume=True)  # opened: nothing was stepped
    assert run_times.ratios_of(kind_of_run(case)) == (ratio,)
