"""Feeds and exits in a column of water: volume, momentum and energy close at every frame, the same bits."""

import math
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.engine.conftest import D
from tests.engine.test_clumps_in_water import cloud

from ryusa.laws.dispatch import hindered
from ryusa.laws.families import Drag, Hindrance, SurfaceRule
from ryusa.model import Exit, Feed, Scene, State, Traffic
from ryusa.model.feeds import IN, OUT
from ryusa.model.fluid import EXTRA_X
from ryusa.results import Results
from ryusa.running import loop as loop_module
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop
from ryusa.water.coupling import Coupling

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

pytestmark = pytest.mark.full

RHO, G = 1000.0, 9.80665
INTERVAL, STEPS, EVERY = 40, 2000, 25


def fed(surface: SurfaceRule = SurfaceRule.VOLUME) -> tuple[Scene, State]:
    """Clumps and spheres fall through flowing water: 30 are there, 50 enter through a disc and a box.

    The disc is above the surface. What gets near the bed leaves; some of that comes in again.
    """
    made, column = cloud()
    scene, state = made
    n_first, (wide, _) = 30, scene.period
    first = int(scene.spheres_of(np.arange(scene.n_grain))[0])
    assert first == 0
    heads = np.flatnonzero(scene.heads)
    begin = int(heads[n_first])
    half = int(heads[55])
    middle, low = 0.5 * wide, 8.0 * D
    feeds = (
        Feed(
            "hose", centre=(middle, middle, 26.0 * D), normal=(0.0, 0.0, -1.0), radius=3.0 * D, rate=4000.0,
            velocity=(0.1, 0.05, -0.8), first=begin, count=half - begin, seed=3,
        ),
        Feed(
            "box", low=(0.0, 0.0, 19.0 * D), high=(wide, wide, 22.0 * D), rate=2000.0, begin=0.002, seed=5,
            velocity=(0.2, 0.0, -0.3), first=half, count=scene.n_grain - half,
        ),
    )  # fmt: skip
    exits = (
        Exit("again", low=(-D, -1.0, -1.0), high=(3.0 * D, 1.0, low), to=0),
        Exit("out", low=(3.0 * D, -1.0, -1.0), high=(wide + D, 1.0, low)),
    )
    there = np.arange(scene.n_grain) < begin
    x, v, omega = (np.where(there[:, None], one, np.nan) for one in (state.x, state.v, state.omega))
    scene = replace(
        scene, traffic=Traffic(feeds, exits, INTERVAL, begin), flow=replace(column, surface=surface),
        world_low=(-1.0, -1.0, -1.0), world_high=(1.0, 1.0, 1.0),
    )  # fmt: skip
    return scene, replace(state, x=x, v=v, omega=omega, present=there)


def carried_out(folder: Path, surface: SurfaceRule = SurfaceRule.VOLUME, **how: Any) -> Results:
    made = fed(surface)
    dt = made[0].dt
    return run_scene(*made, folder, frames=EVERY * dt, stop=Stop(time=STEPS * dt), progress=False, **how)


@dataclass
class Books:
    """Momentum of grains and water along the bed at every frame of a run, and what has changed it [N s]."""

    run: Results = field(init=False)
    held: list[float] = field(default_factory=list[float])
    given: float = 0.0  # by the bed, and by weight and surface of the water
    at_frames: list[float] = field(default_factory=list[float])
    water: list[float] = field(default_factory=list[float])  # its volume [m3]
    solid: list[float] = field(default_factory=list[float])  # volume of the grains in cells [m3]


def along(scene: Scene, v: np.ndarray, bodies: Any) -> float:
    """Momentum of grains along the bed, each clump as one [N s]."""
    alone = scene.bodies.of_grain(scene.n_grain) < 0
    return float(np.nansum(scene.m[alone] * v[alone, 0]) + np.nansum(scene.bodies.m * bodies.v[:, 0]))


