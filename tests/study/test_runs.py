import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from ryusa.casefile import resolved
from ryusa.errors import CaseError, NotANumber, ResultsError
from ryusa.running import runner
from ryusa.study import CostEstimate, Plan, ProgressLines, StudyProgress, estimate_cost, executors
from ryusa.study import carry_out as carry_out_tasks
from ryusa.study import cost as cost_module
from ryusa.study import runs as runs_module
from ryusa.study.executors import executor_of
from ryusa_studies.osada2004._parts import paper_run

SHORT = {"stop.time": "0.01 s", "record.settle": "0 s"}


class Fake:
    """An experiment of two short runs."""

    FIGURE = TITLE = "fake"
    CLAIMS = ("fig20", "fig20-shear")

    def __init__(self, trouble=None, seeds=(1, 2)):
        self.trouble, self.seeds = trouble, seeds

    def tasks(self, plan):
        del plan
        return [paper_run("saltation", SHORT, seed) for seed in self.seeds]

    def measure(self, run, one):
        if self.trouble is not None and one.get("seed") == "2":
            raise self.trouble
        return len(run.frames)


@pytest.fixture
def fakes():
    return {}


def carry_out(known, names, plan, folder, **how):
    return carry_out_tasks(
        {name: known[name].tasks(plan) for name in names}, known.__getitem__, folder, **how
    )


def test_an_interrupted_study_continues_where_it_stopped(fakes, tmp_path):
    fakes["one"] = Fake(KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt):
        carry_out(fakes, ("one",), Plan(), tmp_path)
    fakes["one"] = Fake()
    second = carry_out(fakes, ("one",), Plan(), tmp_path)
    assert second.n_opened == 2  # the interrupt came while the second was measured, its run was finished
    assert second.n_run == 0
    assert len(second.found["one"]) == 2
    assert carry_out(fakes, ("one",), Plan(), tmp_path, again=True).n_run == 2


def test_a_damaged_or_unfinished_run_is_made_anew(fakes, tmp_path):
    fakes["one"] = Fake()
    carry_out(fakes, ("one",), Plan(), tmp_path)
    first, second = (tmp_path / one.folder for one in fakes["one"].tasks(Plan()))
    about = first / "provenance.json"
    about.write_text(about.read_text().replace('"complete"', '"running"'))
    shutil.rmtree(second)
    assert carry_out(fakes, ("one",), Plan(), tmp_path).n_run == 2


def test_an_error_in_one_part_does_not_affect_the_others(fakes, tmp_path):
    fakes["good"], fakes["bad"] = Fake(), Fake(ResultsError("no hop at all"))
    found = carry_out(fakes, ("good", "bad"), Plan(), tmp_path)
    assert found.n_run == 2
    assert len(found.found["good"]) == 2
    assert len(found.found["bad"]) == 1
    assert list(found.problems.values()) == ["bad: no hop at all"]


def test_an_error_in_the_program_affects_only_its_part(fakes, tmp_path):
    fakes["good"], fakes["bad"] = Fake(), Fake(IndexError("list index out of range"))
    found = carry_out(fakes, ("good", "bad"), Plan(), tmp_path)
    assert len(found.found["good"]) == 2
    assert set(found.missing) == {"bad"}
    (fault,) = found.missing["bad"].values()
    assert "error in the program: IndexError: list index out of range (test_runs.py, line" in fault.words
    assert "in measure)" in fault.words
    assert fault.trace.startswith("Traceback")
    assert list(found.problems.values()) == [f"bad: {fault.words}"]
    fakes["bad"] = Fake()
    assert carry_out(fakes, ("good", "bad"), Plan(), tmp_path).n_opened == 2  # repaired: nothing is run again


def test_a_result_that_cannot_be_sent_does_not_affect_the_others(fakes, tmp_path, monkeypatch):
    fakes["one"] = Fake()

    def answer(one, *_, **__):
        if one.get("seed") == "2":
            raise TypeError("cannot pickle a generator")
        return runs_module.TaskResult(one, {"one": 1}, False, 1.0)

    monkeypatch.setattr(runs_module, "_one", answer)
    monkeypatch.setattr(executors, "ProcessPoolExecutor", lambda jobs, **_: ThreadPoolExecutor(jobs))
    found = carry_out(fakes, ("one",), Plan(), tmp_path, jobs=2)
    assert len(found.found["one"]) == 1
    assert [one.get("seed") for one in found.missing["one"]] == ["2"]
    assert "cannot pickle" in next(iter(found.problems.values()))


