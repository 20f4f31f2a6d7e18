"""Grains and mass that enter and leave through feeds and exits, over time."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.statistics import ratio
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.model.feeds import IN, OUT

Ints = NDArray[np.int64]
ENTERED, LEFT = "rate_in", "rate_out"


@dataclass(frozen=True, repr=False)
class Discharge(Averaged):
    """What passed feeds and exits, at the frames of a window; mass and number balance at every frame.

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    n, m : grains that are there, and their mass [kg], shape (n_frame,).
    n_in, n_out : grains that had entered and left since the start of the run, shape (n_frame,).
    m_in, m_out : their mass [kg], shape (n_frame,).
    by_feed, by_exit : mass that had passed each by its name [kg], shape (n_frame,).
    averages : rates over the window, in mass and number, with their errors.
    """

    t: Floats
    n: Ints
    m: Floats
    n_in: Ints
    n_out: Ints
    m_in: Floats
    m_out: Floats
    by_feed: dict[str, Floats]
    by_exit: dict[str, Floats]
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per frame; rates are those since the frame before, nan at the first."""
        columns: dict[str, Any] = {
            "t_s": self.t, "present": self.n, "present_kg": self.m, "in": self.n_in, "out": self.n_out,
            "in_kg": self.m_in, "out_kg": self.m_out,
            f"{ENTERED}_kg_per_s": _rate(self.m_in, self.t), f"{LEFT}_kg_per_s": _rate(self.m_out, self.t),
        }  # fmt: skip
        columns |= {f"in_by_{name}_kg": one for name, one in self.by_feed.items()}
        columns |= {f"out_by_{name}_kg": one for name, one in self.by_exit.items()}
        return lines(columns)


def discharge(run: Run, begin: float | None = None, end: float = math.inf) -> Discharge:
    """Mass and number of grains in, out and there, and the rates at which they pass.

    Parameters
    ----------
    run : a run folder.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.

    Raises
    ------
    ResultsError : the run has no feeds and exits, or fewer than two frames in the window.

    Notes
    -----
    A grain that comes in again counts each time. Its passage counts in the interval of frames in which the
    run let it in or out, so that what is there grows by exactly what entered less what left.
    """
    traffic = run.scene.traffic
    if traffic is None:
        raise ResultsError("the run has no feeds and no exits; [[feeds]] and [[exits]] of the case give some")
    begin = settle_time(run) if begin is None else begin
    times = np.asarray(run.frames.t, dtype=np.float64)
    seen = np.flatnonzero((times >= begin) & (times <= end))
    if len(seen) < 2:
        raise ResultsError(f"{len(seen)} frames from t = {begin:g} s: a rate needs two or more")
    t, step = times[seen], np.asarray(run.frames.step)[seen]
    rows = run.passages
    came, gone = rows[rows["way"] == IN], rows[rows["way"] == OUT]
    n_in, n_out = _passed(came, step, weigh=False), _passed(gone, step, weigh=False)
    m_in, m_out = _passed(came, step), _passed(gone, step)
    first = run.scene.m[: traffic.n_first]
    n_first = int(run.scene.heads[: traffic.n_first].sum())  # a clump counts once
    by_feed = {one.name: _passed(came[came["at"] == k], step) for k, one in enumerate(traffic.feeds)}
    by_exit = {one.name: _passed(gone[gone["at"] == k], step) for k, one in enumerate(traffic.exits)}
    window = (float(t[0]), float(t[-1]))
    rates = {ENTERED: m_in, LEFT: m_out}
    rates |= {f"in by {name}": one for name, one in by_feed.items() if len(by_feed) > 1}
    rates |= {f"out by {name}": one for name, one in by_exit.items() if len(by_exit) > 1}
    numbers = {"grains_in": n_in, "grains_out": n_out}
    dt = np.diff(t)
    items = [ratio(name, "kg/s", [np.diff(one)], [dt], window) for name, one in rates.items()]
    items += [ratio(name, "1/s", [np.diff(one)], [dt], window) for name, one in numbers.items()]
    return Discharge(
        t=t, n=(n_first + n_in - n_out).astype(np.int64), m=first.sum() + m_in - m_out,
        n_in=n_in.astype(np.int64), n_out=n_out.astype(np.int64), m_in=m_in, m_out=m_out,
        by_feed=by_feed, by_exit=by_exit,
        averages=Averages("discharge", tuple(items), _notes(n_first, n_in, n_out, m_in, m_out)),
    )  # fmt: skip


def _passed(rows: NDArray[np.void], step: Ints, *, weigh: bool = True) -> Floats:
    """Mass [kg], or number, of the grains that had passed at each step."""
    amounts = rows["m"] if weigh else np.ones(len(rows))
    sums = np.concatenate([[0.0], np.cumsum(amounts)])
    return sums[np.searchsorted(rows["step"], step, side="right")]


def _rate(amount: Floats, t: Floats) -> Floats:
    return np.concatenate([[math.nan], np.diff(amount) / np.diff(t)])


def _notes(n_first: int, n_in: Floats, n_out: Floats, m_in: Floats, m_out: Floats) -> tuple[str, ...]:
    there = n_first + n_in[-1] - n_out[-1]
    return (
        f"since the start: {int(n_in[-1])} grains in ({m_in[-1]:.4g} kg), {int(n_out[-1])} out "
        f"({m_out[-1]:.4g} kg), {int(there)} there at the end of the window",
    )
