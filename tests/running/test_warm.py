"""What is compiled ahead is what a run asks for, and nothing but compiled code is left."""

import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from tests.running.conftest import DROP

from ryusa.casefile import derive, read_text
from ryusa.errors import CaseError
from ryusa.running import warm as warm_module
from ryusa.running.warm import warm

CASE = DROP.replace("0.01 s", "0.4 s")
CHANGES = '[[timeline]]\nat = "0.1 s"\nrotation = "free"\n[[timeline]]\nat = "0.3 s"\nslope = 0.1\n'
ASK = """
import sys
from ryusa.compiled import waiting
from ryusa.running.runner import run
from ryusa.running.warm import warm
warm(sys.argv[1])
print(warm(sys.argv[1]).functions)
before = waiting.done()
run(sys.argv[1], sys.argv[2], progress=False)
print(waiting.done().since(before).functions)
"""


@pytest.mark.full
def test_a_run_after_it_compiles_nothing(tmp_path):
    """In the store of all tests, where most is there: to compile anew takes long."""
    case = tmp_path / "case.toml"
    case.write_text(CASE)
    done = subprocess.run(
        [sys.executable, "-c", ASK, str(case), str(tmp_path / "run")], check=True, capture_output=True,
        text=True,
    )  # fmt: skip
    assert done.stdout.split() == ["0", "0"]


def test_entries_of_the_timeline_follow_each_other_and_no_folder_is_left(tmp_path, monkeypatch):
    begun: list[tuple[list[int], int, Path]] = []

    def run_scene(scene, state, folder, *, frames, stop, changes, **more):
        steps = [round(one.at / scene.dt) for one in changes]
        begun.append((steps, round(stop.time / scene.dt), folder))
        for one in changes:
            scene = one.apply(scene)
        assert scene.rotation and scene.gravity[0] > 0.0

    monkeypatch.setattr(warm_module, "run_scene", run_scene)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert warm(read_text(CASE + CHANGES)).functions == 0
    ((first, second), end, folder) = begun[0][0], begun[0][1], begun[0][2]
    assert 0 < first < second < end and second - first == first
    assert folder.is_relative_to(tmp_path) and list(tmp_path.iterdir()) == []


def test_feeds_begin_with_the_run():
    from ryusa.build import build
    from ryusa.casefile.read import read
    from ryusa.cases import case_path

    case = read(case_path("poured_heap.toml"))
    scene = build(case, derive(case)).scene
    fed = warm_module._fed_at_once(scene)
    assert scene.traffic is not None and fed.traffic is not None
    assert all(one.begin == 0.0 for one in fed.traffic.feeds) and fed.traffic.interval < 10


def test_a_case_that_cannot_be_run_is_refused(tmp_path):
    with pytest.raises(CaseError):
        warm(read_text(CASE.replace("0.7", "1.7")))
