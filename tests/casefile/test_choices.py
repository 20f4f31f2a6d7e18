"""Keys that the choices of a case do not take are errors that name these choices."""

import re

import pytest

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.errors import CaseError

WITHOUT_EFFECT = [  # case, what is set, key, reason
    ("heap", {"rolling.model": "none", "rolling.coefficient": "0.1"}, "rolling.coefficient", "model 'none'"),
    ("heap", {"rolling.model": "none", "rolling.arm": "reduced radius"}, "rolling.arm", "model 'none'"),
    ("heap", {"rolling.model": "constant", "rolling.coefficient": "0.1", "rolling.damping_ratio": "0.2"},
        "rolling.damping_ratio", "model 'constant'"),
    ("saltation", {"water.speed": "1 m/s"}, "water.speed", "profile 'log rough'"),
    ("saltation", {"water.lift": "Wiberg-Smith"}, "water.lift", "profile 'log rough'"),
    ("saltation", {"water.lift_coefficient": "0.3"}, "water.lift_coefficient", "profile 'log rough'"),
    ("saltation", {"water.hindrance_exponent": "3"}, "water.hindrance_exponent", "profile 'log rough'"),
    ("saltation", {"water.column.kappa": "0.4"}, "water.column", "profile 'log rough'"),
    ("saltation", {"water.drag_coefficient": "1"}, "water.drag_coefficient", "drag '24/Re+0.4'"),
    ("saltation", {"water.rebound_stokes": "30"}, "water.rebound_stokes", "rebound 'dry'"),
    ("saltation", {"water.film_reach": "1 mm"}, "water.film_reach", "film 'none'"),
    ("saltation", {"water.asperity": "1 um"}, "water.asperity", "rebound 'dry' and film 'none'"),
    ("movable_bed", {"water.hindrance_exponent": "3"}, "water.hindrance_exponent", "hindrance 'Di Felice'"),
    ("movable_bed", {"water.roughness": "1 mm"}, "water.roughness", "bed 'moving'"),
    ("movable_bed", {"water.column.discharge": "1 m2/s"}, "water.column.discharge", "drive 'slope'"),
    ("movable_bed", {"water.column.drive": "discharge", "water.column.discharge": "1 m2/s",
        "water.u_star": "0.1 m/s"}, "water.u_star", "drive 'discharge'"),
    ("movable_bed", {"water.column.mixing_length": "none", "water.column.kappa": "0.4"},
        "water.column.kappa", "mixing_length 'none'"),
]  # fmt: skip


@pytest.mark.parametrize(("case", "keys", "key", "reason"), WITHOUT_EFFECT)
def test_a_key_that_no_choice_takes_has_no_effect_and_the_choices_are_named(
    case: str, keys: dict[str, str], key: str, reason: str
) -> None:
    with pytest.raises(CaseError) as caught:
        read(case_path(f"{case}.toml"), keys)
    lines = str(caught.value).splitlines()
    assert any(
        re.search(rf"\b{re.escape(key)}\b.*has no effect with {re.escape(reason)}", one) for one in lines
    )
