"""Compiled time step of a row of columns: water that varies along the stream.

The grid is staggered. Segments of equal length hold the volume of water, its surface and its concentration of
grains; the stations between them hold the speed along x in cells that follow the bottom. Along x the step is
explicit, along z each station solves the momentum balance of a column (`momentum_balance`). Equations, order
of a step and limits: design/0027.
"""

import math

from ryusa.model.row import INFLOW, OPEN, SAME_DEPTH, WALL
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.closures import bed_thickness
from ryusa.water.drive import imposed_gradient
from ryusa.water.limiter import limited
from ryusa.water.momentum_balance import DONE, NO_ROOM, NOT_A_NUMBER, TOO_SHORT
from ryusa.water.row_energy import add_held, book_displaced, book_ends, book_row
from ryusa.water.row_inlet import NO_INFLOW, depth_over_bed, inflow
from ryusa.water.row_layout import NappeArrays, RowEnds, RowGrains, RowMatrix, RowShape, RowWater
from ryusa.water.row_nappe import LANDED, book_nappes, hang, throw, with_landing
from ryusa.water.row_pressure import PressureArrays, begin_pressure, find_tops, keep_w, viscosities
from ryusa.water.row_pressure_energy import add_held_upwards, book_faces, book_projection, book_push
from ryusa.water.row_projection import project, worst_segment
from ryusa.water.row_station import StationArrays, solve_station
from ryusa.water.time_step import distribute_water

COURANT = 0.5  # largest (|u| + wave speed) dt/dx of a step; above it the interval is divided
MOST_TAKEN = 0.98  # largest share of the water of a segment that leaves it in a step
# scalars that `advance_row` writes
FAULT_AT, STEPS, COURANT_MET, TURNS = range(4)
N_SCALARS = 4
NOT_PROJECTED = 6  # after those of `momentum_balance` and `row_inlet`: no pressure was found
ASTRAY = 6  # before those of a nappe, BEYOND and STRIKES of `row_nappe`
# largest viscosity times dt/dx**2 of a step with a pressure of its own: along x it is explicit
DIFFUSED = 0.25


@kernel
def fill_to_depth(
    p: ColumnParameters, first: int, phi: Floats, depth: float, content: Floats, wet: Floats
) -> float:
    """Fill a segment up to a depth [m]: content, wet thickness of its cells, and volume returned [m]."""
    volume = 0.0
    for k in range(p.n):
        wet[k] = min(max(depth - k * p.dz, 0.0), p.dz) if k >= first else 0.0
        content[k] = (1.0 - phi[k]) * wet[k] if wet[k] > 0.0 else 0.0
        volume += content[k]
    return volume


@kernel
def fill_ends(p: ColumnParameters, ends: RowEnds, shape: RowShape, phi: Floats, water: RowWater) -> None:
    """Fill the segments beyond the ends; they stay as they are during the step."""
    for e in range(len(ends.segment)):
        i = ends.segment[e]
        depth = ends.depth[e]
        if ends.rule[e] == SAME_DEPTH:
            depth = water.surface[ends.beside[e]] - p.z_low
        bed = 0.0
        if shape.kind[shape.east[i]] == INFLOW:
            solid = int(shape.first[i])
            bed = solid * p.dz + bed_thickness(p, phi[i, solid:])
        if bed > 0.0:
            depth = depth_over_bed(bed, float(depth), ends.rule[e] != SAME_DEPTH, ends.discharge, shape.g_z)
        water.surface[i] = p.z_low + depth
        water.volume[i] = fill_to_depth(
            p, int(shape.first[i]), phi[i], float(depth), water.content[i], water.wet[i]
        )


