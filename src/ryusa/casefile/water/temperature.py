"""Density and viscosity of fresh water by its temperature."""

import re
from typing import Any

from ryusa.units import plain_signs

COLDEST, WARMEST = 0.0, 40.0  # [deg C], of the formula for the density
_TEMPERATURE = re.compile(r"\s*([+-]?[0-9]*\.?[0-9]+)\s*(degC|°C|C|℃|degF|°F|F|K)\s*")


def read_temperature(value: Any) -> Any:
    """Read a temperature of water in degrees Celsius; a number, as case.json holds it, stays.

    >>> (
    ...     read_temperature("15 degC"),
    ...     round(read_temperature("59 °F"), 9),
    ...     round(read_temperature("288.15 K"), 9),
    ... )
    (15.0, 15.0, 15.0)
    """
    if isinstance(value, float):
        return value
    found = _TEMPERATURE.fullmatch(plain_signs(value)) if isinstance(value, str) else None
    if found is None:
        raise ValueError("needs a temperature with its unit, such as '15 degC'")
    number, unit = float(found.group(1)), found.group(2)
    if unit in {"degF", "°F", "F"}:
        number = (number - 32.0) / 1.8
    elif unit == "K":
        number -= 273.15
    if not COLDEST <= number <= WARMEST:
        raise ValueError(f"must lie between {COLDEST:g} and {WARMEST:g} degC, the range of the formulae")
    return number


def density_of_water(t: float) -> float:
    """Density of air-free fresh water at one atmosphere [kg/m3], t in degrees Celsius.

    Source: Tanaka et al. 2001, Metrologia 38, 301, eq. 1.

    >>> [round(density_of_water(t), 2) for t in (0.0, 4.0, 20.0, 40.0)]
    [999.84, 999.97, 998.21, 992.22]
    """
    return 999.974950 * (1.0 - (t - 3.983035) ** 2 * (t + 301.797) / (522528.9 * (t + 69.34881)))


def viscosity_of_water(t: float) -> float:
    """Kinematic viscosity of fresh water [m2/s], t in degrees Celsius.

    Source: Kestin, Sokolov & Wakeham 1978, J. Phys. Chem. Ref. Data 7, 941, eq. 15, over the density.

    >>> [round(1e6 * viscosity_of_water(t), 3) for t in (0.0, 10.0, 20.0, 30.0)]
    [1.792, 1.307, 1.004, 0.801]
    """
    off = 20.0 - t
    dynamic = 1.002e-3 * 10.0 ** (off / (t + 96.0) * (1.2364 - 1.37e-3 * off + 5.7e-6 * off * off))
    return float(dynamic / density_of_water(t))