def test_a_run_stopped_before_its_end_continues_from_its_checkpoint(fakes, tmp_path, monkeypatch):
    from ryusa.running import loop

    fakes["one"] = Fake(seeds=(1,))
    advance = loop.Loop._advance

    def stopped(self, n_steps):
        advance(self, n_steps)
        self._signal.stop = "the test"

    with monkeypatch.context() as patch:
        patch.setattr(loop.Loop, "_advance", stopped)
        with pytest.raises(KeyboardInterrupt):
            carry_out(fakes, ("one",), Plan(), tmp_path)
    assert carry_out(fakes, ("one",), Plan(), tmp_path).n_run == 1
    about = next(tmp_path.glob("*/*/provenance.json"))
    assert [one["step"] for one in json.loads(about.read_text())["resumed"]] == [1]
    carry_out(fakes, ("one",), Plan(), tmp_path, again=True)
    assert "resumed" not in json.loads(about.read_text())


def test_only_a_failed_run_is_repeated(fakes, tmp_path, monkeypatch):
    fakes["both"], fakes["first"] = Fake(), Fake(seeds=(1,))
    real = runner.run

    def breaks(case, *words, **how):
        if case.seed == 2:
            raise NotANumber("force is no number", grain=3, step=7, t=0.1, hint="Take shorter steps")
        return real(case, *words, **how)

    monkeypatch.setattr(runner, "run", breaks)
    found = carry_out(fakes, ("both", "first"), Plan(), tmp_path)
    assert len(found.found["first"]) == 1
    assert set(found.missing) == {"both"}
    assert "grain 3" in next(iter(found.problems.values()))
    assert not any(one.trace for one in found.missing["both"].values())  # no error in the program
    monkeypatch.setattr(runner, "run", real)
    second = carry_out(fakes, ("both", "first"), Plan(), tmp_path)
    assert (second.n_run, second.n_opened) == (1, 1)
    assert len(second.found["both"]) == 2
    assert not second.problems


def test_a_run_that_fails_while_stepping_is_not_finished(fakes, tmp_path):
    limit = {**SHORT, "domain.overlap_limit": "1e-9", "stop.time": "0.3 s"}
    fakes["one"] = Fake(seeds=())
    fakes["one"].tasks = lambda _: [paper_run("saltation", SHORT), paper_run("saltation", limit)]
    for opened in (0, 1):
        found = carry_out(fakes, ("one",), Plan(), tmp_path)
        assert found.n_opened == opened
        assert len(found.found["one"]) == 1
        assert "overlap" in next(iter(found.problems.values()))


def test_an_error_in_the_handling_of_a_failed_run_is_reported(fakes, tmp_path, monkeypatch):
    def breaks(*_, **__):
        raise NotANumber("force is no number", grain=3, step=7, t=0.1, hint="Take shorter steps")

    def wrong(_):
        raise ValueError("no answer")

    fakes["answers"], fakes["errs"] = Fake(seeds=(1,)), Fake(seeds=(1,))
    fakes["answers"].failed, fakes["errs"].failed = str, wrong
    monkeypatch.setattr(runner, "run", breaks)
    found = carry_out(fakes, ("answers", "errs"), Plan(), tmp_path)
    assert "grain 3" in next(iter(found.found["answers"].values()))
    assert set(found.missing) == {"errs"}
    assert "ValueError: no answer" in next(iter(found.problems.values()))


def test_runs_that_do_not_fit_on_the_disk_are_refused_before_the_first(fakes, tmp_path, monkeypatch):
    fakes["one"] = Fake()
    monkeypatch.setattr(cost_module, "free_bytes", lambda _: 1000)
    with pytest.raises(CaseError, match=r"2 runs need .* only 1 kB are free"):
        carry_out(fakes, ("one",), Plan(), tmp_path / "deep" / "er")
    assert not list(tmp_path.iterdir())


