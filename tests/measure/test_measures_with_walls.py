"""Measures that go by touching pairs, in boxes of walls beside the same boxes of planes."""

import numpy as np
import pytest

import ryusa
from ryusa.casefile import read
from ryusa.cases import case_path
from ryusa.catalogue import MEASURES
from ryusa.errors import CaseError, ResultsError
from ryusa.measure import contact_network, contact_stress, coordination
from ryusa.measure.snapshot import scene_at
from ryusa.model.wall_contacts import shares_of_forces
from ryusa.results.touching import contacts_per_grain

L = 10.4  # of the box [mm]
HEAD = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
spread = 0.1
[contact]
stiffness = "10 N/cm"
restitution = 0.3
friction = 0.3
timing = "at steps"
[motion]
rotation = "free"
plane = false
[build]
kind = "table"
file = "grains.csv"
[stop]
time = "0.2 s"
[record]
frames = "10 ms"
settle = "0.15 s"
events = "none"
forces = true
"""
SIDES = {
    "floor": ((0, 0, 0), (L, 0, 0), (0, L, 0), (0, 0, 1)),
    "left": ((0, 0, 0), (0, L, 0), (0, 0, 30), (1, 0, 0)),
    "right": ((L, 0, 0), (0, L, 0), (0, 0, 30), (-1, 0, 0)),
    "front": ((0, 0, 0), (L, 0, 0), (0, 0, 30), (0, 1, 0)),
    "back": ((0, L, 0), (L, 0, 0), (0, 0, 30), (0, -1, 0)),
}


def _mm(values):
    return "[" + ", ".join(f'"{one} mm"' for one in values) + "]"


def _wall(name, corner, one, other):
    head = f'[[walls]]\nname = "{name}"\nshape = "rectangle"\n'
    return head + f"at = {_mm(corner)}\nsides = [{_mm(one)}, {_mm(other)}]\n"


def _plane(name, point, normal):
    return f'[[planes]]\nname = "{name}"\npoint = {_mm(point)}\nnormal = {list(normal)}\n'


WALLS = "".join(_wall(name, *side[:3]) for name, side in SIDES.items())
PLANES = "".join(_plane(name, side[0], side[3]) for name, side in SIDES.items())
BOTH = WALLS + PLANES.replace('name = "', 'name = "plane ')
LID = WALLS + _wall("plate", (-20, -20, -0.2), (60, 0, 0), (0, 60, 0))


@pytest.fixture(scope="module")
def boxes(tmp_path_factory):
    found, folder = {}, tmp_path_factory.mktemp("boxes")
    places = [
        (1.3 + 2.4 * a + 0.25 * (7 * c % 3), 1.3 + 2.4 * b + 0.2 * (5 * c % 4), 1.2 + 2.3 * c)
        for c in range(5)
        for a in range(4)
        for b in range(4)
    ]
    rows = "\n".join(
        f"{x:.2f},{y:.2f},{z:.2f},{1.9 + 0.2 * (k * 0.618 % 1):.3f}" for k, (x, y, z) in enumerate(places)
    )
    (folder / "grains.csv").write_text("x [mm],y [mm],z [mm],d [mm]\n" + rows + "\n")
    for name, sides in {"walls": WALLS, "planes": PLANES, "both": BOTH, "a plate below": LID}.items():
        text = HEAD + sides
        (folder / f"{name}.toml").write_text(text)
        found[name] = ryusa.run(read(folder / f"{name}.toml"), folder / name, progress=False)
    return found


@pytest.mark.full
@pytest.mark.parametrize("kind", ["walls", "both", "a plate below"])
def test_touching_surfaces_are_counted_as_planes_are(boxes, kind):
    run, planes = boxes[kind], boxes["planes"]
    k = len(run.frames.t) - 1
    t = float(run.frames.t[k])
    x = np.asarray(planes.frames.x[k])  # the same places, other surfaces
    assert (contacts_per_grain(x, scene_at(run, t), t) == contacts_per_grain(x, scene_at(planes, t), t)).all()
    one, other = coordination(run), coordination(planes)
    assert one.contacts.mean() == pytest.approx(other.contacts.mean(), rel=0.1)
    assert one.rattlers.mean() == pytest.approx(other.rattlers.mean(), abs=0.1)


@pytest.mark.full
@pytest.mark.parametrize("kind", ["walls", "planes", "both", "a plate below"])
def test_the_forces_of_walls_carry_the_weight(boxes, kind):
    run = boxes[kind]
    found = contact_stress(run)
    weight = float(run.scene.m.sum()) * 9.80665
    carried = np.zeros(3)
    for k in range(15, len(run.frames.t)):
        forces = run.contact_forces(k)
        carried += forces["force"][forces["j"] >= run.scene.n_grain].sum(axis=0)
    assert carried[2] / (len(run.frames.t) - 15) == pytest.approx(weight, rel=0.05)
    bed = found.averages["bed_normal"]
    plan = float(carried[2]) / (len(run.frames.t) - 15) / bed.value
    assert plan == pytest.approx((L * 1e-3) ** 2, rel=0.25)  # sixteen grains to a layer leave the corners
    fabric = {one.name: one.value for one in found.averages.items if one.name.startswith("fabric")}
    assert fabric["fabric_xx"] + fabric["fabric_yy"] + fabric["fabric_zz"] == pytest.approx(1.0, abs=1e-9)
    assert 0.2 < fabric["fabric_zz"] < 0.5
    network = contact_network(run)
    assert (network.j >= run.scene.n_grain).any()
    assert np.isfinite(network.f_n).all()


def test_shares_of_two_like_contacts_are_halves_and_of_sharp_corners_whole():
    for degrees, share in ((0.5, 1 / 1.98), (15.0, 0.75), (60.0, 1.0)):
        a = np.radians(degrees / 2)
        away = np.array([[np.sin(a), 0, np.cos(a)], [-np.sin(a), 0, np.cos(a)]])
        found = shares_of_forces(np.ones(2) * 1e-6, away, np.zeros(2, bool))
        assert found == pytest.approx([share, share], abs=0.01)


@pytest.mark.full
def test_the_shares_of_the_frames_are_those_of_the_engine(tmp_path):
    """A grain in a cone of 12 facets: the forces that frames hold carry its weight."""
    turn = [(10 * np.cos(2 * np.pi * k / 12), 10 * np.sin(2 * np.pi * k / 12)) for k in range(12)]
    faces = "".join(
        f"facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex {a} {b} 10\nvertex {c} {d} 10\n"
        "endloop\nendfacet\n"
        for (a, b), (c, d) in zip(turn, [*turn[1:], turn[0]], strict=True)
    )
    (tmp_path / "cone.stl").write_text(f"solid c\n{faces}endsolid c\n")
    (tmp_path / "grains.csv").write_text("x [mm],y [mm],z [mm],d [mm]\n0.001,0.002,1.48,2\n")
    text = HEAD.replace("spread = 0.1\n", "").replace('"10 N/cm"', '"100 N/cm"')
    text += '[[walls]]\nname = "cone"\nshape = "mesh"\nfile = "cone.stl"\nunit = "mm"\n'
    (tmp_path / "cone.toml").write_text(text)
    run = ryusa.run(read(tmp_path / "cone.toml"), tmp_path / "run", progress=False)
    forces = run.contact_forces(len(run.frames.t) - 1)
    assert len(forces) == 12
    assert forces["force"].sum(axis=0) == pytest.approx(
        [0, 0, float(run.scene.m[0]) * 9.80665], rel=1e-3, abs=1e-8
    )
    assert float(run.tally["spring_n"][-1]) > 0.0


SHORT = {"stop.time": "60 ms", "record.settle": "20 ms", "record.frames": "5 ms"}
RUNS = {
    "walls": ("drum", {}),
    "feeds": ("hopper", {"timeline": "[]"}),
    "clumps": ("gravel_heap", {"timeline": "[]"}),
    "row": ("fed_river", {}),
}


@pytest.mark.full
@pytest.mark.parametrize("kind", RUNS)
def test_every_measure_answers_or_refuses_by_name(kind, tmp_path):
    name, more = RUNS[kind]
    run = ryusa.run(read(case_path(f"{name}.toml"), SHORT | more), tmp_path / "run", progress=False)
    answered = 0
    for entry in MEASURES:
        try:
            answered += len(run.measure(entry.name).rows()) >= 0
        except (ResultsError, CaseError) as error:
            assert len(str(error)) > 20, entry.name
    assert answered >= 6


@pytest.mark.full
def test_grains_without_weight_between_plates_have_a_stress(tmp_path):
    run = ryusa.run(
        read(
            case_path("shear_cell.toml"),
            {"stop.time": "60 ms", "timeline": "[]", "record.settle": "20 ms", "record.forces": "true"},
        ),
        tmp_path / "run",
        progress=False,
    )
    found = contact_stress(run)
    lid = found.averages["lid_normal"].value  # all that presses these grains, which weigh nothing
    assert found.weight.max() == pytest.approx(lid, rel=1e-9) and lid > 0.0
    assert any("weight of the grains per area: 0 Pa" in note for note in found.averages.notes)
    assert np.isfinite(found.xx.value).all()
    assert run.draw("contact_stress") is not None
