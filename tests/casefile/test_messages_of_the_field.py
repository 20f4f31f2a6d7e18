"""Messages about mistakes that others have reported: the cause is named, not a symptom."""

import pytest

from ryusa.build import build
from ryusa.casefile.read import read
from ryusa.cases import case_path
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


@pytest.mark.parametrize("stiffness", ["0.01 N/m", "{ collision_time = '0.1 s' }"])
def test_grains_that_would_pass_through_one_another_are_refused(stiffness):
    with pytest.raises(CaseError, match=r"contact\.stiffness.*overlap by .* diameters and pass through"):
        read(case_path("movable_bed.toml"), {"contact.stiffness": stiffness})


def test_single_drops_may_be_as_soft_as_a_study_asks():
    soft = {"contact.stiffness": "0.001 N/cm", "record.frames": "50 ms", "stop.time": "2 s"}
    assert read(case_path("drop.toml"), soft).build.kind == "drop"


def test_contacts_too_long_for_frames_are_judged_by_the_step():
    changes = {"contact.stiffness": "0.01 N/m", "record.frames": "1 ms"}
    with pytest.raises(
        CaseError, match=r"lasts 0\.064 s and a step 0\.0064 s, longer than record\.frames, 0\.001 s"
    ):
        read(case_path("movable_bed.toml"), changes)
