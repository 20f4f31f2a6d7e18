"""A dam break over a loose bed, by the signs that experiments give (design/0028)."""

import math
from collections.abc import Sequence
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from ryusa.build import build
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.measure.long_section import bed_line, long_section, row_of
from ryusa.model import State
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.running.runner import run, run_scene
from ryusa.running.stops import Stop
from ryusa.study import Finding, Found, Level, Plan, Task, calculation
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)

CASE = "dam_break_bed"
SEEDS = (1, 2)
# Of the case, in SI: the gate, water and bed upstream of it, its end and mean diameter
GATE, DEEP, BED, END, D = 0.6, 0.1, 0.06, 1.75, 3.5e-3
G = 9.80665
T_0 = math.sqrt(DEEP / G)
SETTLING = {
    "water.row.surface": f"[['0 m', '5 mm'], ['{END:g} m', '5 mm']]",
    "stop.time": "0.3 s",
    "record.frames": "0.3 s",
}
AHEAD = (1.62, 1.72)  # where even a front at 2 sqrt(g h_0) does not come within 5 t_0 [m]
LATE, WINDOW = 3.0, 3.0  # since when [t_0] and how far from the gate [h_0] a rise of the surface counts
SLOW = 0.2  # a grain slower than that counts as at rest (Spinewine & Zech 2007) [m/s]


def ritter(x: Floats, t: float, deep: float) -> Floats:
    """Depth of a dam break over a dry rigid bed [m], shape as x; Ritter 1892.

    x : distance from the gate [m]. t : time since it is gone [s]. deep : depth upstream [m].

    >>> ritter(np.array([0.0]), 0.5, 0.09).tolist() == [0.04]
    True
    """
    c = math.sqrt(G * deep)
    return np.clip(2.0 * c - x / t, 0.0, 3.0 * c) ** 2 / (9.0 * G)


def broken(seed: int, pressure: str = "hydrostatic") -> dict[str, Floats]:
    """Let a bed settle, then the dam break over it; `profiles` of that.

    pressure : of the row, by its name in a case.

    Raises
    ------
    KeyboardInterrupt : a run was stopped.
    """
    path = case_path(f"validation/{CASE}.toml")
    differs = {"seed": str(seed), "water.row.pressure": pressure}
    case = read(path, differs)
    with TemporaryDirectory() as folder:
        loose = read(path, {**SETTLING, **differs})
        settled = whole(run(loose, f"{folder}/settled", progress=False))
        scene = build(case).scene
        x = np.array(settled.frames.x[-1])
        x[:, 1] %= scene.period[1]
        assert case.stop.time is not None
        done = run_scene(
            scene, State.at_rest(x), f"{folder}/broken", frames=case.record.frames,
            stop=Stop(time=case.stop.time), progress=False,
        )  # fmt: skip
        return profiles(whole(done))


def whole(run: Results) -> Results:
    """The run, if it came to its end; raises KeyboardInterrupt."""
    if not run.complete:
        raise KeyboardInterrupt
    return run


def profiles(run: Results) -> dict[str, Floats]:
    """Surface and bed over distance and time, and the grains above the bed in the last frame.

    Returns
    -------
    `t` [s], shape (n_frame,); `x` [m], middles of the segments, shape (n_segment,). `surface` and `bed` [m],
    where the concentration reaches half of `packed`, shape (n_frame, n_segment). Of the last frame, shape
    (n_segment,): `rest`, where that of the grains at rest does [m]; `concentration` of grains between it and
    the surface [-], nan where there is no water; `highest`, top of the highest grain faster than `SLOW` [m],
    0 where there is none.
    """
    found = row_of(run)
    frames, row = np.arange(len(found.t)), found.row
    last = long_section(run, bed="rest")
    x, v = np.asarray(run.frames.x[-1]), np.asarray(run.frames.v[-1])
    highest, moving = np.zeros(row.n_segment), (v * v).sum(axis=1) > SLOW**2
    at = np.clip(((x[moving, 0] - row.x_low) / row.dx).astype(np.int64), 0, row.n_segment - 1)
    np.maximum.at(highest, at, x[moving, 2] + 0.5 * run.scene.d[moving])
    return {
        "t": found.t, "x": row.x, "surface": found.surface, "bed": bed_line(run, found, frames, "packed"),
        "rest": last.bed, "concentration": last.concentration, "highest": highest,
    }  # fmt: skip


def front(x: Floats, surface: Floats) -> float:
    """First place downstream of the gate where the surface is within one diameter of that far ahead [m].

    nan where there is none upstream of `AHEAD`, whose bed is then no reference. Ritter's front with this
    limit runs at 1.44 sqrt(g h_0).
    """
    over = surface - surface[_within(x, *AHEAD)].mean() - D
    k = int(np.argmax((x > GATE) & (over <= 0.0)))
    if k == 0 or x[k] >= AHEAD[0]:
        return math.nan
    part = over[k - 1] / (over[k - 1] - over[k]) if over[k - 1] > 0.0 else 0.0
    return float(x[k - 1] + part * (x[k] - x[k - 1]))


def scour(x: Floats, bed: Floats) -> float:
    """How far the bed within one depth of the gate lies below that ahead of the wave, in diameters [-]."""
    return float(bed[_within(x, *AHEAD)].mean() - bed[np.abs(x - GATE) < DEEP].mean()) / D


