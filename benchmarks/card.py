"""The CUDA engine on a card: is it right there, and how near does it come to the memory's own speed?

    python benchmarks/card.py [--parts agreement twice speed] [--kinds dry column exact]
                              [--grains 10000 100000 1000000 10000000] [--save FILE] [--limit SECONDS]
    python benchmarks/card.py --simulated          (numba's simulator: few grains, times mean nothing)

Rows are kept in FILE as they are found; a row that is there is not done again, so that the table may be made
in several commands, or go on after one was cut off. A part that would not end within the limit, judged by the
one before, is left for the next command, which is then asked for.

agreement: at one frozen state forces agree with the CPU's to 1e-12 of the largest. twice: two runs give the
same bits, and both sides of every pair keep the same bits. speed: grains on a lattice between two fixed
layers, three touching pairs a grain, energy account and guards on; with the bytes that a step asks for, by
count (card_cost.py), over what a kernel that copies an array reaches on the same card, and the time of the
two kernels of a step by themselves. What the card's caches give twice counts twice.
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

PARTS = ("agreement", "twice", "speed")
KINDS = ("dry", "column", "exact")
FROZEN, TWICE = 10_000, 200  # grains that are compared, and steps run twice
REPEATS, PROFILED = 5, 20  # timings of a row; steps whose kernels are timed one by one
WORK = 2e8  # grain-steps of one timing
COPIED = 2**27  # doubles of the copy
SLOWER = 12.0  # times that ten times the grains take, at most
EIGHT = 8.0  # steps per contact with exact timing


def pressed(n: int, kind: str) -> Any:
    """About n grains on a lattice that presses, stirred a little, without weight: scene and state."""
    import workloads
    from kernels import lattice

    from ryusa.build import scene
    from ryusa.laws.families import Buoyancy, Cap, ContactTiming, Drag, Hindrance, Lift, Profile, Slip
    from ryusa.laws.families import WaterTorque as Torque
    from ryusa.model import ContactLaw, Water
    from ryusa.model.scene import Damping, EventRule

    grains, rng = lattice(n, 0.9995, 0.0), np.random.default_rng(1)
    exact = kind == "exact"
    law = ContactLaw(
        k_n=workloads.K_N, k_s=workloads.K_S, mu=workloads.MU, damping=Damping.CONSTANTS,
        eta_n=workloads.ETA_N, eta_s=workloads.ETA_S, slip=Slip.TOTAL, cap=Cap.TOTAL,
        timing=ContactTiming.EXACT if exact else ContactTiming.AT_STEPS,
    )  # fmt: skip
    water = Water(
        profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, hindrance=Hindrance.DI_FELICE,
        buoyancy=Buoyancy.STRESS, lift=Lift.SAFFMAN_MEI, torque=Torque.DENNIS,
    )  # fmt: skip
    stir = rng.normal(0.0, 1e-3, grains.x.shape)
    return scene(
        grains.x, grains.d, density=workloads.DENSITY, v=stir, omega=1e3 * stir, x_fixed=grains.x_fixed,
        d_fixed=grains.d_fixed, contact=law, gravity=0.0, period=grains.period,
        dt=None if exact else workloads.DT, steps_per_contact=EIGHT, events=EventRule.NONE,
        allow_overlap=True, water=water if kind == "column" else None,
    )  # fmt: skip


def loaded(engine: Any, made: Any) -> Any:
    """The engine with a scene and, where it has a column, with water at every grain."""
    from ryusa.laws.families import Profile
    from ryusa.model.fluid import N_SAMPLED, PHI, SHEAR, SUBMERGED, U

    engine.load(*made)
    if made[0].water.profile == Profile.COLUMN:
        sampled = np.zeros((made[0].n_grain, N_SAMPLED))
        sampled[:, U], sampled[:, SHEAR], sampled[:, PHI], sampled[:, SUBMERGED] = 0.01, 1.0, 0.5, 1.0
        engine.set_fluid(sampled)
    return engine


def agreement(n: int, kind: str, warm: int) -> dict[str, Any]:
    """Largest difference of force and torque from the CPU's at one state, over the largest of one contact."""
    from ryusa.engine.cpu.engine import CpuEngine
    from ryusa.engine.cuda.engine import CudaEngine

    scene, state = pressed(n, kind)
    cpu = loaded(CpuEngine(), (scene, state))
    cpu.advance(warm).raise_if_any()
    frozen, after = cpu.state(), []
    for engine in (CpuEngine(), CudaEngine()):
        loaded(engine, (scene, frozen)).advance(1).raise_if_any()
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
    """Whether both sides of every pair in contact keep the same bits."""
    store = engine._device
    start, partners, live, _, rows = (array.copy_to_host() for array in store.pairs)
    owner = np.repeat(np.arange(store.n), np.diff(start))
    partners, live, rows = (array[: start[-1]] for array in (partners, live, rows))
    both = (live != 0) & (partners < store.n)
    i, j, rows = owner[both], partners[both], rows[both, :8].view(np.int64)
    lower, upper = np.minimum(i, j), np.maximum(i, j)
    order = np.lexsort((upper, lower))
    pairs, rows = np.column_stack([lower, upper])[order], rows[order]
    even = len(pairs) % 2 == 0 and np.array_equal(pairs[::2], pairs[1::2])
    return bool(even and len(pairs) > 0 and np.array_equal(rows[::2], rows[1::2]))


