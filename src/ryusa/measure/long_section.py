"""Water and grains along a row of columns, at one moment or as means."""

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ryusa.catalogue import BEDS
from ryusa.errors import ResultsError
from ryusa.measure._run import Run
from ryusa.measure.along_row import grains_along_row, moving_in_row
from ryusa.measure.inclined import fall_of, gravity_at, pull_of
from ryusa.measure.nappe import Nappe, nappes_of
from ryusa.measure.statistics import standard_errors
from ryusa.measure.table import lines
from ryusa.measure.water import HALF, averaged_over_grain, height_reached
from ryusa.model import ColumnRow
from ryusa.model.row import EndKind
from ryusa.printed import ByShape
from ryusa.results.water import WaterFrames
from ryusa.spelling import known_word

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bed = Literal["packed", "rest"]
THIN = 1.0e-6  # depth below which a segment counts as dry [m]
_WATER = (
    "x", "bottom", "floor", "bed", "surface", "depth", "speed", "froude", "discharge", "critical", "energy",
    "tau",
)  # fmt: skip
_GRAINS = ("volume", "solid_discharge", "transport_concentration", "concentration")
_LENGTHS = (
    "x", "bottom", "floor", "bed", "bed_change", "surface", "depth", "critical", "energy", "volume",
    "pressure_head",
)  # fmt: skip
_UNITS = {  # as parts of the names of columns; none: without a unit
    **dict.fromkeys(_LENGTHS, "_m"),
    "t": "_s", "speed": "_m_per_s", "discharge": "_m2_per_s", "solid_discharge": "_m2_per_s", "tau": "_Pa",
}  # fmt: skip


@dataclass(frozen=True, repr=False)
class LongSection(ByShape):
    """Water and grains of a row by segment, at one moment or as means; arrays of shape (n_segment,).

    Attributes
    ----------
    t : time of the frame, or of the last one of the window [s].
    slope : of the x axis, positive where it falls downstream [rad].
    x : middles of the segments [m].
    bottom, floor : height of the bottom, and of it with the dams that let no water through [m].
    bed : height of the top of the bed of grains [m], see `long_section`; the floor without one.
    surface : height of the surface [m]; the floor where it is dry.
    depth : from the bed to the surface, along z [m]; 0 where the surface lies in the bed.
    discharge : of water, mean of both ends of a segment [m2/s].
    speed : of water and grains, the discharge of both over the depth, along x [m/s]; nan where it is dry.
    froude : speed along the bottom over that of a long wave on it [-], see Notes.
    critical : depth along z at which the discharge of both has a Froude number of 1 [m].
    energy : height of the energy line [m], see Notes.
    tau : shear stress at the bottom, mean of both ends [Pa].
    pressure_head : height to which the pressure at the floor raises water [m], None where it is hydrostatic:
        that of the surface.
    dams : name, first and last x [m] of each.
    volume : of free grains per area, with pores left out [m]; 0 in a run without, and so the following.
    solid_discharge : q_s, volume of grains per width and time, mean of both ends [m2/s].
    transport_concentration : q_s/(q_s + q_w), the concentration averaged over the discharge [-]; nan where
        nothing flows.
    concentration : of grains between bed and surface, averaged over the cross-section [-]; nan where dry.
    window : begin and end of the means [s]; None for one moment.
    error : standard errors of the means by name, in their unit; empty for one moment.
    grains : whether there are free grains.
    nappes : water in the air behind aerated dams.

    Notes
    -----
    Where the bottom is inclined by alpha to the x axis and by theta to the horizontal, the flow has the speed
    U = speed/cos(alpha) and, normal to the bottom, the depth h_n = depth cos(alpha). The Froude number is
    U/sqrt(g cos(theta) h_n): that of `ryusa check` where flow is uniform, whatever the slope of the x axis.
    The energy line lies the velocity head U**2/(2 g), which is vertical, above the surface; measured along
    z, as `energy` is, that is U**2/(2 g_z). Speeds are taken as equal over the depth. alpha is that of the
    bottom, the mean of both ends of a segment, also where a bed lies on it, and 0 over the crest of a closed
    dam.
    """

    t: float
    slope: float
    x: Floats
    bottom: Floats
    floor: Floats
    bed: Floats
    surface: Floats
    depth: Floats
    discharge: Floats
    speed: Floats
    froude: Floats
    critical: Floats
    energy: Floats
    tau: Floats
    dams: tuple[tuple[str, float, float], ...]
    volume: Floats
    solid_discharge: Floats
    transport_concentration: Floats
    concentration: Floats
    window: tuple[float, float] | None = None
    error: dict[str, Floats] = field(default_factory=dict[str, Floats])
    grains: bool = False
    pressure_head: Floats | None = None
    nappes: tuple[Nappe, ...] = ()

    def elevation(self, z: Floats) -> Floats:
        """Vertical height of points at the heights z normal to the x axis [m]; 0 at the origin."""
        return z * math.cos(self.slope) - self.x * math.sin(self.slope)

    def rows(self) -> list[dict[str, object]]:
        """One line for each segment; the error of a mean is beside it, in its unit."""
        names = (*_WATER, *_GRAINS) if self.grains else _WATER
        columns: dict[str, Floats] = {}
        if self.pressure_head is not None:
            names = (*names, "pressure_head")
        for name in names:
            columns[column_name(name)] = getattr(self, name)
            if name in self.error:
                columns[column_name(name, "_error")] = self.error[name]
        return lines(columns)


