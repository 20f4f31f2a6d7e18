"""Clumps in what `ryusa export` writes: which spheres belong together, and how each clump is turned."""

import csv
import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from ryusa.build import scene, with_clumps
from ryusa.casefile import read_text
from ryusa.errors import CaseError
from ryusa.formats.export import export
from ryusa.laws.families import ContactTiming
from ryusa.model.clump import shape
from ryusa.results import Results, schema
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

RATE, END = 20.0, 0.05  # spin of the first clump about z [rad/s], and the time up to which it turns [s]
HALF = np.sqrt(0.5)
UPRIGHT = (HALF, 0.0, HALF, 0.0)  # a quarter turn about y: the long axis, x of the clump, points down
CLUMP = [0, 0, 1, 1, -1, -1]  # of the spheres of two pebbles, of a sphere and of a fixed grain
READ = """
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction = 0.5
[motion]
rotation = "free"
plane = false
[build]
kind = "table"
BUILD
[stop]
time = "1 ms"
"""


@pytest.fixture(scope="module")
def turning(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """A pebble that spins about z, one that stands on end, and a sphere, without gravity."""
    loose, state = scene(
        x=[[0.0, 0.0, 0.02], [0.02, 0.0, 0.02], [0.04, 0.0, 0.02]],
        d=[0.004, 0.003, 0.002],
        v=[[0.0, 0.1, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        omega=[[0.0, 0.0, RATE], [0.0, 0.0, 0.0], [0.0, 7.0, 0.0]],
        x_fixed=[[0.02, 0.0, 0.001]],
        d_fixed=[0.002],
        timing=ContactTiming.AT_STEPS,
        gravity=0.0,
    )
    made, begun = with_clumps(
        loose, state, [shape("pebble")], form_of=[0, 0, -1],
        orientation=[(1, 0, 0, 0), UPRIGHT, (1, 0, 0, 0)], names=("pebble",),
    )  # fmt: skip
    folder = tmp_path_factory.mktemp("clumps") / "run"
    return run_scene(made, begun, folder, frames=END / 5, stop=Stop(time=END), progress=False)


def expected(run: Results) -> np.ndarray:
    """Quaternions (w, x, y, z) of all spheres at the last frame, whose time is that of a step."""
    half = 0.5 * RATE * float(run.frames.t[-1])
    turned = (np.cos(half), 0.0, 0.0, np.sin(half))
    return np.array([turned, turned, UPRIGHT, UPRIGHT, (1, 0, 0, 0), (1, 0, 0, 0)])


def table_of(path: Path) -> list[dict[str, str]]:
    """Rows of the last frame of a CSV file."""
    lines = path.read_text().splitlines()
    rows = list(csv.DictReader(lines[1:]))
    return [row for row in rows if row["t [s]"] == rows[-1]["t [s]"]]


def test_a_csv_has_the_clump_of_each_sphere_and_how_it_is_turned(turning: Results, tmp_path: Path) -> None:
    [path] = export(turning, tmp_path / "grains.csv", "csv")
    rows = table_of(path)
    assert [int(row["clump"]) for row in rows] == CLUMP
    q = np.array([[float(row[name]) for name in ("qw", "qx", "qy", "qz")] for row in rows])
    assert q == pytest.approx(expected(turning), abs=1e-9)
    assert [float(row["wz [rad/s]"]) for row in rows] == pytest.approx([RATE, RATE, 0, 0, 0, 0], rel=1e-9)
    x = np.array([[float(row[f"{axis} [m]"]) for axis in "xyz"] for row in rows])
    along = x[1] - x[0]
    angle = RATE * float(turning.frames.t[-1])  # the long axis of the spinning clump lay along x
    assert np.abs(along / np.linalg.norm(along)) == pytest.approx(
        np.abs([np.cos(angle), np.sin(angle), 0.0]), abs=1e-9
    )
    assert np.abs(x[3] - x[2])[:2] == pytest.approx(0.0, abs=1e-15)  # the other stands upright
    # the sphere of its own and the fixed one have one size and one density, whatever spheres of a clump share
    assert float(rows[5]["m [kg]"]) == pytest.approx(float(rows[4]["m [kg]"]), rel=1e-12)


def test_vtk_reads_clumps_as_point_data(turning: Results, tmp_path: Path) -> None:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonMath import vtkQuaternion
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    paths = export(turning, tmp_path / "grains.pvd", "vtu", at=END)
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(paths[1]))
    reader.Update()
    grains = reader.GetOutput()
    data = grains.GetPointData()
    assert vtk_to_numpy(data.GetArray("clump")).tolist() == CLUMP
    q = vtk_to_numpy(data.GetArray("orientation"))
    assert q == pytest.approx(expected(turning), abs=1e-9)
    # VTK's own quaternion turns the arm of the first sphere to where that sphere is
    assert turning.scene.bodies is not None
    assert turning.bodies is not None
    to_space = np.zeros((3, 3))
    vtkQuaternion["float64"](*q[0].tolist()).ToMatrix3x3(to_space)
    x = vtk_to_numpy(grains.GetPoints().GetData())
    centre = np.asarray(turning.bodies.x[-1])[0]
    assert x[0] - centre == pytest.approx(to_space @ turning.scene.bodies.arm[0], abs=1e-12)


def test_a_dump_and_an_extended_xyz_name_clumps_as_their_programs_do(
    turning: Results, tmp_path: Path
) -> None:
    [dump] = export(turning, tmp_path / "grains.dump", "lammps-dump", at=END)
    lines = dump.read_text().splitlines()
    head = next(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    names, rows = lines[head].split()[2:], [line.split() for line in lines[head + 1 :]]
    at = [names.index(name) for name in ("mol", "quatw", "quati", "quatj", "quatk")]
    assert [int(row[at[0]]) for row in rows] == [k + 1 for k in CLUMP]
    assert np.array([[float(row[k]) for k in at[1:]] for row in rows]) == pytest.approx(
        expected(turning), abs=1e-9
    )
    [xyz] = export(turning, tmp_path / "grains.xyz", "extxyz", at=END)
    _, about, *words = xyz.read_text().splitlines()
    assert re.search(r"mass:R:1:clump:I:1:orientation:R:4 ", about)
    assert [int(line.split()[-5]) for line in words] == CLUMP
    q = np.array([[float(one) for one in line.split()[-4:]] for line in words])
    assert q[:, [3, 0, 1, 2]] == pytest.approx(expected(turning), abs=1e-9)


def test_parquet_has_the_columns_of_the_csv(turning: Results, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    [path] = export(turning, tmp_path / "grains.parquet", "parquet", at=END)
    table = parquet.read_table(path)
    assert table["clump"].to_pylist() == CLUMP
    q = np.array([table[name].to_pylist() for name in ("qw", "qx", "qy", "qz")]).T
    assert q == pytest.approx(expected(turning), abs=1e-9)


def test_the_file_for_paraview_tells_which_spheres_belong_together(turning: Results) -> None:
    with h5py.File(turning.folder / schema.GRAINS) as file:
        data = file["VTKHDF/PointData"]
        assert isinstance(data, h5py.Group)
        clump = data["clump"]
        assert isinstance(clump, h5py.Dataset)
        assert clump[:].tolist() == CLUMP[:5]
        assert "clump" in file["VTKHDF/Steps/PointDataOffsets"]


@pytest.mark.parametrize(
    ("to", "name", "keys"),
    [
        ("csv", "grains.csv", 'file = "grains.csv"'),
        ("vtu", "grains.pvd", 'file = "grains/grains-0000.vtu"\nformat = "vtu"'),
    ],
)
def test_a_case_cannot_begin_with_clumps_from_a_file(
    turning: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, to: str, name: str, keys: str
) -> None:
    export(turning, tmp_path / name, to, at=END)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CaseError, match="expected single spheres, with clump -1"):
        read_text(READ.replace("BUILD", keys))
