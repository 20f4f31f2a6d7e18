"""`ryusa check` beside natural sand, and the limit of Coulomb."""

import pytest

from ryusa.casefile import explain, read_text

CASE = """
[grains]
diameter = "{d}"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = {e}
friction = 0.3
{contact}
[motion]
rotation = "free"
plane = false
[water]
profile = "still"
viscosity = "1.004e-6 m2/s"
density = "998.2 kg/m3"
{water}
[build]
kind = "drop"
partner = "plane"
height = "1 mm"
[stop]
time = "10 ms"
"""


def rows(d="1 mm", contact="", water="", e=0.6):
    text = CASE.format(d=d, contact=contact, water=water, e=e)
    return {row.name: row for row in explain(read_text(text))}


# Gibbs, Matthews & Link 1971, spheres of quartz in water of 20 deg C [m/s]
@pytest.mark.parametrize(
    ("d", "measured"), [("0.25 mm", 0.0325), ("0.5 mm", 0.0763), ("1 mm", 0.1535), ("2 mm", 0.2747)]
)
def test_spheres_settle_as_measured_without_a_law_being_named(d, measured):
    assert rows(d)["settling velocity"].value == pytest.approx(measured, rel=0.05)


# Ferguson & Church 2004, eq. 4 with C_1 = 18, C_2 = 1: 0.125 mm 0.0115 m/s, 1 mm 0.126 m/s
@pytest.mark.parametrize(
    ("d", "water", "word"),
    [
        ("1 mm", "", "23% faster"),
        ("1 mm", 'drag = "24/Re+0.4"', "62% faster"),
        ("1 mm", 'drag = "24/Re+2"', "slower"),
        ("1 mm", 'drag = "Ferguson-Church sand"', ""),
        ("0.1 mm", "", ""),
        ("40 mm", "", "faster"),
    ],
)
def test_the_settling_velocity_stands_beside_that_of_natural_sand(d, water, word):
    row = rows(d, water=water)["settling velocity of natural sand"]
    assert word in row.origin
    assert (row.flag == "note") == bool(word)
    if d == "1 mm":
        assert row.value == pytest.approx(0.1264, rel=2e-3)


@pytest.mark.parametrize(
    ("contact", "e", "holds"),
    [
        ("", 0.6, True),
        ('slip = "total"', 0.6, True),
        ('slip = "spring"', 0.6, False),
        ('slip = "spring-drop"', 0.6, False),
        ('slip = "spring"\nrestitution_shear = 1.0', 0.6, False),  # the cap is that of e_n
        ('slip = "spring"\nrestitution_shear = 1.0\ncap = "total"', 0.6, True),
        ('slip = "spring"', 1.0, True),
    ],
)
def test_the_limit_of_coulomb_is_said_to_hold_or_not(contact, e, holds):
    row = rows(contact=contact, e=e)["Coulomb limit"]
    assert (row.value == "holds") == holds
    assert (row.flag == "note") != holds