def long_section(
    run: Run,
    t: float | None = None,
    bed: Bed = "packed",
    begin: float = -math.inf,
    end: float = math.inf,
) -> LongSection:
    """Find water and grains along a row of columns.

    Parameters
    ----------
    run : its water is a row of columns.
    t : time [s]; that of the frame nearest to it, the last one when not given.
    bed : what ends the bed, going down from the surface: "packed", where the concentration, averaged over the
        height of a grain, reaches half of `water.column.packed`, as in `measure.water`; "rest", where that of
        the grains slower than 0.1 sqrt(g d) does. They differ in a flow as dense as a debris flow.
    begin, end : window of means [s], instead of one moment.

    Raises
    ------
    CaseError : `bed` is no such word.
    ResultsError : the run has no row of columns, no frame, fewer than two in the window, or a moment and a
        window are both given.

    Notes
    -----
    In a window, discharges are what passed a station from its first to its last frame over the time, and what
    follows from two quantities, such as the Froude number, follows from their means; its error is to first
    order that of the mean of its linear part. At one moment the discharge of grains is that by their speeds.
    """
    known_word(bed, BEDS, "bed")
    found = row_of(run)
    if math.isinf(begin) and math.isinf(end):
        k = len(found.t) - 1 if t is None else int(np.argmin(np.abs(found.t - t)))
        return _section(run, found, np.array([k]), bed)
    if t is not None:
        raise ResultsError("give a moment or a window of means, not both")
    frames = np.flatnonzero((found.t >= begin) & (found.t <= end))
    if len(frames) < 2:
        raise ResultsError(f"{len(frames)} frames from {begin:g} to {end:g} s: means need two or more")
    return _section(run, found, frames, bed)


