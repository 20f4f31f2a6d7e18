"""The parts on box, heap, bed and Eq. (13) vary the choices that are registered for them, and no others."""

from pathlib import Path

import pytest

from ryusa.study.registration import Registration
from ryusa_studies import osada2004
from ryusa_studies.osada2004 import bed18, eq13, fig10, fig19

DESIGNS = {
    "fig10-soft": fig10.DESIGN, "fig10-stiff": fig10.DESIGN, "fig10-rule": fig10.OTHERS,
    "fig19-locked": fig19.DESIGN, "fig19-free": fig19.DESIGN, "bed18": bed18.DESIGN, "eq13": eq13.DESIGN,
}  # fmt: skip


@pytest.fixture(scope="module")
def registered() -> Registration:
    return Registration.read(Path(osada2004.__file__).parent / "registration")


@pytest.mark.parametrize("claim", DESIGNS)
def test_the_factors_are_the_registered_ones(claim: str, registered: Registration) -> None:
    assert set(registered.claims[claim].factors) == set(DESIGNS[claim].levels)
    assert registered.claims[claim].original
    assert registered.claims[claim].translation
