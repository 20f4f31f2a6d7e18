"""One implicit step of the column: a tridiagonal system inside Newton's method.

Momentum of the water along the bed, with its speed U and its volume fraction eps = 1 - phi:

    d(rho eps U)/dt + d(rho eps w U)/dz = d tau/dz - dp/dx + rho eps g_x - (all forces of water on grains)
    tau = rho (nu + nu_t) dU/dz

This holds for every form of buoyancy (design/0007), because the form only decides which force the water
exerts on the grains. Where that force depends on the solution, `carried` gives the share of d tau/dz that the
grains take.
"""

import numpy as np

from ryusa.errors import WaterError
from ryusa.model.column import Budget, Column, WaterState
from ryusa.model.scene import Floats
from ryusa.water import momentum_balance as kernels
from ryusa.water._kernel import parameters_of
from ryusa.water.time_step import time_step


def advance(
    column: Column,
    state: WaterState,
    phi: Floats,
    force: Floats | None,
    dt: float,
    *,
    slope: Floats | None = None,
    carried: Floats | None = None,
    phi_w: Floats | None = None,
) -> tuple[WaterState, Budget]:
    """State of the water after a step dt, and its momentum budget.

    Parameters
    ----------
    column, state : fixed parameters, and the present state of the water.
    phi : concentration of grains at the end of the step [-], shape (n,).
    force : all forces along the bed that the water exerted on the grains during the step, for any form of
        buoyancy, per volume of the cells [N/m3], shape (n,); None: no grains.
    dt : step [s]; any length is stable.
    slope : derivative of `force` with respect to the speed of the water [N s/m4], for forces that depend on
        the solution; None: 0.
    carried : share of d tau/dz that the grains take in addition to `force` [-]: phi for the form `stress`
        where that part is not in `force`; None: 0.
    phi_w : phi times the vertical speed of the grains [m/s], from which that of the water follows; None: 0.

    Notes
    -----
    The nonlinear system is solved to round-off, so that the steady state does not depend on dt. Raises
    `WaterError` if the surface leaves the column, if grains fill a cell completely, or if a value is not
    finite.
    """
    return solve_step(column, state, phi, force, slope, carried, phi_w, 1.0 / dt, state.u, dt)


def solve_step(
    column: Column,
    state: WaterState,
    phi: Floats,
    force: Floats | None,
    slope: Floats | None,
    carried: Floats | None,
    phi_w: Floats | None,
    per_dt: float,
    guess: Floats,
    dt: float,
) -> tuple[WaterState, Budget]:
    """Solve the balance of `advance`; 1/dt = `per_dt` [1/s], Newton's method starts at `guess` [m/s]."""
    n = column.n
    given = np.zeros((kernels.N_GIVEN, n))  # a single array type, so that the step is compiled once
    for row, values in enumerate((state.u, state.content, guess, phi, force, slope, carried, phi_w)):
        if values is not None:
            given[row] = values
    rows, faces, out = np.empty((6, n)), np.empty((2, n + 1)), np.zeros(kernels.N_OUT)
    status = time_step(parameters_of(column), given, float(state.volume), float(per_dt), rows, faces, out)
    if status != kernels.DONE:
        raise fault_of(status, state.step, state.t)
    now = water_of(rows, faces, out, state.volume, state.t + dt, state.step + 1)
    return now, budget_of(out)


def water_of(rows: Floats, faces: Floats, out: Floats, volume: float, t: float, step: int) -> WaterState:
    """State of the water from what `time_step` wrote; its arrays become read-only."""
    rows.flags.writeable = faces.flags.writeable = False
    return WaterState(
        u=rows[0],
        w=rows[1],
        content=rows[2],
        shear=rows[3],
        du_dt=rows[4],
        dtau_dz=rows[5],
        tau=faces[0],
        nu_t=faces[1],
        z_surface=float(out[kernels.SURFACE]),
        volume=volume,
        gradient=float(out[kernels.GRADIENT]),
        t=t,
        step=step,
    )


def profiles_of(state: WaterState) -> tuple[Floats, Floats, Floats]:
    """The inverse of `water_of`: profiles in cells and at faces, and scalars."""
    rows = np.stack([state.u, state.w, state.content, state.shear, state.du_dt, state.dtau_dz])
    out = np.zeros(kernels.N_OUT)
    out[kernels.SURFACE], out[kernels.GRADIENT] = state.z_surface, state.gradient
    return rows, np.stack([state.tau, state.nu_t]), out


def budget_of(out: Floats) -> Budget:
    """Momentum budget from the scalars that `time_step` wrote."""
    return Budget(
        change=float(out[kernels.B_CHANGE]),
        gravity=float(out[kernels.B_GRAVITY]),
        driver=float(out[kernels.B_DRIVER]),
        bed=float(out[kernels.B_BED]),
        lid=float(out[kernels.B_LID]),
        side=float(out[kernels.B_SIDE]),
        grains=float(out[kernels.B_GRAINS]),
        carried=float(out[kernels.B_SHARED]),
        surface=float(out[kernels.B_SURFACE]),
        fixed=float(out[kernels.B_FIXED]),
    )


FAULTS = {
    kernels.TOO_SHORT: (
        "The water surface is above the top of the column",
        "Raise the top of the column (water.depth, water.column.cell), or check the volume of water.",
    ),
    kernels.NO_ROOM: (
        "A concentration of grains is not between 0 and 1",
        "Take thicker cells (water.column.cell), which average over more grains; check for large overlaps.",
    ),
    kernels.NOT_A_NUMBER: (
        "A speed of the water is not finite",
        "Check the driving force (water.column.drive) and the speeds of the grains in the last frames.",
    ),
    kernels.NOT_CONVERGED: (
        "The iteration for the stresses of the water did not converge",
        "Take a shorter exchange interval (water.column.interval), or thinner cells at the wall "
        "(water.column.cell).",
    ),
}


def fault_of(status: int, step: int, t: float) -> WaterError:
    """The error for a status of `time_step`, at a step of the water and its time [s]."""
    cause, hint = FAULTS[status]
    return WaterError(cause, step=step, t=t, hint=hint)
