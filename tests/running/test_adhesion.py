"""Runs of grains that stick: recorded forces, stopped and resumed with the same bits."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.casefile.read import read
from ryusa.laws.families import Adhesion
from ryusa.measure.contact_network import contact_network
from ryusa.results import Results, schema

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

pytestmark = pytest.mark.full

CASE = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
mixture = { clay = 0.4 }
[materials.clay]
work_of_adhesion = "1 J/m2"
[[pairs]]
materials = ["grains", "clay"]
work_of_adhesion = "0.3 J/m2"
[contact]
law = "Hertz-Mindlin"
youngs_modulus = "5 MPa"
friction = 0.5
restitution = 0.7
adhesion = "DMT"
work_of_adhesion = "0.1 J/m2"
[rolling]
model = "constant"
coefficient = 0.05
[motion]
plane = false
rotation = "free"
[build]
kind = "fill"
low = ["0.2 cm", "0.2 cm", "0.2 cm"]
high = ["1 cm", "1 cm", "1 cm"]
[[planes]]
name = "floor"
point = ["0 m", "0 m", "0 m"]
normal = [0, 0, 1]
[[exits]]
name = "hole"
low = ["0.2 cm", "0.2 cm", "0 cm"]
high = ["0.5 cm", "0.5 cm", "0.3 cm"]
[stop]
time = "0.06 s"
[record]
frames = "0.01 s"
forces = true
"""


def case_in(folder: Path) -> Path:
    (folder / "case.toml").write_text(CASE)
    return folder / "case.toml"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Results:
    folder = tmp_path_factory.mktemp("adhesion")
    return ryusa.run(read(case_in(folder)), folder / "run", progress=False, threads=2)


def test_the_account_closes_and_grains_that_leave_take_their_attraction_along(whole: Results) -> None:
    assert whole.summary["energy"]["residual"] < 1e-3
    assert whole.summary["restitution"]["adhesion"]
    made = whole.scene.materials
    assert made is not None
    assert {one.adhesion for one in made.contact} == {Adhesion.DMT}
    assert [one.adhesion_amount for one in made.contact] == [0.1, 0.3, 0.3, 1.0]


def test_recorded_forces_hold_the_attraction(whole: Results) -> None:
    held = whole.contact_forces(len(whole.frames.t) - 1)
    pull = np.concatenate([contact_network(whole, lane=k).f_n for k in range(contact_network(whole).slices)])
    assert len(pull) == len(held)
    assert pull.min() < 0.0 < pull.max()  # some contacts pull, others push
    forces = np.zeros((whole.scene.n_grain + 1, 3))
    np.add.at(forces, held["i"], held["force"])
    free = held["j"] < whole.scene.n_grain
    np.add.at(forces, held["j"][free], -held["force"][free])
    x, v = (getattr(whole.frames, name)[-1] for name in ("x", "v"))
    there = np.isfinite(x[:, 0])
    weight = float(whole.scene.m[there].sum()) * 9.80665
    assert abs(forces[:-1][there].sum(axis=0)[2] - weight) < 0.5 * weight  # nearly at rest on the floor
    assert np.abs(v[there]).max() < 0.3


def test_a_stopped_run_of_grains_that_stick_resumes_with_the_same_bits(
    whole: Results, tmp_path: Path, stop_at: Any
) -> None:
    path = case_in(tmp_path)
    stop_at(round(0.55 * whole.summary["steps"]))
    assert ryusa.run(read(path), tmp_path / "run", progress=False).status == schema.STOPPED
    again = read(tmp_path / "run" / schema.CASE_TOML)
    assert ryusa.run(again, tmp_path / "run", progress=False, resume=True).status == schema.COMPLETE
    assert differences(whole.folder, tmp_path / "run") == []
