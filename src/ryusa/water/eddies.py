"""Turbulent fluctuations by a discrete random walk: each grain passes through a sequence of eddies.

An eddy keeps its speed over u_tau during its lifetime; its age is measured in lifetimes at the position of
the grain. Eddies are renewed at exchanges, so that an eddy lasts at least one interval. The random numbers of
an eddy follow from (seed, grain, number of earlier eddies of the grain) alone: they do not depend on threads,
order or resume. A drift velocity keeps fluid particles uniformly mixed; the shorter interaction of a heavy
grain that falls out of its eddy is not modelled.
"""

import math
from typing import Any

import numpy as np

from ryusa.laws.eddies import eddy_along, eddy_drift, eddy_life
from ryusa.laws.families import BedKind
from ryusa.model.column import Column, WaterState
from ryusa.model.eddies import Eddies
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel, parameters_of
from ryusa.water.exchange import Ints, Slices, to_grains

ROUGH = int(BedKind.ROUGH)
LEAST = 0.01  # lower limit of the volume fraction of water in a cell
GOLDEN, MIX_1, MIX_2 = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB


@kernel
def _mixed(word: Any) -> Any:
    """Mix 64 bits with the finaliser of SplitMix64 (Steele, Lea & Flood 2014)."""
    word = (word ^ (word >> np.uint64(30))) * np.uint64(MIX_1)
    word = (word ^ (word >> np.uint64(27))) * np.uint64(MIX_2)
    return word ^ (word >> np.uint64(31))


@kernel
def draw(seed: int, grain: int, count: int, k: int) -> float:
    """Uniform random number in (0, 1) [-], number k of eddy `count` of a grain."""
    word = _mixed(np.uint64(seed) + np.uint64(GOLDEN))
    word = _mixed(word + np.uint64(GOLDEN) * np.uint64(grain + 1))
    word = _mixed(word + np.uint64(GOLDEN) * np.uint64(count + 1))
    word = _mixed(word + np.uint64(GOLDEN) * np.uint64(k + 1))
    return (float(word >> np.uint64(11)) + 0.5) * (1.0 / 9007199254740992.0)


@kernel
def _born(seed: int, grain: int, count: int, i: int, r: Floats) -> None:
    """Draw the speeds of eddy `count` of the grain in row i, by Box & Muller from four uniform numbers."""
    for k, axis in ((0, 0), (2, 1)):
        size = math.sqrt(-2.0 * math.log(draw(seed, grain, count, k)))
        turn = 2.0 * math.pi * draw(seed, grain, count, k + 1)
        r[i, axis] = size * math.cos(turn)
        if axis == 0:
            r[i, 2] = size * math.sin(turn)


@kernel
def _begin(seed: int, ids: Ints, r: Floats, spent: Floats) -> None:
    for i in range(len(spent)):
        _born(seed, ids[i], 0, i, r)
        spent[i] = draw(seed, ids[i], 0, 4)


@kernel
def _renew(seed: int, dt: float, ids: Ints, shear: Floats, r: Floats, spent: Floats, count: Any) -> None:
    for i in range(len(spent)):
        spent[i] += dt / eddy_life(shear[i])
        if spent[i] >= 1.0:
            left = math.floor(spent[i])
            spent[i] -= left
            count[i] += int(left)
            _born(seed, ids[i], count[i], i, r)


@kernel
def _speeds(plane: bool, r: Floats, u_tau: Floats, drift: Floats, shear: Floats, u: Floats) -> None:
    for i in range(len(u)):
        u[i, 0] = eddy_along(r[i, 0], r[i, 2], u_tau[i], shear[i])
        u[i, 1] = 0.0 if plane else r[i, 1] * u_tau[i]
        u[i, 2] = r[i, 2] * u_tau[i] + drift[i]


@kernel
def _drift(dz: float, u_tau: Floats, viscosity: Floats, drift: Floats) -> None:
    """Drift velocity in cells, from u_tau [m/s] and diffusivity l u_tau [m2/s] at their faces."""
    for k in range(len(drift)):
        length = 0.0
        for f in (k, k + 1):
            if u_tau[f] > 0.0:
                length += 0.5 * viscosity[f] / u_tau[f]
        drift[k] = eddy_drift(length, (u_tau[k + 1] - u_tau[k]) / dz)


