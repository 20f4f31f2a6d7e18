"""A case that starts from what was exported, from LAMMPS, or from a frame of another run."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ryusa import run
from ryusa.build import build
from ryusa.build.case import Built
from ryusa.casefile import derive, read
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.errors import CaseError
from ryusa.formats.export import export
from ryusa.results import Results, schema

HEAD = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
spread = 0.2
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
[build]
"""
TAIL = '[time]\nstep = "1 us"\n[stop]\ntime = "60 ms"\n[record]\nframes = "5 ms"\n'
FALLING = 'kind = "packing"\ncolumns = 4\nrows = 3\nlayers = 2\nspeed = "0.3 m/s"\n'
IN_FLIGHT = 2  # a frame before any grain touches another; some do before the next
NEXT = 3
FILES = {
    "csv": 'file = "grains.csv"\n',
    "lammps-dump": 'file = "grains.dump"\nformat = "lammps-dump"\nfixed_types = [2]\n',
    "extxyz": 'file = "grains.xyz"\nformat = "xyz"\n',
    "vtu": 'file = "grains/grains-0000.vtu"\nformat = "vtu"\n',
}
NAMES = {"csv": "grains.csv", "lammps-dump": "grains.dump", "extxyz": "grains.xyz", "vtu": "grains.pvd"}


def case(folder: Path, keys: str, name: str = "case.toml", tail: str = TAIL) -> Path:
    path = folder / name
    path.write_text(HEAD + keys + tail, encoding="utf-8")
    return path


def wrapped(results: Results, k: int) -> np.ndarray:
    """Centres of a frame inside the period; engines let grains pass its sides for a while."""
    x = np.array(results.frames.x_wrapped[k])
    for axis, period in enumerate(results.scene.period):
        x[:, axis] -= np.floor(x[:, axis] / period) * period
    return x


def after(built: Built, steps: int) -> tuple[np.ndarray, ...]:
    engine = CpuEngine()
    engine.load(built.scene, built.state)
    engine.advance(steps).raise_if_any()
    state = engine.state()
    return np.array(state.x), np.array(state.v), np.array(state.omega)


@pytest.fixture(scope="module")
def falling(tmp_path_factory: pytest.TempPathFactory) -> Results:
    folder = tmp_path_factory.mktemp("falling")
    done = run(read(case(folder, FALLING)), folder / "runs" / "falling", progress=False)
    assert done.frames.t[IN_FLIGHT] < done.contacts["t_begin"].min() < done.frames.t[NEXT]
    return done


@pytest.mark.parametrize("to", list(FILES))
def test_a_case_from_an_exported_frame_takes_the_same_steps(
    falling: Results, tmp_path: Path, to: str
) -> None:
    for k in (0, IN_FLIGHT):
        export(falling, tmp_path / NAMES[to], to, at=float(falling.frames.t[k]))
        text = FILES[to].replace("\n", "\nallow_overlap = true\n", 1)  # fixed grains of the bed overlap
        built = build(read(case(tmp_path, 'kind = "table"\n' + text)))
        frame = falling.frames[k]
        assert built.scene.period == falling.scene.period
        assert np.array_equal(built.state.x, frame.x_wrapped)
        assert np.array_equal(built.state.v, frame.v)
        assert np.array_equal(built.scene.d, falling.scene.d)
        assert np.array_equal(built.scene.x_fixed, falling.scene.x_fixed)
        first = build(read(falling.folder.parents[1] / "case.toml"))
        whole = after(first, int(falling.frames.step[k]) + 100)
        for one, other in zip(after(built, 100), whole, strict=True):
            assert np.array_equal(one, other)


def test_a_frame_is_chosen_by_its_number(falling: Results, tmp_path: Path) -> None:
    for to in ("csv", "lammps-dump", "extxyz"):
        export(falling, tmp_path / NAMES[to], to)
        path = case(tmp_path, f'kind = "table"\nallow_overlap = true\n{FILES[to]}')
        assert np.array_equal(build(read(path)).state.x, wrapped(falling, -1)), to
        for k in (0, 3, len(falling.frames) - 1):
            chosen = build(read(path, {"build.frame": str(k)}))
            assert np.array_equal(chosen.state.x, wrapped(falling, k)), to
        with pytest.raises(CaseError, match=rf"the file has frames 0 to {len(falling.frames) - 1}"):
            read(path, {"build.frame": str(len(falling.frames))})


