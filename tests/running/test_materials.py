"""Runs with several materials: stopped and resumed with the same bits, with a feed."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.casefile.read import read
from ryusa.results import Results, schema

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

pytestmark = pytest.mark.full

CASE = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
mixture = { glass = 0.3 }
[materials.glass]
density = "2000 kg/m3"
friction = 0.2
stiffness = "4e3 N/m"
[materials.steel]
[[pairs]]
materials = ["glass", "grains"]
friction = 0.3
[[pairs]]
materials = ["grains", "steel"]
friction = 0.1
restitution = 0.9
rolling_coefficient = 0.02
[[pairs]]
materials = ["glass", "steel"]
friction = 0.15
restitution = 0.5
[contact]
stiffness = "2e3 N/m"
friction = 0.5
restitution = 0.7
[rolling]
model = "spring-dashpot-slider"
coefficient = 0.1
[motion]
plane = false
rotation = "free"
[build]
kind = "fill"
low = ["0 cm", "0 cm", "0.2 cm"]
high = ["1 cm", "1 cm", "1 cm"]
[[planes]]
name = "floor"
point = ["0 m", "0 m", "0 m"]
normal = [0, 0, 1]
material = "steel"
[[walls]]
name = "tube"
shape = "cylinder"
at = ["0.5 cm", "0.5 cm", "-1 cm"]
axis = ["0 cm", "0 cm", "6 cm"]
radius = "0.9 cm"
material = "glass"
[[feeds]]
name = "tap"
low = ["0.3 cm", "0.3 cm", "2 cm"]
high = ["0.7 cm", "0.7 cm", "3 cm"]
rate = "300 grains/s"
material = "glass"
[stop]
time = "0.08 s"
[record]
frames = "0.01 s"
"""


def case_in(folder: Path) -> Path:
    (folder / "case.toml").write_text(CASE)
    return folder / "case.toml"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Results:
    folder = tmp_path_factory.mktemp("materials")
    return ryusa.run(read(case_in(folder)), folder / "run", progress=False, threads=2)


def test_the_account_closes_with_materials_feeds_and_walls(whole: Results) -> None:
    assert len(whole.contacts) > 0
    assert whole.summary["energy"]["residual"] < 1e-3
    assert whole.scene.materials is not None
    assert whole.scene.materials.names == ("grains", "glass", "steel")
    assert whole.summary["restitution"]["by_pair"]


def test_a_stopped_run_of_several_materials_resumes_with_the_same_bits(
    whole: Results, tmp_path: Path, stop_at: Any
) -> None:
    path = case_in(tmp_path)
    stop_at(round(0.55 * whole.summary["steps"]))
    assert ryusa.run(read(path), tmp_path / "run", progress=False).status == schema.STOPPED
    again = read(tmp_path / "run" / schema.CASE_TOML)
    assert ryusa.run(again, tmp_path / "run", progress=False, resume=True).status == schema.COMPLETE
    assert differences(whole.folder, tmp_path / "run") == []


def test_contacts_are_held_against_the_law_of_their_pair(whole: Results) -> None:
    made, scene = whole.scene.materials, whole.scene
    assert made is not None
    found = ryusa.measure.collisions(whole, slowest=0.1)  # gravity acts on slower ones
    alone = (found.events["alone"] > 0.0) & (found.events["j"] == scene.n_grain)  # on the floor
    for name, e in ((0, 0.9), (1, 0.5)):
        mine = alone & (made.of[found.events["i"]] == name)
        assert mine.sum() > 10
        assert np.nanmedian(found.restitution[mine]) == pytest.approx(e, abs=0.006)
