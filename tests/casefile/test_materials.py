"""[materials.NAME] and [[pairs]] of the case file: what they become, and what bad ones get."""

import math
from typing import Any

import numpy as np
import pytest

from ryusa.build import build
from ryusa.casefile.derive import derive
from ryusa.casefile.explain import explain
from ryusa.casefile.materials.values import case_of_pair, meeting
from ryusa.casefile.read import json_schema, read_text
from ryusa.casefile.resolved import resolved
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.errors import CaseError
from ryusa.laws.hertz import effective_modulus
from ryusa.results.scene_file import scene_digest

PLAIN = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
[contact]
stiffness = "1e4 N/m"
friction = 0.5
restitution = 0.7
[motion]
plane = false
rotation = "free"
[build]
kind = "fill"
low = ["0 cm", "0 cm", "0 cm"]
high = ["1 cm", "1 cm", "1 cm"]
[[planes]]
name = "floor"
point = ["0 m", "0 m", "0 m"]
normal = [0, 0, 1]
[[walls]]
name = "lid"
shape = "disc"
at = ["0.5 cm", "0.5 cm", "2 cm"]
normal = [0, 0, 1]
radius = "2 cm"
[stop]
time = "0.01 s"
[record]
frames = "0.005 s"
"""
MATERIALS = """
[materials.glass]
density = "2000 kg/m3"
friction = 0.2
[materials.steel]
[[pairs]]
materials = ["glass", "grains"]
friction = 0.3
restitution = 0.6
[[pairs]]
materials = ["grains", "steel"]
friction = 0.1
[[pairs]]
materials = ["steel", "glass"]
friction_angle = "10 deg"
restitution = 0.9
"""
TEXT = (PLAIN + MATERIALS).replace('density = "2650', 'mixture = { glass = 0.25 }\ndensity = "2650', 1)
TEXT = TEXT.replace("normal = [0, 0, 1]\n[[walls]]", 'normal = [0, 0, 1]\nmaterial = "steel"\n[[walls]]')
TEXT = TEXT.replace('radius = "2 cm"', 'radius = "2 cm"\nmaterial = "glass"')
SPRINGS = 'stiffness = "1e4 N/m"'
ELASTIC = 'law = "Hertz-Mindlin"\nyoungs_modulus = "50 MPa"\npoisson_ratio = 0.3\nexpected_speed = "0.5 m/s"'


def changed(*pairs: tuple[str, str], text: str = TEXT) -> Any:
    for old, new in pairs:
        assert text.count(old) >= 1, old
        text = text.replace(old, new, 1)
    return read_text(text)


def test_grains_planes_and_walls_get_their_materials() -> None:
    scene = build(read_text(TEXT)).scene
    made = scene.materials
    assert made is not None
    assert made.names == ("grains", "glass", "steel")
    n = scene.n_grain
    assert np.bincount(made.of[:n]).tolist() == [n - round(0.25 * n), round(0.25 * n)]
    assert made.of[scene.n_grain :].tolist() == [2, 1]
    np.testing.assert_allclose(
        scene.m / scene.d**3 * 6.0 / math.pi, np.where(made.of[: scene.n_grain] == 1, 2000.0, 2650.0)
    )
    mu = [law.mu for law in made.contact]
    assert mu[:5] == [0.5, 0.3, 0.1, 0.3, 0.2]
    assert mu[5] == mu[7] == pytest.approx(math.tan(math.radians(10.0)))
    e = [law.e_n for law in made.contact]
    assert e[:8] == [0.7, 0.6, 0.7, 0.6, 0.7, 0.9, 0.7, 0.9]
    assert CpuEngine().refuses(scene) == ()


def test_without_materials_nothing_changes() -> None:
    case = read_text(PLAIN)
    assert build(case).scene.materials is None
    data = resolved(case)
    assert not {"materials", "pairs"} & set(data)
    assert "material" not in data["planes"][0]
    assert "mixture" not in data["grains"]


def test_the_check_lists_each_pair_that_meets() -> None:
    rows = {row.name: row for row in explain(read_text(TEXT)) if row.section == "materials"}
    assert rows["glass on steel"].shown.startswith("mu 0.1763, e 0.9")
    assert rows["grains on glass"].origin == "pairs.0"
    assert "steel on steel" not in rows
    assert set(meeting(read_text(TEXT))) == {
        ("grains", "grains"),
        ("grains", "glass"),
        ("grains", "steel"),
        ("glass", "glass"),
        ("glass", "steel"),
    }


def test_the_step_follows_the_lightest_and_stiffest_pair() -> None:
    plain, light = derive(read_text(PLAIN)), derive(read_text(TEXT))
    assert light.shortest < plain.shortest
    heavier = derive(changed(('density = "2000 kg/m3"', 'density = "8000 kg/m3"')))
    assert heavier.shortest == pytest.approx(plain.shortest, rel=1e-12)
    stiff = derive(changed(('density = "2000 kg/m3"', 'stiffness = "4e4 N/m"')))
    assert stiff.shortest == pytest.approx(0.5 * plain.shortest, rel=1e-12)
    assert stiff.dt == pytest.approx(0.5 * plain.dt, rel=1e-12)


def test_two_stiffnesses_are_springs_in_series() -> None:
    case = changed(('density = "2000 kg/m3"', 'stiffness = "4e4 N/m"'))
    made = build(case).scene.materials
    assert made is not None
    assert [law.k_n for law in made.contact[:5]] == pytest.approx([1e4, 1.6e4, 1e4, 1.6e4, 4e4])
    assert made.contact[1].k_s == pytest.approx(1.6e4 * 2.0 / 7.0)


def test_two_moduli_combine_as_hertz_has_it() -> None:
    steel = '[materials.steel]\nyoungs_modulus = "200 MPa"\npoisson_ratio = 0.1'
    case = changed((SPRINGS, ELASTIC), ("[materials.steel]", steel))
    made = build(case).scene.materials
    assert made is not None
    law = made.contact[2]
    expected = 1.0 / ((1.0 - 0.3**2) / 5e7 + (1.0 - 0.1**2) / 2e8)
    assert effective_modulus(law.youngs_modulus, law.poisson_ratio) == pytest.approx(expected, rel=1e-12)
    assert 0.1 < law.poisson_ratio < 0.3


def test_the_effective_mass_of_a_pair_is_that_of_its_two_densities() -> None:
    case = read_text(TEXT)
    pair = case_of_pair(case, "grains", "glass")
    assert 0.5 * pair.grains.density == pytest.approx(1.0 / (1.0 / 2650.0 + 1.0 / 2000.0))


def test_feeds_bring_grains_of_their_material() -> None:
    feed = """
