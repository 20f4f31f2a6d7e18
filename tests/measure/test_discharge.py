"""Mass and number through feeds and exits; what other measures and pictures make of such a run."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.casefile.read import read_text
from ryusa.cases import case_path
from ryusa.catalogue import MEASURES, PICTURES
from ryusa.errors import CaseError, ResultsError
from ryusa.formats.export import export
from ryusa.formats.grains import table_of_frame
from ryusa.measure import discharge, passages
from ryusa.measure.snapshot import bounds, snapshot
from ryusa.results import Results
from ryusa.results.touching import contacts_per_grain
from ryusa.view.encode import positions, presence
from ryusa.view.page import encoded

HEAP = case_path("poured_heap.toml").read_text()
TEXT = (
    (HEAP[: HEAP.index("[rolling]")] + HEAP[HEAP.index("[motion]") : HEAP.index("[[feeds]]")]).replace(
        'plate = "4 cm"', ""
    )
    + """
[[feeds]]
name = "hose"
centre = ["10 cm", "0 m", "0 m"]
radius = "2 cm"
rate = "40 grains/s"
end = "1 s"

[[exits]]
name = "floor"
point = ["0 m", "0 m", "-122.5 cm"]
normal = [0, 0, -1]
"""
    + HEAP[HEAP.index("[time]") :]
)


@pytest.fixture(scope="module")
def fed(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Grains that fall through a hose past an exit: forty in a second, each half a second on its way."""
    changes = {
        "contact.stiffness": "1 N/cm", "stop.time": "1.5 s", "record.frames": "50 ms",
        "record.events": "all",  # as other runs of `make test`
    }  # fmt: skip
    folder = tmp_path_factory.mktemp("fed") / "run"
    return ryusa.run(read_text(TEXT, changes), folder, progress=False)


def test_what_is_there_is_what_entered_less_what_left(fed: Results) -> None:
    found = discharge(fed)
    there = np.array([np.isfinite(frame.x[:, 0]).sum() for frame in fed.frames])
    np.testing.assert_array_equal(found.n, there)
    np.testing.assert_array_equal(found.n_in - found.n_out, there)
    masses = [fed.scene.m[np.isfinite(frame.x[:, 0])].sum() for frame in fed.frames]
    np.testing.assert_allclose(found.m, masses, atol=1e-15)
    assert (found.n_in[-1], found.n_out[-1]) == (40, 40)
    np.testing.assert_allclose(found.by_feed["hose"], found.m_in)


def test_rates_are_those_of_the_feed(fed: Results) -> None:
    found = discharge(fed, begin=0.0, end=1.0)
    assert found["grains_in"].value == pytest.approx(40.0, abs=1.0)
    assert found["rate_in"].value == pytest.approx(40.0 * fed.scene.m.mean(), rel=0.05)
    later = discharge(fed, begin=0.6, end=1.4)
    assert later["grains_out"].value == pytest.approx(40.0, abs=2.0)
    rows = later.rows()
    assert set(rows[0]) >= {"t_s", "present", "in_kg", "out_kg", "rate_out_kg_per_s", "out_by_floor_kg"}


def test_passages_balance_with_what_the_last_frame_holds(fed: Results) -> None:
    found, there = passages(fed), np.isfinite(fed.frames.x[-1][:, 0])
    assert found.m_end == math.fsum(fed.scene.m[there])
    assert found.n_end == there.sum()
    assert len(found.rows()) == 80
    assert not found.gates[0].owed_n.any()
    whole = discharge(fed)
    assert found["rate_out"].value == pytest.approx(whole["rate_out"].value, rel=1e-9)
    fallen = [row["speed_m_per_s"] for row in found.rows() if row["way"] == "out"]
    g, h = float(np.linalg.norm(fed.scene.gravity)), 1.225  # from the hose to the exit
    v = float(np.linalg.norm(fed.scene.traffic.feeds[0].velocity)) if fed.scene.traffic else 0.0
    assert fallen == pytest.approx([math.sqrt(v * v + 2.0 * g * h)] * 40, rel=1e-9)


def test_a_run_without_feeds_has_no_discharge(tmp_path: Path) -> None:
    run = ryusa.run(
        read_text(case_path("drop.toml").read_text(), {"stop.time": "0.01 s"}),
        tmp_path / "run",
        progress=False,
    )
    with pytest.raises(ResultsError, match="no feeds and no exits"):
        discharge(run)
    with pytest.raises(ResultsError, match="no feeds and no exits"):
        passages(run)
    assert len(run.passages) == 0


@pytest.mark.parametrize("entry", [one for one in (*MEASURES, *PICTURES) if not one.fed])
def test_what_needs_the_same_grains_refuses_by_name(fed: Results, entry: Any) -> None:
    call = fed.measure if entry in MEASURES else fed.draw
    with pytest.raises(ResultsError, match="feeds or exits"):
        call(entry.name)
    if entry in MEASURES:
        function = getattr(ryusa.measure, entry.function.partition(":")[2])
        with pytest.raises(ResultsError, match=f"{entry.name} needs the same grains"):
            function(fed)


