"""Water and grains hand over what they do to each other, once in an interval of steps. design/0007.

Within an interval the slices of the grains and the water hold still. What a grain took in it goes back to the
cells with the same slices, so that momentum closes to round-off.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from ryusa.errors import WaterError
from ryusa.model import Coupled, Scene
from ryusa.model.column import STIFF, Bed, Budget, Column, Mixing, Start, WaterState
from ryusa.model.eddies import Eddies
from ryusa.model.enums import Buoyancy
from ryusa.model.immersed import A_X, DRAG, EXTRA_X, EXTRA_Z, N_SEEN, PHI, SHARE, SHEAR, U, V, W
from ryusa.model.scene import Floats
from ryusa.water import eddies
from ryusa.water.brim import below
from ryusa.water.closures import averaged
from ryusa.water.drive import discharge
from ryusa.water.exchange import Cells, Slices, carried, slices, to_cells, to_grains
from ryusa.water.solve import advance
from ryusa.water.standing import PACKED, Held, Standing, flowing


@dataclass
class Coupling:
    """The column of a run, and the water as its grains see it.

    Attributes
    ----------
    scene : what holds still; its water has the profile COLUMN.
    column : cells, boundaries, driver, closures.
    longest : steps of the engine in an interval, at most.
    steps : steps in the interval under way; 1 in the first, before any drag is known.
    state : the water now.
    phi : concentration of grains, fixed ones included, in the cells now [-], shape (n,).
    budget : momentum of the water over the last interval; None before the first.
    seen : what the grains were told last, columns of `model.immersed`.
    due : step of the engine at which the next exchange is due.
    exchanges : done so far.
    worst : largest residual of the water's momentum over its largest term so far [-].
    eddies : those the grains are in; None without fluctuations.
    """

    scene: Scene
    column: Column
    longest: int
    steps: int
    state: WaterState
    phi: Floats
    budget: Budget | None
    seen: Floats
    due: int
    exchanges: int
    worst: float
    _slices: Slices  # of whole grains: what fills the cells
    _wet: Slices  # of what of them is below the surface: what water and grains do to each other
    _bed: Standing  # fixed grains
    _volume: Floats  # of each grain, A_3 d**3 [m3]
    _force_z: Floats  # of the water on grains along z, by volume of cells [N/m3]
    _z: Floats  # heights at which the grains are cut [m]
    eddies: Eddies | None = None

    @staticmethod
    def begin(
        scene: Scene, column: Column, longest: int, x: Floats, state: WaterState | None = None, step: int = 0
    ) -> "Coupling":
        """Cut the grains at x [m], and fill the column: as it says it begins, or with a state given.

        Raises
        ------
        ValueError : the column cannot be run, or the steps of an interval are fewer than one.
        WaterError : no steady water was found to begin with.
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
            state = flowing(column, scene.water, bed.phi, free, float((every**3).sum() / (every**2).sum()))
        now = WaterState.at_rest(column, phi) if state is None else state
        coupling = Coupling(
            scene, column, longest, 1, now, phi, None, np.zeros((scene.n_grain, N_SEEN)), step + 1, 0, 0.0,
            cut, below(cut, x[:, 2], scene.d, now.z_surface), bed, solid, np.zeros(column.n),
            np.array(x[:, 2]),
        )  # fmt: skip
        coupling.eddies = eddies.begin(column.seed, scene.n_grain) if column.fluctuations else None
        coupling.seen = coupling._told()
        return coupling

    @staticmethod
    def resume(scene: Scene, column: Column, longest: int, found: Coupled, seen: Floats) -> "Coupling":
        """Go on from a snapshot; `seen` is what its grains were told, columns of `model.immersed`.

        Raises
        ------
        ValueError : as `begin`, or the snapshot is of another column or other grains.
        """
        if found.water.u.shape != (column.n,) or found.z.shape != (scene.n_grain,):
            raise ValueError(
                f"a snapshot of {len(found.water.u)} cells and {len(found.z)} grains does not go on in a "
                f"column of {column.n} cells with {scene.n_grain} grains"
            )
        x = np.zeros((scene.n_grain, 3))
        x[:, 2] = found.z
        coupling = Coupling.begin(scene, column, longest, x, found.water)
        coupling.steps, coupling.due = found.steps, found.due
        coupling.exchanges, coupling.worst = found.exchanges, found.worst
        coupling.seen, coupling._force_z = seen, found.force_z
        coupling.eddies = found.eddies
        return coupling

    def snapshot(self) -> Coupled:
        """All that `resume` needs, beside what the grains were told."""
        z, force_z = self._z.copy(), self._force_z.copy()
        z.flags.writeable = force_z.flags.writeable = False
        return Coupled(self.state, z, force_z, self.steps, self.due, self.exchanges, self.worst, self.eddies)

    def change(self, scene: Scene, column: Column) -> None:
        """Go on in a scene that the timeline changed: its slope, or fixed grains taken away."""
        if not np.array_equal(scene.fixed_active, self.scene.fixed_active):
            self._bed = _bed(scene, self._slices.cells, column.bed)
            self.phi = _phi(self._slices, self._volume) + self._bed.phi  # as a resume finds it, to the bit
        self.scene, self.column = scene, column

    def exchange(self, x: Floats, v: Floats, taken: Floats) -> Floats:
        """Give the water what the grains took in the interval, move it on, and tell the grains anew.

        Parameters
        ----------
        x, v : centres and velocities of the grains now [m], [m/s], shape (n_grain, 3).
        taken : what each took from the water in the interval, columns of `model.immersed`.

        Returns
        -------
        seen : columns of `model.immersed`, shape (n_grain, N_SEEN); for the engine.
        """
        dt, before = self.steps * self.scene.dt, self.state
        force = self.force(taken, dt)
        self._z = np.ascontiguousarray(x[:, 2])
        self._slices = slices(self._z, self.scene.d, self._slices.cells, again=self._slices)
        self.phi = _phi(self._slices, self._volume) + self._bed.phi
        phi_w = carried(self._slices, v[:, 2] * self._volume / self._slices.whole)
        held = self._bed.hold(self.scene.water, self.column.rho_w * self.column.g_x, before, self.phi)
        self._force_z += held.force_z
        self.state, budget = advance(
            self.column, before, self.phi, force + held.force, dt, slope=held.slope, carried=held.carried,
            phi_w=phi_w,
        )  # fmt: skip
        self._wet = below(self._slices, self._z, self.scene.d, self.state.z_surface)
        self.budget = _with_fixed(budget, held, self.state, before, self.column.dz)
        self.exchanges, self.worst = self.exchanges + 1, max(self.worst, self.budget.relative)
        self.steps = min(self.longest, self._resolved(taken[:, DRAG]))
        self.due += self.steps
        if self.eddies is not None:
            self.eddies = eddies.renew(self.eddies, self.column.seed, dt, self.seen[:, SHEAR])
        self.seen = self._told()
        return self.seen

    def force(self, taken: Floats, dt: float) -> Floats:
        """All forces of the water on grains along the bed over an interval, by volume of cells [N/m3].

        Every slice of a grain drags the water by its own slip: the sum over slices is what the grain took.
        """
        scene, cut, u, k_d = self.scene, self._wet, self.state.u, taken[:, DRAG]
        archimedes = (scene.m_weight - scene.m) * scene.gravity[0]
        mean = taken[:, 0] / dt
        both = to_cells(cut, np.column_stack([mean, taken[:, 2] / dt]), "wet").cells / cut.cells.volume
        rest = to_cells(cut, archimedes + self.seen[:, EXTRA_X], "wet").cells / cut.cells.volume
        slip = to_cells(cut, np.column_stack([k_d, k_d * to_grains(cut, u, "wet")]), "wet").cells
        self._force_z = both[:, 1]
        return both[:, 0] + rest + (slip[:, 0] * u - slip[:, 1]) / cut.cells.volume

    def numbers(self) -> dict[str, float | int]:
        """Say how the water stands, for the summary of a run; SI."""
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
        """Densest place of the bed now, averaged over the height of a grain [-]."""
        column = self.column
        return float(np.max(averaged(column.dz, column.d, column.n - 1, self.phi)))

    def warnings(self) -> list[str]:
        """What is odd about the water now, in sentences."""
        column, densest = self.column, self.densest()
        if (
            column.mixing is not Mixing.LI_SAWAMOTO
            or column.bed is not Bed.MOVING
            or densest >= column.phi_max
        ):
            return []
        return [
            f"the bed is nowhere packed: concentration {densest:.3g} at most over the height of a grain, "
            f"below {column.phi_max:.3g}; eddies reach into it. If it lies still, give water.column.packed "
            "its concentration"
        ]

    def _resolved(self, drag: Floats) -> int:
        """Steps an interval may have where drag is so stiff [N s/m], shape (n_grain,)."""
        scene, cut = self.scene, self._wet
        per = to_cells(cut, drag, "wet").cells / cut.cells.volume
        water = scene.water.rho_w * np.maximum(1.0 - self.phi, 1.0 - PACKED)
        fastest = max(
            float(np.max(per / water, initial=0.0)),
            float(np.max(drag / (scene.m + scene.m_added), initial=0.0)),
        )
        if fastest * scene.dt * self.longest <= STIFF:
            return self.longest
        most = math.floor(STIFF / (fastest * scene.dt))
        if most < 1:
            raise WaterError(
                f"Drag equalises water and grains within {1.0 / fastest:.3g} s, which a step of "
                f"{scene.dt:.3g} s does not resolve",
                step=self.state.step,
                t=self.state.t,
                hint="Take a shorter step (time.step), larger grains or a thinner fluid.",
            )
        return most

    def _told(self) -> Floats:
        """Water at every grain."""
        scene, state, cut = self.scene, self.state, self._wet
        eps = 1.0 - self.phi
        water = scene.water
        along = np.column_stack([state.u, state.w, state.shear, self.phi, state.du_dt, state.dtau_dz])
        at = to_grains(cut, along, "wet")
        share = cut.share
        seen = np.zeros((scene.n_grain, N_SEEN))
        seen[:, U], seen[:, W], seen[:, SHEAR] = at[:, 0], at[:, 1], at[:, 2]
        seen[:, PHI], seen[:, A_X], seen[:, SHARE] = np.minimum(at[:, 3], PACKED), at[:, 4], share
        if self.eddies is not None:
            u_tau, drift = eddies.turbulence(self.column, state, self.phi, cut)
            seen[:, [U, V, W]] += eddies.speeds(self.eddies, scene.plane_case, u_tau, drift, at[:, 2])
        solid = self._volume * share
        g_x, g_z = scene.gravity[0], scene.gravity[2]
        # the part above the water has no buoyancy
        out = (1.0 - share) * self._volume * water.rho_w
        seen[:, EXTRA_X], seen[:, EXTRA_Z] = out * g_x, out * g_z
        if water.buoyancy == Buoyancy.STRESS:
            seen[:, EXTRA_X] += solid * (at[:, 5] + state.gradient + water.rho_w * g_x)
            seen[:, EXTRA_Z] += solid * to_grains(cut, self._force_z / np.maximum(eps, 1.0 - PACKED), "wet")
        elif water.buoyancy == Buoyancy.WEIGHT:
            seen[:, EXTRA_X] += solid * state.gradient
        else:
            seen[:, EXTRA_X] += solid * water.rho_w * g_x
        return seen


def _phi(cut: Slices, solid: Floats) -> Floats:
    """Concentration of grains of volume `solid` [m3], whose spheres are cut."""
    return carried(cut, solid / cut.whole)


def _bed(scene: Scene, cells: Cells, bed: Bed) -> Standing:
    """The fixed grains that stand."""
    there = scene.fixed_active
    return Standing.at(scene.x_fixed[there, 2], scene.d_fixed[there], cells, bed)


def _with_fixed(budget: Budget, held: Held, now: WaterState, before: WaterState, dz: float) -> Budget:
    """The budget with what the fixed grains took apart from what the free ones did."""
    wet = now.content > 0.0
    taken = float(held.force.sum() + (held.slope * (now.u - before.u))[wet].sum()) * dz
    return replace(budget, grains=budget.grains + taken, fixed=budget.carried - taken, carried=0.0)
