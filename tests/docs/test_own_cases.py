"""The cases of docs/cases-of-your-own.md and its subject pages are read, built and stepped as they stand."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
import trimesh

from ryusa import measure, run
from ryusa.build import build
from ryusa.casefile import derive, read
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.model.walls import ASKED

DOCS = Path(__file__).parents[2] / "docs"
PAGES = (
    "cases-of-your-own",
    "feeds-and-exits",
    "walls",
    "lids",
    "sieve-curves",
    "clumps",
    "adhesion",
    "scenes-in-python",
)
REST = '[motion]\nrotation = "free"\nplane = true\n[stop]\ntime = "0.05 s"\n[record]\nframes = "1 ms"\n'


@pytest.fixture
def blocks() -> list[tuple[str, str]]:
    text = "".join((DOCS / f"{page}.md").read_text(encoding="utf-8") for page in PAGES)
    return re.findall(r"```(\w+)\n(.*?)```", text, re.DOTALL)


def stepped(path: Path):
    built = build(read(path))
    engine = CpuEngine()
    engine.load(built.scene, built.state)
    engine.advance(500).raise_if_any()
    return built.scene


@pytest.mark.full
def test_the_gate_case_runs_and_its_gate_can_be_removed(blocks, tmp_path):
    kind, text = blocks[0]
    assert kind == "toml"
    path = tmp_path / "gate.toml"
    path.write_text(text, encoding="utf-8")
    scene = stepped(path)
    assert scene.n_plane == 5
    assert "gate" in scene.groups


def test_the_table_case_runs(blocks, tmp_path):
    (csv,) = [text for kind, text in blocks if kind == "text"]
    (tmp_path / "grains.csv").write_text(csv, encoding="utf-8")
    head = blocks[0][1].split("[rolling]")[0]
    path = tmp_path / "table.toml"
    (table,) = [text for _, text in blocks if 'kind = "table"' in text]
    path.write_text(head + table + REST, encoding="utf-8")
    scene = stepped(path)
    assert (scene.n_grain, scene.n_fixed) == (1, 2)


def test_the_box_settles_without_friction_and_gets_it_back(blocks, tmp_path):
    box, changes = [text for kind, text in blocks if kind == "toml"][1:3]
    head = blocks[0][1].split("[rolling]")[0]
    path = tmp_path / "box.toml"
    path.write_text(head + box + changes + REST.replace("0.05", "0.5"), encoding="utf-8")
    assert {"floor", "back", "gate", "pit"} <= set(stepped(path).groups)
    assert len(read(path).timeline) == 3


def test_the_hopper_runs_and_its_walls_are_measured(blocks, tmp_path):
    (text,) = [text for kind, text in blocks if kind == "toml" and "Hopper" in text]
    path = tmp_path / "hopper.toml"
    path.write_text(text, encoding="utf-8")
    short = {"stop.time": "0.02 s", "timeline.0.at": "0.01 s", "record.frames": "5 ms"}
    found = run(read(path, short), tmp_path / "run", progress=False)
    assert measure.walls(found).names == ("left", "right", "plate")


@pytest.mark.full
def test_the_bed_under_water_runs_and_its_water_is_measured(blocks, tmp_path):
    (text,) = [text for _, text in blocks if 'title = "Gravel bed under water"' in text]
    path = tmp_path / "gravel.toml"
    path.write_text(text, encoding="utf-8")
    assert derive(read(path)).tau_star == pytest.approx(0.25, abs=0.01)
    short = {"stop.time": "0.04 s", "record.settle": "0.01 s", "record.frames": "5 ms"}
    found = run(read(path, short), tmp_path / "run", progress=False)
    assert measure.water(found).averages["discharge"].value > 0.0
    assert measure.transport(found).averages["tau_star"].value > 0.0


def test_the_feed_of_the_page_is_that_of_the_packaged_case(blocks):
    (text,) = [text for kind, text in blocks if "[[feeds]]" in text and 'kind = "empty"   ' in text]
    from ryusa.cases import case_path

    written = tomllib.loads(text)
    packaged = tomllib.loads(case_path("poured_heap.toml").read_text(encoding="utf-8"))
    assert {key: packaged[key] for key in written} == written


@pytest.mark.full
def test_the_flume_with_a_weir_runs(blocks, tmp_path):
    (text,) = [text for kind, text in blocks if kind == "toml" and "Flume with a weir" in text]
    path = tmp_path / "flume.toml"
    path.write_text(text, encoding="utf-8")
    profile = np.array([[0.0, 0.0], [4.0, 12.0], [8.0, 12.0], [14.0, 0.0]])  # x, z [mm]
    ends = [np.insert(profile, 1, y, axis=1) for y in (-30.0, 30.0)]
    triangles = []
    for k in range(4):
        n = (k + 1) % 4
        triangles += [[ends[0][k], ends[0][n], ends[1][n]], [ends[0][k], ends[1][n], ends[1][k]]]
    trimesh.Trimesh(np.concatenate(triangles), np.arange(24).reshape(-1, 3)).export(tmp_path / "weir.stl")
    short = {"stop.time": "0.1 s", "feeds.0.end": "0.1 s", "record.frames": "5 ms"}
    found = run(read(path, short), tmp_path / "run", progress=False)
    assert measure.walls(found).names == ("floor", "left", "right", "weir")
    assert measure.discharge(found).n_in[-1] > 20


def test_the_drum_of_arrays_is_built_and_its_grains_can_be_clumps(blocks):
    (text,) = [text for kind, text in blocks if kind == "python" and "drum_of_arrays" in text]
    made = {}
    exec(text.split("run = ")[0], made)
    scene, shape = made["scene"], made["shape"]
    assert scene.n_grain == 600
    assert scene.materials.of[-scene.n_face :].tolist() == [1, 1]
    assert scene.traffic.exits[0].to == 0
    clumps, _ = made["build"].with_clumps(scene, made["state"], [shape("tetrahedron")])
    assert clumps.bodies.n == 600
    assert clumps.traffic.feeds[0].count == 4 * 600


@pytest.mark.full
def test_grains_are_fed_and_trapped_in_a_column_of_water(blocks, tmp_path):
    (text,) = [text for _, text in blocks if "Bed load fed" in text]
    path = tmp_path / "trap.toml"
    path.write_text(text.replace('time = "2 s"', 'time = "0.11 s"').replace('settle = "1 s"', ""), "utf-8")
    results = run(read(path), tmp_path / "run", progress=False)
    rows = results.passages
    assert (rows["way"] == 1).sum() >= 2  # one at once, one a tenth of a second later
    assert (rows["way"] == -1).sum() >= 1
    assert results.summary["energy"]["residual"] < 1e-3
    assert results.summary["water"]["momentum_residual"] < 1e-9


def test_the_lid_of_arrays_presses_on_the_area_of_the_sample(blocks):
    (text,) = [text for kind, text in blocks if kind == "python" and "runs/lid" in text]
    made = {}
    exec(text.split("run = ")[0], made)
    scene = made["scene"]
    assert scene.n_grain == 400
    assert scene.walls.servo[1, ASKED] == pytest.approx(400.0 * scene.period[0] * scene.period[1], rel=1e-9)
