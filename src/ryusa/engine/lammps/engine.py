"""LAMMPS as an engine, on one process or on those that mpirun started together (design/0025)."""

from dataclasses import replace
from typing import Any

import numpy as np

from ryusa.engine.lammps.answers import FEWEST_IMAGES, Extremes, together
from ryusa.engine.lammps.faults import LammpsFailed, fault_of_grains
from ryusa.engine.lammps.ranks import Ranks
from ryusa.engine.lammps.refusals import refusals_of_change, refusals_of_lammps
from ryusa.engine.protocol import Flags
from ryusa.engine.shared.energy_account import potential_energy
from ryusa.engine.shared.refusals import check_sampled, check_state, refusals
from ryusa.errors import NotANumber, RunError, WaterError
from ryusa.laws.families import Profile
from ryusa.model import EVENT, EngineBlock, Scene, State, Tally, Term
from ryusa.model.fluid import N_IMPULSE, N_KEPT, N_SAMPLED, FluidAtGrains
from ryusa.model.scene import Floats
from ryusa.model.state import make_read_only

VERSION = 1
INSPECTION = 1_000  # steps between two inspections of overlaps, speeds and places, at most
_AT_ONCE = 1_000_000  # grains that are brought to the leader in one message
_NAN = float("nan")
_WORD = 4  # bytes of a restart that one double holds


