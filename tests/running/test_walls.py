"""Runs with walls: recorded, stopped, resumed without the mesh, measured and drawn."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import ryusa
from ryusa.casefile import read
from ryusa.cli import app
from ryusa.results import Results, schema

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

CASE = """
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
[contact]
stiffness = "2000 N/m"
restitution = 0.5
friction = 0.5
slip = "total"
[motion]
rotation = "free"
plane = false
[[walls]]
name = "cup"
shape = "mesh"
file = "parts of it/cup.stl"
unit = "mm"
[[walls]]
name = "lid"
shape = "disc"
at = ["0 cm", "0 cm", "3 cm"]
normal = [0, 0, 1]
radius = "2 cm"
amplitude = ["0 cm", "0 cm", "1 mm"]
frequency = "20 Hz"
[[timeline]]
at = "60 ms"
[timeline.move]
wall = "cup"
angular_velocity = ["0 rpm", "0 rpm", "100 rpm"]
axis_point = ["0 cm", "0 cm", "0 cm"]
[[timeline]]
at = "100 ms"
remove = "lid"
[build]
kind = "fill"
low = ["-9 mm", "-9 mm", "1 mm"]
high = ["9 mm", "9 mm", "2.6 cm"]
[stop]
time = "0.15 s"
[record]
frames = "5 ms"
forces = true
events = "all"
"""


def write_cup(path: Path, sides: int = 40) -> None:
    """An open cup of 16 mm radius and 30 mm height, triangles in any orientation."""
    angle = 2.0 * np.pi * np.arange(sides + 1) / sides
    low = np.column_stack([16.0 * np.cos(angle), 16.0 * np.sin(angle), np.zeros(sides + 1)])
    high = low + np.array([0.0, 0.0, 30.0])
    corners = [
        *np.stack([low[:-1], low[1:], high[1:]], axis=1),
        *np.stack([low[:-1], high[:-1], high[1:]], axis=1),
        *np.stack([np.zeros((sides, 3)), low[:-1], low[1:]], axis=1),
    ]
    lines = ["solid cup"]
    for one in corners:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in one)]
        lines += ["endloop", "endfacet"]
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join([*lines, "endsolid cup", ""]))


def case_in(folder: Path) -> Path:
    write_cup(folder / "parts of it" / "cup.stl")
    (folder / "case.toml").write_text(CASE)
    return folder / "case.toml"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Results:
    folder = tmp_path_factory.mktemp("walls")
    return ryusa.run(read(case_in(folder)), folder / "run", progress=False, threads=2)


def test_a_run_resumes_without_its_mesh_with_the_same_bits(
    whole: Results, tmp_path: Path, stop_at: Any
) -> None:
    path = case_in(tmp_path)
    stop_at(round(0.55 * whole.summary["steps"]))
    assert ryusa.run(read(path), tmp_path / "run", progress=False).status == schema.STOPPED
    (tmp_path / "parts of it" / "cup.stl").unlink()
    again = read(tmp_path / "run" / schema.CASE_TOML)
    assert ryusa.run(again, tmp_path / "run", progress=False, resume=True).status == schema.COMPLETE
    assert differences(whole.folder, tmp_path / "run") == []


def test_grains_stay_in_the_cup_and_the_account_closes(whole: Results) -> None:
    x = whole.frames.x[-1]
    assert np.hypot(x[:, 0], x[:, 1]).max() < 0.016
    assert x[:, 2].min() > 0.0
    assert whole.tally["residual"][-1] < 2e-3
    assert whole.tally["wall"][-1] != 0.0


def test_the_impulse_on_the_walls_is_the_change_of_momentum(whole: Results) -> None:
    m, t, first = whole.scene.m, whole.tally["t"], 10
    before, after = ((m[:, None] * np.asarray(whole.frames.v[k])).sum(axis=0) for k in (first, -1))
    weight = np.array([0.0, 0.0, -m.sum() * 9.80665]) * (t[-1] - t[first])
    on_walls = (whole.walls[-1] - whole.walls[first])[:, :3].sum(axis=0)
    assert on_walls == pytest.approx(weight - (after - before), rel=1e-9, abs=1e-12)
    found = whole.measure("walls", begin=float(t[first]))
    assert found.names == ("cup", "lid")
    dt = np.diff(t[first:])[:, None, None]
    assert (found.force * dt).sum(axis=(0, 1)) == pytest.approx(on_walls, rel=1e-9, abs=1e-12)
    assert np.all(found.force[found.t > 0.105, 1] == 0.0)  # the lid is gone
    assert found.power[-1, 0] != 0.0
    assert {"t_s", "wall", "force_z_N", "torque_z_Nm", "power_W"} <= set(found.rows()[0])
    assert found["cup: force z"].value < 0.0


def test_contact_forces_on_walls_point_into_the_cup(whole: Results) -> None:
    held = whole.contact_forces(len(whole.frames) - 1)
    on_wall = held[held["j"] >= whole.scene.n_grain]
    x = np.asarray(whole.frames.x[-1])[on_wall["i"]]
    on_floor = np.hypot(x[:, 0], x[:, 1]) < 0.0138  # the others touch the side
    assert on_floor.sum() > 10
    assert np.all(on_wall["force"][on_floor, 2] > 0.0)


def test_walls_are_drawn(whole: Results, tmp_path: Path) -> None:
    shown = CliRunner().invoke(
        app, ["draw", str(whole.folder), "walls", "--wall", "lid", "-o", str(tmp_path / "lid.png")]
    )
    assert shown.exit_code == 0 and (tmp_path / "lid.png").exists(), shown.output
    both = whole.draw("walls")
    assert {one.get_title("left") for one in both.axes} >= {"cup"}
    whole.view().save(tmp_path / "view.html")
    assert '"wall_faces"' in (tmp_path / "view.html").read_text()
    still = whole.film(frames=2, size=(480, 270))
    assert still is not None
    still = ryusa.Results.open(whole.folder)
    assert still.walls.shape == (len(still.frames), 2, 8)