def test_the_estimate_counts_finished_runs_and_is_no_shorter_than_the_longest_run(tmp_path):
    runs = [paper_run("saltation", SHORT, seed) for seed in range(1, 4)]
    carry_out({}, (), Plan(), tmp_path)
    ahead = estimate_cost([*runs, runs[0]], tmp_path, jobs=2)
    assert len(ahead.costs) == 3
    assert ahead.seconds == pytest.approx(ahead.core_seconds / 2)
    assert estimate_cost(runs, tmp_path, jobs=100).seconds == pytest.approx(max(ahead.costs.values()))
    assert "3 runs to make: about" in str(ahead)
    finished(tmp_path, runs[0], "a" * 40)
    later = estimate_cost(runs, tmp_path, jobs=2)
    assert later.there == (runs[0],)
    assert "(1 more are there and will be opened)" in str(later)
    assert len(estimate_cost(runs, tmp_path, jobs=2, again=True).costs) == 3


def finished(place, one, commit, seed=None):
    """Leave what the outlook reads of a finished run; of another case where a seed is given."""
    folder = place / one.folder
    folder.mkdir(parents=True, exist_ok=True)
    about = {"status": "complete", "commit": commit, "ryusa": "0.0.1"}
    (folder / "provenance.json").write_text(json.dumps(about))
    case = paper_run(one.case, SHORT, seed) if seed else one
    (folder / "case.json").write_text(json.dumps(resolved(case.read())))


def test_a_folder_that_holds_another_case_is_run_again(tmp_path):
    runs = [paper_run("saltation", SHORT, seed) for seed in (1, 2)]
    finished(tmp_path, runs[0], "a" * 40, seed=7)
    finished(tmp_path, runs[1], "a" * 40)
    assert estimate_cost(runs, tmp_path, jobs=1).there == (runs[1],)


def test_one_run_of_each_case_comes_first_and_then_the_longest():
    costs = {paper_run("saltation", {"stop.time": f"{k} s"}, 1): float(k) for k in (2, 4)}
    costs |= {paper_run("drop", {"stop.time": f"{k} s"}, 1): float(k) for k in (1, 3, 5)}
    order = runs_module._order(CostEstimate(costs, (), 0, 2))
    assert [costs[one] for one in order] == [5.0, 4.0, 3.0, 2.0, 1.0]
    dear = {one: 10.0 * cost if "drop" in one.folder else cost for one, cost in costs.items()}
    assert [costs[one] for one in runs_module._order(CostEstimate(dear, (), 0, 2))] == [
        5.0,
        4.0,
        3.0,
        1.0,
        2.0,
    ]


def test_the_estimate_lists_runs_of_other_states_of_the_code(tmp_path, monkeypatch):
    monkeypatch.setattr(cost_module, "commit", lambda: "c" * 40)
    runs = [paper_run("saltation", SHORT, seed) for seed in range(1, 7)]
    for one, commit in zip(runs, ["c" * 40, "a" * 40, "a" * 40, "c" * 40 + "+", None], strict=False):
        finished(tmp_path, one, commit)
    ahead = estimate_cost(runs, tmp_path, jobs=1)
    assert len(ahead.there) == 5
    assert ahead.others == {"a" * 40: 2, "c" * 40 + "+": 1, "ryusa 0.0.1": 1}
    said = str(ahead)
    assert "than the present cccccccccccc made 4 of the 5 that are there (2 by aaaaaaaaaaaa, " in said
    assert "1 by cccccccccccc with changes" in said
    assert "--again makes all anew" in said
    assert "anew" not in str(
        estimate_cost(runs[:1], tmp_path, jobs=1)
    )  # nothing of other code, nothing to say


def test_a_study_counts_the_runs_of_other_states_of_the_code(fakes, tmp_path, monkeypatch):
    fakes["one"] = Fake()
    carry_out(fakes, ("one",), Plan(), tmp_path)
    about = next(tmp_path.glob("*/*/provenance.json"))
    changed = json.loads(about.read_text()) | {"commit": "a" * 40}
    about.write_text(json.dumps(changed))
    monkeypatch.setattr(cost_module, "commit", lambda: "c" * 40)
    found = carry_out(fakes, ("one",), Plan(), tmp_path)
    assert found.n_opened == 2
    assert found.others["a" * 40] == 1
    assert found.commits["a" * 40] == 1


