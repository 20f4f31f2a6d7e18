"""`ryusa sweep --on dask`: a scheduler and two workers on the loopback of this machine."""

import json
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ryusa.cli import app
from ryusa.study import cluster, remote

sys.path.insert(0, str(Path(__file__).parent))
from sweeping import (
    OUT,
    STUDY,
    continued,
    finish,
    harmed,
    new_place,
    start,
    states,
    table,
    table_by_processes,
    under_way,
    wait_until,
    words,
)  # fmt: skip

pytestmark = pytest.mark.full

pytest.importorskip("distributed")


class Dask:
    """A scheduler and its workers, each a process of its own."""

    def __init__(self, folder):
        self.file, self.folder = folder / "scheduler.json", folder
        self.scheduler = self._start("scheduler", "--scheduler-file", self.file, "--port", "0")
        wait_until(self.file.is_file, self.scheduler)
        self.address = json.loads(self.file.read_text())["address"]
        self.workers = []

    def _start(self, kind, *more):
        near = ("--host", "127.0.0.1", "--no-dashboard", "--dashboard-address", "127.0.0.1:0")
        command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *near, *more]
        return subprocess.Popen(command, cwd=self.folder, stderr=subprocess.DEVNULL)

    def add_worker(self):
        self.workers.append(self._start("worker", self.address, "--nthreads", "1", "--no-nanny"))

    def close(self):
        for one in (*self.workers, self.scheduler):
            one.kill()
            one.wait()


def n_workers(dask):
    from distributed import Client

    with Client(dask.address, set_as_default=False) as client:
        return len(client.nthreads())


@pytest.fixture(scope="module")
def dask(tmp_path_factory):
    found = Dask(tmp_path_factory.mktemp("dask"))
    found.add_worker()
    found.add_worker()
    wait_until(lambda: n_workers(found) == 2)
    yield found
    found.close()


@pytest.fixture(scope="module")
def by_processes(tmp_path_factory):
    return table_by_processes(tmp_path_factory.mktemp("processes"))


def call(*more):
    return CliRunner().invoke(app, [*words(OUT), *map(str, more)])


def said(result):
    return " ".join(result.output.split())


@pytest.mark.slow
def test_ctrl_c_ends_remote_runs_with_a_checkpoint_and_a_killed_worker_costs_nothing(
    dask, by_processes, tmp_path
):
    place = new_place(tmp_path)
    first = start(place, "--on", f"dask:{dask.address}")
    wait_until(lambda: len(under_way(place)) == 2, first)
    first.send_signal(signal.SIGINT)
    code, text = finish(first)
    assert code == 130, text
    assert "The same command continues there" in text
    assert states(place) == ["stopped", "stopped"]  # at once: nothing goes on at the workers
    assert len(list(place.rglob("checkpoint.h5"))) == 2

    second = start(place, "--on", f"dask:{dask.address}")
    wait_until(lambda: "running" in states(place) and "complete" not in states(place), second)
    dask.workers[0].send_signal(signal.SIGKILL)
    dask.add_worker()
    code, text = finish(second)
    assert code == 0, text
    assert states(place) == ["complete"] * 4
    assert continued(place) >= 2
    assert table(place) == by_processes
    assert not harmed(tmp_path)


def test_a_study_gives_the_same_table_at_the_workers(dask, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "study.py").write_text(STUDY)
    tables = []
    for where in ("processes", f"dask:{dask.address}"):
        words = ("study", "mine", "--seeds", "2", "-q", "-o", where[:4], "--on", where, "-j", "1")
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, result.output
        tables.append((tmp_path / where[:4] / "mine" / "mine.csv").read_bytes())
    assert tables[0] == tables[1]
    assert tables[0].count(b"\n") == 3


def test_a_worker_that_differs_is_refused_before_any_run(dask, tmp_path, monkeypatch):
    monkeypatch.chdir(new_place(tmp_path))
    here = remote.versions()
    monkeypatch.setattr(remote, "versions", lambda: {**here, "numba": "0.1", "ryusa": "ryusa 9"})
    result = call("--on", f"dask:{dask.address}")
    assert result.exit_code == 2, result.output
    assert re.search(r"worker on \S+: it has ryusa \S.*, here ryusa 9; numba \S+, here 0.1", said(result))
    assert not list((tmp_path).rglob("case.json"))


def test_a_worker_that_does_not_see_the_folder_is_refused_before_any_run(dask, tmp_path, monkeypatch):
    place = new_place(tmp_path)
    monkeypatch.chdir(place)
    refuse = cluster._refuse_workers

    def of_another_disk(client, site):
        Path(site.probe).unlink()
        refuse(client, site)

    monkeypatch.setattr(cluster, "_refuse_workers", of_another_disk)
    result = call("--on", f"dask:{dask.address}")
    assert result.exit_code == 2, result.output
    assert "it does not see the folder" in said(result)
    assert "All workers must see it under the same path, on a shared disk" in said(result)
    assert not list(tmp_path.rglob("case.json"))


def test_a_scheduler_that_is_not_there_is_named(tmp_path, monkeypatch):
    monkeypatch.chdir(new_place(tmp_path))
    monkeypatch.setattr(cluster, "ANSWER", 0.5)
    result = call("--on", "dask:tcp://127.0.0.1:9")
    assert result.exit_code == 2
    assert "on = 'dask:tcp://127.0.0.1:9': no scheduler of dask answers there" in said(result)
    assert "such as dask:tcp://node1:8786" in said(call("--on", "dask"))
