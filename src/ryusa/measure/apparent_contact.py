"""Contact as a film shows it: for how long two grains look as if they touched."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import CaseError, ResultsError
from ryusa.measure._run import Floats, Run, frames_between, settle_time
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import average
from ryusa.measure.table import Averaged, Averages
from ryusa.model.scene import EventRule
from ryusa.printed import ByShape
from ryusa.results.touching import touching_pairs

FPS = 250.0  # frames of a film per second
RESOLUTION = 0.05  # gap from which two grains look apart, over the mean of their diameters
DENSER = 4  # frames of the run for each frame of the film, at least
HALF = 0.5  # a stay cut after n frames lasts n or more; it counts as cut this much before n

Ints = NDArray[np.int64]


@dataclass(frozen=True, repr=False)
class NearPairs(ByShape):
    """Pairs of grains within a resolution at frames of a run.

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    resolution : largest gap over the mean of both diameters, at a plane over that of the grain [-].
    n_id : number of ids: free grains, fixed grains, planes and faces, of which the first stands for its wall.
    step : time step [s]; a frame comes with the first step after its time, so at most this late.
    frame, pair : index of the frame, and i n_id + j of the pair with ids i, j; one entry per frame and pair.
    contacts : contacts that began meanwhile, dtype model.EVENT; None where the run did not record all.
    """

    t: Floats
    resolution: float
    n_id: int
    step: float
    frame: Ints
    pair: Ints
    contacts: NDArray[np.void] | None

    @property
    def interval(self) -> float:
        """Mean time between two frames [s]."""
        return float(self.t[-1] - self.t[0]) / (len(self.t) - 1)


@dataclass(frozen=True, repr=False)
class Stays(ByShape):
    """Times during which pairs are within a resolution, in order of their begin; one entry per stay.

    Attributes
    ----------
    pair : as in `NearPairs`.
    first : index of the first frame of the stay, 1 or more: stays that began before are left out.
    frames : number of frames of the stay.
    cut : whether the last of them is the last one of all, so that the stay may be longer.
    interval : time between two frames [s].
    """

    pair: Ints
    first: Ints
    frames: Ints
    cut: NDArray[np.bool_]
    interval: float

    @property
    def duration(self) -> Floats:
        """Number of frames times the interval [s], which is on average how long a stay lasts.

        A stay that is cut is completed after Kaplan and Meier: it gets the mean of those that are as long or
        longer, so that the mean of all is that of their estimate. Where the longest one is cut it counts as
        it is, and the mean is a lower bound.
        """
        whole = self.frames.astype(np.float64)
        if self.cut.any():
            steps, left = self._survival()
            # From a step to the last
            area = np.append(np.cumsum((np.diff(steps) * left[:-1])[::-1])[::-1], 0.0)
            at = np.searchsorted(steps, whole[self.cut] - HALF)
            whole[self.cut] = np.maximum(steps[at] + area[at] / left[at], whole[self.cut])
        return whole * self.interval

    @property
    def median(self) -> float:
        """Duration that half of them do not exceed [s], after Kaplan and Meier; nan if too many are cut."""
        if not len(self.frames):
            return math.nan
        steps, left = self._survival()
        below = np.flatnonzero(left <= 0.5)
        return float(steps[below[0]]) * self.interval if len(below) else math.nan

    @property
    def cut_share(self) -> float:
        """Share of the stays that are cut [-]; nan without any."""
        return float(self.cut.mean()) if len(self.cut) else math.nan

    def _survival(self) -> tuple[Floats, Floats]:
        """Numbers of frames, and the share of the stays that have more of them."""
        from scipy.stats import CensoredData, ecdf  # the import takes half a second

        found = ecdf(
            CensoredData(uncensored=1.0 * self.frames[~self.cut], right=self.frames[self.cut] - HALF)
        ).sf
        return np.asarray(found.quantiles), np.asarray(found.probabilities)


@dataclass(frozen=True, repr=False)
class ApparentContact(Averaged):
    """Contact as a film shows it.

    Attributes
    ----------
    t : times of the frames of the film [s].
    film : apparent contacts: stays within the resolution, by the frames of the film.
    near : stays within the resolution, by the frames of the run.
    seen : which of these a frame of the film shows, shape (n_stay,).
    collisions : number of contacts that began in each of them, shape (n_stay,); none where not recorded.
    n_id : as in `NearPairs`.
    averages : means with their errors.
    """

    t: Floats
    film: Stays
    near: Stays
    seen: NDArray[np.bool_]
    collisions: Ints
    n_id: int
    averages: Averages

    def series(self) -> list[dict[str, object]]:
        """One dictionary per apparent contact."""
        one = self.film
        return [
            {
                "i": pair // self.n_id,
                "j": pair % self.n_id,
                "begin_s": float(self.t[k]),
                "frames": n,
                "cut": cut,
            }
            for pair, k, n, cut in zip(
                one.pair.tolist(), one.first.tolist(), one.frames.tolist(), one.cut.tolist(), strict=True
            )
        ]


def apparent_contact(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    fps: float = FPS,
    resolution: float = RESOLUTION,
) -> ApparentContact:
    """Apparent contacts of all pairs on a film of a run.

    Parameters
    ----------
    run : a run folder.
    begin, end : when the film begins and ends [s]; `begin` defaults to the case's `record.settle`.
    fps : frames of the film per second [1/s].
    resolution : gap below which two grains look as if they touched, over the mean of their diameters [-].

    Raises
    ------
    CaseError : the frames of the run are not four times as dense as those of the film.
    ResultsError : fewer than two frames of the film lie in the window.

    Notes
    -----
    The film begins with the first frame of the window; each of its frames is the nearest frame of the run,
    at most an eighth of its interval away, and nothing is interpolated. An apparent contact is a stay within
    the resolution over consecutive frames; it lasts their number over `fps`. A stay of T is seen in T fps
    frames on average and, if T < 1/fps, not at all with probability 1 - T fps. So those that are seen last
    max(T, 1/fps) on average: no film shows anything shorter than the time between its frames. Stays that
    began before the first frame are left out, since long ones are over-represented among them.
    """
    return on_film(near_pairs(run, begin, end, resolution), fps)


def near_pairs(run: Run, begin: float | None, end: float, resolution: float) -> NearPairs:
    """Pairs within a resolution at every frame in a window; arguments as of `apparent_contact`."""
    since = settle_time(run) if begin is None else begin
    t = np.asarray(run.frames.t, dtype=np.float64)
    kept = frames_between(t, since, end)
    first, last = kept.start, kept.stop
    scene = run.scene
    n_id = scene.n_partner
    first_face = np.zeros(0, np.int64)
    if scene.walls is not None:
        first_face = n_id - scene.n_face + np.searchsorted(scene.walls.wall, np.arange(scene.walls.n_wall))
    counts, pairs = np.zeros(last - first, dtype=np.int64), [np.zeros(0, dtype=np.int64)]
    for k in range(first, last):
        x = np.asarray(run.frames.x[k], dtype=np.float64)
        i, j = touching_pairs(x, scene_at(run, float(t[k])), float(t[k]), resolution)
        if scene.walls is not None:  # a grain that goes from face to face stays at its wall: its first face
            face = j >= n_id - scene.n_face
            j[face] = first_face[scene.walls.wall[j[face] - n_id + scene.n_face]]
        pairs.append(np.unique(i * n_id + j))
        counts[k - first] = len(pairs[-1])
    contacts = None
    if scene.events == EventRule.ALL:
        began = run.contacts["t_begin"]
        contacts = run.contacts[(began >= t[first]) & (began <= t[last - 1])]
    which = np.repeat(np.arange(last - first), counts)
    return NearPairs(t[first:last], resolution, n_id, scene.dt, which, np.concatenate(pairs), contacts)


def on_film(near: NearPairs, fps: float) -> ApparentContact:
    """Apparent contacts on a film of `fps` frames per second; see `apparent_contact`."""
    t = near.t
    longest = float(np.diff(t).max()) - near.step
    if longest > (1.0 + 1.0e-9) / (DENSER * fps):
        raise CaseError(
            "fps",
            f"{fps:g}",
            f"the frames of the run are {longest:.4g} s apart, and there must be {DENSER} to each of the "
            f'film; run it with record.frames = "{1.0 / (DENSER * fps):.4g} s" or less, or ask for at most '
            f"{1.0 / (DENSER * longest):.4g} frames per second",
        )
    wanted = t[0] + np.arange(int((t[-1] - t[0]) * fps * (1.0 + 1.0e-9)) + 1) / fps
    shown = np.searchsorted(0.5 * (t[1:] + t[:-1]), wanted)  # nearest frames of the run
    if len(shown) < 2:
        raise ResultsError(
            f"a film of {fps:g} frames per second from t = {t[0]:g} s to {t[-1]:g} s has one frame; "
            "2 or more are needed"
        )
    place = np.full(len(t), -1)
    place[shown] = np.arange(len(shown))
    meanwhile = near.frame <= shown[-1]
    on = meanwhile & (place[near.frame] >= 0)
    film = _stays(near.pair[on], place[near.frame[on]], len(shown), 1.0 / fps)
    stays = _stays(near.pair[meanwhile], near.frame[meanwhile], int(shown[-1]) + 1, near.interval)
    seen = np.searchsorted(shown, stays.first + stays.frames) > np.searchsorted(shown, stays.first)
    collisions, lasting = _collisions(near, stays)
    window = (float(t[0]), float(t[shown[-1]]))
    items = (
        average("apparent_time", "s", [film.duration], window),
        average("stay", "s", [stays.duration], window),
        average("unseen", "-", [1.0 - seen], window),
        average("collisions_per_stay", "-", [1.0 * collisions], window),
        average("collision_time", "s", [lasting], window),
    )
    notes = (
        f"film of {fps:g} frames per second; grains look in contact up to a gap of {near.resolution:g} d",
        f"medians: apparent_time {film.median:.4g} s, stay {stays.median:.4g} s",
        f"cut by the end of the window: {_cut(film)} apparent contacts and {_cut(stays)} stays, "
        "completed after Kaplan and Meier",
    )
    return ApparentContact(
        t[shown], film, stays, seen, collisions, near.n_id, Averages("apparent_contact", items, notes)
    )


def _stays(pair: Ints, frame: Ints, n_frame: int, interval: float) -> Stays:
    """Runs of consecutive frames of every pair; those that begin with the first frame are left out."""
    order = np.lexsort((frame, pair))
    pair, frame = pair[order], frame[order]
    breaks = (np.diff(pair) != 0) | (np.diff(frame) != 1)
    starts = np.flatnonzero(np.append(True, breaks)[: len(pair)])
    frames = np.diff(np.append(starts, len(pair)))
    pair, first = pair[starts], frame[starts]
    kept = np.flatnonzero(first > 0)
    kept = kept[np.argsort(first[kept], kind="stable")]
    cut = first + frames == n_frame
    return Stays(pair[kept], first[kept], frames[kept], cut[kept], interval)


def _collisions(near: NearPairs, stays: Stays) -> tuple[Ints, Floats]:
    """Contacts that began in each stay, or within a frame of it, and their durations [s]."""
    if near.contacts is None:
        return np.zeros(0, dtype=np.int64), np.zeros(0)
    contacts, t = near.contacts, near.t
    whole = contacts[np.isfinite(contacts["closing_end"])]  # of the others the partner was taken away
    every = np.concatenate([stays.pair, contacts["i"] * near.n_id + contacts["j"]])
    rank = 2.0 * (t[-1] - t[0]) * np.unique(every, return_inverse=True)[1]  # one pair lies after the other
    mine, began = rank[: len(stays.pair)], np.sort(rank[len(stays.pair) :] + contacts["t_begin"])
    after = t[np.minimum(stays.first + stays.frames, len(t) - 1)]
    counts = np.searchsorted(began, mine + after, "right") - np.searchsorted(began, mine + t[stays.first - 1])
    return counts, whole["t_end"] - whole["t_begin"]


def _cut(stays: Stays) -> str:
    return f"{int(stays.cut.sum())} of {len(stays.cut)}"
