"""Values and limits in messages are in the words of the case, not in SI."""

import pytest

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.errors import CaseError


@pytest.mark.parametrize(
    "name, key, typed, words",
    [
        ("drop", "grains.diameter", "-0.2 cm", "= '-0.2 cm': must be at least 1e-05 cm"),
        ("drop", "grains.diameter", "0 in", "must be at least 3.938e-06 in"),  # rounded to what is taken
        ("drop", "contact.friction_angle", "95 deg", "must be less than 90 deg"),
        ("drop", "motion.slope_angle", "89 deg", "must be at most 85.94 deg"),
        ("drop", "grains.density", "2650 g/cm3", "must be at most 1000 g/cm3"),
        ("drop", "grains.spread", "95 %", "must be less than 90 %"),
        ("drop", "motion.slope", "20", "Were 20 deg meant, or '20 %'?"),
        ("drop", "record.settle", "-1 ms", "must be at least 0 ms"),
        ("drop", "contact.restitution", "7", "= 7: must be at most 1"),
        (
            "bedload_3d",
            "water.depth",
            "2 mm",
            "water.depth = '2 mm': covers no grain: at least their diameter, 4 mm",
        ),
        ("river", "water.row.dams.0.end", "600 cm", "must lie in the row, 0 to 300 cm"),
        ("sabo_dam", "exits.0.normal", "[0, 0, 0]", "exits.0.normal = [0, 0, 0]: must not be zero"),
    ],
)
def test_a_limit_is_in_the_unit_that_was_typed(name: str, key: str, typed: str, words: str) -> None:
    with pytest.raises(CaseError) as found:
        read(case_path(f"{name}.toml"), {key: typed})
    assert words in str(found.value)
    assert "SI" not in str(found.value)
