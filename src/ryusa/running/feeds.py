"""Grains that enter and leave during a run: at fixed steps, with a backlog where a feed is full."""

import math
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.protocol import Engine
from ryusa.engine.shared.passages import Entering, everywhere, placed, removed
from ryusa.errors import CheckpointError
from ryusa.model import PASSAGE, Scene, State
from ryusa.model.arrays import Floats
from ryusa.model.feeds import GONE, IN, NONE, PRESENT, WAITING, Population, Traffic
from ryusa.model.wall_feeds import carrier_of, corners, speed_of_feed
from ryusa.model.walls import BEGIN
from ryusa.running.arrivals import arriving, listed
from ryusa.running.checkpoint import CheckpointBlock
from ryusa.running.crossing import Surface, fall, leaving_at, of_heads
from ryusa.running.insertion import (
    ATTEMPTS,
    Neighbours,
    drawn_orientation,
    drawn_place,
    spheres_at,
    wrapped,
)
from ryusa.water.protocol import Fluid

_FULL = 3  # grains in a row that find no place, after which a feed is tried again at the next instant
Ints = NDArray[np.int64]
_UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])  # orientation of a grain that is no clump


class Passed(NamedTuple):
    """What happened at one instant.

    Attributes
    ----------
    state : of all grains after it, for the engine.
    events : contacts that ended with a grain that left, dtype EVENT.
    rows : grains that entered and left, dtype PASSAGE.
    water : what moves among the grains that are there now; None without one, and before the first step.
    """

    state: State
    events: np.ndarray
    rows: np.ndarray
    water: Fluid | None = None