def _section(run: Run, found: WaterFrames, frames: Ints, bed: Bed) -> LongSection:
    """The section at one frame, or means over several."""
    row, now = found.row, float(found.t[frames[-1]])
    fall, (g_x, g_z) = fall_of(row), gravity_at(run, now)
    pull = pull_of(fall, g_x, g_z)
    series = _series(run, found, frames, bed)
    means = {name: one.mean(axis=0) for name, one in series.items()}
    depth, through = means["depth"], means["discharge"] + means["solid_discharge"]
    wet, all_above = depth > THIN, means["above"] + means["over"]
    speed = _over(through, depth, wet)
    head = (1.0 + fall**2) * speed**2 / (2.0 * g_z)
    moved = np.abs(means["discharge"]) + np.abs(means["solid_discharge"]) > 0.0
    carried = _over(means["solid_discharge"], through, moved)
    errors: dict[str, Floats] = {}
    if len(frames) > 1:
        errors = {name: standard_errors(one) for name, one in series.items() if name not in _PARTS}
        errors |= _errors_of_ratios(series, means, carried, wet, pull, head)
    return LongSection(
        t=now,
        slope=math.atan2(g_x, g_z),
        x=row.x,
        bottom=np.array(row.bottom),
        floor=found.floor,
        bed=means["bed"],
        surface=means["surface"],
        depth=depth,
        discharge=means["discharge"],
        speed=speed,
        froude=_over(np.abs(speed), np.sqrt(pull * depth), wet),
        critical=np.cbrt(through**2 / pull),
        energy=means["surface"] + head,
        tau=means["tau"],
        dams=dams_of(row),
        volume=means["volume"],
        solid_discharge=means["solid_discharge"],
        transport_concentration=carried,
        concentration=_over(means["above"], all_above, wet & (all_above > 0.0)),
        window=(float(found.t[frames[0]]), now) if len(frames) > 1 else None,
        error=errors,
        grains=bool(run.scene.n_grain),
        pressure_head=means.get("pressure_head"),
        nappes=nappes_of(found, frames, means["surface"], g_x, g_z),
    )


_PARTS = ("above", "over")  # of the series: grains and water above the bed, per area [m]


def _series(run: Run, found: WaterFrames, frames: Ints, bed: Bed) -> dict[str, Floats]:
    """Quantities at some frames, of discharges between them; arrays (n_frame, n_segment) by name."""
    row = found.row
    stress = found.tau[frames].copy()
    if row.upstream is not None and row.upstream.kind is EndKind.DISCHARGE:
        stress[:, 0] = stress[:, 1]  # the speeds of an inlet are given, so that no stress is solved for
    beds, surface = bed_line(run, found, frames, bed), found.surface[frames]
    grains, water = _above(found, frames, beds)
    volume, solid = np.zeros(surface.shape), np.zeros((max(len(frames) - 1, 1), row.n_segment))
    dt = np.diff(found.t[frames])[:, None]
    through = np.diff(found.passed[frames], axis=0) / dt if len(frames) > 1 else found.discharge[frames]
    if run.scene.n_grain:
        held = grains_along_row(run, row, frames)
        volume = held.volume
        solid = between_stations(
            row.periodic, np.diff(held.passed, axis=0) / dt if len(frames) > 1 else held.flux
        )  # fmt: skip
    weights = dt / dt.mean() if len(frames) > 1 else 1.0  # their plain mean is that over time
    own = {} if row.hydrostatic else {"pressure_head": surface + _head_beyond(run, found, frames)}
    return own | {
        "bed": beds, "surface": surface, "depth": np.maximum(surface - beds, 0.0),
        "discharge": weights * between_stations(row.periodic, through),
        "tau": between_stations(row.periodic, stress),
        "volume": volume, "solid_discharge": weights * solid, "above": grains, "over": water,
    }  # fmt: skip


def _errors_of_ratios(
    series: dict[str, Floats], means: dict[str, Floats], carried: Floats, wet: NDArray[np.bool_],
    pull: Floats, head: Floats,
) -> dict[str, Floats]:  # fmt: skip
    """Standard errors of what follows from two means, to first order; nan where it is dry."""
    n = len(series["discharge"])
    after = {name: one if len(one) == n else 0.5 * (one[1:] + one[:-1]) for name, one in series.items()}
    both = after["discharge"] + after["solid_discharge"]
    mean = means["discharge"] + means["solid_discharge"]
    thick, all_above = np.where(wet, means["depth"], math.nan), means["above"] + means["over"]
    with np.errstate(invalid="ignore", divide="ignore"):
        share, deeper, speed = both / mean, after["depth"] / thick, mean / thick
        held = means["above"] / all_above
        solid = after["solid_discharge"] - carried * both
        grains = after["above"] - held * (after["above"] + after["over"])
        return {
            "speed": standard_errors((share - deeper) * speed),
            "froude": standard_errors(share - 1.5 * deeper) * np.abs(speed) / np.sqrt(pull * thick),
            "critical": standard_errors(share) * np.cbrt(mean**2 / pull) * 2.0 / 3.0,
            "energy": standard_errors(after["surface"] + (share - deeper) * 2.0 * head),
            "transport_concentration": standard_errors(solid / mean),
            "concentration": standard_errors(grains / np.where(wet, all_above, math.nan)),
        }


