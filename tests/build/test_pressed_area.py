"""A pressure of a servo acts on the area of the sample, or of the wall where that is smaller."""

import itertools
import math
from dataclasses import replace

import pytest

from ryusa import build
from ryusa.build.servo import pressed_area, servo_notes
from ryusa.build.walls import SolidWall
from ryusa.casefile import read_text
from ryusa.cases import case_path
from ryusa.model.walls import ASKED

L, W, UP = 0.02, 0.03, (0.0, 0.0, 0.05)
BOX = [
    build.rectangle("left", (0, 0, 0), (0, W, 0), UP),
    build.rectangle("right", (L, 0, 0), (0, W, 0), UP),
    build.rectangle("front", (0, 0, 0), (L, 0, 0), UP),
    build.rectangle("back", (0, W, 0), (L, 0, 0), UP),
]
PLANES = [("floor", (0, 0, 0), (0, 0, 1)), ("left", (0, 0, 0), (1, 0, 0)), ("right", (L, 0, 0), (-1, 0, 0)),
          ("front", (0, 0, 0), (0, 1, 0)), ("back", (0, W, 0), (0, -1, 0))]  # fmt: skip
TUBE = [build.cylinder("tube", (0.5 * L, 0.5 * W, 0.0), UP, 0.008)]
OPEN = (math.inf, math.inf)
FITS = build.rectangle("lid", (0, 0, 0.04), (L, 0, 0), (0, W, 0))
LARGE = build.rectangle("lid", (-L, -W, 0.04), (3 * L, 0, 0), (0, 3 * W, 0))
STRIP = build.rectangle("lid", (-L, 0.01, 0.04), (3 * L, 0, 0), (0, 0.01, 0))
PLATE = build.disc("lid", (0.5 * L, 0.5 * W, 0.04), (0, 0, 1), 0.004)
ROUGH = build.ridges("lid", (0, W, 0.04), (L, 0, 0), (0, -W, 0), 10, 0.001)


def body() -> SolidWall:
    """A plate with two faces and four sides, as from CAD."""
    top = build.rectangle("top", (0, 0, 0.042), (L, 0, 0), (0, W, 0))
    sides = [build.rectangle("side", (0, y, 0.04), (L, 0, 0), (0, 0, 0.002)) for y in (0.0, W)]
    sides += [build.rectangle("side", (x, 0, 0.04), (0, W, 0), (0, 0, 0.002)) for x in (0.0, L)]
    every = [FITS, top, *sides]
    corners = [
        [a, [p + q for p, q in zip(a, b, strict=True)], [p + q for p, q in zip(a, c, strict=True)]]
        for one in every
        for a, b, c in ((row[:3].tolist(), row[3:6].tolist(), row[6:9].tolist()) for row in one.face)
    ]
    return build.triangles("lid", corners)


@pytest.mark.parametrize(
    ("lid", "walls", "planes", "period", "area", "share"),
    [
        (FITS, BOX, [], OPEN, L * W, 1.0),
        (LARGE, BOX, [], OPEN, L * W, 1.0),
        (LARGE, [], PLANES, OPEN, L * W, 1.0),
        (LARGE, BOX[2:], [], (L, math.inf), L * W, 1.0),
        (LARGE, [], [], (L, W), L * W, 1.0),
        (STRIP, BOX, [], OPEN, L * 0.01, 1.0 / 3.0),
        (PLATE, BOX, [], OPEN, math.pi * 0.004**2, math.pi * 0.004**2 / (L * W)),
        (LARGE, TUBE, [], OPEN, math.pi * 0.008**2, 1.0),
        (ROUGH, [], [], (L, W), L * W, 1.0),
        (FITS, [], [], OPEN, L * W, 0.0),
        (body(), BOX, [], OPEN, L * W, 1.0),
    ],
)
def test_the_area_is_what_lies_within_the_sample(lid, walls, planes, period, area, share) -> None:
    pressed = replace(lid, servo=build.Servo((0.0, 0.0, -2.0), 0.1, 1.0, pressure=300.0))
    scene, _ = build.scene(
        [[0.01, 0.015, 0.01]], 0.002, walls=[*walls, pressed], planes=planes, period=period
    )
    found, sample = pressed_area(scene, len(walls), scene.walls.servo[-1, :3])
    assert found == pytest.approx(area, rel=2e-5 if walls is TUBE else 1e-9)
    assert found / sample == pytest.approx(share, rel=2e-5)
    assert scene.walls.servo[-1, ASKED] == pytest.approx(300.0 * area, rel=2e-5 if walls is TUBE else 1e-9)


def test_the_notes_say_on_what_area_a_pressure_acts() -> None:
    pressed = replace(PLATE, servo=build.Servo((0.0, 0.0, -1.0), 0.1, 1.0, pressure=300.0))
    for walls, said in (
        (BOX, "8.4% of the sample, in which the mean pressure is 25.13 Pa"),
        ([], "open sides"),
    ):
        scene, _ = build.scene([[0.01, 0.015, 0.01]], 0.002, walls=[*walls, pressed])
        (note,) = servo_notes(scene, {len(walls): 300.0})
        assert "300 Pa on 0.5027 cm2" in note and said in note and "0.01508 N" in note
    built = build.build(read_text(case_path("shear_cell.toml").read_text(encoding="utf-8")))
    assert any("500 Pa on 4.32 cm2, the whole sample: 0.216 N" in note for note in built.notes)


def ring(inner: float, outer: float, thick: float) -> SolidWall:
    """A ring of 64 sides about the middle of the box, a sheet or, with a thickness, a closed body."""
    angle = [2.0 * math.pi * k / 64 for k in range(65)]

    def at(r: float, a: float, z: float) -> tuple[float, float, float]:
        return 0.5 * L + r * math.cos(a), 0.5 * W + r * math.sin(a), z

    corners = []
    for a, b in itertools.pairwise(angle):
        strips = [((inner, 0.0), (outer, 0.0))]
        if thick:
            strips += [((outer, 0.0), (outer, thick)), ((outer, thick), (inner, thick))]
            strips += [((inner, thick), (inner, 0.0))]
        for (r, z), (s, y) in strips:
            one, two, three, four = (at(r, a, z), at(s, a, y), at(s, b, y), at(r, b, z))
            corners += [[one, two, three], [one, three, four]]
    return build.triangles("lid", [[[x, y, 0.04 + z] for x, y, z in one] for one in corners])


@pytest.mark.parametrize("inner", [0.002, 0.006])
@pytest.mark.parametrize("thick", [0.0, 0.001])
@pytest.mark.parametrize("tubes", [False, True])
def test_a_ring_presses_with_its_own_area_and_not_with_that_of_its_hole(inner, thick, tubes) -> None:
    outer = 0.008
    walls = (
        [build.cylinder(f"tube {r:g}", (0.5 * L, 0.5 * W, 0.0), UP, r) for r in (inner, outer)]
        if tubes
        else []
    )
    servo = build.Servo((0.0, 0.0, -1.0), 0.1, 1.0, pressure=300.0)
    lid = replace(ring(inner, outer, thick), servo=servo)
    scene, _ = build.scene([[0.01, 0.012, 0.01]], 0.001, walls=[*walls, lid])
    area = 32.0 * math.sin(math.pi / 32.0) * (outer**2 - inner**2)
    assert scene.walls.servo[-1, ASKED] == pytest.approx(300.0 * area, rel=1e-9)
    (note,) = servo_notes(scene, {len(walls): 300.0})
    assert "it has a hole or a recess" in note
