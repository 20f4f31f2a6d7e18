"""Compiled momentum balance of a column: Newton's method, momentum budget.

One column (`time_step`) and each station of a row of columns (`row_step`) solve it.
"""

import math
from typing import NamedTuple

import numpy as np

from ryusa.laws.dispatch import length_of_wall
from ryusa.laws.families import SideWalls
from ryusa.laws.turbulence import eddy_viscosity
from ryusa.model.column import Top
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.closures import bed_shear, bed_stress, mixing_lengths, side_drag
from ryusa.water.drive import DISCHARGE

LID = int(Top.LID)
NO_WALLS = int(SideWalls.NONE)
TOLERANCE = 1.0e-13  # relative change of the speed at which Newton's method stops
ROUND_OFF = 1.0e-9  # relative change accepted where the next is no smaller: limit of round-off
MAX_ITERATIONS = 300
# Iterations after which only half of a change is taken: the wall's two layers meet in a kink.
DAMPED_AFTER = 30
DONE, TOO_SHORT, NO_ROOM, NOT_A_NUMBER, NOT_CONVERGED = range(5)
# scalars that a step writes, beside its profiles
SURFACE, GRADIENT, ITERATIONS = range(3)
B_GRAVITY, B_DRIVER, B_BED, B_LID, B_SIDE, B_GRAINS, B_SHARED, B_SURFACE, B_CHANGE = range(3, 12)
B_FIXED = 12  # written by an exchange, which tells fixed grains from free ones
B_ADVECTED = 13  # written by a row of columns: momentum that the flow brings along the bed
N_OUT = 14
N_GIVEN = 9  # rows of `given_rows` of `time_step`


class Sources(NamedTuple):
    """Action of the grains on the cells during a step, each of shape (n,); see `solve.advance`."""

    phi: Floats
    force: Floats
    slope: Floats
    carried: Floats
    phi_w: Floats
    advected: Floats  # momentum that the flow along the bed brings, over density [m2/s2]; zero in one column


class StepWorkspace(NamedTuple):
    """Work arrays of one step; cells of shape (n,), faces of shape (n + 1,)."""

    h: Floats  # wet thickness of a cell [m]
    z: Floats  # middle of its wet part [m]
    q: Floats  # upward flux of water through a face, per area [m/s]
    below: Floats  # weight of the cell below a face in the momentum of that flux [-]
    square: Floats  # volume fraction of water times mixing length squared at a face [m2]
    k_face: Floats  # tau/rho at a face is k_face (u above - u below) - r_face
    r_face: Floats
    k_side: Floats  # side walls and cell: r_side - k_side u [m2/s2]
    r_side: Floats
    a: Floats  # the tridiagonal system
    b: Floats
    c: Floats
    r: Floats
    y: Floats
    scratch: Floats


@kernel
def weigh_vertical_flow(p: ColumnParameters, m: int, last: int, u_old: Floats, work: StepWorkspace) -> None:
    """Determine how the vertical flux of water carries momentum.

    Notes
    -----
    The flux carries the mean speed of both cells where friction between them exceeds it (no numerical
    diffusion), else the speed of the upstream cell.
    """
    q, below = work.q, work.below
    below[:] = 1.0
    for f in range(1, last + 1):
        mixed = 0.0
        if f <= m:
            gap = work.z[f] - work.z[f - 1]
            mixed = (p.nu + eddy_viscosity(1.0, (u_old[f] - u_old[f - 1]) / gap, work.square[f])) / gap
        if 0.5 * abs(q[f]) <= mixed:
            below[f] = 0.5
        elif q[f] < 0.0:
            below[f] = 0.0


@kernel
def linearise(p: ColumnParameters, m: int, u: Floats, content: Floats, work: StepWorkspace) -> None:
    """Linearise all stresses at the speeds u for Newton's method: bed, faces, lid and side walls."""
    wall = work.z[0] - p.z_low
    stress, rate = bed_stress(p, u[0], wall, work.square[0])
    work.k_face[0], work.r_face[0] = rate, rate * u[0] - stress
    for f in range(1, m + 1):
        gap = work.z[f] - work.z[f - 1]
        shear = (u[f] - u[f - 1]) / gap
        nu_t = eddy_viscosity(1.0, shear, work.square[f])
        work.k_face[f] = (p.nu + 2.0 * nu_t) / gap
        work.r_face[f] = nu_t * shear
    work.k_face[m + 1] = p.nu / (0.5 * work.h[m]) if p.top == LID else 0.0
    if p.side != NO_WALLS:
        for k in range(m + 1):
            drag, grows = side_drag(p, u[k])
            work.k_side[k] = -content[k] * grows
            work.r_side[k] = content[k] * (drag - grows * u[k])


