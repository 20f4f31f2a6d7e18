"""Grains that start and stop moving: entrainment and deposition per area of bed and time."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.measure.statistics import Average, average, ratio
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.measure.transport import places_of, window_of
from ryusa.model import Scene

SPEED = 0.1  # speed from which a grain moves, over sqrt(g d)
DURATION = 1.0  # time for which it must, over sqrt(d/g)


@dataclass(frozen=True, repr=False)
class Entrainment(Averaged):
    """Grains that start and stop moving.

    Attributes
    ----------
    t, dt : middle and length of the time between two frames [s], shape (n,).
    started, stopped : grains that began to move and to rest in it, shape (n,).
    started_volume, stopped_volume : their volume [m3], shape (n,).
    speed : from which a grain moves [m/s].
    duration : how long it must stay so, moving or at rest, to be counted [s]: a whole number of frames.
    area : of the bed, all lanes together [m2].
    averages : entrainment and deposition [1/(m2 s)], the same by volume [m/s], volume of moving grains per
        area [m] and their mean speed along the bed [m/s].
    """

    t: Floats
    dt: Floats
    started: Floats
    stopped: Floats
    started_volume: Floats
    stopped_volume: Floats
    speed: float
    duration: float
    area: float
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per time between two frames."""
        columns = {
            "t_s": self.t, "dt_s": self.dt,
            "started": self.started.astype(np.int64), "stopped": self.stopped.astype(np.int64),
            "started_volume_m3": self.started_volume, "stopped_volume_m3": self.stopped_volume,
        }  # fmt: skip
        return lines(columns)


def entrainment(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    speed: float | None = None,
    duration: float | None = None,
) -> Entrainment:
    """Grains that start and stop moving, per area of bed and time.

    Parameters
    ----------
    run : a run folder, periodic along x.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.
    speed : from which a grain moves [m/s]; default 0.1 sqrt(g d).
    duration : how long it must stay so to be counted [s]; default sqrt(d/g). Rounded up to whole frames.

    Raises
    ------
    ResultsError : a window too short to see a grain rest, start and go on, or an area that is not bounded.

    Notes
    -----
    The speed of a grain between two frames is the way between its centres over the time, so vibration in
    place does not count as moving. A grain has started once it was at rest for `duration`, whatever it did
    in between, and then moves for `duration`; it is counted when that began. Starts and stops of the first
    and last `duration` of the window cannot be told, and it is shortened by as much. Both rates depend on the
    threshold; give it with them.
    """
    t, first, last, scene, area = window_of(run, begin, end, least=2)
    d, g = float(scene.d.mean()), float(np.linalg.norm(scene.gravity))
    speed = SPEED * math.sqrt(g * d) if speed is None else speed
    duration = DURATION * math.sqrt(d / g) if duration is None else duration
    dt = np.diff(t)
    n, step = len(dt), float(np.median(dt))
    need = max(math.ceil(duration / step - 1.0e-9), 1)
    if n - 2 * need + 1 < 1:
        raise ResultsError(
            f"{n + 1} frames from t = {t[0]:g} s to {t[-1]:g} s: too few to see a grain rest and move for "
            f"{duration:g} s each"
        )
    counts, moving, distance = _count(run, first, last, scene, speed * dt, need)
    seen = slice(need, n - need + 1)
    return Entrainment(
        t=(0.5 * (t[1:] + t[:-1]))[seen],
        dt=dt[seen],
        started=counts[0, seen],
        stopped=counts[1, seen],
        started_volume=counts[2, seen],
        stopped_volume=counts[3, seen],
        speed=speed,
        duration=need * step,
        area=area,
        averages=Averages(
            "entrainment",
            (
                *_rates(counts[:, seen] / area, dt[seen], (float(t[need]), float(t[n - need + 1]))),
                *_motion(moving, distance, dt, area, (float(t[0]), float(t[-1]))),
            ),
            (
                f"a grain moves if it is faster than {speed:.3g} m/s; it is counted once it has moved, or "
                f"rested, for {need * step:.3g} s",
            ),
        ),
    )


def _count(
    run: Run, first: int, last: int, scene: Scene, threshold: Floats, need: int
) -> tuple[Floats, Floats, Floats]:
    """Count the grains that start and stop between frames.

    Parameters
    ----------
    threshold : displacement between two frames beyond which a grain moves [m], shape (n,).
    need : frame intervals for which a grain must move or rest to be counted.

    Returns
    -------
    counts : grains that start, grains that stop, and the volume of both [m3], shape (4, n).
    moving, distance : volume in motion [m3], and volume times displacement along x [m4], shape (n,).
    """
    ball = np.pi / 6.0 * scene.d**3
    n = len(threshold)
    counts, moving, distance = np.zeros((4, n)), np.zeros(n), np.zeros(n)
    state, last_flag, length = (np.full(scene.n_grain, -1, dtype=np.int64) for _ in range(3))
    k = 0
    for x in places_of(run, first, last):
        for before, after in pairwise(x):
            flag = (np.linalg.norm(after - before, axis=1) > threshold[k]).astype(np.int64)
            moving[k] = (flag * ball).sum()
            distance[k] = (flag * ball * (after - before)[:, 0]).sum()
            length = np.where(flag == last_flag, length + 1, 1)
            last_flag = flag
            sure = length >= need
            up, down = sure & (flag == 1) & (state == 0), sure & (flag == 0) & (state == 1)
            counts[:, k - need + 1] += up.sum(), down.sum(), ball[up].sum(), ball[down].sum()
            state = np.where(sure, flag, state)
            k += 1
    return counts, moving, distance


def _rates(per_area: Floats, dt: Floats, window: tuple[float, float]) -> list[Average]:
    """Rates of entrainment and deposition, by number and by volume, from the counts per area (4, n)."""
    names = (
        ("entrainment", "1/(m2 s)"),
        ("deposition", "1/(m2 s)"),
        ("entrained_volume", "m/s"),
        ("deposited_volume", "m/s"),
    )
    return [ratio(name, unit, [per_area[c]], [dt], window) for c, (name, unit) in enumerate(names)]


def _motion(
    moving: Floats, distance: Floats, dt: Floats, area: float, window: tuple[float, float]
) -> list[Average]:
    """Volume of moving grains per area, and their mean speed along the bed."""
    return [
        average("moving", "m", [moving / area], window),
        ratio("moving_speed", "m/s", [distance], [moving * dt], window),
    ]
