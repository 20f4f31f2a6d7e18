"""Bands of the claims as they are registered."""

from functools import cache
from pathlib import Path

from ryusa.study import Band
from ryusa.study.registration import Registration


@cache
def _registration() -> Registration:
    return Registration.read(Path(__file__).with_name("registration"))


def band(claim: str, part: str) -> Band:
    """Band of one part of a claim that is in force."""
    found = _registration().claims[claim].entries(part)[-1].band
    assert found is not None, f"{claim}: {part} is registered to be shown only"
    return found
