"""[stop] precision: how well averages must be known for a run to end."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Annotated

from pydantic import PlainSerializer, PlainValidator, WithJsonSchema

from ryusa.casefile.quantities import read_ratio
from ryusa.casefile.section import Section
from ryusa.catalogue import MEASURES
from ryusa.units import UnitError, quantity

INDEPENDENT = 60  # independent samples that an average must be worth, and frames before the first measurement


@dataclass(frozen=True)
class ErrorLimit:
    """Largest standard error of an average that is to be known well enough.

    Attributes
    ----------
    amount : the error, as a share of the average [-] or in `unit`.
    unit : SI unit of the error; "" for a share of the average.
    """

    amount: float
    unit: str = ""

    def of(self, value: float) -> float:
        """Largest error of an average of this value, in its unit.

        >>> ErrorLimit(0.02).of(-5.0), ErrorLimit(1.0e-3, "m").of(-5.0)
        (0.1, 0.001)
        """
        return self.amount if self.unit else self.amount * abs(value)

    def __str__(self) -> str:
        return f"{self.amount:g} {self.unit}" if self.unit else f"{100.0 * self.amount:g} %"


def limit_reader(unit: str) -> Callable[[object], ErrorLimit | None]:
    """Return a reader of "2 %", and where there is a unit also of an error in it.

    >>> limit_reader("m")("2 %"), limit_reader("m")("1 mm")
    (ErrorLimit(amount=0.02, unit=''), ErrorLimit(amount=0.001, unit='m'))
    """
    needed = "needs a share of the average such as '2 %'"
    needed += f", or an error in {unit} such as '1e-6 {unit}'" if unit else ""

    def read(given: object) -> ErrorLimit | None:
        if given is None:
            return None
        if not isinstance(given, str):
            raise ValueError(needed)
        try:
            if given.strip().endswith("%"):
                limit = ErrorLimit(read_ratio(given))
            elif unit:
                limit = ErrorLimit(quantity(given, unit), unit)
            else:
                raise ValueError(needed)
        except UnitError as error:
            raise ValueError(f"{error}; or a share of the average such as '2 %'") from None
        if not limit.amount > 0.0 or (not limit.unit and limit.amount >= 1.0):
            raise ValueError("must be greater than 0" + ("" if limit.unit else " and less than 100 %"))
        return limit

    return read


def _data(limit: ErrorLimit | None) -> dict[str, float | str] | None:
    return None if limit is None else asdict(limit)


def _schema(*examples: str) -> WithJsonSchema:
    return WithJsonSchema(
        {"type": "string", "format": "quantity", "title": "standard error", "examples": list(examples)}
    )


_PLAIN = PlainSerializer(_data)
Share = Annotated[ErrorLimit | None, PlainValidator(limit_reader("")), _PLAIN, _schema("2 %")]
ErrorOfLength = Annotated[
    ErrorLimit | None, PlainValidator(limit_reader("m")), _PLAIN, _schema("2 %", "0.1 mm")
]
ErrorOfSpeed = Annotated[
    ErrorLimit | None, PlainValidator(limit_reader("m/s")), _PLAIN, _schema("2 %", "1 mm/s")
]
ErrorOfFlux = Annotated[
    ErrorLimit | None, PlainValidator(limit_reader("m2/s")), _PLAIN, _schema("2 %", "1 mm2/s")
]


class PrecisionSection(Section):
    """Averages that end the run once all are known to these standard errors.

    They are taken from record.settle, or the last change of the timeline, on, and must be steady.
    """

    q: ErrorOfFlux = None
    """Volume of grains that crosses a unit of width in a second, of `ryusa measure RUN transport`."""
    q_star: Share = None
    """The same over sqrt(R g d^3), of `ryusa measure RUN transport`."""
    layer_thickness: ErrorOfLength = None
    """Thickness of the transport layer, of `ryusa measure RUN transport`."""
    entrainment: Share = None
    """Grains that start to move per area and time, of `ryusa measure RUN entrainment`."""
    deposition: Share = None
    """Grains that come to rest per area and time, of `ryusa measure RUN entrainment`."""
    moving: ErrorOfLength = None
    """Volume of moving grains per area of bed, of `ryusa measure RUN entrainment`."""
    moving_speed: ErrorOfSpeed = None
    """Mean speed of moving grains along the bed, of `ryusa measure RUN entrainment`."""
    tau_star: Share = None
    """Shear stress of the water at the bed over (rho_s - rho_w) g d, of `ryusa measure RUN water`."""
    discharge: ErrorOfFlux = None
    """Discharge of water per width, of `ryusa measure RUN water`."""

    def limits(self) -> dict[str, ErrorLimit]:
        """The averages that are given, each with its largest standard error."""
        found: dict[str, ErrorLimit | None] = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: limit for name, limit in found.items() if limit is not None}


def measure_of(name: str) -> str:
    """Name of the measure that gives an average of `stop.precision`.

    >>> measure_of("q_star")
    'transport'
    """
    return next(entry.name for entry in MEASURES if name in entry.precision)
