"""Feeds without room, exits out of reach: each is named before the run; what only looks like it is built."""

import pytest

from ryusa.build import build
from ryusa.casefile.read import read_text
from ryusa.errors import CaseError

FED = """
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
kind = "empty"
[stop]
time = "0.1 s"
[[feeds]]
name = "hose"
centre = ["0 cm", "0 cm", "5 cm"]
radius = "1 cm"
rate = "100 grains/s"
"""
FILLED = FED.replace('"empty"', '"fill"\nlow = ["0 cm", "0 cm", "0 cm"]\nhigh = ["1 cm", "1 cm", "0.5 cm"]')
SHELF = """
[[walls]]
name = "shelf"
shape = "rectangle"
at = ["-2 cm", "-2 cm", "50.5 mm"]
sides = [["4 cm", "0 cm", "0 cm"], ["0 cm", "4 cm", "0 cm"]]
"""
FLOOR = '[[planes]]\nname = "floor"\npoint = ["0 m", "0 m", "0 m"]\nnormal = [0, 0, 1]\n'
OUT = '[[exits]]\nname = "out"\npoint = ["0 cm", "0 cm", "-1 cm"]\nnormal = [0, 0, -2]\n'
HATCH = '[[exits]]\nname = "out"\nlow = ["0 m", "0 m", "-1 cm"]\nhigh = ["1 cm", "1 cm", "-0.5 cm"]\n'
DOMAIN = '[domain]\nlow = ["-8 cm", "-8 cm", "-8 cm"]\nhigh = ["8 cm", "8 cm", "8 cm"]\n'


def fault(text: str) -> str:
    with pytest.raises(CaseError) as found:
        build(read_text(text))
    return str(found.value)


def test_a_feed_that_a_wall_fills_is_named_with_the_wall() -> None:
    said = fault(FED + SHELF)
    assert said.startswith(
        "feeds.0 = 'hose': has no room for a grain of 0.002 m, the wall 'shelf' is in the way"
    )
    assert "the plane 'floor'" in fault(FED.replace('"5 cm"]\nradius', '"0.5 mm"]\nradius') + FLOOR)


def test_a_wall_that_moves_or_goes_leaves_a_feed_its_room() -> None:
    assert build(read_text(FED + SHELF + 'velocity = ["0 m/s", "0 m/s", "-1 cm/s"]\n')).scene.n_wall == 1
    gone = '[[timeline]]\nat = "1 ms"\nremove = "shelf"\n'
    assert build(read_text(FED + SHELF + gone)).scene.n_wall == 1


def test_a_rate_is_held_against_the_room_that_walls_leave() -> None:
    half = SHELF.replace('"-2 cm", "-2 cm"', '"0 cm", "-2 cm"')
    assert build(read_text(FED + half)).scene.n_wall == 1
    said = fault(FED.replace("100 grains", "4000 grains") + half)
    assert "feeds.0.rate = '4000 grains/s': cannot fit: the wall 'shelf' leaves 0.4" in said
    assert "or move the feed" in said
    build(read_text(FED.replace("100 grains", "4000 grains")))


def test_an_exit_that_no_grain_gets_to_is_named() -> None:
    for exit_ in (OUT, HATCH):
        assert "exits.0 = 'out': lies behind the plane 'floor'" in fault(FED + FLOOR + exit_)
        far = exit_.replace("-1 cm", "-1 m").replace("-0.5 cm", "-0.9 m")
        assert "exits.0 = 'out': lies outside domain.low and domain.high" in fault(FED + DOMAIN + far)
        assert build(read_text(FED + DOMAIN + exit_)).scene.traffic
        opened = '[[timeline]]\nat = "1 ms"\nremove = "floor"\n'
        assert build(read_text(FED + FLOOR + exit_ + opened)).scene.traffic
    beside = OUT.replace("[0, 0, -2]", "[1, 0, -2]")
    assert build(read_text(FED + FLOOR + beside)).scene.traffic


def test_an_exit_that_takes_first_grains_is_named() -> None:
    for exit_ in (OUT.replace("-1 cm", "9 mm"), HATCH.replace("-1 cm", "0 cm").replace("-0.5 cm", "9 mm")):
        assert "exits.0 = 'out': takes all 32 first grains at once" in fault(FILLED + exit_)
    built = build(read_text(FILLED + OUT.replace("-1 cm", "2 mm")))
    assert "exit 'out' takes 16 of the 32 first grains at once (exits.0)" in built.notes


def test_a_run_that_would_never_see_a_grain_is_named() -> None:
    led = FED.replace('rate = "100 grains/s"\n', "") + OUT + 'to = "hose"\n'
    assert "build.kind = 'empty': gives no grain, and no feed has a rate" in fault(led)
    filled = FILLED.replace('rate = "100 grains/s"\n', "") + OUT + 'to = "hose"\n'
    assert build(read_text(filled)).scene.traffic
