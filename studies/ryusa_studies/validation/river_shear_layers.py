"""A jet along a floor, how fast it widens, and the eddy behind a step, how long it is (design/0030)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.laws.families import BedKind, Mixing, Pressure, SurfaceRule
from ryusa.model.arrays import Floats
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowEnd
from ryusa.study import Finding, Found, Task, calculation
from ryusa.water.row import RowArrays, advance_row, row_at_rest
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)

G = 9.80665
THICK, DEEP, LONG = 0.02, 0.5, 1.6  # of the jet, the water, the row [m]
WITHIN = 0.3, 1.0  # where it widens freely: beyond its core, before the end turns it [m]
LENGTHS = ("shear layer", "Li-Sawamoto")
EDDIES = (("shear layer", 5), ("shear layer", 10), ("Li-Sawamoto", 10))  # and cells of the step
KNOWN = 6.28  # length of the eddy in heights
TIMES = 40  # at which either is looked at; the later half counts
STEP, BEFORE, SPEED = 0.05, 5.0, 0.25  # height [m], depth before it in heights, speed there [m/s]
AHEAD, BEHIND = 3.0, 20.0  # lengths of the row before and behind the step, in heights


def widening(mixing: str, cell: float = 0.005, time: float = 20.0) -> dict[str, Floats]:
    """A jet of 1 m/s enters along the floor.

    Returns
    -------
    Over the way `x` [m] within WITHIN: `width`, height at which half of the highest speed is left [m], and
    that `speed` [m/s]; `rate`, at which it widens [-]. Means over the later half of the time.
    """
    n, dx = round(1.1 * DEEP / cell), 4.0 * cell
    c = Column(
        z_low=0.0, dz=cell, n=n, depth=DEEP, nu=1e-6, bed=BedKind.SMOOTH, mixing=Mixing.of(mixing),
        surface=SurfaceRule.VOLUME,
    )  # fmt: skip
    profile = np.where(np.arange(n) < round(THICK / cell), 1.0, 1e-9)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=THICK, profile=profile)
    segments, level = round(LONG / dx), RowEnd(EndKind.LEVEL, level=DEEP)
    row = ColumnRow(c, dx, np.zeros(segments), G, inlet, level, pressure=Pressure.FULL)
    now, arrays = row_at_rest(row, np.full(segments, DEEP)), RowArrays.of(row)
    mean = np.zeros_like(now.u)
    for k in range(TIMES):
        now = advance_row(row, now, time / TIMES, arrays=arrays)
        mean += now.u * (2 * k >= TIMES) / (TIMES / 2)
    inside = np.flatnonzero((row.x_station > WITHIN[0]) & (row.x_station < WITHIN[1]))
    x, speed = row.x_station[inside], mean[inside].max(axis=1)
    width = np.array([_half(c.z, one) for one in mean[inside]])
    return {"x": x, "width": width, "speed": speed, "rate": np.array(np.polyfit(x, width, 1)[0])}


def _half(z: Floats, u: Floats) -> float:
    """Height above the floor at which half of the highest speed is left, above it [m]."""
    most = int(u.argmax())
    k = most + int(np.flatnonzero(u[most:] < 0.5 * u[most])[0])
    return float(np.interp(0.5 * u[most], [u[k], u[k - 1]], [z[k], z[k - 1]]))


def eddy(mixing: str, cells: int, time: float = 30.0) -> dict[str, Floats]:
    """A channel that becomes 1.2 times as deep, by a step so many cells high.

    Notes
    -----
    What enters has the boundary layer of the reference, 1.2 steps thick at the step, by its power of 1/7; the
    row begins with the speed of the discharge everywhere, so that no wave runs through it.

    Returns
    -------
    `length`, from the step to where the mean speed along the floor turns downstream, in its heights [-].
    Mean over the later half of the time.
    """
    dz = STEP / cells
    dx, deep, first = 2.0 * dz, (BEFORE + 1.0) * STEP, round(AHEAD * STEP / (2.0 * dz))
    n, segments = round(1.15 * deep / dz), first + round(BEHIND * STEP / dx)
    c = Column(
        z_low=0.0, dz=dz, n=n, depth=deep, nu=1e-6, bed=BedKind.SMOOTH, mixing=Mixing.of(mixing),
        surface=SurfaceRule.VOLUME,
    )  # fmt: skip
    profile = np.minimum((np.arange(n) + 0.5) * dz / (1.2 * STEP), 1.0) ** (1.0 / 7.0)
    q = SPEED * STEP * BEFORE
    row = ColumnRow(
        c, dx, np.zeros(segments), G, RowEnd(EndKind.DISCHARGE, discharge=q, profile=profile),
        RowEnd(EndKind.LEVEL, level=deep), np.where(np.arange(segments) < first, cells, 0), -AHEAD * STEP,
        pressure=Pressure.FULL,
    )  # fmt: skip
    now, arrays = row_at_rest(row, np.full(segments, deep)), RowArrays.of(row)
    open_cells = np.arange(n) >= np.where(np.arange(segments + 1) <= first, cells, 0)[:, None]
    depth = deep - np.where(np.arange(segments + 1) <= first, STEP, 0.0)
    now = replace(now, u=open_cells * (q / depth)[:, None])
    mean = np.zeros(segments + 1)
    for k in range(TIMES):
        now = advance_row(row, now, time / TIMES, arrays=arrays)
        mean += now.u[:, 0] * (2 * k >= TIMES)
    last = int(np.flatnonzero((row.x_station > 0.5 * dx) & (mean < 0.0))[-1])
    ends = row.x_station[last] + dx * mean[last] / (mean[last] - mean[last + 1])
    return {"length": np.array(ends / STEP)}


def tasks() -> Sequence[Task]:
    """Two minutes."""
    jets = [calculation(widening, mixing=one, seconds=20.0) for one in LENGTHS]
    return [*jets, *(calculation(eddy, mixing=one, cells=n, seconds=8.0 * (n / 5) ** 3) for one, n in EDDIES)]


def judge(found: Found) -> Sequence[Finding]:
    """Beside the rate of plane wall jets, and the eddy of a direct numerical simulation."""
    runs = [found[one] for one in tasks()]
    own, other = runs[:2]
    lengths = [float(one["length"]) for one in runs[2:]]
    x = own["x"]
    line = float(own["width"].mean()) + 0.073 * (x - float(x.mean()))
    finding = DECLARED["wall-jet"].finding(
        [Curve(word, run["x"], 1e3 * run["width"]) for word, run in zip(LENGTHS, runs[:2], strict=True)],
        [Curve("widens by 0.073", x, 1e3 * line)],
        {"rate": abs(float(own["rate"]) / 0.073 - 1.0)}, other=float(other["rate"]),
        at=float(x[-1]), left=float(own["speed"][-1]), rest=float(other["speed"][-1]),
    )  # fmt: skip
    step = DECLARED["step"].finding(
        [Curve(f"{word}, {n} cells", np.array([n]), np.array([one]))
         for (word, n), one in zip(EDDIES, lengths, strict=True)],
        [Curve("Le, Moin & Kim", np.array([EDDIES[0][1], EDDIES[-1][1]]), np.full(2, KNOWN))],
        {"length": lengths[1] / KNOWN}, coarse=lengths[0] / KNOWN, other=lengths[2] / KNOWN,
    )  # fmt: skip
    return [finding, step]
