import contextlib
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ryusa.casefile.quantities import read_ratio
from ryusa.units import COMMON, UnitError, format_quantity, from_pint, quantity

GOOD = [
    ("100 N/cm", "N/m", 1.0e4),
    ("0.01 N/cm", "N/m", 1.0),
    ("0.2 cm", "m", 0.002),
    ("0.2cm", "m", 0.002),
    ("200 µm", "m", 2e-4),
    ("200 μm", "m", 2e-4),
    ("200 um", "m", 2e-4),
    ("2650 kg/m3", "kg/m3", 2650.0),
    ("2.65 g/cm^3", "kg/m3", 2650.0),
    ("2.65 g/cm³", "kg/m3", 2650.0),
    ("2.65 g cm-3", "kg/m3", 2650.0),
    ("9.8 m/s2", "m/s2", 9.8),
    ("9.8 m/s/s", "m/s2", 9.8),
    ("0.001 N s/cm", "N s/m", 0.1),
    ("0.001 N·s/cm", "N s/m", 0.1),
    ("1e-6 m2/s", "m2/s", 1e-6),
    ("1 cSt", "m2/s", 1e-6),
    ("200 cm2/s", "m2/s", 0.02),
    ("50 Pa/m", "Pa/m", 50.0),
    ("1 hPa/m", "Pa/m", 100.0),
    ("30 deg", "rad", math.pi / 6),
    ("30°", "rad", math.pi / 6),
    ("60 rpm", "rad/s", 2 * math.pi),
    ("-1.5 mm", "m", -0.0015),
    ("0 N", "N", 0.0),
    ("1 dyn", "N", 1e-5),
]

BAD = [
    ("", "m"),
    ("   ", "m"),
    ("cm", "m"),
    ("5 0 N", "N"),
    ("5", "N"),
    (5, "N"),
    (0.5, "rad"),
    (True, "m"),
    (None, "m"),
    (["1 m"], "m"),
    ("nan m", "m"),
    ("inf m", "m"),
    ("1e999 m", "m"),
    ("1e9999999 m", "m"),
    ("0,2 cm", "m"),
    ("20 degC", "K"),
    ("20 degC", "m"),
    ("20 °C", "m"),
    ("1 Hz", "rad/s"),
    ("5 %", "rad"),
    ("5 kg", "m"),
    ("5 parsnips", "m"),
    ("5 m**99", "m"),
    ("5 m//s", "m/s"),
    ("5 m/", "m"),
    ("5 /m", "m"),
    ("5 (m)", "m"),
    ("10² cm", "m"),
    ("__import__('os') m", "m"),
    ("1 __import__", "m"),
    ("1 m" + " " * 100, "m"),
    ("1 " + "m*" * 500 + "m", "m"),
    ("0.25 d", "m"),
]


@pytest.mark.parametrize(("text", "unit", "value"), GOOD)
def test_a_number_with_its_unit_becomes_si(text: str, unit: str, value: float) -> None:
    assert quantity(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(("text", "unit"), BAD)
def test_a_bad_quantity_gives_one_error(text: object, unit: str) -> None:
    with pytest.raises(UnitError) as caught:
        quantity(text, unit)
    assert "\n" not in str(caught.value)
    assert "pint" not in str(caught.value)


def test_a_number_without_a_unit_is_refused() -> None:
    with pytest.raises(UnitError, match="missing unit"):
        quantity("0.2", "m")
    with pytest.raises(UnitError, match="missing unit"):
        quantity(0.2, "m")


def test_decimal_text_keeps_its_decimal_value() -> None:
    assert quantity("0.7 cm", "m") == 0.007
    assert quantity("1 N/cm", "N/m") == 100.0


@given(
    st.floats(min_value=1e-12, max_value=1e12),
    st.sampled_from([("m", "cm"), ("N/m", "N/cm"), ("rad", "deg"), ("s", "ms")]),
)
def test_what_is_written_is_read_back(value: float, units: tuple[str, str]) -> None:
    si, shown = units
    assert quantity(format_quantity(value, shown, digits=17), si) == pytest.approx(value, rel=1e-14)


@settings(max_examples=300)
@given(st.text(max_size=80))
def test_any_text_is_a_number_or_a_unit_error(text: str) -> None:
    try:
        value = quantity(text, "m")
    except UnitError:
        return
    assert math.isfinite(value)


@given(st.text(alphabet="0123456789.eE+- mskgNcd/*^°%µ²", max_size=20))
def test_texts_near_quantities_raise_no_other_error(text: str) -> None:
    with contextlib.suppress(UnitError):
        quantity(text, "N/m")


@pytest.mark.parametrize("name", sorted(COMMON.keys() - {"%"}))
def test_common_units_agree_with_pint(name):
    factor, bases = from_pint(name)
    assert (factor, tuple(sorted(bases))) == COMMON[name]


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("1 cfs", "m3/s", 0.028316846592),
        ("35.3146667 cfs", "m3/s", 1.0),
        ("10 cfs/ft", "m2/s", 0.9290304),
        ("15850.323 gpm", "m3/s", 1.0),
        ("165 pcf", "kg/m3", 2643.0456),
        ("62.4 pcf", "kg/m3", 999.552),
        ("1 psf", "Pa", 47.88026),
        ("3/8 in", "m", 0.009525),
        ("1 1/2 in", "m", 0.0381),
        ("-3/4 in", "m", -0.01905),
        ("1-1/4 in", "m", 0.03175),
        ("\uff13/\uff18 in", "m", 0.009525),
    ],
)
def test_units_of_the_trade_and_fractions_of_an_inch_are_read(text, unit, value):
    assert quantity(text, unit) == pytest.approx(value, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1:20", 0.05),
        ("1 : 20", 0.05),
        ("5 ‰", 0.005),
        ("5 permille", 0.005),
        ("-1:20", -0.05),
        ("\uff11/\uff12\uff10", 0.05),
    ],
)
def test_slopes_are_written_as_the_trade_writes_them(text, value):
    assert read_ratio(text) == pytest.approx(value, rel=1e-12)


def test_a_slope_that_may_be_of_earthworks_is_asked_for():
    with pytest.raises(ValueError, match="2/1 or 1/2"):
        read_ratio("2:1")
