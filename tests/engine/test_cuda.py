"""The CUDA engine: its tests run in numba's simulator, in their own process; its kernels become PTX here."""

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from benchmarks.card_kernels import (
    KINDS,
    LIMITS,
    Kernel,
    Resources,
    card_of,
    compile_kernel,
    kernels_of_kind,
    other_kernels,
)

from ryusa.engine import registry
from ryusa.errors import CaseError

pytest.importorskip("numba_cuda", reason="CUDA's compiler is an extra")
pytest.importorskip("numba.cuda")

HERE = Path(__file__).parent
CC = (8, 0)  # compute capability compiled for
# The shortest step and the fullest ones. The others are left to `make slow`: their laws become PTX one by one
# in tests/laws, and scenes of all kinds are run in the simulator.
SHOWN = (
    "dry, 3D",
    "elastic spheres, column, films, rolling, records",
    "exact timing, plane, records, may pull",
    "exact timing, column, films, rolling, records",
)


def in_simulator(*words: str) -> subprocess.CompletedProcess[str]:
    """Run this Python with the simulator for a card."""
    command = [sys.executable, *words]
    return subprocess.run(
        command, env=os.environ | {"NUMBA_ENABLE_CUDASIM": "1"}, cwd=HERE.parents[1], check=False,
        capture_output=True, text=True, timeout=1800,
    )  # fmt: skip


@pytest.mark.full
@pytest.mark.parametrize(
    "file, part",
    [("test_engines.py", "frozen"), ("test_engines.py", "not frozen"), ("on_cuda.py", "test")],
)
def test_the_engine_does_in_the_simulator_what_every_engine_does(file: str, part: str) -> None:
    done = in_simulator("-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", part, str(HERE / file))
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]


@pytest.mark.full
def test_the_program_for_a_card_fills_its_table_in_parts_and_does_no_row_twice(tmp_path: Path) -> None:
    program = (
        "benchmarks/card.py",
        "--simulated",
        "--kinds",
        "dry",
        "column",
        "--save",
        str(tmp_path / "card.json"),
    )
    none = in_simulator(*program, "--limit", "0")
    assert "left for the same command again: agreement, dry, twice, dry, agreement, column" in none.stdout
    first = in_simulator(*program, "--parts", "agreement", "twice")
    assert first.returncode == 0, first.stdout[-3000:] + first.stderr[-2000:]
    assert first.stdout.count('"same bits twice": true, "both sides alike": true') == 2
    assert first.stdout.count('"force agrees": true') == 2
    second = in_simulator(*program)
    assert second.returncode == 0, second.stdout[-3000:] + second.stderr[-2000:]
    assert "agrees" not in second.stdout
    rows = json.loads((tmp_path / "card.json").read_text())["rows"]
    assert rows["speed, column, 8"]["launches a step"] == rows["speed, dry, 8"]["launches a step"] == 2.0
    assert rows["speed, column, 8"]["ms an exchange"] > 0.0


@pytest.fixture
def card(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stand for the card that numba-cuda asks when one function calls another; nothing is run on it."""
    dispatcher = importlib.import_module("numba.cuda.dispatcher")
    monkeypatch.setattr(dispatcher, "get_current_device", card_of(CC))


def entry(kernel: Kernel) -> str:
    """PTX of a kernel, once it was assembled for a card and found to fit a block of its threads there."""
    pytest.importorskip("cuda.bindings.nvjitlink")
    ptx, taken = compile_kernel(kernel, CC)
    assert ".visible .entry" in ptx
    blocks, share = taken.occupancy(LIMITS[CC])
    assert blocks >= 1
    assert 0.0 < share <= 1.0
    return ptx


@pytest.mark.full
@pytest.mark.usefixtures("card")
@pytest.mark.parametrize(
    "kind", [one if one in SHOWN else pytest.param(one, marks=pytest.mark.slow) for one in KINDS]
)
def test_the_step_becomes_ptx_in_double_precision_without_racing_sums(kind: str) -> None:
    for kernel in kernels_of_kind(kind):
        ptx = entry(kernel)
        assert ".f64" in ptx
        for space in ("global", "shared", "local"):  # exp rounds an exponent in single, nothing is kept so
            assert f"{space}.f32" not in ptx
        assert "atom.global.add.f64" not in ptx  # no sum may depend on which thread comes first


@pytest.mark.full
@pytest.mark.usefixtures("card")
def test_every_other_kernel_becomes_ptx() -> None:
    from ryusa.engine.cuda import verlet_list

    names = set()
    for kernel in other_kernels():
        entry(kernel)
        names.add(kernel.name)
    compiled = importlib.import_module("numba.cuda.dispatcher").CUDADispatcher
    known = {name: one for name, one in vars(verlet_list).items() if isinstance(one, compiled)}
    closing = {"close", "close_kicks", "close_shear"}
    assert names == {name for name, one in known.items() if not one.targetoptions["device"]} | closing


def test_occupancy_follows_from_registers_threads_and_shared_memory() -> None:
    hopper = LIMITS[(9, 0)]
    assert Resources(32, 0, 0, 0, 128).occupancy(hopper) == (16, 1.0)  # all warps
    assert Resources(128, 0, 0, 0, 128).occupancy(hopper) == (4, 0.25)
    assert Resources(129, 0, 0, 0, 128).occupancy(hopper) == (3, 0.1875)  # 136 registers are given
    assert Resources(255, 0, 0, 0, 128).occupancy(hopper) == (2, 0.125)
    assert Resources(32, 0, 0, 100_000, 128).occupancy(hopper) == (2, 0.125)  # two blocks' shared memory


def test_a_numpy_that_numba_cuda_does_not_know_is_named_with_the_remedy(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from ryusa.engine.cuda import availability

    def fails(name: str) -> None:
        raise AttributeError(f"module 'numpy' has no attribute 'row_stack', which {name} asks for")

    monkeypatch.setattr(importlib.import_module("numba.cuda"), "gpus", [object()])
    monkeypatch.setattr(availability, "import_module", fails)
    reason = availability.unavailable()
    assert "does not go with numpy" in reason and "row_stack" in reason and "'numpy<2.5'" in reason


def test_without_a_gpu_one_line_says_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    from ryusa.engine.cuda import availability

    if availability.unavailable() == "":
        pytest.skip("there is a card")
    with pytest.raises(CaseError, match="engine = 'cuda': no CUDA driver answers"):
        registry.create("cuda")
    monkeypatch.setattr(availability, "find_spec", lambda name: None)
    assert availability.unavailable() == "the package numba-cuda is not installed: pip install 'ryusa[cuda]'"