@kernel
def assemble(
    p: ColumnParameters,
    m: int,
    last: int,
    u_old: Floats,
    content: Floats,
    content_old: Floats,
    given: Sources,
    gradient: float,
    lost: float,
    per_dt: float,
    work: StepWorkspace,
) -> None:
    """Momentum balance of each cell over density: a u_below + b u + c u_above = r [m2/s2]."""
    a, b, c, r, y, q, below = work.a, work.b, work.c, work.r, work.y, work.q, work.below
    for k in range(last + 1):
        share = 1.0 - given.carried[k] if k <= m else 1.0
        a[k] = -share * work.k_face[k] - q[k] * below[k]
        c[k] = -share * work.k_face[k + 1] + q[k + 1] * (1.0 - below[k + 1])
        b[k] = content[k] * per_dt + share * (work.k_face[k] + work.k_face[k + 1])
        b[k] += q[k + 1] * below[k + 1] - q[k] * (1.0 - below[k])
        r[k] = content_old[k] * per_dt * u_old[k] + share * (work.r_face[k] - work.r_face[k + 1])
        r[k] += given.advected[k]
        y[k] = work.h[k] / p.rho_w
        if k <= m:
            taken = given.force[k] - given.slope[k] * u_old[k]
            if k == m:
                r[k] += share * work.k_face[k + 1] * p.u_lid
                taken += lost
            b[k] += work.k_side[k] + given.slope[k] * p.dz / p.rho_w
            r[k] += work.r_side[k] + p.g_x * content[k] - taken * p.dz / p.rho_w + gradient * y[k]


@kernel
def tridiagonal(n: int, both: bool, work: StepWorkspace) -> None:
    """Solve the system for r, and for y if `both`, in place."""
    a, b, c, r, y, scratch = work.a, work.b, work.c, work.r, work.y, work.scratch
    scratch[0] = c[0] / b[0]
    r[0] /= b[0]
    y[0] /= b[0]
    for k in range(1, n):
        pivot = 1.0 / (b[k] - a[k] * scratch[k - 1])
        scratch[k] = c[k] * pivot
        r[k] = (r[k] - a[k] * r[k - 1]) * pivot
        if both:
            y[k] = (y[k] - a[k] * y[k - 1]) * pivot
    for k in range(n - 2, -1, -1):
        r[k] -= scratch[k] * r[k + 1]
        if both:
            y[k] -= scratch[k] * y[k + 1]


@kernel
def write_results(
    p: ColumnParameters,
    m: int,
    last: int,
    u_old: Floats,
    content_old: Floats,
    given: Sources,
    gradient: float,
    lost: float,
    per_dt: float,
    rows: Floats,
    faces: Floats,
    out: Floats,
    work: StepWorkspace,
) -> None:
    """Write stresses, derivatives and momentum budget, with the stresses of the last linear system."""
    u, content, tau, nu_t = rows[0], rows[2], faces[0], faces[1]
    tau[:] = 0.0
    nu_t[:] = 0.0
    tau[0] = p.rho_w * (work.k_face[0] * u[0] - work.r_face[0])
    nu_t[0] = eddy_viscosity(1.0, u[0] / (work.z[0] - p.z_low), work.square[0])
    for f in range(1, m + 1):
        tau[f] = p.rho_w * (work.k_face[f] * (u[f] - u[f - 1]) - work.r_face[f])
        nu_t[f] = eddy_viscosity(1.0, (u[f] - u[f - 1]) / (work.z[f] - work.z[f - 1]), work.square[f])
    if p.top == LID:
        tau[m + 1] = p.rho_w * work.k_face[m + 1] * (p.u_lid - u[m])
    out[B_GRAVITY : B_CHANGE + 1] = 0.0
    for k in range(last + 1):
        out[B_CHANGE] += p.rho_w * (content[k] * u[k] - content_old[k] * u_old[k]) * per_dt
        if k <= m:
            out[B_GRAVITY] += p.rho_w * p.g_x * content[k]
            out[B_DRIVER] += gradient * work.h[k]
            out[B_SIDE] += p.rho_w * (work.r_side[k] - work.k_side[k] * u[k])
            out[B_GRAINS] -= (given.force[k] + given.slope[k] * (u[k] - u_old[k])) * p.dz
            out[B_SHARED] -= given.carried[k] * (tau[k + 1] - tau[k])
    out[B_GRAINS] -= lost * p.dz
    out[B_BED], out[B_LID] = -tau[0], tau[m + 1]
    out[B_SURFACE] = -p.rho_w * work.q[last + 1] * u[last]

    u[m + 1 :] = u[m]
    w, shear, du_dt, dtau_dz = rows[1], rows[3], rows[4], rows[5]
    rows[1, m + 1 :] = 0.0
    rows[3:, m + 1 :] = 0.0
    for k in range(m + 1):
        w[k] = -given.phi_w[k] / (1.0 - given.phi[k])
        dtau_dz[k] = (tau[k + 1] - tau[k]) / work.h[k]
        if k == 0:
            shear[k] = bed_shear(p, u[0], work.z[0] - p.z_low, tau[0] / p.rho_w)
        else:
            shear[k] = 0.5 * (u[k] - u[k - 1]) / (work.z[k] - work.z[k - 1])
            if k < m:
                shear[k] += 0.5 * (u[k + 1] - u[k]) / (work.z[k + 1] - work.z[k])
            elif p.top == LID:
                shear[k] += (p.u_lid - u[k]) / work.h[k]
        du_dt[k] = (u[k] - u_old[k]) * per_dt + w[k] * shear[k]


