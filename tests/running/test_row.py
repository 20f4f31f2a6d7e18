"""A row of columns from a case file: it runs, is recorded and read back, and resumes with the same bits."""

import shutil
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from PIL import Image

import ryusa
from ryusa.casefile import explain
from ryusa.casefile.read import read_text
from ryusa.catalogue import MEASURES, PICTURES
from ryusa.errors import CaseError, ResultsError, WaterError
from ryusa.formats.grains import table_of_frame
from ryusa.measure.long_section import long_section
from ryusa.measure.water_energy import water_energy
from ryusa.report.page import report_page
from ryusa.results import Results, schema
from ryusa.results.read import read_scenes
from ryusa.view.film import film
from ryusa.view.page import view_page

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

WEIR = """
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
[contact]
stiffness = "700 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
slope = "1/100"
[water]
profile = "column"
depth = "5 cm"
[water.column]
bed = "rough"
cell = "5 mm"
[water.row]
bottom = [["0 m", "0 cm"], ["2 m", "0 cm"]]
segments = 20
upstream = { end = "discharge", discharge = "0.03 m2/s" }
downstream = { end = "free fall" }
[[water.row.dams]]
name = "weir"
begin = "1.5 m"
end = "1.8 m"
height = "4 cm"
[build]
kind = "empty"
[stop]
time = "3 s"
[record]
frames = "0.1 s"
"""


def run(folder: Path, text: str = WEIR, overrides: dict[str, str] | None = None, **how: Any) -> Results:
    return ryusa.run(read_text(text, overrides or {}), folder, progress=False, **how)


