"""A stream whose bed is that of another run: its grains, its checks, and a resume without that run."""

import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ryusa import run
from ryusa.build import build
from ryusa.casefile import read
from ryusa.casefile.case import Case
from ryusa.casefile.explain import explain
from ryusa.casefile.row.values import bed_over, row_plan
from ryusa.errors import CaseError
from ryusa.results import Results, schema

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

pytestmark = pytest.mark.full

STREAM = """
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
cell = "2.5 mm"
[water.row]
bottom = [["0 m", "0 cm"], ["16 cm", "0 cm"]]
segment = "2 cm"
width = "2 cm"
upstream = { end = "wall" }
downstream = { end = "wall" }
[build]
kind = "stream"
bed = [["2 cm", "1.2 cm"], ["12 cm", "1.2 cm"]]
walls = false
[stop]
time = "60 ms"
[record]
frames = "10 ms"
"""
OF_RUN = {"build.bed": "{ run = 'runs/laid' }"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a case, with the run that left a bed."""
    found = tmp_path_factory.mktemp("settled")
    (found / "stream.toml").write_text(STREAM, encoding="utf-8")
    run(read(found / "stream.toml"), found / "runs" / "laid", progress=False)
    return found


@pytest.fixture(scope="module")
def laid(folder: Path) -> Results:
    return Results.open(folder / "runs" / "laid")


def case(folder: Path, **more: str) -> Case:
    return read(folder / "stream.toml", OF_RUN | {key.replace("__", "."): one for key, one in more.items()})


def test_the_grains_are_those_of_the_last_frame(folder: Path, laid: Results) -> None:
    built = build(case(folder))
    x = np.array(laid.frames.x[-1])
    x[:, 1] %= 0.02
    assert np.abs(built.state.x - x).max() < 1e-15
    assert (built.scene.d == laid.scene.d).all()
    assert (built.state.v == np.asarray(laid.frames.v[-1])).all()
    assert built.scene.walls is not None
    assert built.scene.walls.names == ("bottom",)
    assert any("runs/laid" in note for note in built.notes)


def test_a_time_chooses_the_frame(folder: Path, laid: Results) -> None:
    built = build(case(folder, build__bed="{ run = 'runs/laid', at = '21 ms' }"))
    assert (built.state.x[:, 2] == np.asarray(laid.frames.x[2])[:, 2]).all()


def test_the_thickness_of_the_bed_holds_its_grains_packed(folder: Path, laid: Results) -> None:
    """And the water of a depth stands over it."""
    one = case(folder)
    plan = row_plan(one)
    thick = bed_over(one, plan.x)
    packed = build(one).scene.row.column.phi_max  # type: ignore[union-attr]
    volume = thick.sum() * plan.dx * 0.02 * packed
    assert volume == pytest.approx(laid.scene.solid_volume.sum(), rel=1e-12)
    assert thick[-1] == 0.0 < thick[3]
    assert plan.start == pytest.approx(plan.bottom + thick + 0.02, abs=1e-12)


def test_check_says_of_which_run_the_bed_is(folder: Path, laid: Results) -> None:
    row = next(one for one in explain(case(folder)) if one.name == "bed at the start")
    assert f"{laid.scene.n_grain} grains as in runs/laid at 0.06 s" in row.origin


def test_the_run_goes_on_without_the_folder_of_the_bed(folder: Path, tmp_path: Path, stop_at: Any) -> None:
    """Its own folder keeps the grains, and a resume has the bits of the whole run."""
    shutil.copytree(folder, tmp_path / "case")
    whole = run(case(tmp_path / "case"), tmp_path / "whole", progress=False)
    stop_at(700)
    assert run(case(tmp_path / "case"), tmp_path / "run", progress=False).status == schema.STOPPED
    shutil.rmtree(tmp_path / "case")
    resumed = run(read(tmp_path / "run" / "case.toml", OF_RUN), tmp_path / "run", resume=True, progress=False)
    assert resumed.complete
    assert differences(whole.folder, resumed.folder) == []


BAD = [
    ({"build.bed": "{ run = 'runs/lade' }"}, "build.bed.run", "no such run folder"),
    ({"build.bed": "{ folder = 'runs/laid' }"}, "build.bed", "run"),
    ({"build.begin": "'1 cm'"}, "build.begin", "no effect"),
    ({"build.gap": "0.1"}, "build.gap", "no effect"),
    ({"build.walls": "true"}, "build.bed.run", "build.walls must be false"),
    ({"water.row.width": "'2.4 cm'"}, "build.bed.run", "is 0.02 m wide"),
    ({"water.row.bottom": "[['0 m', '0 m'], ['8 cm', '0 m']]"}, "build.bed.run", "must lie in the row"),
    ({"grains.density": "'1500 kg/m3'"}, "build.bed.run", "2650 kg/m3"),
]


@pytest.mark.parametrize(("more", "key", "says"), BAD, ids=[f"{key} {says}" for _, key, says in BAD])
def test_what_a_bed_of_a_run_cannot_be_is_refused_with_its_key(
    folder: Path, laid: Results, more: dict[str, str], key: str, says: str
) -> None:
    del laid
    with pytest.raises(CaseError) as caught:
        read(folder / "stream.toml", OF_RUN | more)
    assert key in str(caught.value)
    assert says in str(caught.value)