def kept_books(folder: Path, surface: SurfaceRule) -> Books:
    """A run, and its books as it went."""
    kept = Books()
    record, exchange = loop_module.Loop._record, Coupling.exchange

    def exchanged(self: Coupling, *given: Any) -> Any:
        time = self.steps * self.scene.dt
        found = exchange(self, *given)
        budget = self.budget
        assert budget is not None
        outer = budget.gravity + budget.driver + budget.bed + budget.side + budget.surface
        kept.given += outer * self.column.area * time
        return found

    def recorded(self: Any) -> None:
        record(self)
        water, scene, state = self._water, self.scene, self.engine.state()
        content = np.asarray(water.state.content)
        elapsed = (self._step - (water.due - water.steps)) * scene.dt
        there = state.present
        owed = float(state.fluid.impulse[there, 0].sum())  # not given to the water yet
        archimedes = (scene.m_weight - scene.m)[there] * scene.gravity[0]
        owed += float((archimedes + state.fluid.sampled[there, EXTRA_X]).sum()) * elapsed
        of_water = RHO * water.column.area * float(content @ water.state.u)
        kept.held.append(of_water + along(scene, state.v, state.bodies) - owed)
        kept.at_frames.append(kept.given)
        kept.water.append(float(content.sum()) * water.column.area)
        kept.solid.append(float(water.phi.sum()) * water.column.dz * water.column.area)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Coupling, "exchange", exchanged)
        patch.setattr(loop_module.Loop, "_record", recorded)
        kept.run = carried_out(folder, surface)
    return kept


@pytest.fixture(scope="module")
def books(tmp_path_factory: pytest.TempPathFactory) -> Books:
    """Of a run with a constant volume of water."""
    return kept_books(tmp_path_factory.mktemp("fed") / "run", SurfaceRule.VOLUME)


@pytest.fixture(scope="module")
def at_depth(tmp_path_factory: pytest.TempPathFactory) -> Books:
    """Of a run with a constant depth: what grains displace leaves through the surface."""
    return kept_books(tmp_path_factory.mktemp("deep") / "run", SurfaceRule.DEPTH)


@pytest.fixture(scope="module")
def whole(books: Books) -> Results:
    return books.run


def passed(run: Results, amounts: np.ndarray) -> np.ndarray:
    """What came in less what left, up to each frame."""
    rows = run.passages
    return np.array([(rows["way"] * amounts)[rows["step"] <= step].sum() for step in run.frames.step])


def weight_along(run: Results) -> np.ndarray:
    """Impulse of the weight of grains and clumps along the bed up to each frame [N s]."""
    scene, rows, step = run.scene, run.passages, np.asarray(run.frames.step)
    n_first = scene.traffic.n_first
    first = scene.of_heads()[1][:n_first][scene.heads[:n_first]].sum()
    return (
        scene.dt
        * scene.gravity[0]
        * (first * step + step * passed(run, rows["m"]) - passed(run, rows["m"] * rows["step"]))
    )


@pytest.mark.parametrize("kept", ["books", "at_depth"])
def test_water_and_grains_gain_what_bed_weight_and_passages_give_at_every_frame(
    kept: str, request: pytest.FixtureRequest
) -> None:
    book: Books = request.getfixturevalue(kept)
    run, held = book.run, np.array(book.held)
    rows = run.passages
    assert (rows["way"] == IN).sum() > 40
    assert (rows["way"] == OUT).sum() > 10
    assert run.summary["water"]["momentum_residual"] < 1e-10
    crossed, scale = passed(run, rows["momentum"][:, 0]), np.abs(held).max()
    given = np.array(book.at_frames) + weight_along(run) + crossed
    assert np.abs(crossed).max() > 0.1 * scale
    np.testing.assert_allclose(held - held[0], given - given[0], rtol=0.0, atol=1e-12 * scale)


@pytest.mark.parametrize("kept", ["books", "at_depth"])
def test_grains_bring_their_volume_to_the_cells_and_take_it_along(
    kept: str, request: pytest.FixtureRequest
) -> None:
    book: Books = request.getfixturevalue(kept)
    run, scene = book.run, book.run.scene
    of_all = (scene.m - scene.m_weight) / RHO
    there = np.isfinite(run.frames.x[:, :, 2])
    volume = there @ of_all
    assert volume.max() > 1.5 * volume[0]
    np.testing.assert_allclose(book.solid, volume, rtol=1e-12)
    balance = of_all[: scene.traffic.n_first].sum() + passed(run, run.passages["m"]) / 2650.0
    np.testing.assert_allclose(volume, balance, rtol=1e-12)