def column_name(name: str, of: str = "") -> str:
    """Name of a column of a table, or of its error, with the unit."""
    return name + of + _UNITS.get(name, "")


def _head_beyond(run: Run, found: WaterFrames, frames: Ints) -> Floats:
    """Pressure at the floor beyond the hydrostatic one as a height of water [m], (n_frame, n_segment)."""
    row = found.row
    lowest = np.zeros(row.n_segment, np.int64) if row.solid is None else row.solid
    at_floor = found.pressure[frames][:, np.arange(row.n_segment), lowest]
    g_z = np.array([gravity_at(run, t)[1] for t in found.t[frames].tolist()])
    return np.asarray(at_floor / (row.column.rho_w * g_z[:, None]), dtype=np.float64)


def row_of(run: Run) -> WaterFrames:
    """Frames of the row of columns of a run.

    Raises
    ------
    ResultsError : it has none.
    """
    found = run.row
    if found is None:
        raise ResultsError("needs a run whose water is a row of columns (water.row)")
    if not len(found.t):
        raise ResultsError("the run has no frame yet")
    return found


def bed_line(run: Run, found: WaterFrames, frames: Ints, bed: Bed) -> Floats:
    """Height of the bed of grains in some frames, or of the floor without one [m], (n_frame, n_segment)."""
    floors = np.tile(found.floor, (len(frames), 1))
    column = found.row.column
    if not run.scene.n_grain:
        return floors
    cells, least = run.scene.d_mean / column.dz, HALF * column.phi_max
    for m, k in enumerate(frames.tolist()):
        phi = _grains_in_cells(found, k)
        if bed == "rest":
            phi = phi - moving_in_row(run, found, k)
        for i, bottom in enumerate(found.row.bottom.tolist()):
            top = height_reached(
                column.z - column.z_low + bottom, averaged_over_grain(phi[i], cells), least
            )  # fmt: skip
            floors[m, i] = max(floors[m, i], top) if math.isfinite(top) else floors[m, i]
    return floors


def _grains_in_cells(found: WaterFrames, k: int) -> Floats:
    """Concentration of grains in frame k, without the matter of dams that let water through [-]."""
    solid = found.row.porous
    return found.phi[k] if solid is None else found.phi[k] - solid.phi


def _above(found: WaterFrames, frames: Ints, beds: Floats) -> tuple[Floats, Floats]:
    """Grains and water between bed and surface, per area [m], shape (n_frame, n_segment) each."""
    row, dz = found.row, found.row.column.dz
    low = row.bottom[:, None] + np.arange(row.column.n) * dz
    grains, water = np.zeros(beds.shape), np.zeros(beds.shape)
    for m, k in enumerate(frames.tolist()):
        share = np.clip((low + dz - beds[m][:, None]) / dz, 0.0, 1.0)
        wet = np.clip((found.surface[k][:, None] - low) / dz, 0.0, 1.0)
        grains[m] = (_grains_in_cells(found, k) * dz * np.minimum(share, wet)).sum(axis=1)
        water[m] = (found.content[k] * share).sum(axis=1)
    return grains, water


def _over(above: Floats, below: Floats, where: NDArray[np.bool_]) -> Floats:
    """A quotient; nan elsewhere."""
    return np.divide(above, below, out=np.full(len(below), math.nan), where=where)


def dams_of(row: ColumnRow) -> tuple[tuple[str, float, float], ...]:
    """Name, first and last x of the dams [m]."""
    return tuple((one.name, row.x_low + one.first * row.dx, row.x_low + one.end * row.dx) for one in row.dams)


def between_stations(periodic: bool, stations: Floats) -> Floats:
    """Means of both ends of the segments, of values at the stations, which are the last axis."""
    after = np.roll(stations, -1, axis=-1) if periodic else stations[..., 1:]
    return 0.5 * ((stations if periodic else stations[..., :-1]) + after)
