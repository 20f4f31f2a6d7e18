"""The paper as data."""

import importlib
import importlib.util

import pytest

from ryusa.laws.collision import collision_time
from ryusa_studies.osada2004 import claims, paper


def test_all_thirteen_equations_are_there():
    assert list(paper.EQUATIONS) == [str(n) for n in range(1, 14)]


@pytest.mark.parametrize("number", paper.EQUATIONS)
def test_an_equation_points_at_a_law_that_names_it(number):
    code = paper.EQUATIONS[number].code
    if code == "engine":
        assert importlib.util.find_spec("ryusa.engine")
        return
    module, name = f"ryusa.{code}".rsplit(".", 1)
    assert "Eq" in getattr(importlib.import_module(module), name).__doc__


def test_claims_and_readings_have_unique_ids_and_texts():
    assert len(claims.CLAIMS) == 49  # ids are keys of TOML tables, which occur once or the file is refused
    assert len(paper.READINGS) == 17
    assert all(claim.setup and claim.says for claim in claims.CLAIMS.values())
    assert all(reading.choice and reading.why for reading in paper.READINGS.values())


@pytest.mark.parametrize("figure", range(4, 24))
def test_every_figure_from_4_on_is_named_by_a_claim(figure):
    named = " ".join(claim.figure for claim in claims.CLAIMS.values()).replace(",", " ")
    assert any(word.rstrip("abc") == str(figure) for word in named.split())


def test_a_claim_with_rotation_free_does_not_say_locked():
    assert "locked" not in claims.CLAIMS["fig17-free"].setup


def test_the_time_of_fig4_is_that_of_eq_8():
    m = 2650.0 * 3.14159 / 6 * 0.002**3
    assert collision_time(m, 1.0) == pytest.approx(0.01, rel=0.1)
