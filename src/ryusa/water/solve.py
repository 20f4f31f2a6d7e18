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
    `WaterError` when the surface leaves the column, grains leave no room for water, or a number is lost.
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
    given = np.zeros((8, n))  # one array of one kind, so that the step is compiled once
    for row, values in enumerate((state.u, state.content, guess, phi, force, slope, carried, phi_w)):
        if values is not None:
            given[row] = values
    rows, faces, out = np.empty((6, n)), np.empty((2, n + 1)), np.empty(at.N_OUT)
    answer = at.march(numbers(column), given, float(state.volume), float(per_dt), rows, faces, out)
    if answer != at.DONE:
        raise _error(answer, state)
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


FAULTS = {
    at.TOO_SHORT: (
        "The water does not fit into the column",
        "Give the column more cells, or check the volume of water.",
    ),
    at.NO_ROOM: (
        "A concentration of grains is not between 0 and 1",
        "Where grains overlap far, or cells are thin and the area is small, choose thicker cells.",
    ),
    at.NOT_A_NUMBER: (
        "A speed of the water is no longer finite",
        "Look at the forces that the grains hand over, and at the driver.",
    ),
    at.NOT_CLOSE: (
        "The stresses of the water found no balance",
        "A shorter step helps, or cells that are fine enough for the wall.",
    ),
}


def _error(answer: int, state: WaterState) -> WaterError:
    cause, hint = FAULTS[answer]
    return WaterError(cause, step=state.step, t=state.t, hint=hint)
