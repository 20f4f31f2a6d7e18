"""Grains of a table that are of several materials, by their groups."""

from pathlib import Path

import numpy as np
import pytest

from ryusa.build import build
from ryusa.casefile import read
from ryusa.errors import CaseError

TABLE = """x [mm],y [mm],z [mm],d [mm],vz [m/s],group
0,0,1.1,2,0,
5,0,1.1,2,0,
0,0,20,10,-2,ball
10,0,1.6,3,0,stone
"""
CASE = """
[grains]
diameter = "2 mm"
density = "2500 kg/m3"
[contact]
law = "Hertz-Mindlin"
youngs_modulus = "1e8 Pa"
poisson_ratio = 0.2
restitution = 0.5
friction = 0.3
expected_speed = "1 m/s"
[motion]
rotation = "free"
plane = false
[materials.steel]
density = "7200 kg/m3"
youngs_modulus = "210e9 Pa"
poisson_ratio = 0.2
[[pairs]]
materials = ["grains", "steel"]
friction = 0.2
restitution = 0.4
[[planes]]
name = "floor"
point = ["0 m", "0 m", "0 m"]
normal = [0, 0, 1]
material = "steel"
[build]
kind = "table"
file = "grains.csv"
made_of = { ball = "steel" }
[stop]
time = "1 ms"
"""


def case_in(folder: Path, text: str = CASE):
    (folder / "grains.csv").write_text(TABLE, encoding="utf-8")
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return read(path)


def test_a_group_of_a_table_is_of_its_material(tmp_path: Path) -> None:
    scene = build(case_in(tmp_path)).scene
    first, end = scene.groups["ball"]
    steel = np.arange(scene.n_grain) == first
    assert end == first + 1
    assert scene.materials is not None
    assert (np.asarray(scene.materials.of[: scene.n_grain]) == 1).tolist() == steel.tolist()
    density = scene.m / (np.pi / 6.0 * scene.d**3)
    assert density == pytest.approx(np.where(steel, 7200.0, 2500.0))


def test_the_step_follows_from_the_sizes_that_the_material_has(tmp_path: Path) -> None:
    """A large ball of steel is not taken for steel of the smallest grain, whose contact is far shorter."""
    large = build(case_in(tmp_path)).scene.dt
    text = CASE.replace('made_of = { ball = "steel" }', 'made_of = { stone = "steel" }')
    small = build(case_in(tmp_path, text)).scene.dt
    assert large > 2.0 * small


@pytest.mark.parametrize(
    ("made_of", "part"),
    [
        ('{ bal = "steel" }', r"build\.made_of\.bal: is no group of free grains .* ball, stone"),
        ('{ ball = "stell" }', r"build\.made_of\.ball = 'stell': must be a material"),
    ],
)
def test_what_is_misspelt_is_named(tmp_path: Path, made_of: str, part: str) -> None:
    with pytest.raises(CaseError, match=part):
        build(case_in(tmp_path, CASE.replace('{ ball = "steel" }', made_of)))


def test_a_mixture_beside_it_is_refused(tmp_path: Path) -> None:
    text = CASE.replace('density = "2500 kg/m3"', 'density = "2500 kg/m3"\nmixture = { steel = 0.2 }')
    with pytest.raises(CaseError, match=r"grains\.mixture: excludes build\.made_of"):
        case_in(tmp_path, text)
