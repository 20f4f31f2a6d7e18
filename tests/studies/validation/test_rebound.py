"""What the check of immersed rebound asks for is what its laws say, and what is known by hand."""

import numpy as np
import pytest

from ryusa.laws import immersed
from ryusa.laws.reduced import reduced
from ryusa_studies.validation import rebound

ST = np.array(rebound.ASKED)


def test_the_laws_repeated_in_the_study_are_those_of_the_package():
    exponential = [immersed.restitution_exponential(rebound.E_DRY, st, rebound.ST_C) for st in ST]
    davis = [immersed.restitution_davis(rebound.E_DRY, st, rebound.ROUGH, rebound.D) for st in ST]
    assert rebound.asked("exponential", ST) == pytest.approx(np.maximum(exponential, rebound.LEAST))
    assert rebound.asked("Davis", ST) == pytest.approx(np.maximum(davis, rebound.LEAST))


@pytest.mark.parametrize(
    ("partner", "mass", "size"),
    [("wall", np.inf, np.inf), ("fixed grain", np.inf, 1.0), ("free grain", 1.0, 1.0)],
)
def test_a_speed_gives_the_stokes_number_it_was_chosen_for(partner, mass, size):
    m = (rebound.DENSITY + rebound.C_M * rebound.RHO) * np.pi / 6.0 * rebound.D**3
    r = 0.5 * rebound.D
    speed = rebound.speed_of(35.0, partner)
    st = immersed.stokes_number(speed, reduced(m, m * mass), reduced(r, r * size), rebound.RHO, rebound.NU)
    assert st == pytest.approx(35.0)


def test_a_film_dissipates_the_integral_of_its_force():
    r, gap = 0.5 * rebound.D, np.linspace(0.0, rebound.REACH, 20001)
    force = [
        immersed.lubrication_force(h, 1.0, r, rebound.ROUGH, rebound.REACH, rebound.RHO, rebound.NU)
        for h in gap
    ]
    taken = np.trapezoid(force, gap) / (6.0 * np.pi * rebound.RHO * rebound.NU * r**2)
    assert pytest.approx(taken, rel=1e-4) == rebound.TAKEN
    assert rebound.through(np.array([1e9]))[0] == pytest.approx(rebound.E_DRY)
