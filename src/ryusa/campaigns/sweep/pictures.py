"""Pictures of a sweep: each quantity over each key that varies."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from ryusa.campaigns.sweep.design import SAMPLED, SweepDesign
from ryusa.campaigns.sweep.part import Measured, short_names
from ryusa.campaigns.sweep.table import SweepColumn, pooled_over_seeds
from ryusa.figures.effects import EffectAxis, EffectPoint, effects
from ryusa.measure.statistics import Average
from ryusa.units import quantity, si_unit

WIDE = 30.0  # ratio of the ends of a range from which its axis is logarithmic
BARS = "mean, bars: ± s.e."


@dataclass(frozen=True)
class Quantity:
    """One quantity of one measure, over all settings.

    Attributes
    ----------
    measure, name, unit : what it is.
    runs : by setting its values, one for each run that has it.
    pooled : by setting its mean over the seeds; that of the run where there is one; None without any.
    """

    measure: str
    name: str
    unit: str
    runs: tuple[tuple[float, ...], ...]
    pooled: tuple[Average | None, ...]

    @property
    def title(self) -> str:
        """Measure and quantity in words."""
        return f"{self.measure} {self.name}"


def quantities_of(measures: Sequence[str], found: Sequence[Sequence[Measured]]) -> list[Quantity]:
    """Quantities of all measures.

    Parameters
    ----------
    measures : names of the measures.
    found : by setting what was measured of its runs.
    """
    pooled = [pooled_over_seeds(measures, runs) for runs in found]
    every: list[Quantity] = []
    for measure in measures:
        units = {
            one.name: one.unit for runs in found for run in runs for one in run.averages.get(measure, ())
        }
        for name, unit in units.items():
            held = [
                [one for run in runs for one in run.averages.get(measure, ()) if one.name == name]
                for runs in found
            ]
            means = tuple(
                mean.get((measure, name), one[0] if one else None)
                for mean, one in zip(pooled, held, strict=True)
            )
            values = tuple(tuple(one.value for one in mine) for mine in held)
            every.append(Quantity(measure, name, unit, values, means))
    return every


def drawn_effects(
    design: SweepDesign, columns: Sequence[SweepColumn], quantities: Sequence[Quantity]
) -> dict[str, Figure]:
    """Pictures by name; none where nothing varies but the seed."""
    if not columns or len(design.settings) < 2:
        return {}
    known = {one.key: one for one in columns}
    panels = [next(iter(axis.choices)) for axis in design.axes]  # the first of keys that change together
    if design.kind in SAMPLED:
        panels = list(known)
    names = {key: name.replace("_", " ") for key, name in zip(known, short_names(list(known)), strict=True)}
    grouped = design.kind not in SAMPLED and len(panels) > 1
    axes, places, groups = [], [], []
    for k, key in enumerate(panels):
        other = panels[(k + 1) % len(panels)] if grouped else ""
        axis, place = _axis(known[key], names[key], names[other] if other else "")
        axes.append(axis)
        places.append(place)
        groups.append(known[other].written if other else ("",) * len(design.settings))
    pictures: dict[str, Figure] = {}
    for one in quantities:
        points = [_point(one, k, places, groups) for k in range(len(design.settings)) if one.runs[k]]
        words = f"{one.measure}: {one.name.replace('_', ' ')}  ({printed_unit(one.unit)})"
        if points:
            pictures[f"{one.measure}-{_plain(one.name)}"] = effects(
                axes, points, words, joined=design.kind not in SAMPLED, error=BARS
            )
    return pictures


def printed_unit(unit: str) -> str:
    """A unit as a page prints it.

    >>> printed_unit("m2/s"), printed_unit("1/(m2 s)"), printed_unit("-")
    ('m²/s', '1/(m² s)', '–')
    """
    return (
        re.sub(r"(?<=[A-Za-z])[23]", lambda found: "²³"[int(found.group()) - 2], unit)
        if unit not in {"", "-"}
        else "–"
    )


def _plain(name: str) -> str:
    """Name of a quantity as part of the name of a file."""
    return "-".join("".join(letter if letter.isalnum() or letter == "_" else " " for letter in name).split())


def _point(
    one: Quantity, k: int, places: Sequence[Sequence[float]], groups: Sequence[Sequence[str]]
) -> EffectPoint:
    mean = one.pooled[k]
    return EffectPoint(
        tuple(place[k] for place in places), tuple(group[k] for group in groups), one.runs[k],
        math.nan if mean is None else mean.value, math.nan if mean is None else mean.error,
    )  # fmt: skip


def _axis(column: SweepColumn, name: str, legend: str) -> tuple[EffectAxis, Sequence[float]]:
    """Axis of a key, and the place of every setting along it, in the unit in which it was written."""
    numbers = [one for one in column.values if isinstance(one, (int, float)) and not isinstance(one, bool)]
    if len(numbers) < len(column.values):
        words = tuple(dict.fromkeys(column.written))
        return EffectAxis(name, words, legend=legend), [float(words.index(one)) for one in column.written]
    unit, scale = _written_unit(column)
    places = [float(one) / scale for one in numbers]
    log = min(places) > 0.0 and max(places) > WIDE * min(places)
    return EffectAxis(f"{name}  ({printed_unit(unit)})", (), log, legend), places


def _written_unit(column: SweepColumn) -> tuple[str, float]:
    """Unit in which all values of a key are written, and its size in SI; the SI unit if they differ."""
    words = {one.lstrip("+-0123456789.eE ").strip() for one in column.written}
    unit = words.pop() if len(words) == 1 else ""
    if column.unit and unit and si_unit(f"1 {unit}") == column.unit:
        return unit, quantity(f"1 {unit}", column.unit)
    return column.unit, 1.0