@kernel
def fluxes_along(
    p: ColumnParameters, shape: RowShape, ends: RowEnds, phi: Floats, dt: float, water: RowWater,
    flux: Floats, tilt: Floats,
) -> None:  # fmt: skip
    """Water that passes each station per time and width [m2/s], shape (n_station, n).

    Notes
    -----
    A cell gives what the segment upstream holds in it, up to the surface at the station: the surface of the
    segment and half its limited slope, less what passes during the step. A cell that is thin gives at most
    twice its water, and a segment at most the share MOST_TAKEN of its water.
    """
    low = p.z_low
    for i in range(len(shape.bottom)):
        before = water.surface[i] - water.surface[shape.left[shape.west[i]]]
        after = water.surface[shape.right[shape.east[i]]] - water.surface[i]
        tilt[i] = limited(before, after)
    for j in range(len(shape.left)):
        for k in range(p.n):
            flux[j, k] = 0.0
        if shape.kind[j] == WALL:
            continue
        left, right = shape.left[j], shape.right[j]
        if shape.kind[j] != OPEN:
            inflow(
                p, ends.discharge, ends.shape, int(shape.first[left]), phi[left], water.content[left],
                water.wet[left], water.u[j], flux[j],
            )  # fmt: skip
            continue
        for k in range(max(shape.first[left], shape.first[right]), p.n):
            u = water.u[j, k]
            up = left if u > 0.0 else right
            held = water.content[up, k]
            if u == 0.0 or held <= 0.0:
                continue
            half = 0.5 * max(1.0 - abs(u) * dt / shape.dx, 0.0)
            side = water.surface[up] + (half if u > 0.0 else -half) * tilt[up] - low - k * p.dz
            part = min(max(side, 0.0), p.dz) / water.wet[up, k]
            flux[j, k] = u * held * min(part, 2.0)
    for i in range(shape.inner[0], shape.inner[1]):
        taken = 0.0
        for k in range(p.n):
            taken += max(flux[shape.east[i], k], 0.0) + max(-flux[shape.west[i], k], 0.0)
        most = MOST_TAKEN * water.volume[i] * shape.dx
        if taken * dt > most > 0.0:  # what passes into air behind a sill is not its own
            part = most / (taken * dt)
            for k in range(p.n):
                if flux[shape.east[i], k] > 0.0:
                    flux[shape.east[i], k] *= part
                if flux[shape.west[i], k] < 0.0:
                    flux[shape.west[i], k] *= part


@kernel
def fluxes_upwards(
    p: ColumnParameters, first: int, per_dx: float, per_dt: float, content: Floats, old: Floats, west: Floats,
    east: Floats, q: Floats,
) -> None:  # fmt: skip
    """Vertical flux of water through the faces of a segment [m/s], shape (n + 1,).

    Notes
    -----
    From the bottom up to the highest cell with water now or before the step, and from the top down above it:
    water that enters over a drop falls. What is left over at the surface is round-off.
    """
    top = first - 1
    for k in range(p.n):
        if content[k] > 0.0 or old[k] > 0.0:
            top = k
    for k in range(first + 1):
        q[k] = 0.0
    for k in range(first, top + 1):
        q[k + 1] = q[k] - (content[k] - old[k]) * per_dt - (east[k] - west[k]) * per_dx
    falling = 0.0
    for k in range(p.n - 1, top, -1):
        q[k + 1] = falling
        falling += (east[k] - west[k]) * per_dx
    if top >= first and falling != 0.0:
        q[top + 1] = falling


@kernel
def fastest(p: ColumnParameters, shape: RowShape, water: RowWater) -> float:
    """Largest speed of the water plus that of a long wave [m/s]."""
    most = 0.0
    for j in range(len(shape.left)):
        deepest, u = 0.0, 0.0
        for i in (shape.left[j], shape.right[j]):
            if water.volume[i] > 0.0:
                deepest = max(deepest, water.surface[i] - p.z_low - shape.first[i] * p.dz)
            for k in range(p.n):
                if water.content[i, k] > 0.0:
                    u = max(u, abs(water.u[j, k]))
        most = max(most, u + math.sqrt(shape.g_z * max(deepest, 0.0)))
    return most


@kernel
def driving_gradient(p: ColumnParameters, shape: RowShape, j: int, water: RowWater, driver: float) -> float:
    """Pressure gradient at a station [Pa/m]: the driver's, and that of the slope of the surface.

    Notes
    -----
    Neither surface counts below the lowest cell that is open at the station. A dry segment whose bottom lies
    above the water beside it counts as level with it.
    """
    left, right = shape.left[j], shape.right[j]
    sill = p.z_low + max(shape.first[left], shape.first[right]) * p.dz
    here, there = max(water.surface[left], sill), max(water.surface[right], sill)
    here, there = here + shape.bottom[left], there + shape.bottom[right]
    level = shape.dx * p.g_x / shape.g_z  # rise of a level surface from segment to segment
    if water.surface[right] <= sill and there > here + level:
        there = here + level
    elif water.surface[left] <= sill and here > there - level:
        here = there - level
    return float(driver - p.rho_w * shape.g_z * (there - here) / shape.dx)


