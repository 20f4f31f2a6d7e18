"""Direct shear test: friction and dilation over the displacement of one half of a box against the other."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import average, ratio
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.measure.walls import ALONG, pressed_lid, walls
from ryusa.model import Scene
from ryusa.model.walls import SPIN, SWING, VELOCITY, pose

PEAK = 0.25  # displacement over which the peak is a mean, in mean diameters
LAST = 0.5  # share of the displacement that counts as residual
LEAST = 8  # frames in the window


@dataclass(frozen=True, repr=False)
class DirectShear(Averaged):
    """One half of a box, drawn along under the other.

    Attributes
    ----------
    lid : name of the wall that a servo presses.
    moving : names of the walls of the half that moves.
    t : middle of the time between two frames [s], shape (n,).
    displacement : of the moving half since the window began [m], shape (n,).
    normal, shear : force across the plane between the halves [N], shape (n,).
    rise : of the lid since the window began, positive where grains dilate [m], shape (n,).
    peak : largest friction as a mean over a quarter of a diameter [-].
    peak_at : displacement in the middle of it [m].
    averages : of the second half of the displacement: mu, the residual friction [-]; normal [N]; rise [m];
        imbalance, the sum of the shear forces on both halves over the shear force [-].
    """

    lid: str
    moving: tuple[str, ...]
    t: Floats
    displacement: Floats
    normal: Floats
    shear: Floats
    rise: Floats
    peak: float
    peak_at: float
    averages: Averages

    def series(self) -> list[dict[str, object]]:
        """One dictionary per time between two frames."""
        columns = {
            "t_s": self.t, "displacement_m": self.displacement, "normal_N": self.normal,
            "shear_N": self.shear, "mu": self.shear / self.normal, "rise_m": self.rise,
        }  # fmt: skip
        return lines(columns)


def direct_shear(run: Run, begin: float | None = None, end: float = math.inf) -> DirectShear:
    """Friction across the plane between two halves of a box, one of which moves, and the rise of the lid.

    Parameters
    ----------
    run : a run folder with one wall that a servo presses downwards or upwards, the lid, at rest sideways,
        and walls that move along one level direction at a constant velocity by the end of the window.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`, when shearing should begin.

    Raises
    ------
    ResultsError : no such lid or walls, or fewer than nine frames or too short a displacement in the window.

    Notes
    -----
    Walls that move are one half of the box, all others the other. The force across the plane between them is
    half of the difference of the forces on the two halves, from impulses summed at every step: as long as
    the grains hardly accelerate both carry the same shear force, and their normal forces differ by the weight
    of the grains, half of which lies above the plane if both halves hold as many. Friction is the sum of
    shear forces over that of normal forces; areas do not enter.
    """
    forces = walls(run, begin, end)
    if len(forces.t) < LEAST:
        raise ResultsError(f"{len(forces.t) + 1} frames in the window; {LEAST + 1} or more are needed")
    lid, moving, along = _halves(scene_at(run, float(forces.t[-1])))
    times = np.asarray(run.tally["t"], dtype=np.float64)
    first = int(np.searchsorted(times, forces.t[0])) - 1  # the frame with which the window begins
    places = [float(_place(run, moving[0], t) @ along) for t in (float(times[first]), *forces.t.tolist())]
    displacement = np.array(places[1:]) - places[0]
    others = np.setdiff1d(np.arange(len(forces.names)), moving)
    here, there = forces.force[:, moving].sum(axis=1), forces.force[:, others].sum(axis=1)
    shear = 0.5 * (there - here) @ along
    normal = 0.5 * np.abs((there - here)[:, 2])
    assert forces.travel is not None  # there is a servo
    rise = run.wall_travel[first, lid] - forces.travel[:, lid]
    peak, at = _peak(displacement, shear, normal, PEAK * run.scene.d_mean)
    late = displacement >= (1.0 - LAST) * displacement[-1]
    window, whole = (float(forces.t[late][0]), float(forces.t[-1])), (float(forces.t[0]), float(forces.t[-1]))
    items = (
        ratio("mu", "-", [shear[late]], [normal[late]], window),
        average("normal", "N", [normal[late]], window),
        average("rise", "m", [rise[late]], window),
        ratio("imbalance", "-", [(here + there)[late] @ along], [shear[late]], window),
    )
    notes = (
        f"lid {forces.names[lid]!r}; moving half: {', '.join(forces.names[k] for k in moving)}; displacement "
        f"{displacement[-1]:.4g} m in the window from {whole[0]:.4g} to {whole[1]:.4g} s",
        f"peak: mu = {peak:.4g} at {at:.3g} m, a mean over {PEAK:g} diameters",
        "averages are of the second half of the displacement",
    )
    return DirectShear(
        forces.names[lid], tuple(forces.names[k] for k in moving), forces.t, displacement, normal, shear,
        rise, peak, at, Averages("direct_shear", items, notes),
    )  # fmt: skip


def _place(run: Run, wall: int, t: float) -> Floats:
    """Where the origin of the frame of a wall is at a time [s], (3,) [m]."""
    found = scene_at(run, t).walls
    assert found is not None
    return pose(found.motion[wall], t)[1]


def _halves(scene: Scene) -> tuple[int, list[int], Floats]:
    """Number of the lid, numbers of the walls that move, and the direction in which they do, (3,)."""
    lid, _ = pressed_lid(scene)
    assert scene.walls is not None  # it has a lid
    names, motion = scene.walls.names, scene.walls.motion
    moving = [k for k in range(len(names)) if k != lid and motion[k, VELOCITY : VELOCITY + 3].any()]
    if not moving or motion[lid, VELOCITY : VELOCITY + 2].any():
        raise ResultsError(
            "needs walls that move under a lid that does not: one half of the box is drawn along"
        )
    velocity = motion[moving[0], VELOCITY : VELOCITY + 3]
    for k in moving:
        other = motion[k, VELOCITY : VELOCITY + 3]
        if (
            (other != velocity).any()
            or motion[k, SPIN : SPIN + 3].any()
            or motion[k, SWING : SWING + 3].any()
        ):
            raise ResultsError(
                f"wall {names[k]!r} moves otherwise than {names[moving[0]]!r}; half of the box moves as one"
            )
    speed = float(np.linalg.norm(velocity))
    if abs(float(velocity[2])) > ALONG * speed:
        raise ResultsError(f"wall {names[moving[0]]!r} does not move along a level direction")
    return lid, moving, np.asarray(velocity / speed)


def _peak(displacement: Floats, shear: Floats, normal: Floats, width: float) -> tuple[float, float]:
    """Largest friction as a mean over a displacement of that width [m], and the middle of it [m]."""
    found, at = -math.inf, math.nan
    for k, begin in enumerate(displacement.tolist()):
        last = int(np.searchsorted(displacement, begin + width, "right"))
        if displacement[-1] - begin < width:
            break
        here = float(shear[k:last].sum() / normal[k:last].sum())
        if here > found:
            found, at = here, 0.5 * (begin + float(displacement[last - 1]))
    if math.isinf(found):
        raise ResultsError(
            f"displacement of {displacement[-1]:.3g} m; a peak needs {width:.3g} m, {PEAK:g} diameters"
        )
    return found, at
