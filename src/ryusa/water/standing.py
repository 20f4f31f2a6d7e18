"""Grains that stand still in the water: what they take from it, and water that flows steadily past them."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ryusa.errors import WaterError
from ryusa.laws.drag import volume
from ryusa.model.column import Bed, Column, WaterState
from ryusa.model.enums import Buoyancy, Drag
from ryusa.model.resistance import hindered
from ryusa.model.scene import Floats, Water
from ryusa.water._kernel import kernel
from ryusa.water.brim import below
from ryusa.water.exchange import Cells, Slices, concentration, slices, to_cells, to_grains
from ryusa.water.steady import steady

PACKED = 0.99  # concentration beyond which a cell holds no water to speak of
NUDGE = 1.0e-4  # relative change of the slip by which the slope of the drag is found
CLOSE, MOST = 1.0e-9, 400  # relative change of the speed at which the start is steady; turns


class Held(NamedTuple):
    """Forces of the water on standing grains by volume of cells, each of shape (n,); see `solve.advance`."""

    force: Floats  # along the bed, drag and buoyancy [N/m3]
    slope: Floats  # how it grows with the speed of the water [N s/m4]
    carried: Floats  # share of d tau/dz on top [-]
    force_z: Floats  # drag upwards [N/m3]


@dataclass(frozen=True)
class Standing:
    """Grains that do not move.

    Attributes
    ----------
    cut : their slices.
    z : heights of their centres [m], shape (n_grain,).
    d : diameters [m], shape (n_grain,).
    phi : concentration [-], shape (n,).
    walled : the law of a rough wall speaks for them: they fill cells and take nothing.
    """

    cut: Slices
    z: Floats
    d: Floats
    phi: Floats
    walled: bool

    @staticmethod
    def at(z: Floats, d: Floats, cells: Cells, bed: Bed) -> "Standing":
        """Spheres at heights z [m], of diameters d [m], at the bottom of a column with such a bed."""
        cut = slices(z, d, cells)
        return Standing(
            cut, np.ascontiguousarray(z), np.ascontiguousarray(d), concentration(cut), bed is Bed.ROUGH
        )

    def hold(self, water: Water, rho_g_x: float, state: WaterState, phi: Floats) -> Held:
        """Forces of the water, with the laws and the form of buoyancy that free grains feel.

        Parameters
        ----------
        water : laws of drag, hindrance and buoyancy.
        rho_g_x : weight of the water along the bed [N/m3].
        state, phi : water, and concentration of all grains [-], shape (n,).

        Notes
        -----
        The drag of a grain over its slip follows from the mean speed over its volume; every slice then drags
        the water of its cell by that water's own speed, as slices of free grains do. Its slope is laid into
        each cell as if the grain lay there alone. So the sum is exact where the speed no longer changes, and
        a step of any length is stable.
        """
        n = len(phi)
        given = np.zeros((n, 3))
        if self.walled:
            return Held(*np.zeros((4, n)))
        cells = self.cut.cells
        if len(self.d):
            cut = below(self.cut, self.z, self.d, state.z_surface)
            at = to_grains(cut, np.column_stack([state.u, state.w, np.minimum(phi, PACKED)]), "wet")
            out = _drags(water, at, cut.share, self.d)
            given = to_cells(cut, out, "wet").cells / cells.volume
            given[:, 0] *= state.u
        wet = np.clip((state.z_surface - cells.faces[:-1]) / cells.dz, 0.0, 1.0)
        return _held(given, water, self.phi, wet, state.gradient, rho_g_x)


def lying(column: Column, fixed: Floats, free: Floats, d: float) -> Floats:
    """Concentration once the free grains lie on the bed [-], shape (n,), averaged over a diameter.

    Parameters
    ----------
    column : what holds still of the water; they lie as dense as its phi_max.
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


def flowing(column: Column, water: Water, fixed: Floats, free: Floats, d: float) -> WaterState:
    """Water that flows steadily over the bed, for a start without the time to gain speed.

    Parameters
    ----------
    column : what holds still of the water.
    water : laws of drag, hindrance and buoyancy.
    fixed, free : concentrations of fixed and of free grains now [-], shape (n,).
    d : diameter of the grains, sum of d**3 over sum of d**2 [m].

    Raises
    ------
    WaterError : drag and driver find no balance.

    Notes
    -----
    Over a moving bed the water flows past grains at rest which lie as dense as they will, see `lying`: first
    grains are placed loosely. Over a wall it flows as without free grains.
    """
    start = WaterState.at_rest(column, fixed + free)
    phi = lying(column, fixed, free, d) if column.bed is Bed.MOVING else fixed
    state = WaterState.at_rest(column, phi)
    sizes = np.full(column.n, d)
    wet = np.clip((column.z_surface - column.faces[:-1]) / column.dz, 0.0, 1.0)
    for _ in range(MOST):
        held = Held(*np.zeros((4, column.n)))
        if column.bed is not Bed.ROUGH:
            drags = _drags(water, np.column_stack([state.u, 0.0 * wet, phi]), wet, sizes)
            given = drags * (phi / volume(d, math.pi / 6.0))[:, None]
            given[:, 0] *= state.u
            held = _held(given, water, phi, wet, state.gradient, column.rho_w * column.g_x)
        now, _ = steady(column, phi, held.force, slope=held.slope, carried=held.carried, guess=state.u)
        change, state = float(np.max(np.abs(now.u - state.u))), now
        if change <= CLOSE * float(np.max(np.abs(now.u))):
            names = ("u", "shear", "dtau_dz", "tau", "nu_t", "gradient")
            return replace(start, **{name: getattr(now, name) for name in names})
    raise WaterError(
        "Water that flows steadily over the first grains was not found",
        step=0,
        t=0.0,
        hint='Begin with water at rest, water.column.start = "rest".',
    )


def _held(given: Floats, water: Water, phi: Floats, wet: Floats, gradient: float, rho_g_x: float) -> Held:
    """Drag along x, its slope and drag along z by volume of cells, and the buoyancy of grains of phi.

    `wet` is the part of a cell below the surface.
    """
    force, share = given[:, 0].copy(), np.zeros(len(phi))
    if water.buoyancy == Buoyancy.STRESS:
        force, share = force + phi * wet * gradient, phi
    elif water.buoyancy == Buoyancy.WEIGHT:
        force += phi * wet * (gradient - rho_g_x)
    return Held(force, given[:, 1].copy(), share, given[:, 2].copy())


def _drags(water: Water, at: Floats, share: Floats, d: Floats) -> Floats:
    """Of resting grains: drag over slip [N s/m], slope of drag [N s/m], drag along z [N], (n_grain, 3)."""
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
    """Drag over slip, slope of drag [N s/m], drag along z [N] of each grain; at: u, w [m/s], phi [-]."""
    for i in range(d.shape[0]):
        u, w, phi = at[i, 0], at[i, 1], at[i, 2]
        slip = max(math.sqrt(u * u + w * w), 1.0e-9 * nu / d[i])
        k = share[i] * hindered(law, hindrance, stress, exponent, slip, phi, d[i], nu, rho_w, a_2, c_d)
        more = slip * (1.0 + NUDGE)
        k_more = share[i] * hindered(law, hindrance, stress, exponent, more, phi, d[i], nu, rho_w, a_2, c_d)
        out[i, 0], out[i, 1], out[i, 2] = k, (k_more * (1.0 + NUDGE) - k) / NUDGE, k * w
