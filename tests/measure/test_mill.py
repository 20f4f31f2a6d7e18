import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from tests.engine.conftest import run as stepped

import ryusa
from ryusa.build import scene as built
from ryusa.build.walls import WallMotion, cylinder, rectangle, with_walls
from ryusa.cases import case_path
from ryusa.errors import ResultsError
from ryusa.figures.mill import mill as drawn
from ryusa.laws.drum import critical_rate
from ryusa.measure import mill
from ryusa.model.tally import HELD, LOSSES
from ryusa.model.walls import AXIS_POINT, N_IMPULSE, SPIN, TOUCHED, FaceKind, Walls, at_rest

D, RADIUS, G = 0.008, 0.06, 9.80665
RATE, TORQUE = 9.0, 0.02


def turning(make, *, rate=RATE, axis=(0.0, 1.0, 0.0), turns=2.3):
    """A run with a shell and one lifter under known torques, whose grains lose what they are given."""
    motion = at_rest(3)
    motion[:2, SPIN + 1] = rate
    motion[1, AXIS_POINT : AXIS_POINT + 3] = 0.0, 0.01, 0.0
    motion[2, SPIN + 1], motion[2, AXIS_POINT] = rate, 0.02  # turns about another axis
    face = np.zeros((3, 9))
    face[:, 3:6], face[:, 6:8] = axis, (RADIUS, 0.03)
    number = np.arange(3)
    walls = Walls(
        face=face, kind=np.array([FaceKind.CYLINDER, FaceKind.DISC, FaceKind.DISC]), wall=number,
        surface=number, active=np.ones(3, dtype=bool), motion=motion, names=("shell", "lifter", "other"),
    )  # fmt: skip
    scene = replace(make.scene(2), d=np.full(2, D), walls=walls, gravity=np.array([0.0, 0.0, -G]))
    t = np.linspace(0.0, turns * 2.0 * math.pi / RATE, 231)
    sense = math.copysign(1.0, rate)
    impulse = np.zeros((len(t), 3, N_IMPULSE))
    impulse[:, 0, 4], impulse[:, 1, 4], impulse[:, 2, 4] = (
        -sense * k * TORQUE * t for k in (0.25, 0.75, 9.0)
    )
    impulse[:, 0, 6] = RATE * TORQUE * t
    tally = {name: np.zeros(len(t)) for name in (*HELD, *(one.name.lower() for one in LOSSES))}
    tally |= {"t": t, "slide": 0.6 * RATE * TORQUE * t, "dash_n": 0.3 * RATE * TORQUE * t}
    tally["potential"] = 0.1 * RATE * TORQUE * t
    return SimpleNamespace(
        case={},
        frames=SimpleNamespace(t=t),
        scene=scene,
        walls=impulse,
        row=None,
        wall_travel=np.zeros((len(t), 3)),
        tally=tally,
    )


@pytest.mark.parametrize("rate", [RATE, -RATE])
def test_power_is_the_torque_of_all_that_turns_with_the_shell_times_its_rate(make, rate):
    found = mill(turning(make, rate=rate))
    assert found.together == ("shell", "lifter")
    assert found["torque"].value == pytest.approx(TORQUE)
    assert found["power"].value == pytest.approx(RATE * TORQUE)
    assert found["given"].value == pytest.approx(RATE * TORQUE)
    assert found["lost"].value == pytest.approx(0.9 * RATE * TORQUE)
    assert found["stored"].value == pytest.approx(0.1 * RATE * TORQUE)
    assert found.turns == 2
    assert found.t[-1] - found.t[0] == pytest.approx(2.0 * 2.0 * math.pi / RATE, rel=0.02)
    assert found.critical == pytest.approx(RATE / math.sqrt(G / (RADIUS - 0.5 * D)))
    assert len(drawn(found).axes) == 2


def test_what_is_no_mill_is_refused_by_name(make):
    for wrong, says in (
        ({"rate": 0.0}, "no cylinder that turns"), ({"axis": (1.0, 0.0, 0.0)}, "no cylinder that turns"),
        ({"turns": 0.9}, "less than one turn"),
    ):  # fmt: skip
        with pytest.raises(ResultsError, match=says):
            mill(turning(make, **wrong))


def lifted(share):
    """One ball before a lifter, without friction, moving with the drum at a share of its critical rate."""
    rate, reach = share * critical_rate(RADIUS, D, G), RADIUS - 0.5 * D
    behind = -math.pi / 2.0 + math.asin(0.5 * D / reach)  # of the lifter: the ball touches it at the bottom
    way = np.array([math.cos(behind), 0.0, math.sin(behind)])
    motion = WallMotion(spin=(0.0, rate, 0.0))
    walls = [
        cylinder("shell", (0, -D, 0), (0, 2 * D, 0), RADIUS),
        rectangle("lifter", RADIUS * way - (0, D, 0), -0.03 * way, (0, 2 * D, 0)),
    ]
    scene, first = built(
        x=[[0.0, 0.0, -reach]], v=[[-rate * reach, 0.0, 0.0]], d=D, friction=0.0, restitution=0.1,
        stiffness=1.0e5, steps_per_contact=20.0,
    )  # fmt: skip
    low, high = (-1.0,) * 3, (1.0,) * 3
    made = with_walls(scene, [replace(one, motion=motion) for one in walls])
    return (replace(made, world_low=low, world_high=high), first), rate


@pytest.mark.parametrize("share", [0.6, 0.8])
def test_a_ball_leaves_the_shell_where_gravity_exceeds_the_centrifugal_force(share):
    """Along the lifter, on which it slides freely: omega**2 rho cos(behind) = g cos(lifter)."""
    made, rate = lifted(share)
    engine, chunk, held = stepped(made, 1), 20, math.inf
    while held > 0.0 or engine.tally().t < 1.2 / rate:  # it bounces a little at first
        before = np.array(engine.tally().walls).reshape(-1, N_IMPULSE)[0, TOUCHED]
        engine.advance(chunk).raise_if_any()
        held = np.array(engine.tally().walls).reshape(-1, N_IMPULSE)[0, TOUCHED] - before
        assert engine.tally().t < math.pi / rate
    x, behind = engine.state().x[0], math.asin(0.5 * D / (RADIUS - 0.5 * D))
    lifter = math.acos(x[2] / math.hypot(x[0], x[2])) + behind  # from the top; its plane is the way out
    assert math.cos(lifter) == pytest.approx(share**2 * math.cos(behind), abs=0.01)


def test_a_ball_stays_on_the_shell_above_the_critical_rate():
    made, rate = lifted(1.05)
    engine = stepped(made, 1)
    while engine.tally().t < 3.0 * math.pi / rate:
        engine.advance(500).raise_if_any()
        x = engine.state().x[0]
        assert math.hypot(x[0], x[2]) > RADIUS - 0.55 * D


@pytest.mark.slow
def test_the_packaged_mill_loses_what_its_drum_gives(tmp_path: Path) -> None:
    run = ryusa.run(ryusa.load(case_path("mill.toml")), tmp_path / "run", progress=False)
    found = mill(run)
    assert found["power"].value == pytest.approx(found["given"].value, rel=1e-3)
    assert found["given"].value - found["lost"].value == pytest.approx(
        found["stored"].value, rel=0.01, abs=1e-3
    )
    assert abs(found["stored"].value) < 0.05 * found["lost"].value
    assert run.tally["residual"].max() < 1e-3
