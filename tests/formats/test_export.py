"""What `ryusa export` writes, read by other programs and refused where it cannot be."""

import json
import re
import shutil
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ryusa.cli import app
from ryusa.errors import ResultsError
from ryusa.formats.export import FORMATS, export
from ryusa.formats.grains import table_of_frame
from ryusa.results import Results

Exported = Callable[[str], Path]
Lammps = Callable[..., dict[str, np.ndarray]]


def test_lammps_reads_a_dump_to_the_last_bit(
    exported: Exported, flight: Results, every_x: np.ndarray, in_lammps: Lammps
) -> None:
    step = int(flight.frames.step[3])
    found = in_lammps(
        "units si", "atom_style sphere", "boundary p s s", "region all block 0 0.04 -1 1 -1 1",
        "create_box 2 all",
        f"read_dump {exported('lammps-dump')} {step} x y z ix iy iz vx vy vz box yes add keep",
    )  # fmt: skip
    assert np.array_equal(found["x"].reshape(-1, 3), every_x[3])
    assert np.array_equal(found["v"].reshape(-1, 3)[:3], flight.frames.v[3])
    assert found["type"].tolist() == [1, 1, 1, 2]
    assert found["image"].reshape(-1, 3)[:, 0].tolist() == [0, 1, 0, 0]
    assert (found["box"][0][0], found["box"][1][0]) == (0.0, 0.04)


def test_units_stand_once_at_the_head_of_a_dump(exported: Exported, flight: Results) -> None:
    lines = exported("lammps-dump").read_text().splitlines()
    assert lines[:2] == ["ITEM: UNITS", "si"]  # OVITO takes a dump that repeats them for one frame
    assert lines.count("ITEM: UNITS") == 1
    assert lines.count("ITEM: TIMESTEP") == len(flight.frames)


def test_vtk_reads_the_frames_that_the_pvd_lists(
    exported: Exported, flight: Results, every_x: np.ndarray
) -> None:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    pvd = exported("vtu")
    files = re.findall(r'file="([^"]*)"', pvd.read_text())
    assert len(files) == len(flight.frames)
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(pvd.parent / files[3]))
    reader.Update()
    grains = reader.GetOutput()
    data = grains.GetPointData()
    assert np.array_equal(vtk_to_numpy(grains.GetPoints().GetData()), every_x[3])
    assert grains.GetNumberOfCells() == 4
    assert vtk_to_numpy(data.GetArray("diameter")).tolist() == [0.004, 0.002, 0.003, 0.004]
    assert np.array_equal(vtk_to_numpy(data.GetArray("velocity"))[:3], flight.frames.v[3])
    assert np.array_equal(vtk_to_numpy(data.GetArray("spin"))[:3], flight.frames.omega[3])
    assert vtk_to_numpy(data.GetArray("fixed")).tolist() == [0, 0, 0, 1]
    assert vtk_to_numpy(data.GetArray("image"))[:, 0].tolist() == [0, 1, 0, 0]
    assert grains.GetFieldData().GetArray("TimeValue").GetValue(0) == flight.frames.t[3]


def test_ase_reads_every_frame_of_an_extended_xyz(
    exported: Exported, flight: Results, every_x: np.ndarray
) -> None:
    ase = pytest.importorskip("ase.io")
    frames = ase.read(exported("extxyz"), index=":", format="extxyz")
    assert len(frames) == len(flight.frames)
    for k, atoms in enumerate(frames):
        assert np.array_equal(atoms.positions, every_x[k])
        assert atoms.info["Time"] == flight.frames.t[k]
        assert atoms.pbc.tolist() == [True, False, False]
        assert atoms.cell[0, 0] == 0.04
        assert np.array_equal(atoms.arrays["velo"][:3], flight.frames.v[k])
        assert np.array_equal(2.0 * atoms.arrays["radius"][:3], flight.grains.d)
        assert atoms.arrays["fixed"].tolist() == [0, 0, 0, 1]


