"""[shapes] of a run: the spheres of its clumps are in its folder."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

import ryusa
from ryusa.build import build
from ryusa.casefile import forms
from ryusa.casefile.read import read
from ryusa.casefile.resolved import resolved
from ryusa.results import schema

PLAIN = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
shape = { crushed = 0.5, shingle = 0.25 }
[shapes.crushed]
file = "crushed.stl"
spheres = 9
[shapes.shingle]
elongation = 0.7
flatness = 1
spheres = 4
[contact]
stiffness = "1e4 N/m"
friction = 0.5
restitution = 0.7
[motion]
plane = false
rotation = "free"
[build]
kind = "box"
columns = 4
rows = 3
layers = 2
floor = "plane"
[stop]
time = "0.002 s"
[record]
frames = "1 ms"
"""


def test_a_run_keeps_its_spheres_whatever_becomes_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    trimesh.creation.box((70.0, 70.0, 70.0)).export(tmp_path / "crushed.stl")
    (tmp_path / "case.toml").write_text(PLAIN)
    case = read(tmp_path / "case.toml")
    run = ryusa.run(case, tmp_path / "run", progress=False)
    kept = json.loads((run.folder / schema.CASE_JSON).read_text())["shapes"]["crushed"]["made_of"]
    assert len(kept) == 9
    trimesh.creation.icosphere().export(run.folder / "crushed.stl")
    monkeypatch.setattr(forms, "fill_mesh", None)  # nothing is filled again
    again = read(run.folder / schema.CASE_TOML)
    assert resolved(again)["shapes"]["crushed"]["made_of"] == kept
    made, first = build(again).scene.bodies, run.scene.bodies
    assert made is not None
    assert first is not None
    assert np.array_equal(made.arm, first.arm)
    with pytest.raises(TypeError):  # other keys make another body
        read(run.folder / schema.CASE_TOML, {"shapes.crushed.spheres": "4"})