def twice(n: int, kind: str, steps: int) -> dict[str, Any]:
    """Whether two runs give the same bits, and both sides of each pair too."""
    from ryusa.engine.cuda.engine import CudaEngine

    made, found = pressed(n, kind), []
    for _ in range(2):
        engine = loaded(CudaEngine(skin=0.02), made)
        engine.advance(steps).raise_if_any()
        state = engine.state()
        terms = np.array(state.tally.terms)
        kept = (state.x, state.v, state.omega, terms, state.contacts.spring_s, state.contacts.j)
        found.append(b"".join(np.ascontiguousarray(array).tobytes() for array in kept))
    return {"same bits twice": found[0] == found[1], "both sides alike": sides(engine), "steps": steps}


class TimedKernel:
    """A kernel in place of one of an engine, whose launches are counted and timed to their ends."""

    def __init__(self, kernel: Any) -> None:
        self._kernel, self.launches, self.seconds = kernel, 0, 0.0

    def __getitem__(self, shape: Any) -> Any:
        from numba import cuda

        kernel = self._kernel[shape]

        def launch(*arguments: Any) -> None:
            cuda.synchronize()
            begun = time.perf_counter()
            kernel(*arguments)
            cuda.synchronize()
            self.seconds += time.perf_counter() - begun
            self.launches += 1

        return launch


def profile(engine: Any, steps: int) -> dict[str, Any]:
    """Launches of a step, and time of its two kernels, host's part of a launch included."""
    kept = engine._step_kernel, engine._close_kernel
    step, close = engine._step_kernel, engine._close_kernel = TimedKernel(kept[0]), TimedKernel(kept[1])
    for _ in range(steps):  # one by one: graphs of steps are not timed from within
        engine.advance(1).raise_if_any()
    engine._step_kernel, engine._close_kernel = kept
    return {
        "launches a step": round((step.launches + close.launches) / steps, 2),
        "us in step": round(1e6 * step.seconds / steps, 1),
        "us in close": round(1e6 * close.seconds / steps, 1),
    }


def exchange(engine: Any) -> dict[str, Any]:
    """Time in which the host reads the grains and sets their water."""
    begun = time.perf_counter()
    engine.kinematics()
    engine.set_fluid(engine._fluid)
    return {"ms an exchange": round(1e3 * (time.perf_counter() - begun), 2)}


def speed(n: int, kind: str, copying: float, work: float) -> dict[str, Any]:
    """Steps of about n grains."""
    from card_cost import allocated, traffic
    from numba import cuda

    from ryusa.engine.cuda.engine import CudaEngine

    made = pressed(n, kind)
    n = made[0].n_grain
    engine = loaded(CudaEngine(), made)
    engine.advance(20 if work == WORK else 1).raise_if_any()  # compiles
    steps = int(min(max(work / n, 2 * REPEATS), 2000))
    taken: list[float] = []
    for _ in range(REPEATS):
        cuda.synchronize()
        begun = time.perf_counter()
        engine.advance(steps).raise_if_any()
        taken.append((time.perf_counter() - begun) / steps)
    step = statistics.median(taken)
    listed, touching = engine._device.n_pair / n, 2.0 * engine.tally().n_contact / n
    asked = n * traffic(engine._variant, listed, touching).asked
    return {
        "grains": n,
        "listed a grain": round(listed, 1),
        "touching a grain": round(touching, 1),
        "us a step": round(1e6 * step, 1),
        "spread": round((max(taken) - min(taken)) / step, 3),
        "million grain-steps/s": round(n / step / 1e6, 3),
        "GB/s asked for": round(asked / step / 1e9, 3),
        "share of copying": round(asked / step / copying, 3),
        "bytes a grain": round(allocated(engine) / n),
        "lists": engine._n_list,
        **profile(engine, min(steps, PROFILED)),
        **(exchange(engine) if kind == "column" else {}),
    }


