"""The grains of one rank: an instance of LAMMPS, and what the engine asks of it.

Every rank has one. All methods are called on all ranks together; those that return grains return the rows of
this rank, with their ids.
"""

import os
from collections.abc import Generator, Iterable
from contextlib import contextmanager
from typing import Any, BinaryIO

import numpy as np

from ryusa.engine.lammps import commands as C
from ryusa.engine.lammps import forces as F
from ryusa.engine.lammps.answers import FEWEST_IMAGES, Extremes, RankRows
from ryusa.engine.lammps.atoms import AtomArrays
from ryusa.engine.lammps.faults import (
    LISTED,
    LammpsFailed,
    RankFault,
    SharedFault,
    fault_of_lammps,
    not_a_number,
)
from ryusa.engine.lammps.grain_types import grain_types
from ryusa.engine.lammps.module import module, open_lammps
from ryusa.engine.lammps.overlaps import contacts
from ryusa.engine.lammps.sums import RankSums
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.parameters import parameters_of
from ryusa.engine.shared.variant import choice_of
from ryusa.errors import RunError
from ryusa.laws.families import Profile
from ryusa.model import Scene, State
from ryusa.model.fluid import DRAG, N_IMPULSE, SUBMERGED
from ryusa.model.scene import Floats


@contextmanager
def memory_file() -> Generator[tuple[str, BinaryIO]]:
    """A file in memory and its path: no folder's name gets into a command, and nothing is left behind."""
    with os.fdopen(os.memfd_create("ryusa"), "r+b") as file:
        yield f"/proc/self/fd/{file.fileno()}", file


