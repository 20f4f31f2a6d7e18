import io
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.model import State
from ryusa.results import Results, schema
from ryusa.running import disk, vtkhdf
from ryusa.running import recorder as recorder_module
from ryusa.running.record_buffer import bytes_per_frame
from ryusa.running.recorder import Recorder, buffer_limit, flush_after

WRITER = """
import json, os, sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
import numpy as np
from conftest import make_event, make_scene, make_tally
from ryusa.model import State
from ryusa.running import vtkhdf
from ryusa.running.recorder import Recorder

vtkhdf.SUBINDEX_PARTS = 3
folder = Path(sys.argv[1])
folder.mkdir()
scene = make_scene(4)
(folder / "provenance.json").write_text(json.dumps({"format": 2, "ryusa": "0", "status": "running"}))
recorder = Recorder(folder, scene)
for k in range(100_000):
    x = k + np.arange(12.0).reshape(4, 3) / 16
    state = State(x=x, v=-x, omega=2 * x, step=k, t=k * 1e-3, image=np.zeros((4, 2), np.int32))
    recorder.frame(state, make_tally(k * 1e-3))
    recorder.contacts(make_event(1, 5, k * 1e-3, k * 1e-3 + 1e-4))
    if k % 3 == 0:
        recorder.flush()
        print(recorder.n_frame, flush=True)
"""


@pytest.fixture
def writer(tmp_path: Path) -> Any:
    """A process that writes frames as fast as it can; x = frame number + grain's own offset."""
    (tmp_path / "writer.py").write_text(WRITER)
    running: list[subprocess.Popen[str]] = []

    def begin(name: str) -> "tuple[subprocess.Popen[str], Path]":
        command = [
            sys.executable,
            str(tmp_path / "writer.py"),
            str(tmp_path / name),
            str(Path(__file__).parent),
        ]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        running.append(process)
        assert process.stdout is not None
        assert process.stdout.readline() == "1\n"
        return process, tmp_path / name

    yield begin
    for process in running:
        process.kill()
        process.wait()


def check_frames(folder: Path, at_least: int) -> int:
    """Every flushed frame is right through `Results`, plain h5py and, where there, vtk."""
    results = Results.open(folder)
    n = len(results.frames)
    assert n >= at_least
    offsets = np.arange(12.0).reshape(4, 3) / 16
    assert np.array_equal(results.frames.x[:], np.arange(n)[:, None, None] + offsets)
    with h5py.File(folder / schema.GRAINS, "r", locking=False) as file:
        steps = file["ryusa/step"][:]
        points = file["VTKHDF/Points"][:].reshape(-1, 4, 3)
        events = file["ryusa/contacts"][:]
    assert len(steps) >= at_least
    assert np.array_equal(steps, np.arange(len(steps)))
    assert np.array_equal(points, steps[:, None, None] + offsets)
    assert np.array_equal(events["t_begin"], steps * 1e-3)
    return min(n, len(steps))  # between a part and the index that names it a reader may look


@pytest.mark.full
def test_after_sigkill_at_any_moment_every_flushed_frame_is_readable(writer: Any) -> None:
    rng = np.random.default_rng(7)
    running = [writer(f"run{k}") for k in range(2)]
    for k in range(10):
        process, folder = running.pop(0)
        time.sleep(rng.uniform(0.0, 0.08))
        process.kill()
        told = process.stdout.read().split("\n")[:-1]
        process.wait()
        check_frames(folder, at_least=int(told[-1]) if told else 1)
        assert len(vtk_frames(folder / schema.GRAINS, [0])) == 1
        if k < 8:
            running.append(writer(f"run{k + 2}"))


def test_a_run_is_readable_while_it_writes(writer: Any) -> None:
    process, folder = writer("run")
    seen = 0
    for _ in range(15):
        seen = check_frames(folder, at_least=max(seen, 1))
    assert process.poll() is None
    assert seen > 1


def vtk_frames(path: Path, steps: list[int]) -> list[dict[str, Any]]:
    """What vtkHDFReader finds at some steps."""
    pytest.importorskip("vtkmodules")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    found: list[dict[str, Any]] = []
    for step in steps:
        reader.SetStep(step)
        reader.Update()
        out = reader.GetOutput()
        data = out.GetPointData()
        arrays = {
            data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)).copy()
            for k in range(data.GetNumberOfArrays())
        }
        found.append(
            {
                "t": reader.GetTimeValue(),
                "n_step": reader.GetNumberOfSteps(),
                "n_vert": out.GetNumberOfVerts(),
                "n_poly": out.GetNumberOfPolys(),
                "points": vtk_to_numpy(out.GetPoints().GetData()).copy(),
                **arrays,
            }
        )
    return found


