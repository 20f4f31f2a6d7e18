"""A deposit in a row of columns over time: its slope, what is stored, and the share that is trapped."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ryusa.catalogue import BEDS
from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.along_row import dam_named, volumes_of_heads
from ryusa.measure.long_section import Bed, bed_line, row_of
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import Average, average, ratio, standard_error
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.model import ColumnRow
from ryusa.model.feeds import IN, OUT
from ryusa.spelling import known_word

FEWEST = 3  # segments with a deposit to which a line is fitted
ROUND_OFF = 1.0e-9  # of the grains in a reach, which are added up; less than that is no grain


@dataclass(frozen=True, repr=False)
class Deposit(Averaged):
    """Grains in a reach of a row and the line of their bed at each frame; arrays of shape (n_frame,).

    Attributes
    ----------
    t : times of the frames [s].
    reach : its begin and end along x [m].
    fitted : begin and end of the segments to which the line is fitted [m], shape (n_frame, 2): those with a
        deposit, up to the upstream face of the dam; nan where there are none.
    slope : of the line of least squares through the bed, fall over horizontal distance [-]; nan with fewer
        than three segments that have a deposit.
    slope_error : its standard error by the scatter of the bed about it [-].
    held : volume of grains in the reach per width [m2].
    stored : the same less that in the first frame.
    brought : volume per width that came over the upstream end of the reach or by feeds within it, since then.
    passed : that went over the downstream end or by exits within it.
    trapped : stored over brought [-]; nan where nothing was brought, to round-off.
    unaccounted : grains in the frame less those that feeds and exits have left there [m2]; round-off.
    averages : of the slope and the rates of these volumes over the window; the trapped share at its end.
    """

    t: Floats
    reach: tuple[float, float]
    fitted: Floats
    slope: Floats
    slope_error: Floats
    held: Floats
    stored: Floats
    brought: Floats
    passed: Floats
    trapped: Floats
    unaccounted: Floats
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One line for each frame."""
        columns = {
            "t_s": self.t, "slope": self.slope, "slope_error": self.slope_error,
            "fitted_from_m": self.fitted[:, 0], "fitted_to_m": self.fitted[:, 1], "held_m2": self.held,
            "stored_m2": self.stored, "brought_m2": self.brought, "passed_m2": self.passed,
            "trapped": self.trapped, "unaccounted_m2": self.unaccounted,
        }  # fmt: skip
        return lines(columns)


def deposit(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    dam: str | None = None,
    reach: tuple[float, float] | None = None,
    bed: Bed = "packed",
) -> Deposit:
    """Slope of a deposit, volume stored in a reach, and the share of what came that is trapped there.

    Parameters
    ----------
    run : its water is a row of columns with ends, and it has free grains.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`. Volumes count from its first
        frame.
    dam : name of a dam: the reach goes from the begin of the row to its downstream face. Default the dam
        farthest upstream; without one the whole row.
    reach : begin and end of another reach [m].
    bed : what ends the bed, as in `long_section`.

    Raises
    ------
    CaseError : `bed` is no such word.
    ResultsError : no such row, dam or reach, a periodic row, no grains, or fewer than two frames.

    Notes
    -----
    A grain is where its centre is, each sphere of a clump with its share of the volume; one that enters or
    leaves, where the centre of the clump is. Volumes leave pores out. stored = brought - passed at every
    frame, to round-off: what passes is counted from frame to frame with the places at which grains came and
    left. The line is that of least squares through the bed of the segments in the reach whose deposit is at
    least one mean diameter thick over bottom and dams: bare bottom has a slope of its own. The
    error of its slope allows for bed heights that are correlated along x (`standard_error`).
    """
    known_word(bed, BEDS, "bed")
    found = row_of(run)
    row, times = found.row, found.t
    if row.periodic or not run.scene.n_grain:
        raise ResultsError("needs free grains in a row of columns with ends; a period stores nothing")
    low, high, face = _reach(row, dam, reach)
    begin = settle_time(run) if begin is None else begin
    frames = np.flatnonzero((times >= begin) & (times <= end))
    if len(frames) < 2:
        raise ResultsError(f"{len(frames)} frames from {begin:g} to {end:g} s: rates need two or more")
    t = times[frames]
    width = row.column.area / (row.n_segment * row.dx)
    beyond, came, gone = _volumes(run, frames, (-math.inf, low, high))
    over = (beyond - beyond[0] - (came - gone)) / width  # -inf, low and high: passed each since the begin
    held = (beyond[:, 1] - beyond[:, 2]) / width
    brought = over[:, 1] + (came[:, 1] - came[:, 2]) / width
    passed = over[:, 2] + (gone[:, 1] - gone[:, 2]) / width
    stored = held - held[0]
    beds = bed_line(run, found, frames, bed)
    slope, error, fitted = _slopes(run, row, beds, found.floor, (low, face), t)
    came_in = brought > ROUND_OFF * (held.max() + abs(brought).max())
    with np.errstate(invalid="ignore", divide="ignore"):
        trapped = np.where(came_in, stored / brought, math.nan)
    volumes = {"stored": stored, "brought": brought, "passed": passed}
    scatter = float(np.sqrt(np.nanmean(error**2))) if np.isfinite(error).any() else math.nan
    return Deposit(
        t, (low, high), fitted, slope, error, held, stored, brought, passed, trapped, over[:, 0],
        Averages(
            "deposit", _averages(t, slope, volumes, float(trapped[-1])),
            (
                f"reach: x = {low:.4g} to {high:.4g} m; since t = {t[0]:.4g} s {brought[-1]:.4g} m2 came and "
                f"{passed[-1]:.4g} m2 went, {stored[-1]:.4g} m2 are stored, per width and without pores",
                _of_fit(fitted, slope, scatter),
                _of_share(bool(came_in[-1]), low),
            ),
        ),
    )  # fmt: skip


