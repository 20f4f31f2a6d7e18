"""Grains along a row of columns, in runs made up by hand with volumes, fluxes and lines in closed form."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.measure.made_rows import BALL, CELLS, DX, DZ, PACKED, WIDTH, D, G, layered, row_of, run_of
from tests.water import test_row_dams, test_row_grains

from ryusa.errors import CaseError, ResultsError
from ryusa.figures.long_section import long_section as long_section_figure
from ryusa.figures.long_section import x_t
from ryusa.measure import deposit
from ryusa.measure.along_row import grains_along_row, moving_in_row, segments_of
from ryusa.measure.depth_history import depth_history
from ryusa.measure.long_section import long_section
from ryusa.model.column import Column
from ryusa.model.feeds import IN, OUT, PASSAGE
from ryusa.model.row import ColumnRow, RowDam
from ryusa.water.row import shape_of
from ryusa.water.row_grains import GrainsInRow
from ryusa.water.row_sums import GrainPlaces, place_grains


@pytest.fixture
def cloud() -> Any:
    """Grains of random speeds in a period, for 2 s."""
    rng = np.random.default_rng(1)
    v = np.zeros((50, 3))
    v[:, 0] = rng.normal(0.02, 0.03, 50)
    t = np.linspace(0.0, 2.0, 21)
    x = np.stack([0.1 + 0.08 * rng.random(50), np.zeros(50), 0.01 * rng.random(50)], axis=1)
    x = x + t[:, None, None] * v
    return run_of(row_of(), t, x, np.broadcast_to(v, x.shape))


@pytest.mark.parametrize("ends", [False, True])
@pytest.mark.parametrize("n", [2, 3, 8])
def test_grains_are_shared_between_segments_as_by_the_water(n: int, ends: bool) -> None:
    row, x = row_of(n, ends=ends), 0.1 + n * DX * np.linspace(-0.5, 1.5, 401)
    shape, places = shape_of(row), GrainPlaces.of(len(x), n)
    place_grains(x, row.x_low, 0.0, shape, places)
    at, weight, _ = segments_of(x, row)
    assert np.array_equal(at + (1 if ends else 0), places.at)
    assert weight == pytest.approx(places.weight, abs=1e-12)


@pytest.mark.parametrize("porous", [False, True])
def test_grains_beside_a_dam_are_in_the_cells_in_which_the_water_has_them(porous: bool) -> None:
    row, at = test_row_dams.dammed(0.0, porous)
    at[:, 2] += 0.5 * D
    made, _ = test_row_grains.cloud(at=at, length=math.inf, tilt=0.0)
    water = GrainsInRow.begin(made, row, at).phi - (0.0 if row.porous is None else row.porous.phi)
    frames = SimpleNamespace(x=at[None], v=np.ones((1, *at.shape)))
    run: Any = SimpleNamespace(scene=made, frames=frames)
    found: Any = SimpleNamespace(row=row)
    assert moving_in_row(run, found, 0) == pytest.approx(water, abs=1e-12)
    held = grains_along_row(run, row, np.arange(1)).volume[0]
    assert held == pytest.approx(water.sum(axis=1) * row.column.dz, rel=1e-12, abs=1e-15)


def behind_dam() -> ColumnRow:
    """A dam of 8 mm, 16 cells, in the segment from 0.14 to 0.15 m, over a bottom that falls by 1 in 20."""
    row = replace(
        row_of(ends=True, bottom=0.01 - 0.05 * DX * np.arange(8)), dams=(RowDam("dam", 4, 5, 0.016),)
    )
    return replace(row, solid=np.where(np.arange(8) == 4, 16, 0))


@pytest.mark.parametrize("upstream", [False, True])
def test_no_part_of_a_grain_passes_into_a_dam_but_over_its_crest(upstream: bool) -> None:
    """It lies against the dam, rises beside it, and is on the crest at the end."""
    row, n = behind_dam(), 401
    face = 0.14 - 0.5 * D if upstream else 0.15 + 0.5 * D
    x, t = np.zeros((n, 1, 3)), np.linspace(0.0, 1.0, n)
    x[:, 0, 0] = face + (0.145 - face) * np.clip(3.0 * t - 2.0, 0.0, 1.0)
    x[:, 0, 2] = (
        0.5 * D + 0.01 - 0.05 * (0.035 if upstream else 0.055) + 0.012 * np.clip(3.0 * t - 1.0, 0.0, 1.0)
    )
    found = grains_along_row(run_of(row, t, x, np.gradient(x, t, axis=0)), row, np.arange(n))
    assert np.abs(found.volume[: n // 3, 4]).max() == 0.0
    assert found.volume[-1, 4] * DX * WIDTH == pytest.approx(0.75 * BALL, rel=1e-12)
    gained = (found.volume - found.volume[0]) * DX
    rest = gained - (found.passed[:, :-1] - found.passed[:, 1:] + found.fed)
    assert np.abs(rest).max() < 1e-15 * BALL / WIDTH
    through = np.cumsum(0.5 * (found.flux[1:] + found.flux[:-1]) * np.diff(t)[:, None], axis=0)
    assert np.abs(through - found.passed[1:])[:, 1:-1].max() < 0.01 * BALL / WIDTH
    assert np.abs(found.flux[:, 4 if upstream else 5]).max() > 0.0


@pytest.mark.parametrize("n", [1, 2, 8])
def test_what_segments_gain_is_what_passes_their_ends(cloud: Any, n: int) -> None:
    row = row_of(n, dx=0.08 / n)
    found = grains_along_row(cloud, row, np.arange(21))
    gained = (found.volume - found.volume[0]) * row.dx
    given = found.passed - np.roll(found.passed, -1, axis=1)
    assert np.abs(gained - given).max() < 1e-12 * 50 * BALL / WIDTH
    assert found.volume.sum(axis=1) * row.dx * WIDTH == pytest.approx(50 * BALL, rel=1e-13)
    assert np.ptp(found.volume[:, 0]) > 0.0 or n == 1


def test_what_passes_is_volume_times_speed_over_the_length(cloud: Any) -> None:
    """Averaged along the row, at every frame and between frames, exactly."""
    found = grains_along_row(cloud, cloud.row.row, np.arange(21))
    q = BALL * cloud.frames.v[0][:, 0].sum() / (0.08 * WIDTH)
    assert found.flux.mean(axis=1) == pytest.approx(q, rel=1e-12)
    assert found.passed[-1].mean() / 2.0 == pytest.approx(q, rel=1e-12)


def test_the_speeds_of_a_frame_give_what_passes_in_a_short_time(cloud: Any) -> None:
    cloud.frames.x = cloud.frames.x[:2].copy()
    cloud.frames.x[1] = cloud.frames.x[0] + 1.0e-6 * cloud.frames.v[0]
    found = grains_along_row(cloud, cloud.row.row, np.arange(2))
    assert found.flux[0] == pytest.approx(found.passed[1] / 1.0e-6, rel=1e-4, abs=1e-9)


def test_a_row_with_ends_feeds_and_an_exit_balances_to_round_off() -> None:
    """One grain lies still; one is fed at 0.11 m and leaves at 0.18 m; one comes and goes between frames."""
    t, v = np.array([0.0, 0.5, 1.0, 1.5]), 0.05
    x = np.full((4, 4, 3), np.nan)
    x[:, 0] = (0.142, 0.0, 0.001)
    x[1, 1] = (0.11 + 0.3 * v, 0.0, 0.001)
    x[2, 1] = (0.11 + 0.8 * v, 0.0, 0.001)
    x[3, 3] = (0.13, 0.0, 0.001)
    story = [
        (1, IN, 0.2, 0.11),
        (2, IN, 0.55, 0.13),
        (2, OUT, 0.85, 0.18),
        (1, OUT, 1.4, 0.18),
        (3, IN, 1.5, 0.13),
    ]
    rows = np.zeros(len(story), PASSAGE)
    for one, (grain, way, time, place) in zip(rows, story, strict=True):
        one["grain"], one["way"], one["t"], one["step"] = grain, way, time, round(time * 1000)
        one["x"], one["d"] = (place, 0.0, 0.001), D
    run = run_of(row_of(ends=True), t, x, np.zeros_like(x), rows)
    found = grains_along_row(run, run.row.row, np.arange(4))
    gained = (found.volume - found.volume[0]) * DX
    rest = gained - (found.passed[:, :-1] - found.passed[:, 1:] + found.fed)
    assert np.abs(rest).max() < 1e-15 * BALL / WIDTH
    passed = found.passed[-1] * WIDTH / BALL
    assert passed[-1] == pytest.approx(2.0)  # the exit lies at the end of the row
    assert passed[4] == pytest.approx(2.0, abs=1e-12)  # the third grain was placed upstream of it, and stays
    assert passed[1] == pytest.approx(0.5)  # on the station the first was fed
    assert passed[0] == pytest.approx(0.5)  # and half of it counts as coming through the end
    assert found.fed[-1].sum() * WIDTH / BALL == pytest.approx(0.5 + 1.0 + 1.0)


def test_a_periodic_row_with_feeds_is_refused() -> None:
    rows, x = np.zeros(0, PASSAGE), np.full((2, 2, 3), 0.15)
    with pytest.raises(ResultsError, match="periodic row with feeds"):
        grains_along_row(run_of(row_of(), np.arange(2.0), x, x, rows), row_of(), np.arange(2))


def test_lines_depth_and_froude_number_over_an_inclined_bottom() -> None:
    """Bed at 5 to 12 mm over a bottom that falls by 1 in 10, surface at 30 mm above it, q_w = 0.02 m2/s."""
    bottom = 0.01 - 0.1 * DX * np.arange(8)
    row = row_of(ends=True, bottom=bottom)
    levels = 5.0e-3 + 1.0e-3 * np.arange(8)
    phi = np.tile(layered(row, levels, 0.1), (5, 1, 1))
    content = (1.0 - phi) * DZ * ((np.arange(CELLS) + 0.5) * DZ < 0.03)
    t, x = np.arange(5) * 0.1, np.full((5, 1, 3), 0.14)
    run = run_of(
        row, t, x, np.zeros_like(x), surface=np.tile(bottom + 0.03, (5, 1)), phi=phi, content=content,
        discharge=np.full((5, 9), 0.02), passed=np.tile(0.02 * t[:, None], (1, 9)),
    )  # fmt: skip
    one, mean = long_section(run), long_section(run, begin=0.0)
    assert one.bed == pytest.approx(bottom + levels, abs=0.51 * DZ)
    for found in (one, mean):
        depth = found.surface - found.bed
        assert found.depth == pytest.approx(depth)
        assert found.speed == pytest.approx(0.02 / depth)
        steep = 1.0 + 0.1**2  # 1 + tan^2 of the bottom to the x axis, which falls by 0.01 itself
        assert found.froude == pytest.approx(0.02 / np.sqrt(G * (1.0 - 0.01 * 0.1) / steep**2 * depth**3))
        assert found.concentration == pytest.approx(0.1, abs=0.02)
        assert found.transport_concentration == pytest.approx(0.0)
    assert mean.window == (0.0, 0.4) and one.window is None
    assert mean.error["bed"] == pytest.approx(0.0) and mean.error["froude"] == pytest.approx(0.0)
    assert {"bed_m", "bed_error_m", "froude_error", "discharge_error_m2_per_s"} <= set(mean.rows()[0])
    with pytest.raises(ResultsError, match="not both"):
        long_section(run, t=0.1, begin=0.0)


def test_the_concentration_of_the_discharge_is_that_of_both_discharges(cloud: Any) -> None:
    n = len(cloud.frames.t)
    q_s = grains_along_row(cloud, cloud.row.row, np.arange(n)).passed[-1] / 2.0
    cloud.row.passed[:] = 1.0e-4 * cloud.frames.t[:, None]
    found = long_section(cloud, begin=0.0)
    both = 0.5 * (q_s + np.roll(q_s, -1))
    assert found.solid_discharge == pytest.approx(both, rel=1e-12)
    assert found.transport_concentration == pytest.approx(both / (both + 1.0e-4), rel=1e-12)
    assert (found.error["transport_concentration"] > 0.0).all()


def test_the_bed_of_grains_at_rest_lies_below_those_that_move() -> None:
    """Layers of grains in every segment: two rest, the third and fourth move as densely packed."""
    row = row_of(4)
    n, side = 4, D * (np.pi / 6.0 / PACKED) ** (1.0 / 3.0)  # spacing of cubes with the concentration
    along, across = np.arange(0.1, 0.1 + 4 * DX, side / 40), np.zeros(1)
    places, speeds = [], []
    for k in range(n):
        for one in along:
            places.append((one, across[0], (k + 0.5) * D))
            speeds.append((0.2 if k > 1 else 0.0, 0.0, 0.0))
    x, v = np.array(places)[None], np.array(speeds)[None]
    full = len(along) * BALL / (D * 4 * DX)  # concentration times width
    object.__setattr__(row, "column", Column(**{**vars(row.column), "area": full / PACKED * 4 * DX}))
    levels = np.full(4, n * D)
    run = run_of(row, np.zeros(1), x, v, phi=layered(row, levels, 0.0)[None], surface=np.full((1, 4), 0.03))
    assert long_section(run).bed == pytest.approx(n * D, abs=DZ)
    assert long_section(run, bed="rest").bed == pytest.approx(2 * D, abs=2 * DZ)


def test_a_bed_that_rises_and_what_passes_between_frames_are_the_history(cloud: Any) -> None:
    row = cloud.row.row
    levels = 5.0e-3 + 1.0e-3 * np.arange(21)[:, None] * np.ones(8)
    for k in range(21):
        cloud.row.phi[k] = layered(row, levels[k], 0.0)
    cloud.row.surface[:] = 0.03
    found = depth_history(cloud, begin=0.5, end=1.5)
    assert found.bed_change[-1] == pytest.approx(0.010, abs=DZ)
    assert np.isnan(found.solid_discharge[0]).all()
    assert found.froude[0] == pytest.approx(long_section(cloud, t=0.5).froude) and found.froude[0].max() > 0.0
    held = grains_along_row(cloud, row, np.arange(5, 16))
    assert found.volume == pytest.approx(held.volume)
    gained = np.diff(found.volume, axis=0).sum() * row.dx
    assert gained == pytest.approx(0.0, abs=1e-15)
    assert {"t_s", "bed_m", "bed_change_m", "volume_m", "solid_discharge_m2_per_s"} <= set(found.rows()[0])


def test_a_word_that_is_none_is_refused_with_the_nearest(cloud: Any) -> None:
    for measure in (long_section, depth_history, deposit):
        with pytest.raises(
            CaseError, match=r"bed = 'Rest': must be one of packed, rest. Did you mean 'rest'"
        ):
            measure(cloud, bed="Rest")
    with pytest.raises(CaseError, match=r"quantity = 'dept': must be one of .* Did you mean 'depth'"):
        x_t(depth_history(cloud), quantity="dept")


def test_the_rise_of_the_bed_counts_from_the_end_of_settling() -> None:
    """A bed that is laid loose sinks by 1 cm in the first tenths of a second, and then rises by 2 mm."""
    row, t = row_of(ends=True), np.arange(6) * 0.1
    levels = np.array([0.018, 0.012, 0.008, 0.008, 0.009, 0.010])
    phi = np.stack([layered(row, np.full(row.n_segment, one), 0.0) for one in levels])
    run = run_of(row, t, np.full((6, 1, 3), 0.14), np.zeros((6, 1, 3)), phi=phi)
    assert depth_history(run).bed_change[-1] == pytest.approx(-0.008)
    run.case["record"] = {"settle": 0.2}
    found = depth_history(run)
    assert found.t[0] == pytest.approx(0.2) and found.bed_change[-1] == pytest.approx(0.002)
    assert depth_history(run, begin=0.0).bed_change[-1] == pytest.approx(-0.008)
    figure = x_t(found, "bed")
    assert any("rise of the bed since 0.2 s" in one.get_ylabel() for one in figure.axes)


def test_pictures_of_large_rivers_are_in_metres(cloud: Any) -> None:
    """A depth of 4 m and a transport of 1 m2/s more."""
    small, large = depth_history(cloud), depth_history(cloud)
    large = replace(large, depth=large.depth + 4.0, solid_discharge=large.solid_discharge + 1.0)
    for found, length, rate in ((small, "cm", "cm²/s"), (large, "m", "m²/s")):
        labels = {one.get_xlabel() for one in x_t(found).axes}
        assert f"depth  ({length})" in labels
        assert f"grains  $q_s$  ({rate})" in labels
    elevations = long_section_figure(long_section(cloud)).axes[0]
    assert elevations.get_ylabel() == "elevation  (cm)"