@pytest.fixture
def recorder(tmp_path: Path, scene: Any) -> Recorder:
    (tmp_path / "provenance.json").write_text('{"format": 2, "ryusa": "0", "status": "running"}')
    return Recorder(tmp_path, scene)


def moment(k: int, n: int = 3) -> State:
    x = np.random.default_rng(k).random((n, 3)) + k
    return State(x=x, v=x / 3, omega=-x, step=10 * k, t=k / 8, image=np.full((n, 2), k, np.int32))


def test_paraview_reads_time_points_velocity_and_sizes(
    recorder: Recorder, tally: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for k in range(7):
        recorder.frame(moment(k), tally(k / 8))
        if k in {0, 3, 4}:
            recorder.flush()
    recorder.flush()
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    for k, found in enumerate(vtk_frames(tmp_path / schema.GRAINS, list(range(7)))):
        assert found["n_step"] == 7
        assert found["t"] == k / 8
        assert found["n_vert"] == 3
        assert np.array_equal(found["points"], moment(k).x)
        assert np.array_equal(found["velocity"], moment(k).v)
        assert np.array_equal(found["spin"], moment(k).omega)
        assert np.array_equal(found["diameter"], np.full(3, 2e-3))
        assert found["id"].tolist() == [0, 1, 2]


def test_a_run_folder_can_be_moved(recorder: Recorder, tally: Any, tmp_path: Path) -> None:
    recorder.frame(moment(0), tally())
    recorder.flush()
    moved = tmp_path.with_name(tmp_path.name + "-moved")
    os.rename(tmp_path, moved)
    assert np.array_equal(vtk_frames(moved / schema.GRAINS, [0])[0]["points"], moment(0).x)
    with h5py.File(moved / schema.GRAINS) as file:
        assert np.array_equal(file["VTKHDF/Points"][:], moment(0).x)
    assert np.array_equal(Results.open(moved).frames.x_wrapped[0], moment(0).x)


def test_paraview_shows_the_bed_and_that_a_gate_goes(
    recorder: Recorder, scene_with: Any, tmp_path: Path
) -> None:
    before = vtk_frames(tmp_path / schema.BED, [0])[0]
    assert (before["n_vert"], before["n_poly"]) == (2, 1)
    assert before["diameter"].tolist() == [2e-3] * 2 + [0.0] * 4
    assert before["id"].tolist() == [3, 4] + [5] * 4
    assert np.ptp(before["points"][2:, 2]) == 0.0
    recorder.scene(scene_with(fixed_active=np.array([False, True])), 100, 0.5)
    early, late = vtk_frames(tmp_path / schema.BED, [0, 1])
    assert early["id"].tolist() == before["id"].tolist()
    assert late["t"] == 0.5
    assert late["id"].tolist() == [4] + [5] * 4
    assert (late["n_vert"], late["n_poly"]) == (1, 1)


def test_a_scene_without_bed_and_planes_is_recorded_too(tmp_path: Path, scene_with: Any, tally: Any) -> None:
    none = np.zeros((0, 3))
    empty = {"d_fixed": np.zeros(0), "fixed_active": np.zeros(0, bool), "plane_active": np.zeros(0, bool)}
    bare = scene_with(x_fixed=none, plane_normal=none, plane_point=none, **empty)
    (tmp_path / "provenance.json").write_text('{"format": 2, "status": "running"}')
    recorder = Recorder(tmp_path, bare)
    recorder.frame(moment(0), tally())
    recorder.flush()
    assert Results.open(tmp_path).bed.x.shape == (0, 3)


def test_contacts_between_frames_are_kept_without_a_frame(
    recorder: Recorder, tally: Any, event: Any, tmp_path: Path
) -> None:
    recorder.frame(moment(0), tally())
    recorder.flush()
    recorder.contacts(event(0, 4, 0.3, 0.4))
    recorder.contacts(event(1, 2, 0.1, 0.2))
    recorder.flush()
    assert not recorder.flush()
    results = Results.open(tmp_path)
    assert results.contacts["t_part"].tolist() == [0.2, 0.4]
    assert len(results.frames) == 1
    assert vtk_frames(tmp_path / schema.GRAINS, [0])[0]["n_step"] == 1


def test_a_part_is_written_when_enough_has_gathered(
    recorder: Recorder, tally: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder_module, "_BUFFER", 2.5 * bytes_per_frame(3))
    written = []
    for k in range(9):
        recorder.frame(moment(k), tally())
        written.append(recorder.flush_if_due())
    recorder.settle()
    assert written == [False, False, True] * 3
    assert len(list((tmp_path / "parts").glob("part-*"))) == 3


def test_parts_are_written_by_the_clock(
    tmp_path: Path, scene: Any, tally: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder_module, "write_index", lambda *_: 0)
    now = [0.0]
    recorder = Recorder(tmp_path, scene, clock=lambda: now[0])
    written = []
    for k in range(600):
        now[0] = float(k)
        recorder.frame(moment(k % 5), tally())
        written.append(recorder.flush_if_due())
    at = np.flatnonzero(written)
    assert np.all(np.diff(at[at < 200]) == 2)
    assert np.all(np.diff(at[at > 400]) >= 5)


def test_an_index_with_subindices_shows_every_frame_and_names_few_files(
    recorder: Recorder, tally: Any, event: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(vtkhdf, "SUBINDEX_PARTS", 3)
    for k in range(11):
        recorder.frame(moment(k), tally(k))
        recorder.contacts(event(1, 5, k * 1e-3, k * 1e-3 + 1e-4))
        recorder.flush()
    assert len(list((tmp_path / "parts").glob("subindex-*"))) == 3
    with h5py.File(tmp_path / schema.GRAINS, "r") as file:
        sources = {one.file_name for one in file["VTKHDF/Points"].virtual_sources()}
        assert len(sources) == 3 + 2
        assert file["ryusa/step"][:].tolist() == [moment(k).step for k in range(11)]
        assert file["ryusa/tally"]["t"].tolist() == list(range(11))
        assert len(file["ryusa/contacts"]) == 11
    monkeypatch.chdir("/")  # where the reader stands does not matter
    shown = vtk_frames(tmp_path / schema.GRAINS, list(range(11)))
    for k, frame in enumerate(shown):
        assert np.array_equal(frame["points"], moment(k).x)


def test_parts_stay_few_however_long_a_run_takes() -> None:
    t, n = 0.0, 0
    while t < 7 * 86400.0:
        t += flush_after(t, n)
        n += 1
    assert n < 1000
    assert buffer_limit(0) == 64 << 20
    assert buffer_limit(10_000) == 1 << 28
    assert flush_after(0.0, 0) == 2.0
    assert flush_after(86400.0, 100) == 60.0


def test_a_full_disk_is_one_clear_error_and_spares_what_is_there(
    recorder: Recorder, tally: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recorder.frame(moment(0), tally())
    recorder.flush()
    recorder.frame(moment(1), tally())

    def full(path: Path) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(disk, "sync", full)
    with pytest.raises(ResultsError, match="No space left on device"):
        recorder.flush()
    assert len(Results.open(tmp_path).frames) == 1
    monkeypatch.undo()
    recorder.flush()
    assert len(Results.open(tmp_path).frames) == 2


def test_large_deliveries_of_contacts_are_written_as_they_came(
    recorder: Recorder, tally: Any, event: Any, tmp_path: Path
) -> None:
    one = event(0, 4, 0.0, 0.1)
    pieces = [np.repeat(one, n) for n in (3000, 2000, 1)]
    for k, piece in enumerate(pieces):
        piece["t_part"] = k + np.arange(len(piece)) / len(piece)
        recorder.contacts(piece)
    recorder.frame(moment(0), tally())
    recorder.flush()
    with h5py.File(tmp_path / "parts" / "part-000000.h5") as file:
        assert np.array_equal(file["contacts"][:], np.concatenate(pieces))


def test_a_disk_that_fills_up_within_a_part_is_an_error_after_hdf5_has_closed_it() -> None:
    class Narrow(io.BytesIO):
        def write(self, data: Any) -> int:
            if self.tell() + len(data) > 100_000:
                raise OSError(28, "No space left on device")
            return super().write(data)

    def fill(file: h5py.File) -> None:
        for name in "abc":
            file.create_dataset(name, data=np.arange(10_000.0))

    with pytest.raises(OSError, match="No space left"):
        disk.hdf5_file(fill)(Narrow())
    wide = io.BytesIO()
    disk.hdf5_file(fill)(wide)
    with h5py.File(wide) as file:
        assert all(np.array_equal(file[name][:], np.arange(10_000.0)) for name in "abc")
