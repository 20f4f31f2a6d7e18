"""Compiled implicit time step of the column: its water, and the momentum balance of its cells."""

from ryusa.laws._family import numbers
from ryusa.laws.families import SurfaceRule
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.closures import mixing_lengths
from ryusa.water.drive import imposed_gradient
from ryusa.water.momentum_balance import (
    DONE,
    GRADIENT,
    NO_ROOM,
    SURFACE,
    TOO_SHORT,
    StepWorkspace,
    friction_velocity_at,
    iterate,
    sources_of,
    weigh_vertical_flow,
    workspace,
    write_results,
)

DEPTH, VOLUME = numbers(__name__, SurfaceRule.DEPTH, SurfaceRule.VOLUME)


@kernel
def distribute_water(
    p: ColumnParameters, first: int, phi: Floats, volume: float, content: Floats, h: Floats, z: Floats
) -> tuple[int, float]:
    """Distribute the water over the cells: content, wet thickness h and its middle z [m], shape (n,).

    Parameters
    ----------
    p, phi, volume : as in `time_step`.
    first : lowest cell that can hold water; those below it are left as they are.

    Returns
    -------
    m, z_surface : highest wet cell, and height of the surface [m]; m = n if the column is too short, -1
        without water, -2 if a concentration is not below 1.
    """
    left = volume
    m = -1
    z_surface = p.z_surface
    for k in range(first, p.n):
        low = p.z_low + k * p.dz
        eps = 1.0 - phi[k]
        if not 0.0 < eps <= 1.0:
            return -2, z_surface
        if p.surface == VOLUME:
            wet = min(left / eps, p.dz)
            left -= eps * wet
        else:
            wet = min(z_surface - low, p.dz)
        if wet <= 1.0e-12 * p.dz:
            wet = 0.0
        else:
            m = k
            if p.surface == VOLUME:
                z_surface = low + wet
        h[k] = wet
        content[k] = eps * wet
        z[k] = low + 0.5 * wet
    if p.surface == VOLUME and left > 1.0e-12 * volume:
        return p.n, z_surface
    return m, z_surface


@kernel
def vertical_flow(
    p: ColumnParameters,
    m: int,
    content: Floats,
    content_old: Floats,
    per_dt: float,
    work: StepWorkspace,
) -> int:
    """Vertical flux of water through the faces, from the change of content.

    Returns
    -------
    last : highest cell with water now or before the step; the latter still passes its momentum down.
    """
    q = work.q
    last = m
    q[:] = 0.0
    if per_dt > 0.0:
        for k in range(p.n):
            q[k + 1] = q[k] - (content[k] - content_old[k]) * per_dt
            if content_old[k] > 0.0 and k > last:
                last = k
    return last


@kernel
def time_step(
    p: ColumnParameters,
    given_rows: Floats,
    volume: float,
    per_dt: float,
    rows: Floats,
    faces: Floats,
    out: Floats,
) -> int:
    """One step, backward Euler, solved to round-off; per_dt = 1/dt, 0 for the steady state.

    Parameters
    ----------
    given_rows : u and content before the step, first guess of u, then the fields of `Sources`; shape
        (N_GIVEN, n).
    rows, faces : output; u, w, content, shear, du_dt, dtau_dz, shape (6, n); tau, nu_t, shape (2, n + 1).
    """
    n = p.n
    u_old, content_old, guess = given_rows[0], given_rows[1], given_rows[2]
    given = sources_of(given_rows)
    u, content = rows[0], rows[2]
    work = workspace(n)
    m, z_surface = distribute_water(p, 0, given.phi, volume, content, work.h, work.z)
    if m < 0:
        return NO_ROOM
    if m >= n:
        return TOO_SHORT
    u_star = friction_velocity_at(p, guess[0], work.z[0] - p.z_low)
    mixing_lengths(p, m, given.phi, work.z, z_surface, u_star, work.square)
    last = vertical_flow(p, m, content, content_old, per_dt, work)
    weigh_vertical_flow(p, m, last, u_old, work)
    lost = 0.0  # forces in cells that have run dry act on the highest wet cell
    for k in range(m + 1, n):
        lost += given.force[k]
    gradient = imposed_gradient(p, content, z_surface)
    u[:] = guess
    status, gradient = iterate(
        p, m, last, z_surface, u_star, u_old, content_old, given, gradient, lost, per_dt, 1.0, 1.0, u,
        content, out, work,
    )  # fmt: skip
    if status == DONE:
        out[SURFACE], out[GRADIENT] = z_surface, gradient
        write_results(p, m, last, u_old, content_old, given, gradient, lost, per_dt, rows, faces, out, work)
    return status
