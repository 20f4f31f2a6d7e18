"""A row of columns with grains from a case file: it runs, resumes with the same bits, and refuses by name."""

import sys
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.build import build
from ryusa.casefile import explain, read_text, resolved
from ryusa.casefile.estimate import cells_of_row
from ryusa.engine import registry
from ryusa.errors import CaseError, ResultsError
from ryusa.formats.grains import table_of_frame
from ryusa.measure.along_row import grains_along_row
from ryusa.measure.depth_history import depth_history
from ryusa.measure.long_section import long_section
from ryusa.model import RowState
from ryusa.model.fluid import EXTRA_X
from ryusa.results import Results, schema
from ryusa.results.water import WaterFrames
from ryusa.running.summary import summary_lines
from ryusa.view.flow import surfaces
from ryusa.view.page import encoded
from ryusa.water import momentum_balance as m
from ryusa.water.row_coupling import RowCoupling

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

TEXT = files("ryusa.cases").joinpath("bedload_3d.toml").read_text(encoding="utf-8")
SMALL = {
    "build.length": "'4.8 cm'", "build.layers": "3", "water.column.surface": "'volume'",
    "stop.time": "'30 ms'", "record.frames": "'10 ms'", "record.settle": "'0 s'",
}  # fmt: skip


def row(segments: int, length: str = "4.8 cm") -> dict[str, str]:
    return {"water.row.bottom": f"[['0 m', '0 m'], ['{length}', '0 m']]", "water.row.segments": str(segments)}


def run(folder: Path, more: dict[str, str], **how: Any) -> Results:
    return ryusa.run(read_text(TEXT, {**SMALL, **more}), folder, progress=False, **how)


