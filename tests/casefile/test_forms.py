"""[shapes] of the case file: clumps of a mesh or of ratios of axes, and bad ones."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from ryusa.build import build
from ryusa.casefile.explain import explain
from ryusa.casefile.read import read, read_text
from ryusa.errors import CaseError
from ryusa.running.case_files import files_beside

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
RATIOS = PLAIN.replace("{ crushed = 0.5, shingle = 0.25 }", '"shingle"').replace(
    '[shapes.crushed]\nfile = "crushed.stl"\nspheres = 9\n', ""
)


def with_mesh(folder: Path, mesh: trimesh.Trimesh, text: str = PLAIN) -> Path:
    mesh.export(folder / "crushed.stl")
    (folder / "case.toml").write_text(text)
    return folder / "case.toml"


def cube() -> trimesh.Trimesh:
    return trimesh.creation.box((70.0, 70.0, 70.0))


def test_clumps_of_a_mesh_and_of_ratios_are_built_and_their_likeness_is_stated(tmp_path: Path) -> None:
    case = read(with_mesh(tmp_path, cube()))
    bodies = build(case).scene.bodies
    assert bodies is not None
    assert bodies.names == ("crushed", "shingle")
    assert bodies.count.tolist().count(9) == 12
    assert bodies.d == pytest.approx(np.full(18, 0.002))
    rows = {row.name: row for row in explain(case)}
    cubes = rows["shape 'crushed': likeness"]
    assert cubes.value == "73.8 % filled"
    assert (
        "12 triangles; scaled to its volume, lengths of equal inertia off by -2.2, -2.2 and -2.2 %"
        in cubes.origin
    )
    made = rows["shape 'shingle': likeness"]
    assert made.value == "3 spheres"
    assert "b/a = 0.7" in made.origin
    assert "by calliper" in made.origin
    assert files_beside(case) == {"crushed.stl": tmp_path / "crushed.stl"}


def test_ratios_need_no_file() -> None:
    case = read_text(RATIOS)
    bodies = build(case).scene.bodies
    assert bodies is not None
    assert bodies.inertia[0, 1] == pytest.approx(bodies.inertia[0, 2], rel=1e-9)


BAD = [
    ("spheres = 4", "spheres = 65", "shapes.shingle.spheres"),
    ("spheres = 4", "spheres = 4\nfilled = 0.99", "3 spheres fill"),
    ("flatness = 1\n", "", "shapes.shingle.flatness"),
    ("flatness = 1\n", 'flatness = 1\nfile = "a.stl"\n', "excludes file"),
    ("elongation = 0.7\nflatness = 1\n", "", "a shape needs a file, or elongation and flatness"),
    ("elongation = 0.7", "elongation = 1.4", "shapes.shingle.elongation"),
    ("flatness = 1", "flatnes = 1", "Did you mean"),
    ('shape = "shingle"', 'shape = "shinglle"', "Did you mean 'shingle'"),
    ('shape = "shingle"', 'shape = "rod"', "has no effect; name it in grains.shape"),
    ("flatness = 1", "flatness = 0.2", "it is too thin for so few"),
]


@pytest.mark.parametrize(("was", "now", "part"), BAD)
def test_a_bad_shape_of_ones_own_gets_a_message_with_its_key(was: str, now: str, part: str) -> None:
    with pytest.raises(CaseError) as found:
        read_text(RATIOS.replace(was, now))
    assert part in str(found.value)


def test_a_mesh_that_is_no_body_is_refused_with_its_key(tmp_path: Path) -> None:
    path = with_mesh(tmp_path, cube())
    for mesh, part in (
        (trimesh.Trimesh(cube().vertices, cube().faces[1:]), "is not closed: 3 sides"),
        (trimesh.Trimesh(cube().vertices, cube().faces[:, ::-1], process=False), "is turned inside out"),
        (
            trimesh.creation.box((70.0, 70.0, 7.0)),
            "it is too thin for so few; ask for more in shapes.crushed.spheres",
        ),
    ):
        mesh.export(tmp_path / "crushed.stl")
        with pytest.raises(CaseError) as found:
            read(path)
        assert part in str(found.value)
        assert "shapes.crushed" in str(found.value)
    (tmp_path / "crushed.stl").unlink()
    with pytest.raises(CaseError, match="no such file in the folder of the case"):
        read(path)
