"""Loads on meshes and other walls of a row: displaced weight, a dam within a mesh, walls without water."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.measure.made_rows import DX, DZ, WIDTH, G, row_of, run_of
from tests.measure.test_water_on_faces import box

from ryusa.errors import ResultsError
from ryusa.figures.loads import loads as drawn
from ryusa.measure.loads import loads
from ryusa.model.row import RowDam
from ryusa.model.walls import N_IMPULSE, TOUCHED, VELOCITY, Walls, at_rest

T, RHO, DEEP = np.arange(11) * 0.1, 1000.0, 0.02
DAM = RowDam("core", 4, 5, 8 * DZ)
LOW, HIGH = np.array([0.122, 0.002, 0.006]), np.array([0.136, 0.008, 0.012])


def row_with(
    walls: dict[str, np.ndarray], *, shapes: tuple[str, ...] = ("mesh",), speed: float = 0.0,
    pushed: dict[str, float] | None = None, dam: bool = False, level: Any = DEEP, own: tuple[str, ...] = (),
) -> Any:  # fmt: skip
    """A pond with walls of triangles, of which the first may rise; grains push some with a force [N].

    `own` names those that are no [[walls]] of the case.
    """
    row = row_of(ends=True)
    if dam:
        row = replace(row, solid=np.where(np.arange(8) == 4, 8, 0), dams=(DAM,))
    none, names = np.zeros((11, 1, 3)), tuple(walls)
    run = run_of(row, T, none, none, surface=np.broadcast_to(level, (11, 8)))
    corners = np.concatenate(list(walls.values()))
    face = np.concatenate(
        [corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=1
    )
    of = np.repeat(np.arange(len(names)), [len(one) for one in walls.values()])
    motion, n = at_rest(len(names)), len(names)
    motion[0, VELOCITY + 2] = speed
    kinds = (np.zeros(len(face), int), of, of, np.ones(n, bool), motion)
    impulse = np.zeros((11, n, N_IMPULSE))
    for name, force in (pushed or {}).items():
        impulse[:, names.index(name), 0] = impulse[:, names.index(name), TOUCHED] = force * T
    run.scene = SimpleNamespace(
        walls=Walls(face, *kinds, names), n_grain=0, has_servo=False, period=(np.inf, np.inf),
        plane_normal=np.zeros((0, 3)), plane_point=np.zeros((0, 3)), plane_active=np.zeros(0, bool),
        gravity=np.array([0.0, 0.0, -G]),
    )  # fmt: skip
    run.tally, run.walls, run.wall_travel = {"t": T}, impulse, np.zeros((11, n))
    theirs = [name for name in names if name not in own]
    run.case = {"walls": [{"name": a, "shape": b} for a, b in zip(theirs, shapes, strict=True)]}
    return run


@pytest.mark.parametrize("outwards", [True, False])
def test_a_closed_mesh_is_lifted_by_the_water_that_it_displaces(outwards: bool) -> None:
    mesh = box(LOW, HIGH)
    found = loads(row_with({"boulder": mesh if outwards else mesh[:, ::-1]}))
    lift = RHO * G * np.prod(HIGH - LOW)
    turn = lift * 0.5 * (HIGH[0] - LOW[0])  # the toe is below its end
    assert found.names == ("boulder",)
    assert found.toe[0] == pytest.approx([HIGH[0], LOW[2]])
    assert found.water[:, 0] == pytest.approx(np.tile([0.0, lift, turn], (10, 1)), abs=1e-12)
    assert any("water on boulder: hydrostatic, on the outer side" in one for one in found.averages.notes)


def test_a_mesh_that_rises_leaves_the_water() -> None:
    found = loads(row_with({"boulder": box(LOW, HIGH)}, speed=0.01))
    base = LOW[2] + 0.01 * T
    lift = RHO * G * np.prod((HIGH - LOW)[:2]) * np.clip(DEEP - base, 0.0, 0.006)
    assert found.water[:, 0, 1] == pytest.approx(0.5 * (lift[1:] + lift[:-1]), abs=1e-12)


def test_a_mesh_round_a_dam_has_its_water_once_and_the_grains_of_both() -> None:
    begin = 0.1 + DAM.first * DX
    shell = box((begin - 0.004, 0.0, 0.0), (begin + DX + 0.004, WIDTH, DAM.crest + DZ))
    level = np.where(np.arange(8) < 5, 0.003, 0.001)
    level[4] = DAM.crest
    own = box((begin, 0.0, 0.0), (begin + DX, WIDTH, DAM.crest))
    run = row_with(
        {"weir": shell, "core": own}, pushed={"weir": 2.0, "core": 0.5}, dam=True, level=level, own=("core",)
    )
    found = loads(run)
    assert found.names == ("core",)
    force = 0.5 * RHO * G * WIDTH * (0.003**2 - 0.001**2)
    assert found.water[:, 0, 0] == pytest.approx(np.full(10, force))
    assert found.grains[:, 0, 0] == pytest.approx(np.full(10, 2.5))
    assert any("core has the water, and the grains of core, weir" in one for one in found.averages.notes)
    drawn(found)


def test_a_sheet_has_no_water_and_is_left_out_where_nothing_touches_it() -> None:
    plate = box((0.15, 0.0, 0.0), (0.15, WIDTH, 0.01))[:2]
    walls = {"pushed": plate, "idle": plate + 0.002}
    found = loads(row_with(walls, shapes=("rectangle", "disc"), pushed={"pushed": 1.0}))
    assert found.names == ("pushed",)
    assert not found.water.any()
    assert found.acts_at["grains"] == pytest.approx(np.zeros((10, 1)))  # no torque about the origin
    said = " ".join(found.averages.notes)
    assert "no water on pushed, idle" in said and "pushes it: idle" in said
    assert not any("water" in one.name for one in found.averages.items)
    with pytest.raises(ResultsError, match="neither water nor a grain pushes pushed, idle"):
        loads(row_with(walls, shapes=("rectangle", "disc")))


def test_a_mesh_without_an_outer_side_has_no_water() -> None:
    mesh = box(LOW, HIGH)
    mesh[0] = mesh[0, ::-1]
    found = loads(row_with({"boulder": mesh}, pushed={"boulder": 1.0}))
    assert not found.water.any()
    assert any("no water on boulder: its triangles are flipped" in one for one in found.averages.notes)


def test_a_row_without_dams_and_walls_is_refused() -> None:
    run = row_with({"bottom": box(LOW, HIGH)}, own=("bottom",), shapes=())
    with pytest.raises(ResultsError, match=r"no \[\[walls\]\], and no dam that stops the water"):
        loads(run)