def jump(t: Floats, x: Floats, surface: Floats) -> float:
    """Largest rise of the surface downstream, near the gate and behind the front, over h_0 [-].

    The largest of the frames since `LATE`; the surface is the mean of three segments.
    surface : [m], shape (n_frame, n_segment).
    """
    rises = [0.0]
    for one in surface[t >= LATE * T_0]:
        inside = (np.abs(x - GATE) < WINDOW * DEEP) & (x < front(x, one))
        smooth = np.convolve(np.pad(one, 1, mode="edge"), np.full(3, 1.0 / 3.0), mode="valid")[inside]
        rises.append(float((smooth - np.minimum.accumulate(smooth)).max(initial=0.0)))
    return max(rises) / DEEP


def lead(x: Floats, end: float, depth: Floats, concentration: Floats) -> float:
    """Concentration in the front quarter of the wave less that in the quarter at the gate [-].

    x, depth : [m], shape (n_segment,). end : of the wave [m].
    """
    quarter = 0.25 * (end - GATE)
    held = np.where(depth > 0.0, concentration, 0.0) * depth
    sums = [
        (held[part].sum(), depth[part].sum())
        for part in (_within(x, end - quarter, end), _within(x, GATE, GATE + quarter))
    ]
    (ahead, wave), (behind, gate) = sums
    return float(ahead / wave - behind / gate) if wave > 0.0 and gate > 0.0 else math.nan


def reach(x: Floats, end: float, depth: Floats, highest: Floats) -> float:
    """Share of the depth in the front quarter of the wave up to which grains move [-].

    highest : height of the top of the highest moving grain over the bed at rest [m]. Others as in `lead`.
    """
    part = _within(x, end - 0.25 * (end - GATE), end)
    all_of_it = float(depth[part].sum())
    return float(np.clip(highest, 0.0, depth)[part].sum()) / all_of_it if all_of_it > 0.0 else math.nan


def speed(t: Floats, x: Floats, surface: Floats) -> float:
    """Speed of the front from 2 to 5 t_0, by least squares, over sqrt(g h_0) [-]."""
    some = t >= 2.0 * T_0
    ends = [front(x, one) for one in surface[some]]
    return (
        float(np.polyfit(t[some], ends, 1)[0]) / math.sqrt(G * DEEP) if np.isfinite(ends).all() else math.nan
    )


def _within(x: Floats, low: float, high: float) -> NDArray[np.bool_]:
    return (x > low) & (x < high)


def dam_break(seed: int, pressure: str = "hydrostatic") -> Task:
    """The task of `broken`."""
    differs = {} if pressure == "hydrostatic" else {"pressure": pressure}
    return calculation(broken, seed=seed, seconds=700.0, **differs)


def tasks(plan: Plan) -> Sequence[Task]:
    """Two seeds, at the full level alone: some ten minutes each, the settling of the bed included."""
    return [dam_break(seed) for seed in SEEDS] if plan.level is Level.FULL else []


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """The four signs, by the seed that shows each least."""
    return [finding(found, SEEDS)] if plan.level is Level.FULL else []


def finding(found: Found, seeds: Sequence[int], pressure: str = "hydrostatic", under: str = "") -> Finding:
    """The four signs with these seeds; `under` says the pressure in words."""
    runs = [found[dam_break(seed, pressure)] for seed in seeds]
    t, x = runs[0]["t"], runs[0]["x"]
    ends = [front(x, one["surface"][-1]) for one in runs]
    depths = [np.maximum(one["surface"][-1] - one["rest"], 0.0) for one in runs]
    scours = [scour(x, one["bed"][-1]) for one in runs]
    rises = [jump(t, x, one["surface"]) for one in runs]
    each = list(zip(runs, ends, depths, strict=True))
    leads = [lead(x, end, depth, one["concentration"]) for one, end, depth in each]
    reaches = [reach(x, end, depth, one["highest"] - one["rest"]) for one, end, depth in each]
    speeds = [speed(t, x, one["surface"]) for one in runs]
    moving = [scour(x, one["rest"]) for one in runs]
    ours = [
        Curve(f"{name}, seed {seed}", x - GATE, 100.0 * one[name][-1])
        for seed, one in zip(seeds, runs, strict=True)
        for name in ("surface", "bed")
    ]
    closed = Curve(
        "Ritter's surface over a rigid bed", x - GATE, 100.0 * (BED + ritter(x - GATE, float(t[-1]), DEEP))
    )
    said = "; ".join(
        f"{name} {', '.join(f'{one:.3g}' for one in values)}"
        for name, values in (
            ("scour in diameters", scours), ("rise over h_0", rises), ("lead", leads),
            ("reach", reaches), ("front over sqrt(g h_0)", speeds),
        )
    )  # fmt: skip
    return DECLARED["dam-break-bed"].finding(
        ours, [closed],
        {
            "scour": min(scours), "rise": min(rises), "lead": min(leads), "reach": min(reaches),
            "front": float(np.mean(speeds)), "moving": float(np.mean(moving)),
        },
        [Curve("bed at the start", x - GATE, np.full(len(x), 100.0 * BED))],
        said=said, seeds=len(seeds), under=under,
    )  # fmt: skip
