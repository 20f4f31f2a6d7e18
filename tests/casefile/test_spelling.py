"""A hint is given where two words are near, and nowhere else."""

from collections.abc import Callable

import pytest

from ryusa.casefile import Case, all_keys
from ryusa.errors import CaseError
from ryusa.spelling import nearest_word

CaseOf = Callable[..., Case]
WORDS = sorted({part for key in all_keys() for part in key.split(".")})

NEAR = [
    ("diametr", "diameter"),
    ("diamter", "diameter"),
    ("Diameter", "diameter"),
    ("stifness", "stiffness"),
    ("restituion", "restitution"),
    ("friction_angel", "friction_angle"),
    ("frictionangle", "friction_angle"),
    ("viscocity", "viscosity"),
    ("rougness", "roughness"),
    ("densty", "density"),
    ("lenght", "length"),
    ("tau", "tau_star"),
    ("ustar", "u_star"),
    ("rotaton", "rotation"),
    ("timelime", "timeline"),
    ("contakt", "contact"),
    ("steps_per_contacts", "steps_per_contact"),
    ("colum", "column"),
]
FAR = [
    "inflow",
    "outflow",
    "young",
    "mesh",
    "nozzle",
    "salinity",
    "humidity",
    "hertz",
    "x",
    "dt",
    "",
    "porosity",
    "boundary",
    "cellsize_of_the_mesh",
]


@pytest.mark.parametrize(("written", "meant"), NEAR)
def test_a_misspelt_key_is_recognised(written: str, meant: str) -> None:
    assert nearest_word(written, WORDS) == meant


@pytest.mark.parametrize("written", FAR)
def test_a_word_unlike_any_key_gets_no_hint(written: str) -> None:
    assert nearest_word(written, WORDS) is None


def test_a_word_of_three_letters_with_another_letter_is_another_word() -> None:
    assert nearest_word("gpu", ["cpu", "cuda"]) is None
    assert nearest_word("pcu", ["cpu", "cuda"]) == "cpu"
    assert nearest_word("cp", ["cpu", "cuda"]) is None
    assert nearest_word("cpus", ["cpu", "cuda"]) == "cpu"


def test_every_key_is_found_again_with_a_letter_left_out_or_two_swapped() -> None:
    for word in (one for one in WORDS if len(one) > 5):
        for place in range(1, len(word) - 1):
            short = word[:place] + word[place + 1 :]
            swapped = word[:place] + word[place + 1] + word[place] + word[place + 2 :]
            for written in (short, swapped):
                found = nearest_word(written, WORDS)
                assert found is not None, written
                assert found == word or written in WORDS or len(found) <= len(word) + 1


def test_a_key_of_another_table_is_pointed_to(case: CaseOf) -> None:
    with pytest.raises(CaseError, match=r"contact\.diameter: unknown key\. Did you mean 'grains\.diameter'"):
        case(**{"contact.diameter": "'1 mm'"})


@pytest.mark.parametrize("key", ["dt", "timestep", "time_step"])
def test_the_time_step_is_found_by_the_names_of_other_programs(case: CaseOf, key: str) -> None:
    with pytest.raises(CaseError, match=rf"time\.{key}: unknown key\. Did you mean 'time\.step'"):
        case(**{f"time.{key}": "'1 us'"})


def test_an_unknown_boundary_gets_no_hint(case: CaseOf) -> None:
    with pytest.raises(CaseError) as caught:
        case(**{"domain.inflow": "1"})
    assert caught.value.nearest is None


@pytest.mark.parametrize("key", ["young", "shear_modulus", "poissons_ratio", "model"])
def test_a_key_of_elastic_spheres_under_another_name_is_answered_by_theirs(case: CaseOf, key: str) -> None:
    with pytest.raises(CaseError, match=r"law = 'Hertz-Mindlin' with youngs_modulus") as caught:
        case(**{f"contact.{key}": "1"})
    assert "contact.stiffness" in str(caught.value)
    assert "docs/theory.md" in str(caught.value)
    assert caught.value.nearest is None