def test_rolling_friction_is_included_in_the_cost():
    rolls = {"rolling.model": "constant", "rolling.coefficient": "0.1"}
    assert paper_run("fig19", rolls).cost() > 1.5 * paper_run("fig19").cost()


def test_the_remaining_time_follows_from_the_finished_runs(capsys):
    now = [0.0]
    runs = [paper_run("saltation", SHORT, seed) for seed in range(1, 5)]
    say = ProgressLines(clock=lambda: now[0])
    say.begin(CostEstimate(dict.fromkeys(runs, 10.0), (), 10**6, 2), Path())
    assert say.left() == pytest.approx(20.0)
    say.started(runs[0])
    say.started(runs[1])
    now[0] = 20.0  # twice as slow as thought
    say.done(runs[0], 20.0, opened=False, problem="")
    say.done(runs[1], 20.0, opened=False, problem="grain 7 lost")
    assert say.left() == pytest.approx(20.0)
    say.started(runs[2])
    now[0] = 35.0
    assert say.left() == pytest.approx(20.0)  # the last one has not begun
    say.tick()
    said = capsys.readouterr()
    assert said.out == ""
    assert "2/4 runs, about 20 s left, now: saltation 0 s 3 0.01 s" in said.err
    assert "grain 7 lost" in said.err


def test_a_study_that_asks_for_more_runs_counts_them_anew(capsys):
    now = [0.0]
    runs = [paper_run("saltation", SHORT, seed) for seed in range(1, 7)]
    say = ProgressLines(clock=lambda: now[0])
    for wave in (runs[:4], runs[4:]):
        say.begin(CostEstimate(dict.fromkeys(wave, 10.0), (), 10**6, 1), Path())
        for one in wave:
            say.started(one)
            say.lost(one)  # its process was ended from outside: it is tried again, and counts once
            say.started(one)
            now[0] += 20.0
            say.tick()
            say.done(one, 20.0, opened=False, problem="")
        say.end()
    counts = re.findall(r"(\d+)/(\d+) runs", capsys.readouterr().err)
    assert [(int(n), int(of)) for n, of in counts] == [(0, 4), (1, 4), (2, 4), (3, 4), (0, 2), (1, 2)]


def test_a_bar_of_more_runs_stands_alone(monkeypatch):
    say = ProgressLines()
    monkeypatch.setattr(say._console, "_force_terminal", True)
    runs = [paper_run("saltation", SHORT, seed) for seed in (1, 2)]
    for one in runs:
        say.begin(CostEstimate({one: 10.0}, (), 10**6, 1), Path())
        assert [(task.completed, task.total) for task in say._bar.tasks] == [(0, 1)]
        say.started(one)
        say.done(one, 1.0, opened=False, problem="")
        say.end()


def test_without_progress_output_nothing_else_is_needed(fakes, tmp_path):
    fakes["one"] = Fake(seeds=(1,))
    assert carry_out(fakes, ("one",), Plan(), tmp_path, progress=StudyProgress()).n_run == 1


# -------------------------------------------------------------------------------------------------- signals


def family(group):
    """Processes of a group that are alive, with their command lines."""
    found = {}
    for place in Path("/proc").glob("[0-9]*"):
        try:
            stat = (place / "stat").read_text().rsplit(")", 1)[1].split()
            if int(stat[2]) == group and stat[0] != "Z":
                found[int(place.name)] = (place / "cmdline").read_text().replace("\0", " ")
        except OSError:
            continue
    return found


