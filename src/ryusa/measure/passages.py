"""Grains that passed feeds and exits, one by one, with what each feed still owes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.statistics import Average, average, ratio
from ryusa.measure.steadiness import BLOCKS
from ryusa.measure.table import Averaged, Averages
from ryusa.model.feeds import IN, NONE, OUT, Population
from ryusa.printed import ByShape

Ints = NDArray[np.int64]
SEEN = 400  # instants of the window at which the backlog is given
_SLACK = 1.0e-6  # of an interval between two instants, for a time that is one of them


@dataclass(frozen=True, repr=False)
class Gate(ByShape):
    """A feed or an exit: what passed it within a window.

    Attributes
    ----------
    name : of the feed or the exit.
    way : model.traffic.IN for a feed, OUT for an exit.
    t : when its grains passed [s], ascending, shape (n,).
    d, m, speed : their diameters [m], masses [kg] and speeds [m/s] then, shape (n,).
    mass : their mass together [kg].
    owed, owed_n : mass [kg] and number of the grains that were due and had found no place, at the times
        `Passages.instants`, shape (k,); 0 for an exit.
    """

    name: str
    way: int
    t: Floats
    d: Floats
    m: Floats
    speed: Floats
    mass: float
    owed: Floats
    owed_n: Ints

    @property
    def label(self) -> str:
        """Such as "in by hose"."""
        return f"{'in' if self.way == IN else 'out'} by {self.name}"


@dataclass(frozen=True, repr=False)
class Passages(Averaged):
    """Grains that entered and left within a window, each as one row; a clump is one grain.

    Attributes
    ----------
    window : begin and end [s].
    records : the passages, dtype model.PASSAGE, in order of time.
    through : name of the feed or the exit of each.
    gates : each feed, then each exit.
    instants : times at which the backlog is given [s], shape (k,).
    n_begin, m_begin, n_end, m_end : grains that are there at both ends of the window, and their mass [kg];
        at the end is there what was there at the begin, and came, less what left, to the last bit.
    averages : rates over the window and mean speeds of the grains that left, with their errors.
    """

    window: tuple[float, float]
    records: NDArray[np.void]
    through: tuple[str, ...]
    gates: tuple[Gate, ...]
    instants: Floats
    n_begin: int
    m_begin: float
    n_end: int
    m_end: float
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per passage; `due_s` is when a grain that entered should have, nan for an exit."""
        found: list[dict[str, object]] = []
        for row, name in zip(self.records, self.through, strict=True):
            came, (x, y, z), (u, v, w) = row["way"] == IN, row["x"].tolist(), row["v"].tolist()
            found.append(
                {
                    "t_s": row["t"].item(), "way": "in" if came else "out", "through": name,
                    "id": row["grain"].item(), "d_m": row["d"].item(), "m_kg": row["m"].item(),
                    "speed_m_per_s": math.hypot(u, v, w),
                    "v_x_m_per_s": u, "v_y_m_per_s": v, "v_z_m_per_s": w, "x_m": x, "y_m": y, "z_m": z,
                    "due_s": row["due"].item() if came else math.nan,
                }
            )  # fmt: skip
        return found


def passages(run: Run, begin: float | None = None, end: float = math.inf) -> Passages:
    """Every grain that a feed brought or an exit took, and rates, totals and backlog of each.

    Parameters
    ----------
    run : a run folder.
    begin, end : window of the times at which grains passed [s]; `begin` defaults to the case's
        `record.settle`, and it ends at the last frame at the latest.

    Raises
    ------
    ResultsError : the run has no feeds and exits, or its record ends before the window begins.

    Notes
    -----
    Times are those at which a grain entered, or crossed the exit: between two frames, and between the steps
    at which a run lets grains in and out. A rate is what passed over the length of the window; its standard
    error is that of 128 equal parts of it. A grain that comes in again counts each time.

    A feed owes the grains that were due at the last instant at which grains enter and had found no place.
    """
    traffic = run.scene.traffic
    if traffic is None:
        raise ResultsError("the run has no feeds and no exits; [[feeds]] and [[exits]] of the case give some")
    begin = settle_time(run) if begin is None else begin
    last = float(run.frames.t[-1]) if len(run.frames.t) else 0.0
    end = min(end, last)
    if not end > begin:
        raise ResultsError(f"the record ends at t = {last:g} s; no time is left from {begin:g} s on")
    every = run.passages[np.argsort(run.passages["t"], kind="stable")]
    inside = every[(every["t"] >= begin) & (every["t"] <= end)]
    instants = _instants(run, begin, end)
    gates = [_gate(one.name, IN, inside, k, *_owed(run, k, instants)) for k, one in enumerate(traffic.feeds)]
    none = np.zeros(len(instants)), np.zeros(len(instants), np.int64)
    gates += [_gate(one.name, OUT, inside, k, *none) for k, one in enumerate(traffic.exits)]
    names = {IN: [one.name for one in traffic.feeds], OUT: [one.name for one in traffic.exits]}
    n_begin, m_begin = _there(run, every[every["t"] < begin])
    n_end, m_end = _there(run, every[every["t"] <= end])
    return Passages(
        window=(begin, end),
        records=inside,
        through=tuple(names[int(row["way"])][int(row["at"])] for row in inside),
        gates=tuple(gates),
        instants=instants,
        n_begin=n_begin, m_begin=m_begin, n_end=n_end, m_end=m_end,
        averages=Averages(
            "passages", tuple(_averages(inside, gates, begin, end)), _notes(gates, n_end, m_end)
        ),
    )  # fmt: skip


