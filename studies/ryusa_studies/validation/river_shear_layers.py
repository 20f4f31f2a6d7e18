"""A jet along a floor below deep still water: how fast it widens, and what speed is left (design/0030)."""

from collections.abc import Sequence

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
TIMES = 40  # at which it is looked at; the later half counts


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


def tasks() -> Sequence[Task]:
    """Half a minute."""
    return [calculation(widening, mixing=one, seconds=20.0) for one in LENGTHS]


def judge(found: Found) -> Sequence[Finding]:
    """Beside the rate of plane wall jets."""
    runs = [found[one] for one in tasks()]
    own, other = runs
    x = own["x"]
    line = float(own["width"].mean()) + 0.073 * (x - float(x.mean()))
    finding = DECLARED["wall-jet"].finding(
        [Curve(word, run["x"], 1e3 * run["width"]) for word, run in zip(LENGTHS, runs, strict=True)],
        [Curve("widens by 0.073", x, 1e3 * line)],
        {"rate": abs(float(own["rate"]) / 0.073 - 1.0)}, other=float(other["rate"]),
        at=float(x[-1]), left=float(own["speed"][-1]), rest=float(other["speed"][-1]),
    )  # fmt: skip
    return [finding]
