"""A film of a run, as a file that any browser or player shows: drawn without display and without OpenGL."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ryusa.errors import CaseError, ResultsError
from ryusa.measure.long_section import Bed
from ryusa.results import Results
from ryusa.spelling import nearest_word
from ryusa.view.box import Floats, box_of, needs_grains
from ryusa.view.camera import VIEWS, Camera
from ryusa.view.colouring import COLOURINGS, Colouring, value_range
from ryusa.view.film_file import check, write
from ryusa.view.margins import inner_size, margins
from ryusa.view.picture import Look, Painter
from ryusa.view.section_film import FIELD, SECTION, section_pictures

SECONDS = 10.0  # about what a film lasts, unless asked otherwise
FPS = 25.0
SIZE = (1280, 720)
SMALLEST, LARGEST = (480, 270), (7680, 4320)
MOST_PICTURES = 10_000
NEAR = 10.0  # half the height of a picture around a grain that is followed, in its diameters
_PLACES, _VALUES = 20_000_000, 5_000_000  # grains and frames from which box and colour scale are taken
_BOX_FRAMES, _VALUE_FRAMES = 60, 12  # and not fewer frames than these


@dataclass(frozen=True)
class Timing:
    """When the pictures of a film are.

    Attributes
    ----------
    times : of the pictures, evenly spaced [s].
    fps : pictures a second.
    speed : time of the run over that of the film: 0.1 is ten times slower than it was.
    frames : number of recorded frames within it.
    """

    times: Floats
    fps: float
    speed: float
    frames: int

    @property
    def seconds(self) -> float:
        """How long it lasts."""
        return len(self.times) / self.fps


def film(
    results: Results,
    path: Path,
    *,
    view: str | None = None,
    colour: str | None = None,
    begin: float = -math.inf,
    end: float = math.inf,
    frames: int | None = None,
    speed: float | None = None,
    fps: float = FPS,
    size: tuple[int, int] = SIZE,
    follow: int | None = None,
    bed: Bed | None = None,
    progress: Callable[[float], None] = lambda share: None,
) -> Timing:
    """Write a film of a run.

    Parameters
    ----------
    path : its suffix is one of `film_file.SUFFIXES`; a file that is there is replaced once the film is whole.
    view : "oblique", "side" or "top" of the grains, or "long_section" or "flow_field" of a row of columns;
        default oblique, for a plane scene side, and the long section of water alone.
    colour : a word of `COLOURINGS`; default "speed".
    begin, end : window of time shown [s]; default all frames.
    frames, speed : number of pictures, or time of the run over that of the film; default a round speed at
        which the film lasts about ten seconds.
    fps : pictures a second, 1 to 60.
    size : width and height [pixel].
    follow : free grain that stays in the middle of the picture.
    bed : of a long section, what ends the bed: "packed", the default, or "rest".
    progress : called with the share that is done.

    Notes
    -----
    The pictures are evenly spaced in time. Between two recorded frames grains are on straight lines, as in
    the page of `ryusa view`; nothing is shown before the first or after the last. Box, length scale and
    colours are the same in all pictures. A long section or flow field is that of the nearest frame,
    on axes that are the same in all pictures.

    Raises
    ------
    CaseError : names the parameter that is wrong, and what is allowed.
    ResultsError : no grains, fewer than two frames in the window, or a file that cannot be written.
    """
    if view is None:
        alone = results.row is not None and not results.scene.n_grain
        view = SECTION if alone else "side" if results.scene.plane_case else "oblique"
    _known("view", view, (*VIEWS, SECTION, FIELD))
    for axis in range(2):
        if not SMALLEST[axis] <= size[axis] <= LARGEST[axis]:
            allowed = f"must be {SMALLEST[0]}x{SMALLEST[1]} to {LARGEST[0]}x{LARGEST[1]}"
            raise CaseError("size", f"{size[0]}x{size[1]}", allowed)
    if view != SECTION:
        _left_out("is of films of long sections: view = 'long_section'", bed=bed)
    if view in (SECTION, FIELD):
        _left_out(f"is of films of grains; {view} has none", colour=colour, follow=follow)
        seen = bed or "packed"
        return _of_section(results, path, view, begin, end, frames, speed, fps, size, seen, progress)
    needs_grains(results)
    one = _colouring(colour or "speed")
    if follow is not None and results.scene.traffic is not None:
        raise CaseError("follow", follow, "cannot be used with feeds or exits: a grain may not be there yet")
    if follow is not None and not 0 <= follow < results.scene.n_grain:
        raise CaseError("follow", follow, f"must be a free grain, 0 to {results.scene.n_grain - 1}")
    window = _window(results, begin, end)
    made = _planned(results.frames.t[window], frames, speed, fps)
    check(path, size, len(made.times))
    inner = inner_size(size)
    look, beyond = _look(results, window, view, one, inner[0] / inner[1], follow)
    painter = Painter(results, look, *inner)
    digits = _digits(made.speed / fps)

    def words(t: float) -> str:
        grain = "" if follow is None else f"   grain {follow}"
        return f"t = {t:.{digits}f} s   {made.speed:.3g} × real time{grain}"

    gravity = results.scene_at(float(made.times[-1])).gravity
    longest = max((words(float(t)) for t in made.times), key=len)
    around = margins(size, _title(results), longest, look.camera, gravity, one, look.low, look.high, beyond)

    def picture(k: int) -> Image.Image:
        t = float(made.times[k])
        return around.around(painter.at(t), words(t))

    return _written(path, picture, made, progress)


def _written(
    path: Path, picture: Callable[[int], Image.Image], made: Timing, progress: Callable[[float], None]
) -> Timing:
    """Write the pictures of a film, and tell how far it is."""

    def draw(k: int) -> Image.Image:
        drawn = picture(k)
        progress((k + 1) / len(made.times))
        return drawn

    write(path, draw, len(made.times), made.fps)
    return made


def _title(results: Results) -> str:
    return str(results.case.get("title") or results.folder.resolve().name)


def _left_out(why: str, **given: object) -> None:
    """Refuse parameters that are of another kind of film."""
    for key, value in given.items():
        if value is not None:
            raise CaseError(key, value, why)


def _of_section(
    results: Results, path: Path, view: str, begin: float, end: float, frames: int | None,
    speed: float | None, fps: float, size: tuple[int, int], bed: Bed, progress: Callable[[float], None],
) -> Timing:  # fmt: skip
    """Write a film of the long section or the flow field; parameters as of `film`."""
    made = _planned(results.frames.t[_window(results, begin, end)], frames, speed, fps)
    check(path, size, len(made.times))
    title, digits = _title(results), _digits(made.speed / fps)
    pictures = section_pictures(
        results, view, made.times, size,
        lambda t: f"{title}   t = {t:.{digits}f} s   {made.speed:.3g} × real time", bed,
    )  # fmt: skip
    return _written(path, pictures, made, progress)


def _colouring(word: str) -> Colouring:
    _known("colour", word, tuple(one.word for one in COLOURINGS))
    return next(one for one in COLOURINGS if one.word == word)


def _known(key: str, word: str, words: tuple[str, ...]) -> None:
    if word not in words:
        raise CaseError(key, word, f"must be one of {', '.join(words)}", nearest_word(word, words))


def _digits(step: float) -> int:
    """Digits behind the point at which times that are a step [s] apart differ as they should.

    >>> _digits(0.04), _digits(0.144), _digits(2.0)
    (2, 2, 0)
    """
    least = min(max(0, math.ceil(-math.log10(step) - 1.0e-9)), 6)
    return least if math.isclose(step, round(step, least), rel_tol=1.0e-6) else least + 1


def _window(results: Results, begin: float, end: float) -> NDArray[np.int64]:
    """Frames of the window."""
    times = results.frames.t
    window = np.flatnonzero((times >= begin) & (times <= end))
    if len(window) < 2:
        span = f"{times[0]:.4g} .. {times[-1]:.4g} s" if len(times) else "none"
        raise ResultsError(
            f"{results.folder}: {len(window)} frames from {begin:g} to {end:g} s, and a film needs two or "
            f"more; the run holds {len(times)}: {span}"
        )
    return window


def _planned(times: Floats, frames: int | None, speed: float | None, fps: float) -> Timing:
    """When the pictures are: from the first to the last of the frames' times."""
    if not 1.0 <= fps <= 60.0:
        raise CaseError("fps", fps, "must be 1 to 60 pictures a second")
    first, last = float(times[0]), float(times[-1])
    span = last - first
    if frames is not None:
        if speed is not None:
            raise CaseError("frames", frames, f"must be left out where a speed is given (speed = {speed:g})")
        if not 2 <= frames <= MOST_PICTURES:
            raise CaseError("frames", frames, f"must be 2 to {MOST_PICTURES} pictures")
        return Timing(np.linspace(first, last, frames), fps, span * fps / (frames - 1), len(times))
    least, most = span * fps / (MOST_PICTURES - 1), span * fps
    if speed is None:
        speed = min(max(_round(span / SECONDS), least), most)
    elif not least <= speed <= most:
        raise CaseError(
            "speed", speed, f"must be {least:.3g} to {most:.3g} for {span:.3g} s of the run at {fps:g} "
            f"pictures a second, which is {MOST_PICTURES} to 2 pictures",
        )  # fmt: skip
    count = math.floor(span * fps / speed + 1.0e-9) + 1
    return Timing(np.minimum(first + np.arange(count) * speed / fps, last), fps, speed, len(times))


