"""What every kind of water has to do, asked of each of them and of a fluid of a page."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from tests.running.test_water import G, bits, falling, stepping
from tests.water.current import Current, CurrentState, Drift

from ryusa.laws.families import Buoyancy, Pressure, SurfaceRule
from ryusa.model import Scene, State
from ryusa.model.arrays import Floats
from ryusa.model.flow import Field, Flow
from ryusa.model.fluid import N_IMPULSE, N_SAMPLED, SUBMERGED
from ryusa.model.row import ColumnRow
from ryusa.results import Results, flow_file
from ryusa.running.runner import run_scene
from ryusa.running.snapshot import state_block, state_from_block
from ryusa.running.stops import Stop
from ryusa.water import kinds
from ryusa.water.protocol import Fluid

SEGMENTS = 4


@dataclass(frozen=True, repr=False)
class Layered(Current):
    """A current that keeps two fields more, as water with a pressure would."""

    def fields(self) -> Mapping[str, Field]:
        more = {"w": Field("m/s", ("layer", "face")), "p": Field("Pa", ("layer",))}
        return {**super().fields(), **more}


class LayeredDrift(Drift):
    def frame(self) -> Mapping[str, Floats]:
        n = self.flow.layers
        return {**super().frame(), "w": np.ones((n, n + 1)), "p": G * np.arange(n)}

    def snapshot(self, kept: Floats | None = None) -> CurrentState:
        return replace(super().snapshot(kept), mixed=np.ones(self.flow.layers + 1))


def flow_of(kind: str, scene: Scene) -> Flow:
    column = replace(scene.column, surface=SurfaceRule.VOLUME)  # type: ignore[type-var]
    if kind in ("row", "row with pressure"):
        high = np.full(SEGMENTS, column.z_surface)
        pressure = Pressure.HYDROSTATIC if kind == "row" else Pressure.FULL
        return ColumnRow(
            column, scene.period[0] / SEGMENTS, np.zeros(SEGMENTS), G, start=high, pressure=pressure
        )
    of = {"current": Current, "layered": Layered}.get(kind)
    return column if of is None else of(0.1, column.depth, column.area)


@pytest.fixture(params=["column", "row", "row with pressure", "current", "layered"])
def made(request: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Scene, State]]:
    """Grains that fall into water of each kind."""
    for name, flow, fluid in (("current", Current, Drift), ("layered", Layered, LayeredDrift)):
        monkeypatch.setitem(kinds.KINDS, flow, kinds.FluidKind(fluid, CurrentState))
        monkeypatch.setitem(flow_file.FLOWS, name, flow)
    scene, state = falling()
    scene = replace(scene, water=replace(scene.water, buoyancy=Buoyancy.STRESS))
    yield replace(scene, flow=flow_of(request.param, scene)), state


def begun(made: tuple[Scene, State]) -> Fluid:
    scene, state = made
    assert scene.flow is not None
    return kinds.KINDS[type(scene.flow)].fluid.begin(scene, scene.flow, state.x, step=7)


def taken(made: tuple[Scene, State], along_x: float = 0.0) -> tuple[Floats, Floats, Floats]:
    """Grains that have not moved, and what they took."""
    impulse = np.zeros((made[0].n_grain, N_IMPULSE))
    impulse[:, 0] = along_x
    return made[1].x, made[1].v, impulse


def test_it_begins_by_telling_all_grains_and_is_due_after_a_step(made: Any) -> None:
    water = begun(made)
    assert water.sampled.shape == (made[0].n_grain, N_SAMPLED) and np.isfinite(water.sampled).all()
    assert (water.sampled[:, SUBMERGED] >= 0.0).all() and water.due == 8
    assert (water.surface_at(made[1].x[:, 0]) > 0.0).all() and water.bed_at_inlet == 0.0


def test_what_it_keeps_at_a_frame_is_what_its_flow_declares(made: Any) -> None:
    water, flow = begun(made), made[0].flow
    for _ in range(2):
        kept = water.frame()
        assert {name: np.shape(one) for name, one in kept.items()} == flow.frame_shapes()
        assert all(np.isfinite(one).all() for one in kept.values())
        water.exchange(*taken(made))


def test_an_exchange_tells_the_grains_anew_and_is_due_within_the_longest_interval(made: Any) -> None:
    water = begun(made)
    for _ in range(3):
        before = water.due
        told = water.exchange(*taken(made))
        assert told is not None and np.array_equal(told, water.sampled)
        assert before < water.due <= before + made[0].flow.interval


def test_water_loses_what_the_grains_take(made: Any) -> None:
    """Of two that are alike, the one whose grains took more is slower."""
    one, other = begun(made), begun(made)
    one.exchange(*taken(made))
    other.exchange(*taken(made, along_x=1.0e-7))
    assert other.sampled[:, 0].mean() < one.sampled[:, 0].mean()


def test_an_interval_can_be_ended_and_one_that_has_not_begun_is_left(made: Any) -> None:
    water = begun(made)
    water.exchange(*taken(made))
    due, told = water.due, water.sampled.copy()
    water.finish(8, *taken(made))
    assert water.due == due and np.array_equal(water.sampled, told)
    water.finish(9, *taken(made))
    assert water.due > 9 and water.snapshot().steps == water.due - 9


def test_among_other_grains_it_is_due_after_a_step_with_the_same_water(made: Any) -> None:
    water = begun(made)
    water.exchange(*taken(made))
    after = water.among(made[1].x, 20)
    own = isinstance(made[0].flow, ColumnRow) and not made[0].flow.hydrostatic
    steps = water.snapshot().steps if own else 1
    assert after.due == 20 + steps and after.snapshot().steps == steps
    at_frame, now = water.frame(), after.frame()
    assert all(np.array_equal(now[name], one) for name, one in at_frame.items() if name in {"u", "speed"})


def test_it_takes_over_a_slope(made: Any) -> None:
    scene = made[0]
    water, level = begun(made), replace(scene, flow=scene.flow.tilted(0.0, G))
    assert not water.ends_with(level)
    water.change(level)
    water.exchange(*taken(made))
    steep = begun(made)
    steep.change(replace(scene, flow=scene.flow.tilted(1.0, G)))
    steep.exchange(*taken(made))
    assert steep.sampled[:, 0].mean() > water.sampled[:, 0].mean()


def test_it_speaks_of_itself(made: Any) -> None:
    water = begun(made)
    assert made[0].flow.text.startswith("a ") and water.text and water.warnings() == []
    assert all(math.isfinite(one) for one in water.numbers().values())


@pytest.mark.parametrize("k", [0, 1, 7, 62])
def test_its_snapshot_in_a_checkpoint_goes_on_with_the_same_bits(made: Any, k: int) -> None:
    fixed, first = made
    whole, part = stepping(fixed, first), stepping(fixed, first)
    whole._steps(80)
    part._steps(k)
    kept = state_from_block(state_block(part.state()), fixed)
    again = stepping(fixed, kept)
    assert bits(again.state()) == bits(part.state())
    again._steps(80 - k)
    assert bits(again.state()) == bits(whole.state())


@pytest.mark.parametrize("wrong", [{"steps": 0}, {"due": 0}])
def test_a_snapshot_of_no_interval_is_refused(made: Any, wrong: Any) -> None:
    state = stepping(*made).state()
    block = state_block(replace(state, coupling=replace(state.coupling, **wrong)))
    with pytest.raises(Exception, match="steps between exchanges"):
        state_from_block(block, made[0])


def test_a_run_folder_gives_its_fields_by_name_with_unit_and_axes(made: Any, tmp_path: Path) -> None:
    scene, state = made
    folder, dt = tmp_path / "run", scene.dt
    run_scene(scene, state, folder, frames=20 * dt, stop=Stop(time=60 * dt), progress=False)
    results, flow = Results.open(folder), scene.flow
    assert bits(results.scene.flow) == bits(flow)
    found = results.fluid
    assert found is not None and len(found.t) == len(results.frames) == 4
    with h5py.File(next((folder / "parts").glob("part-*.h5"))) as file:
        for name, field in flow.fields().items():
            assert getattr(found, name).shape == (4, *(flow.places[one] for one in field.at))
            attrs = file[f"{flow.GROUP}/{name}"].attrs
            assert attrs["unit"] == field.unit and tuple(attrs["axes"]) == ("frame", *field.at)
            assert f"{name} [{field.unit}]" in repr(found)
    with pytest.raises(AttributeError, match="no 'colour' among the fields of the water"):
        _ = found.colour


@pytest.mark.parametrize("kind", [Flow, Fluid])
def test_a_kind_of_water_that_forgets_something_cannot_be_made(kind):
    forgetful = type("Forgetful", (kind,), {})
    with pytest.raises(TypeError, match="abstract"):
        forgetful()
