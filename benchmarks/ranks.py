"""What a step of LAMMPS under MPI costs, by its parts, and what follows for many grains on many ranks.

    python benchmarks/ranks.py [--rounds 7] [--ranks 2] [--out FILE]

Blocks of grains that touch their neighbours above and below (one contact a grain, as in a dense flow),
periodic along and across, 12 deep: dry, in still water, under a two-way column. Every part is timed on one
rank by the time of its processor, the least of all rounds, so that others who work on the machine disturb it
little:

- a step of n grains with g copies of grains of other ranks ("ghosts": here periodic images) takes
  `step` n + `ghost` g: shapes with few and with many ghosts a grain tell them apart;
- the water adds `water` n to a step, and an exchange with a column of C cells takes `exchange` n + `cells` C;
- a frame takes `frame` N on the first rank.

Two ranks are timed by the wall, the shortest stretch of some hundred steps: waiting ranks spin, so that their
processor time says nothing. On a machine that others use that is what two ranks reach when both happen to
have a core.

What follows, `predicted`, is arithmetic from these and from a network that is not here: `NETWORK` says what
is assumed. Ranks share the bed and not its height, so that a rank has a border of one list cutoff round its
columns of 12 grains.
"""

import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import machine
import numpy as np

D, DEEP = 2.0e-3, 12
CELLS = (60, 240)  # of the columns that are timed
INTERVAL = 33  # steps between two exchanges, as the packaged cases have it
STRETCH = 400  # steps of a stretch on several ranks; each call costs them as much as a step or more
SHAPES = {"square": (13, 13), "strip": (56, 3), "large": (29, 29)}  # grains along and across; 12 deep
# timed on several ranks: 2,028, 10,092 and 80,688 grains
BY_THE_WALL = {**{name: SHAPES[name] for name in ("square", "large")}, "largest": (82, 82)}
FRAME = 88  # bytes of a grain in a frame


@dataclass(frozen=True)
class Network:
    """What is assumed of the network and the disk of a cluster.

    Attributes
    ----------
    latency : of a message [s].
    bandwidth : of a rank [B/s].
    messages : of a rank in a step: forwards and backwards to four neighbours, and the check of the list.
    writing : of the first rank to the disk [B/s].
    """

    latency: float = 2.0e-6
    bandwidth: float = 1.0e9
    messages: int = 9
    writing: float = 5.0e8


NETWORK = Network()
BYTES_OF_GHOST = 8 * (9 + 6)  # x, v, omega forwards; force and torque backwards


