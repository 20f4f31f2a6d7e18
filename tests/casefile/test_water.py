"""What the water of a case does, against other formulas and pocket-calculator numbers."""

import math
from collections.abc import Callable

import pytest

from ryusa.casefile import Case, derive, read
from ryusa.casefile.water.values import terminal_velocity, water_speed
from ryusa.cases import case_path
from ryusa.errors import CaseError

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
        found = derive(wet)
        surface, higher = water_speed(wet, found, 0.02), water_speed(wet, found, 0.04)
        assert surface == pytest.approx(found.u_star * (8.5 + 5.75 * 1.0))
        assert (higher > surface) - (higher < surface) == expected


def test_a_step_in_which_drag_reverses_the_slip_is_refused(case: CaseOf) -> None:
    # Stokes: (sigma + rho/2) d^2/(18 rho nu) = 3150 * 4e-6/(18 * 1000 * nu); dt of 50 steps is 2e-6 s or so
    keys = {"time.step": "2e-6 s", "contact.friction_angle": "30 deg"}
    slowest = 3150.0 * 4e-6 / 18.0e3 / 2e-6
    thin = f"{{ profile = 'still', drag = 'Schiller-Naumann', viscosity = '{0.99 * slowest:g} m2/s' }}"
    assert case(water=thin, **keys).water is not None
    with pytest.raises(
        CaseError, match=r"time\.step.*too long for the drag, which slows .* within 1\.98e-06"
    ):
        case(water=thin.replace(f"{0.99 * slowest:g}", f"{1.01 * slowest:g}"), **keys)


def test_a_column_needs_a_step_below_a_quarter_of_the_drag_time() -> None:
    path = case_path("settling_column.toml")
    most = 0.25 * 3150.0 * 0.25e-6 / 18.0e3 / derive(read(path)).dt  # viscosity whose drag asks for this dt
    read(path, {"water.viscosity": f"{0.99 * most:g} m2/s"})
    with pytest.raises(CaseError, match="must be below a quarter of that"):
        read(path, {"water.viscosity": f"{1.01 * most:g} m2/s"})
