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
TIMES = 40  # at which either is looked at; the later half counts
STEP, SPEED = 0.02, 0.25  # height [m], speed before it [m/s]
AHEAD, BEHIND = 3.0, 20.0  # lengths of the row before and behind the step, in heights
CORNER = 2.0  # within which a smaller eddy may lie, in heights
LENGTHS = ("shear layer", "Li-Sawamoto")
# Cells of the step, and depth before it over its height.
EDDIES = (
    ("shear layer", 10, 5.0),
    ("shear layer", 5, 5.0),
    ("Li-Sawamoto", 10, 5.0),
    ("shear layer", 10, 1.0),
)
KNOWN = 6.28  # length of the eddy in heights


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


def eddy(mixing: str, cells: int, before: float, time: float = 12.0) -> dict[str, Floats]:
    """A backward-facing step so many cells high, before it so many of its heights of water.

    Notes
    -----
    What enters has a boundary layer about as thick as that of the reference, 1.2 heights, by its power of
    1/7; the row begins with the speed of the discharge everywhere, so that no wave runs through it.

    Returns
    -------
    `length` of reattachment, from the step to where the mean speed along the floor turns downstream, in
    heights; nan where none flows back. Mean over the later half of the time.
    """
    dz = STEP / cells
    dx, deep, first = 2.0 * dz, (before + 1.0) * STEP, round(AHEAD * STEP / (2.0 * dz))
    n, segments = round(1.15 * deep / dz), first + round(BEHIND * STEP / dx)
    c = Column(
        z_low=0.0, dz=dz, n=n, depth=deep, nu=1e-6, bed=BedKind.SMOOTH, mixing=Mixing.of(mixing),
        surface=SurfaceRule.VOLUME,
    )  # fmt: skip
    profile = np.minimum((np.arange(n) + 0.5) * dz / (1.2 * STEP), 1.0) ** (1.0 / 7.0)
    q = SPEED * STEP * before
    row = ColumnRow(
        c, dx, np.zeros(segments), G, RowEnd(EndKind.DISCHARGE, discharge=q, profile=profile),
        RowEnd(EndKind.LEVEL, level=deep), np.where(np.arange(segments) < first, cells, 0), -AHEAD * STEP,
        pressure=Pressure.FULL,
    )  # fmt: skip
    now, arrays = row_at_rest(row, np.full(segments, deep)), RowArrays.of(row)
    solid = np.where(np.arange(segments + 1) <= first, cells, 0)
    now = replace(now, u=(np.arange(n) >= solid[:, None]) * (q / (deep - solid * dz))[:, None])
    mean = np.zeros(segments + 1)
    for k in range(TIMES):
        now = advance_row(row, now, time / TIMES, arrays=arrays)
        mean += now.u[:, 0] * (2 * k >= TIMES)
    x = row.x_station
    turns = int(np.flatnonzero((x > CORNER * STEP) & (mean > 0.0))[0])
    if mean[turns - 1] >= 0.0:
        return {"length": np.array(np.nan)}
    return {"length": np.array((x[turns] - dx * mean[turns] / (mean[turns] - mean[turns - 1])) / STEP)}


def tasks() -> Sequence[Task]:
    """Three minutes."""
    jets = [calculation(widening, mixing=one, seconds=20.0) for one in LENGTHS]
    eddies = [
        calculation(eddy, mixing=one, cells=n, before=h, seconds=0.008 * n**3 * (1.0 + h))
        for one, n, h in EDDIES
    ]
    return [*jets, *eddies]


def judge(found: Found) -> Sequence[Finding]:
    """Beside the rate of plane wall jets, and the reattachment of a direct numerical simulation."""
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
    best, coarse, plain, twice = lengths
    step = DECLARED["step"].finding(
        [Curve(LENGTHS[0], np.array([5.0, 10.0]), np.array([coarse, best])),
         Curve(LENGTHS[1], np.array([10.0]), np.array([plain]))],
        [Curve("Le, Moin & Kim", np.array([5.0, 10.0]), np.full(2, KNOWN))],
        {"length": best / KNOWN}, coarse=coarse, plain=plain, twice=twice,
    )  # fmt: skip
    return [finding, step]
