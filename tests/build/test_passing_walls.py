"""Walls that go through each other are named before the run; those that touch or slide are not."""

import math

import pytest

from ryusa.build import build
from ryusa.casefile.read import read, read_text
from ryusa.cases import case_path
from ryusa.errors import CaseError

BASE = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction = 0.5
[motion]
rotation = "free"
plane = false
[build]
kind = "fill"
low = ["-4 cm", "-4 cm", "-4 cm"]
high = ["-3.5 cm", "-3.5 cm", "-3.5 cm"]
[stop]
time = "1 s"
"""


def lengths(text: str) -> str:
    return ", ".join(f'"{x} cm"' for x in text.split())


def rectangle(name: str, at: str, one: str, other: str, more: str = "") -> str:
    """A rectangle; points are three numbers in cm."""
    sides = f"at = [{lengths(at)}]\nsides = [[{lengths(one)}], [{lengths(other)}]]\n"
    return f'[[walls]]\nname = "{name}"\nshape = "rectangle"\n{sides}{more}'


def round_wall(name: str, shape: str, along: str, z: float) -> str:
    at = f'at = ["0 cm", "0 cm", "{z} cm"]\nradius = "2 cm"\n'
    return f'[[walls]]\nname = "{name}"\nshape = "{shape}"\n{at}{along}\n'


def velocity(x: float, y: float, z: float) -> str:
    return f'velocity = ["{x} cm/s", "{y} cm/s", "{z} cm/s"]\n'


def turning(rate: float) -> str:
    spin = f'angular_velocity = ["0 rad/s", "0 rad/s", "{rate} rad/s"]\n'
    return f"{spin}axis_point = [{lengths('0 0 0')}]\n"


def later(at: str, move: str) -> str:
    return f'[[timeline]]\nat = "{at}"\nmove = {{ {move} }}\n'


FLOOR = rectangle("floor", "-2 -2 0", "4 0 0", "0 4 0")
PISTON = rectangle("piston", "-1 -1 2", "2 0 0", "0 2 0", velocity(0, 0, -5))
GATE = rectangle("gate", "0 -1 0", "0 2 0", "0 0 2", velocity(0, 0, -5))


def notes(walls: str) -> list[str]:
    return [one for one in build(read_text(BASE + walls)).notes if "through the" in one]


def fault(walls: str) -> str:
    with pytest.raises(CaseError) as found:
        build(read_text(BASE + walls))
    return str(found.value)


def moment(said: str) -> float:
    return float(said.split("' at ")[1].split(maxsplit=1)[0])


def test_a_piston_that_goes_through_the_floor_is_refused_with_time_place_and_remedy() -> None:
    said = fault(FLOOR + PISTON)
    assert said.startswith("walls.1 = 'piston': goes face-on through the wall 'floor' at 0.4 s near (")
    assert ", 0) m, at 0.05 m/s, and would crush what is between them: stop it before by move" in said
    assert "walls.0 = 'piston'" in fault(PISTON + FLOOR)


def test_a_piston_that_stops_at_the_floor_or_half_a_grain_beyond_is_silent() -> None:
    assert notes(FLOOR + PISTON + later("0.4 s", 'wall = "piston"')) == []
    assert notes(FLOOR + PISTON + later("0.419 s", 'wall = "piston"')) == []
    assert "at 0.4 s" in fault(FLOOR + PISTON + later("0.421 s", 'wall = "piston"'))
    assert notes(FLOOR + PISTON + '[[timeline]]\nat = "0.39 s"\nremove = "floor"\n') == []


def test_a_move_of_the_timeline_is_named_by_its_own_key() -> None:
    still = PISTON.replace(velocity(0, 0, -5), "")
    said = fault(FLOOR + still + later("0.2 s", 'wall = "piston", velocity = ["0 m/s", "0 m/s", "-5 cm/s"]'))
    assert said.startswith("timeline.0.move = 'piston': goes face-on through the wall 'floor' at 0.6 s")
    assert notes(FLOOR + still) == []


def test_a_gate_that_sinks_through_the_floor_edge_first_is_a_note() -> None:
    (said,) = notes(FLOOR + GATE)
    assert said.startswith("wall 'gate' goes through the wall 'floor' at 0.0")
    assert said.endswith("m, at 0.05 m/s, edge first: grains in its way are hit (walls.1)")
    assert notes(FLOOR + GATE.replace("-5 cm/s", "5 cm/s")) == []  # lifted off the floor


def test_a_paddle_that_turns_into_a_wall_is_refused_at_the_angle_where_they_meet() -> None:
    paddle = rectangle("paddle", "0.2 0 -1", "1.5 0 0", "0 0 2", turning(4.0))
    stop = rectangle("stop", "0 0.3 -1", "0 1 0", "0 0 2")
    said = fault(paddle + stop)
    assert said.startswith("walls.0 = 'paddle': goes face-on through the wall 'stop'")
    assert moment(said) == pytest.approx(math.pi / 2.0 / 4.0, rel=1e-3)
    assert notes(paddle.replace("4.0 rad/s", "1.5 rad/s") + stop) == []  # 1.5 rad in the second of the run
    back = later("0.3 s", 'wall = "paddle", angular_velocity = ["0 rad/s", "0 rad/s", "-4 rad/s"]')
    assert notes(paddle + stop + back.replace("-4", "-1")) == []  # from 1.2 rad back
    many = later("0.9 s", 'wall = "paddle", angular_velocity = ["0 rad/s", "0 rad/s", "3 rad/s"]')
    away = paddle.replace("4.0 rad/s", "-1e-6 rad/s")
    assert "timeline.0.move" in fault(away + stop + many.replace("0.9", "0.3"))
    assert notes(away + stop + many) == []  # 0.3 rad
    alone = paddle.replace("4.0 rad/s", "31.4 rad/s") + many  # five turns, then where the last one ended
    assert notes(alone + rectangle("under", "0 0.3 1.1", "0 1 0", "0 0 2")) == []


def test_an_oscillation_counts_by_its_amplitude() -> None:
    lid = PISTON.replace(velocity(0, 0, -5), 'amplitude = ["0 cm", "0 cm", "AMP cm"]\nfrequency = "2 Hz"\n')
    assert "face-on through the wall 'floor'" in fault(FLOOR + lid.replace("AMP", "2.3"))
    assert notes(FLOOR + lid.replace("AMP", "2.05")) == []


def test_touches_before_a_passage_do_not_hide_it() -> None:
    """Each of some 1000 points dips a quarter of a grain below the floor, comes back, then goes through."""
    swing = 'amplitude = ["0 cm", "0 cm", "2.05 cm"]\nfrequency = "2 Hz"\n'
    lid, down = PISTON.replace(velocity(0, 0, -5), swing), 'velocity = ["0 cm/s", "0 cm/s", "-10 cm/s"]'
    assert notes(FLOOR + lid) == []
    said = fault(FLOOR + lid + later("0.5 s", f'wall = "piston", {down}'))
    assert said.startswith("timeline.0.move = 'piston': goes face-on through the wall 'floor' at 0.7 s")
    plane = '[[planes]]\nname = "bottom"\npoint = ["0 cm", "0 cm", "-4.5 cm"]\nnormal = [0, 0, 1]\n'
    deeper, faster = lid.replace("2.05", "6.55"), down.replace("-10", "-20")
    assert notes(plane + deeper) == []
    said = fault(plane + deeper + later("0.5 s", f'wall = "piston", {faster}'))
    assert said.startswith("timeline.0.move = 'piston': goes face-on through the plane 'bottom' at 0.825 s")


def test_faces_whose_edges_alone_meet_are_found() -> None:
    one = rectangle("one", "-2 -0.2 0", "4 0 0", "0 0.4 0")
    other = rectangle("other", "-0.2 -2 1", "0.4 0 0", "0 4 0", velocity(0, 0, -2))
    assert "walls.1 = 'other': goes face-on through the wall 'one' at 0.5 s" in fault(one + other)
    same = rectangle("same", "-2 -0.2 1", "4 0 0", "0 0.4 0", velocity(0, 0, -2))
    assert "walls.1 = 'same'" in fault(one + same)
    assert notes(one + other.replace('"-0.2 cm"', '"2.5 cm"')) == []  # beside it


def test_walls_that_move_together_or_turn_inside_each_other_are_silent() -> None:
    shell = round_wall("shell", "cylinder", 'axis = ["0 cm", "0 cm", "4 cm"]', -1)
    piston = round_wall("piston", "disc", "normal = [0, 0, 1]", 0)
    assert notes(shell + piston + velocity(0, 0, 2) + turning(7.0)) == []
    floor = rectangle("floor", "-3 -3 0", "6 0 0", "0 6 0")
    assert notes(floor + piston + turning(3.0)) == []  # a disc in the floor
    lifter = rectangle("lifter", "2 0 -1", "-0.5 0 0", "0 0 4", turning(3.0))
    assert notes(shell + turning(3.0) + lifter) == []
    lid = rectangle("lid", "-2 -2 3", "4 0 0", "0 4 0", velocity(0, 0, -2))
    sides = [rectangle(f"side {k}", f"{2 * k} -2 -1", "0 4 0", "0 0 5") for k in (-1, 1)]
    assert notes("".join(sides) + lid) == []  # between sides that it touches


def test_a_plane_is_passed_from_its_front_only() -> None:
    plane = '[[planes]]\nname = "base"\npoint = ["0 m", "0 m", "0 m"]\nnormal = [0, 0, 1]\n'
    above = plane.replace('"0 m"]', '"-5 cm"]')
    rising = PISTON.replace('"2 cm"]', '"-6 cm"]').replace("-5 cm/s", "5 cm/s")
    assert "'piston': goes face-on through the plane 'base' at 0.8 s" in fault(
        above + PISTON.replace('"2 cm"]', '"-1 cm"]')
    )
    assert notes(above + rising) == []


def test_an_image_of_a_wall_counts_in_a_period() -> None:
    flag = rectangle("flag", "-3.9 -3.9 -3", "0 0.2 0", "0 0 0.5", velocity(0.4, 0, 0))
    post = rectangle("post", "-4.5 -3.9 -3", "0 0.2 0", "0 0 0.5")
    assert notes(flag + post) == []
    endless = BASE.replace("-3.5 cm", "-3.2 cm").replace("[stop]", "periodic = true\n[stop]")  # by 0.8 cm
    with pytest.raises(CaseError, match=r"'flag': goes face-on through the wall 'post' at 0\.5 s"):
        build(read_text(endless + flag + post))


def test_packaged_cases_that_move_walls_are_silent() -> None:
    for name in ("drum", "lifted_cylinder", "shear_cell"):
        case = read(case_path(f"{name}.toml"))
        assert not [one for one in build(case).notes if "through the" in one]