def test_a_constant_volume_of_water_makes_room_for_grains_by_its_surface(books: Books) -> None:
    run, column = books.run, books.run.scene.column
    np.testing.assert_allclose(books.water, books.water[0], rtol=1e-13)
    wet = np.clip(run.water.z_surface[:, None] - column.faces[:-1], 0.0, column.dz)
    below = (run.water.phi * wet).sum(axis=1) * column.area  # volume of grains below the surface
    steps = run.frames.step  # the surface follows with the next exchange, a step after a passage
    at_rest = ~np.isin(steps, run.passages["step"])
    rise = (run.water.z_surface - run.water.z_surface[0]) * column.area
    assert at_rest.sum() > 10
    assert rise.max() > 1e-3 * books.water[0]
    np.testing.assert_allclose(rise[at_rest], (below - below[0])[at_rest], atol=1e-12 * books.water[0])


def test_a_constant_depth_lets_out_what_grains_displace(at_depth: Books) -> None:
    run, column = at_depth.run, at_depth.run.scene.column
    np.testing.assert_array_equal(run.water.z_surface, column.z_surface)
    wet = np.clip(column.z_surface - column.faces[:-1], 0.0, column.dz)
    below = (run.water.phi * wet).sum(axis=1) * column.area
    recent = np.isin(run.frames.step, run.passages["step"])  # moves on with the next exchange
    total = np.array(at_depth.water) + below
    np.testing.assert_allclose(total[~recent], total[0], rtol=1e-12)


def before_first_contact(run: Results) -> np.ndarray:
    """Frames up to which no grain has touched another."""
    return np.cumsum(run.tally["overlap_max"] > 0.0) == 0


def test_the_energy_account_closes_to_round_off_where_nothing_touches(whole: Results) -> None:
    free = before_first_contact(whole)
    assert free.sum() > 20
    assert (whole.passages["step"] <= whole.frames.step[free][-1]).sum() > 25
    assert (whole.passages["way"][:20] == OUT).sum() > 3
    assert whole.tally["residual"][free].max() < 1e-13
    assert whole.tally["residual"].max() < 1e-5  # contacts of clumps: of the order of the step (design/0022)


def test_an_id_is_never_there_twice_and_some_that_leave_come_in_again(whole: Results) -> None:
    rows, traffic = whole.passages, whole.scene.traffic
    for grain in np.unique(rows["grain"]):
        ways = rows["way"][rows["grain"] == grain]
        first = OUT if grain < traffic.n_first else IN
        assert ways.tolist() == [first * (-1) ** k for k in range(len(ways))]
    sent = rows[(rows["way"] == OUT) & (rows["at"] == 0)]
    again = rows[(rows["way"] == IN) & (rows["grain"] < traffic.n_first)]
    assert len(again) > 5
    assert np.isin(again["grain"], sent["grain"]).all()
    assert (again["at"] == 0).all()
    for row in rows[(rows["way"] == OUT) & (rows["at"] == 1)]:
        assert not np.any((rows["grain"] == row["grain"]) & (rows["step"] > row["step"]))


def test_any_number_of_threads_gives_the_same_bits(whole: Results, tmp_path: Path) -> None:
    carried_out(tmp_path / "run", threads=2)
    assert differences(whole.folder, tmp_path / "run") == []


@pytest.mark.parametrize("stops", [(39, 41), (INTERVAL * 20 - 1, INTERVAL * 20), (INTERVAL * 30 + 1, 1507)])
def test_a_stopped_run_resumes_with_the_same_bits(
    whole: Results, tmp_path: Path, stop_at: Any, stops: tuple[int, ...]
) -> None:
    for step in stops:
        stop_at(step)
        carried_out(tmp_path / "run", resume=True)
    last = carried_out(tmp_path / "run", resume=True)
    assert last.complete
    assert differences(whole.folder, tmp_path / "run") == []
    assert last.passages.tobytes() == whole.passages.tobytes()