@kernel
def continuity(
    p: ColumnParameters, shape: RowShape, dt: float, phi: Floats, water: RowWater, work: StationArrays,
    scalars: Floats, pressure: PressureArrays | None, nappe: NappeArrays | None,
) -> int:  # fmt: skip
    """Move the water on along x, and find the vertical fluxes and the momentum that is carried.

    Returns
    -------
    status : DONE, or a fault of `momentum_balance` or of a nappe in the segment `scalars[FAULT_AT]`.
    """
    if nappe is not None and pressure is not None:
        what, at = throw(p, shape, water, work.flux, pressure.w, nappe)
        if what != LANDED:
            scalars[FAULT_AT] = at
            return ASTRAY + what
    n, per_dt, per_dx = p.n, 1.0 / dt, 1.0 / shape.dx
    for j in range(len(shape.left)):
        total = 0.0
        for k in range(n):
            total += work.flux[j, k]
        work.total[j] = total
        water.passed[j] += total * dt
    for i in range(len(shape.bottom)):
        west, east = shape.west[i], shape.east[i]
        for k in range(n):
            work.old[i, k] = water.content[i, k]
        if shape.inner[0] <= i < shape.inner[1]:
            water.volume[i] -= dt * per_dx * (work.total[east] - work.total[west])
            if nappe is not None:
                water.volume[i] += dt * nappe.lands[i]
            m, surface = distribute_water(
                p, shape.first[i], phi[i], water.volume[i], water.content[i], water.wet[i], work.middle
            )
            if m < -1 or m >= n:
                scalars[FAULT_AT] = i
                return TOO_SHORT if m >= n else NO_ROOM
            water.surface[i] = surface if m >= 0 else p.z_low + shape.first[i] * p.dz
        entering = work.flux[west]
        if nappe is not None:
            entering = with_landing(shape, i, entering, water.wet[i], nappe)
        fluxes_upwards(
            p, shape.first[i], per_dx, per_dt, water.content[i], work.old[i], entering, work.flux[east],
            work.q[i],
        )  # fmt: skip
        # along an inclined bottom the speed u sqrt(steep) is carried, of which u is the part along x
        turned_west, turned_east = math.sqrt(shape.steep[west]), math.sqrt(shape.steep[east])
        for k in range(n):
            through = 0.5 * (work.flux[west, k] + work.flux[east, k])
            u, turned = water.u[east, k], turned_east
            if through > 0.0:
                u, turned = water.u[west, k], turned_west
            work.carried[i, k] = through * u * turned
            work.energy.through[i, k], work.energy.speed[i, k] = through, u * turned
    return DONE


