"""What water that feels its grains costs: a flowing bed of 20,172 grains in 3D, on one thread.

    python benchmarks/coupling.py              # three to four minutes
    python benchmarks/coupling.py --row        # instead of one column a row of them, five minutes
    python benchmarks/coupling.py --save       # and keep the table in benchmarks/results/

The packaged dense 3D case under a column of water, as `ryusa run` steps it: 50 steps, then the exchange. The
same grains are stepped dry, in water that is given (log law), in a column, and in one with fluctuations, in
turns, so that a drift of the machine's speed meets all. The share is that of the exchange (cutting grains,
sums both ways, the water's own step, telling the grains) in the time of its steps and itself; what water
costs within a step, drag first of all, is the difference of the columns to "dry".
"""

import argparse
import datetime
import json
import os
import platform
import statistics
import time
from dataclasses import replace
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

from ryusa.build import build
from ryusa.casefile import read
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.running.provenance import processor
from ryusa.water import row_grains
from ryusa.water.coupling import Coupling
from ryusa.water.row_coupling import RowCoupling

REPEATS = 15
FLOW = 12_000  # steps under water before anything is timed
COLUMN = {
    "motion.slope": "1/10",
    "motion.plane": "false",
    "water": "{ profile = 'column', depth = '4 cm', hindrance = 'Di Felice' }",
}
KINDS: dict[str, dict[str, str]] = {
    "dry": {"motion.slope": "1/10"},
    "given water": {"motion.slope": "1/10", "water": "{ profile = 'log rough', tau_star = 1.2 }"},
    "column": COLUMN,
    "column, random walk": COLUMN
    | {
        "water": "{ profile = 'column', depth = '4 cm', hindrance = 'Di Felice', "
        "column = { fluctuations = 'random walk' } }"
    },
}


ROWS = (
    (50, 60, 16, 10),
    (200, 20, 16, 10),
    (200, 60, 4, 4),
    (200, 60, 16, 10),
)  # segments, cells; width, bed over d
SETTLE = 60  # intervals before a row is timed


def row_of(segments: int, cells: int, width: int, bed: int) -> Any:
    """A stream with a bed, of the packaged river: segments of 3 d, cells up to 24 d."""
    path, length = Path(str(files("ryusa").joinpath("cases", "river.toml"))), 0.03 * segments
    keys = {
        "water.row.bottom": f"[['0 m', '{0.02 * length:g} m'], ['{length:g} m', '0 m']]",
        "water.row.width": f"{width} cm",
        "water.row.height": "24 cm",
        "water.row.dams": "[]",
        "water.column.cell": f"{24 / cells:g} cm",
        "water.depth": "10 cm",
        "build.bed": f"{bed} cm",
        "build.begin": "0.1 m",
        "build.end": f"{length - 0.3:g} m",
        "exits": f"[{{ name = 'outlet', point = ['{length:g} m', '0 m', '0 m'], normal = [1, 0, 0] }}]",
        "feeds": "[]",
        "timeline": "[]",
    }
    return read(path, keys)


def measure_row(segments: int, cells: int, width: int, bed: int) -> dict[str, Any]:
    """Time steps and exchanges of a row of columns."""
    built, water_alone = build(row_of(segments, cells, width, bed)), 0.0
    scene, row = built.scene, built.scene.row
    assert row is not None
    advance = row_grains.advance_row

    def timed(*args: Any, **named: Any) -> Any:
        nonlocal water_alone
        begin = time.process_time()
        found = advance(*args, **named)
        water_alone += time.process_time() - begin
        return found

    row_grains.advance_row = timed
    engine = CpuEngine()
    engine.load(scene, built.state)
    coupling = RowCoupling.begin(scene, row, built.state.x)
    engine.set_fluid(coupling.sampled)
    taken, given, alone, steps = [], [], [], []
    for turn in range(SETTLE + REPEATS):
        water_alone, k = 0.0, coupling.steps
        begin = time.process_time()
        engine.advance(k).raise_if_any()
        middle = time.process_time()
        engine.set_fluid(coupling.exchange(*engine.kinematics()))
        if turn >= SETTLE:
            taken.append(middle - begin)
            given.append(time.process_time() - middle)
            alone.append(water_alone)
            steps.append(k)
    row_grains.advance_row = advance
    moved, more = statistics.median(taken), statistics.median(given)
    return {
        "segments": segments,
        "cells": row.column.n,
        "grains": scene.n_grain,
        "steps an exchange": statistics.median(steps),
        "steps [ms]": round(1e3 * moved, 2),
        "exchange [ms]": round(1e3 * more, 2),
        "of it water [ms]": round(1e3 * statistics.median(alone), 2),
        "share of the exchange [%]": round(100.0 * more / (moved + more), 1),
    }


