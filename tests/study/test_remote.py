"""A call in a process of its own, as a worker of a cluster carries it out."""

import json
import os
import pickle
import signal
import threading
import time
from concurrent.futures import BrokenExecutor
from pathlib import Path

import pytest

from ryusa.errors import ResultsError
from ryusa.study import remote
from ryusa.study.remote import Site, WorkerError, in_process, packed_site, unpacked
from ryusa.study.user import open_study

pytestmark = pytest.mark.full


@pytest.fixture
def site(tmp_path):
    (tmp_path / "probe").write_text("token")
    (tmp_path / "a.toml").write_text("x = 1")
    files = {str(tmp_path / "a.toml"): remote.digest_of(tmp_path / "a.toml")}
    return Site(str(tmp_path), str(tmp_path / "probe"), "token", files, remote.versions())


def changed(site, **values):
    return Site(**{**vars(site), **values})


def call(site, function, *given, wanted=lambda: True):
    return unpacked(in_process(packed_site(site), pickle.dumps((function, given)), wanted))


def test_a_call_has_the_working_directory_of_the_client_and_one_thread(site, tmp_path):
    assert call(site, os.getcwd) == str(tmp_path)
    assert call(site, os.getenv, "NUMBA_NUM_THREADS") == "1"
    assert call(site, os.getpid) != os.getpid()


def test_what_a_call_prints_is_no_part_of_its_answer_and_an_error_is_raised_here(site):
    assert call(site, print, "anything") is None
    with pytest.raises(ZeroDivisionError):
        call(site, divmod, 1, 0)
    with pytest.raises(ResultsError, match="nowhere: there is no such folder"):
        call(site, open_study, Path("nowhere"))


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"versions": {"numba": "0.1"}}, r"it has numba \S+, here 0.1. Results are the same only with"),
        ({"probe": "nowhere/probe"}, "it does not see the folder nowhere. All workers must see it"),
        ({"place": "/nowhere at all"}, "it does not see the folder /nowhere at all, in which the command"),
        ({"token": "another"}, "it sees another folder as "),
        ({"files": {"b.toml": "12"}}, "it has no file b.toml, or another one"),
    ],
)
def test_a_worker_that_differs_from_the_client_is_refused_by_name(site, values, expected):
    with pytest.raises(WorkerError, match=rf"^worker on \S+: {expected}"):
        call(changed(site, **values), os.getpid)


def test_a_call_that_is_no_longer_wanted_is_ended(site, monkeypatch):
    tried: list[bool] = []
    monkeypatch.setattr(remote, "_try_elsewhere", lambda: tried.append(True))
    begun = time.monotonic()
    late = begun + 3.0
    with pytest.raises(BrokenExecutor):
        call(site, time.sleep, 600.0, wanted=lambda: time.monotonic() < late)
    assert tried == [True]  # handed back, and not counted as a failure
    assert not remote._under_way


def test_a_process_that_is_killed_breaks_its_call_alone(site):
    def kill():
        while not remote._under_way:
            time.sleep(0.05)
        next(iter(remote._under_way)).send_signal(signal.SIGKILL)

    threading.Thread(target=kill).start()
    with pytest.raises(BrokenExecutor, match="ended with code -9"):
        call(site, time.sleep, 600.0)
    assert call(site, abs, -1) == 1


def test_the_site_is_one_line(site):
    assert "\n" not in packed_site(changed(site, place="a\nb"))
    assert Site(**json.loads(packed_site(site))) == site


def test_a_study_whose_file_changes_under_way_is_refused(site, tmp_path):
    (tmp_path / "study.py").write_text('"""A."""\ntasks = measure = print\n')
    study = open_study(tmp_path)
    assert call(site, study.claims, "any") == ()
    (tmp_path / "study.py").write_text('"""B."""\ntasks = measure = print\n')
    with pytest.raises(ResultsError, match=r"study\.py: has changed since the study began"):
        call(site, study.claims, "any")
