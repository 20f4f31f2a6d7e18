"""What a measure needs of a run folder; `results.Results` provides it, and so may a stand-in in a test."""

from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.model import Scene

Floats = NDArray[np.float64]
Above = Literal["datum", "bed crest", "mean crest"]


class Run(Protocol):
    """A run folder, read-only."""

    @property
    def case(self) -> dict[str, Any]:
        """The case, resolved, in SI."""
        ...

    @property
    def frames(self) -> Any:
        """`Frames`."""
        ...

    @property
    def scene(self) -> Scene:
        """At the start of the run."""
        ...

    @property
    def contacts(self) -> Any:
        """Contacts that ended: structured array of dtype model.EVENT."""
        ...

    @property
    def passages(self) -> Any:
        """Grains that entered and left: structured array of dtype model.PASSAGE."""
        ...

    @property
    def tally(self) -> Any:
        """Dict of arrays (n_frame,): the energy account at each frame."""
        ...

    @property
    def wall_travel(self) -> Any:
        """Of each wall along the direction of its servo at each frame (n_frame, n_wall) [m]."""
        ...

    @property
    def row(self) -> Any:
        """`WaterFrames` of a row of columns; None without."""
        ...

    @property
    def walls(self) -> Any:
        """Impulses on each wall up to each frame (n_frame, n_wall, N_IMPULSE), model.walls."""
        ...


def settle_time(run: Run) -> float:
    """Time before which measures ignore the record [s]: `record.settle` of the case, else 0."""
    value = (run.case.get("record") or {}).get("settle")
    return 0.0 if value is None else float(value)


def frames_between(t: Floats, begin: float, end: float) -> slice:
    """Numbers of the frames of a window.

    Parameters
    ----------
    t : times of all frames, ascending [s].
    begin, end : of the window, both in it [s].

    Raises
    ------
    ResultsError : fewer than two frames lie in it.
    """
    first, last = int(np.searchsorted(t, begin, "left")), int(np.searchsorted(t, end, "right"))
    if last - first < 2:
        held = f"the run holds {t[0]:g} .. {t[-1]:g} s" if len(t) else "the run holds no frame"
        raise ResultsError(
            f"{last - first} frames from t = {begin:g} s to {end:g} s; 2 or more are needed, and {held}"
        )
    return slice(first, last)


def path_of(run: Run, grain: int) -> tuple[Floats, Floats, Floats, Floats]:
    """Times [s] (n_frame,) and centre [m], velocity [m/s], spin [rad/s] of one grain, each (n_frame, 3)."""
    frames = run.frames
    pick = (slice(None), grain)
    return (
        np.asarray(frames.t, dtype=np.float64),
        np.asarray(frames.x[pick], dtype=np.float64),
        np.asarray(frames.v[pick], dtype=np.float64),
        np.asarray(frames.omega[pick], dtype=np.float64),
    )


def crest_of(scene: Scene) -> float:
    """Top of the highest fixed grain [m]; 0 where there is none."""
    return float((scene.x_fixed[:, 2] + 0.5 * scene.d_fixed).max()) if scene.n_fixed else 0.0


def level_of(scene: Scene, above: Above) -> float:
    """Height in the scene of what heights are counted from [m].

    Parameters
    ----------
    scene : its fixed grains count.
    above : "datum", z = 0 of the case; "bed crest", the top of the highest fixed grain; "mean crest", the
        mean of all their tops. 0 in a scene without fixed grains.
    """
    if above == "bed crest":
        return crest_of(scene)
    if above == "mean crest" and scene.n_fixed:
        return float((scene.x_fixed[:, 2] + 0.5 * scene.d_fixed).mean())
    return 0.0
