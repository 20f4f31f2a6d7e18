"""Force and torque on each wall over time, and the work of walls that move."""

import math
from dataclasses import dataclass, replace

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, frames_between, settle_time
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import average
from ryusa.measure.table import Averaged, Averages
from ryusa.model import Scene
from ryusa.model.servo import driven
from ryusa.model.walls import N_IMPULSE, TOWARDS, Carrier

AXES = ("x", "y", "z")
ALONG = 1.0e-9  # sine of the angle up to which two directions are one


@dataclass(frozen=True, repr=False)
class WallForces(Averaged):
    """What grains do to walls: means from frame to frame, of every step in between.

    Attributes
    ----------
    t : middle of the time between two frames [s], shape (n,).
    names : of the walls.
    force : of the grains on each wall [N], shape (n, n_wall, 3).
    torque : about the axis point of each wall [N m], shape (n, n_wall, 3).
    axis_point : where that point is at the begin of the window [m], shape (n_wall, 3); a wall takes it along.
    power : that each wall gives to the grains [W], shape (n, n_wall); 0 where neither it nor its
        surface moves.
    contacts : mean number of contacts of each wall, shape (n, n_wall).
    travel : way of each wall along the direction of its servo [m], shape (n, n_wall); None without a servo.
    averages : of the components of each wall, those that are not zero throughout; the notes name the walls
        that no grain touched.
    """

    t: Floats
    names: tuple[str, ...]
    force: Floats
    torque: Floats
    axis_point: Floats
    power: Floats
    contacts: Floats
    travel: Floats | None
    averages: Averages

    @property
    def untouched(self) -> tuple[str, ...]:
        """Names of the walls that no grain touched."""
        felt = np.any((self.force != 0.0).any(axis=2) | (self.contacts != 0.0), axis=0)
        return tuple(name for name, one in zip(self.names, felt.tolist(), strict=True) if not one)

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per time between two frames and wall."""
        return [
            {
                "t_s": float(t),
                "wall": name,
                **{f"force_{axis}_N": float(self.force[k, w, a]) for a, axis in enumerate(AXES)},
                **{f"torque_{axis}_Nm": float(self.torque[k, w, a]) for a, axis in enumerate(AXES)},
                "power_W": float(self.power[k, w]),
                "contacts": float(self.contacts[k, w]),
                **({} if self.travel is None else {"travel_m": float(self.travel[k, w])}),
            }
            for k, t in enumerate(self.t)
            for w, name in enumerate(self.names)
        ]


def walls(run: Run, begin: float | None = None, end: float = math.inf) -> WallForces:
    """Force and torque of the grains on each wall, and the power that each gives to them.

    Parameters
    ----------
    run : a run folder with [[walls]].
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.

    Raises
    ------
    ResultsError : no wall, or fewer than two frames in the window.

    Notes
    -----
    The engine sums the impulses at every step; their difference between two frames over the time is the mean
    force, whatever happens in between. The torque is about the axis point of the wall, which is its `at`
    where the case gives no axis_point, and the origin where it gives neither, as for the bottom and the dams
    of a stream. Weight of the wall itself is not included.
    """
    if run.scene.walls is None:
        raise ResultsError("the run has no [[walls]]; planes are not measured")
    since = settle_time(run) if begin is None else begin
    return forces_of_frames(run, frames_between(np.asarray(run.tally["t"]), since, end))


def forces_of_frames(run: Run, kept: slice) -> WallForces:
    """`walls` from one given frame to another; the run has walls."""
    assert run.scene.walls is not None
    names, every = run.scene.walls.names, np.asarray(run.tally["t"], dtype=np.float64)
    t = every[kept]
    impulse = np.asarray(run.walls, dtype=np.float64).reshape(len(every), len(names), N_IMPULSE)[kept]
    dt = np.diff(t)
    rate = np.diff(impulse, axis=0) / dt[:, None, None]
    window = (float(t[0]), float(t[-1]))
    items = [
        average(f"{name}: {quantity}", unit, [rate[:, w, k]], window)
        for w, name in enumerate(names)
        for k, (quantity, unit) in enumerate(_QUANTITIES)
        if np.any(rate[:, w, k] != 0.0)
    ]
    travel = np.asarray(run.wall_travel, dtype=np.float64)[kept]
    now = scene_at(run, window[0]).walls or run.scene.walls
    found = WallForces(
        0.5 * (t[1:] + t[:-1]), names, rate[:, :, :3], rate[:, :, 3:6],
        np.array([Carrier.of(row, window[0]).axis_point for row in now.motion]), rate[:, :, 6], rate[:, :, 7],
        0.5 * (travel[1:] + travel[:-1]) if run.scene.has_servo else None, Averages("walls", tuple(items)),
    )  # fmt: skip
    notes = _notes(found, now.moving().tolist())
    if run.row is not None:
        notes = (*notes, "the water is not in them: `ryusa measure RUN loads` has both, of dams and meshes")
    return replace(found, averages=replace(found.averages, notes=notes))


def _notes(found: WallForces, moves: list[bool]) -> tuple[str, ...]:
    """Whose forces these are, about which points the torques are, and which walls no grain touched."""
    points = [
        f"{name} ({', '.join(f'{one + 0.0:.4g}' for one in place)}) m"
        + " at the begin, moving with it" * moving
        for name, place, moving in zip(found.names, found.axis_point.tolist(), moves, strict=True)
    ]
    said = ("forces of the grains on the walls; torques about the axis point at " + ", ".join(points),)
    if found.untouched:
        return (*said, f"no grain touched: {', '.join(found.untouched)}")
    return said


def pressed_lid(scene: Scene) -> tuple[int, float]:
    """Number of the one wall that a servo presses along z, and the sign of that direction.

    Raises
    ------
    ResultsError : no such wall, or several.
    """
    pressed = driven(scene.walls).tolist()
    if scene.walls is None or len(pressed) != 1:
        raise ResultsError(f"needs one wall with a servo, the lid; the run has {len(pressed) or 'none'}")
    towards = float(scene.walls.servo[pressed[0], TOWARDS + 2])
    if abs(towards) < 1.0 - ALONG:
        raise ResultsError(f"wall {scene.walls.names[pressed[0]]!r} is not pressed along z, as a lid is")
    return pressed[0], math.copysign(1.0, towards)


_QUANTITIES = (
    *((f"force {axis}", "N") for axis in AXES),
    *((f"torque {axis}", "N m") for axis in AXES),
    ("power", "W"),
)
