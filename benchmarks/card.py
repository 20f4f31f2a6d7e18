"""The CUDA engine on a card: is it right there, and how near does it come to the memory's own speed?

    python benchmarks/card.py [--grains 10000 100000 1000000 10000000] [--save FILE]
    python benchmarks/card.py --simulated          (no card: numba's simulator, few grains, nothing timed)

Right: at one frozen state forces agree with the CPU's to 1e-12 of the largest; two runs give the same bits;
both sides of every pair keep the same bits. Then a table: grains on a lattice between two fixed layers, three
touching pairs a grain, energy account and guards on. The share of bandwidth is the bytes that a step has to
ask for, by count, over its time, against what a kernel that copies an array reaches on the same card; what
the card's caches give twice counts twice.
"""

import argparse
import json
import os
import statistics
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

FROZEN, TWICE = 10_000, 200  # grains that are compared, and steps run twice
REPEATS = 5
# Bytes by count: a grain (three vectors in and out, masses, place in the list, contacts), a listed neighbour
# (place, mark, id, centre), a touching one (its velocity and spin, dashpots, memory in and out).
A_GRAIN, A_NEIGHBOUR, A_TOUCH = 252, 41, 209
COPIED = 2**27  # doubles of the copy


def pressed(n: int) -> Any:
    """About n grains on a lattice that presses, stirred a little."""
    from kernels import lattice, weightless

    scene, state = weightless(lattice(n, 0.9995, 0.0))
    stir = np.random.default_rng(1).normal(0.0, 1e-3, state.v.shape)
    from dataclasses import replace

    return scene, replace(state, v=stir, omega=1e3 * stir)


def agreement(n: int, warm: int) -> dict[str, Any]:
    """Largest difference of force and torque from the CPU's at one state, over the largest of one contact."""
    from ryusa.engine.cpu.engine import CpuEngine
    from ryusa.engine.cuda.engine import CudaEngine

    scene, state = pressed(n)
    cpu = CpuEngine()
    cpu.load(scene, state)
    cpu.advance(warm).raise_if_any()
    frozen, after = cpu.state(), []
    for engine in (CpuEngine(), CudaEngine()):
        engine.load(scene, frozen)
        engine.advance(1).raise_if_any()
        after.append(engine.state())
    held = after[0].contacts
    along = float(np.linalg.norm(held.spring_s + held.dash_s, axis=1).max())
    push, turn = float(np.abs(held.f_n).max()) / scene.m.min(), along * 0.5 * (scene.d / scene.inertia).max()
    found: dict[str, Any] = {"grains": scene.n_grain, "contacts": len(held)}
    for name, largest in (("force", push * scene.dt), ("torque", turn * scene.dt)):
        theirs, mine = (one.v if name == "force" else one.omega for one in after)
        # the change of a velocity is rounded at the size of the velocity
        noise = 4e-16 * np.abs(theirs).max()
        off = np.abs(mine - theirs).max()
        found[name] = float(max(off - noise, 0.0) / largest)
        found[f"{name} agrees"] = bool(off <= 1e-12 * largest + noise)
    return found


def sides(engine: Any) -> bool:
    """Whether both sides of every pair in touch keep the same bits."""
    store = engine._device
    start, partners, live, _, rows = (array.copy_to_host() for array in store.pairs)
    owner = np.repeat(np.arange(store.n), np.diff(start))
    partners, live, rows = (array[: start[-1]] for array in (partners, live, rows))
    both = (live == 1) & (partners < store.n)
    i, j, rows = owner[both], partners[both], rows[both, :8].view(np.int64)
    lower, upper = np.minimum(i, j), np.maximum(i, j)
    order = np.lexsort((upper, lower))
    pairs, rows = np.column_stack([lower, upper])[order], rows[order]
    even = len(pairs) % 2 == 0 and np.array_equal(pairs[::2], pairs[1::2])
    return bool(even and len(pairs) > 0 and np.array_equal(rows[::2], rows[1::2]))


