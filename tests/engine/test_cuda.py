"""The CUDA engine: its tests run in numba's simulator, in their own process; its kernels become PTX here."""

import importlib
import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from numba import types

from ryusa.engine import registry
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.errors import CaseError

pytest.importorskip("numba_cuda", reason="CUDA's compiler is an extra")
cuda = pytest.importorskip("numba.cuda")

HERE = Path(__file__).parent
CC = (8, 0)  # compute capability compiled for
DRY = LawChoice(*[0] * len(LawChoice._fields))
# every branch that a kernel may take, at least once
KINDS = {
    "dry, 3D": (KernelVariant(0, 1, 0, 0, 0, 0, 0, 0), DRY),
    "dry, plane, records of some, may pull": (
        KernelVariant(1, 1, 0, 1, 0, 0, 0, 0), DRY._replace(events=1, tension=1, slip=1),
    ),
    "no rotation": (KernelVariant(0, 0, 0, 0, 0, 0, 0, 0), DRY._replace(slip=2, cap=1)),
    "flow, rolling spring": (
        KernelVariant(0, 1, 1, 1, 0, 0, 1, 0),
        DRY._replace(rolling=3, arm=1, events=2, profile=1, above=2, drag=2, torque=2),
    ),
    "rolling as printed, film": (
        KernelVariant(0, 1, 1, 0, 0, 1, 1, 0),
        DRY._replace(rolling=1, profile=4, drag=4, torque=1, rebound=2),
    ),
    "column, rolling constant": (
        KernelVariant(0, 1, 1, 1, 1, 1, 1, 0),
        DRY._replace(
            rolling=2, events=2, profile=5, drag=4, torque=2, buoyancy=1, hindrance=5, lift=2, magnus=2,
            rebound=1,
        ),
    ),
    "exact timing, 3D": (KernelVariant(0, 1, 0, 0, 0, 0, 0, 1), DRY),
    "exact timing, plane, records, may pull": (
        KernelVariant(1, 1, 0, 1, 0, 0, 0, 1), DRY._replace(events=2, tension=1, slip=1),
    ),
    "exact timing, column, films, rolling, records": (
        KernelVariant(0, 1, 1, 1, 1, 1, 1, 1),
        DRY._replace(
            rolling=3, arm=1, events=2, profile=5, drag=4, torque=2, buoyancy=1, hindrance=5, lift=2,
            magnus=2, rebound=1, slip=2, cap=1,
        ),
    ),
}  # fmt: skip


def in_simulator(*words: str) -> subprocess.CompletedProcess[str]:
    """Run this Python with the simulator for a card."""
    command = [sys.executable, *words]
    return subprocess.run(
        command, env=os.environ | {"NUMBA_ENABLE_CUDASIM": "1"}, cwd=HERE.parents[1], check=False,
        capture_output=True, text=True, timeout=1800,
    )  # fmt: skip


@pytest.mark.parametrize(
    "file, part",
    [("test_engines.py", "frozen"), ("test_engines.py", "not frozen"), ("in_cuda_simulator.py", "test")],
)
def test_the_engine_does_in_the_simulator_what_every_engine_does(file: str, part: str) -> None:
    done = in_simulator("-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", part, str(HERE / file))
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]


def test_the_cuda_engine_runs_in_the_simulator() -> None:
    done = in_simulator("benchmarks/card.py", "--simulated")
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-2000:]
    assert '"same bits twice": true, "both sides alike": true' in done.stdout