class Table:
    """Rows found on one card, kept in a file as they are found."""

    def __init__(self, path: Path, card: str, limit: float) -> None:
        self._path, self._until = path, time.monotonic() + limit
        self.left: list[str] = []
        self.rows: dict[str, Any] = {}
        if path.exists():
            kept = json.loads(path.read_text(encoding="utf-8"))
            if kept["card"] != card:
                raise SystemExit(f"{path}: rows of {kept['card']}, this is {card}: give another --save")
            self.rows = kept["rows"]
        self._card = card

    def add(self, name: str, expected: float, find: Any, *arguments: Any) -> float:
        """Find a row unless it is kept, or would take too long; returns the seconds it took, or takes."""
        if name in self.rows:
            return float(self.rows[name]["seconds"])
        begun = time.monotonic()
        if begun + expected > self._until:
            self.left.append(name)
            return expected
        found = find(*arguments)
        taken = time.monotonic() - begun
        self.rows[name] = found | {"seconds": round(taken, 1)}
        print(json.dumps({"row": name} | self.rows[name]), flush=True)
        text = json.dumps({"card": self._card, "rows": self.rows}, indent=1)
        self._path.write_text(text + "\n", encoding="utf-8")
        return taken

    def wrong(self) -> list[str]:
        """What is false in any row."""
        return [
            f"{name}: {what}"
            for name, row in self.rows.items()
            for what, is_so in row.items()
            if is_so is False
        ]


def fill(table: Table, args: argparse.Namespace) -> None:
    """Find the rows that are asked for, those of fewer grains first."""
    some, warm, steps = (8, 5, 6) if args.simulated else (FROZEN, 20, TWICE)
    for kind in args.kinds:
        if "agreement" in args.parts:
            table.add(f"agreement, {kind}", 30.0, agreement, some, kind, warm)
        if "twice" in args.parts:
            table.add(f"twice, {kind}", 30.0, twice, some, kind, steps)
    if "speed" not in args.parts:
        return
    from card_copy import bandwidth

    table.add("copy", 10.0, bandwidth, *((64, 1, 8) if args.simulated else (COPIED, 4096, 256)))
    expected = dict.fromkeys(args.kinds, 30.0)
    for n in args.grains:
        for kind in args.kinds:
            if "copy" in table.rows:
                copying = 1e9 * table.rows["copy"]["copying GB/s"]
                work = 1.0 if args.simulated else WORK
                taken = table.add(f"speed, {kind}, {n}", expected[kind], speed, n, kind, copying, work)
                expected[kind] = max(expected[kind], SLOWER * taken if n >= 10**6 else taken)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument("--grains", type=int, nargs="+", default=[10**k for k in (4, 5, 6, 7)])
    parser.add_argument("--simulated", action="store_true", help="numba's simulator; times mean nothing")
    parser.add_argument("--save", type=Path, default=Path("card.json"), help="file of the rows")
    parser.add_argument("--limit", type=float, default=540.0, help="seconds for this command")
    args = parser.parse_args()
    if args.simulated:  # before numba is loaded
        os.environ["NUMBA_ENABLE_CUDASIM"] = "1"
        sys.setswitchinterval(2e-5)
        args.grains = [8]
    from ryusa.engine.cuda.availability import device_name, unavailable

    if reason := unavailable():
        raise SystemExit(f"benchmarks/card.py: {reason}. --simulated tries the program without a card")
    table = Table(args.save, device_name(), args.limit)
    fill(table, args)
    if table.wrong():
        raise SystemExit(f"benchmarks/card.py: NOT {', NOT '.join(table.wrong())}")
    if table.left:
        print(f"left for the same command again: {', '.join(table.left)}", flush=True)


if __name__ == "__main__":
    main()
