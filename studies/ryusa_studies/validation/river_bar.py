"""Waves over a bar, beside the surfaces that Dingemans 1994 measured at six gauges (design/0030)."""

import math
from dataclasses import replace

import numpy as np
from scipy.optimize import root_scalar

from ryusa.figures.comparison import Curve
from ryusa.laws.families import Pressure, SurfaceRule
from ryusa.model.arrays import Floats
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowEnd
from ryusa.study import Finding, Found, Task, calculation
from ryusa.water.row import RowArrays, advance_row, row_at_rest
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)
G = 9.80665
PERIOD = 2.02 * math.sqrt(2.0)  # [s]; the tests in a flume twice as large as the first, by Froude's law
DEPTH = 0.8  # [m]
BAR = (11.01, 23.04, 27.04, 33.07), (0.0, 0.6, 0.6, 0.0)  # its line: distance and height [m]
LENGTH, DX, DZ = 75.0, 0.1, 0.025  # a wave that the end reflects is not back by the end of the run [m]
END = 47.75  # of the two periods in which the surfaces are compared [s]
HARMONICS = 4
EACH = 0.025  # steps of the wave maker [s]


def harmonics(t: Floats, surface: Floats) -> Floats:
    """Amplitudes of the first harmonics of a surface, by least squares, shape (HARMONICS,).

    t : times [s] over whole periods. surface : heights at them, shape (n,).

    >>> t = np.linspace(0.0, PERIOD, 30)
    >>> harmonics(t, 5.0 + 3.0 * np.cos(4.0 * np.pi * t / PERIOD)).round(6).tolist()
    [0.0, 3.0, 0.0, 0.0]
    """
    phase = 2.0 * math.pi / PERIOD * np.outer(t, np.arange(1, HARMONICS + 1))
    columns = np.column_stack([np.ones(len(t)), np.cos(phase), np.sin(phase)])
    a = np.linalg.lstsq(columns, surface, rcond=None)[0]
    return np.hypot(a[1 : HARMONICS + 1], a[HARMONICS + 1 :])


def bar(pressure: str) -> dict[str, Floats]:
    """Surfaces at the gauges from the time on that was measured, after a wave maker began in still water.

    Returns
    -------
    `t` [s], shape (n,), and `surface` over its mean at each gauge [mm], shape (n_gauge, n).

    Notes
    -----
    Where the row begins a discharge c A sin(omega t) comes and goes, c and A speed and amplitude of the wave.
    """
    omega = 2.0 * math.pi / PERIOD
    k = root_scalar(lambda k: G * k * math.tanh(k * DEPTH) - omega**2, bracket=(0.1, 10.0)).root
    first, *_ = measured().values()
    amplitude = 1e-3 * float(harmonics(first[:, 0], first[:, 1])[0])
    n = round(LENGTH / DX)
    x = (np.arange(n) + 0.5) * DX
    c = Column(z_low=0.0, dz=DZ, n=round(1.2 * DEPTH / DZ), depth=DEPTH, nu=1e-6, surface=SurfaceRule.VOLUME)
    row = ColumnRow(
        c, DX, np.interp(x, *BAR), G, RowEnd(EndKind.DISCHARGE, discharge=0.0), RowEnd(EndKind.WALL),
        pressure=Pressure.of(pressure),
    )  # fmt: skip
    now = row_at_rest(row, np.full(n, DEPTH))
    gauges, begin = np.array([float(name.split()[0]) for name in measured()]), first[0, 0] - PERIOD
    t, surfaces = list[float](), list[Floats]()
    while now.t < END:
        middle = now.t + 0.5 * EACH
        wave = amplitude * omega / k * math.sin(omega * middle) * min(1.0, middle / (2.0 * PERIOD))
        row = replace(row, upstream=RowEnd(EndKind.DISCHARGE, discharge=wave))
        longest = 0.2 * DX / math.sqrt(G * DEPTH)
        now = advance_row(row, now, EACH, longest=longest, arrays=RowArrays.of(row))
        if now.t > begin:
            t.append(now.t)
            surfaces.append(1e3 * np.interp(gauges, x, now.surface[row.inner] + row.bottom))
    over = np.array(surfaces).T
    return {"t": np.array(t), "surface": over - over[:, np.array(t) > first[0, 0]].mean(axis=1)[:, None]}


def measured() -> dict[str, Floats]:
    """By the name of each gauge its times [s] and surface over its mean there [mm], shape (n, 2)."""
    points = DECLARED["bar"].points
    return {name: one - np.array([0.0, one[:, 1].mean()]) for name, one in points.items()}


def off(run: dict[str, Floats]) -> tuple[float, float, dict[str, tuple[Floats, Floats]]]:
    """How far a run is off.

    Returns
    -------
    The rms of the amplitudes at all gauges but the first, over the first harmonic there [-]; the rms of the
    surfaces with the shift of time that makes it least, within one period, over that of those measured [-];
    and by gauge the amplitudes measured and found [mm].
    """
    pairs = list(zip(measured().items(), run["surface"], strict=True))
    (_, first), _ = pairs[0]
    late = run["t"] > first[0, 0]  # whole periods, as measured
    told = {name: (harmonics(*one.T), harmonics(run["t"][late], own[late])) for (name, one), own in pairs}
    (incoming, _), *others = told.values()
    amplitudes = np.array([one - own for one, own in others])
    behind = [(one, own) for (_, one), own in pairs[1:]]
    apart = [
        np.concatenate([one[:, 1] - np.interp(one[:, 0] - shift, run["t"], own) for one, own in behind])
        for shift in np.arange(0.0, PERIOD, 0.5 * EACH)
    ]
    least = min(float(np.sqrt((each**2).mean())) for each in apart)
    series = least / float(np.sqrt((np.concatenate([one[:, 1] for one, _ in behind]) ** 2).mean()))
    return float(np.sqrt((amplitudes**2).mean())) / float(incoming[0]), series, told


def tasks() -> list[Task]:
    """Two runs, of three minutes and of one."""
    return [
        calculation(bar, pressure=one.word, seconds=seconds)
        for one, seconds in ((Pressure.FULL, 200.0), (Pressure.HYDROSTATIC, 70.0))
    ]


def judge(found: Found) -> list[Finding]:
    """The harmonics and surfaces at the gauges behind the first."""
    own, still = (found[one] for one in tasks())
    harmonic, series, told = off(own)
    still_harmonic, still_series, _ = off(still)
    each = "; ".join(
        f"{name} {', '.join(f'{x:.1f}' for x in one)} and {', '.join(f'{x:.1f}' for x in ours)}"
        for name, (one, ours) in told.items()
    )
    return [
        DECLARED["bar"].finding(
            [Curve(name, own["t"], one) for name, one in zip(measured(), own["surface"], strict=True)],
            [Curve(name, *one.T) for name, one in measured().items()],
            {"harmonics": harmonic, "series": series}, told=each, own=harmonic, own_series=series,
            still=still_harmonic, still_series=still_series,
        )
    ]  # fmt: skip