def _gate(name: str, way: int, rows: NDArray[np.void], k: int, owed: Floats, owed_n: Ints) -> Gate:
    own = rows[(rows["way"] == way) & (rows["at"] == k)]
    speed = np.linalg.norm(own["v"], axis=1)
    return Gate(name, way, own["t"], own["d"], own["m"], speed, math.fsum(own["m"]), owed, owed_n)


def _there(run: Run, rows: NDArray[np.void]) -> tuple[int, float]:
    """Grains that are there after some passages, and their mass, rounded once [kg]."""
    traffic, scene = run.scene.traffic, run.scene
    assert traffic is not None
    first = scene.of_heads()[1][: traffic.n_first][scene.heads[: traffic.n_first]]
    return len(first) + int(rows["way"].sum()), math.fsum([*first, *(rows["m"] * rows["way"])])


def _instants(run: Run, begin: float, end: float) -> Floats:
    """Times at which grains enter and leave, at most `SEEN` of the window, the last among them [s]."""
    assert run.scene.traffic is not None
    between = run.scene.traffic.interval * run.scene.dt
    low, high = math.ceil(begin / between - _SLACK), math.floor(end / between + _SLACK)
    if high < low:
        return np.array([high * between])
    return np.unique(np.linspace(high, low, min(SEEN, high - low + 1)).round()) * between


def _owed(run: Run, k: int, instants: Floats) -> tuple[Floats, Ints]:
    """Mass [kg] and number of the grains due at feed k and not yet in, at some instants."""
    scene, rows = run.scene, run.passages
    assert scene.traffic is not None
    _, masses = scene.of_heads()
    first = Population.first(scene.traffic, masses, scene.heads)
    own = np.flatnonzero((first.feed == k) & np.isfinite(first.due))
    again = rows[(rows["way"] == OUT) & (rows["to"] == k) & (rows["to"] != NONE)]
    came = rows[(rows["way"] == IN) & (rows["at"] == k)]
    slack = _SLACK * scene.dt
    due = _up_to(np.append(first.due[own], again["t"]), np.append(masses[own], again["m"]), instants + slack)
    entered = _up_to(came["step"] * scene.dt, came["m"], instants + slack)
    count = due[1] - entered[1]
    return np.where(count > 0, due[0] - entered[0], 0.0), count


def _up_to(t: Floats, m: Floats, instants: Floats) -> tuple[Floats, Ints]:
    """Mass [kg] and number of what happened up to each instant."""
    order = np.argsort(t, kind="stable")
    count = np.searchsorted(t[order], instants, side="right")
    return np.concatenate([[0.0], np.cumsum(m[order])])[count], count.astype(np.int64)


def _averages(rows: NDArray[np.void], gates: Sequence[Gate], begin: float, end: float) -> list[Average]:
    came, gone = rows[rows["way"] == IN], rows[rows["way"] == OUT]
    edges = np.linspace(begin, end, BLOCKS + 1)

    def rate(name: str, unit: str, t: Floats, amount: Any) -> Average:
        parts = np.histogram(t, edges, weights=amount)[0]
        return ratio(name, unit, [parts], [np.diff(edges)], (begin, end))

    found = [
        rate("rate_in", "kg/s", came["t"], came["m"]),
        rate("rate_out", "kg/s", gone["t"], gone["m"]),
        rate("grains_in", "1/s", came["t"], None),
        rate("grains_out", "1/s", gone["t"], None),
    ]
    found += [rate(one.label, "kg/s", one.t, one.m) for one in gates]
    exits = [one for one in gates if one.way == OUT and len(one.t)]
    found += [average(f"speed {one.label}", "m/s", [one.speed], (begin, end)) for one in exits]
    return found


def _notes(gates: Sequence[Gate], n_end: int, m_end: float) -> tuple[str, ...]:
    found: list[str] = []
    for one in gates:
        kind = f"feed '{one.name}' brought" if one.way == IN else f"exit '{one.name}' took"
        owed = f"; it owes {one.owed_n[-1]} ({one.owed[-1]:.4g} kg)" if one.owed_n[-1] else ""
        found.append(f"{kind} {_grains(len(one.t))}, {one.mass:.6g} kg{owed}")
    return (*found, f"there at the end of the window: {_grains(n_end)}, {m_end:.6g} kg")


def _grains(count: int) -> str:
    return "1 grain" if count == 1 else f"{count} grains"