[[feeds]]
name = "tap"
material = "glass"
low = ["0 cm", "0 cm", "3 cm"]
high = ["1 cm", "1 cm", "4 cm"]
rate = "0.01 kg/s"
"""
    case = read_text(TEXT.replace("[stop]", feed + "[stop]"))
    scene = build(case).scene
    assert scene.materials is not None
    assert scene.traffic is not None
    first = scene.traffic.n_first
    assert set(scene.materials.of[first : scene.n_grain].tolist()) == {1}
    fed = scene.m[first:].sum()
    assert fed == pytest.approx(0.01 * 0.01, abs=scene.m[-1])


def test_the_schema_knows_materials() -> None:
    assert "additionalProperties" in json_schema()["properties"]["materials"]


def test_a_scene_of_one_material_keeps_its_digest() -> None:
    one, other = build(read_text(PLAIN)).scene, build(read_text(PLAIN)).scene
    assert scene_digest(one) == scene_digest(other)
    assert scene_digest(build(read_text(TEXT)).scene) != scene_digest(one)


PAIR = '[[pairs]]\nmaterials = ["glass", "grains"]\nfriction = 0.3\nrestitution = 0.6\n'
BAD = {
    "planes.0.material: unknown": (('material = "steel"', 'material = "stel"'), "Did you mean 'steel'"),
    "materials.steel: never used": (('material = "steel"\n', ""), "materials.steel: is never used"),
    "a pair given twice": ((PAIR, PAIR + PAIR), "pairs.1.materials = ['glass', 'grains']: is given twice"),
    "a pair of one": (('["glass", "grains"]', '["glass", "glass"]'), "is one material"),
    "an unknown pair": (('["glass", "grains"]', '["glas", "grains"]'), "Did you mean 'glass'"),
    "a pair that is missing": ((PAIR, ""), "pairs (grains, glass): friction: missing"),
    "a value that is missing": (
        ("friction = 0.3\n", ""),
        "pairs.0.friction: missing; grains has 0.5 and glass 0.2",
    ),
    "two frictions": (
        ("friction = 0.2", 'friction = 0.2\nfriction_angle = "9 deg"'),
        "materials.glass.friction: excludes",
    ),
    "an unknown key": (("friction = 0.2", "frition = 0.2"), "Did you mean 'materials.glass.friction'"),
    "grains twice": (("[materials.steel]", "[materials.grains]"), "materials.grains: is what [grains]"),
    "a modulus of springs": (
        ("friction = 0.2", 'youngs_modulus = "1 MPa"'),
        "materials.glass.youngs_modulus",
    ),
    "a stiffness of spheres": (
        (SPRINGS, ELASTIC),
        ("friction = 0.2", 'friction = 0.2\nstiffness = "1 N/m"'),
        "materials.glass.stiffness",
    ),
    "a stiffness at steps": (
        (SPRINGS, SPRINGS + '\ntiming = "at steps"'),
        ("friction = 0.2", 'friction = 0.2\nstiffness = "1e4 N/m"'),
        "needs contact.timing = 'exact'",
    ),
    "rolling without a model": (
        ("friction = 0.2", "friction = 0.2\nrolling_coefficient = 0.1"),
        "rolling.model = 'none'",
    ),
    "shares beyond one": (("glass = 0.25", "glass = 0.7, steel = 0.4"), "sum to 1.1"),
    "a density of a wall": (
        ("[materials.steel]", '[materials.steel]\ndensity = "1 g/cm3"'),
        "materials.steel.density",
    ),
    "constant dashpots": (("restitution = 0.7", 'damping = "0.1 N s/m"'), "contact.damping"),
    "friction of the timeline": (
        ("[stop]", '[[timeline]]\nat = "1 ms"\nfriction = 0.1\n[stop]'),
        "timeline.0.friction = 0.1: cannot be used",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_materials_are_named(name: str) -> None:
    *pairs, message = BAD[name]
    with pytest.raises(CaseError) as found:
        changed(*pairs)  # type: ignore[arg-type]
    assert message in str(found.value)


def test_a_material_without_the_table_is_named() -> None:
    with pytest.raises(CaseError, match=r"planes\.0\.material = 'steel': is no material"):
        read_text(PLAIN.replace("normal = [0, 0, 1]", 'normal = [0, 0, 1]\nmaterial = "steel"', 1))