def twice(n: int, steps: int) -> dict[str, Any]:
    """Whether two runs give the same bits, and both sides of each pair too."""
    from ryusa.engine.cuda.engine import CudaEngine

    made, found = pressed(n), []
    for _ in range(2):
        engine = CudaEngine(skin=0.02)
        engine.load(*made)
        engine.advance(steps).raise_if_any()
        state = engine.state()
        terms = np.array(state.tally.terms)
        kept = (state.x, state.v, state.omega, terms, state.contacts.spring_s, state.contacts.j)
        found.append(b"".join(np.ascontiguousarray(array).tobytes() for array in kept))
    return {"same bits twice": found[0] == found[1], "both sides alike": sides(engine), "steps": steps}


def bandwidth(size: int) -> float:
    """What copying an array moves [B/s]."""
    from numba import cuda

    @cuda.jit
    def copy(a: Any, b: Any) -> None:
        for k in range(cuda.grid(1), a.shape[0], cuda.gridsize(1)):
            b[k] = a[k]

    a, b = (cuda.to_device(np.zeros(size)) for _ in range(2))
    taken: list[float] = []
    for _ in range(REPEATS + 1):
        cuda.synchronize()
        begun = time.perf_counter()
        copy[4096, 256](a, b)
        cuda.synchronize()
        taken.append(time.perf_counter() - begun)
    return 16.0 * size / min(taken[1:])


def timed(n: int, copying: float) -> dict[str, Any]:
    """Steps of about n grains."""
    from numba import cuda

    from ryusa.engine.cuda.engine import CudaEngine

    scene, state = pressed(n)
    n = scene.n_grain
    engine = CudaEngine()
    engine.load(scene, state)
    free_before = cuda.current_context().get_memory_info().free
    engine.advance(20).raise_if_any()  # compiles
    steps = int(min(max(2e8 / n, 20), 2000))
    taken: list[float] = []
    for _ in range(REPEATS):
        cuda.synchronize()
        begun = time.perf_counter()
        engine.advance(steps).raise_if_any()
        taken.append((time.perf_counter() - begun) / steps)
    step, total = statistics.median(taken), cuda.current_context().get_memory_info().total
    listed, touching = engine._device.n_pair / n, 2.0 * engine.tally().n_contact / n
    asked = n * (A_GRAIN + A_NEIGHBOUR * listed + A_TOUCH * touching)
    return {
        "grains": n,
        "listed a grain": round(listed, 1),
        "touching a grain": round(touching, 1),
        "us a step": round(1e6 * step, 1),
        "million grain-steps/s": round(n / step / 1e6, 1),
        "GB/s asked for": round(asked / step / 1e9, 1),
        "share of copying": round(asked / step / copying, 3),
        "bytes a grain on the card": round((total - free_before) / n),
        "lists": engine._n_list,
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--grains", type=int, nargs="+", default=[10**k for k in (4, 5, 6, 7)])
    parser.add_argument("--simulated", action="store_true", help="numba's simulator; nothing is timed")
    parser.add_argument("--save", type=Path, help="JSON file for what is found")
    args = parser.parse_args()
    if args.simulated:  # before numba is loaded
        os.environ["NUMBA_ENABLE_CUDASIM"] = "1"
        sys.setswitchinterval(2e-5)
    from ryusa.engine.cuda.availability import device_name, unavailable

    if reason := unavailable():
        raise SystemExit(f"benchmarks/card.py: {reason}. --simulated tries the program without a card")
    rows: list[dict[str, Any]] = [{"card": device_name()}]
    rows.append(agreement(8, 5) if args.simulated else agreement(FROZEN, 20))
    rows.append(twice(8, 6) if args.simulated else twice(FROZEN, TWICE))
    for row in rows:
        print(json.dumps(row), flush=True)
    if not args.simulated:
        rows.append({"copying GB/s": round((copying := bandwidth(COPIED)) / 1e9, 1)})
        print(json.dumps(rows[-1]), flush=True)
        for n in args.grains:
            rows.append(timed(n, copying))
            print(json.dumps(rows[-1]), flush=True)
    if args.save:
        args.save.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    wrong = [name for row in rows for name, good in row.items() if good is False]
    if wrong:
        raise SystemExit(f"benchmarks/card.py: NOT {', NOT '.join(wrong)}")


if __name__ == "__main__":
    main()
