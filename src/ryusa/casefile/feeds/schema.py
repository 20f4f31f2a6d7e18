"""Keys of [[feeds]] and [[exits]]."""

import re
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Tag, WithJsonSchema

from ryusa.casefile.course import FILE_OR_POINTS, AtPoints, CourseFile
from ryusa.casefile.quantities import Moment, Name, Number, Point, PositiveLength, Speed
from ryusa.casefile.section import Section
from ryusa.units import UnitError, quantity

_GRAINS = re.compile(r"\s*([0-9.eE+-]+)\s*(?:grains?|1)?\s*/\s*(s|min|h)\s*")
Rate = tuple[float, Literal["kg/s", "grains/s"]]


def read_rate(value: Any) -> Any:
    """Read kilograms or grains in a time.

    >>> read_rate("1.2 kg/min"), read_rate("30 grains/min")
    ((0.02, 'kg/s'), (0.5, 'grains/s'))
    """
    if isinstance(value, list | tuple):  # as case.json holds it
        return tuple(value)
    found = _GRAINS.fullmatch(value[:64]) if isinstance(value, str) else None
    if found is not None:
        seconds = quantity(f"1 {found.group(2)}", "s")
        try:
            return float(found.group(1)) / seconds, "grains/s"
        except ValueError:
            pass
    try:
        return quantity(value, "kg/s"), "kg/s"
    except UnitError:
        raise ValueError(
            "needs a mass or a number of grains in a time, such as '0.1 kg/s' or '20 grains/s'"
        ) from None


FeedRate = Annotated[
    Rate,
    BeforeValidator(read_rate),
    WithJsonSchema(
        {"type": "string", "format": "quantity", "title": "rate", "examples": ["0.1 kg/s", "20 grains/s"]}
    ),
]


SedigraphPoints = Annotated[tuple[tuple[Moment, FeedRate], ...], AtPoints, Tag("<points>")]
Sedigraph = Annotated[CourseFile | SedigraphPoints, FILE_OR_POINTS]

_COUNT = re.compile(r"\s*([0-9]+)\s*grains?\s*")
Total = tuple[float, Literal["kg", "grains"]]


def read_total(value: Any) -> Any:
    """Read a mass or a number of grains.

    >>> read_total("500 g"), read_total("200 grains")
    ((0.5, 'kg'), (200.0, 'grains'))
    """
    if isinstance(value, list | tuple):  # as case.json holds it
        return tuple(value)
    found = _COUNT.fullmatch(value[:64]) if isinstance(value, str) else None
    if found is not None:
        return float(found.group(1)), "grains"
    try:
        return quantity(value, "kg"), "kg"
    except UnitError:
        raise ValueError("needs a mass or a number of grains, such as '0.5 kg' or '200 grains'") from None


FeedTotal = Annotated[
    Total,
    BeforeValidator(read_total),
    WithJsonSchema(
        {"type": "string", "format": "quantity", "title": "total", "examples": ["0.5 kg", "200 grains"]}
    ),
]


class FeedSection(Section):
    """Grains that enter during the run, in a box or through a disc."""

    name: Name
    """Name of the feed; [[exits]] can lead to it, and its grains are a group of this name."""
    low: Point | None = None
    """Lower corner of a box in which whole grains are placed at random."""
    high: Point | None = None
    """Upper corner of the box."""
    centre: Point | None = None
    """Centre of a disc through which grains pass, a line in a plane scene; instead of a box."""
    normal: tuple[Number, Number, Number] = (0.0, 0.0, -1.0)
    """Direction normal to the disc, of any length."""
    radius: PositiveLength | None = None
    """Radius of the disc; whole grains fit in it."""
    rate: FeedRate | None = None
    """Mass or number of grains in a time, "0.1 kg/s" or "20 grains/s"; without a rate only grains that an
    exit sends here come in."""
    sedigraph: Sedigraph | None = None
    """Rate over time, instead of `rate`, `begin` and `end`: a CSV file in the folder of the case with the
    header t [s],rate [kg/s], or pairs of time and rate, straight between them. Before the first and after the
    last the feed brings nothing."""
    velocity: tuple[Speed, Speed, Speed] = (0.0, 0.0, 0.0)
    """Velocity of every grain that enters."""
    begin: Moment = 0.0
    """Simulated time at which the first grain is due."""
    end: Moment | None = None
    """Simulated time from which no new grain is due; stop.time when not given."""
    total: FeedTotal | None = None
    """Mass or number of grains after which the feed stops, "0.5 kg" or "200 grains"."""
    moves_with: Name | None = None
    """Name of a wall to which the feed is attached, and with which it moves and turns. Place and normal are
    those at t = 0, and velocity is relative to the wall, with its direction at t = 0."""
    material: Name | None = None
    """Material of its grains, of [materials], with its sizes; that of [grains] when not given."""

    @property
    def brings(self) -> bool:
        """Whether it brings grains of its own."""
        return self.rate is not None or self.sedigraph is not None


class ExitSection(Section):
    """Where grains leave: beyond a plane or in a box, as soon as their centre is there."""

    name: Name
    """Name of the exit."""
    point: Point | None = None
    """A point on the plane."""
    normal: tuple[Number, Number, Number] | None = None
    """Direction in which grains leave through the plane, of any length."""
    low: Point | None = None
    """Lower corner of a box, instead of a plane."""
    high: Point | None = None
    """Upper corner of the box."""
    moves_with: Name | None = None
    """Name of a wall to which the exit is attached; place and normal are those at t = 0."""
    to: str | None = None
    """Name of a feed through which the same grains come in again; they are removed when not given."""