def test_the_others_take_grains_that_are_away(fed: Results) -> None:
    assert np.isfinite(fed.measure("energy").residual)
    assert len(fed.measure("collisions").rows()) >= 0
    for t in (0.0, 0.7):
        fed.draw("grains", t=t)
    fed.draw("energy")


def test_a_snapshot_holds_the_grains_that_are_there(fed: Results) -> None:
    seen = snapshot(fed, 0.7)
    k = int(np.abs(fed.frames.t - 0.7).argmin())
    assert len(seen.grains) == discharge(fed).n[k]
    assert np.isfinite(seen.x).all()
    assert len(contacts_per_grain(fed.frames.x_wrapped[k], fed.scene)) == fed.scene.n_grain
    box = bounds(fed)
    assert box.bottom < -1.0
    assert np.isfinite([box.left, box.right, box.bottom, box.top, box.speed]).all()


def test_a_table_of_a_frame_leaves_out_the_others(fed: Results, tmp_path: Path) -> None:
    k = int(np.abs(fed.frames.t - 0.7).argmin())
    table = table_of_frame(fed, k)
    there = np.flatnonzero(np.isfinite(fed.frames.x[k][:, 0]))
    np.testing.assert_array_equal(table.ids[~table.fixed], there)
    for kind in ("csv", "extxyz", "lammps-dump"):
        [path] = export(fed, tmp_path / f"grains.{kind}", kind)
        assert "nan" not in path.read_text()


def test_the_page_shows_grains_only_while_they_are_there(fed: Results) -> None:
    frames, grains = np.arange(len(fed.frames)), np.arange(fed.scene.n_grain)
    there = presence(fed, frames, grains)
    assert there is not None
    whole, quantum = positions(fed, frames, grains, lambda _row: None)
    x = np.asarray(fed.frames.x[:])
    np.testing.assert_allclose((whole * quantum)[there], x[there], atol=float(quantum.max()))
    # away: where it was last, or will be first
    first = there.argmax(axis=0)
    for g in grains:
        np.testing.assert_array_equal(whole[: first[g], g], np.tile(whole[first[g], g], (first[g], 1)))
    data, _ = encoded(fed)
    assert data["arrays"]["there"]["shape"] == [len(frames), len(grains)]
    assert "NaN" not in json.dumps(data)


def test_a_film_is_drawn_and_follows_no_grain(fed: Results, tmp_path: Path) -> None:
    from ryusa.view.film import film

    film(fed, tmp_path / "film.webp", frames=3, size=(480, 270))
    assert (tmp_path / "film.webp").stat().st_size > 0
    with pytest.raises(CaseError, match="cannot be used with feeds"):
        film(fed, tmp_path / "film.webp", frames=3, follow=0)


@pytest.mark.full
def test_a_silo_discharges_at_the_rate_of_beverloo(tmp_path: Path) -> None:
    """Two thirds of the grains of the packaged case: C between 0.45 and 0.7 with k = 1.4, for one seed."""
    less = {"build.most": "3000", "contact.stiffness": "100 N/cm", "stop.time": "0.8 s"}
    run = ryusa.run(ryusa.load(case_path("hopper.toml"), less), tmp_path / "run", progress=False)
    found = run.measure("discharge", begin=0.5)
    width, d = 0.024, 0.004
    z, frame = run.frames.x[20][:, 2], np.asarray(run.frames.t)[20]
    assert frame == pytest.approx(0.4, abs=1e-3)  # the shutter is still there
    packed = float(run.scene.m[(z > d) & (z < 4.0 * d)].sum()) / (np.pi * 0.036**2 * 3.0 * d)
    rate = found["rate_out"].value / (4.0 / np.pi * packed * np.sqrt(9.81) * (width - 1.4 * d) ** 2.5)
    assert 0.45 < rate < 0.7
    assert not found["rate_in"].value
    assert run.tally["residual"].max() < 1e-3


@pytest.mark.slow
def test_what_is_fed_into_the_packaged_flume_passes_its_weir(tmp_path: Path) -> None:
    """Once the room behind the weir is full; until then less leaves than comes in."""
    run = ryusa.run(ryusa.load(case_path("flume.toml")), tmp_path / "run", progress=False)
    late, early = run.measure("discharge"), run.measure("discharge", begin=0.05, end=0.6)
    assert late["rate_in"].value == pytest.approx(0.1, rel=0.03)
    error = np.hypot(late["rate_in"].error, late["rate_out"].error)
    assert abs(late["rate_out"].value - late["rate_in"].value) < 3.0 * error
    assert error < 0.06 * late["rate_in"].value
    assert early["rate_out"].value < 0.8 * early["rate_in"].value
    assert run.tally["residual"].max() < 1e-3
