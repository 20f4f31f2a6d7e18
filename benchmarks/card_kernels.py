"""The kernels of the CUDA engine as their compiler sees them: no card and no driver is asked for.

    python benchmarks/card_kernels.py [--cc 9.0] [--save FILE]

Every kernel becomes PTX and is assembled for a card of compute capability `--cc` (9.0: H100 and H200).
Registers, stack, spilled and shared bytes are the assembler's own words; the blocks that share a
multiprocessor follow from them and from the limits of the card (`LIMITS`).
"""

import argparse
import importlib
import json
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

from numba import types

from ryusa.engine.shared.variant import KernelVariant, LawChoice

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
    "column": (
        KernelVariant(0, 1, 0, 0, 1, 0, 1, 0),
        DRY._replace(profile=5, drag=4, torque=2, buoyancy=1, hindrance=5, lift=2),
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
    "elastic spheres, 3D": (KernelVariant(0, 1, 0, 0, 0, 0, 0, 0, hertz=1), DRY),
    "elastic spheres, column, films, rolling, records": (
        KernelVariant(0, 1, 1, 1, 1, 1, 1, 0, hertz=1),
        DRY._replace(
            rolling=3, arm=1, events=2, profile=5, drag=4, torque=2, buoyancy=1, hindrance=5, lift=2,
            magnus=2, rebound=1, slip=2, cap=1, unloading=1,
        ),
    ),
    "exact timing, column, films, rolling, records": (
        KernelVariant(0, 1, 1, 1, 1, 1, 1, 1),
        DRY._replace(
            rolling=3, arm=1, events=2, profile=5, drag=4, torque=2, buoyancy=1, hindrance=5, lift=2,
            magnus=2, rebound=1, slip=2, cap=1,
        ),
    ),
}  # fmt: skip

NUMBER, COUNT = types.float64, types.int64
F1, F2, F3 = (types.Array(NUMBER, dims, "C") for dims in (1, 2, 3))
I1, I4, I42, U1 = COUNT[::1], types.int32[::1], types.int32[:, ::1], types.uint8[::1]


class Limits(NamedTuple):
    """What one multiprocessor has (NVIDIA, CUDA C++ Programming Guide, technical specifications)."""

    warps: int
    blocks: int
    registers: int
    shared: int  # [B]
    a_block: int  # shared memory that the system takes from each block [B]


LIMITS = {(8, 0): Limits(64, 32, 65_536, 167_936, 1024), (9, 0): Limits(64, 32, 65_536, 233_472, 1024)}
_WARP, _REGISTERS_AT_ONCE = 32, 256  # threads of a warp; registers are given to warps by so many