@kernel
def gradient_of_discharge(p: ColumnParameters, m: int, content: Floats, work: StepWorkspace) -> float:
    """Pressure gradient [Pa/m] with which the solution of the linear system has the prescribed discharge."""
    without, per_gradient = 0.0, 0.0
    for k in range(m + 1):
        without += content[k] * work.r[k]
        per_gradient += content[k] * work.y[k]
    return (p.discharge - without) / per_gradient


@kernel
def largest_change(u: Floats, last: int, work: StepWorkspace) -> tuple[float, float]:
    """Largest change of the speed and largest speed [m/s]; the latter is nan if a speed is not finite."""
    change, scale = 0.0, 0.0
    for k in range(last + 1):
        change = max(change, abs(work.r[k] - u[k]))
        scale = max(scale, abs(work.r[k]))
        if not np.isfinite(work.r[k]):
            return change, np.nan
    return change, scale


@kernel
def iterate(
    p: ColumnParameters,
    m: int,
    last: int,
    z_surface: float,
    u_star: float,
    u_old: Floats,
    content_old: Floats,
    given: Sources,
    gradient: float,
    lost: float,
    per_dt: float,
    steep: float,
    part: float,
    u: Floats,
    content: Floats,
    out: Floats,
    work: StepWorkspace,
) -> tuple[int, float]:
    """Solve the momentum balance by Newton's method, which starts at the speeds u and overwrites them.

    Parameters
    ----------
    p, m, last, u_old, content_old, given, lost, per_dt, content, work : as in `assemble`.
    z_surface, u_star : height of the surface [m], and friction velocity at the speeds u [m/s].
    gradient : pressure gradient [Pa/m], where the column does not solve for it.
    steep, part : factors of all stresses [-]; 1 unless the flow is inclined to the x axis (`row_station`).

    Returns
    -------
    status, gradient : DONE or a fault, and the pressure gradient [Pa/m].
    """
    wall = work.z[0] - p.z_low
    solve_gradient = p.drive == DISCHARGE
    status = NOT_CONVERGED
    change_before = np.inf
    for iteration in range(MAX_ITERATIONS):
        if length_of_wall(p.mixing) and iteration > 0:
            stress, _ = bed_stress(p, u[0], wall, work.square[0])
            damped = 1.0 if iteration < DAMPED_AFTER else 0.5
            u_star += damped * (np.sqrt(abs(stress)) - u_star)
            mixing_lengths(p, m, given.phi, work.z, z_surface, u_star, work.square)
        linearise(p, m, u, content, work)
        if steep != 1.0:
            steepen(m, steep, part, work)
        known = 0.0 if solve_gradient else gradient
        assemble(p, m, last, u_old, content, content_old, given, known, lost, per_dt, work)
        tridiagonal(last + 1, solve_gradient, work)
        if solve_gradient:
            gradient = gradient_of_discharge(p, m, content, work)
            for k in range(last + 1):
                work.r[k] += gradient * work.y[k]
        change, scale = largest_change(u, last, work)
        if not np.isfinite(scale):
            return NOT_A_NUMBER, gradient
        stuck = change <= ROUND_OFF * scale and change >= 0.9 * change_before
        if change <= TOLERANCE * scale or stuck:
            status = DONE
        change_before = change
        damped = 1.0 if iteration < DAMPED_AFTER or status == DONE else 0.5
        for k in range(last + 1):
            u[k] = work.r[k] if damped == 1.0 else u[k] + damped * (work.r[k] - u[k])
        out[ITERATIONS] = iteration + 1.0
        if status == DONE:
            break
    return status, gradient


@kernel
def steepen(m: int, steep: float, part: float, work: StepWorkspace) -> None:
    """Multiply the linearised stresses by the factors of a flow inclined to the x axis."""
    for f in range(m + 2):
        work.k_face[f] *= steep * part
        work.r_face[f] *= steep * part
    for k in range(m + 1):
        work.k_side[k] *= math.sqrt(steep) * part
        work.r_side[k] *= math.sqrt(steep) * part


@kernel
def sources_of(given_rows: Floats) -> Sources:
    """The fields of `Sources` in the rows given to a step."""
    return Sources(
        given_rows[3], given_rows[4], given_rows[5], given_rows[6], given_rows[7], given_rows[8]
    )  # fmt: skip


@kernel
def workspace(n: int) -> StepWorkspace:
    """Work arrays for a column of n cells."""
    cells, edges = np.zeros((10, n)), np.zeros((5, n + 1))
    return StepWorkspace(
        cells[0], cells[1], edges[0], edges[1], edges[2], edges[3], edges[4], cells[2], cells[3], cells[4],
        cells[5], cells[6], cells[7], cells[8], cells[9],
    )  # fmt: skip


@kernel
def friction_velocity_at(p: ColumnParameters, u: float, wall: float) -> float:
    """Friction velocity [m/s] at the speed u [m/s] of the lowest cell, `wall` [m] above the bed."""
    stress, _ = bed_stress(p, u, wall, 0.0)
    return np.sqrt(abs(stress))
