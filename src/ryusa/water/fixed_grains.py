"""Forces of the water on fixed grains, and steady flow over a bed at rest as an initial state."""

import math
from dataclasses import replace
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
from ryusa.water.steady import steady

numbers(__name__, Buoyancy.WEIGHT, Buoyancy.STRESS, Buoyancy.PRESSURE)
DRAG_STEP = 1.0e-4  # relative change of the slip speed in the numerical derivative of the drag
# Relative change of the speed at which the initial state is steady; iterations.
TOLERANCE, MAX_ITERATIONS = 1.0e-9, 400


class FixedGrainForces(NamedTuple):
    """Forces of the water on fixed grains per volume of cells, each of shape (n,); see `solve.advance`."""

    force: Floats  # along the bed, drag and buoyancy [N/m3]
    slope: Floats  # derivative with respect to the speed of the water [N s/m4]
    carried: Floats  # share of d tau/dz that they take in addition [-]
    force_z: Floats  # drag upwards [N/m3]


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
        drag_on_fixed(
            int(water.drag), int(water.hindrance), water.buoyancy == Buoyancy.STRESS,
            float(water.hindrance_exponent), at, share, d, float(water.nu), float(water.rho_w),
            float(water.a_2), float(water.c_d), out,
        )  # fmt: skip
    return out


@kernel
def drag_on_fixed(
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