@pytest.fixture
def campaign(tmp_path):
    """A campaign of two runs at a time, while both are running."""
    hears = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"  # a CI job may not
    words = ["-c", f"{hears}; from ryusa.cli import main; main()", "paper", "fig20", "--quick", "-j", "2"]
    words += ["--seeds", "8"]  # enough runs that some are still under way when the first two are seen
    process = subprocess.Popen(
        [sys.executable, *words, "-o", tmp_path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
    )  # fmt: skip
    for _ in range(600):
        if len(list(tmp_path.glob("runs/*/*/log.txt"))) >= 2:
            break
        assert process.poll() is None, process.communicate()
        time.sleep(0.1)
    yield process
    if family(process.pid):
        os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


def gone(pid):
    """Whether every process of the group ends, a moment for the system to clear up given."""
    for _ in range(100):
        if not family(pid):
            return True
        time.sleep(0.1)
    return False


needs_proc = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")


@pytest.mark.full
@needs_proc
@pytest.mark.parametrize("how", ["ctrl-c", "term"])
def test_an_interrupt_ends_every_process_and_says_how_to_continue(campaign, how):
    if how == "ctrl-c":
        os.killpg(campaign.pid, signal.SIGINT)  # a terminal tells the whole group
    else:
        campaign.terminate()
    _, said = campaign.communicate(timeout=30)
    assert campaign.returncode == 130
    assert "The same command continues there" in said
    assert "Traceback" not in said
    assert gone(campaign.pid)


@pytest.mark.full
@needs_proc
def test_a_run_whose_process_was_killed_is_tried_once_more_and_costs_no_other(campaign):
    workers = [one for one, words in family(campaign.pid).items() if "spawn_main" in words]
    os.kill(workers[0], signal.SIGKILL)
    _, said = campaign.communicate(timeout=600)
    assert "its process was ended from outside; it is tried once more, by itself" in said
    assert "could not be carried out" not in said
    assert campaign.returncode == 0
    assert gone(campaign.pid)


DEADLY = """import os
import signal


def measure(run, one):
    if one.get("seed") == "2":
        os.kill(os.getpid(), signal.SIGKILL)  # as the kernel does where memory is short
    return len(run.frames)


def load(name):
    import deadly_part
    return deadly_part
"""


@pytest.mark.full
def test_a_run_that_ends_its_process_every_time_costs_no_other(tmp_path, monkeypatch):
    (tmp_path / "deadly_part.py").write_text(DEADLY)  # a module that processes of their own can import
    monkeypatch.syspath_prepend(tmp_path)
    from importlib import import_module

    tasks = {"one": Fake(seeds=(1, 2, 3)).tasks(Plan())}
    found = carry_out_tasks(tasks, import_module("deadly_part").load, tmp_path / "runs", jobs=2)
    assert sorted(one.get("seed") for one in found.found["one"]) == ["1", "3"]
    assert [one.get("seed") for one in found.missing["one"]] == ["2"]
    assert "ended from outside twice" in next(iter(found.problems.values()))


@pytest.mark.full
@needs_proc
def test_no_process_outlives_a_killed_study(campaign):
    campaign.kill()
    campaign.wait(timeout=30)
    for _ in range(300):
        if not family(campaign.pid):
            break
        time.sleep(0.1)
    assert not family(campaign.pid)


def test_the_remaining_time_weighs_runs_by_their_cost_and_by_what_is_still_running(tmp_path):
    now = [0.0]
    long, *short = (paper_run("saltation", SHORT, seed) for seed in range(1, 22))
    say = ProgressLines(clock=lambda: now[0])
    say.begin(CostEstimate({long: 100.0, **dict.fromkeys(short, 1.0)}, (), 10**6, 2), tmp_path)
    say.started(long)
    for one in short:
        say.started(one)
        now[0] += 1.0
        say.done(one, 1.0, opened=False, problem="")
    assert say.left() == pytest.approx(80.0)  # not the 100/20 of its neighbours
    now[0] = 120.0  # late, and it does not tell how far it is: never nearly done
    assert say.left() > 10.0
    (tmp_path / long.folder).mkdir(parents=True)
    end = long.read().stop.time
    (tmp_path / long.folder / "summary.json").write_text(json.dumps({"t": 0.25 * end, "saltations": [0]}))
    say.tick()
    assert say.left() == pytest.approx(360.0)  # a quarter took 120 s


def test_a_run_that_goes_on_tells_its_share(tmp_path):
    one = paper_run("saltation", SHORT, 1)
    assert one.share(tmp_path) is None
    (tmp_path / "summary.json").write_text("{")
    assert one.share(tmp_path) is None
    (tmp_path / "summary.json").write_text(json.dumps({"t": one.read().stop.time / 2, "saltations": [0]}))
    assert one.share(tmp_path) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("name", "jobs", "said"),
    [("proceses", 2, "on = 'proceses'.*Did you mean 'processes'"), ("processes", 0, "jobs = 0: must be 1")],
)
def test_an_unknown_executor_is_refused_with_the_nearest_one(name, jobs, said):
    with pytest.raises(CaseError, match=said):
        executor_of(name, jobs)