def test_a_run_starts_from_a_frame_of_another(falling: Results) -> None:
    folder = falling.folder.parents[1]
    t = falling.frames.t[IN_FLIGHT]
    path = case(folder, f'kind = "run"\nfolder = "runs/falling"\nat = "{t:.17g} s"\n', "on.toml")
    on = run(read(path), folder / "runs" / "on", progress=False)
    assert on.frames.step[1] == falling.frames.step[NEXT] - falling.frames.step[IN_FLIGHT]
    assert np.array_equal(on.frames.v[0], falling.frames.v[IN_FLIGHT])
    assert on.frames.v[1] == pytest.approx(falling.frames.v[NEXT], rel=1e-9, abs=1e-9)
    assert (folder / "runs" / "on" / schema.START).is_file()
    last = build(read(path, {"build.at": f"{falling.frames.t[-1]:.17g} s"}))
    assert np.array_equal(last.state.v, falling.frames.v[-1])
    with pytest.raises(CaseError, match="has no frame at 9 s"):
        read(path, {"build.at": "9 s"})
    with pytest.raises(CaseError, match="no such run folder"):
        read(path, {"build.folder": "runs/none"})
    with pytest.raises(CaseError, match="inside the folder of the case"):
        read(path, {"build.folder": "../runs"})
    held = falling.contacts
    touching = next(t for t in falling.frames.t if ((held["t_begin"] < t) & (t < held["t_part"])).any())
    with pytest.raises(CaseError, match="first grains overlap"):
        build(read(path, {"build.at": f"{touching:.17g} s", "build.allow_overlap": "false"}))


def test_a_run_folder_holds_the_grains_that_it_started_from(falling: Results, tmp_path: Path) -> None:
    shutil.copytree(falling.folder, tmp_path / "runs" / "falling")
    path = case(tmp_path, 'kind = "run"\nfolder = "runs/falling"\n', "on.toml")
    whole = build(read(path))
    run(read(path), tmp_path / "on", progress=False)
    shutil.rmtree(tmp_path / "runs")
    alone = build(read(tmp_path / "on" / "case.toml"))
    for name in ("x", "v", "omega"):
        assert np.array_equal(getattr(whole.state, name), getattr(alone.state, name))
    assert alone.scene.period == whole.scene.period
    again = run(read(tmp_path / "on" / "case.toml"), tmp_path / "again", progress=False)
    start = (tmp_path / "on" / schema.START).read_bytes()
    assert (tmp_path / "again" / schema.START).read_bytes() == start
    assert np.array_equal(again.frames.x[-1], Results.open(tmp_path / "on").frames.x[-1])


@pytest.mark.full
def test_groups_planes_and_the_zero_of_the_water_come_from_the_run(tmp_path: Path) -> None:
    from ryusa.cases import case_path

    short = {"stop.time": "5 ms", "record.settle": "0 s", "record.frames": "5 ms", "timeline": "[]"}
    heap = read(case_path("heap.toml"), short)
    run(heap, tmp_path / "heap", progress=False)
    text = heap.text[: heap.text.index("[build]")] + '[build]\nkind = "run"\nfolder = "heap"\n'
    (tmp_path / "on.toml").write_text(
        text + '[stop]\ntime = "5 ms"\n[[timeline]]\nat = "1 ms"\nremove = "gate"\n'
    )
    before, built = build(heap), build(read(tmp_path / "on.toml"))
    assert {"floor", "back", "gate", "pit"} <= set(before.scene.groups)
    assert built.scene.groups == before.scene.groups
    assert np.array_equal(built.scene.plane_point, before.scene.plane_point)
    assert np.array_equal(built.scene.plane_normal, before.scene.plane_normal)
    own = "[{ name = 'pit', point = ['0 m', '0 m', '-9 m'], normal = [0, 0, 1] }]"
    lower = build(read(tmp_path / "on.toml", {"planes": own}))
    assert lower.scene.plane_point[-1].tolist() == [0.0, 0.0, -9.0]
    assert lower.scene.n_plane == before.scene.n_plane


def test_a_column_of_water_between_walls_keeps_its_bed(tmp_path: Path) -> None:
    from ryusa.cases import case_path

    small = {
        "build.length": "8 cm", "stop.time": "10 ms", "record.settle": "0 s", "record.frames": "5 ms",
    }  # fmt: skip
    flume = read(case_path("bedload_3d.toml"), small)
    run(flume, tmp_path / "flume", progress=False)
    start, end = flume.text.index("[build]"), flume.text.index("[", flume.text.index("[build]") + 2)
    while flume.text[end - 1] != "\n":
        end = flume.text.index("[", end + 1)
    text = flume.text[:start] + '[build]\nkind = "run"\nfolder = "flume"\n' + flume.text[end:]
    (tmp_path / "on.toml").write_text(text)
    del small["build.length"]
    before, built = build(flume), build(read(tmp_path / "on.toml", small))
    assert before.scene.column is not None
    assert built.scene.column is not None
    assert built.scene.column.area == before.scene.column.area
    assert built.scene.water.z_zero == before.scene.water.z_zero
    assert built.scene.groups.keys() == before.scene.groups.keys()


