"""Forces of the water on fixed grains, and steady flow over a bed at rest as an initial state."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ryusa.errors import WaterError
from ryusa.laws._family import numbers
from ryusa.laws.dispatch import hindered
from ryusa.laws.drag import volume
from ryusa.laws.families import BedKind, Buoyancy, Drag
from ryusa.model.column import Column, WaterState
from ryusa.model.scene import Floats, Water
from ryusa.water._kernel import kernel
from ryusa.water.at_grains import DENSEST
from ryusa.water.exchange import Cells, Slices, concentration, slices, to_cells, to_grains
from ryusa.water.free_surface import submerged_part
from ryusa.water.steady import steady

numbers(__name__, Buoyancy.WEIGHT, Buoyancy.STRESS, Buoyancy.PRESSURE)
DRAG_STEP = 1.0e-4  # relative change of the slip speed in the numerical derivative of the drag
TOLERANCE, MAX_ITERATIONS = (
    1.0e-9,
    400,
)  # relative change of the speed at which the initial state is steady; iterations


class FixedGrainForces(NamedTuple):
    """Forces of the water on fixed grains per volume of cells, each of shape (n,); see `solve.advance`."""

    force: Floats  # along the bed, drag and buoyancy [N/m3]
    slope: Floats  # derivative with respect to the speed of the water [N s/m4]
    carried: Floats  # share of d tau/dz that they take in addition [-]
    force_z: Floats  # drag upwards [N/m3]


@dataclass(frozen=True)
class FixedGrains:
    """Fixed grains in a column of water.

    Attributes
    ----------
    cut : their slices.
    z : heights of their centres [m], shape (n_grain,).
    d : diameters [m], shape (n_grain,).
    phi : concentration [-], shape (n,).
    covered_by_wall_law : the law of a rough wall stands for their drag: they fill cells but take no force.
    """

    cut: Slices
    z: Floats
    d: Floats
    phi: Floats
    covered_by_wall_law: bool

    @staticmethod
    def at(z: Floats, d: Floats, cells: Cells, bed: BedKind) -> "FixedGrains":
        """Spheres at heights z [m] with diameters d [m] in a column with the bed condition `bed`."""
        cut = slices(z, d, cells)
        return FixedGrains(
            cut, np.ascontiguousarray(z), np.ascontiguousarray(d), concentration(cut), bed is BedKind.ROUGH
        )

    def forces(self, water: Water, rho_g_x: float, state: WaterState, phi: Floats) -> FixedGrainForces:
        """Forces of the water, by the laws and the form of buoyancy that apply to free grains.

        Parameters
        ----------
        water : laws of drag, hindrance and buoyancy.
        rho_g_x : weight of the water along the bed [N/m3].
        state, phi : water, and concentration of all grains [-], shape (n,).

        Notes
        -----
        The drag coefficient of a grain follows from the mean speed over its volume; each slice then acts on
        the water of its cell with the speed in that cell, as for free grains. The derivative of the drag is
        taken in each cell as if the grain lay there alone. The sum is therefore exact in steady flow, and a
        step of any length is stable.
        """
        n = len(phi)
        given = np.zeros((n, 3))
        if self.covered_by_wall_law:
            return FixedGrainForces(*np.zeros((4, n)))
        cells = self.cut.cells
        if len(self.d):
            cut = submerged_part(self.cut, self.z, self.d, state.z_surface)
            at = to_grains(cut, np.column_stack([state.u, state.w, np.minimum(phi, DENSEST)]), "submerged")
            out = _drags(water, at, cut.share, self.d)
            given = to_cells(cut, out, "submerged").cells / cells.volume
            given[:, 0] *= state.u
        submerged = np.clip((state.z_surface - cells.faces[:-1]) / cells.dz, 0.0, 1.0)
        return _forces_per_volume(given, water, self.phi, submerged, state.gradient, rho_g_x)


def settled_concentration(column: Column, fixed: Floats, free: Floats, d: float) -> Floats:
    """Concentration once the free grains have settled on the bed [-], shape (n,), averaged over a diameter.

    Parameters
    ----------
    column : parameters of the column; settled grains have its concentration phi_max.
    fixed, free : concentrations of fixed and of free grains now [-], shape (n,).
    d : diameter [m].
    """
    left, phi = float(free.sum()), fixed.copy()
    for k in range(column.n):
        more = min(left, max(column.phi_max - phi[k], 0.0))
        phi[k] += more
        left -= more
    window = np.ones(2 * round(0.5 * d / column.dz) + 1)
    return np.convolve(phi, window, "same") / np.convolve(np.ones(column.n), window, "same")


def steady_start(column: Column, water: Water, fixed: Floats, free: Floats, d: float) -> WaterState:
    """Steady flow over the bed, as an initial state that needs no spin-up.

    Parameters
    ----------
    column : parameters of the column.
    water : laws of drag, hindrance and buoyancy.
    fixed, free : concentrations of fixed and of free grains now [-], shape (n,).
    d : diameter of the grains, sum of d**3 over sum of d**2 [m].

    Raises
    ------
    WaterError : the iteration for the steady flow did not converge.

    Notes
    -----
    Over a moving bed the water flows past grains at rest in their settled state (`settled_concentration`),
    because first grains are placed loosely. Over a wall it flows as without free grains.
    """
    start = WaterState.at_rest(column, fixed + free)
    phi = settled_concentration(column, fixed, free, d) if column.bed is BedKind.MOVING else fixed
    state = WaterState.at_rest(column, phi)
    sizes = np.full(column.n, d)
    submerged = np.clip((column.z_surface - column.faces[:-1]) / column.dz, 0.0, 1.0)
    for _ in range(MAX_ITERATIONS):
        forces = FixedGrainForces(*np.zeros((4, column.n)))
        if column.bed is not BedKind.ROUGH:
            drags = _drags(water, np.column_stack([state.u, 0.0 * submerged, phi]), submerged, sizes)
            given = drags * (phi / volume(d, math.pi / 6.0))[:, None]
            given[:, 0] *= state.u
            forces = _forces_per_volume(
                given, water, phi, submerged, state.gradient, column.rho_w * column.g_x
            )
        now, _ = steady(column, phi, forces.force, slope=forces.slope, carried=forces.carried, guess=state.u)
        change, state = float(np.max(np.abs(now.u - state.u))), now
        if change <= TOLERANCE * float(np.max(np.abs(now.u))):
            names = ("u", "shear", "dtau_dz", "tau", "nu_t", "gradient")
            return replace(start, **{name: getattr(now, name) for name in names})
    raise WaterError(
        "No steady flow over the initial bed was found",
        step=0,
        t=0.0,
        hint='Start from water at rest: water.column.start = "rest".',
    )


def _forces_per_volume(
    given: Floats, water: Water, phi: Floats, submerged: Floats, gradient: float, rho_g_x: float
) -> FixedGrainForces:
    """Drag along x, its derivative and drag along z per volume of cells, and the buoyancy for phi.

    `submerged` is the part of a cell below the surface.
    """
    force, share = given[:, 0].copy(), np.zeros(len(phi))
    if water.buoyancy == Buoyancy.STRESS:
        force, share = force + phi * submerged * gradient, phi
    elif water.buoyancy == Buoyancy.WEIGHT:
        force += phi * submerged * (gradient - rho_g_x)
    return FixedGrainForces(force, given[:, 1].copy(), share, given[:, 2].copy())


def _drags(water: Water, at: Floats, share: Floats, d: Floats) -> Floats:
    """Drag over slip, derivative of drag [N s/m], drag along z [N] of grains at rest, (n_grain, 3)."""
    out = np.zeros((len(d), 3))
    if water.drag != Drag.NONE:
        _resist(
            int(water.drag), int(water.hindrance), water.buoyancy == Buoyancy.STRESS,
            float(water.hindrance_exponent), at, share, d, float(water.nu), float(water.rho_w),
            float(water.a_2), float(water.c_d), out,
        )  # fmt: skip
    return out


@kernel
def _resist(
    law: int, hindrance: int, stress: bool, exponent: float, at: Floats, share: Floats, d: Floats, nu: float,
    rho_w: float, a_2: float, c_d: float, out: Floats,
) -> None:  # fmt: skip
    """Drag over slip, derivative of drag [N s/m], drag along z [N] per grain; at: u, w [m/s], phi [-]."""
    for i in range(d.shape[0]):
        u, w, phi = at[i, 0], at[i, 1], at[i, 2]
        slip = max(math.sqrt(u * u + w * w), 1.0e-9 * nu / d[i])
        k = share[i] * hindered(law, hindrance, stress, exponent, slip, phi, d[i], nu, rho_w, a_2, c_d)
        more = slip * (1.0 + DRAG_STEP)
        k_more = share[i] * hindered(law, hindrance, stress, exponent, more, phi, d[i], nu, rho_w, a_2, c_d)
        out[i, 0], out[i, 1], out[i, 2] = k, (k_more * (1.0 + DRAG_STEP) - k) / DRAG_STEP, k * w