def begin(seed: int, n_grain: int, ids: Ints | None = None) -> Eddies:
    """Put every grain into an eddy of random age.

    Parameters
    ----------
    seed : of the case.
    n_grain : number of rows.
    ids : ids of the grains in the rows, shape (n_grain,); None: 0 to n_grain - 1.
    """
    r, spent = np.zeros((n_grain, 3)), np.zeros(n_grain)
    _begin(seed, np.arange(n_grain) if ids is None else ids, r, spent)
    return Eddies(r, spent, np.zeros(n_grain, np.int64))


def renew(eddies: Eddies, seed: int, dt: float, shear: Floats, ids: Ints | None = None) -> Eddies:
    """Advance the age of the eddies, and renew those that have ended.

    Parameters
    ----------
    eddies : present eddies of the grains.
    seed : of the case.
    dt : elapsed time [s].
    shear : velocity gradient of the water at each grain in that time [1/s], shape (n_grain,).
    ids : as in `begin`.
    """
    r, spent, count = eddies.r.copy(), eddies.spent.copy(), eddies.count.copy()
    _renew(
        seed, dt, np.arange(len(spent)) if ids is None else ids, np.ascontiguousarray(shear), r, spent, count
    )
    return Eddies(r, spent, count)


def speeds(eddies: Eddies, plane: bool, u_tau: Floats, drift: Floats, shear: Floats) -> Floats:
    """Velocity fluctuation of the water at each grain [m/s], shape (n_grain, 3).

    Parameters
    ----------
    eddies : present eddies of the grains.
    plane : motion in x-z only; then there is no transverse fluctuation.
    u_tau, drift : intensity of the turbulence at each grain, and drift velocity along z [m/s].
    shear : velocity gradient of the water there [1/s]; all of shape (n_grain,).
    """
    u = np.empty((len(u_tau), 3))
    _speeds(plane, eddies.r, u_tau, drift, np.ascontiguousarray(shear), u)
    return u


def turbulence(column: Column, state: WaterState, phi: Floats, cut: Slices) -> tuple[Floats, Floats, Floats]:
    """Turbulence at each grain: intensity u_tau, drift velocity along z [m/s], shear of the water [1/s].

    Parameters
    ----------
    column, state : the water.
    phi : concentration in its cells [-], shape (n,).
    cut : slices of the grains.

    Notes
    -----
    u_tau**2 is the turbulent part of the shear stress over density and volume fraction, nu_t |dU/dz|/eps. It
    vanishes at a wall, except at a rough bed, where the lowest cell takes the value of the face above it.
    """
    square, drift = np.empty((2, column.n))
    turbulence_of_cells(parameters_of(column), state.tau, state.nu_t, phi, square, drift)
    at = to_grains(cut, np.column_stack([square, drift, state.shear]), "submerged")
    return np.sqrt(at[:, 0]), at[:, 1], at[:, 2]


@kernel
def turbulence_of_cells(
    p: ColumnParameters, tau: Floats, nu_t: Floats, phi: Floats, square: Floats, drift: Floats
) -> None:
    """Write the square of u_tau [m2/s2] and the drift velocity [m/s] in the cells, each of shape (n,).

    Parameters
    ----------
    p : the column.
    tau, nu_t : stress [Pa] and eddy viscosity [m2/s] at the faces, shape (n + 1,).
    phi : concentration [-], shape (n,).
    """
    u_tau, viscosity = np.empty(p.n + 1), np.empty(p.n + 1)
    for f in range(p.n + 1):
        below = max(1.0 - phi[max(f - 1, 0)], LEAST)
        above = max(1.0 - phi[min(f, p.n - 1)], LEAST)
        viscosity[f] = nu_t[f] / (0.5 * (above + below))
        u_tau[f] = abs(tau[f]) / p.rho_w * viscosity[f] / (p.nu + nu_t[f])
    if p.bed == ROUGH:
        u_tau[0] = u_tau[1]
    for k in range(p.n):
        square[k] = 0.5 * (u_tau[k] + u_tau[k + 1])
    for f in range(p.n + 1):
        u_tau[f] = math.sqrt(u_tau[f])
    _drift(p.dz, u_tau, viscosity, drift)
