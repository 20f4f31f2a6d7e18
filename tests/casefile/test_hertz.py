"""Elastic spheres in a case file: keys, what follows from them, and what is refused by name."""

import pytest

from ryusa.build import build
from ryusa.casefile.case import Case
from ryusa.casefile.contact.speed import expected_speed
from ryusa.casefile.contact.values import largest_overlap
from ryusa.casefile.derive import derive
from ryusa.casefile.explain import explain
from ryusa.casefile.read import read
from ryusa.casefile.resolved import resolved
from ryusa.cases import case_path
from ryusa.errors import CaseError
from ryusa.laws import hertz
from ryusa.laws.families import ContactForce, ContactTiming

ELASTIC = {"contact.law": "Hertz-Mindlin", "contact.youngs_modulus": "200 MPa"}


def elastic(name: str = "box", **more: str) -> Case:
    keys = {key.replace("__", "."): value for key, value in more.items()}
    return read(case_path(f"{name}.toml"), {**ELASTIC, **keys})


def test_a_case_becomes_the_law_of_its_scene() -> None:
    case = elastic("heap", contact__expected_speed="0.3 m/s", contact__poisson_ratio="0.3")
    law = build(case).scene.contact
    assert law.force is ContactForce.HERTZ_MINDLIN
    assert law.timing is ContactTiming.AT_STEPS
    assert (law.youngs_modulus, law.poisson_ratio, law.speed) == (2.0e8, 0.3, 0.3)
    assert not law.tension
    assert build(elastic("heap", contact__damping_law="Tsuji")).scene.contact.tension


def test_the_step_is_a_fraction_of_hertzs_contact_time_at_the_expected_speed() -> None:
    case = elastic("drop", contact__expected_speed="0.3 m/s")
    found = derive(case)
    stiff = hertz.hertz_stiffness(hertz.effective_modulus(2.0e8, 0.25), 0.5 * found.d_min)
    wall = hertz.contact_time_hertz(0.3, found.m + found.m_added, stiff, found.fixed.zeta_n, False)
    if not found.meet:
        assert found.shortest == pytest.approx(wall, rel=1e-12)
    slow = derive(elastic("drop", contact__expected_speed="0.03 m/s"))
    assert slow.shortest / found.shortest == pytest.approx(10.0**0.2, rel=1e-12)


def test_either_law_names_the_stiffness_of_the_other() -> None:
    # the linear stiffness of the same overlap, taken for the stiffness, asks for the same modulus again
    case = elastic("heap")
    rows = {row.name: row for row in explain(case)}
    k_n = float(rows["k_n of the same overlap"].value)
    linear = read(case_path("heap.toml"), {"contact.stiffness": f"{k_n!r} N/m"})
    back = {row.name: row for row in explain(linear)}
    assert float(back["E of the same overlap"].value) == pytest.approx(2.0e8, rel=1e-9)
    speed = expected_speed(case)[0]
    assert largest_overlap(linear, speed) == pytest.approx(largest_overlap(case, speed), rel=1e-9)
    k_n = float(rows["k_n of the same contact time"].value)
    linear = read(case_path("heap.toml"), {"contact.stiffness": f"{k_n!r} N/m"})
    back = {row.name: row for row in explain(linear)}
    assert float(back["E of the same contact time"].value) == pytest.approx(2.0e8, rel=1e-9)


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ({"contact__timing": "exact"}, r"contact\.timing = 'exact': must be 'at steps'"),
        ({"contact__parting": "tension"}, r"contact\.parting = 'tension': has no effect with law 'Hertz-"),
        ({"contact__shear_ratio": "0.3"}, r"contact\.shear_ratio = 0\.3: has no effect"),
        ({"contact__stiffness": "1 N/cm"}, r"contact\.stiffness: excludes --set contact\.youngs_modulus"),
        ({"contact__poisson_ratio": "0.6"}, r"contact\.poisson_ratio = 0\.6: must be at most 0\.5"),
        ({"motion__gravity": "0 m/s2"}, r"contact\.expected_speed: missing"),
        ({"contact__damping_law": "Tsuij"}, "Did you mean 'Tsuji'"),
    ],
)  # fmt: skip
def test_what_elastic_spheres_cannot_have_is_refused_by_name(keys: dict[str, str], says: str) -> None:
    with pytest.raises(CaseError, match=says):
        elastic("heap", **keys)


@pytest.mark.parametrize(
    "key", ["youngs_modulus", "poisson_ratio", "damping_law", "unloading", "expected_speed"]
)
def test_linear_springs_take_no_key_of_elastic_spheres(key: str) -> None:
    value = {"youngs_modulus": "1 MPa", "poisson_ratio": "0.3", "damping_law": "Tsuji", "unloading": "plain"}
    with pytest.raises(CaseError, match=rf"contact\.{key}.*has no effect with law 'linear'"):
        read(case_path("heap.toml"), {f"contact.{key}": value.get(key, "1 m/s")})


def test_a_resolved_case_says_what_was_left_open() -> None:
    data = resolved(elastic("heap"))["contact"]
    assert data["timing"] == "at steps"
    assert data["expected_speed"] > 0.0
    assert data["stiffness"] is None
    assert resolved(read(case_path("heap.toml")))["contact"]["timing"] == "exact"