@pytest.fixture(scope="module")
def weir(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return run(tmp_path_factory.mktemp("weir") / "run")


def test_what_enters_and_does_not_leave_is_in_the_row(weir: Results) -> None:
    found = weir.row
    assert found is not None
    held = found.volume.sum(axis=1) * found.row.dx
    assert held[0] == pytest.approx(0.05 * 1.4 + 0.01 * 0.3 + 0.05 * 0.3, rel=1e-12)
    gained = held - held[0]
    assert np.abs(gained - (found.passed[:, 0] - found.passed[:, -1])).max() < 1e-14
    assert found.passed[-1, 0] == pytest.approx(0.03 * 3.0, rel=1e-12)
    assert np.allclose(found.content.sum(axis=2), found.volume, rtol=1e-14)


def test_frames_hold_depths_speeds_and_discharges_that_agree(weir: Results) -> None:
    found = weir.row
    assert found is not None
    assert np.allclose(weir.frames.t, np.arange(31) * 0.1)
    assert found.u.shape == (31, 21, found.row.column.n) and found.w.shape == found.u.shape
    assert found.discharge[1:, 0] == pytest.approx(0.03, rel=1e-9)
    assert np.allclose(found.depth[-1], found.volume[-1])  # clear water
    assert (found.tau[1:, 2] > 0.0).all()
    assert weir.water is None
    water = weir.summary["water"]
    assert water["momentum_residual"] < 1e-10
    assert 0.1 < water["courant"] <= 0.5
    assert water["entered"] - water["left"] == pytest.approx(
        float((found.volume[-1] - found.volume[0]).sum() * found.row.dx), abs=1e-13
    )


def test_the_discharge_of_a_frame_is_what_passed_in_its_step_at_open_ends_too(tmp_path: Path) -> None:
    found = run(tmp_path / "run", WEIR, {"record.frames": "5 ms", "stop.time": "0.2 s"}).row
    assert found is not None
    assert np.allclose(np.diff(found.passed, axis=0) / 0.005, found.discharge[1:], rtol=1e-9, atol=1e-12)
    assert (found.discharge[-1, [0, -1]] > 0.01).all()


def test_a_run_with_a_pressure_of_its_own_keeps_it_and_is_resumed_with_the_same_bits(
    tmp_path: Path, stop_at: Any
) -> None:
    full = {"water.row.pressure": "full", "stop.time": "0.5 s"}
    whole = run(tmp_path / "whole", WEIR, full)
    found = whole.row
    assert found is not None
    cells = 0.5 * (found.w_faces[:, :, 1:] + found.w_faces[:, :, :-1])
    assert np.allclose(found.w[:, 1:-1], 0.5 * (cells[:, 1:] + cells[:, :-1]), rtol=0.0, atol=1e-15)
    assert np.abs(found.w[-1]).max() > 0.01
    assert np.abs(found.pressure[-1]).max() > 1.0  # Pa
    assert (found.pressure[-1][found.content[-1] == 0.0] == 0.0).all()
    stop_at(17)
    run(tmp_path / "run", WEIR, full)
    assert run(tmp_path / "run", WEIR, full, resume=True).complete
    assert differences(whole.folder, tmp_path / "run") == []
    with pytest.raises(ResultsError, match="water alone, and no grain to write"):
        table_of_frame(whole, -1)


def test_a_run_with_air_below_its_nappe_is_resumed_with_the_same_bits_on_any_number_of_threads(
    tmp_path: Path, stop_at: Any
) -> None:
    air = {"water.row.pressure": "full", "water.row.dams.0.aerated": "true", "stop.time": "0.5 s",
           "water.row.bottom": "[['0 m', '0 cm'], ['2.5 m', '0 cm']]", "water.row.segments": "50",
           "water.row.surface":
               "[['0 m', '8 cm'], ['1.8 m', '8 cm'], ['1.8 m', '2 cm'], ['2.5 m', '2 cm']]"}  # fmt: skip
    text = WEIR.replace('depth = "5 cm"', "")
    whole = run(tmp_path / "whole", text, air, threads=1)
    found = whole.row
    assert found is not None
    assert whole.scene.row.dams[0].aerated and found.u.shape[1:] == (51, found.row.column.n)
    held = found.volume.sum(axis=1) * found.row.dx
    assert np.abs(held - held[0] - (found.passed[:, 0] - found.passed[:, -1])).max() < 1e-14
    over, behind = found.passed[-1, found.row.dams[0].end :][:2]
    assert over > 0.003 and over - behind > 0.5e-3  # a part of it lands farther downstream
    assert water_energy(whole).residual < 1e-12
    (nappe,) = long_section(whole).nappes
    dam, x, z = found.row.dams[0], *nappe.outline.T
    face = found.row.x_low + dam.end * found.row.dx
    assert nappe.segment == dam.end - 1 and (x[0], z[0]) == pytest.approx((face, 0.04))
    assert x[-1] == pytest.approx(face) and z[-1] == pytest.approx(found.surface[-1, dam.end - 1])
    assert 0.05 < x.max() - face < 0.3 and z.min() < 0.04
    assert not long_section(whole, 0.0).nappes  # at rest
    stop_at(17)
    run(tmp_path / "run", text, air, threads=2)
    assert run(tmp_path / "run", text, air, resume=True, threads=2).complete
    assert differences(whole.folder, tmp_path / "run") == []


def test_the_energy_account_of_the_water_closes(weir: Results) -> None:
    found = water_energy(weir)
    assert len(found.t) == 31 and len(found.rows()) == 31
    assert found.residual < 1e-13
    assert found.given["upstream"][-1] > found.lost["fall"][-1] > found.lost["bed"][-1] > 0.0
    assert found.given["downstream"][-1] < 0.0
    assert not any(one[0] for one in (*found.changed.values(), *found.lost.values()))


def test_a_folder_of_a_version_without_the_account_is_refused(weir: Results, tmp_path: Path) -> None:
    old = tmp_path / "old"
    shutil.copytree(weir.folder, old)
    parts = sorted((old / "parts").glob("part-*.h5"))
    for path in parts:
        with h5py.File(path, "r+") as file:
            del file["row/energy"]
    with pytest.raises(ResultsError, match="has no 'row/energy': another version of ryusa wrote it"):
        water_energy(Results.open(old))


def test_a_long_section_has_the_stress_of_the_flow_up_to_the_inlet(weir: Results) -> None:
    tau = long_section(weir).tau
    assert tau[0] == pytest.approx(tau[1], rel=0.5)  # half of it with the inlet's own, 0


@pytest.mark.parametrize("view", [None, "flow_field"])
def test_a_film_of_water_alone_is_that_of_its_long_section_or_its_flow_field(
    weir: Results, tmp_path: Path, view: str | None
) -> None:
    path = tmp_path / "film.webp"
    made = film(weir, path, frames=3, size=(640, 360), view=view)
    with Image.open(path) as pictures:
        assert (pictures.n_frames, pictures.size) == (3, (640, 360))
        first = np.asarray(pictures.convert("RGB"))
        pictures.seek(2)
        last = np.asarray(pictures.convert("RGB"))
    assert made.times[[0, -1]] == pytest.approx(weir.frames.t[[0, -1]])
    apart = np.abs(first.astype(int) - last).max(axis=2) > 60
    assert apart.any()  # the water moves
    assert not apart[:, : 640 // 24].any()  # axes and their labels do not
    for key, value in (("colour", "spin"), ("follow", 0)):
        with pytest.raises(CaseError, match=f"is of films of grains; {view or 'long_section'} has none"):
            film(weir, path, view=view, **{key: value})
    with pytest.raises(CaseError, match="is of films of long sections"):
        film(weir, path, view="flow_field", bed="rest")
    with pytest.raises(ResultsError, match="has no free grains"):
        film(weir, path, view="side")


def test_a_page_of_water_alone_is_refused_by_name_and_a_report_goes_without(weir: Results) -> None:
    with pytest.raises(ResultsError, match="no free grains to show in motion; ryusa film shows its water"):
        view_page(weir)
    page = report_page([weir], size=1.0e6)
    assert "has no free grains to show in motion" in page
    assert "x_t" in page and "long_section" in page


@pytest.mark.parametrize("entry", [one for one in (*MEASURES, *PICTURES) if not one.grainless])
def test_what_needs_grains_refuses_water_alone_by_name(weir: Results, entry: Any) -> None:
    call = weir.measure if entry in MEASURES else weir.draw
    with pytest.raises(ResultsError, match="needs grains, and this run has water alone"):
        call(entry.name)


def test_a_run_that_was_stopped_resumes_with_the_same_bits(
    weir: Results, tmp_path: Path, stop_at: Any
) -> None:
    for step in (1, 33, 150):
        stop_at(step)
        assert run(tmp_path / "run", resume=True).status == schema.STOPPED
    run(tmp_path / "run", resume=True)
    assert differences(weir.folder, tmp_path / "run") == []


def test_water_behind_a_dam_in_a_tilted_frame_stays_still(tmp_path: Path) -> None:
    """A pond with a level surface over a bottom with a kink, between a wall and a dam that is dry behind."""
    text = WEIR.replace('depth = "5 cm"', "").replace(
        '[["0 m", "0 cm"], ["2 m", "0 cm"]]',
        '[["0 m", "0 cm"], ["1 m", "1 cm"], ["2 m", "0 cm"]]\n'
        'surface = [["0 m", "2 cm"], ["1.5 m", "3.5 cm"], ["1.5 m", "-1 cm"], ["2 m", "-1 cm"]]',
    )
    text = text.replace('{ end = "discharge", discharge = "0.03 m2/s" }', '{ end = "wall" }')
    found = run(tmp_path / "run", text, {"stop.time": "1 s"}).row
    assert found is not None
    assert np.abs(found.u).max() < 1e-12 and found.passed[-1, -1] == 0.0


def test_a_row_filled_over_its_top_stops_with_the_place(tmp_path: Path) -> None:
    text = WEIR.replace('{ end = "free fall" }', '{ end = "wall" }')
    with pytest.raises(WaterError, match=r"above the top of the column, at x = .*water\.row\.height"):
        run(tmp_path / "run", text, {"stop.time": "10 s", "water.row.height": "'20 cm'"})
    assert Results.open(tmp_path / "run").status == schema.FAILED


@pytest.mark.parametrize("engine", ["lammps"])
def test_other_engines_refuse_a_row(engine: str, tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="a row of columns of water goes with engine 'cpu' alone"):
        run(tmp_path / "run", engine=engine)


FLOOD = {
    "timeline": "[{ at = '0.75 s', discharge = '0.05 m2/s' }, { at = '1.5 s', discharge = '0.02 m2/s' }]",
    "stop.time": "'2.25 s'",
}


def test_a_hydrograph_in_steps_brings_its_volume(tmp_path: Path) -> None:
    """Each discharge enters from the step nearest to its time on."""
    found = run(tmp_path / "run", overrides=FLOOD)
    assert found.row is not None
    brought = found.row.passed[:, 0]
    asked = np.interp(found.row.t, [0.0, 0.75, 1.5, 2.25], np.cumsum([0.0, 0.0225, 0.0375, 0.015]))
    np.testing.assert_allclose(brought, asked, atol=0.05 * 2.0 * found.scene.dt)
    held = found.row.volume.sum(axis=1) * found.row.row.dx
    assert np.abs(held - held[0] - brought + found.row.passed[:, -1]).max() < 1e-13
    assert [scene.row.upstream.discharge for _, _, scene in read_scenes(tmp_path / "run")] == [
        0.03,
        0.05,
        0.02,
    ]


def test_a_run_stopped_within_a_flood_gives_the_same_bits(tmp_path: Path, stop_at: Any) -> None:
    whole = run(tmp_path / "whole", overrides=FLOOD)
    half = round(1.0 / whole.scene.dt)
    for step in (half // 2, half, 2 * half):
        stop_at(step)
        assert run(tmp_path / "run", overrides=FLOOD, resume=True).status == schema.STOPPED
    assert run(tmp_path / "run", overrides=FLOOD, resume=True).complete
    assert differences(whole.folder, tmp_path / "run") == []


@pytest.mark.parametrize(
    ("discharge", "more", "says"),
    [
        ("-0.01 m2/s", {}, "must be 0 or above"),
        ("6 L/s", {}, "discharge of the whole width"),
        ("0.04 m2/s", {"water.row.upstream": "{ end = 'wall' }"}, "needs water.row.upstream with end ="),
        (
            "0.04 m2/s",
            {"water.row.upstream": "{ end = 'discharge', discharge = '0.03 m2/s', depth = '8 cm' }"},
            "would hold the depth at every discharge",
        ),
    ],
)
def test_a_discharge_that_cannot_enter_is_refused(discharge: str, more: dict[str, str], says: str) -> None:
    with pytest.raises(CaseError) as caught:
        read_text(WEIR, {"timeline": f"[{{ at = '1 s', discharge = '{discharge}' }}]"} | more)
    assert any(says in one.line for one in (caught.value, *caught.value.others))


def test_cells_and_step_are_made_for_the_peak() -> None:
    steady, flood = ({row.name: row for row in explain(read_text(WEIR, one))} for one in ({}, FLOOD))
    assert flood["Courant number"].value > steady["Courant number"].value
    assert flood["cell"].origin != steady["cell"].origin  # of how many
    assert flood["discharge from 0.75 s"].value == 0.05


@pytest.mark.full
@pytest.mark.parametrize("first", ["0.03 m2/s", "0 m2/s"])
def test_a_flood_begins_and_ends_with_no_discharge(tmp_path: Path, first: str) -> None:
    upstream = f"{{ end = 'discharge', discharge = '{first}' }}"
    steps = "[{ at = '0.5 s', discharge = '0.02 m2/s' }, { at = '1 s', discharge = '0 m2/s' }]"
    found = run(
        tmp_path / "run", overrides={"water.row.upstream": upstream, "timeline": steps, "stop.time": "1.5 s"}
    )
    before = 0.5 * (0.03 if first.startswith("0.03") else 0.0)
    assert found.complete
    assert found.row.passed[-1, 0] == pytest.approx(before + 0.5 * 0.02, rel=0.02)
