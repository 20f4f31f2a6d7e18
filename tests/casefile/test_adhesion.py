"""Adhesion in a case file: keys, what follows from them, and what is refused by name."""

import math
from pathlib import Path

import pytest

from ryusa.build import build
from ryusa.casefile.case import Case
from ryusa.casefile.derive import derive
from ryusa.casefile.explain import explain
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.errors import CaseError
from ryusa.laws.adhesion import sticking_speed
from ryusa.laws.families import Adhesion, ContactTiming

DMT = {"contact.adhesion": "DMT", "contact.work_of_adhesion": "50 mN/m"}
ELASTIC = {"contact.law": "Hertz-Mindlin", "contact.youngs_modulus": "20 MPa"}
AREA = {"contact.adhesion": "contact area", "contact.adhesion_density": "1e5 J/m3"}


def sticky(name: str = "box", keys: dict[str, str] | None = None) -> Case:
    return read(case_path(f"{name}.toml"), DMT if keys is None else keys)


def test_a_case_becomes_the_law_of_its_scene() -> None:
    law = build(sticky()).scene.contact
    assert (law.adhesion, law.adhesion_amount) == (Adhesion.DMT, 0.05)
    assert law.timing is ContactTiming.AT_STEPS
    law = build(sticky(keys={**ELASTIC, **AREA})).scene.contact
    assert (law.adhesion, law.adhesion_amount) == (Adhesion.CONTACT_AREA, 1.0e5)
    plain = build(read(case_path("box.toml"))).scene.contact
    assert (plain.adhesion, plain.timing) == (Adhesion.NONE, ContactTiming.EXACT)


def test_check_prints_what_adhesion_does() -> None:
    case = sticky()
    rows, found = {row.name: row for row in explain(case)}, derive(case)
    pull = 2.0 * math.pi * 0.05 * 0.25 * found.d
    assert float(rows["pull-off force"].value) == pytest.approx(pull)
    assert float(rows["Bond number"].value) == pytest.approx(pull / (found.m * found.g))
    assert float(rows["overlap/d by adhesion"].value) == pytest.approx(pull / found.k_n / found.d)
    assert float(rows["shear strength without load"].value) == pytest.approx(found.mu * pull)
    stick = sticking_speed(pull, found.fixed.m, found.k_n, found.fixed.zeta_n, False)
    assert float(rows["sticking speed"].value) == pytest.approx(stick)
    none = {row.name for row in explain(read(case_path("box.toml")))}
    assert "Bond number" not in none


def test_a_contact_so_soft_that_adhesion_presses_it_flat_is_marked() -> None:
    rows = {row.name: row for row in explain(sticky(keys={**DMT, "contact.work_of_adhesion": "1e3 J/m2"}))}
    assert rows["overlap/d by adhesion"].flag == "warning"
    assert "take a larger k_n" in rows["overlap/d by adhesion"].origin
    assert rows["largest overlap/d"].flag == "warning"  # an impact overlaps by as much, and more


def test_elastic_spheres_that_attract_each_other_strongly_get_a_smaller_step() -> None:
    weak, strong = (
        derive(sticky("heap", {**ELASTIC, **DMT, "contact.work_of_adhesion": f"{w} J/m2"}))
        for w in ("1e-6", "100")
    )
    plain = derive(sticky("heap", ELASTIC))
    assert weak.shortest == pytest.approx(plain.shortest, rel=1e-4)
    assert strong.shortest < 0.9 * plain.shortest


@pytest.mark.parametrize(
    ("keys", "key", "says"),
    [
        ({"contact.adhesion": "DMT"}, "contact.work_of_adhesion", "adhesion 'DMT' needs it"),
        ({"contact.adhesion": "constant"}, "contact.pull_off_force", "adhesion 'constant' needs it"),
        (AREA, "contact.adhesion", "needs law 'Hertz-Mindlin', whose contacts have an area"),
        ({**DMT, "contact.timing": "exact"}, "contact.timing", "must be 'at steps'"),
        ({"contact.pull_off_force": "1 mN"}, "contact.pull_off_force", "with adhesion 'none'"),
        ({**DMT, "contact.pull_off_force": "1 mN"}, "contact.pull_off_force", "with adhesion 'DMT'"),
        ({**DMT, "contact.work_of_adhesion": "1 N"}, "contact.work_of_adhesion", "wrong unit"),
        ({**DMT, "contact.work_of_adhesion": "-1 J/m2"}, "contact.work_of_adhesion", "must be at least 0"),
        ({"contact.adhesion": "JKR"}, "contact.adhesion", "'DMT'"),
    ],
)  # fmt: skip
def test_what_does_not_go_with_adhesion_is_refused_by_name(keys: dict[str, str], key: str, says: str) -> None:
    with pytest.raises(CaseError) as caught:
        sticky(keys=keys)
    text = str(caught.value)
    assert key in text
    assert says in text


MIXED = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
mixture = { clay = 0.5 }
[materials.clay]
work_of_adhesion = "0.2 J/m2"
[contact]
stiffness = "1e4 N/m"
restitution = 0.7
friction = 0.5
adhesion = "DMT"
work_of_adhesion = "0.05 J/m2"
[motion]
rotation = "free"
plane = false
[build]
kind = "packing"
columns = 4
rows = 4
layers = 2
[stop]
time = "0.1 s"
[record]
frames = "0.1 s"
"""
PAIR = '[[pairs]]\nmaterials = ["grains", "clay"]\nwork_of_adhesion = "0.08 J/m2"\n'


def test_adhesion_of_two_materials_is_asked_for_where_it_differs(tmp_path: Path) -> None:
    path = tmp_path / "mixed.toml"
    path.write_text(MIXED)
    with pytest.raises(CaseError, match=r"work_of_adhesion.*no law mixes them"):
        read(path)
    path.write_text(MIXED + PAIR)
    made = build(read(path)).scene.materials
    assert made is not None
    assert [one.adhesion_amount for one in made.contact] == [0.05, 0.08, 0.08, 0.2]
    rows = {row.name: row for row in explain(read(path))}
    assert "work_of_adhesion 0.08 J/m2" in rows["grains on clay"].shown
    path.write_text(MIXED.replace('adhesion = "DMT"\nwork_of_adhesion = "0.05 J/m2"\n', "") + PAIR)
    with pytest.raises(CaseError, match=r"materials.clay.work_of_adhesion.*no effect with contact.adhesion"):
        read(path)