def test_pandas_reads_the_csv_as_the_page_says(exported: Exported, flight: Results) -> None:
    pandas = pytest.importorskip("pandas")
    page = (Path(__file__).parents[2] / "docs/in-and-out.md").read_text(encoding="utf-8")
    assert 'read_csv(FILE, comment="#")' in page
    found = pandas.read_csv(exported("csv"), comment="#")
    assert list(found.columns)[:3] == ["t [s]", "step", "id"]
    assert len(found) == len(flight.frames) * (flight.scene.n_grain + flight.scene.n_fixed)


def test_pyarrow_reads_the_columns_of_the_csv_with_their_units(exported: Exported, flight: Results) -> None:
    pytest.importorskip("pyarrow")
    import pyarrow.csv
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(exported("parquet"))
    assert table.num_rows == 4 * len(flight.frames)
    assert table.schema.field("wx").metadata == {b"unit": b"rad/s"}
    assert json.loads(table.schema.metadata[b"ryusa"]) == {"period": [0.04, None]}
    options = pyarrow.csv.ReadOptions(skip_rows=1)
    other = pyarrow.csv.read_csv(exported("csv"), read_options=options)
    for name in ("t", "x", "vz", "wy", "d", "m"):
        column = next(one for one in other.column_names if one.split(" ")[0] == name)
        assert other[column].to_pylist() == table[name].to_pylist(), name


def test_a_fixed_grain_has_the_mass_of_a_free_one_of_its_size(flight: Results) -> None:
    table = table_of_frame(flight, 0)
    assert table.column("m")[3] == pytest.approx(float(flight.grains.m[0]), rel=1e-15)
    assert np.array_equal(table.column("m")[:3], flight.grains.m)


def test_frames_are_chosen_by_time_window_and_interval(flight: Results, tmp_path: Path) -> None:
    def times(*options: str) -> list[str]:
        path = tmp_path / "some.dump"
        done = CliRunner().invoke(
            app, ["export", str(flight.folder), "--to", "lammps-dump", "-o", str(path), *options]
        )
        assert done.exit_code == 0, done.output
        lines = path.read_text().splitlines()
        return [f"{float(lines[k + 1]):.3f}" for k, line in enumerate(lines) if line == "ITEM: TIME"]

    assert times() == ["0.000", "0.010", "0.020", "0.030", "0.040", "0.050"]
    assert times("--at", "21 ms") == ["0.020"]
    assert times("--begin", "15 ms", "--end", "41 ms") == ["0.020", "0.030", "0.040"]
    assert times("--every", "2") == ["0.000", "0.020", "0.040"]


@pytest.mark.parametrize(
    ("options", "part"),
    [
        (["--to", "lammps"], "Did you mean 'lammps-dump'"),
        (["--to", "csv", "--at", "1 s"], "from 0 to 0.04"),
        (["--to", "csv", "--begin", "1 s"], "no frame lies in the window"),
        (["--to", "csv", "--at", "0 s", "--every", "2"], "excludes"),
        (["--to", "csv", "--at", "20"], "--at = '20'"),
        (["--to", "vtu"], "must end in .pvd"),
    ],
)
def test_what_cannot_be_exported_is_refused(
    flight: Results, tmp_path: Path, options: list[str], part: str
) -> None:
    done = CliRunner().invoke(app, ["export", str(flight.folder), "-o", str(tmp_path / "out.csv"), *options])
    assert done.exit_code == 2
    assert part in done.output
    assert list(tmp_path.iterdir()) == []


def test_a_file_above_the_free_disk_is_refused(
    flight: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    usage = type("Usage", (), {"free": 1000})
    monkeypatch.setattr(shutil, "disk_usage", lambda place: usage)
    for to in FORMATS:
        if to == "parquet" and find_spec("pyarrow") is None:
            continue
        with pytest.raises(ResultsError, match="are free; take fewer frames"):
            export(flight, tmp_path / "out.pvd", to)
    assert list(tmp_path.iterdir()) == []


def test_an_export_that_fails_leaves_the_file_before_it(
    flight: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "grains.csv"
    path.write_text("older")

    def full(share: float) -> None:
        if share > 0.5:
            raise OSError(28, "No space left on device")

    with pytest.raises(ResultsError, match="No space left"):
        export(flight, path, "csv", progress=full)
    assert [one.name for one in tmp_path.iterdir()] == ["grains.csv"]
    assert path.read_text() == "older"