@pytest.fixture(scope="module")
def reach(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return run(tmp_path_factory.mktemp("reach") / "run", row(4))


def test_grains_in_a_row_of_one_segment_move_as_in_one_column(tmp_path: Path) -> None:
    column, one = run(tmp_path / "column", {}), run(tmp_path / "row", row(1))
    assert np.array_equal(one.frames.x[-1], column.frames.x[-1])
    assert one.row is not None and column.water is not None
    assert np.array_equal(one.row.u[-1, 0], column.water.u[-1])
    assert np.array_equal(one.row.phi[-1, 0], column.water.phi[-1])


def test_the_row_holds_its_water_and_closes_momentum_and_energy(reach: Results) -> None:
    found, summary = reach.row, reach.summary
    assert found is not None and found.u.shape[1] == 4
    assert np.ptp(found.volume.sum(axis=1)) < 1e-14 * found.volume[0].sum()
    assert summary["water"]["momentum_residual"] < 1e-9
    assert summary["water"]["exchanges"] > 30
    (said,) = (line for line in summary_lines(summary, reach.scene.flow) if line.startswith("water:"))
    assert "exchanges with grains in a row of columns" in said
    assert summary["energy"]["residual"] < 1e-3
    phi = found.phi.sum() * found.row.column.dz * found.row.dx
    assert phi > 0.0 and found.u[-1].max() > 0.3


def test_a_run_with_grains_that_was_stopped_resumes_with_the_same_bits(
    reach: Results, tmp_path: Path, stop_at: Any
) -> None:
    for step in (1, 130, 901):
        stop_at(step)
        assert run(tmp_path / "run", row(4), resume=True).status == schema.STOPPED
    run(tmp_path / "run", row(4), resume=True)
    assert differences(reach.folder, tmp_path / "run") == []


def test_two_threads_give_the_same_bits_as_one(reach: Results, tmp_path: Path) -> None:
    assert differences(reach.folder, run(tmp_path / "run", row(4), threads=2).folder) == []


def test_what_the_water_of_a_case_gains_and_gives_to_its_grains_is_what_drives_and_holds_it() -> None:
    """Over the whole row, at every exchange: to the round-off of the sums."""
    built = build(read_text(TEXT, {**SMALL, **row(4)}))
    scene, engine = built.scene, registry.create()
    assert scene.row is not None
    engine.load(scene, built.state)
    water = RowCoupling.begin(scene, scene.row, built.state.x)
    engine.set_fluid(water.sampled)
    area, weight = scene.row.column.area / 4.0, (scene.m_weight - scene.m) * scene.gravity[0]
    for _ in range(20):
        time, told, was = water.steps * scene.dt, water.sampled, momentum(water.state)
        engine.advance(water.steps).raise_if_any()
        x, v, impulse = engine.kinematics()
        engine.set_fluid(water.exchange(x, v, impulse))
        per_time = scene.water.rho_w * area / time
        gained = per_time * (momentum(water.state) - was)
        taken = float((impulse[:, 0] / time + told[:, EXTRA_X] + weight).sum())
        b = area * water.state.budgets.sum(axis=0)
        given = b[m.B_GRAVITY] + b[m.B_BED] + b[m.B_FIXED] + b[m.B_SURFACE]
        assert taken > 0.1 * b[m.B_GRAVITY]
        assert gained + taken == pytest.approx(given, abs=1e-14 * per_time * was)


def momentum(state: RowState) -> float:
    """Momentum of the water of a periodic row over density and area of a segment [m2/s]."""
    return float((0.5 * (state.content + np.roll(state.content, 1, axis=0)) * state.u).sum())


def test_its_grains_are_measured_shown_and_exported_as_those_of_one_column(reach: Results) -> None:
    assert reach.measure("transport", begin=0.0)["q_star"].value > 0.0
    data, _ = encoded(reach)
    assert data["flow"]["solved"] and data["flow"]["z"] == reach.row.row.column.z.tolist()
    assert data["arrays"]["line"]["shape"] == [4, 6] and len(data["flow"]["x"]) == 6
    assert surfaces(reach) == pytest.approx(reach.row.surface.mean(axis=1))
    assert table_of_frame(reach, 1).bed_area == reach.row.row.column.area
    assert len(reach.measure("long_section").rows()) == 4
    with pytest.raises(ResultsError, match="row of columns; ryusa measure RUN long_section"):
        reach.measure("water")


def test_depth_counts_from_where_grains_fall_below_half_of_packed(reach: Results) -> None:
    row, column = reach.row, reach.row.row.column
    cells = 40 + 10 * np.arange(4)  # of the bed, in each segment
    phi = np.where(np.arange(column.n) < cells[:, None], column.phi_max, 0.0)
    fields = {name: getattr(row, name) for name in row.flow.fields()}
    fields["phi"] = np.tile(phi, (len(row.t), 1, 1))
    told = WaterFrames(row.flow, row.t, **fields)
    run = SimpleNamespace(scene=reach.scene, frames=reach.frames, row=told, case=reach.case)
    one, every = long_section(run), depth_history(run)
    assert one.bed == pytest.approx(column.z_low + cells * column.dz)
    assert one.depth == pytest.approx(row.surface[-1] - one.bed)
    assert every.depth[-1] == pytest.approx(one.depth)
    assert {"bed_m", "floor_m"} <= set(one.rows()[0])
    assert (long_section(reach).bed > column.z_low + 8.0e-3).all()


def test_grains_of_a_row_are_conserved_segment_by_segment_and_give_the_rate_of_transport(
    reach: Results,
) -> None:
    row, frames = reach.row.row, np.arange(len(reach.frames))
    held = grains_along_row(reach, row, frames)
    gained = np.diff(held.volume, axis=0) * row.dx
    given = np.diff(held.passed - np.roll(held.passed, -1, axis=1), axis=0)
    assert np.abs(gained - given).max() < 1e-13 * held.volume.max() * row.dx
    assert np.abs(gained).max() > 1e-4 * held.volume.max() * row.dx
    q = reach.measure("transport", begin=0.0)["q"].value
    assert held.passed[-1].mean() / reach.frames.t[-1] == pytest.approx(q, rel=1e-9)
    found = long_section(reach, begin=0.0)
    assert found.solid_discharge.mean() == pytest.approx(q, rel=1e-9)
    assert (found.error["froude"] > 0.0).all() and (found.error["bed"] > 0.0).all()
    bed, rest = found.bed, long_section(reach, begin=0.0, bed="rest").bed
    assert (rest <= bed).all()
    cells = reach.row.phi.sum(axis=2) * row.column.dz  # of the water, with fixed grains
    assert np.diff(cells, axis=0) == pytest.approx(
        np.diff(held.volume, axis=0), abs=0.05 * np.abs(gained).max() / row.dx
    )


def test_check_explains_bed_flow_and_segments() -> None:
    one, many = (read_text(TEXT, {**SMALL, **more}) for more in ({}, row(4)))
    shown = {line.name: line.value for line in explain(many)}
    both = {line.name: line.value for line in explain(one)}
    for name in ("u_star", "tau_star", "bed thickness", "water over the bed", "cell", "expected motion"):
        assert shown[name] == both[name]
    assert shown["segments"] == 4 and shown["length of the row"] == pytest.approx(0.048)
    assert 1.0 < shown["wall time"] / both["wall time"] < 1.5
    assert resolved(many)["water"]["row"]["height"] is None


def test_case_json_and_check_have_the_cells_that_are_built(reach: Results) -> None:
    case = read_text(TEXT, {**SMALL, **row(4)})
    assert reach.row is not None
    column = reach.row.row.column
    assert resolved(case)["water"]["column"]["cell"] == column.dz
    assert reach.case["water"]["column"]["cell"] == column.dz
    assert cells_of_row(case) == pytest.approx(4 * column.n, rel=0.2)


@pytest.mark.parametrize(
    ("more", "key", "says"),
    [
        ({"water.buoyancy": "'weight'"}, "water.buoyancy", "must be 'stress' in a row"),
        ({"water.row.upstream": "{ end = 'wall' }"}, "water.row.upstream", "build.kind = 'stream'"),
        ({"water.row.bottom": "[['0 m', '0 m'], ['4.8 cm', '1 mm']]"}, "water.row.bottom", "z = 0"),
        ({"water.column.drive": "'discharge'"}, "water.column.drive", "'slope' or 'pressure gradient'"),
        ({"water.row.bottom": "[['0 m', '0 m'], ['5 cm', '0 m']]"}, "water.row.bottom", "must agree"),
        ({"stop.precision.tau_star": "'5 %'"}, "stop.precision.tau_star", "not a row"),
    ],
)
def test_what_a_row_with_grains_cannot_do_is_refused(more: dict[str, str], key: str, says: str) -> None:
    with pytest.raises((CaseError, ExceptionGroup)) as caught:
        build(read_text(TEXT, {**SMALL, **row(4), **more}))
    assert key in str(caught.value) and says in str(caught.value)