@pytest.fixture
def card(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stand for the card that numba-cuda asks when one function calls another; nothing is run on it."""
    dispatcher = importlib.import_module("numba.cuda.dispatcher")
    monkeypatch.setattr(dispatcher, "get_current_device", lambda: SimpleNamespace(compute_capability=CC))


def entry(kernel, *arguments, threads=128):
    """PTX of a kernel, once it was assembled for a card and found to fit a block of so many threads there."""
    ptx, _ = cuda.compile(kernel.py_func, types.void(*arguments), device=False, abi="numba", cc=CC)
    assert ".visible .entry" in ptx
    links = pytest.importorskip("cuda.bindings.nvjitlink")
    link = links.create(2, ["-arch=sm_80", "-Xptxas=-v"])
    links.add_data(link, links.InputType.PTX, ptx.encode() + b"\0", len(ptx) + 1, "kernel")
    links.complete(link)
    said = bytearray(links.get_info_log_size(link))
    links.get_info_log(link, said)
    links.destroy(link)
    registers = max(map(int, re.findall(r"Used (\d+) registers", said.decode())))
    assert registers * threads <= 65_536
    return ptx


NUMBER, COUNT = types.float64, types.int64
F1, F2, F3 = (types.Array(NUMBER, dims, "C") for dims in (1, 2, 3))
I1, I4, I42, U1 = COUNT[::1], types.int32[::1], types.int32[:, ::1], types.uint8[::1]


def groups():
    from ryusa.engine.cuda.arrays import DeviceGrainArrays, DevicePairArrays, DeviceWallArrays

    return (
        types.NamedTuple((F3, F3, F3, F1, F1, F1, F1, I4, I42, U1, I42, F2, F2), DeviceGrainArrays),
        types.NamedTuple((F2, F2, U1), DeviceWallArrays),
        types.NamedTuple((I1, I4, U1, F2, F2), DevicePairArrays),
    )


@pytest.mark.usefixtures("card")
@pytest.mark.parametrize("kind", KINDS)
def test_the_step_becomes_ptx_in_double_precision_without_racing_sums(kind: str) -> None:
    from ryusa.engine.cuda.arrays import ON_CARD
    from ryusa.engine.cuda.step import make_step

    bodies, walls, pairs = groups()
    step = make_step(*KINDS[kind], ON_CARD)
    ptx = entry(step, COUNT, COUNT, COUNT, F1, I1, bodies, walls, pairs, F2, F1)
    assert ".f64" in ptx
    for space in (
        "global",
        "shared",
        "local",
    ):  # exp rounds an exponent in single precision, nothing is kept so
        assert f"{space}.f32" not in ptx
    assert "atom.global.add.f64" not in ptx  # no sum may depend on which thread comes first


@pytest.mark.usefixtures("card")
def test_every_other_kernel_becomes_ptx() -> None:
    from ryusa.engine.cuda import verlet_list
    from ryusa.engine.cuda.arrays import ON_CARD
    from ryusa.engine.cuda.step import make_close

    bodies, walls, pairs = groups()
    entry(make_close(ON_CARD), COUNT, COUNT, COUNT, F1, F1, I1, F1, F2, F2, threads=ON_CARD.closers)
    entry(verlet_list.fill, I1, COUNT)
    entry(verlet_list.wrap_grains, COUNT, F2, I42, I4, F1, F2, I1)
    entry(verlet_list.count_cells, I4, F2, F1, I1, I1, I1)
    entry(verlet_list.fill_cells, I4, I1, I1, I1, I4)
    entry(verlet_list.sort_cells, COUNT, I1, I4, I4)
    entry(verlet_list.sum_chunks, COUNT, I1, I1)
    entry(verlet_list.scan_chunks, COUNT, I1, I1)
    entry(verlet_list.reorder, COUNT, COUNT, I4, bodies, bodies, bodies)
    entry(verlet_list.copy_radii, COUNT, COUNT, bodies)
    entry(verlet_list.find_neighbours, COUNT, COUNT, COUNT, COUNT, F2, I4, walls, F1, I1, I1, I1, I4, I1, I4)
    counts = [COUNT] * 5
    entry(verlet_list.transfer_memory, *counts, F1, I4, bodies, I4, pairs, pairs, I1)
    entry(verlet_list.count_touching, COUNT, I4, pairs, I1)
    entry(verlet_list.collect_touching, COUNT, I4, pairs, I1, I1, I1, U1, F2, F2)


def test_without_a_gpu_one_line_says_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    from ryusa.engine.cuda import availability

    if availability.unavailable() == "":
        pytest.skip("there is a card")
    with pytest.raises(CaseError, match="engine = 'cuda': no CUDA driver answers"):
        registry.create("cuda")
    monkeypatch.setattr(availability, "find_spec", lambda name: None)
    assert availability.unavailable() == "the package numba-cuda is not installed: pip install 'ryusa[cuda]'"