@dataclass
class TrafficRule:
    """Feeds and exits of a run.

    Attributes
    ----------
    traffic : feeds and exits.
    population : which grains are there, and which wait.
    entered, left : number of grains by feed and by exit so far.
    said : for each feed, whether a backlog has been reported.
    """

    traffic: Traffic
    population: Population
    entered: Ints
    left: Ints
    said: NDArray[np.bool_]
    _scene: Scene = field(repr=False)

    @staticmethod
    def of(scene: Scene) -> "TrafficRule | None":
        """The rule of a scene; None where its grains are always the same."""
        traffic = scene.traffic
        if traffic is None:
            return None
        feeds, exits = len(traffic.feeds), len(traffic.exits)
        return TrafficRule(
            traffic, Population.first(traffic, scene.of_heads()[1], scene.heads), np.zeros(feeds, np.int64),
            np.zeros(exits, np.int64), np.zeros(feeds, np.bool_), scene,
        )  # fmt: skip

    @property
    def finished(self) -> bool:
        """Whether no grain waits to enter."""
        return not np.any(self.population.status == WAITING)

    @property
    def n_present(self) -> int:
        """Number of grains that are there."""
        return int(np.sum((self.population.status == PRESENT) & self._scene.heads))

    def next_step(self, step: int, next_change: int) -> int:
        """Step of the next instant; where a feed moves with a wall a change of the scene is one too."""
        regular = (step // self.traffic.interval + 1) * self.traffic.interval
        return min(regular, next_change) if self.traffic.moves else regular

    def begin(self, scene: Scene, state: State) -> Passed:
        """Place the grains that are due at the first step, before an engine has loaded the state."""
        there = self.population.status == PRESENT
        if not np.array_equal(everywhere(state), there):
            raise ValueError(
                f"the state holds other grains than the first {self.traffic.n_first} of its scene"
            )
        surface = surface_of(scene, None)
        came, grains, _ = self._find_places(scene, state, surface)
        return Passed(placed(scene, state, grains), state.contacts.event[:0], came)

    def at_instant(
        self, scene: Scene, engine: Engine, step: int, t: float,
        water: Fluid | None = None,
    ) -> Passed | None:  # fmt: skip
        """Let grains leave and enter; None where none does.

        Parameters
        ----------
        scene : that holds now.
        engine : has stepped to `step`, time t [s]; it is only read.
        water : where a grain enters or leaves it is given what all took of it up to this step.
        """
        surface = surface_of(scene, water)
        status = self.population.status
        through: list[Ints] = []
        if self.traffic.exits:
            through = self._beyond(scene, engine, t)
        waits = (status == WAITING) & (self.population.due <= t)
        if not any(len(ids) for ids in through) and not waits.any():
            return None
        state = engine.state()
        leaving = leaving_at(self.traffic, scene, state, through, surface)
        state, events = removed(scene, state, leaving["grain"])
        self._let_go(leaving)
        came, grains, x = self._find_places(scene, state, surface, water)
        if not len(leaving) and not len(came):
            return None
        if water is not None:
            water.finish(step, *engine.kinematics())
            water = water.among(x, step)
            state = _at_entry(state, water, scene.spheres_of(came["grain"]))
        rows = np.concatenate([leaving, came])
        return Passed(placed(scene, state, grains), events, rows, water)

    def _beyond(self, scene: Scene, engine: Engine, t: float) -> list[Ints]:
        """Ids of the grains that are beyond each exit; those beyond several leave through the first."""
        x = engine.kinematics()[0] if scene.bodies is None else of_heads(scene, engine.grains())[0]
        there, inside = (self.population.status == PRESENT) & scene.heads, wrapped(x, scene.period)
        found: list[Ints] = []
        for one in self.traffic.exits:
            carrier = carrier_of(scene, one.wall, t)
            ids = np.flatnonzero(one.beyond(inside if carrier is None else carrier.frame(inside)) & there)
            there[ids] = False
            found.append(ids)
        return found

    def _let_go(self, leaving: np.ndarray) -> None:
        population = self.population
        for row in leaving:
            i, to = int(row["grain"]), int(row["to"])
            self.left[row["at"]] += 1
            spheres = self._scene.spheres_of(np.array([i]))
            population.status[spheres] = GONE if to == NONE else WAITING
            population.feed[spheres] = to
            population.due[i] = math.inf if to == NONE else row["t"]

    def _find_places(
        self, scene: Scene, state: State, surface: Surface, water: Fluid | None = None
    ) -> tuple[np.ndarray, Entering, Floats]:
        """Find places for grains that are due, the longest waiting first, as far as there is room.

        Parameters
        ----------
        state : without those that have just left.
        surface : height of the water.
        water : grains of a feeder reach wait for its first step.

        Returns
        -------
        came : records of those that enter.
        grains : they, for `placed`.
        x : centres of all spheres then, inside the period [m], shape (n_grain, 3).
        """
        population, step, t = self.population, state.step, state.t
        due = np.flatnonzero((population.status == WAITING) & (population.due <= t))
        due = due[np.lexsort((due, population.due[due]))]
        near: dict[int, Neighbours] = {}
        failed = np.zeros(len(self.traffic.feeds), np.int64)
        rows: list[np.ndarray] = []
        places: list[Floats] = []
        turns: list[Floats] = []
        inside = wrapped(state.x, scene.period)
        for i in due.tolist():
            k = int(population.feed[i])
            own = listed(self.traffic.arrivals, k)  # then one without room says nothing of the next
            if (failed[k] >= _FULL and not own) or (own and water is None):
                continue
            if k not in near:
                near[k] = self._neighbours(scene, k, inside, t)
            if own and water is not None:
                due_at = float(population.due[i])
                (row, place), q = arriving(scene, water, near[k], i, step, t, due_at), _UPRIGHT
            else:
                row, place, q = self._entering(scene, near[k], i, step, t, surface)
            if place is None:
                failed[k] += 1
                continue
            failed[k] = 0
            spheres, x_of = spheres_at(scene, i, place, q)
            for one in near.values():
                for sphere, x_sphere in zip(spheres.tolist(), x_of, strict=True):
                    one.add(x_sphere, float(scene.d[sphere]))
            population.status[spheres], population.feed[spheres] = PRESENT, NONE
            population.due[i] = math.inf
            self.entered[k] += 1
            rows.append(row)
            places.append(place)
            turns.append(q)
            inside[spheres] = x_of
        came = np.concatenate([np.zeros(0, PASSAGE), *rows])
        where, q = np.array(places).reshape(-1, 3), np.array(turns).reshape(-1, 4)
        back = t - came["t"][:, None]
        a = fall(scene, came["grain"], where[:, 2], surface(where[:, 0]))
        speed = came["v"] + (back - 0.5 * scene.dt) * a  # that of half a step before
        came["momentum"] = came["m"][:, None] * speed
        return came, Entering(came["grain"], where, speed, came["omega"], q), inside

    def _neighbours(self, scene: Scene, k: int, inside: Floats, t: float) -> Neighbours:
        feed, interval = self.traffic.feeds[k], self.traffic.interval * scene.dt
        g = float(np.linalg.norm(scene.gravity))
        reach = interval * (math.hypot(*feed.velocity) + 2.0 * speed_of_feed(scene, feed) + g * interval)
        if scene.bodies is not None:
            reach += 0.5 * float(scene.bodies.extent(scene.d).max(initial=0.0))
        return Neighbours.of(scene, feed, inside, self.population.status == PRESENT, reach, t)

    def _entering(
        self, scene: Scene, near: Neighbours, i: int, step: int, t: float, surface: Surface
    ) -> tuple[np.ndarray, Floats | None, Floats]:
        """Record of a grain that enters, its place, None where it finds none, and its orientation."""
        feed, due = self.traffic.feeds[int(self.population.feed[i])], float(self.population.due[i])
        late = t - due
        # a grain that passes a disc between two instants is already on its way
        on_way = late if not feed.is_box and late < self.traffic.interval * scene.dt else 0.0
        level = float(surface(np.array([corner[0] for corner in corners(feed)])).max())
        if near.lowest <= level:
            on_way = 0.0  # what the water does to it on the way is not known
        if scene.walls is not None and feed.wall != NONE and due < scene.walls.motion[feed.wall, BEGIN]:
            on_way = 0.0  # the wall moved otherwise then
        carrier = carrier_of(scene, feed.wall, t - on_way)
        v = np.array(feed.velocity)
        a = fall(scene, np.array([i]), np.array([near.lowest]), np.array([level]))[0]
        d, m = (float(one[i]) for one in scene.of_heads())
        of = -1 if scene.bodies is None else int(scene.bodies.of_grain(scene.n_grain)[i])
        extent = d if scene.bodies is None or of < 0 else float(scene.bodies.extent(scene.d)[of])
        row = np.zeros(1, PASSAGE)
        row["step"], row["t"], row["way"], row["at"] = step, t - on_way, IN, self.population.feed[i]
        row["grain"], row["to"], row["due"], row["d"], row["m"] = i, NONE, due, d, m
        if carrier is not None and scene.rotation:
            row["omega"] = carrier.spin
        for attempt in range(ATTEMPTS):
            begin = drawn_place(feed, scene.plane_case, extent, i, step, attempt)
            q = drawn_orientation(feed, i, step, attempt) if of >= 0 else _UPRIGHT
            if carrier is not None:
                begin = carrier.place(begin)
                v = carrier.turn @ np.array(feed.velocity) + carrier.velocity_at(begin)
            place = wrapped(begin + on_way * v + 0.5 * on_way * on_way * a, scene.period)
            spheres, x = spheres_at(scene, i, place, q)
            if all(near.free(*one) for one in zip(x, scene.d[spheres].tolist(), strict=True)):
                row["x"], row["v"] = begin, v
                return row, place, q
        return row, None, _UPRIGHT

    def backlogs(self, step: int, t: float) -> list[tuple[int, float]]:
        """Number and mass [kg] of the grains that found no place at each feed, at the last instant."""
        population = self.population
        m = self._scene.of_heads()[1]
        instant = t - (step % self.traffic.interval) * self._scene.dt
        waits = (population.status == WAITING) & (population.due <= instant)
        return [
            (int(own.sum()), float(m[own].sum()))
            for k in range(len(self.traffic.feeds))
            for own in (waits & (population.feed == k),)
        ]

    def news(self, step: int, t: float) -> list[str]:
        """Feeds that are full for the first time, one line each."""
        found: list[str] = []
        for k, (count, mass) in enumerate(self.backlogs(step, t)):
            if count and not self.said[k]:
                self.said[k] = True
                name = self.traffic.feeds[k].name
                found.append(f"feed '{name}' is full: {_grains(count)}, {mass:.3g} kg, due and not yet in")
        return found

    def enter(self, numbers: dict[str, Any], step: int, t: float) -> None:
        """Enter the numbers of all feeds and exits, and backlogs as warnings, in those of summary.json."""
        backlogs = self.backlogs(step, t)
        feeds = [
            {"name": one.name, "entered": int(entered), "due": count, "due_mass": mass}
            for one, entered, (count, mass) in zip(self.traffic.feeds, self.entered, backlogs, strict=True)
        ]
        exits = [{"name": one.name, "left": int(self.left[k])} for k, one in enumerate(self.traffic.exits)]
        numbers["traffic"] = {"present": self.n_present, "feeds": feeds, "exits": exits}
        full = [
            f"feed '{one.name}' could not place {_grains(count)} ({mass:.3g} kg) that were due: lower its "
            "rate, or give it more room or more speed"
            for one, (count, mass) in zip(self.traffic.feeds, backlogs, strict=True)
            if count
        ]
        numbers["warnings"] = [*numbers["warnings"], *full]

    def to_block(self) -> CheckpointBlock:
        """All of it, for a checkpoint."""
        population = self.population
        arrays = {"status": population.status, "feed": population.feed, "due": population.due}
        arrays |= {"entered": self.entered, "left": self.left, "said": self.said.astype(np.int64)}
        return CheckpointBlock({}, arrays)

    def restore(self, block: CheckpointBlock, state: State) -> None:
        """Take over the numbers of a checkpoint, whose state is given.

        Raises
        ------
        CheckpointError : they are missing, or do not match the scene or the state.
        """
        mine = self.to_block().arrays
        try:
            found = {name: block.arrays[name] for name in mine}
        except KeyError as error:
            raise CheckpointError(f"the feeds in the checkpoint are incomplete ({error})") from error
        for name, array in mine.items():
            if (found[name].shape, found[name].dtype) != (array.shape, array.dtype):
                raise CheckpointError(f"'{name}' of the feeds in the checkpoint does not match the scene")
        status, feed, due = found["status"], found["feed"], found["due"]
        waits = status == WAITING
        good = np.isin(status, (WAITING, PRESENT, GONE)).all() and not np.isnan(due).any()
        good = good and (feed[waits] >= 0).all() and (feed[waits] < len(self.traffic.feeds)).all()
        if not good or not np.array_equal(everywhere(state), status == PRESENT):
            raise CheckpointError("the feeds in the checkpoint do not match its state")
        self.population = Population(status.copy(), due.copy(), feed.copy())
        self.entered, self.left = found["entered"].copy(), found["left"].copy()
        self.said = found["said"].astype(np.bool_)


def surface_of(scene: Scene, water: Fluid | None) -> Surface:
    """Height of the surface along x, before the first step that of the start; -inf without water."""
    if water is not None:
        return water.surface_at
    if scene.flow is not None:
        return scene.flow.first_surface
    return lambda x: np.full(len(x), -math.inf)


def _at_entry(state: State, water: Fluid, ids: Ints) -> State:
    """A snapshot in water, with the water at spheres of some ids that are about to be put into it."""
    assert state.fluid is not None
    sampled = state.fluid.sampled.copy()
    sampled[ids] = water.sampled[ids]
    return replace(state, fluid=replace(state.fluid, sampled=sampled))


def _grains(count: int) -> str:
    return "1 grain" if count == 1 else f"{count} grains"
