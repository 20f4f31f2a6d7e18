"""Power draw of a drum that turns, and where the power goes."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.laws.drum import critical_rate
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.statistics import average
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.measure.walls import walls
from ryusa.model.tally import HELD, LOSSES
from ryusa.model.walls import AXIS_POINT, SPIN, FaceKind

SAME = 1.0e-9  # relative difference up to which rates and points of the axis are those of the shell
LEVEL = 1.0e-6  # component along gravity up to which an axis is level
SLACK = 1.0e-3  # by which a window may fall short of whole turns: frames are at whole steps


@dataclass(frozen=True, repr=False)
class Mill(Averaged):
    """Torque and power of a shell and all that turns with it.

    Attributes
    ----------
    together : names of the cylinder that turns about its level axis, and of all walls that turn with it.
    rate : angular velocity, without its sign [rad/s].
    critical : over that at which a grain of mean diameter stays on the shell [-].
    t : middle of the time between two frames [s], shape (n,).
    torque : that the walls exert on the grains about the axis, in the sense of the rotation [N m], (n,).
    power : torque times angular velocity [W], shape (n,).
    given : power of these walls in the energy account [W], shape (n,).
    lost : by dashpots, friction and springs that part [W], shape (n,).
    stored : by which motion, height and springs hold more [W], shape (n,).
    turns : number of whole turns over which the averages are taken.
    averages : torque, power, given, lost and stored over whole turns.
    """

    together: tuple[str, ...]
    rate: float
    critical: float
    t: Floats
    torque: Floats
    power: Floats
    given: Floats
    lost: Floats
    stored: Floats
    turns: int
    averages: Averages

    def series(self) -> list[dict[str, object]]:
        """One dictionary per time between two frames."""
        columns = {
            "t_s": self.t, "torque_Nm": self.torque, "power_W": self.power, "given_W": self.given,
            "lost_W": self.lost, "stored_W": self.stored,
        }  # fmt: skip
        return lines(columns)


def mill(run: Run, begin: float | None = None, end: float = math.inf) -> Mill:
    """Torque, power and losses of a drum that turns about its level axis, with or without lifters.

    Parameters
    ----------
    run : a run folder with a cylinder that turns about its own level axis.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.

    Raises
    ------
    ResultsError : no such cylinder, or less than one whole turn in the window.

    Notes
    -----
    Torques are from impulses summed at every step, on all walls that turn about the same axis at the same
    rate. The power that they give, in the energy account, is force times velocity at every contact: the
    same by another way. What is given and not lost is stored, in the mean over whole turns of a steady mill
    nothing. The critical speed is that of `ryusa.laws.drum.critical_rate`.
    """
    together, axis, rate, critical = _shell(run)
    first, last, turns = _whole_turns(run, begin, end, 2.0 * math.pi / abs(rate))
    every = np.asarray(run.tally["t"], dtype=np.float64)
    found, dt = walls(run, float(every[first]), float(every[last])), np.diff(every[first : last + 1])
    torque, given = np.zeros(last - first), np.zeros(last - first)
    assert run.scene.walls is not None
    for w in together:
        arm = run.scene.walls.motion[w, AXIS_POINT : AXIS_POINT + 3] - axis
        on_wall = found.torque[:, w] + np.cross(arm, found.force[:, w])
        torque -= on_wall @ run.scene.walls.motion[w, SPIN : SPIN + 3] / rate
        given += found.power[:, w]
    work = {name: np.asarray(one, dtype=np.float64)[first : last + 1] for name, one in run.tally.items()}
    lost = np.diff(sum(work[one.name.lower()] for one in LOSSES)) / dt
    stored = np.diff(sum(work[name] for name in HELD)) / dt
    window = (float(every[first]), float(every[last]))
    series = (
        ("torque", "N m", torque), ("power", "W", rate * torque), ("given", "W", given),
        ("lost", "W", lost), ("stored", "W", stored),
    )  # fmt: skip
    names = tuple(run.scene.walls.names[w] for w in together)
    notes = (
        f"{names[0]!r} and {len(names) - 1} walls that turn with it: {30.0 * rate / math.pi:.4g} rpm, "
        f"{critical:.1%} of the critical speed; {turns} whole turns",
    )
    return Mill(
        names, rate, critical, found.t, torque, rate * torque, given, lost, stored, turns,
        Averages("mill", tuple(average(name, unit, [one], window) for name, unit, one in series), notes),
    )  # fmt: skip


def _shell(run: Run) -> tuple[list[int], Floats, float, float]:
    """Numbers of the walls that turn together, a point of their axis [m], rate [rad/s], and over critical."""
    scene, g = run.scene, float(np.linalg.norm(run.scene.gravity))
    if scene.walls is None or g == 0.0:
        raise ResultsError("the run has no walls, or no gravity: no mill")
    face, motion, up = scene.walls.face, scene.walls.motion, -scene.gravity / g
    for f in np.flatnonzero(scene.walls.kind == FaceKind.CYLINDER):
        shell = int(scene.walls.wall[f])
        spin, axis = motion[shell, SPIN : SPIN + 3], face[f, 3:6]
        rate = float(np.linalg.norm(spin))
        if rate == 0.0 or abs(float(spin @ axis)) < (1.0 - SAME) * rate or abs(float(axis @ up)) > LEVEL:
            continue
        point, radius = face[f, :3], float(face[f, 6])
        same = [
            w
            for w in range(scene.n_wall)
            if np.allclose(motion[w, SPIN : SPIN + 3], spin, rtol=0.0, atol=SAME * rate)
            and float(np.linalg.norm(np.cross(motion[w, AXIS_POINT : AXIS_POINT + 3] - point, axis)))
            <= SAME * radius
        ]
        if shell in same:
            together = [shell, *(w for w in same if w != shell)]
            return together, point.copy(), rate, rate / critical_rate(radius, float(scene.d_mean), g)
    raise ResultsError("the run has no cylinder that turns about its own level axis: no mill")


def _whole_turns(run: Run, begin: float | None, end: float, turn: float) -> tuple[int, int, int]:
    """First and last frame of the whole turns in the window, counted from its end, and their number."""
    since = settle_time(run) if begin is None else begin
    t = np.asarray(run.frames.t, dtype=np.float64)
    inside = np.flatnonzero((t >= since) & (t <= end))
    turns = int((t[inside[-1]] - t[inside[0]]) / turn * (1.0 + SLACK)) if len(inside) else 0
    if turns < 1:
        raise ResultsError(f"less than one turn, {turn:.3g} s, from t = {since:g} s to {end:g} s")
    last = int(inside[-1])
    return max(int(np.abs(t - (t[last] - turns * turn)).argmin()), 0), last, turns
