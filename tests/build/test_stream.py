"""Beds that builder "stream" lays: their thickness along the stream, as points and from a file."""

from pathlib import Path

import numpy as np
import pytest

from ryusa.build import build
from ryusa.casefile import read, read_text
from ryusa.casefile.row.values import row_plan
from ryusa.errors import CaseError
from ryusa.running.case_files import files_beside

PACKED = 0.6
STREAM = f"""
[grains]
diameter = "5 mm"
density = "2650 kg/m3"
spread = 0.1
[contact]
stiffness = "200 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
[water]
profile = "column"
depth = "2 cm"
[water.column]
bed = "rough"
packed = {PACKED}
[water.row]
bottom = [["0 m", "5 cm"], ["0.5 m", "3 cm"], ["1 m", "0 cm"]]
segments = 40
width = "2 cm"
upstream = {{ end = "wall" }}
downstream = {{ end = "wall" }}
[build]
kind = "stream"
walls = false
[stop]
time = "1 s"
[record]
frames = "0.1 s"
"""
RIDGE = "[['0.2 m', '0 m'], ['0.5 m', '4 cm'], ['0.6 m', '1 cm'], ['0.9 m', '1 cm']]"


def thickness(x: np.ndarray) -> np.ndarray:
    return np.interp(x, [0.2, 0.5, 0.6, 0.9], [0.0, 0.04, 0.01, 0.01], left=0.0, right=0.0)


def test_a_bed_has_the_thickness_that_its_points_give() -> None:
    """The volume of grains upstream of every place, within that of a column of the lattice."""
    case = read_text(STREAM, {"build.bed": RIDGE})
    built = build(case)
    x, d = built.state.x, built.scene.d
    edges = np.linspace(0.0, 1.0, 1001)
    held = np.histogram(x[:, 0], edges, weights=np.pi / 6.0 * d**3)[0].cumsum()
    asked = (thickness(edges[1:] - 5e-4) * 1e-3 * 0.02 * PACKED).cumsum()
    column = 0.0055 * 0.04 * 0.02 * PACKED  # of the lattice, where the bed is thickest
    assert held[-1] == pytest.approx(asked[-1], rel=2e-3)
    assert np.abs(held - asked).max() < column
    assert ((x[:, 0] > 0.2) & (x[:, 0] < 0.9)).all()
    floor = np.interp(x[:, 0], [0.0, 0.5, 1.0], [0.05, 0.03, 0.0])
    assert (x[:, 2] - floor > 0.49 * d).all()


def test_the_water_stands_over_the_bed_and_the_bed_may_end_before_its_points() -> None:
    plan = row_plan(read_text(STREAM, {"build.bed": RIDGE, "build.end": "'0.55 m'"}))
    expected = plan.bottom + np.where(plan.x < 0.55, thickness(plan.x), 0.0) + 0.02
    assert plan.start == pytest.approx(expected, abs=1e-12)


def test_an_even_thickness_is_that_of_two_points() -> None:
    """Both lay as many grains, though not at the same random places."""
    even = build(read_text(STREAM, {"build.bed": "'2 cm'"})).state
    points = build(read_text(STREAM, {"build.bed": "[['0 m', '2 cm'], ['1 m', '2 cm']]"})).state
    assert even.x.shape == points.x.shape
    assert points.x[:, 2].max() == pytest.approx(even.x[:, 2].max(), abs=0.006)


def test_a_file_gives_the_thickness_and_is_kept_with_the_case(tmp_path: Path) -> None:
    (tmp_path / "bed.csv").write_text("x [cm],z [mm]\n20,0\n50,40\n60,10\n90,10\n")
    path = tmp_path / "stream.toml"
    path.write_text(STREAM.replace('kind = "stream"', 'kind = "stream"\nbed = "bed.csv"'))
    case = read(path)
    assert "bed.csv" in files_beside(case)
    filed, pointed = build(case).state, build(read_text(STREAM, {"build.bed": RIDGE})).state
    assert np.array_equal(filed.x, pointed.x)


@pytest.mark.parametrize(
    ("bed", "says"),
    [
        ("[['0.5 m', '1 cm'], ['0.2 m', '1 cm']]", "point 2 lies at x = 0.2 m, not downstream"),
        ("[['0.2 m', '1 cm'], ['0.5 m', '-1 cm']]", "point 2 must have a thickness of at least 0"),
        ("[['0.2 m', '0 cm'], ['0.5 m', '0 cm']]", "gives no grain"),
        ("[['0.2 m', '1 cm']]", "too few"),
        ("'missing.csv'", "no such file"),
        ("'2 m2'", "wrong unit"),
        ("'-2 cm'", "at least 0"),
        ("[['0.2 m', '1 cm'], ['1.4 m', '1 cm']]", "must end in the row"),
    ],
)
def test_a_bed_that_cannot_be_is_refused(bed: str, says: str) -> None:
    with pytest.raises(CaseError) as caught:
        build(read_text(STREAM, {"build.bed": bed}))
    faults = (caught.value, *caught.value.others)
    assert any(one.key == "build.bed" and says in one.line for one in faults), [one.line for one in faults]


def test_bottom_and_dams_are_of_the_material_of_the_bed() -> None:
    keys = {
        "build.bed": RIDGE,
        "grains.bed_material": "smooth",
        "materials.smooth.friction": "0.0",
        "pairs": "[{ materials = ['grains', 'smooth'], friction = 0.0 }]",
        "water.row.dams": "[{ name = 'dam', begin = '0.7 m', end = '0.8 m', height = '2 cm' }]",
        "walls": "[{ name = 'post', shape = 'cylinder', at = ['0.96 m', '1 cm', '0 m'], "
        "axis = ['0 m', '0 m', '5 cm'], radius = '5 mm' }]",
    }
    scene = build(read_text(STREAM, keys)).scene
    walls, materials = scene.walls, scene.materials
    assert walls is not None
    assert materials is not None
    of_faces = materials.of[-len(walls.wall) :]
    found = {
        name: {materials.names[k] for k in of_faces[walls.wall == w]} for w, name in enumerate(walls.names)
    }
    assert found == {"post": {"grains"}, "bottom": {"smooth"}, "dam": {"smooth"}}
