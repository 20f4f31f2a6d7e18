import json
import re
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ryusa.build import scene
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.catalogue import EVERY_BUILDER, MEASURES, PICTURES
from ryusa.cli import app
from ryusa.measure.long_section import LongSection
from ryusa.report.contents import RunContents, _of_segments, contents_of
from ryusa.report.page import differing, report_page, side_by_side
from ryusa.results import Results
from ryusa.running.lock import locked
from ryusa.running.runner import run, run_scene
from ryusa.running.stops import Stop
from ryusa.view.page import view_page

SCRIPT = "</script><script>alert(1)</script><img src=x onerror=alert(2)>"


def saltation(folder: Path, **changes: str) -> Results:
    every = {"build.starts": "3", "stop.time": "0.5 s", "record.settle": "0 s", **changes}
    return run(read(case_path("saltation.toml"), every), folder, progress=False)


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> list[Results]:
    """Two runs that differ in their friction."""
    folder = tmp_path_factory.mktemp("runs")
    return [
        saltation(folder / "smooth", **{"contact.friction_angle": "20 deg"}),
        saltation(folder / "rough", **{"contact.friction_angle": "30 deg"}),
    ]


def contents(one: Results) -> RunContents:
    return contents_of(one, size=5.0e6, progress=lambda share: None)


def test_a_run_has_its_measures_with_errors_its_pictures_and_its_values(runs):
    found = contents(runs[0])
    others = {"walls", "discharge", "passages"}  # of runs that have walls, or feeds and exits
    assert {one.name for one in found.measures} == {
        one.name for one in MEASURES if "saltation" in one.builders
    } - others
    assert {one.name for one in found.drawings} == {
        one.name for one in PICTURES if "saltation" in one.builders
    } - others
    assert found.missing == []
    height = found.averages["saltation: jump_height"]
    row = next(row for table in found.measures for row in table.rows if row[0] == "jump_height")
    assert row[1] == f"{height.value:.4g}"
    assert row[2].rstrip("*") == f"{height.error:.2g}"
    assert row[2].endswith("*") == height.short
    assert row[6] == height.verdict
    assert any(one.name == "diameter" and one.shown == "0.2 cm" for one in found.values)
    assert 'title = "Saltation' in found.case_text


def test_the_energy_account_and_the_state_are_in_words(runs):
    page = report_page(runs[:1], size=5.0e6)
    assert "normal dashpots" in page
    assert "of the largest term of the energy account" in page
    assert "complete: reached" in page


def test_several_runs_show_what_differs_between_their_cases_and_nothing_else(runs):
    found = [contents(one) for one in runs]
    names = [name for name, _ in differing(found)]
    assert any("friction" in name for name in names)
    assert not any("diameter" in name or "stiffness" in name for name in names)
    rows = {name: [cell["text"] for cell in cells] for name, _, cells in side_by_side(found)}
    for k, one in enumerate(found):
        average = one.averages["saltation: jump_height"]
        assert rows["saltation: jump_height"][k].startswith(f"{average.value:.4g} ±")


def test_a_run_that_is_not_complete_says_so(runs, monkeypatch):
    monkeypatch.setitem(runs[0].provenance, "status", "stopped")
    assert "smooth is not complete: stopped" in report_page(runs[:1], size=5.0e6)


def test_what_cannot_be_had_is_listed_with_its_reason(tmp_path):
    short = saltation(tmp_path / "short", **{"stop.time": "20 ms", "record.frames": "10 ms"})
    found = contents(short)
    assert any(
        what == "picture hops" and "hops over fixed grains" in reason for what, reason in found.missing
    )
    assert "does not hold hops over fixed grains" in report_page([short], size=5.0e6)


def test_a_run_from_a_script_has_a_report_without_a_case(tmp_path):
    flying, state = scene(np.array([[0.0, 0.0, 0.01]]), 0.002, v=np.array([[0.1, 0.0, 0.0]]), gravity=0.0)
    made = run_scene(flying, state, tmp_path / "script", frames=0.01, stop=Stop(time=0.05), progress=False)
    found = contents(made)
    assert ("case", "the run was made from a script and holds no case file") in found.missing
    assert {"grains", "energy"} <= {one.name for one in found.drawings}
    assert found.viewer is not None


def test_text_of_a_stranger_stays_text(tmp_path, monkeypatch):
    made = saltation(tmp_path / "<img src=x onerror=alert(3)>", **{"stop.time": "50 ms"})
    monkeypatch.setitem(made.case, "title", SCRIPT)
    toml = made.folder / "case.toml"
    toml.write_text(toml.read_text() + f"\n# {SCRIPT}\n")
    monkeypatch.setitem(made.provenance, "message", SCRIPT)
    page = report_page([made], size=5.0e6)
    assert not re.search(r"<img (?!src=\"data:image/png;base64,)", page)
    assert "<script>alert" not in page
    assert page.count("&lt;img") >= 3


def test_a_page_may_load_nothing_from_anywhere(runs):
    page = report_page(runs, size=5.0e6)
    assert "default-src &#39;none&#39;" in page
    assert not re.search(r"(src|href)=[\"']?(https?:)?//", page)


def test_every_builder_has_a_picture_and_every_name_is_a_builder():
    from ryusa.casefile.read import json_schema

    kinds = set(json_schema()["properties"]["build"]["discriminator"]["mapping"])
    assert set(EVERY_BUILDER) == kinds
    assert {kind for one in (*MEASURES, *PICTURES) for kind in one.builders} <= kinds


@pytest.mark.full
def test_the_command_writes_beside_the_run_or_where_it_is_asked(runs, tmp_path):
    result = CliRunner().invoke(app, ["report", str(runs[0].folder), "-q"])
    assert result.exit_code == 0, result.output
    assert (runs[0].folder / "report.html").exists()
    both = tmp_path / "both.html"
    result = CliRunner().invoke(app, ["report", *(str(one.folder) for one in runs), "-o", str(both), "-q"])
    assert result.exit_code == 0, result.output
    assert "What differs between the cases" in both.read_text()
    result = CliRunner().invoke(app, ["report", str(runs[0].folder), "-o", "page.pdf"])
    assert "must end in .html" in result.stderr


@pytest.mark.parametrize(("n", "listed"), [(8, 8), (24, 24), (25, 12), (100, 20)])
def test_a_table_of_segments_stays_short_and_says_what_it_leaves_out(n: int, listed: int) -> None:
    names = ("bottom", "floor", "bed", "surface", "depth", "discharge", "speed", "froude", "critical",
             "energy", "tau", "volume", "solid_discharge", "transport_concentration",
             "concentration")  # fmt: skip
    row = {name: np.full(n, 0.5) for name in names}
    found = LongSection(t=1.0, slope=0.0, x=np.arange(n) * 0.1, dams=(), **row)
    entry = next(one for one in MEASURES if one.name == "long_section")
    table = _of_segments(entry, found)
    assert len(table.rows) == listed <= 24
    assert any(f"all {n}" in note for note in table.notes) == (listed < n)


def test_a_run_whose_process_was_killed_is_called_so_on_every_page(tmp_path: Path) -> None:
    folder = saltation(tmp_path / "killed").folder
    written = json.loads((folder / "provenance.json").read_text())
    (folder / "provenance.json").write_text(
        json.dumps(written | {"status": "running"})
    )  # as kill -9 leaves it
    found = Results.open(folder)
    assert found.status == "running"  # what the folder says, and what is true of it
    assert contents(found).status == "killed"
    assert 'status": "killed"' in view_page(found)
    with locked(folder):
        assert contents(found).status == "running"
