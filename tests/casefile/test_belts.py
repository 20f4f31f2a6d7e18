"""walls.surface_velocity in a case file: read, told, refused by key; and in the scenes of run folders."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from tests.casefile.test_walls import CASE, FLOOR, TUBE, fault

from ryusa.build import build
from ryusa.build.change import replay
from ryusa.casefile import explain
from ryusa.casefile.read import read_text
from ryusa.model.walls import N_MOTION, N_RIGID, SURFACE, surface_velocity
from ryusa.results.scene_file import read_scene, scene_digest, write_scene

RUNS = 'surface_velocity = ["0.5 m/s", "0 m/s", "0 m/s"]\n'
UP = 'surface_velocity = ["0 m/s", "0 m/s", "0.5 m/s"]\n'
DISC = (
    '[[walls]]\nname = "table"\nshape = "disc"\nat = ["0 m", "0 m", "-1 cm"]\nradius = "3 cm"\n'
    "normal = [0, 0, 1]\n"
)


def move(keys: str, at: str = "1 ms", wall: str = "floor") -> str:
    return f'[[timeline]]\nat = "{at}"\n[timeline.move]\nwall = "{wall}"\n{keys}'


def rows(text: str) -> dict[str, tuple[object, str, str]]:
    return {one.name: (one.value, one.origin, one.flag) for one in explain(read_text(text))}


def test_check_says_how_fast_a_belt_runs_and_when_a_grain_has_its_speed() -> None:
    walls = build(read_text(CASE + FLOOR + RUNS)).scene.walls
    assert walls is not None
    assert walls.motion[0, SURFACE : SURFACE + 3].tolist() == [0.5, 0.0, 0.0]
    assert not walls.moving()[0]
    assert walls.running()[0]
    value, origin, flag = rows(CASE + FLOOR + RUNS)["floor: surface runs at"]
    assert (value, flag) == ("0.5 m/s", "")
    assert "with friction 0.5, a grain that does not roll has it after 0.102 s and 2.55 cm" in origin


def test_check_warns_of_a_belt_that_runs_into_its_wall_or_holds_nothing() -> None:
    into = RUNS.replace('"0 m/s"]', '"0.3 m/s"]')
    value, origin, flag = rows(CASE + FLOOR + into)["floor: surface runs at"]
    assert (value, flag) == ("0.5 m/s", "warning")
    assert "of 0.5831 m/s the rest is normal to it" in origin
    smooth = CASE.replace("friction = 0.5", "friction = 0.0")
    assert rows(smooth + FLOOR + RUNS)["floor: surface runs at"][2] == "warning"


def test_a_move_starts_changes_and_stops_a_belt_and_check_says_so() -> None:
    text = CASE + FLOOR + move(RUNS) + move('velocity = ["1 cm/s", "0 m/s", "0 m/s"]\n', "3 ms")
    case = read_text(text)
    scenes = [scene.walls for _, _, scene in replay(case, build(case).scene)]
    speeds = [one.motion[0, SURFACE] for one in scenes if one is not None]
    assert speeds == [0.5, 0.0]
    found = rows(text)
    assert found["floor: surface runs from 0.001 s on at"][0] == "0.5 m/s"
    assert "gives it no surface_velocity" in found["floor: surface stands still from 0.003 s on"][1]


def test_a_velocity_of_the_timeline_is_in_the_world_though_the_wall_has_turned() -> None:
    """A quarter of a turn about z before the move, half a turn in all a quarter later."""
    turns = 'angular_velocity = ["0 rpm", "0 rpm", "15000 rpm"]\n'
    table = DISC + turns + 'axis_point = ["0 m", "0 m", "0 m"]\n'
    case = read_text(CASE + table + move(RUNS + turns, wall="table"))
    scene = build(case).scene
    ((_, _, after),) = replay(case, scene)
    assert after.walls is not None
    t = round(1e-3 / scene.dt) * scene.dt
    row = after.walls.motion[0]
    assert surface_velocity(row, t) == pytest.approx([0.5, 0.0, 0.0], abs=1e-12)
    assert surface_velocity(row, t + 1e-3) == pytest.approx([0.0, 0.5, 0.0], abs=1e-9)


BAD = [
    (FLOOR + RUNS.replace('"0.5 m/s"', '"0.5 m"'), "walls.0.surface_velocity.0 = '0.5 m': wrong unit"),
    (FLOOR + 'surface_velocity = "0.5 m/s"\n', "walls.0.surface_velocity = '0.5 m/s': must be a list"),
    (FLOOR + RUNS.replace("velocity", "velocty"), "Did you mean"),
    (FLOOR + UP, "walls.0.surface_velocity = [0.0, 0.0, 0.5]: is normal to the wall 'floor'"),
    (DISC + UP, "walls.0.surface_velocity = [0.0, 0.0, 0.5]: is normal to the wall 'table'"),
    (FLOOR + move(UP), "timeline.0.move.surface_velocity = [0.0, 0.0, 0.5]: is normal to the wall 'floor'"),
    (FLOOR.replace('"rectangle"', '"ridges"\nnumber = 5\nheight = "1 mm"') + RUNS,
     "walls.0.surface_velocity = ['0.5 m/s', '0 m/s', '0 m/s']: cannot run over ridges, which would "
     "stand still: give vel"),
    (FLOOR.replace('"rectangle"', '"ridges"\nnumber = 5\nheight = "1 mm"') + move(RUNS),
     "timeline.0.move.surface_velocity = ['0.5 m/s', '0 m/s', '0 m/s']: cannot run over ridges"),
    (TUBE + RUNS, "walls.0.surface_velocity = [0.5, 0.0, 0.0]: runs across the axis of the cylinder 'tube'"),
    (FLOOR + RUNS.replace("0.5 m/s", "9 km/s"), "runs at 9e+03 m/s, with which a grain goes too far in a st"),
    (FLOOR + 'servo = { direction = [0, 0, 1], force = "1 N", max_speed = "1 cm/s" }\n' + move(RUNS),
     "timeline.0.move.wall = 'floor': has a servo"),
]  # fmt: skip


@pytest.mark.parametrize(("walls", "said"), BAD)
def test_a_belt_that_cannot_run_is_named_with_its_key(tmp_path: Path, walls: str, said: str) -> None:
    assert said in fault(tmp_path, walls)


def test_a_plane_scene_has_no_belt(tmp_path: Path) -> None:
    flat = CASE.replace("plane = false", "plane = true")
    assert "needs motion.plane = false" in fault(tmp_path, FLOOR + RUNS, flat)


@pytest.mark.parametrize(("keys", "columns"), [("", N_RIGID), (RUNS, N_MOTION)])
def test_scenes_without_belts_are_stored_as_before_there_were_any(
    tmp_path: Path, keys: str, columns: int
) -> None:
    scene = build(read_text(CASE + FLOOR + keys)).scene
    with h5py.File(tmp_path / "scene.h5", "w") as file:
        write_scene(file, scene, 0, 0.0)
        motion = file["walls/motion"]
        assert isinstance(motion, h5py.Dataset)
        assert motion.shape == (1, columns)
    found = read_scene(tmp_path / "scene.h5")[2]
    assert scene.walls is not None
    assert found.walls is not None
    assert np.array_equal(found.walls.motion, scene.walls.motion)
    assert scene_digest(found) == scene_digest(scene)
