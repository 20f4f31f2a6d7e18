"""A hydraulic jump in a row of columns with a pressure of its own and its own turbulence (design/0030).

The limits are those that were asked for before any jump was run. The loss is that of the heads with the
speeds at all heights; the closed form has uniform speeds, so that the head by the depths alone was judged
beside it once the first number was known.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.laws.bore import conjugate_depth
from ryusa.laws.families import BedKind, Mixing, Pressure, SurfaceRule
from ryusa.model.arrays import Floats
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowEnd, RowState
from ryusa.study import Finding, Found, Task, calculation
from ryusa.water.row import advance_row, row_at_rest
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)
G = 9.80665
BEFORE = 0.02  # depth that enters [m]
FROUDE = (2.0, 3.0, 4.0, 5.0)  # of what enters
TIME = 15.0  # [s]


def heads(row: ColumnRow, now: RowState) -> tuple[Floats, Floats]:
    """Depth, and energy head by the speeds at all heights, at the stations between segments [m]."""
    left, right = row.stations_between
    content = 0.5 * (now.content[left] + now.content[right])
    depth = content.sum(axis=1)
    flow = (content * now.u).sum(axis=1)
    return depth, depth + (content * now.u**3).sum(axis=1) / (2.0 * G * np.where(flow > 0.0, flow, 1.0))


def jump(froude: float, pressure: str) -> dict[str, Floats]:
    """A jump that the level at the end of a smooth flume holds: surface, heads, and the three numbers.

    Notes
    -----
    First the flow runs alone; the level is the depth conjugate to what it has in the middle of the flume, and
    there the jump begins.
    """
    q = froude * math.sqrt(G * BEFORE**3)
    behind = conjugate_depth(BEFORE, froude)
    dx, dz = BEFORE, BEFORE / 6.0
    n = round(24.0 * behind / dx)
    c = Column(
        z_low=0.0, dz=dz, n=round(1.5 * behind / dz), depth=BEFORE, nu=1e-6, bed=BedKind.SMOOTH,
        mixing=Mixing.PARABOLIC, surface=SurfaceRule.VOLUME,
    )  # fmt: skip
    inlet = RowEnd(EndKind.DISCHARGE, discharge=q, depth=BEFORE)
    fast = ColumnRow(c, dx, np.zeros(n), G, inlet, RowEnd(EndKind.UNIFORM), pressure=Pressure.of(pressure))
    now = row_at_rest(fast, np.full(n, BEFORE))
    now = advance_row(fast, replace(now, u=np.full_like(now.u, q / BEFORE)), 5.0 * n * dx / (q / BEFORE))
    depth = now.surface[fast.inner]
    here = float(depth[n // 3])
    held = conjugate_depth(here, q / math.sqrt(G * here**3))
    row = replace(fast, downstream=RowEnd(EndKind.LEVEL, level=held))
    start = row_at_rest(row, np.where(np.arange(n) < n // 3, depth, held))
    speeds = np.where(np.arange(n + 1)[:, None] <= n // 3, now.u, q / held)
    now = replace(start, u=speeds)
    surfaces, energies = list[Floats](), list[Floats]()
    for _ in range(30):
        now = advance_row(row, now, TIME / 30)
        surfaces.append(now.surface[row.inner].copy())
        energies.append(heads(row, now)[1])
    surface, energy = np.mean(surfaces[-10:], axis=0), np.mean(energies[-10:], axis=0)
    toe = int(np.argmax(surface > surface[: n // 2].min() + 0.05 * (held - surface[: n // 2].min())))
    toe = max(toe, 1)
    first = float(surface[toe - 1])
    second = float(surface[toe : toe + round(8.0 * held / dx)].max())
    end = toe + int(np.argmax(surface[toe:] > first + 0.95 * (second - first)))
    after = min(toe + round(6.0 * second / dx), n - 2)
    lost = float(energy[toe - 1] - energy[after])
    fast = q / math.sqrt(G * first**3)
    expected = conjugate_depth(first, fast)
    of_a_jump = (expected - first) ** 3 / (4.0 * expected * first)
    return {
        "x": row.x, "surface": surface, "energy": energy, "toe": np.array(row.x[toe]),
        "conjugate": np.array(float(surface[after]) / expected),
        "length": np.array((end - toe + 1) * dx / second),
        "by_depths": np.array(
            (first + (q / first) ** 2 / (2.0 * G) - surface[after] - (q / surface[after]) ** 2 / (2.0 * G))
            / of_a_jump
        ),
        "loss": np.array(lost / of_a_jump),
        "froude": np.array(fast),
    }  # fmt: skip


def _task(froude: float) -> Task:
    return calculation(jump, froude=froude, pressure=Pressure.FULL.word, seconds=4.0 * froude)


def tasks() -> Sequence[Task]:
    """A jump for each Froude number."""
    return [_task(one) for one in FROUDE]


def judge(found: Found) -> Sequence[Finding]:
    """Depth, length and loss of each."""
    runs = {froude: found[_task(froude)] for froude in FROUDE}
    numbers = [
        DECLARED["jump"].trial(name, number, f"{froude:g}")
        for froude, run in runs.items()
        for name, number in (
            ("conjugate", abs(float(run["conjugate"]) - 1.0)), ("length", float(run["length"])),
            ("loss", abs(float(run["loss"]) - 1.0)), ("by-depths", abs(float(run["by_depths"]) - 1.0)),
        )
    ]  # fmt: skip
    curves = [
        Curve(f"Fr {float(run['froude']):.2f}", run["x"] - run["toe"], run["surface"])
        for run in runs.values()
    ]
    return [DECLARED["jump"].finding(curves, [], numbers)]