def test_grains_that_lammps_wrote_are_read(
    tmp_path: Path, in_lammps: Callable[..., dict[str, np.ndarray]]
) -> None:
    in_lammps(
        "units cgs", "atom_style sphere", "boundary p p f", "region box block -2 2 0 3 0 4",
        "create_box 2 box",
        "create_atoms 1 single -1.5 1 1", "create_atoms 1 single 0.25 2 2.5",
        "create_atoms 2 single 1 1 0.5",
        "set type 1 diameter 0.4 density 2.65", "set type 2 diameter 0.5 density 2.65",
        "set atom 1 vx 12.5 vz -3", "set atom 2 omega 1 2 3", "comm_modify vel yes",
        f"write_data {tmp_path / 'grains.data'}",
        f"write_dump all custom {tmp_path / 'grains.dump'} "
        "id type xs ys zs vx vy vz omegax omegay omegaz radius modify sort off format float %.17g units yes",
    )  # fmt: skip
    units = 'length_unit = "cm"\ntime_unit = "s"\nfixed_types = [2]\n'
    built: dict[str, Any] = {}
    for kind, name in (("lammps-data", "grains.data"), ("lammps-dump", "grains.dump")):
        text = f'kind = "table"\nfile = "{name}"\nformat = "{kind}"\n{units}'
        if kind == "lammps-data":
            text += '[domain]\nperiod_x = "4 cm"\nperiod_y = "3 cm"\n'
        one = build(read(case(tmp_path, text)))
        assert one.scene.period == pytest.approx((0.04, 0.03))
        assert (one.scene.n_grain, one.scene.n_fixed) == (2, 1)
        assert one.state.x == pytest.approx(np.array([[0.025, 0.01, 0.01], [0.0025, 0.02, 0.025]]))
        assert one.state.v == pytest.approx(np.array([[0.125, 0.0, -0.03], [0.0, 0.0, 0.0]]))
        assert one.state.omega == pytest.approx(np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]]))
        assert one.scene.d == pytest.approx([0.004, 0.004])
        assert one.scene.d_fixed == pytest.approx([0.005])
        built[kind] = one
    with pytest.raises(CaseError, match=r"grains\.dump:2:1: the file has units 'cgs': state"):
        read(case(tmp_path, 'kind = "table"\nfile = "grains.dump"\nformat = "lammps-dump"\n'))


def test_a_file_without_sizes_takes_the_diameter_of_the_case(tmp_path: Path) -> None:
    (tmp_path / "two.xyz").write_text("2\nno properties\nSi 0 0 1.5\nO 3 0 2\n")
    text = 'kind = "table"\nfile = "two.xyz"\nformat = "xyz"\nlength_unit = "mm"\n'
    found = build(read(case(tmp_path, text)))
    assert found.scene.d.tolist() == [0.002, 0.002]
    assert found.state.x == pytest.approx(np.array([[0.0, 0.0, 0.0015], [0.003, 0.0, 0.002]]))
    assert derive(read(case(tmp_path, text))).n_grain == 2


def test_keys_of_another_format_are_refused(tmp_path: Path) -> None:
    (tmp_path / "grains.csv").write_text("x [m],z [m],d [m]\n0,0,1e-3\n")
    for key, value in (("length_unit", '"cm"'), ("fixed_types", "[2]")):
        with pytest.raises(CaseError, match=rf"build\.{key}.* has no effect with format 'csv'"):
            read(case(tmp_path, f'kind = "table"\nfile = "grains.csv"\n{key} = {value}\n'))
    with pytest.raises(CaseError, match=r"build\.length_unit"):
        read(case(tmp_path, 'kind = "table"\nfile = "a.xyz"\nformat = "xyz"\nlength_unit = "kg"\n'))


def test_a_period_that_contradicts_the_file_is_refused(falling: Results, tmp_path: Path) -> None:
    export(falling, tmp_path / "grains.xyz", "extxyz")
    text = 'kind = "table"\nallow_overlap = true\n' + FILES["extxyz"]
    length = falling.scene.period[0]
    stated = f'[domain]\nperiod_x = "{length:.17g} m"\n'
    assert build(read(case(tmp_path, text + stated))).scene.period == falling.scene.period
    with pytest.raises(CaseError, match=r"domain\.period_x.* differs from grains\.xyz"):
        read(case(tmp_path, text + '[domain]\nperiod_x = "9 cm"\n'))
