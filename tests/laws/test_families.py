"""Every choice of physics is declared once, and every one is reached."""

import math

import pytest

from ryusa.build import scene
from ryusa.casefile.keys import all_keys
from ryusa.casefile.read import json_schema_text
from ryusa.engine.shared.refusals import refusals
from ryusa.laws import dispatch, families
from ryusa.laws._family import Family, evaluate, marked
from ryusa.laws._family import dispatch as build_dispatch
from ryusa.laws.families import FAMILIES, Drag
from ryusa.model import Water

PROBES = {  # of each generated dispatch: what its laws are asked, in the order of their family
    "drag_coefficient": (50.0, 0.7),
    "hindrance": (0.1, 0.5, 3.0, 1.0e-3, 1.0e-6, True),
    "shear_lift": (0.3, 0.1, 0.1, 20.0, 2.0e-3, 1.0e-6, 1000.0, 0.78, 0.2),
    "magnus": (0.1, 200.0, 2.0e-3, 1.0e-6, 1000.0),
    "water_torque": (300.0, 2.0e-3, 1.0e-6, 1000.0),
    "profile_speed": (0.004, 0.1, 0.002, 1.0e-6, 0.3),
    "wet_restitution": (0.9, 60.0, 35.0, 1.0e-5, 2.0e-3),
    "attraction": (0.05, 1.0e-3, 1.0e-5),
    "rolling_length": (1.0e-3, 2.0e-3, 1.0e-5),
    "mixing_length": (0.009, 0.01, 0.02, 0.1, 1.0e-4, 0.41),
    "wall_stress": (0.3, 0.002, 1.0e-5, 0.002, 1.0e-7),
    "side_friction": (1.0e4,),
}
FAMILY_OF = {
    "drag_coefficient": "Drag", "hindrance": "Hindrance", "shear_lift": "Lift", "magnus": "Magnus",
    "water_torque": "WaterTorque", "profile_speed": "Profile", "wet_restitution": "Rebound",
    "attraction": "Adhesion", "rolling_length": "Arm", "mixing_length": "Mixing", "wall_stress": "BedKind",
    "side_friction": "SideWalls",
}  # fmt: skip
SAME = {"BedKind.NO_SLIP", "BedKind.MOVING"}  # one wall: the eddies tell the two apart


def answers(name: str) -> dict[str, tuple[float, ...]]:
    """What the dispatch answers for each choice of its family."""
    family = next(one for one in FAMILIES if one.__name__ == FAMILY_OF[name])
    found = {}
    for choice in family:
        answer = getattr(dispatch, name)(int(choice), *PROBES[name])
        found[f"{family.__name__}.{choice.name}"] = answer if isinstance(answer, tuple) else (answer,)
    return found


@pytest.mark.parametrize("name", PROBES)
def test_every_choice_with_a_law_is_dispatched_and_no_two_give_the_same_result(name):
    family = next(one for one in FAMILIES if one.__name__ == FAMILY_OF[name])
    found = answers(name)
    for choice in family:
        answer = found[f"{family.__name__}.{choice.name}"]
        assert all(map(math.isfinite, answer)) == (choice.function is not None), choice
    told = [answer for who, answer in found.items() if all(map(math.isfinite, answer)) and who not in SAME]
    assert len(set(told)) == len(told)


@pytest.mark.parametrize("name", PROBES)
def test_a_number_without_a_choice_gives_nan(name):
    answer = getattr(dispatch, name)(99, *PROBES[name])
    assert all(map(math.isnan, answer if isinstance(answer, tuple) else (answer,)))


def test_a_choice_without_a_function_is_an_error_by_its_name():
    class Forgetful(Family, key="water.drag"):
        KNOWN = (0, "known", Drag.RE_2.function, "a law")
        FORGOTTEN = (1, "forgotten", None, "no law")

    with pytest.raises(TypeError, match=r"Forgetful.FORGOTTEN \('forgotten'\)"):
        build_dispatch(Forgetful, ("re",))
    with pytest.raises(TypeError, match="asks for 're'; its family is given slip"):
        build_dispatch(Forgetful, ("slip",), unasked=(Forgetful.FORGOTTEN,))
    with pytest.raises(TypeError, match="no choice of Forgetful is marked 'total'"):
        marked(Forgetful, "total")


def test_no_two_choices_have_the_same_number():
    with pytest.raises(ValueError, match="Twice: 'two' = 0, the number of ONE; take one above all others"):

        class Twice(Family):
            ONE = (0, "one", None, "first")
            TWO = (0, "two", None, "second")


def test_every_family_is_in_the_table():
    made = [one for one in vars(families).values() if isinstance(one, type) and issubclass(one, Family)]
    assert set(FAMILIES) == {one for one in made if one is not Family}


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.__name__)
def test_every_family_is_a_key_of_the_case_file_with_its_words_in_the_schema(family):
    assert family.key in all_keys()
    for choice in family:
        assert choice.about
        if choice.word:
            assert family.of(choice.word) is choice
            assert f'"{choice.word}"' in json_schema_text()
    with pytest.raises(ValueError, match="is none of"):
        family.of("no such word")


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.__name__)
def test_a_key_that_a_choice_takes_is_a_key_of_its_section(family):
    section = family.key.rsplit(".", 1)[0]
    for key in family.all_takes():
        assert {f"{section}.{key}", f"water.{key}"} & set(all_keys()), key


def test_a_scene_with_an_unknown_number_is_refused_by_name():
    made, _ = scene([[0.0, 0.0, 0.01]], 0.002, water=Water(drag=99))  # type: ignore[arg-type]
    assert any(reason.startswith("water.drag: number 99 is none of 0 (none)") for reason in refusals(made))


def test_from_python_a_law_takes_what_its_parameters_name():
    assert evaluate(Drag.CONSTANT, re=10.0, c_d=0.7) == 0.7
    with pytest.raises(TypeError, match="asks for 'c_d'"):
        evaluate(Drag.CONSTANT, re=10.0)