def case_of(keys: dict[str, str], columns: int) -> Any:
    """The packaged case with water over it, and no timeline."""
    path = Path(str(files("ryusa").joinpath("cases", "dense_3d.toml")))
    size = {"build.columns": str(columns), "build.rows": str(columns), "timeline": "[]"}
    return read(path, size | {"time.steps_per_contact": "20"} | keys)


def measure(columns: int) -> list[dict[str, Any]]:
    """Time a step and an exchange of every kind of water on the same grains."""
    built = {name: build(case_of(keys, columns)) for name, keys in KINDS.items()}
    scene, column = built["column"].scene, built["column"].scene.column
    assert column is not None
    flowing = CpuEngine(threads=2)
    flowing.load(scene, built["column"].state)
    coupling = Coupling.begin(scene, column, built["column"].state.x)
    flowing.set_fluid(coupling.sampled)
    done = 0
    while done < FLOW:
        done += (k := coupling.steps)
        flowing.advance(k).raise_if_any()
        flowing.set_fluid(coupling.exchange(*flowing.kinematics()))
    state = flowing.state()
    engines, couplings = {}, {}
    for name, one in built.items():
        engine = engines[name] = CpuEngine()
        dt = replace(one.scene, dt=scene.dt)  # one step for all
        own = replace(state, fluid=None if one.scene.column is None else state.fluid, contacts=state.contacts)
        engine.load(dt, own)
        if one.scene.column is not None:
            water = Coupling.begin(dt, one.scene.column, state.x, state.step, state=coupling.state)
            couplings[name] = water
            engine.set_fluid(water.sampled)
    taken: dict[str, list[float]] = {name: [] for name in engines}
    given: dict[str, list[float]] = {name: [] for name in couplings}
    for turn in range(REPEATS + 2):
        for name, engine in engines.items():
            steps = couplings[name].steps if name in couplings else column.interval
            begin = time.perf_counter()
            engine.advance(steps).raise_if_any()
            middle = time.perf_counter()
            if name in couplings:
                engine.set_fluid(couplings[name].exchange(*engine.kinematics()))
            if turn > 1:
                taken[name].append((middle - begin) / steps)
            if turn > 1 and name in couplings:
                given[name].append((time.perf_counter() - middle) / couplings[name].steps)
    rows = []
    for name, times in taken.items():
        step = statistics.median(times)
        row: dict[str, Any] = {"water": name, "grains": scene.n_grain, "us a step": round(1e6 * step, 1)}
        if name in given:
            more = statistics.median(given[name])
            row |= {
                "steps an exchange": couplings[name].steps,
                "cells": couplings[name].column.n,
                "us a step for the exchange": round(1e6 * more, 1),
                "exchange [ms]": round(1e3 * more * couplings[name].steps, 2),
                "share of the exchange [%]": round(100.0 * more / (step + more), 2),
            }
        rows.append(row)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--columns", type=int, default=41, help="grains along x and y: 41 x 41 x 12")
    parser.add_argument("--row", action="store_true", help="a row of columns instead of one")
    parser.add_argument("--save", action="store_true", help="keep the table in benchmarks/results/")
    options = parser.parse_args()
    table: dict[str, Any] = {
        "date": datetime.date.today().isoformat(),
        "machine": {"cpu": processor(), "system": platform.platform(), "python": platform.python_version()},
        "versions": {name: version(name) for name in ("ryusa", "numba", "llvmlite", "numpy")},
        "load average before": [round(a, 2) for a in os.getloadavg()],
        "rows": (measure_row(*one) for one in ROWS) if options.row else measure(options.columns),
    }
    rows, table["rows"] = table["rows"], []
    for row in rows:
        table["rows"].append(row)
        print(", ".join(f"{key} {value}" for key, value in row.items()), flush=True)
    if options.save:
        file = (
            Path(__file__).parent / "results" / f"{'row' if options.row else 'coupling'}-{table['date']}.json"
        )
        file.parent.mkdir(exist_ok=True)
        file.write_text(json.dumps(table, indent=1) + "\n")
        print(f"kept in {file.relative_to(Path(__file__).parent.parent)}")


if __name__ == "__main__":
    main()