def block(along: int, across: int, water: str, n_cell: int) -> Any:
    """Scene and state of a block of grains."""
    from ryusa.build import scene
    from ryusa.laws.families import BedKind, ContactTiming, Drag, Hindrance, Mixing, Profile, Slip
    from ryusa.model import Column, Water
    from ryusa.model.scene import EventRule

    wide = 1.1 * D
    spots = [(np.arange(n) + 0.5) * wide for n in (along, across)]
    x = np.stack(np.meshgrid(*spots, (np.arange(DEEP) + 0.499) * 0.999 * D, indexing="ij"), -1).reshape(-1, 3)
    waters = {
        "dry": Water(),
        "still": Water(profile=Profile.STILL, drag=Drag.SCHILLER_NAUMANN),
        "column": Water(profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, hindrance=Hindrance.DI_FELICE),
    }
    fixed, first = scene(
        x, D, planes=[("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))], period=(along * wide, across * wide),
        slip=Slip.TOTAL, timing=ContactTiming.AT_STEPS, events=EventRule.NONE, water=waters[water],
        stiffness=2.0e4, slope=0.1, steps_per_contact=10.0, allow_overlap=True,
    )  # fmt: skip
    if water != "column":
        return fixed, first
    column = Column(
        z_low=0.0, dz=2.0 * DEEP * D / n_cell, n=n_cell, depth=1.6 * DEEP * D, z_bed=0.0,
        area=along * across * wide**2, bed=BedKind.MOVING, mixing=Mixing.LI_SAWAMOTO, phi_max=0.6, d=D,
        g_x=float(fixed.gravity[0]), interval=INTERVAL,
    )  # fmt: skip
    return replace(fixed, flow=column), first


def loaded(shape: tuple[int, int], water: str, n_cell: int = CELLS[0]) -> tuple[Any, Any]:
    """An engine that has taken the first steps of a block, with its column."""
    from ryusa.engine import registry
    from ryusa.running.water import advanced, started

    fixed, first = block(*shape, water, n_cell)
    engine = registry.create("lammps")
    engine.load(fixed, first)
    column = started(fixed, engine, first, 0)
    advanced(engine, column, 0, 40)[1].raise_if_any()
    return engine, column


def of_processor(work: Any, rounds: int) -> float:
    """Least processor time of a piece of work [s]."""
    taken = []
    for _ in range(rounds):
        begun = time.process_time()
        work()
        taken.append(time.process_time() - begun)
    return min(taken)


def ghosts(engine: Any) -> int:
    """Copies of grains of other ranks, or of periodic images, on the first rank."""
    return int(engine._ranks._share._lmp.extract_setting("nghost"))


def on_one_rank(rounds: int) -> dict[str, Any]:
    """Times of the parts [s]."""
    rows: list[tuple[int, int, float]] = []
    found: dict[str, Any] = {}
    for name, shape in SHAPES.items():
        engine, _ = loaded(shape, "dry")
        n, g = shape[0] * shape[1] * DEEP, ghosts(engine)
        steps = max(20, 200_000 // n)
        rows.append((n, g, of_processor(lambda e=engine, k=steps: e.advance(k), rounds) / steps))
        if name == "large":
            found["frame"] = of_processor(engine.grains, rounds) / n
        engine._ranks._share.close()
    table = np.array(rows)
    found["step"], found["ghost"] = np.linalg.lstsq(table[:, :2], table[:, 2], rcond=None)[0].tolist()
    found["dry"] = [[int(n), int(g), t] for n, g, t in rows]
    n, g, dry = rows[-1]
    engine, _ = loaded(SHAPES["large"], "still")
    found["water"] = (of_processor(lambda: engine.advance(30), rounds) / 30 - dry) / n
    exchange: list[tuple[int, int, float]] = []
    for shape, cells in (("square", CELLS[0]), ("square", CELLS[1]), ("large", CELLS[0])):
        engine, column = loaded(SHAPES[shape], "column", cells)
        taken = [_exchange(engine, column) for _ in range(rounds)]
        exchange.append((SHAPES[shape][0] * SHAPES[shape][1] * DEEP, cells, min(taken)))
        engine._ranks._share.close()
    (n_0, c_0, t_0), (_, c_1, t_1), (n_2, _, t_2) = exchange
    found["cells"], found["exchange"] = (t_1 - t_0) / (c_1 - c_0), (t_2 - t_0) / (n_2 - n_0)
    found["exchange fixed"] = t_0 - n_0 * found["exchange"] - c_0 * found["cells"]
    found["exchanges"] = exchange
    return found


def _exchange(engine: Any, column: Any) -> float:
    """Processor time of the next exchange [s]."""
    engine.advance(column.due - engine._step)
    begun = time.process_time()
    engine.exchange()
    return time.process_time() - begun


def by_the_wall(stretches: int) -> dict[str, Any]:
    """Shortest wall time of a step, on these ranks [s], and of a sum over them."""
    found: dict[str, Any] = {}
    for name, shape in BY_THE_WALL.items():
        engine, _ = loaded(shape, "dry")
        most = SHAPES["large"][0] * SHAPES["large"][1]
        steps = STRETCH * most // max(most, shape[0] * shape[1])  # longer steps, fewer of them
        taken = []
        for _ in range(stretches):
            begun = time.perf_counter()
            engine.advance(steps)
            taken.append((time.perf_counter() - begun) / steps)
        found[name] = {"step": min(taken), "middle": float(np.median(taken)), "ghosts": ghosts(engine)}
        engine._ranks._share.close()
    return found


def sums(comm: Any, stretches: int) -> float:
    """Shortest time of the sums of one exchange over the ranks [s]; on all of them."""
    from mpi4py import MPI

    values, taken = np.ones(7 * CELLS[0]), []
    for _ in range(stretches):
        begun = time.perf_counter()
        comm.Allreduce(MPI.IN_PLACE, values)
        taken.append(time.perf_counter() - begun)
        values[:] = 1.0
    return min(taken)


def halo(n: float) -> float:
    """Ghosts of a rank with n grains of a wide bed: a border of one cutoff round its columns."""
    side, border = math.sqrt(n / DEEP), 1.15 / 1.1  # in columns
    return DEEP * ((side + 2.0 * border) ** 2 - side**2)


def predicted(
    parts: dict[str, Any], n_grain: float, ranks: int, cells: int, net: Network = NETWORK
) -> dict[str, float]:
    """Times of a step of a two-way run on so many ranks [s], its efficiency, and when frames cost a tenth."""
    n = n_grain / ranks
    g = halo(n)
    local = parts["step"] * n + parts["water"] * n
    border = parts["ghost"] * g
    if ranks > 1:
        border += net.messages * net.latency + BYTES_OF_GHOST * g / net.bandwidth
    rounds = math.ceil(math.log2(ranks)) if ranks > 1 else 0
    summed = rounds * (3.0 * net.latency + 10.0 * 8.0 * cells / net.bandwidth)
    column = (parts["exchange"] * n + parts["exchange fixed"] + parts["cells"] * cells) / INTERVAL
    gathered = 0.0 if ranks == 1 else FRAME * n_grain / net.bandwidth
    frame = parts["frame"] * n_grain + gathered + FRAME * n_grain / net.writing
    whole = local + border + column + summed / INTERVAL
    alone = (parts["step"] + parts["water"] + parts["exchange"] / INTERVAL) * n_grain + parts["ghost"] * halo(
        n_grain
    )
    alone += (parts["exchange fixed"] + parts["cells"] * cells) / INTERVAL
    return {
        "step": whole, "efficiency": alone / (ranks * whole), "halo": border / whole,
        "column": (parts["exchange fixed"] + parts["cells"] * cells) / INTERVAL / whole,
        "sums": summed / INTERVAL / whole, "frame": frame, "steps a frame": 9.0 * frame / whole,
        "scene": 100.0 * n_grain,
    }  # fmt: skip


def table(parts: dict[str, Any]) -> list[str]:
    """Lines of Markdown: 10^6 to 10^9 grains on 1 to 4,096 ranks."""
    lines = [
        "| grains | ranks | a step | efficiency | halo | column | sums | a frame "
        "| steps between frames, for 10 % |",
        "|---" * 9 + "|",
    ]
    for n_grain in (1e6, 1e7, 1e8, 1e9):
        for ranks in (1, 16, 256, 4096):
            one = predicted(parts, n_grain, ranks, CELLS[0])
            shares = " | ".join(f"{100.0 * one[name]:.1f} %" for name in ("halo", "column", "sums"))
            lines.append(
                f"| {n_grain:.0e} | {ranks:,} | {_time(one['step'])} | {100.0 * one['efficiency']:.0f} % "
                f"| {shares} | {_time(one['frame'])} | {one['steps a frame']:,.0f} |"
            )
    return lines


def _time(seconds: float) -> str:
    if seconds >= 100.0:
        return f"{seconds:,.0f} s"
    return f"{seconds:.3g} s" if seconds >= 1.0 else f"{1e3 * seconds:.3g} ms"


def _inside(what: str, count: int) -> None:
    """What one of several processes does."""
    from ryusa.engine import registry
    from ryusa.engine.lammps.ranks import world

    comm = world()
    took = sums(comm, 50 * count) if comm is not None and what == "wall" else 0.0
    with registry.leading("lammps") as leads:
        if leads:
            found = on_one_rank(count) if what == "parts" else {**by_the_wall(count), "sums": took}
            print(json.dumps(found), flush=True)


def _asked(ranks: int, what: str, count: int) -> dict[str, Any]:
    mpirun = shutil.which("mpirun", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    if ranks > 1 and mpirun is None:
        sys.exit("there is no mpirun beside Python or on the path: pip install 'ryusa[mpi]'")
    begin = [mpirun, "-np", str(ranks)] if ranks > 1 and mpirun else []
    words = [sys.executable, __file__, "--inside", what, "--rounds", str(count)]
    done = subprocess.run([*begin, *words], check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--stretches", type=int, default=200)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("build/benchmarks/ranks.json"))
    parser.add_argument("--inside", choices=("parts", "wall"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.inside:
        _inside(options.inside, options.rounds)
        return
    found: dict[str, Any] = {"machine": machine.describe(), "load": [os.getloadavg()[0]]}
    found["parts"] = _asked(1, "parts", options.rounds)
    found["wall"] = {str(p): _asked(p, "wall", options.stretches) for p in (1, options.ranks)}
    found["load"].append(os.getloadavg()[0])
    one, more = found["wall"]["1"], found["wall"][str(options.ranks)]
    for name in BY_THE_WALL:
        found[f"efficiency, {name}"] = one[name]["step"] / (options.ranks * more[name]["step"])
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(found, indent=1) + "\n")
    print(json.dumps(found, indent=1))
    print("\n".join(table(found["parts"])))


if __name__ == "__main__":
    main()
