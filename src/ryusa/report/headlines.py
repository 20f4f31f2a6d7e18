"""The numbers that answer the questions of users, and the sentences that say them."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from ryusa.catalogue import MEASURES, called
from ryusa.errors import ResultsError
from ryusa.measure._run import settle_time
from ryusa.measure.depth_history import depth_history
from ryusa.measure.long_section import long_section
from ryusa.measure.statistics import Average, average
from ryusa.measure.table import Averages
from ryusa.results import Results

_EITHER = {"transport", "saltation"}
LATE = 0.1  # share of the record over whose end a number of the last frame must not change ...
STILL = 0.02  # ... by more than this share of the largest it had
SETTLED = 0.01  # change of the mean between two halves from which water alone counts as still changing


@dataclass(frozen=True)
class Headline:
    """A number of a measure and its sentence.

    Attributes
    ----------
    take : name of an average, `*` for that of a dam or a wall; "last:" and a column of its rows, for the
        last frame; or "row:" and a quantity of its rows, for a measure of one moment.
    sentence : `{}` is the number with its unit, `{name}` what `*` stands for.
    unit, factor : in which it is said, and what the SI value is multiplied by.
    """

    take: str
    sentence: str
    unit: str
    factor: float = 1.0


DEGREES = 180.0 / math.pi
_SLOPE = "The heap rests at a slope of {}."
HEADLINES: dict[str, tuple[Headline, ...]] = {
    "transport": (
        Headline("q_mass", "The transport of grains per metre of width is {}.", "kg/s/m"),
        Headline("layer_thickness", "Nine tenths of it takes place in a layer {} thick.", "mm", 1.0e3),
        Headline("tau_star", "The Shields number of the water at the bed is {}.", "-"),
    ),
    "saltation": (
        Headline("jump_height", "Grains rise by {} in a hop.", "mm", 1.0e3),
        Headline("jump_length", "A hop is {} long.", "mm", 1.0e3),
        Headline("speed", "Grains advance at {}.", "m/s"),
    ),
    "levels": (
        Headline("*: depth", "Upstream of {name} the water is {} deep.", "mm", 1.0e3),
        Headline("*: head", "Its level there is {} above the crest.", "mm", 1.0e3),
        Headline("jump", "A hydraulic jump stands at x = {}.", "m"),
    ),
    "loads": (
        Headline(
            "*: force x, both, by width", "The mean force on {name} downstream, per metre of width, is {}.",
            "N/m",
        ),
        Headline("*: force x, both, largest, by width", "The largest is {}.", "N/m"),
        Headline(
            "*: overturning, both, largest, by width",
            "The largest moment about its toe, positive where it overturns it, is {}.",
            "N m/m",
        ),
    ),
    "walls": (Headline("*dam*: force x", "The grains push {name} downstream with {}.", "N"),),
    "filling": (
        Headline("full from", "The bed upstream of the dam is at crest level from the start, t = {}.", "s"),
        Headline("full at", "The bed upstream of the dam reaches crest level at t = {}.", "s"),
        Headline("below", "The bed upstream of the dam ends {} below crest level.", "mm", 1.0e3),
    ),
    "deposit": (
        Headline(
            "trapped_share", "Of the grains that came into {where}, {} are still there at the end.", "%",
            100.0,
        ),
        Headline(
            "last:stored_m2", "The volume of grains in {where}, per metre of width, has changed by {}.", "m³"
        ),
        Headline("last:slope", "The deposit in {where} has a slope of {} at the end.", "%", 100.0),
    ),
    "discharge": (
        Headline("rate_out", "Grains leave at {}.", "kg/s"),
        Headline("rate_in", "Grains are fed at {}.", "kg/s"),
    ),
    "front": (
        Headline("last:front_m", "The front of the grains has come to x = {}.", "m"),
        Headline("front_speed", "On its way it advanced at {} on average.", "m/s"),
    ),
    "scour": (
        Headline("last:depth_m", "The hole below the dam is {} deep at the end.", "mm", 1.0e3),
        Headline("last:at_m", "Its deepest place lies {} behind the dam.", "mm", 1.0e3),
        Headline("last:length_m", "It ends {} behind the dam.", "mm", 1.0e3),
    ),
    "cone": (Headline("row:slope", _SLOPE, "deg"), Headline("row:height", "It is {} high.", "mm", 1.0e3)),
    "surface": (
        Headline("row:slope", _SLOPE, "deg", DEGREES),
        Headline("row:slope_spread", "Lines fitted to other parts of it differ by {}.", "deg", DEGREES),
        Headline("row:run_out", "Its foot lies {} beyond where the grains stood before.", "mm", 1.0e3),
    ),
    "direct_shear": (Headline("mu", "Shear force over normal force is {} on average.", "-"),),
    "shear": (
        Headline("mu", "Shear stress over normal stress is {}.", "-"),
        Headline("phi", "Grains fill {} of the volume.", "%", 100.0),
    ),
    "shear_zone": (
        Headline("centre", "The middle of the shear zone is {} from the axis.", "mm", 1.0e3),
        Headline("width", "The zone is {} wide.", "mm", 1.0e3),
    ),
    "dynamic_angle": (Headline("angle of the surface", "The surface is inclined by {}.", "deg"),),
    "mill": (
        Headline("torque", "The drum needs a torque of {}.", "N m"),
        Headline("power", "It takes {}.", "W"),
    ),
    "segregation": (
        Headline("segregation_index", "The index of segregation, 0 where mixed, is {}.", "-"),
    ),
    "collisions": (Headline("restitution", "A grain keeps {} of its speed in an impact.", "-"),),
}  # fmt: skip


def taken(
    results: Results, measure: str, begin: float | None, reach: tuple[float, float] | None = None
) -> dict[Headline, Average]:
    """The numbers of a measure that a run has, in the unit of their sentences.

    Parameters
    ----------
    begin : of the window [s]; None for that of the measure, and of water alone the last fifth of the record.
    reach : begin and end of the reach [m] of a measure that has one; None for its own.

    Raises
    ------
    ResultsError : the run does not allow the measure.
    """
    alone = not results.scene.n_grain and results.row is not None
    if begin is None and alone:
        begin = 0.8 * float(results.frames.t[-1])
    given = {"begin": begin, "reach": reach}
    record = _OWN[measure](results, begin) if measure in _OWN else _measured(results, measure, given)
    found: dict[Headline, Average] = {}
    for line in HEADLINES[measure]:
        for one in _numbers(record, line.take):
            if alone and "largest" in line.take:  # as large as the mean, once it is still
                continue
            if line.take == "rate_in" and not (results.scene.traffic and results.scene.traffic.feeds):
                continue
            name = one.name.partition(":")[0] if "*" in line.take else ""
            low, high = getattr(record, "reach", (math.nan, math.nan))
            words = {"{name}": f"“{name}”", "{where}": f"x = {low:.4g} to {high:.4g} m"}
            sentence = line.sentence
            for word, text in words.items():
                sentence = sentence.replace(word, text)
            said = replace(line, sentence=sentence)
            found[said] = _in_unit(one, line, alone)
    return found


def _measured(results: Results, measure: str, given: dict[str, Any]) -> Any:
    entry = next(one for one in MEASURES if one.name == measure)
    if measure in _EITHER and (measure == "saltation") != (results.case["build"]["kind"] == "saltation"):
        raise ResultsError("a case with single grains over a fixed bed has hops, another a rate")
    if measure == "walls" and results.row is not None:
        raise ResultsError("loads has the force of the grains on a dam of a row too")
    options = {name: one for name, one in given.items() if one is not None and name in entry.options}
    return called(entry)(results, **options)


def _numbers(record: Any, take: str) -> list[Average]:
    how, _, name = take.rpartition(":") if take.startswith(("last:", "row:")) else ("", "", take)
    if how == "last":
        return _last(record.rows(), name)
    if how == "row":
        rows = {str(row["quantity"]): float(row["value"]) for row in record.rows()}
        moving = math.inf if rows["moving_share"] > 0.0 else 0.0
        return [_moment(name, rows[name], moving, rows["time"])] if math.isfinite(rows[name]) else []
    return [one for one in record.averages.items if one.n and fnmatchcase(one.name, name)]


def _last(rows: list[dict[str, Any]], name: str) -> list[Average]:
    t, values = (np.array([row[key] for row in rows], dtype=np.float64) for key in ("t_s", name))
    if not np.isfinite(values[-1]):
        return []
    before = values[np.searchsorted(t, t[-1] - LATE * (t[-1] - t[0]), side="right") - 1]
    drift = float(values[-1] - before)
    changes = not abs(drift) <= STILL * float(np.nanmax(np.abs(values)))
    return [_moment(name, float(values[-1]), math.inf if changes else 0.0, float(t[-1]), drift)]


def _moment(name: str, value: float, variation: float, t: float, drift: float = math.nan) -> Average:
    """A number of one moment; it counts as changing where its variation is infinite."""
    nan = math.nan
    return Average(name, "", value, nan, 1, 0, nan, (t, t), variation, drift, nan)


def _in_unit(one: Average, line: Headline, alone: bool) -> Average:
    value, drift = one.value * line.factor, one.drift * line.factor
    if alone and one.n_series:  # no scatter to hold a drift against
        variation = math.inf if not abs(drift) <= SETTLED * abs(value) else 0.0
        one = replace(one, variation=variation)
    return replace(one, value=value, error=one.error * line.factor, drift=drift, unit=line.unit)


class _Levels:
    """Water before and over the dams of a row, and where a jump stands."""

    def __init__(self, results: Results, begin: float | None) -> None:
        frames = results.row
        if frames is None:
            raise ResultsError("levels are those of a row of columns; the run has no [water.row]")
        t = np.asarray(frames.t)
        kept = t >= (settle_time(results) if begin is None else begin)
        window, items = (float(t[kept][0]), float(t[kept][-1])), list[Average]()
        for dam in frames.row.dams:
            if not dam.porous and dam.first > 0:
                level, k = np.asarray(frames.surface)[kept, dam.first - 1], dam.first
                if not frames.row.hydrostatic:  # beyond where the surface is drawn down, by four heads
                    away = round(4.0 * max(float((level - frames.floor[k]).mean()), 0.0) / frames.row.dx)
                    level = np.asarray(frames.surface)[kept, max(dam.first - 1 - away, 0)]
                for what, floor in (("depth", frames.floor[k - 1]), ("head", frames.floor[k])):
                    items.append(average(f"{dam.name}: {what}", "m", [level - floor], window))
        last = long_section(results)
        turns = np.flatnonzero((last.froude[:-1] > 1.0) & (last.froude[1:] <= 1.0))
        if len(turns) and len(frames.row.dams) and turns[0] + 1 < frames.row.dams[0].first:
            k = int(turns[0])
            share = (last.froude[k] - 1.0) / (last.froude[k] - last.froude[k + 1])
            items.append(_moment("jump", float(last.x[k] + share * (last.x[k + 1] - last.x[k])), 0.0, last.t))
        self.averages = Averages("levels", tuple(items))


class _Filling:
    """When the bed before the first dam of a row reaches its crest."""

    def __init__(self, results: Results, begin: float | None) -> None:
        frames = results.row
        if frames is None or not frames.row.dams or not results.scene.n_grain:
            raise ResultsError("only a dam in a row of columns with grains fills")
        dam = min(frames.row.dams, key=lambda one: one.first)
        if dam.first == 0 or dam.porous:
            raise ResultsError("the dam has no closed face in the row")
        found = depth_history(results, begin=begin)
        short = frames.floor[dam.first] - found.bed[:, dam.first - 1]
        full = np.flatnonzero(short <= 0.0)
        name, value = ("full at", found.t[full[0]]) if len(full) else ("below", short[-1])
        name = "full from" if len(full) and not full[0] else name
        one = _moment(name, float(value), 0.0, float(found.t[-1]))
        self.averages = Averages("filling", (one,))


_OWN: dict[str, Callable[[Results, float | None], Any]] = {"levels": _Levels, "filling": _Filling}
