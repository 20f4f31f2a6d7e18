"""What grains are told in a row with a pressure of its own: its push, and accelerations of the water."""

from ryusa.model.row import INFLOW, OPEN
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.at_grains import DENSEST
from ryusa.water.exchange import Ints
from ryusa.water.row_exchange import MOVES, PUSH, RowTold
from ryusa.water.row_layout import RowShape
from ryusa.water.slice_sums import ROW_DU_DT, SOLID


@kernel
def accelerate_with_grains(
    shape: RowShape, per_cell: float, c_m: float, rho_w: float, solid: Floats, sums: Floats, before: Floats,
    within: Floats, top: Ints, told: RowTold,
) -> None:  # fmt: skip
    """Find the accelerations of the water that free grains are told, with the added mass that goes with it.

    Parameters
    ----------
    per_cell : one over the volume of a cell [1/m3].
    c_m, rho_w : coefficient of the added mass [-], and density of the water [kg/m3].
    solid : concentration of a porous solid [-], (n_segment, n); in it no acceleration upwards is told.
    sums : of `sum_grains_in_row`, for the concentration of free grains.
    before : acceleration along x that they were told last [m/s2], shape (n_station, n).
    within, top : as of `press_grains`.
    told : `stations` has what the balance of the water found along x and is overwritten; `moves` is that of
        the last interval, and is overwritten.

    Notes
    -----
    The balance of the water over an interval has what the grains gave for the acceleration told before. For
    the one told now they will give c_m rho phi A, so that A = A_found - g (A - A_before) with
    g = c_m phi/(1 - phi), which holds for grains at rest; those that follow give less, and A comes closer
    with each interval. If grains were told A_found itself, each interval would undo the last one g times
    over, and where phi > 1/(1 + c_m) this grows. Upwards A_found is - dP/dz - N/(rho (1 - phi)).
    """
    for j in range(len(shape.left)):
        a, b = shape.left[j], shape.right[j]
        if shape.kind[j] != OPEN:
            continue
        for k in range(before.shape[1]):
            wet_a, wet_b = told.wet[a, k], told.wet[b, k]
            free = per_cell * (sums[SOLID, a, k] * wet_a + sums[SOLID, b, k] * wet_b)
            water = (1.0 - told.phi[a, k]) * wet_a + (1.0 - told.phi[b, k]) * wet_b
            water = max(water, (1.0 - DENSEST) * (wet_a + wet_b))
            g = c_m * free / water if water > 0.0 else 0.0
            told.stations[j, ROW_DU_DT, k] = (told.stations[j, ROW_DU_DT, k] + g * before[j, k]) / (1.0 + g)
    for j in range(len(shape.left)):
        if shape.kind[j] == INFLOW:
            told.stations[j, ROW_DU_DT] = told.stations[j + 1, ROW_DU_DT]
    for i in range(len(shape.bottom)):
        first = shape.first[i]
        for k in range(before.shape[1]):
            if solid[i, k] > 0.0 or not (first <= k <= top[i] and top[i] > first):
                told.moves[i, k] = 0.0
                continue
            water = max(1.0 - told.phi[i, k], 1.0 - DENSEST)
            found = c_m * (lift_of(rho_w, within, first, i, k) - told.force_z[i, k] / water)
            g = c_m * sums[SOLID, i, k] * per_cell / water
            told.moves[i, k] = (found + g * told.moves[i, k]) / (1.0 + g)


@kernel
def lift_of(rho_w: float, within: Floats, first: int, i: int, k: int) -> float:
    """Push of the pressure upwards in a cell [N/m3]; the lowest one has no face at its bottom."""
    return float(-rho_w * within[i, k] * (2.0 if k == first else 1.0))


@kernel
def press_grains(
    p: ColumnParameters, shape: RowShape, told: RowTold, rise: Floats, within: Floats, top: Ints,
    table: Floats,
) -> None:  # fmt: skip
    """Tell the grains the pressure in `table` of `table_of`, instead of the force that balances drag upwards.

    Parameters
    ----------
    rise, within : rise of P along x at the stations, and upwards in the cells, of `find_rises` [m/s2].
    top : cells of the surface.

    Notes
    -----
    Where the water rests, the force upwards is what `table` had: the pressure bears the drag.
    """
    for i in range(len(table)):
        west, east, first = shape.west[i], shape.east[i], shape.first[i]
        for k in range(p.n):
            push = -0.5 * p.rho_w * (rise[west, k] + rise[east, k])
            table[i, k, PUSH], table[i, k, MOVES] = push, 0.0
            table[i, k, 5] += push
            if first <= k <= top[i] and top[i] > first:
                table[i, k, MOVES] = told.moves[i, k]
                table[i, k, 6] = lift_of(p.rho_w, within, first, i, k) + told.moves[i, k]
