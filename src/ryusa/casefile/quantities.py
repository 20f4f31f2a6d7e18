"""Field types of the case file: text with a unit comes in, SI numbers stay."""

import math
import re
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    AllowInfNan,
    BeforeValidator,
    Field,
    GetCoreSchemaHandler,
    Strict,
    WithJsonSchema,
)
from pydantic_core import CoreSchema, core_schema

from ryusa.laws._family import Family
from ryusa.units import plain_signs, quantity

_RATIO = re.compile(
    r"\s*([+-]?[0-9]*\.?[0-9]+(?:[eE][+-]?[0-9]+)?)\s*(?:([/:])\s*([0-9]*\.?[0-9]+)|(%|‰|permille))?\s*"
)


def _si(unit: str) -> BeforeValidator:
    def read(text: Any) -> float:
        return quantity(text, unit)

    return BeforeValidator(read)


def _text(what: str, *examples: str) -> WithJsonSchema:
    return WithJsonSchema({"type": "string", "format": "quantity", "title": what, "examples": list(examples)})


def read_ratio(value: Any) -> Any:
    """Read a number, `"1/20"`, `"1:20"`, `"5 %"` or `"5 permille"`; anything else goes on to the type check.

    >>> read_ratio("1/20"), read_ratio("1:20"), read_ratio("5 ‰")
    (0.05, 0.05, 0.005)
    """
    if not isinstance(value, str):
        return value
    found = _RATIO.fullmatch(plain_signs(value[:64]))
    if found is None:
        raise ValueError("needs a number or a ratio such as '1/20'")
    top, sign, below, part = found.groups()
    bottom = {None: float(below or 1.0), "%": 100.0}.get(part, 1000.0)
    if sign == ":" and abs(float(top)) > bottom:
        raise ValueError(f"'{value.strip()}' is read in two ways: write {top}/{below} or {below}/{top}")
    if bottom == 0.0 or not math.isfinite(float(top) / bottom):
        raise ValueError("needs a finite ratio such as '1/20'")
    return float(top) / bottom + 0.0  # no -0.0


class WordOf:
    """Annotation of a text that must be a word of a family of laws; JSON Schema gets the words too."""

    def __init__(self, family: type[Family]) -> None:
        self._family = family

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.literal_schema(list(self._family.words()))


def printable(name: str) -> str:
    """Check a name that will stand in tables and messages.

    Raises
    ------
    ValueError : it has a line break, or another character that cannot be printed.
    """
    if not name.isprintable():
        raise ValueError("must be printable text on one line")
    return name


Name = Annotated[str, Field(min_length=1, max_length=64), AfterValidator(printable)]
Number = Annotated[float, Strict(), AllowInfNan(False)]
Count = Annotated[int, Strict()]
Boolean = Annotated[bool, Strict()]
Length = Annotated[float, _si("m"), _text("length", "0.2 cm", "2 mm")]
Duration = Annotated[float, _si("s"), _text("time", "1 s", "1 ms"), Field(gt=0)]
Moment = Annotated[float, _si("s"), _text("time", "0 s", "0.1 s"), Field(ge=0)]
Speed = Annotated[float, _si("m/s"), _text("speed", "0.6 m/s", "60 cm/s")]
Spin = Annotated[float, _si("rad/s"), _text("spin", "900 rad/s", "10 rpm")]
Frequency = Annotated[float, _si("Hz"), _text("frequency", "30 Hz", "2 kHz"), Field(gt=0)]
Angle = Annotated[float, _si("rad"), _text("angle", "30 deg", "0.5 rad")]
Density = Annotated[float, _si("kg/m3"), _text("density", "2650 kg/m3", "2.65 g/cm3")]
Stiffness = Annotated[float, _si("N/m"), _text("stiffness", "100 N/cm", "1e4 N/m")]
Pressure = Annotated[float, _si("Pa"), _text("pressure", "50 MPa", "1e7 Pa")]
Dashpot = Annotated[float, _si("N s/m"), _text("damping constant", "0.001 N s/cm")]
Force = Annotated[float, _si("N"), _text("force", "0 N", "1 mN")]
Acceleration = Annotated[float, _si("m/s2"), _text("acceleration", "9.8 m/s2")]
Viscosity = Annotated[float, _si("m2/s"), _text("kinematic viscosity", "1e-6 m2/s")]
PressureGradient = Annotated[float, _si("Pa/m"), _text("pressure gradient", "50 Pa/m")]
UnitDischarge = Annotated[float, _si("m2/s"), _text("discharge per width", "0.02 m2/s", "200 cm2/s")]
Ratio = Annotated[
    float,
    AllowInfNan(False),
    BeforeValidator(read_ratio),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}], "examples": ["1/20", 0.05, "5 %"]}),
]

PositiveLength = Annotated[Length, Field(gt=0)]
Point = tuple[Length, Length, Length]

# the same quantity wherever a case gives it
STEEPEST = 1.5  # slope angles stay below 86 deg [rad]
Slope = Annotated[Ratio, Field(ge=-14, le=14)]
SlopeAngle = Annotated[Angle, Field(ge=-STEEPEST, le=STEEPEST)]
FrictionAngle = Annotated[Angle, Field(ge=0, lt=math.pi / 2)]
FrictionCoefficient = Annotated[Number, Field(ge=0, le=1.0e6)]
Restitution = Annotated[Number, Field(gt=0, le=1)]
RollingCoefficient = Annotated[Number, Field(ge=0)]
SpringStiffness = Annotated[Stiffness, Field(ge=1.0e-9, le=1.0e15)]
YoungsModulus = Annotated[Pressure, Field(ge=1.0, le=1.0e15)]
PoissonRatio = Annotated[Number, Field(ge=0, le=0.5)]
PullOffForce = Annotated[Force, Field(ge=0, le=1.0e9)]
WorkOfAdhesion = Annotated[
    float, _si("J/m2"), _text("energy per area", "0.05 J/m2", "50 mN/m"), Field(ge=0, le=1.0e9)
]
AdhesionDensity = Annotated[
    float, _si("J/m3"), _text("energy per volume", "1e5 J/m3", "100 kPa"), Field(ge=0, le=1.0e15)
]
GrainDensity = Annotated[Density, Field(ge=1.0, le=1.0e6)]
