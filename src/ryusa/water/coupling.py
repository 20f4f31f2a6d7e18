"""Two-way coupling of water and grains: momentum is exchanged once per coupling interval (design/0007).

Within an interval the slices of the grains and the state of the water are constant. The impulse that a grain
received is taken from the cells with the same slices, so that momentum is conserved to round-off.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from ryusa.errors import WaterError
from ryusa.laws._family import numbers
from ryusa.laws.families import BedKind, Buoyancy, Fluctuations, Mixing, Start
from ryusa.model import CouplingState, Scene
from ryusa.model.column import STIFF, Budget, Column, WaterState
from ryusa.model.eddies import Eddies
from ryusa.model.fluid import DRAG, N_SAMPLED, SHEAR
from ryusa.model.scene import Floats
from ryusa.water import eddies
from ryusa.water.at_grains import DENSEST, given_by_grains, sample
from ryusa.water.closures import averaged
from ryusa.water.drive import discharge
from ryusa.water.exchange import Cells, Slices, slices, to_cells, to_grains, weighted_concentration
from ryusa.water.fixed_grains import FixedGrainForces, FixedGrains, steady_start
from ryusa.water.free_surface import submerged_part
from ryusa.water.solve import advance

numbers(__name__, Start.REST, Start.STEADY)
numbers(__name__, Fluctuations.NONE, Fluctuations.RANDOM_WALK)


@dataclass
class Coupling:
    """The column of water of a run, and the state of the water at its grains.

    Attributes
    ----------
    scene : the scene; its water has the profile COLUMN.
    column : cells, boundaries, driver, closures.
    longest : largest number of engine steps in an interval.
    steps : steps in the present interval; 1 in the first, where no drag is known yet.
    state : present state of the water.
    phi : present concentration of grains in the cells, fixed ones included [-], shape (n,).
    budget : momentum budget of the water over the last interval; None before the first.
    sampled : water at the grains as given last, columns of `model.fluid`.
    due : step of the engine at which the next exchange is due.
    exchanges : number of exchanges so far.
    worst : largest residual of the momentum budget so far, over its largest term [-].
    eddies : present eddies of the grains; None without fluctuations.
    """

    scene: Scene
    column: Column
    longest: int
    steps: int
    state: WaterState
    phi: Floats
    budget: Budget | None
    sampled: Floats
    due: int
    exchanges: int
    worst: float
    _slices: Slices  # of whole grains: volume in the cells
    _submerged: Slices  # of the parts below the surface: exchange of forces
    _bed: FixedGrains  # fixed grains
    _volume: Floats  # of each grain, A_3 d**3 [m3]
    _force_z: Floats  # of the water on grains along z, per volume of cells [N/m3]
    _z: Floats  # heights at which the grains are cut [m]
    eddies: Eddies | None = None

    @staticmethod
    def begin(
        scene: Scene, column: Column, longest: int, x: Floats, state: WaterState | None = None, step: int = 0
    ) -> "Coupling":
        """Cut the grains at x [m], and fill the column with its initial state or with a given one.

        Raises
        ------
        ValueError : the column is not valid, or `longest` is less than 1.
        WaterError : no steady initial state was found.
        """
        faults = column.refuses()
        if faults or longest < 1:
            raise ValueError("; ".join(faults) or f"an interval of {longest} steps: at least 1")
        cells = Cells(column.z_low, column.dz, column.n, column.area)
        cut = slices(x[:, 2], scene.d, cells)
        solid = (scene.m - scene.m_weight) / scene.water.rho_w
        bed = _bed(scene, cells, column.bed)
        free = _phi(cut, solid)
        phi = free + bed.phi
        if state is None and column.start is Start.STEADY:
            every = np.concatenate([scene.d, bed.d])
            state = steady_start(
                column, scene.water, bed.phi, free, float((every**3).sum() / (every**2).sum())
            )
        now = WaterState.at_rest(column, phi) if state is None else state
        coupling = Coupling(
            scene, column, longest, 1, now, phi, None, np.zeros((scene.n_grain, N_SAMPLED)), step + 1, 0, 0.0,
            cut, submerged_part(cut, x[:, 2], scene.d, now.z_surface), bed, solid, np.zeros(column.n),
            np.array(x[:, 2]),
        )  # fmt: skip
        if column.fluctuations is Fluctuations.RANDOM_WALK:
            coupling.eddies = eddies.begin(column.seed, scene.n_grain)
        coupling.sampled = coupling._fluid_at_grains()
        return coupling

    @staticmethod
    def resume(
        scene: Scene, column: Column, longest: int, found: CouplingState, sampled: Floats
    ) -> "Coupling":
        """Go on from a snapshot; `sampled` is the water at its grains, columns of `model.fluid`.

        Raises
        ------
        ValueError : as `begin`, or the snapshot does not match the column or the grains.
        """
        if found.water.u.shape != (column.n,) or found.z.shape != (scene.n_grain,):
            raise ValueError(
                f"the snapshot has {len(found.water.u)} cells and {len(found.z)} grains, the run has "
                f"{column.n} cells and {scene.n_grain} grains"
            )
        x = np.zeros((scene.n_grain, 3))
        x[:, 2] = found.z
        coupling = Coupling.begin(scene, column, longest, x, found.water)
        coupling.steps, coupling.due = found.steps, found.due
        coupling.exchanges, coupling.worst = found.exchanges, found.worst
        coupling.sampled, coupling._force_z = sampled, found.force_z
        coupling.eddies = found.eddies
        return coupling

    def snapshot(self) -> CouplingState:
        """All that `resume` needs, beside the water at the grains."""
        z, force_z = self._z.copy(), self._force_z.copy()
        z.flags.writeable = force_z.flags.writeable = False
        return CouplingState(
            self.state, z, force_z, self.steps, self.due, self.exchanges, self.worst, self.eddies
        )

    def change(self, scene: Scene, column: Column) -> None:
        """Take over a scene that the timeline changed: its slope, or removed fixed grains."""
        if not np.array_equal(scene.fixed_active, self.scene.fixed_active):
            self._bed = _bed(scene, self._slices.cells, column.bed)
            self.phi = _phi(self._slices, self._volume) + self._bed.phi  # the same bits as after a resume
        self.scene, self.column = scene, column

    def exchange(self, x: Floats, v: Floats, impulse: Floats) -> Floats:
        """Give the water what the grains took in the interval, move it on, and tell the grains anew.

        Parameters
        ----------
        x, v : centres and velocities of the grains now [m], [m/s], shape (n_grain, 3).
        impulse : what each took from the water in the interval, columns of `model.fluid`.

        Returns
        -------
        sampled : columns of `model.fluid`, shape (n_grain, N_SAMPLED); for the engine.
        """
        dt, before = self.steps * self.scene.dt, self.state
        force = self.force(impulse, dt)
        self._z = np.ascontiguousarray(x[:, 2])
        self._slices = slices(self._z, self.scene.d, self._slices.cells, reuse=self._slices)
        solid = self._volume / self._slices.whole
        both = weighted_concentration(self._slices, np.column_stack([solid, v[:, 2] * solid]))
        self.phi, phi_w = both[:, 0] + self._bed.phi, both[:, 1]
        fixed = self._bed.forces(self.scene.water, self.column.rho_w * self.column.g_x, before, self.phi)
        self._force_z += fixed.force_z
        self.state, budget = advance(
            self.column, before, self.phi, force + fixed.force, dt, slope=fixed.slope, carried=fixed.carried,
            phi_w=phi_w,
        )  # fmt: skip
        self._submerged = submerged_part(self._slices, self._z, self.scene.d, self.state.z_surface)
        self.budget = _with_fixed(budget, fixed, self.state, before, self.column.dz)
        self.exchanges, self.worst = self.exchanges + 1, max(self.worst, self.budget.relative)
        self.steps = min(self.longest, self._resolved(impulse[:, DRAG]))
        self.due += self.steps
        if self.eddies is not None:
            self.eddies = eddies.renew(self.eddies, self.column.seed, dt, self.sampled[:, SHEAR])
        self.sampled = self._fluid_at_grains()
        return self.sampled

    def force(self, impulse: Floats, dt: float) -> Floats:
        """Force of the water on grains along the bed, averaged over an interval, per volume of cells [N/m3].

        Each slice acts on the water with the slip in its cell; the sum over slices is the force on the grain.
        """
        scene, cut, u = self.scene, self._submerged, self.state.u
        archimedes = (scene.m_weight - scene.m) * scene.gravity[0]
        met = to_grains(cut, u, "submerged")
        amounts = given_by_grains(impulse, met, archimedes, self.sampled, 1.0 / dt)
        sums = to_cells(cut, amounts, "submerged").cells / cut.cells.volume
        self._force_z = sums[:, 1].copy()
        return sums[:, 0] + (sums[:, 2] * u - sums[:, 3])

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
            column.mixing is not Mixing.LI_SAWAMOTO
            or column.bed is not BedKind.MOVING
            or densest >= column.phi_max
        ):
            return []
        return [
            f"no part of the bed reaches the packed concentration {column.phi_max:.3g}: the largest is "
            f"{densest:.3g}, averaged over the height of a grain, so turbulence enters the bed. If the bed "
            "is at rest, set water.column.packed to its concentration"
        ]

    def _resolved(self, drag: Floats) -> int:
        """Steps for which an interval resolves the drag, with coefficients [N s/m], shape (n_grain,)."""
        scene, cut = self.scene, self._submerged
        per = to_cells(cut, drag, "submerged").cells / cut.cells.volume
        water = scene.water.rho_w * np.maximum(1.0 - self.phi, 1.0 - DENSEST)
        fastest = max(
            float(np.max(per / water, initial=0.0)),
            float(np.max(drag / (scene.m + scene.m_added), initial=0.0)),
        )
        if fastest * scene.dt * self.longest <= STIFF:
            return self.longest
        most = math.floor(STIFF / (fastest * scene.dt))
        if most < 1:
            raise WaterError(
                f"Drag brings grains to the speed of the water within {1.0 / fastest:.3g} s, which a step of "
                f"{scene.dt:.3g} s does not resolve",
                step=self.state.step,
                t=self.state.t,
                hint="Take a shorter step (time.step), larger grains or a less viscous fluid.",
            )
        return most

    def _fluid_at_grains(self) -> Floats:
        """State of the water at every grain."""
        scene, state, cut = self.scene, self.state, self._submerged
        eps = 1.0 - self.phi
        water = scene.water
        along = [state.u, state.w, state.shear, self.phi, state.du_dt]
        if water.buoyancy == Buoyancy.STRESS:
            along += [state.dtau_dz, self._force_z / np.maximum(eps, 1.0 - DENSEST)]
        at = to_grains(cut, np.column_stack(along), "submerged")
        both = np.zeros((0, 3))
        if self.eddies is not None:
            u_tau, drift = eddies.turbulence(self.column, state, self.phi, cut)
            both = eddies.speeds(self.eddies, scene.plane_case, u_tau, drift, at[:, 2])
        sampled = np.empty((scene.n_grain, N_SAMPLED))
        sample(
            at, cut.share, self._volume, both, int(water.buoyancy), state.gradient, water.rho_w,
            scene.gravity[0], scene.gravity[2], sampled,
        )  # fmt: skip
        return sampled


def _phi(cut: Slices, solid: Floats) -> Floats:
    """Concentration of grains of volume `solid` [m3], with the slices of their spheres."""
    return weighted_concentration(cut, solid / cut.whole)


def _bed(scene: Scene, cells: Cells, bed: BedKind) -> FixedGrains:
    """The fixed grains that are still there."""
    there = scene.fixed_active
    return FixedGrains.at(scene.x_fixed[there, 2], scene.d_fixed[there], cells, bed)


def _with_fixed(
    budget: Budget, fixed: FixedGrainForces, now: WaterState, before: WaterState, dz: float
) -> Budget:
    """The budget, with the force on fixed grains separated from that on free grains."""
    wet = now.content > 0.0
    taken = float(fixed.force.sum() + (fixed.slope * (now.u - before.u))[wet].sum()) * dz
    return replace(budget, grains=budget.grains + taken, fixed=budget.carried - taken, carried=0.0)
