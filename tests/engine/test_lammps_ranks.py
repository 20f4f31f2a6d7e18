"""The LAMMPS engine shared by two processes, started by `mpirun`."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from tests.engine.lammps_across_ranks import D, in_a_column

from ryusa.engine import registry
from ryusa.results import Results

HERE = Path(__file__).parent
MISSING = registry.unavailable("lammps")
MPIRUN = shutil.which("mpirun", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}")

pytestmark = [
    pytest.mark.full,
    pytest.mark.skipif(MPIRUN is None, reason="there is no mpirun beside Python or on the path"),
    pytest.mark.skipif(bool(MISSING), reason=f"the engine is not available: {MISSING}"),
]

FLOW = [
    "contact.slip=total", "contact.cap=total", "contact.timing=at steps", "build.columns=5", "build.rows=5",
    "build.layers=3", "record.frames=5 ms", "record.settle=2 ms", "stop.time=20 ms",
]  # fmt: skip


def command(ranks, *words):
    alone = [sys.executable, *words]
    return alone if ranks == 1 else [MPIRUN, "-np", str(ranks), *alone]


def done(ranks, *words, code=0):
    found = subprocess.run(
        command(ranks, *words), cwd=HERE.parents[1], check=False, capture_output=True, text=True, timeout=600
    )
    assert found.returncode == code, found.stdout[-2000:] + found.stderr[-4000:]
    return found


@pytest.fixture
def flow(tmp_path):
    """The packaged dense flow, small and short, in a folder whose name a shell would read."""
    case = (HERE.parents[1] / "src/ryusa/cases/dense_3d.toml").read_text(encoding="utf-8")
    folder = tmp_path / "a \"b\" $(c) 'd'"
    folder.mkdir()
    (folder / "flow.toml").write_text(case.replace('at = "0.3 s"', 'at = "3 ms"'), encoding="utf-8")
    return folder


def words_for(folder, out, *more):
    settings = [word for one in (*FLOW, *more) for word in ("--set", one)]
    case = [str(folder / "flow.toml"), "--engine", "lammps", "-o", str(folder / out)]
    return ["-m", "ryusa", "run", *case, *settings]


@pytest.fixture(scope="module")
def closed_forms():
    """What one and two ranks find."""
    words = "-m", "tests.engine.lammps_across_ranks", "closed forms"
    return {ranks: json.loads(done(ranks, *words).stdout) for ranks in (1, 2)}


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_collision_across_the_border_at_50_steps_has_the_restitution_of_the_case(closed_forms, ranks):
    found = closed_forms[ranks]
    assert found["owners"] == [[0, ranks - 1]] * 8
    for springs in ("rebound", "elastic"):
        assert np.mean(found[springs]) == pytest.approx(0.7, abs=2e-3)
        assert found[springs] == pytest.approx([0.7] * 4, abs=1e-2)
        assert found[springs] == pytest.approx(closed_forms[1][springs], abs=1e-13)


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_sliding_grain_ends_rolling_at_five_sevenths_of_its_speed(closed_forms, ranks):
    found = closed_forms[ranks]
    assert found["slide owners"] == [[0, ranks - 1], [ranks - 1, ranks - 1]]
    assert found["speed"] == pytest.approx(0.2 * 5.0 / 7.0, rel=3e-4)
    assert found["surface"] == pytest.approx(found["speed"], rel=1e-3)
    assert found["still"] < 1e-6
    assert found["speed"] == pytest.approx(closed_forms[1]["speed"], rel=1e-10)


@pytest.mark.parametrize("ranks", [1, 2])
def test_grains_of_every_rank_fall_at_their_terminal_velocity(closed_forms, ranks):
    found = closed_forms[ranks]
    assert found["fall owners"] == [0, ranks - 1]
    for fall in found["fall"]:
        re = fall * D / 1e-6
        drag = 0.5 * 1000.0 * np.pi / 4.0 * D**2 * fall**2 * 24.0 / re * (1.0 + 0.15 * re**0.687)
        assert drag == pytest.approx(found["weight"], rel=1e-5)


@pytest.mark.parametrize("kind", ["dry", "elastic", "materials", "column"])
def test_contacts_across_the_border_are_those_of_one_rank(kind):
    one, two = (
        json.loads(done(ranks, "-m", "tests.engine.lammps_across_ranks", kind).stdout) for ranks in (1, 2)
    )
    assert one["n_contact"] > 2
    for name, found in one.items():
        if name != "restart":
            size = np.abs(np.array(found)).max(initial=0.0)
            assert np.array(two[name]) == pytest.approx(np.array(found), rel=1e-9, abs=1e-10 * size), name


def test_a_column_that_all_ranks_move_is_that_of_one_rank_and_of_the_cpu():
    # two-way, with eddies, a free surface, fixed grains, a change of slope and bed, and a resume
    one, two = (
        json.loads(done(ranks, "-m", "tests.engine.lammps_across_ranks", "two-way").stdout)
        for ranks in (1, 2)
    )
    cpu = in_a_column("cpu")
    assert cpu["n_contact"] > 2
    assert two["crossed"] > 5 and one["crossed"] == 0
    assert np.ptp(cpu["u"]) > 0.1 and np.abs(np.array(cpu["u"]) - cpu["u, later"]).max() > 0.01
    assert max(cpu["apart"].values()) == 0.0  # bit for bit
    assert two["n_contact"] == one["n_contact"]  # the CPU engine counts those of the last force evaluation
    for name in set(cpu) - {"apart", "crossed", "n_contact", "n_contact, later"}:
        size = max(np.abs(np.array(cpu[name])).max(initial=0.0), 1e-3)
        for found in (one, two):
            assert np.array(found[name]) == pytest.approx(np.array(cpu[name]), abs=1e-11 * size), name
            assert found["apart"][name.removesuffix(", later")] < 1e-11 * size


def test_a_run_of_two_ranks_has_the_frames_of_one_and_is_resumed_by_either(flow):
    for ranks, out in ((1, "one"), (2, "two")):
        said = done(ranks, *words_for(flow, out)).stderr
        assert said.count("complete: reached 0.02 s") == 1
        assert "a resume is not bit for bit" in said
    one, two = (Results.open(flow / out) for out in ("one", "two"))
    assert len(two.frames) == 5 and two.complete
    assert two.tally["overlap_max"][-1] > 1e-4
    assert two.provenance["device"].endswith("2 ranks of MPI")
    for k in range(5):
        assert two.frames.x[k] == pytest.approx(one.frames.x[k], abs=1e-9 * 2e-3)
        assert two.frames.v[k] == pytest.approx(one.frames.v[k], abs=1e-8)
    assert np.isnan(two.tally["residual"]).all() and (two.tally["kinetic"][1:] > 0.0).all()
    done(1, "-m", "ryusa", "resume", str(flow / "two"), "--set", "stop.time=25 ms")
    done(2, "-m", "ryusa", "resume", str(flow / "one"), "--set", "stop.time=25 ms")
    one, two = (Results.open(flow / out) for out in ("one", "two"))
    assert len(one.frames) == len(two.frames) == 6
    assert two.frames.x[5] == pytest.approx(one.frames.x[5], abs=1e-8 * 2e-3)
    told = done(1, "-m", "ryusa", "inspect", str(flow / "two")).stdout
    assert "goes on from its own restart: not bit for bit" in told


@pytest.mark.parametrize(
    "whom, number",
    [("mpirun", signal.SIGINT), ("mpirun", signal.SIGTERM), ("the second rank", signal.SIGTERM)],
)
def test_a_signal_to_any_of_them_ends_the_run_in_order(flow, whom, number):
    words = words_for(flow, "long", "stop.time=100 s", "record.frames=1 s")
    running = subprocess.Popen(
        command(2, *words), cwd=HERE.parents[1], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
    )
    for line in running.stderr:
        if "slope_angle" in line:  # the timeline of the first steps
            break
    target = running.pid if whom == "mpirun" else sorted(ranks_of(running.pid))[-1]
    os.kill(target, number)
    begun, rest = time.monotonic(), running.stderr.read()
    assert running.wait(60) == 5, rest
    assert time.monotonic() - begun < 60.0
    assert rest.count("checkpoint written at step") == 1
    assert Results.open(flow / "long").status == "stopped"


def ranks_of(mpirun):
    """Processes of Python under a process."""
    found, waiting = [], [mpirun]
    while waiting:
        parent = waiting.pop()
        children = Path(f"/proc/{parent}/task/{parent}/children").read_text(encoding="utf-8").split()
        waiting += [int(one) for one in children]
        found += [
            int(one) for one in children
            if b"-m\0ryusa" in (text := Path(f"/proc/{one}/cmdline").read_bytes()) and b"mpirun" not in text
        ]  # fmt: skip
    return found


NOT_FINITE = r"is not finite: grain \d+, step \d+, t = .* s\. Most likely the step is too long"


@pytest.mark.parametrize(
    "kind, case, said",
    [
        ("place", "flow", NOT_FINITE),
        ("speed", "stream", NOT_FINITE),
        ("program", "flow", r"rank 1 failed: MemoryError: no room for a list"),
    ],
)
def test_an_error_of_the_second_rank_alone_ends_both_with_one_message(flow, kind, case, said):
    words = words_for(flow, "broken", "stop.time=100 s", "record.frames=1 s")[2:]
    if case == "stream":
        path = str(HERE.parents[1] / "src/ryusa/cases/bedload_3d.toml")
        settings = [word for one in FLOW[:3] for word in ("--set", one)]
        words = ["run", path, "--engine", "lammps", "-o", str(flow / "broken"), *settings]
    told = done(2, "-m", "tests.engine.lammps_across_ranks", "broken", kind, *words, code=3).stderr
    assert re.search(said, told) and told.count("ryusa: ") == 1, told
    left = Results.open(flow / "broken")
    assert left.status == "failed" and re.search(said, left.provenance["message"])
    assert len(left.frames) == 1 and np.isfinite(left.frames.x[0]).all()
    assert left.summary["steps"] > 0


def test_an_error_of_the_case_or_of_the_grains_is_one_message(flow):
    said = done(2, *words_for(flow, "wrong", "contact.slip=spring"), code=2).stderr
    assert said.count("contact.slip='total' would be carried") == 1
    assert not (flow / "wrong").exists()
    said = done(2, *words_for(flow, "deep", "domain.overlap_limit=0.00001"), code=3).stderr
    assert said.count("ryusa: overlap is") == 1
    assert Results.open(flow / "deep").status == "failed"
