"""Builders leave room for clumps, whichever way these are turned."""

import pytest

from ryusa.build import build
from ryusa.casefile.read import read_text
from ryusa.engine.cpu.engine import CpuEngine

PLAIN = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
spread = 0.2
shape = "rod"
[contact]
stiffness = "1e4 N/m"
friction = 0.5
restitution = 0.7
[motion]
plane = false
rotation = "free"
[build]
kind = "box"
columns = 6
rows = 5
layers = 6
floor = "plane"
[stop]
time = "0.01 s"
[record]
frames = "1 ms"
"""


@pytest.mark.parametrize("kind", ["box", "packing", "fill", "flume"])
def test_builders_leave_room_for_clumps_however_they_are_turned(kind):
    boxes = {
        "box": "", "packing": "", "fill": 'low = ["0 cm", "0 cm", "0 cm"]\nhigh = ["2 cm", "2 cm", "2 cm"]',
        "flume": 'length = "3 cm"\nwidth = "2 cm"\nlayers = 3',
    }  # fmt: skip
    text = PLAIN
    if kind != "box":
        text = text.replace('kind = "box"', f'kind = "{kind}"\n{boxes[kind]}').replace(
            'floor = "plane"\n', ""
        )
    if kind in {"fill", "flume"}:
        for key in ("columns = 6\n", "rows = 5\n", "layers = 6\n"):
            text = text.replace(key, "")
    made = build(read_text(text))
    bodies = made.scene.bodies
    assert bodies is not None
    assert bodies.n * 3 == made.scene.n_grain
    assert CpuEngine().refuses(made.scene) == ()
    engine = CpuEngine()
    engine.load(made.scene, made.state)
    engine.advance(1).raise_if_any()
    assert engine.tally().n_contact == 0  # none overlaps another, the bed or a wall