def in_still_water(
    folder: Path, rate: float, count: int, area: float, time: float, tall: float = 1.0
) -> Results:
    """Spheres fed into still water near its surface at 0.25 m/s; they leave near the bottom.

    `area` is that of the bed [m2], `tall` stretches column and cells. The laws are those of the runs above,
    which are compiled.
    """
    (scene, state), column = cloud(part=0.0)
    wide = scene.period[0]
    feed = Feed(
        "sieve", low=(0.0, 0.0, 20.0 * tall * D), high=(wide, wide, 20.0 * tall * D + 2.0 * D),
        rate=rate, count=count, seed=7,
        velocity=(0.0, 0.0, -0.25),
    )  # fmt: skip
    away = np.full_like(state.x, np.nan)
    away = {"x": away, "v": away, "omega": away, "present": np.zeros(scene.n_grain, np.bool_)}
    out = Exit("out", point=(0.0, 0.0, 3.0 * D), normal=(0.0, 0.0, -1.0))
    keys = {"d", "m", "m_added", "m_weight", "inertia"}
    rows = {name: np.full(count, getattr(scene, name)[0]) for name in keys}
    away = {name: np.resize(one, (count, *one.shape[1:])) for name, one in away.items()}
    scene = replace(
        scene, **rows, gravity=np.array([0.0, 0.0, -G]), traffic=Traffic((feed,), (out,), 100, 0),
        flow=replace(column, g_x=0.0, area=area, dz=tall * column.dz, depth=tall * column.depth),
        tracked=scene.tracked[:0], world_low=(-1.0, -1.0, -1.0), world_high=(1.0, 1.0, 1.0),
    )  # fmt: skip
    state = replace(state, **away, image=np.zeros((count, 2), np.int32))
    return run_scene(scene, state, folder, frames=0.005, stop=Stop(time=time), progress=False)


def settling(phi: float) -> float:
    """Speed at which spheres among others of concentration phi settle in a closed column [m/s].

    They slip at w/eps; the drag of a single grain, times eps of the model A and Di Felice's eps^-beta, takes
    eps of the submerged weight.
    """
    eps = 1.0 - phi
    weight = 1650.0 * math.pi / 6.0 * D**3 * G

    def excess(w: float) -> float:
        slip = w / eps
        k = hindered(
            int(Drag.SCHILLER_NAUMANN), int(Hindrance.DI_FELICE), True, 0.0, slip, phi, D, 1.0e-6, RHO,
            math.pi / 4.0, 0.4,
        )  # fmt: skip
        return k * slip - eps * weight

    return float(brentq(excess, 0.01, 1.0))


def test_a_grain_that_is_fed_reaches_the_terminal_speed_of_its_drag(tmp_path: Path) -> None:
    run = in_still_water(tmp_path / "run", 10.0, 1, 100.0, 1.2, tall=10.0)
    frames = np.flatnonzero(np.isfinite(run.frames.x[:, 0, 2]))
    speed = -float(run.frames.v[frames[-1], 0, 2])
    assert speed == pytest.approx(settling(0.0), rel=1e-6)
    assert abs(0.25 - settling(0.0)) > 0.01  # it did not enter with it


def test_a_feed_that_balances_an_exit_holds_the_concentration_of_its_flux(tmp_path: Path) -> None:
    """phi w(phi) = volume fed per area and time, with the hindered settling of the law; uniform in height."""
    rate, area = 700.0, (12.0 * D) ** 2
    run = in_still_water(tmp_path / "run", rate, 320, area, 0.45)
    flux = rate * math.pi / 6.0 * D**3 / area
    expected = brentq(lambda phi: phi * settling(phi) - flux, 1e-4, 0.2)
    late = run.frames.t > 0.25
    z = run.scene.column.z
    zone = (z > 6.0 * D) & (z < 17.0 * D)
    phi = run.water.phi[late][:, zone].mean(axis=1)
    assert phi.mean() == pytest.approx(expected, rel=0.03)
    assert phi.std() < 0.1 * phi.mean()
    assert flux / settling(0.0) < 0.95 * expected  # without hindrance it would be less
    n = np.isfinite(run.frames.x[late][:, :, 2]).sum(axis=1)
    assert np.ptp(n) <= 0.1 * n.mean()
