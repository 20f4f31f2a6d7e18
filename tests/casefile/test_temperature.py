"""water.temperature: density and viscosity of fresh water."""

import pytest

from ryusa.casefile.read import read_text
from ryusa.errors import CaseError

CASE = """
[grains]
diameter = "1 mm"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.6
friction = 0.3
[motion]
rotation = "free"
plane = false
[water]
profile = "still"
{water}
[build]
kind = "drop"
partner = "plane"
height = "1 mm"
[stop]
time = "10 ms"
"""


def read(water):
    return read_text(CASE.format(water=water)).water


# Kestin et al. 1978, table 4, and Tanaka et al. 2001
@pytest.mark.parametrize(
    ("text", "density", "viscosity"),
    [
        ("5 degC", 999.967, 1.5182e-6),
        ("15 degC", 999.103, 1.1386e-6),
        ("20 degC", 998.207, 1.0038e-6),
        ("68 degF", 998.207, 1.0038e-6),
        ("303.15 K", 995.649, 0.8007e-6),
    ],
)
def test_water_is_as_dense_and_viscous_as_its_temperature_says(text, density, viscosity):
    found = read(f'temperature = "{text}"')
    assert found.density == pytest.approx(density, rel=1e-5)
    assert found.viscosity == pytest.approx(viscosity, rel=1e-3)


def test_a_density_that_is_given_stays():
    found = read('temperature = "10 degC"\ndensity = "1025 kg/m3"')
    assert found.density == 1025.0
    assert found.viscosity == pytest.approx(1.307e-6, rel=1e-3)


@pytest.mark.parametrize(
    ("water", "said"),
    [
        ('temperature = "-3 degC"', "between 0 and 40"),
        ('temperature = "15"', "15 degC"),
        ('temperature = "15 m"', "15 degC"),
        ('temperature = "15 degC"\ndensity = "1000 kg/m3"\nviscosity = "1e-6 m2/s"', "no effect"),
    ],
)
def test_what_is_no_temperature_or_has_no_effect_is_refused(water, said):
    with pytest.raises(CaseError, match=said):
        read(water)
