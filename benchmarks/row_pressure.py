"""What a pressure of its own costs the water of a row: a step of it over one of the hydrostatic row.

    python benchmarks/row_pressure.py          # a minute

A river-like row, a wavy porous bed with 3 cm of water over it, turbulence of the row, on one thread; both
rows start alike and are stepped in turns. The step is the same, so that the ratio is that of their costs.
"""

import statistics
import time
from dataclasses import replace

import numpy as np

from ryusa.laws.families import BedKind, Mixing, Pressure, SurfaceRule
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowEnd
from ryusa.running.provenance import processor
from ryusa.water.row import RowArrays, advance_row, row_at_rest

SIZES = ((60, 20), (200, 60), (2000, 60))  # segments, cells
BOTTOMS = (0.0, 0.002)  # height of the waves of the bottom [m]: five points in the system, or nine
ROUNDS, STEPS = 7, 20


def flow(segments: int, cells: int, wave: float, pressure: Pressure) -> tuple[ColumnRow, PorousSolid]:
    """A row and the porous bed in it."""
    dz = 0.06 / cells
    c = Column(
        z_low=0.0, dz=dz, n=cells + cells // 2, depth=0.06, bed=BedKind.ROUGH, k_rough=0.002,
        mixing=Mixing.PARABOLIC, surface=SurfaceRule.VOLUME,
    )  # fmt: skip
    x = np.arange(segments)
    phi = 0.6 * (c.z < 0.03 + 0.002 * np.sin(0.1 * x)[:, None])
    ends = RowEnd(EndKind.DISCHARGE, discharge=0.006), RowEnd(EndKind.LEVEL, level=0.06)
    row = ColumnRow(c, 8.0 * dz, wave * np.sin(0.05 * x), 9.80665, *ends, pressure=pressure)
    return row, PorousSolid.of_grains(phi, 0.003, 1e-6)


def seconds(segments: int, cells: int, wave: float) -> dict[Pressure, float]:
    """Seconds of a step of each row: medians over rounds, after both have been running for a while."""
    found: dict[Pressure, list[float]] = {one: [] for one in Pressure}
    rows = {one: flow(segments, cells, wave, one) for one in Pressure}
    arrays = {one: RowArrays.of(rows[one][0]) for one in Pressure}
    longest = 0.2 * rows[Pressure.FULL][0].dx
    now = {one: row_at_rest(row, np.full(segments, 0.06), solid) for one, (row, solid) in rows.items()}
    for turn in range(ROUNDS + 2):
        for one in Pressure if turn % 2 else reversed(Pressure):
            row, solid = rows[one]
            begin, before = time.perf_counter(), now[one].steps
            now[one] = advance_row(
                row, now[one], STEPS * longest, longest=longest, solid=solid, arrays=arrays[one]
            )
            if turn > 1:
                found[one].append((time.perf_counter() - begin) / (now[one].steps - before))
            now[one] = replace(now[one], t=0.0)
    return {one: statistics.median(values) for one, values in found.items()}


def main() -> None:
    """Print the table."""
    print(f"{processor()}, one thread; milliseconds of a step, {ROUNDS} rounds of {STEPS} steps and more")
    print("| segments x cells | bottom | hydrostatic | full | ratio |\n|---|---|---|---|---|")
    for segments, cells in SIZES:
        for wave in BOTTOMS:
            took = seconds(segments, cells, wave)
            still, full = took[Pressure.HYDROSTATIC], took[Pressure.FULL]
            bottom = "wavy" if wave else "level"
            numbers = f"{1e3 * still:.3g} | {1e3 * full:.3g} | {full / still:.2f}"
            print(f"| {segments} x {cells} | {bottom} | {numbers} |")


if __name__ == "__main__":
    main()
