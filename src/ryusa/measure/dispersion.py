"""Dispersion: how grains part from the mean motion, and the diffusivity that describes it."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.measure.statistics import average
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.measure.transport import window_of

PLACES = 4_000_000  # of grains held in memory at once
QUARTER = 0.25  # of the window: longest lag
HALF = 0.5  # of the longest lag: where the fit begins
UNEVEN = 0.01  # by which the time between two frames may differ


@dataclass(frozen=True, repr=False)
class Dispersion(Averaged):
    """Mean squared displacement of the free grains about the mean motion.

    Attributes
    ----------
    lag : times over which displacements are taken [s], shape (n_lag,).
    along, across, normal : mean squared displacement along x, y and z [m2], shape (n_lag,).
    fit : first and last lag of the fit [s].
    averages : diffusivities along, across and normal to the bed [m2/s].
    """

    lag: Floats
    along: Floats
    across: Floats
    normal: Floats
    fit: tuple[float, float]
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per lag."""
        columns = {
            "lag_s": self.lag, "along_m2": self.along, "across_m2": self.across, "normal_m2": self.normal
        }  # fmt: skip
        return lines(columns)


def dispersion(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    layer: float = 0.5,
    fit: tuple[float, float] | None = None,
) -> Dispersion:
    """Mean squared displacement about the mean motion, and diffusivities.

    Parameters
    ----------
    run : a run folder, periodic along x.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.
    layer : thickness in mean diameters of the layers in which the mean motion along x is taken.
    fit : first and last lag of the fit [s]; default an eighth and a quarter of the window.

    Raises
    ------
    ResultsError : fewer than 9 frames, frames at uneven times, or fewer than two lags in the fit.

    Notes
    -----
    Between two frames a grain moves with the mean of all grains whose way has its middle in the same layer,
    over the whole window; what remains of its way along x is summed (Campbell 1997, J. Fluid Mech. 348, 85).
    Without that the shear would carry neighbours apart. Along y and z the mean motion is that of all grains.
    The diffusivity is half the slope of a straight line through the mean squared displacement over the lags
    of the fit; a line that is not straight there is no diffusion. Every frame from which the longest lag
    fits into the window gives one value, and the error is that of their mean. All free grains count, those
    of a bed at rest too.
    """
    t, first, last, scene, _ = window_of(run, begin, end, least=9)
    dt = np.diff(t)
    step = float(np.median(dt))
    if abs(dt[-1] - step) > UNEVEN * step:  # the frame at the end of the run
        t, last, dt = t[:-1], last - 1, dt[:-1]
    if np.abs(dt - step).max() > UNEVEN * step:
        raise ResultsError("the frames are not evenly spaced in time; choose a window in which they are")
    span = float(t[-1] - t[0])
    low, high = (HALF * QUARTER * span, QUARTER * span) if fit is None else fit
    n_lag = min(int(high / step + UNEVEN), len(t) - 1)
    lag = np.asarray(step * np.arange(1, n_lag + 1), dtype=np.float64)
    chosen = np.flatnonzero(lag >= low - UNEVEN * step)
    if len(chosen) < 2:
        raise ResultsError(f"fewer than two lags from {low:g} s to {high:g} s; frames are {step:g} s apart")
    thickness = layer * float(scene.d.mean())
    squares = _squares(run, first, last, n_lag, thickness)
    pull = lag[chosen] - lag[chosen].mean()
    origins = len(t) - n_lag
    slope = np.tensordot(pull / (pull**2).sum(), squares[chosen, :origins], axes=1)
    window = float(t[0]), float(t[-1])
    directions = ("along", "normal") if scene.plane_case else ("along", "across", "normal")
    mean = np.array([squares[k, : len(t) - k - 1].mean(axis=0) for k in range(n_lag)])
    return Dispersion(
        lag=lag,
        along=mean[:, 0],
        across=mean[:, 1],
        normal=mean[:, 2],
        fit=(float(lag[chosen[0]]), float(lag[-1])),
        averages=Averages(
            "dispersion",
            tuple(
                average(
                    f"diffusivity_{name}",
                    "m2/s",
                    [0.5 * slope[:, ("along", "across", "normal").index(name)]],
                    window,
                )
                for name in directions
            ),
            (
                f"fit from lag {lag[chosen[0]]:.4g} s to {lag[-1]:.4g} s, over {scene.n_grain} grains; "
                f"mean motion along x in layers of {thickness:.3g} m",
            ),
        ),
    )


def _squares(run: Run, first: int, last: int, n_lag: int, thickness: float) -> Floats:
    """Mean squared displacement from each frame over each lag [m2], (n_lag, n_frame - 1, 3)."""
    n_frame, n_grain = last - first, run.scene.n_grain
    few = max(PLACES // n_frame, 1)
    spans = [slice(a, min(a + few, n_grain)) for a in range(0, n_grain, few)]
    sums: dict[int, Floats] = {}
    drift = np.zeros((n_frame - 1, 3))
    for span in spans:
        x = np.asarray(run.frames.x[first:last, span], dtype=np.float64)
        way, level = np.diff(x, axis=0), _level(x, thickness)
        drift += way.sum(axis=1) / n_grain
        low = int(level.min())
        counts = np.bincount((level - low).ravel())
        ways = np.bincount((level - low).ravel(), way[:, :, 0].ravel())
        for k in np.flatnonzero(counts):
            sums[low + int(k)] = sums.get(low + int(k), np.zeros(2)) + np.array([counts[k], ways[k]])
    bottom = min(sums)
    mean = np.zeros(max(sums) - bottom + 1)
    for k, (count, moved) in sums.items():
        mean[k - bottom] = moved / count
    squares = np.zeros((n_lag, n_frame - 1, 3))
    for span in spans:
        x = np.asarray(run.frames.x[first:last, span], dtype=np.float64)
        way, level = np.diff(x, axis=0), _level(x, thickness)
        way[:, :, 0] -= mean[level - bottom]
        way[:, :, 1:] -= drift[:, None, 1:]
        path = np.concatenate([np.zeros((1, *way.shape[1:])), np.cumsum(way, axis=0)])
        for k in range(n_lag):
            squares[k, : n_frame - k - 1] += ((path[k + 1 :] - path[: -k - 1]) ** 2).sum(axis=1) / n_grain
    return squares


def _level(x: Floats, thickness: float) -> np.ndarray:
    """Layer in which the middle of each way between two frames lies, (n_frame - 1, n_grain)."""
    return np.floor(0.5 * (x[1:, :, 2] + x[:-1, :, 2]) / thickness).astype(np.int64)