@kernel
def advance_row(
    p: ColumnParameters, shape: RowShape, ends: RowEnds, matrix: RowMatrix, grains: RowGrains, time: float,
    longest: float, water: RowWater, work: StationArrays, rows: Floats, faces: Floats, out: Floats,
    scalars: Floats, pressure: PressureArrays | None, nappe: NappeArrays | None,
) -> int:  # fmt: skip
    """Move the water on, in as few equal steps as the Courant number and `longest` permit.

    Parameters
    ----------
    p : the column of every station; its heights are measured from the bottom of the row.
    shape, ends, matrix, grains : the row, what lies beyond its ends, a porous solid in it, and its grains.
    time, longest : what is to pass, and the longest step [s].
    water : the state, overwritten; left in the middle of a step after a fault.
    work : work arrays; the energy account of the time is added to `work.energy.books`.
    rows, faces, out : profiles and momentum budget of each station after the last step, as `time_step` writes
        them, with a leading axis of stations.
    scalars : receives FAULT_AT (segment or station), STEPS, COURANT_MET and TURNS, shape (N_SCALARS,).
    pressure : state and work arrays of a pressure of its own; None, which compiles without it: hydrostatic.
    nappe : of the opened row with a pressure of its own; None with a hydrostatic one.

    Returns
    -------
    status : DONE, NO_INFLOW, NOT_PROJECTED, that of a nappe over ASTRAY, or a fault of `momentum_balance`.
    """
    # One function: the order of a step, in which pressure beyond the hydrostatic one has its places
    remaining, energy = time, work.energy
    hang(p, shape, water, False, nappe, energy.books)
    add_held(p, shape, water, -1.0, energy.books)
    forces = grains.force
    if pressure is not None:
        add_held_upwards(p, shape, water, -1.0, pressure, energy.books)
        forces = pressure.force
    while remaining > 0.0:
        speed = fastest(p, shape, water)
        if not math.isfinite(speed):
            return NOT_A_NUMBER
        dt = min(longest, COURANT * shape.dx / speed if speed > 0.0 else longest)
        if pressure is not None:
            find_tops(shape, water.wet, pressure.before)
            most = viscosities(p, shape, faces, pressure.nu)
            if most > 0.0:
                dt = min(dt, DIFFUSED * shape.dx**2 / most)
        parts = max(math.ceil(remaining / dt - 1.0e-9), 1.0)
        dt = remaining / parts
        remaining = remaining - dt if parts > 1.0 else 0.0
        book_ends(p, shape, water, -1.0, energy.books)
        fill_ends(p, ends, shape, grains.phi, water)
        book_ends(p, shape, water, 1.0, energy.books)
        fluxes_along(p, shape, ends, grains.phi, dt, water, work.flux, work.tilt)
        if shape.kind[0] == INFLOW and ends.discharge > 0.0 and not work.flux[0].sum() > 0.0:
            scalars[FAULT_AT] = shape.inner[0]
            return NO_INFLOW
        if grains.laden:
            book_displaced(p, shape, grains.phi, water, work.level, energy.books)
        status = continuity(p, shape, dt, grains.phi, water, work, scalars, pressure, nappe)
        if status != DONE:
            return status
        if pressure is not None:
            begin_pressure(p, shape, dt, matrix, grains.force, water, work, pressure, nappe)
            book_faces(p, shape, dt, work, water, pressure, energy.books)
        first = shape.inner[0]
        driver = imposed_gradient(p, water.content[first], water.surface[first])
        for j in range(len(shape.left)):
            if shape.kind[j] != OPEN:
                continue
            left, right = shape.left[j], shape.right[j]
            gradient = driving_gradient(p, shape, j, water, driver)
            energy.push[j] = gradient - driver
            status = solve_station(
                p, int(max(shape.first[left], shape.first[right])), shape.steep[j], shape.inertia[j],
                gradient, 1.0 / shape.dx, 1.0 / dt, left, right, j,
                matrix.phi, matrix.linear, matrix.quadratic, grains.phi, forces[j], grains.slope[j],
                grains.carried[j], grains.phi_w[j], water.u[j], water.content, water.wet, water.surface,
                water.volume, grains.laden, work, rows[j], faces[j], out[j],
            )  # fmt: skip
            if status != DONE:
                scalars[FAULT_AT] = j
                return status
        book_row(p, shape, dt, driver, grains.phi, water, energy, work.total, out)
        if pressure is not None:
            book_push(p, shape, dt, grains.laden, work, water, pressure, energy.books, out)
            book_nappes(
                p, shape, dt, grains, work, water, pressure.top, pressure.next_w, nappe, energy.books, out
            )
        for j in range(len(shape.left)):
            if shape.kind[j] == OPEN:
                for k in range(p.n):
                    water.u[j, k] = work.u[j, k]
        if pressure is not None:
            turns = project(p, shape, dt, matrix, grains.slope, water, work.flux, pressure)
            if turns < 0:
                scalars[FAULT_AT] = worst_segment(shape, pressure)
                return NOT_PROJECTED
            book_projection(p, shape, dt, water, pressure, energy.books, rows, out)
            keep_w(shape, water.u, pressure)
            scalars[TURNS] += turns
        hang(p, shape, water, True, nappe, energy.books)
        scalars[STEPS] += 1.0
        scalars[COURANT_MET] = max(scalars[COURANT_MET], speed * dt / shape.dx)
    add_held(p, shape, water, 1.0, energy.books)
    if pressure is not None:
        add_held_upwards(p, shape, water, 1.0, pressure, energy.books)
    return DONE
