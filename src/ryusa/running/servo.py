"""Walls that a servo presses on the grains, corrected at fixed steps by the mean force since the last one."""

from dataclasses import dataclass, replace

import numpy as np

from ryusa.engine.protocol import Engine
from ryusa.errors import CheckpointError, WallLost
from ryusa.laws.walls import servo_speed
from ryusa.model import Scene
from ryusa.model.arrays import Floats
from ryusa.model.servo import driven, motion_with
from ryusa.model.walls import ASKED, INTERVAL, MOST_SPEED, MOST_TRAVEL, N_IMPULSE, TOUCHED, TOWARDS
from ryusa.running.checkpoint import CheckpointBlock

FORGOTTEN = 0.01  # share of the most contacts a wall has had that is forgotten at each correction


def with_servos(scene: Scene, rule: "ServoRule | None") -> Scene:
    """The scene with its walls where their servos have brought them, for an engine to be loaded with."""
    if rule is None or scene.walls is None:
        return scene
    return replace(scene, walls=replace(scene.walls, motion=rule.motion(scene)))


@dataclass
class ServoRule:
    """The servos of a run.

    Attributes
    ----------
    travel : way of each wall along the direction of its servo at the last correction [m], shape (n_wall,).
    speed : along it since then [m/s].
    impulse : of the grains on each wall along it, up to then [N s].
    touched : number of contacts of each wall times the time that they lasted, up to then [s].
    most : contacts that each wall has had between two corrections, slowly forgotten [-]; the speed is made
        for them, because a number that rises and falls with the force would bias its mean.
    t : time of the last correction [s].
    """

    travel: Floats
    speed: Floats
    impulse: Floats
    touched: Floats
    most: Floats
    t: float

    @staticmethod
    def of(scene: Scene, t: float) -> "ServoRule | None":
        """The rule of a scene at its first step, time t [s]; None where no wall has a servo."""
        if scene.walls is None or not len(scene.walls.servo):
            return None
        none = np.zeros(scene.n_wall)
        return ServoRule(none.copy(), none.copy(), none.copy(), none.copy(), none.copy(), t)

    @staticmethod
    def interval(scene: Scene) -> int:
        """Steps from one correction to the next."""
        assert scene.walls is not None
        return int(scene.walls.servo[0, INTERVAL])

    def next_step(self, scene: Scene, step: int) -> int:
        """Step of the next correction after a step."""
        return (step // self.interval(scene) + 1) * self.interval(scene)

    def travel_at(self, t: float) -> Floats:
        """Way of each wall along the direction of its servo at a time up to the next correction [m]."""
        return np.asarray(self.travel + self.speed * (t - self.t))

    def motion(self, scene: Scene) -> Floats:
        """Motion of all walls since the last correction, (n_wall, N_MOTION)."""
        assert scene.walls is not None
        return motion_with(scene.walls, self.travel, self.speed, self.t)

    def correct(self, scene: Scene, engine: Engine, step: int, t: float) -> None:
        """Set the speed of each wall by the mean force since the last correction.

        Parameters
        ----------
        scene : that holds now.
        engine : has stepped to `step`, time t [s].

        Raises
        ------
        WallLost : a wall has gone farther than its servo may.
        """
        walls = scene.walls
        assert walls is not None
        every = np.array(engine.tally().walls or np.zeros(scene.n_wall * N_IMPULSE))
        every = every.reshape(scene.n_wall, N_IMPULSE)
        travel, since = self.travel_at(t), t - self.t
        laws = (scene.contact,) if scene.materials is None else scene.materials.contact
        k_n = max(law.k_n for law in laws)
        for w in driven(walls):
            row = walls.servo[w]
            impulse, touched = float(every[w, :3] @ row[TOWARDS : TOWARDS + 3]), float(every[w, TOUCHED])
            force = (float(self.impulse[w]) - impulse) / since  # of the wall on the grains
            contacts = (touched - float(self.touched[w])) / since
            self.impulse[w], self.touched[w] = impulse, touched
            self.most[w] = max(contacts, (1.0 - FORGOTTEN) * float(self.most[w]))
            if abs(travel[w]) > row[MOST_TRAVEL]:
                raise WallLost(
                    f"wall '{walls.names[w]}' has moved {travel[w]:.4g} m along the direction of its servo, "
                    f"more than max_travel = {row[MOST_TRAVEL]:.4g} m, and exerts {force:.3g} N of the "
                    f"{row[ASKED]:.3g} N asked",
                    step,
                    t,
                    "Either there is nothing in its way, or the grains cannot carry the force: check "
                    "direction and force, or raise servo.max_travel.",
                )
            self.speed[w] = servo_speed(row[ASKED], force, float(self.most[w]), k_n, since, row[MOST_SPEED])
        self.travel, self.t = travel, t
        engine.set_walls(self.motion(scene))

    def to_block(self) -> CheckpointBlock:
        """All of it, for a checkpoint."""
        arrays = {"travel": self.travel, "speed": self.speed, "impulse": self.impulse}
        arrays |= {"touched": self.touched, "most": self.most}
        return CheckpointBlock({"t": self.t}, arrays)

    def restore(self, block: CheckpointBlock) -> None:
        """Take over the numbers of a checkpoint.

        Raises
        ------
        CheckpointError : they are missing, or do not match the walls.
        """
        mine = self.to_block()
        try:
            found = {name: np.array(block.arrays[name]) for name in mine.arrays}
            self.t = float(block.values["t"])
        except (KeyError, TypeError, ValueError) as error:
            raise CheckpointError(f"the servos in the checkpoint are incomplete ({error})") from error
        for name, array in mine.arrays.items():
            good = found[name].shape == array.shape and found[name].dtype == array.dtype
            if not (good and np.isfinite(found[name]).all()):
                raise CheckpointError(f"'{name}' of the servos in the checkpoint does not match the walls")
        self.travel, self.speed = found["travel"], found["speed"]
        self.impulse, self.touched, self.most = found["impulse"], found["touched"], found["most"]