class GrainShare:
    """LAMMPS on one rank.

    Parameters
    ----------
    comm : communicator of mpi4py; None without MPI.
    """

    def __init__(self, comm: Any = None) -> None:
        self._comm = comm
        self._lmp: Any = None
        self._scene: Scene | None = None
        self._first = comm is None or comm.Get_rank() == 0
        self._atoms: Any = None  # AtomArrays
        self._broken: Exception | None = None  # raised where LAMMPS calls, which drops exceptions
        self.water: Any = None  # column of water of this process (engine.protocol.ColumnHere)

    def load(self, scene: Scene, state: State, restart: bytes | None) -> None:
        """Take a scene and a state; `restart` is what `restart` returned, for a resume."""
        self.close()
        self._scene, self._types = scene, grain_types(scene)
        self._t_zero = state.t - state.step * scene.dt
        self._take_numbers(scene)
        self._lmp = lmp = open_lammps(self._comm)
        self._atoms = AtomArrays(lmp)
        if (lmp.extract_setting("tagint"), lmp.extract_setting("imageint")) != (4, 4):
            raise SharedFault(
                LammpsFailed("LAMMPS was built with 64-bit ids: a build with the usual 32 bits is needed")
            )
        self._bed = scene.fixed_active.copy()
        if restart is None:
            self._create(scene, state)
        else:
            self._read_restart(restart)
        self._give_bodies(scene, state)
        self._run(C.laws(scene, self._types))
        if self._calls:
            lmp.set_fix_external_callback(C.WATER, self._complete, None)
        self._run([f"reset_timestep {state.step}"])
        self._begin_impulse(state)
        self._set_out()

    def _create(self, scene: Scene, state: State) -> None:
        """The box and its grains."""
        there = np.flatnonzero(scene.fixed_active)
        x = np.concatenate([state.x, scene.x_fixed[there]])
        ids = np.concatenate([np.arange(scene.n_grain), scene.n_grain + there]) + 1
        types = np.concatenate([self._types.of, self._types.n + self._types.of_fixed[there]]) + 1
        image = np.zeros((len(x), 3), np.int64)
        for axis, period in enumerate(scene.period):
            if np.isfinite(period):
                crossed = np.floor(x[:, axis] / period)
                x[:, axis] -= crossed * period
                image[:, axis] = crossed
        if len(state.image):
            image[: scene.n_grain, :2] += state.image
        image = (image + FEWEST_IMAGES // 2) % FEWEST_IMAGES - FEWEST_IMAGES // 2
        self._run(C.box(scene, self._types, x))
        flags = [self._lmp.encode_image_flags(*row) for row in image.tolist()]
        self._lmp.create_atoms(len(x), ids.tolist(), types.tolist(), x.ravel().tolist(), None, flags)

    def _read_restart(self, content: bytes) -> None:
        """Box, grains and the history of contacts; only the first rank reads the file."""
        with memory_file() as (path, file):
            file.write(content)
            file.flush()
            self._run([C.PROCESSORS.format(1 if self._plane else "*"), f"read_restart {path}"])

    def close(self) -> None:
        """End LAMMPS."""
        if self._lmp is not None:
            self._lmp.close()
            self._lmp = None
            self._broken = self.water = self._atoms = None

    def _take_numbers(self, scene: Scene) -> None:
        self._choice, self._c = choice_of(scene), parameters_of(scene)
        self._calls = C.completes_forces(scene)
        self._column = scene.water.profile == Profile.COLUMN
        self._own = np.column_stack([scene.m, scene.m_added, scene.m_weight, scene.inertia])
        self._counts, self._plane = False, scene.plane_case

    def _give_bodies(self, scene: Scene, state: State) -> None:
        """Radii, masses, velocities and spins of the grains of this rank."""
        tag, r, mass, v, w = (self._atoms(name) for name in ("id", "radius", "rmass", "v", "omega"))
        d = np.concatenate([scene.d, scene.d_fixed])
        m = np.concatenate([scene.m + scene.m_added, np.full(scene.n_fixed, float(scene.m.mean()))])
        r[:], mass[:] = 0.5 * d[tag - 1], m[tag - 1]
        v[:] = w[:] = 0.0
        free = tag <= scene.n_grain
        v[free] = state.v[tag[free] - 1]
        if scene.rotation:
            w[free] = state.omega[tag[free] - 1]

    def _begin_impulse(self, state: State) -> None:
        if not self._column or self._scene is None:
            return
        tag = self._atoms("id")
        free = np.flatnonzero(tag <= self._scene.n_grain)
        ids = tag[free] - 1
        sampled, impulse, last = (self._atoms(name) for name in (C.SAMPLED, C.IMPULSE, C.LAST))
        sampled[:] = impulse[:] = last[:] = 0.0
        if state.fluid is not None:
            sampled[free], impulse[free] = state.fluid.sampled[ids], state.fluid.impulse[ids]
            last[free, F.K_D] = impulse[free, DRAG]
        last[free, F.V_BEGIN : F.V_BEGIN + 3] = state.v[ids]

    def _set_out(self) -> None:
        """Evaluate forces at the present positions with velocities of half a step before, as ryusa does."""
        self._counts = False
        self._command("run 0 post no")
        self._shift(+0.5)

    def advance(self, n_steps: int) -> None:
        """Do n_steps steps."""
        self._counts = True
        self._command(f"run {n_steps} pre no post no")

    def change(self, scene: Scene) -> None:
        """Go on with a scene that the timeline changed: gravity, fixed grains or planes taken away."""
        before = self._scene
        assert before is not None
        self._shift(-0.5)
        self._scene = scene
        self._c = parameters_of(scene)
        if not self._calls:
            self._run(["unfix weight", C.weight(scene)])
        self._run(C.removed(np.flatnonzero(self._bed & ~scene.fixed_active) + scene.n_grain))
        self._bed = scene.fixed_active.copy()
        for k in np.flatnonzero(before.plane_active & ~scene.plane_active).tolist():
            self._run(f"unfix {C.wall(k, c)}" for c in range(self._types.n))
        self._set_out()  # counts no impulse: what was taken from the water goes with its grain

    def set_fluid(self, ids: np.ndarray, sampled: Floats) -> None:
        """Set the water at grains, rows by id, and evaluate the forces at the present positions again."""
        scene = self._scene
        assert scene is not None
        here, free = self._free()
        place = np.full(scene.n_grain, -1)
        place[ids] = np.arange(len(ids))
        self._tell(free, sampled[place[here]])

    def _tell(self, free: np.ndarray, sampled: Floats) -> None:
        """Set the water at the free grains here; their impulse is counted anew."""
        self._shift(-0.5)
        self._atoms(C.SAMPLED)[free] = sampled
        self._atoms(C.IMPULSE)[:] = 0.0
        self._atoms(C.LAST)[:, F.V_BEGIN : F.V_BEGIN + 3] = self._atoms("v")
        self._evaluate()
        self._shift(+0.5)

    def couple(self, begin: Any, told: bool) -> None:
        """Begin a column of water for the grains here; `told`: they know of its water."""
        ids, free = self._free()
        several = self._comm is not None and self._comm.Get_size() > 1
        processes, x = RankSums(self._comm) if several else None, self._atoms("x")[free]
        self.water = begin(self._scene, ids, x, self._atoms(C.SAMPLED)[free], processes)
        if not told:
            self._tell(free, self.water.sampled)
        self._atoms(C.KEPT)[free] = self.water.kept

    def exchange(self) -> int:
        """Exchange momentum between the grains here and the column, which all ranks move alike.

        Returns
        -------
        Checksum of the water.

        Raises
        ------
        RyusaError : the water cannot be moved on; on all ranks.
        """
        _, x, v, impulse = self.kinematics()
        free = self._hold()
        self._tell(free, self.water.exchange(x, v, impulse))
        self._atoms(C.KEPT)[free] = self.water.kept
        return self.water.checksum

    def change_column(self) -> None:
        """Let the column take over the scene that `change` took."""
        assert self._scene is not None
        self._hold()
        self.water.change(self._scene)

    def kept(self) -> tuple[np.ndarray, Floats]:
        """Ids of the grains of this rank, and what they keep for the column (model.fluid)."""
        ids, free = self._free()
        return ids, self._atoms(C.KEPT)[free]

    def _hold(self) -> np.ndarray:
        """Tell the column which grains are here now; their rows."""
        ids, free = self._free()
        self.water.hold(ids, self._atoms(C.KEPT)[free], self._atoms(C.SAMPLED)[free])
        return free

    def _complete(self, _caller: Any, _step: int, _n: int, _tag: Any, _x: Any, _force: Any) -> None:
        """Complete the forces of a step; LAMMPS calls it after those of contacts, and drops exceptions."""
        try:
            self._contact = np.hstack([self._atoms("f"), self._atoms("torque")])
            if self._column and self._counts and self._scene is not None:
                F.count_impulse(
                    self._atoms("id"), self._scene.n_grain, self._c[P.DT], self._atoms(C.LAST),
                    self._atoms(C.IMPULSE),
                )  # fmt: skip
            self._evaluate()
        except Exception as error:
            self._broken = self._broken or error

    def _evaluate(self) -> None:
        scene = self._scene
        assert scene is not None
        none = np.zeros((0, 0))
        F.complete_forces(
            self._choice, scene.plane_case, self._column, self._c, self._own, self._atoms("id"),
            self._atoms("x"), self._atoms("v"), self._atoms("omega"), self._atoms("radius"),
            self._atoms("rmass"), self._contact, self._atoms("f"), self._atoms("torque"),
            self._atoms(C.SAMPLED) if self._column else none, self._atoms(C.LAST) if self._column else none,
        )  # fmt: skip

    def _shift(self, steps: float) -> None:
        """Move velocities by so many steps under the present forces."""
        scene = self._scene
        assert scene is not None
        F.shift_velocities(
            self._atoms("id"), scene.n_grain, scene.rotation, steps * scene.dt, self._atoms("rmass"),
            self._atoms("radius"), self._atoms("f"), self._atoms("torque"), self._atoms("v"),
            self._atoms("omega"),
        )  # fmt: skip

    def rows(self, low: int, high: int) -> RankRows:
        """Grains of this rank with ids from `low` to below `high`."""
        scene = self._scene
        assert scene is not None
        tag = self._atoms("id")
        free = np.flatnonzero((tag > low) & (tag <= min(high, scene.n_grain)))
        x, v, w = self._atoms("x")[free], self._half("v")[free], self._half("omega")[free]
        crossed = self._atoms("image")[free].astype(np.int64)
        image = np.zeros((len(free), 2), np.int32)
        for axis, period in enumerate(scene.period):
            if np.isfinite(period):
                image[:, axis] = (crossed >> (10 * axis) & 1023) - 512
        return RankRows(tag[free].astype(np.int64) - 1, x, v, w, image)

    def fluid(self) -> tuple[np.ndarray, Floats]:
        """Ids of the grains of this rank, and the water at them (model.fluid)."""
        ids, free = self._free()
        return ids, self._atoms(C.SAMPLED)[free]

    def kinematics(self) -> tuple[np.ndarray, Floats, Floats, Floats]:
        """Ids of the grains of this rank, centres, velocities and impulse from the water (model.fluid)."""
        ids, free = self._free()
        v, impulse = self._half("v"), np.zeros((len(self._atoms("id")), N_IMPULSE))
        if self._column:
            F.taken_from_water(
                self._atoms("id"), self._own, v, self._atoms(C.SAMPLED), self._atoms(C.IMPULSE),
                self._atoms(C.LAST), impulse,
            )  # fmt: skip
        return ids, self._atoms("x")[free], v[free], impulse[free]

    def _free(self) -> tuple[np.ndarray, np.ndarray]:
        """Ids of the free grains of this rank, and their rows among its atoms."""
        assert self._scene is not None
        tag = self._atoms("id")
        free = np.flatnonzero(tag <= self._scene.n_grain)
        return tag[free].astype(np.int64) - 1, free

    def extremes(self) -> Extremes:
        """Energies and extremes of the grains of this rank, from its pairs in contact and its planes."""
        scene = self._scene
        assert scene is not None
        ids, free = self._free()
        x, v, w = (self._atoms(name)[free] for name in ("x", "v", "omega"))
        speed, spin = np.linalg.norm(v, axis=1), np.linalg.norm(w, axis=1)
        m = self._inertial_mass()[free]
        ends = self._local(f"{C.PAIRS}_ids", 2).astype(np.int64) - 1
        spring, n_contact, overlap, pair = contacts(scene, ids, x, np.ravel(self._local(C.PAIRS, 1)), ends)
        bad = ~np.isfinite(np.hstack([x, v, w])).all(axis=1)
        out = np.any((x < scene.world_low) | (x > scene.world_high), axis=1)
        fast = int(speed.argmax()) if len(ids) else -1
        return Extremes(
            kinetic=0.5 * float(np.sum(m * speed**2)),
            spin=0.5 * float(np.sum(scene.inertia[ids] * spin**2)) if scene.rotation else 0.0,
            spring_n=spring,
            n_contact=n_contact,
            overlap=overlap,
            pair=pair,
            speed=float(speed[fast]) if fast >= 0 else 0.0,
            fastest=int(ids[fast]) if fast >= 0 else -1,
            spin_max=float(spin.max(initial=0.0)),
            not_finite=int(ids[bad][0]) if bad.any() else -1,
            outside=int(ids[out][0]) if out.any() else -1,
        )

    def _inertial_mass(self) -> Floats:
        """Mass of each atom with the added mass of its part under water [kg]."""
        mass = self._atoms("rmass").copy()
        if self._column and self._scene is not None:
            tag = self._atoms("id")
            free = tag <= self._scene.n_grain
            own = self._own[tag[free] - 1]
            mass[free] = own[:, 0] + own[:, 1] * self._atoms(C.SAMPLED)[free, SUBMERGED]
        return mass

    def restart(self) -> bytes | None:
        """What a resume needs, of all ranks: on the first rank the content of a restart file of LAMMPS."""
        with memory_file() as (path, file):
            self._command(f"write_restart {path} noinit")
            file.seek(0)
            return file.read() if self._first else None

    def _local(self, name: str, columns: int) -> np.ndarray:
        """Rows of a compute of pairs, copied."""
        words = module()
        if not self._lmp.extract_compute(name, words.LMP_STYLE_LOCAL, words.LMP_SIZE_ROWS):
            return np.zeros((0, columns))
        kind = words.LMP_TYPE_VECTOR if columns == 1 else words.LMP_TYPE_ARRAY
        found = self._lmp.numpy.extract_compute(name, words.LMP_STYLE_LOCAL, kind)
        return np.array(found, np.float64).reshape(-1, columns)

    def _half(self, name: str) -> Floats:
        """Velocities or spins half a step before the positions."""
        scene = self._scene
        assert scene is not None
        mass = self._atoms("rmass")[:, None]
        if name == "v":
            return self._atoms("v") - 0.5 * scene.dt * self._atoms("f") / mass
        if not scene.rotation:
            return self._atoms("omega").copy()
        inertia = F.SOLID * mass * self._atoms("radius")[:, None] ** 2
        return self._atoms("omega") - 0.5 * scene.dt * self._atoms("torque") / inertia

    def _command(self, text: str) -> None:
        """Let LAMMPS carry out a command.

        Raises
        ------
        SharedFault, RankFault : it failed, on all ranks or on this one.
        """
        try:
            self._lmp.command(text)
        except Exception as error:  # the module raises nothing narrower
            raise fault_of_lammps(error, self._lost()) from error
        if self._broken is not None:
            raise RankFault(LammpsFailed(f"forces of the water: {self._broken}")) from self._broken

    def _lost(self) -> RunError | None:
        """The error of a grain of this rank that is not finite, after LAMMPS failed; None without one."""
        scene = self._scene
        if scene is None or self._atoms is None:
            return None
        ids, free = self._free()
        moves = np.hstack([self._atoms(name)[free] for name in ("x", "v", "omega")])
        bad = ~np.isfinite(moves).all(axis=1)
        if not bad.any():
            return None
        step = int(self._lmp.extract_global("ntimestep"))
        return not_a_number(int(ids[bad].min()), step, self._t_zero + step * scene.dt, LISTED)

    def _run(self, texts: Iterable[str]) -> None:
        for text in texts:
            self._command(text)