class LammpsEngine:
    """Steps the grains of a scene with LAMMPS.

    It keeps no account of energy by cause and no records of contacts: terms of its tally are nan.
    """

    name = "lammps"

    def __init__(self) -> None:
        self._ranks: Ranks | None = None
        self._scene: Scene | None = None
        self._step, self._t_zero, self._inspected = 0, 0.0, -1
        self._found: Extremes | None = None  # of the present step
        self._fault: RunError | None = None
        self._failed = False  # LAMMPS has
        self._last: Tally | None = None
        self._overlap = (0.0, -1, 0)  # largest over the smaller diameter so far, its grain and step

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        """Reasons why this engine cannot simulate the scene; () when it can."""
        return (*refusals(scene), *refusals_of_lammps(scene))

    def refuses_change(self, before: Scene, after: Scene) -> tuple[str, ...]:
        """Reasons why the scene cannot become another one during a run; () when it can."""
        return refusals_of_change(before, after)

    def load(self, scene: Scene, state: State) -> None:
        """Take a scene and an initial state or a snapshot; also when the timeline changes the scene."""
        if reasons := self.refuses(scene):
            raise ValueError("; ".join(reasons))
        before = self._scene
        if before is not None and before is not scene and state.step == self._step:
            if reasons := refusals_of_change(before, scene):
                raise ValueError("; ".join(reasons))
            self._inspect()
            if self._fault is not None:
                raise self._fault
            check_state(scene, state)
            self._scene = scene
            self._all("change", scene)
        else:
            check_state(scene, state)
            self._scene = scene
            self._begin(scene, state)
        self._found, self._fault, self._inspected = None, None, self._step

    def _begin(self, scene: Scene, state: State) -> None:
        self._step, self._t_zero = state.step, state.t - state.step * scene.dt
        self._overlap, restart = (0.0, -1, 0), None
        self._failed, self._last = False, None
        self._image = state.image if len(state.image) else np.zeros((scene.n_grain, 2), np.int32)
        block = state.block_of(self.name, VERSION)
        if block is not None:
            words = block.arrays["restart"]
            restart = words.astype(np.uint32).tobytes()[: int(block.number("bytes", 0, _WORD * len(words)))]
            self._overlap = (
                block.number("overlap_max", 0.0, np.inf),
                int(block.number("overlap_grain", -1, scene.n_grain - 1)),
                int(block.number("overlap_step", 0, state.step)),
            )
        elif len(state.contacts):
            raise ValueError(
                f"LAMMPS cannot take the springs of {len(state.contacts)} contacts from another engine"
            )
        bare = replace(state, contacts=type(state.contacts).none(), engine=None, tally=None, coupling=None)
        self._all("load", scene, bare, restart)

    def set_fluid(self, sampled: Floats) -> None:
        """Set the water at every grain for the next steps, and count its impulse anew."""
        assert self._scene is not None
        n, column = self._scene.n_grain, self._scene.water.profile == Profile.COLUMN
        check_sampled(sampled, (n, N_SAMPLED) if column else None)
        self._all("set_fluid", np.arange(n), sampled)

    def couple(self, begin: Any, told: bool) -> Any:
        """Begin a column of water in every process (engine.protocol.SharesColumn)."""
        self._all("couple", begin, told)
        assert self._ranks is not None
        return self._ranks.water

    def exchange(self) -> None:
        """Let the grains of every process exchange momentum with its column."""
        try:
            sums = self._all("exchange")
        except WaterError:
            self._found = None
            self._inspect()  # a grain that is not finite takes the water along
            if self._fault is not None:
                raise self._fault from None
            raise
        if len(set(sums)) > 1:
            raise LammpsFailed(
                f"the columns of water of the ranks have parted at step {self._step}: run all ranks on "
                "processors of one kind, with one version of each library"
            )

    def change_column(self) -> None:
        """Let the columns take over the scene that was loaded last."""
        self._all("change_column")

    def kept(self) -> Floats:
        """What the grains keep for the column, columns of model.fluid by id."""
        assert self._scene is not None
        kept = np.empty((self._scene.n_grain, N_KEPT))
        for ids, found in self._all("kept"):
            kept[ids] = found
        return kept

    def set_walls(self, motion: Floats) -> None:
        """Refuse: this engine has no walls but planes."""
        raise ValueError("the lammps engine has no [[walls]]")

    def advance(self, n_steps: int) -> Flags:
        """Do n_steps steps, fewer if an inspection shows a fault."""
        end = self._step + n_steps
        while self._step < end:
            if self._fault is not None:
                return Flags(self._fault)
            k = min(end - self._step, INSPECTION - (self._step - self._inspected))
            self._all("advance", k)
            self._step, self._found = self._step + k, None
            if self._step - self._inspected >= INSPECTION:
                self._inspect()
        return Flags(self._fault)

    def _inspect(self) -> Extremes:
        """Look at all grains, and keep the first fault."""
        assert self._scene is not None
        if self._found is None:
            self._found = together(self._all("extremes"))
            since, self._inspected = self._step - self._inspected, self._step
            if self._found.overlap > self._overlap[0]:
                self._overlap = self._found.overlap, self._found.pair[0], self._step
            fault = fault_of_grains(self._scene, self._found, self._step, self._t, since)
            self._fault = self._fault or fault
        return self._found

    def grains(self) -> State:
        """Where grains are and how they move: a frame."""
        assert self._scene is not None
        n = self._scene.n_grain
        x, v, omega, image = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3)), np.zeros((n, 2), np.int32)
        for low in range(0, n, _AT_ONCE):
            for rows in self._all("rows", low, low + _AT_ONCE):
                ids = rows.ids
                x[ids], v[ids], omega[ids], image[ids] = rows.x, rows.v, rows.omega, rows.image
        half = FEWEST_IMAGES // 2
        image = self._image + ((image - self._image + half) % FEWEST_IMAGES - half)
        self._image = image
        return State(x=x, v=v, omega=omega, step=self._step, t=self._t, image=image)

    def kinematics(self) -> tuple[Floats, Floats, Floats]:
        """Centres [m], velocities [m/s] and impulse from the fluid (model.fluid), by id."""
        assert self._scene is not None
        n, column = self._scene.n_grain, self._scene.water.profile == Profile.COLUMN
        x, v, impulse = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, N_IMPULSE))
        for ids, *found in self._all("kinematics"):
            x[ids], v[ids], impulse[ids] = found
        return x, v, impulse if column else np.zeros((0, 0))

    def state(self) -> State:
        """Read-only snapshot: enough to go on from, though not with the same bits."""
        assert self._scene is not None
        fluid = None
        if self._scene.water.profile == Profile.COLUMN:
            fluid = FluidAtGrains.at_rest(self._scene.n_grain)
            fluid.impulse[:] = self.kinematics()[2]
            for ids, sampled in self._all("fluid"):
                fluid.sampled[ids] = sampled
        content: bytes = self._all("restart")[0]
        words = np.frombuffer(content + bytes(-len(content) % _WORD), np.uint32).astype(np.float64)
        numbers = dict(zip(("overlap_max", "overlap_grain", "overlap_step"), self._overlap, strict=True))
        block = EngineBlock(
            self.name, VERSION, {"restart": words},
            {name: float(one) for name, one in {**numbers, "bytes": len(content)}.items()},
        )  # fmt: skip
        state = replace(self.grains(), fluid=fluid, engine=block)
        make_read_only(state)
        return state

    def tally(self) -> Tally:
        """Energies of the present step, and extremes of the inspections; terms of the account are nan.

        After an error of LAMMPS, those of the last time.

        Raises
        ------
        NotANumber : a grain is not finite.
        """
        assert self._scene is not None
        known = self._failed or isinstance(self._fault, NotANumber)  # told before this call
        if known and self._last is not None:
            return self._last
        found = self._inspect()
        if isinstance(self._fault, NotANumber):  # no frame of it
            self._failed = True
            raise self._fault
        self._last = Tally(
            t=self._t,
            kinetic=found.kinetic,
            spin=found.spin,
            potential=potential_energy(self._scene, self.grains()),
            spring_n=found.spring_n,
            spring_s=_NAN,
            spring_r=_NAN,
            terms=(_NAN,) * len(Term),
            overlap_max=self._overlap[0],
            overlap_grain=self._overlap[1],
            overlap_step=self._overlap[2],
            speed_max=found.speed,
            spin_max=found.spin_max,
            n_contact=found.n_contact,
        )
        return self._last

    def events(self) -> np.ndarray:
        """No records: a scene that asks for them is refused."""
        return np.zeros(0, EVENT)

    @property
    def _t(self) -> float:
        assert self._scene is not None
        return self._t_zero + self._step * self._scene.dt

    def _all(self, method: str, *arguments: Any) -> list[Any]:
        if self._ranks is None:
            self._ranks = Ranks()
        try:
            return self._ranks.all(method, *arguments)
        except (LammpsFailed, RunError):
            self._failed = True
            raise
