"""What the water of a case does, against other formulas and pocket-calculator numbers."""

import math
from collections.abc import Callable

import pytest

from ryusa.casefile import Case
from ryusa.casefile.water import terminal_velocity, water_speed

CaseOf = Callable[..., Case]
WATER = "{ profile = 'log rough', tau_star = 0.3, depth = '2 cm' }"


def test_settling_velocity_agrees_with_ferguson_and_church(case: CaseOf) -> None:
    wet = case(
        water="{ profile = 'still', drag = 'Ferguson-Church sphere' }", **{"motion.gravity": "9.81 m/s2"}
    )
    assert terminal_velocity(wet) == pytest.approx(0.301, abs=5e-4)
    assert terminal_velocity(case()) == math.inf


def test_water_above_its_depth_does_what_the_case_says(case: CaseOf) -> None:
    for above, expected in (("continue", 1.0), ("hold", 0.0), ("dry", -1.0)):
        wet = case(water=WATER.replace("}", f", above = '{above}' }}"))
        surface, higher = water_speed(wet, 0.02), water_speed(wet, 0.04)
        assert surface == pytest.approx(wet.derived.u_star * (8.5 + 5.75 * 1.0))
        assert (higher > surface) - (higher < surface) == expected