class Resources(NamedTuple):
    """What one kernel takes."""

    registers: int  # of a thread
    stack: int  # of a thread, its local arrays among it [B]
    spilled: int  # of a thread, stores and loads [B]
    shared: int  # of a block [B]
    threads: int  # of a block

    def occupancy(self, limits: Limits) -> tuple[int, float]:
        """Blocks that share a multiprocessor, and their warps over the most that it can have."""
        warps = -(-self.threads // _WARP)
        a_warp = -(-self.registers * _WARP // _REGISTERS_AT_ONCE) * _REGISTERS_AT_ONCE
        blocks = min(
            limits.warps // warps,
            limits.blocks,
            limits.registers // (a_warp * warps),
            limits.shared // (self.shared + limits.a_block),
        )
        return blocks, blocks * warps / limits.warps


class Kernel(NamedTuple):
    """A kernel with the types of its arguments and how it is launched."""

    name: str
    text: Any
    arguments: tuple[Any, ...]
    threads: int
    shared: int  # asked for at the launch [B]


def groups() -> tuple[Any, Any, Any]:
    """Types of grains, planes and pairs."""
    from ryusa.engine.cuda.arrays import DeviceGrainArrays, DevicePairArrays, DeviceWallArrays

    return (
        types.NamedTuple((F3, F3, F3, F1, F1, F1, F1, I4, I42, U1, I42, F2, F2), DeviceGrainArrays),
        types.NamedTuple((F2, F2, U1), DeviceWallArrays),
        types.NamedTuple((I1, I4, U1, F2, F2), DevicePairArrays),
    )


def step_kernel(kind: str) -> Kernel:
    """The step of one kind of scene."""
    from ryusa.engine.cuda.arrays import ON_CARD
    from ryusa.engine.cuda.step import make_step

    bodies, walls, pairs = groups()
    arguments = (COUNT, COUNT, F1, I1, bodies, walls, pairs, F2, F1)
    return Kernel(
        f"step: {kind}", make_step(*KINDS[kind], ON_CARD), arguments, ON_CARD.threads,
        8 * ON_CARD.shared_doubles,
    )  # fmt: skip


def shear_kernel(kind: str) -> Kernel:
    """What grains do between the kicks of one kind of scene with exact timing."""
    from ryusa.engine.cuda import step_totals as T
    from ryusa.engine.cuda.arrays import ON_CARD
    from ryusa.engine.cuda.shear import make_shear

    bodies, walls, pairs = groups()
    arguments = (COUNT, COUNT, F1, I1, F1, bodies, walls, pairs, F1)
    return Kernel(
        f"shear: {kind}", make_shear(*KINDS[kind], ON_CARD), arguments, ON_CARD.threads,
        8 * ON_CARD.threads * T.N_OF_SHEAR,
    )  # fmt: skip


def kernels_of_kind(kind: str) -> Iterator[Kernel]:
    """Those that step one kind of scene."""
    yield step_kernel(kind)
    if KINDS[kind][0].exact:
        yield shear_kernel(kind)


def other_kernels() -> Iterator[Kernel]:
    """The kernels that close a step, and those of the search."""
    from ryusa.engine.cuda import step_totals as T
    from ryusa.engine.cuda import verlet_list
    from ryusa.engine.cuda.arrays import ON_CARD
    from ryusa.engine.cuda.shear import make_close_kicks, make_close_shear
    from ryusa.engine.cuda.step import make_close

    bodies, walls, pairs = groups()
    closing = COUNT, COUNT, F1, F1, I1, F1, F2, F2
    for name, make, arguments, columns in (
        ("close", make_close, closing, T.N_COLUMN),
        ("close_kicks", make_close_kicks, closing, T.N_COLUMN),
        ("close_shear", make_close_shear, closing[:-1], T.N_OF_SHEAR),
    ):
        yield Kernel(name, make(ON_CARD), arguments, ON_CARD.closers, 8 * ON_CARD.segments * columns)
    for name, arguments in (
        ("fill", (I1, COUNT)),
        ("wrap_grains", (COUNT, F2, I42, I4, F1, F2, I1)),
        ("count_cells", (I4, F2, F1, I1, I4, I4)),
        ("fill_cells", (I4, I4, I4, I4, I4)),
        ("sort_cells", (COUNT, I4, I4, I4)),
        ("sum_chunks", (COUNT, I1, I1)),  # of pairs; then of cells
        ("scan_chunks", (COUNT, I1, I1)),
        ("sum_chunks", (COUNT, I4, I1)),
        ("scan_chunks", (COUNT, I4, I1)),
        ("reorder", (COUNT, COUNT, I4, F2, bodies, bodies)),
        ("copy_radii", (COUNT, COUNT, bodies)),
        (
            "find_neighbours",
            (COUNT, COUNT, COUNT, COUNT, F2, I4, walls, F1, I1, I4, I4, I4, I1, I4),
        ),
        ("set_springs_in_touch", (COUNT, COUNT, COUNT, COUNT, F1, bodies, pairs)),
        ("transfer_memory", (*[COUNT] * 5, F1, I4, bodies, pairs, pairs, I1)),
        ("count_touching", (COUNT, I4, pairs, I1)),
        ("hold_touching", (COUNT, I4, pairs, pairs)),
        ("collect_touching", (COUNT, I4, pairs, I1, I1, I1, U1, F2, F2)),
    ):
        yield Kernel(name, getattr(verlet_list, name), arguments, ON_CARD.threads, 0)


def card_of(cc: tuple[int, int]) -> Any:
    """What stands for the card that numba-cuda asks when one function calls another; nothing runs on it."""
    return lambda: SimpleNamespace(compute_capability=cc)


def compile_kernel(kernel: Kernel, cc: tuple[int, int]) -> tuple[str, Resources]:
    """PTX of a kernel, and what it takes once it is assembled for a card."""
    from cuda.bindings import nvjitlink
    from numba import cuda

    ptx, _ = cuda.compile(
        kernel.text.py_func, types.void(*kernel.arguments), device=False, abi="numba", cc=cc
    )
    link = nvjitlink.create(2, [f"-arch=sm_{cc[0]}{cc[1]}", "-Xptxas=-v"])
    nvjitlink.add_data(link, nvjitlink.InputType.PTX, ptx.encode() + b"\0", len(ptx) + 1, "kernel")
    nvjitlink.complete(link)
    log = bytearray(nvjitlink.get_info_log_size(link))
    nvjitlink.get_info_log(link, log)
    nvjitlink.destroy(link)
    said = log.decode()

    def largest(pattern: str) -> int:
        return max(map(int, re.findall(pattern, said)))

    spilled = sum(map(int, re.findall(r"(\d+) bytes spill", said)))
    return ptx, Resources(
        largest(r"Used (\d+) registers"), largest(r"(\d+) bytes stack frame"), spilled, kernel.shared,
        kernel.threads,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cc", default="9.0", choices=[f"{a}.{b}" for a, b in LIMITS])
    parser.add_argument("--save", type=Path, help="JSON file for the table")
    args = parser.parse_args()
    major, minor = args.cc.split(".")
    cc = (int(major), int(minor))
    dispatcher: Any = importlib.import_module("numba.cuda.dispatcher")
    dispatcher.get_current_device = card_of(cc)
    rows: list[dict[str, Any]] = []
    for kernel in (*chain.from_iterable(map(kernels_of_kind, KINDS)), *other_kernels()):
        _, taken = compile_kernel(kernel, cc)
        blocks, share = taken.occupancy(LIMITS[cc])
        found = taken._asdict() | {"blocks a multiprocessor": blocks, "occupancy": share}
        rows.append({"kernel": kernel.name} | found)
        print(json.dumps(rows[-1]), flush=True)
    if args.save:
        args.save.write_text(json.dumps({"cc": args.cc, "kernels": rows}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
