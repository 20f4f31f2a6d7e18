"""One implicit step of the column: a tridiagonal system inside Newton's method.

Momentum of the water along the bed, U its speed and eps = 1 - phi its share of a cell:

    d(rho eps U)/dt + d(rho eps w U)/dz = d tau/dz - dp/dx + rho eps g_x - (all forces of water on grains)
    tau = rho (nu + nu_t) dU/dz

This holds for every form of buoyancy (design/0007), because each only decides what the water does to the
grains. Where that is not known beforehand, `carried` gives the share of d tau/dz that the grains take.
"""

import numpy as np

from ryusa.errors import WaterError
from ryusa.model.column import Budget, Column, WaterState
from ryusa.model.scene import Floats
from ryusa.water import march as at
from ryusa.water._kernel import numbers


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
    """Water after a step dt, and where its momentum came from.

    Parameters
    ----------
    column, state : what holds still and what moves.
    phi : concentration of grains at the end of the step [-], shape (n,).
    force : all forces along the bed that the water put on the grains during the step, whatever the form of
        buoyancy, per volume of the cells [N/m3], shape (n,); None: no grains.
    dt : step [s]; any length is stable.
    slope : how `force` grows with the water's speed [N s/m4], for forces that are not settled yet; None: 0.
    carried : share of d tau/dz that the grains take on top of `force`, phi for the form `stress` where its
        part is not in `force` [-]; None: 0.
    phi_w : phi times the vertical speed of the grains [m/s], for the water's own; None: 0.

    Notes
    -----
    Solved to round-off, not linearised over the step: the steady state does not depend on dt. Raises
    `WaterError` when the surface leaves the column or a number is lost.
    """
    return _march(column, state, phi, force, slope, carried, phi_w, 1.0 / dt, state.u, dt)


def _march(
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
    n = column.n
    none = np.zeros(n)
    rows, faces, out = np.empty((6, n)), np.empty((2, n + 1)), np.empty(at.N_OUT)
    given = at.Sources(
        phi=phi,
        force=none if force is None else force,
        slope=none if slope is None else slope,
        carried=none if carried is None else carried,
        phi_w=none if phi_w is None else phi_w,
    )
    answer = at.march(
        numbers(column), state.u, state.content, state.volume, given, per_dt, guess, rows, faces, out
    )
    if answer != at.DONE:
        raise _error(answer, column, state)
    rows.flags.writeable = faces.flags.writeable = False
    now = WaterState(
        u=rows[0],
        w=rows[1],
        content=rows[2],
        shear=rows[3],
        du_dt=rows[4],
        dtau_dz=rows[5],
        tau=faces[0],
        nu_t=faces[1],
        z_surface=float(out[at.SURFACE]),
        volume=state.volume,
        gradient=float(out[at.GRADIENT]),
        t=state.t + dt,
        step=state.step + 1,
    )
    budget = Budget(
        change=float(out[at.B_CHANGE]),
        gravity=float(out[at.B_GRAVITY]),
        driver=float(out[at.B_DRIVER]),
        bed=float(out[at.B_BED]),
        lid=float(out[at.B_LID]),
        side=float(out[at.B_SIDE]),
        grains=float(out[at.B_GRAINS]),
        carried=float(out[at.B_CARRIED]),
        surface=float(out[at.B_SURFACE]),
        iterations=int(out[at.TURNS]),
    )
    return now, budget


def _error(answer: int, column: Column, state: WaterState) -> WaterError:
    if answer == at.TOO_SHORT:
        return WaterError(
            "The water does not fit into the column",
            step=state.step,
            t=state.t,
            hint=f"It ends at {column.z_high:g} m; give it more cells, or check the volume of water.",
        )
    cause = (
        "A speed of the water is no longer finite"
        if answer == at.NOT_A_NUMBER
        else "The water found no balance"
    )
    return WaterError(
        cause,
        step=state.step,
        t=state.t,
        hint="Look at the forces that the grains hand over, and at concentrations close to 1.",
    )
