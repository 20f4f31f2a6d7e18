"""Water and grains hand over what they do to each other, once in an interval of steps. design/0007.

Within an interval the slices of the grains and the water hold still. What a grain took in it goes back to the
cells with the same slices, so that momentum closes to round-off.
"""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import WaterError
from ryusa.model import Scene
from ryusa.model.column import Budget, Column, WaterState
from ryusa.model.enums import Buoyancy
from ryusa.model.immersed import A_X, DRAG, EXTRA_X, EXTRA_Z, N_SEEN, PHI, SHARE, SHEAR, U, W
from ryusa.model.scene import Floats
from ryusa.water.drive import discharge
from ryusa.water.exchange import Cells, Slices, carried, concentration, slices, to_cells, to_grains
from ryusa.water.solve import advance

PACKED = 0.99  # concentration beyond which a cell holds no water to speak of
QUARTER = 0.25  # of the time in which drag equalises water and grains: longest interval


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
    """

    scene: Scene
    column: Column
    longest: int
    steps: int
    state: WaterState
    phi: Floats
    budget: Budget | None
    seen: Floats
    exchanges: int
    worst: float  # largest residual of the water's momentum over its largest term [-]
    _slices: Slices
    _bed: Floats  # concentration of fixed grains [-]
    _volume: Floats  # of each grain, A_3 d**3 [m3]
    _force_z: Floats  # of the water on grains along z, by volume of cells [N/m3]

    @staticmethod
    def begin(
        scene: Scene, column: Column, longest: int, x: Floats, state: WaterState | None = None
    ) -> "Coupling":
        """Cut the grains at x [m], and fill the column: with water at rest, or that of a snapshot.

        Raises
        ------
        ValueError : the column cannot be run, or the steps of an interval are fewer than one.
        """
        faults = column.refuses()
        if faults or longest < 1:
            raise ValueError("; ".join(faults) or f"an interval of {longest} steps: at least 1")
        cells = Cells(column.z_low, column.dz, column.n, column.area)
        cut = slices(x[:, 2], scene.d, cells)
        solid = (scene.m - scene.m_weight) / scene.water.rho_w
        standing = scene.fixed_active
        bed = concentration(slices(scene.x_fixed[standing, 2], scene.d_fixed[standing], cells))
        phi = _phi(cut, solid) + bed
        now = WaterState.at_rest(column, phi) if state is None else state
        coupling = Coupling(
            scene, column, longest, 1, now, phi, None, np.zeros((scene.n_grain, N_SEEN)), 0, 0.0,
            cut, bed, solid, np.zeros(column.n),
        )  # fmt: skip
        coupling.seen = coupling._told()
        return coupling

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
        dt = self.steps * self.scene.dt
        force = self.force(taken, dt)
        self._slices = slices(x[:, 2], self.scene.d, self._slices.cells, again=self._slices)
        self.phi = _phi(self._slices, self._volume) + self._bed
        phi_w = carried(self._slices, v[:, 2] * self._volume / self._slices.whole)
        self.state, self.budget = advance(self.column, self.state, self.phi, force, dt, phi_w=phi_w)
        self.exchanges, self.worst = self.exchanges + 1, max(self.worst, self.budget.relative)
        self.steps = min(self.longest, self._resolved(taken[:, DRAG]))
        self.seen = self._told()
        return self.seen

    def force(self, taken: Floats, dt: float) -> Floats:
        """All forces of the water on grains along the bed over an interval, by volume of cells [N/m3]."""
        scene, cut = self.scene, self._slices
        archimedes = (scene.m_weight - scene.m) * scene.gravity[0]
        mean = taken[:, 0] / dt
        both = to_cells(cut, np.column_stack([mean, taken[:, 2] / dt]), "wet").cells / cut.cells.volume
        rest = to_cells(cut, archimedes + self.seen[:, EXTRA_X], "wet").cells / cut.cells.volume
        self._force_z = both[:, 1]
        return both[:, 0] + rest

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
            "driving_gradient": state.gradient + column.rho_w * column.g_x,
        }

    def _resolved(self, drag: Floats) -> int:
        """Steps an interval may have where drag is so stiff [N s/m], shape (n_grain,)."""
        scene, cut = self.scene, self._slices
        per = to_cells(cut, drag, "wet").cells / cut.cells.volume
        water = scene.water.rho_w * np.maximum(1.0 - self.phi, 1.0 - PACKED)
        fastest = max(
            float(np.max(per / water, initial=0.0)),
            float(np.max(drag / (scene.m + scene.m_added), initial=0.0)),
        )
        if fastest * scene.dt * self.longest <= QUARTER:
            return self.longest
        most = math.floor(QUARTER / (fastest * scene.dt))
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
        scene, state, cut = self.scene, self.state, self._slices
        eps = 1.0 - self.phi
        water = scene.water
        along = np.column_stack([state.u, state.w, state.shear, self.phi, state.du_dt, state.dtau_dz])
        at = to_grains(cut, along, "wet")
        share = cut.share
        seen = np.zeros((scene.n_grain, N_SEEN))
        seen[:, U], seen[:, W], seen[:, SHEAR] = at[:, 0], at[:, 1], at[:, 2]
        seen[:, PHI], seen[:, A_X], seen[:, SHARE] = np.minimum(at[:, 3], PACKED), at[:, 4] * share, share
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
