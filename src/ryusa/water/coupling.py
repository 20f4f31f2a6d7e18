"""Two-way coupling of water and grains: momentum is exchanged once per coupling interval (design/0007).

Within an interval the slices of the grains and the state of the water are constant. The impulse that a grain
received is taken from the cells with the same slices, so that momentum is conserved to round-off.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from zlib import crc32

import numpy as np

from ryusa.errors import NotANumber
from ryusa.laws._family import numbers
from ryusa.laws.families import BedKind, Fluctuations, Start
from ryusa.model import CouplingState, Scene
from ryusa.model.column import STIFF, Budget, Column, WaterState
from ryusa.model.eddies import Eddies
from ryusa.model.fluid import KEPT_COUNT, KEPT_R, KEPT_SPENT, KEPT_Z, N_KEPT, N_SAMPLED, SHEAR
from ryusa.model.scene import Floats
from ryusa.water import eddies
from ryusa.water import exchange_step as step
from ryusa.water.closures import averaged
from ryusa.water.coupling_interval import refuse_unresolved, steps_resolved
from ryusa.water.drive import discharge
from ryusa.water.exchange import Ints, weighted_concentration, with_those_away
from ryusa.water.exchange_arrays import ExchangeArrays, concentration_of_bed
from ryusa.water.fixed_grains import steady_start
from ryusa.water.momentum_balance import DONE, GRADIENT, SURFACE
from ryusa.water.processes import SharingProcesses
from ryusa.water.protocol import Fluid
from ryusa.water.solve import budget_of, fault_of, profiles_of, water_of

numbers(__name__, Start.REST, Start.STEADY)
numbers(__name__, Fluctuations.NONE, Fluctuations.RANDOM_WALK)


@dataclass
class Coupling(Fluid):
    """The column of water of a run, and the state of the water at its grains.

    Attributes
    ----------
    scene : the scene; its water has the profile COLUMN.
    column : cells, boundaries, driver, closures.
    steps : steps in the present interval; 1 in the first, where no drag is known yet.
    phi : present concentration of grains in the cells, fixed ones included [-], shape (n,).
    sampled : water at the grains as given last, columns of `model.fluid`.
    due : step of the engine at which the next exchange is due.
    exchanges : number of exchanges so far.
    worst : largest residual of the momentum budget so far, over its largest term [-].
    eddies : present eddies of the grains; None without fluctuations.
    ids : of the grains that are rows here; None: all grains, in their order.
    processes : that share the grains, each with a column that moves alike; None: this one has them all.
    """

    scene: Scene
    column: Column
    steps: int
    phi: Floats
    sampled: Floats
    due: int
    exchanges: int
    worst: float
    _arrays: ExchangeArrays
    _rows: Floats  # profiles of the water in cells, those of `time_step`
    _faces: Floats  # and at faces
    _out: Floats  # scalars of the last exchange
    _about: tuple[float, float, int]  # water per area of bed [m], t [s] and steps of the water
    eddies: Eddies | None = None
    ids: Ints | None = None
    processes: SharingProcesses | None = None

    @staticmethod
    def begin(
        scene: Scene, column: Column, x: Floats, step: int = 0, threads: int = 1,
        state: WaterState | None = None, ids: Ints | None = None, processes: SharingProcesses | None = None,
    ) -> "Coupling":  # fmt: skip
        """Cut the grains at x [m], and fill the column with its initial state or with a given one.

        Raises
        ------
        ValueError : the column is not valid, or its interval is less than a step.
        WaterError : no steady initial state was found.
        """
        del threads  # one column has no loops that are worth it
        faults = column.refuses()
        if faults or column.interval < 1:
            raise ValueError("; ".join(faults) or f"an interval of {column.interval} steps: at least 1")
        x, _ = with_those_away(scene, column.z_low, x, x)
        phi_bed = concentration_of_bed(scene, column)
        surface = column.z_surface if state is None else state.z_surface
        arrays = ExchangeArrays.of(
            scene, column, np.ascontiguousarray(x[:, 2]), surface, phi_bed, ids, processes
        )
        free = _of_free_grains(arrays, column, processes)
        phi = free + phi_bed
        if state is None and column.start is Start.STEADY:
            d_bed = scene.d_fixed[scene.fixed_active]
            every = np.concatenate([scene.d, d_bed])
            state = steady_start(
                column, scene.water, phi_bed, free, float((every**3).sum() / (every**2).sum())
            )
        now = WaterState.at_rest(column, phi) if state is None else state
        rows, faces, out = profiles_of(now)
        n = len(x)
        coupling = Coupling(
            scene, column, 1, phi, np.zeros((n, N_SAMPLED)), step + 1, 0, 0.0, arrays, rows, faces,
            out, (now.volume, now.t, now.step), ids=ids, processes=processes,
        )  # fmt: skip
        if column.fluctuations is Fluctuations.RANDOM_WALK:
            coupling.eddies = eddies.begin(column.seed, n, ids)
        coupling.sampled = coupling._water_at_grains()
        return coupling

    @staticmethod
    def resume(
        scene: Scene, column: Column, found: CouplingState, sampled: Floats | None = None, threads: int = 1,
        ids: Ints | None = None, processes: SharingProcesses | None = None,
    ) -> "Coupling":  # fmt: skip
        """Go on from a snapshot; `sampled` is the water at the grains here, columns of `model.fluid`.

        Raises
        ------
        ValueError : as `begin`, or the snapshot does not match the column or the grains.
        """
        if found.water.u.shape != (column.n,) or found.z.shape != (scene.n_grain,):
            raise ValueError(
                f"the snapshot has {len(found.water.u)} cells and {len(found.z)} grains, the run has "
                f"{column.n} cells and {scene.n_grain} grains"
            )
        here = slice(None) if ids is None else ids
        sampled = np.zeros((0, N_SAMPLED)) if sampled is None else sampled
        x = np.zeros((len(sampled), 3))
        x[:, 2] = found.z[here]
        coupling = Coupling.begin(
            scene, column, x, threads=threads, state=found.water, ids=ids, processes=processes
        )
        coupling.steps, coupling.due = found.steps, found.due
        coupling.exchanges, coupling.worst = found.exchanges, found.worst
        coupling.sampled = np.array(sampled)  # one that may be written: read-only arrays would compile anew
        coupling._arrays.force_z[:] = found.force_z
        if found.eddies is not None:
            coupling.eddies = Eddies(*(one[here] for one in vars(found.eddies).values()))
        return coupling

    def snapshot(self, kept: Floats | None = None) -> CouplingState:
        """All that `resume` needs, beside the water at the grains; `kept` is that of all processes, by id."""
        walk = self.eddies
        z, force_z = self._arrays.z.copy(), self._arrays.force_z.copy()
        if kept is not None:
            z, walk = kept[:, KEPT_Z].copy(), None if walk is None else _eddies_of(kept)
        z.flags.writeable = force_z.flags.writeable = False
        return CouplingState(self.state, z, force_z, self.steps, self.due, self.exchanges, self.worst, walk)

    @property
    def kept(self) -> Floats:
        """What goes with the grains here to another process, columns of `model.fluid`."""
        kept = np.zeros((len(self._arrays.z), N_KEPT))
        kept[:, KEPT_Z] = self._arrays.z
        if self.eddies is not None:
            kept[:, KEPT_R : KEPT_R + 3] = self.eddies.r
            kept[:, KEPT_SPENT], kept[:, KEPT_COUNT] = self.eddies.spent, self.eddies.count
        return kept

    def hold(self, ids: Ints, kept: Floats, sampled: Floats) -> None:
        """Go on with the grains that are in this process now, since some came and some went.

        Parameters
        ----------
        ids : of the grains here.
        kept, sampled : what `kept` and `sampled` were of each, wherever it was, columns of `model.fluid`.
        """
        if self.ids is not None and np.array_equal(ids, self.ids):
            return
        self.ids, self.sampled = ids, sampled
        self._cut(np.ascontiguousarray(kept[:, KEPT_Z]))
        if self.eddies is not None:
            self.eddies = _eddies_of(kept)

    @property
    def state(self) -> WaterState:
        """Present state of the water."""
        return water_of(self._rows.view(), self._faces.view(), self._out, *self._about)

    @property
    def checksum(self) -> int:
        """Of the profiles of the water: the same where all their bits are."""
        return crc32(self._faces.data, crc32(self._rows.data))

    @property
    def budget(self) -> Budget | None:
        """Momentum budget of the water over the last interval; None before the first, and after a resume."""
        return budget_of(self._out) if len(self._out) == step.N_SCALAR else None

    def change(self, scene: Scene) -> None:
        """Take over a scene that the timeline changed: its slope, or removed fixed grains."""
        assert scene.column is not None
        before, self.scene, self.column = self.scene, scene, scene.column
        self._cut(self._arrays.z)
        if not np.array_equal(scene.fixed_active, before.fixed_active):
            # the same bits as after a resume
            free = _of_free_grains(self._arrays, scene.column, self.processes)
            self.phi = free + self._arrays.bed.phi

    def _cut(self, z: Floats) -> None:
        """Cut the grains here at their heights at the last exchange [m]."""
        scene, column, force_z = self.scene, self.column, self._arrays.force_z
        phi_bed, surface = concentration_of_bed(scene, column), float(self._out[SURFACE])
        self._arrays = ExchangeArrays.of(scene, column, z, surface, phi_bed, self.ids, self.processes)
        self._arrays.force_z[:] = force_z

    def exchange(self, x: Floats, v: Floats, impulse: Floats) -> Floats:
        """Give, move on and tell, as `Fluid.exchange`.

        Raises
        ------
        WaterError : the water cannot be moved on, or drag acts faster than a step resolves.
        NotANumber : the height of a grain is not finite.
        """
        x, v = with_those_away(self.scene, self.column.z_low, x, v)
        dt, arrays = self.steps * self.scene.dt, self._arrays
        volume, t, count = self._about
        rows, faces = np.empty_like(self._rows), np.empty_like(self._faces)
        out = np.zeros(step.N_SCALAR)
        if self.processes is None or self.ids is None:
            status = step.exchange_step(
                arrays.p, arrays.area, arrays.laws, arrays.grains, arrays.bed, arrays.cut, arrays.wet,
                arrays.bed_cut, arrays.bed_wet, arrays.reaches, x, v, impulse, self.sampled, dt, volume,
                self._out, self._rows, arrays.z, self.phi, arrays.force_z, rows, faces, out,
            )  # fmt: skip
        else:
            status = step.exchange_of_processes(
                self.processes, self.ids, arrays, (x, v, impulse, self.sampled), dt, volume, self._out,
                self._rows, self.phi, rows, faces, out,
            )  # fmt: skip
        if status == step.NOT_FINITE:
            raise NotANumber(
                "the height is not finite",
                grain=int(out[step.BAD]),
                step=self.due,
                t=t + dt,
                hint="Most likely the step is too long for the springs: raise time.steps_per_contact, which "
                "shortens the step.",
            )
        if status != DONE:
            raise fault_of(status, count, t)
        self._rows, self._faces, self._out, self._about = rows, faces, out, (volume, t + dt, count + 1)
        arrays.reaches = bool(out[step.REACHES])
        self.exchanges, self.worst = self.exchanges + 1, max(self.worst, float(out[step.RESIDUAL]))
        fastest = float(out[step.FASTEST])
        refuse_unresolved(fastest, self.scene.dt, STIFF, *self._about[1:])
        self.steps = steps_resolved(fastest, self.scene.dt, self.column.interval)
        self.due += self.steps
        if self.eddies is not None:
            self.eddies = eddies.renew(self.eddies, self.column.seed, dt, self.sampled[:, SHEAR], self.ids)
        self.sampled = self._water_at_grains()
        return self.sampled

    def among(self, x: Floats, step: int) -> "Coupling":
        """The same water at a step at which grains have entered or left, as `Fluid.among`.

        Notes
        -----
        The water in each cell is what it was, and so is its momentum. What entering grains displace moves on
        with the next exchange, as it does where grains move from cell to cell.
        """
        other = Coupling.begin(self.scene, self.column, x, step, state=self.state)
        other.exchanges, other.worst, other.eddies = self.exchanges, self.worst, self.eddies
        other._arrays.force_z[:] = self._arrays.force_z
        other.sampled = other._water_at_grains()
        return other

    def frame(self) -> Mapping[str, Floats]:
        """Profiles and numbers of a frame, as `Column.frame_shapes`."""
        found = {**vars(self.state), "phi": self.phi}
        return {name: np.array(found[name]) for name in self.column.frame_shapes()}

    def surface_at(self, x: Floats) -> Floats:
        """Height of the surface, the same everywhere [m], same shape."""
        return np.full(x.shape, float(self._out[SURFACE]))

    @property
    def text(self) -> str:
        """Discharge and speed in a line."""
        found = self.numbers()
        return f"discharge {found['discharge']:.4g} m2/s  fastest {found['speed_max']:.3g} m/s"

    def numbers(self) -> dict[str, float | int]:
        """State of the water for the summary of a run; SI."""
        state, column = self.state, self.column
        return {
            "exchanges": self.exchanges,
            "steps_between": self.steps,
            "momentum_residual": self.worst,
            "discharge": discharge(state),
            "bed_stress": float(state.tau[0]),
            "surface": state.z_surface,
            "speed_max": float(np.max(np.abs(state.u))),
            "densest": self.densest(),
            "driving_gradient": state.gradient + column.rho_w * column.g_x,
        }

    def densest(self) -> float:
        """Largest concentration, averaged over the height of a grain [-]."""
        column = self.column
        return float(np.max(averaged(column.dz, column.d, column.n - 1, self.phi)))

    def warnings(self) -> list[str]:
        """Warnings about the water, one sentence each."""
        column, densest = self.column, self.densest()
        if (
            "grains" not in column.mixing.marks
            or column.bed is not BedKind.MOVING
            or densest >= column.phi_max
        ):
            return []
        return [
            f"no part of the bed reaches the packed concentration {column.phi_max:.3g}: the largest is "
            f"{densest:.3g}, averaged over the height of a grain, so turbulence enters the bed. If the bed "
            "is at rest, set water.column.packed to its concentration"
        ]

    def _water_at_grains(self) -> Floats:
        """State of the water at every grain."""
        arrays = self._arrays
        wet = arrays.wet if arrays.reaches else arrays.cut
        speeds = np.zeros((0, 3))
        if self.eddies is not None:
            cut, water = arrays.slices(self.column, wet), self.state
            u_tau, drift, shear = eddies.turbulence(self.column, water, self.phi, cut)
            speeds = eddies.speeds(self.eddies, self.scene.plane_case, u_tau, drift, shear)
        sampled = np.empty((len(arrays.z), N_SAMPLED))
        step.water_at_grains(
            arrays.p, arrays.laws, arrays.grains, wet, self._rows, float(self._out[GRADIENT]), self.phi,
            arrays.force_z, speeds, sampled,
        )  # fmt: skip
        return sampled


def _of_free_grains(arrays: ExchangeArrays, column: Column, processes: SharingProcesses | None) -> Floats:
    """Concentration of the free grains of all processes [-], shape (n,)."""
    free = weighted_concentration(arrays.slices(column, arrays.cut), arrays.grains.solid / arrays.cut.whole)
    if processes is not None:
        processes.add(free)
    return free


def _eddies_of(kept: Floats) -> Eddies:
    """Eddies as they go with the grains."""
    r, spent = kept[:, KEPT_R : KEPT_R + 3].copy(), kept[:, KEPT_SPENT].copy()
    return Eddies(r, spent, kept[:, KEPT_COUNT].astype(np.int64))
