"""Messages about mistakes that others have reported: the cause is named, not a symptom."""

import pytest

from ryusa.build import build
from ryusa.casefile.read import read
from ryusa.errors import CaseError

CASE = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
[contact]
{law}
restitution = 0.7
friction = 0.3
[motion]
rotation = "free"
plane = false
[build]
kind = "table"
file = "g.csv"
[[planes]]
name = "floor"
point = ["0 m", "0 m", "0 m"]
normal = {normal}
[stop]
time = "10 ms"
[record]
frames = "0.1 ms"
"""
STIFF = 'stiffness = "100 N/cm"'


def case_of(tmp_path, law=STIFF, normal="[0, 0, 1]", grains="0,0,20,2\n5,0,20,2"):
    (tmp_path / "g.csv").write_text(f"x [mm],y [mm],z [mm],d [mm]\n{grains}\n")
    (tmp_path / "case.toml").write_text(CASE.format(law=law, normal=normal))
    return tmp_path / "case.toml"


@pytest.mark.parametrize("grains", ["0,0,20,2\n5,0,20,2", "0,0,20,2", "0,0,3,2\n5,0,90,4"])
def test_a_plane_whose_normal_points_the_wrong_way_is_named(tmp_path, grains):
    with pytest.raises(
        CaseError, match="'floor': its normal points into the room of the grains; turn it round"
    ):
        build(read(case_of(tmp_path, normal="[0, 0, -1]", grains=grains)))


def test_a_grain_that_does_overlap_is_still_named(tmp_path):
    with pytest.raises(CaseError, match=r"first grains overlap: .* by 0\.25 d"):
        build(read(case_of(tmp_path, grains="0,0,0.5,2\n5,0,20,2")))


@pytest.mark.parametrize(
    ("law", "key"),
    [
        ('stiffness = "1e-6 N/m"', r"contact\.stiffness"),
        ('stiffness = "1e-9 N/cm"', r"contact\.stiffness"),
        ('law = "Hertz-Mindlin"\nyoungs_modulus = "1 Pa"', r"contact\.youngs_modulus"),
    ],
)
def test_a_very_soft_spring_blames_itself(tmp_path, law, key):
    with pytest.raises(CaseError, match=f"{key}.*so small that the shortest contact lasts"):
        read(case_of(tmp_path, law=law))