def _round(speed: float) -> float:
    """The nearest 1, 2 or 5 times a power of ten, by ratio."""
    power = 10.0 ** math.floor(math.log10(speed))
    near = min((1.0, 2.0, 5.0, 10.0), key=lambda k: abs(math.log(k * power / speed)))
    return float(f"{near * power:.1g}")


def _look(
    results: Results, window: NDArray[np.int64], view: str, one: Colouring, aspect: float, follow: int | None
) -> tuple[Look, tuple[bool, bool]]:
    """Camera, box and colour scale of all pictures, and whether values lie below and above the scale."""
    scene = results.scene
    shown = _some(window, scene.n_grain, _PLACES, _BOX_FRAMES)
    low, high = box_of(results, scene.d, (_centres(results, int(k)) for k in shown))
    room = 0.01 * float(np.linalg.norm(high - low))  # so that walls are seen
    periodic = np.isfinite([*scene.period, math.inf])
    low, high = low - np.where(periodic, 0.0, room), high + np.where(periodic, 0.0, room)
    camera = Camera.fitted(low, high, view, aspect)
    if follow is not None:
        camera = camera.closer(NEAR * float(scene.d[follow]))
    chosen = _some(window, scene.n_grain, _VALUES, _VALUE_FRAMES)[:: 1 if not one.steady else len(window)]
    values = np.stack([one.values(results, int(k)) for k in chosen])
    values = values if scene.traffic is None else values[np.isfinite(values)]
    least, most = value_range(one, values, scene)
    beyond = bool(values.min(initial=least) < least), bool(values.max(initial=most) > most)
    return Look(view, one, least, most, camera, (low, high), follow), beyond


def _some(window: NDArray[np.int64], n_grain: int, most: int, least: int) -> NDArray[np.int64]:
    """Frames of a window, evenly spaced, the first and last among them: about `most` grains in all."""
    count = min(max(most // max(n_grain, 1), least), len(window))
    return window[np.rint(np.linspace(0, len(window) - 1, count)).astype(np.int64)]


def _centres(results: Results, k: int) -> Floats:
    x = results.frames.x_wrapped[k]
    wrong = np.flatnonzero(~np.isfinite(x).all(axis=1))
    if len(wrong) and results.scene.traffic is None:
        raise ResultsError(
            f"{results.folder}: grain {wrong[0]} is at {x[wrong[0]]} m in the frame at "
            f"t = {results.frames.t[k]:g} s, which cannot be shown"
        )
    return x