def _averages(t: Floats, slope: Floats, volumes: Mapping[str, Floats], trapped: float) -> tuple[Average, ...]:
    """Slope, rate of each volume per width, and the share that is trapped in the end."""
    window = (float(t[0]), float(t[-1]))
    rates = [
        ratio(f"{name}_rate", "m2/s", [np.diff(one)], [np.diff(t)], window) for name, one in volumes.items()
    ]
    return (
        average("slope", "-", [slope], window), *rates, _counted("trapped_share", trapped, window),
    )  # fmt: skip


def _counted(name: str, value: float, window: tuple[float, float]) -> Average:
    """A share of grains that were counted, which has no error in its own run."""
    nan = math.nan
    return Average(name, "-", value, nan, int(math.isfinite(value)), 0, nan, window, nan, nan, nan)


def _of_share(came: bool, low: float) -> str:
    """What the trapped share is, in words."""
    if came:
        return (
            "trapped share: counted at the last frame, so without an error of its own; how much it differs "
            "from run to run, runs with other seeds tell"
        )
    return (
        f"trapped share: none, since no grain came into the reach at x = {low:.4g} m or by a feed. Of grains "
        "that lie in it from the start it says nothing: begin the reach downstream of them (--reach)"
    )


def _reach(row: ColumnRow, dam: str | None, reach: tuple[float, float] | None) -> tuple[float, float, float]:
    """Begin and end of the reach, and where the deposit meets the dam [m]."""
    first, last = row.x_low, row.x_low + row.n_segment * row.dx
    if dam is not None and reach is not None:
        raise ResultsError("give a dam or a reach, not both")
    if reach is not None:
        if not first <= reach[0] < reach[1] <= last:
            raise ResultsError(
                f"reach from {reach[0]:g} to {reach[1]:g} m: must ascend within the row, from {first:g} to "
                f"{last:g} m"
            )
        return (*reach, reach[1])
    chosen = dam_named(row, dam)
    if chosen is None:
        return first, last, last
    return first, first + chosen.end * row.dx, first + chosen.first * row.dx


def _volumes(run: Run, frames: np.ndarray, places: tuple[float, ...]) -> tuple[Floats, Floats, Floats]:
    """Volume of grains beyond some places [m3]: at each frame, and that came and left since the first.

    Each has the shape (n_frame, n_place).
    """
    solid, at = run.scene.solid_volume, np.array(places)
    beyond, came, gone = np.zeros((3, len(frames), len(places)))
    for m, k in enumerate(frames.tolist()):
        x = np.asarray(run.frames.x[k])[:, 0]
        beyond[m] = ((x[:, None] >= at) * solid[:, None]).sum(axis=0)  # nan, away: beyond no place
    if run.scene.traffic is None:
        return beyond, came, gone
    steps, rows, volume = np.asarray(run.frames.step)[frames], run.passages, volumes_of_heads(run)
    for way, into in ((IN, came), (OUT, gone)):
        own = rows[(rows["way"] == way) & (rows["step"] > steps[0])]
        amounts = (own["x"][:, :1] >= at) * volume[own["grain"]][:, None]
        sums = np.concatenate([np.zeros((1, len(at))), np.cumsum(amounts, axis=0)])
        into[:] = sums[np.searchsorted(own["step"], steps, side="right")]
    return beyond, came, gone


def _of_fit(fitted: Floats, slope: Floats, scatter: float) -> str:
    """Over which distances the lines were fitted, in words."""
    known = np.flatnonzero(np.isfinite(slope))
    if not len(known):
        return f"slope: in no frame {FEWEST} segments have a deposit at least one mean diameter thick"
    (low, high), (first, last) = fitted[known[-1]].tolist(), (fitted[known, 0].min(), fitted[known, 1].max())
    return (
        f"slope: line of least squares through the deposit where it is at least one mean diameter thick, in "
        f"the last frame from x = {low:.4g} to {high:.4g} m, in all within {first:.4g} to {last:.4g} m; the "
        f"scatter of the bed about it gives an error of {scatter:.2g} in one frame"
    )


def _slopes(
    run: Run, row: ColumnRow, beds: Floats, floor: Floats, reach: tuple[float, float], t: Floats
) -> tuple[Floats, Floats, Floats]:
    """Slope of the line through the bed and its standard error [-] in each frame, and over which x [m]."""
    inside = (row.x > reach[0]) & (row.x < reach[1])
    slope, error = np.full((2, len(beds)), math.nan)
    fitted = np.full((len(beds), 2), math.nan)
    for m, bed in enumerate(beds):
        there = inside & (bed - floor >= run.scene.d_mean)
        n = int(there.sum())
        if n:
            fitted[m] = row.x[there].min() - 0.5 * row.dx, row.x[there].max() + 0.5 * row.dx
        if n < FEWEST:
            continue
        x, z = row.x[there] - row.x[there].mean(), bed[there] - bed[there].mean()
        steep = float(x @ z / (x @ x))
        scatter = (z - steep * x) * x
        g_x, _, minus_g_z = np.asarray(scene_at(run, float(t[m])).gravity).tolist()
        slope[m] = math.tan(math.atan2(g_x, -minus_g_z) - math.atan(steep))
        wide = n * standard_error([scatter]).error / float(x @ x) * math.sqrt(n / (n - 2.0))
        error[m] = wide * (1.0 + slope[m] ** 2) / (1.0 + steep**2)
    return slope, error, fitted
