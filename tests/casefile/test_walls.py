"""Walls of a case file: every fault is named by key and remedy, and meshes are read as they are."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ryusa.build import build
from ryusa.build.wall_checks import MOST_STEP
from ryusa.casefile import explain, read
from ryusa.casefile.read import read_text
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.shared.parameters import LARGEST_DISPLACEMENT
from ryusa.errors import CaseError, ParseError
from ryusa.formats.mesh import read_mesh

CASE = """
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
low = ["0 cm", "0 cm", "0 cm"]
high = ["1 cm", "1 cm", "0.5 cm"]
[stop]
time = "0.1 s"
"""
FLOOR = """
[[walls]]
name = "floor"
shape = "rectangle"
at = ["-2 cm", "-2 cm", "-1 mm"]
sides = [["5 cm", "0 cm", "0 cm"], ["0 cm", "5 cm", "0 cm"]]
"""
LID = FLOOR.replace("floor", "lid").replace("-1 mm", "3 cm")
BASE = '[[planes]]\nname = "base"\npoint = ["0 m", "0 m", "0 m"]\nnormal = [0, 0, 1]\n'
DOMAIN = '[domain]\nlow = ["-3 cm", "-3 cm", "-3 cm"]\nhigh = ["3 cm", "3 cm", "3 cm"]\n'
PRESSED = 'servo = { direction = [0, 0, 1], force = "1 N", max_speed = "1 cm/s" }\n'
MESH = """
[[walls]]
name = "part"
shape = "mesh"
file = "part.stl"
unit = "mm"
at = ["0 cm", "0 cm", "-3 cm"]
"""


def tetrahedron(size: float = 20.0) -> np.ndarray:
    a, b, c, d = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * size
    return np.array([[a, c, b], [a, b, d], [a, d, c], [b, c, d]])


def write_stl(path: Path, corners: np.ndarray) -> None:
    lines = ["solid part"]
    for one in corners:
        points = [f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in one]
        lines += ["facet normal 0 0 0", "outer loop", *points]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid part", ""]))


def write_obj(path: Path, corners: np.ndarray) -> None:
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners.reshape(-1, 3)]
    lines += [f"f {3 * k + 1} {3 * k + 2} {3 * k + 3}" for k in range(len(corners))]
    path.write_text("\n".join(["mtllib /etc/passwd", "usemtl red", *lines, ""]))


def write_binary(path: Path, corners: np.ndarray) -> None:
    rows = np.zeros(len(corners), np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")]))
    rows["c"] = corners
    path.write_bytes(bytes(80) + np.uint32(len(corners)).tobytes() + rows.tobytes())


def fault(folder: Path, walls: str, case: str = CASE) -> str:
    (folder / "case.toml").write_text(case + walls)
    with pytest.raises(CaseError) as caught:
        build(read(folder / "case.toml"))
    return str(caught.value)


BAD = [
    (FLOOR.replace('shape = "rectangle"', 'shape = "rectange"'), "Did you mean 'rectangle'"),
    (FLOOR.replace("sides", "side"), "Did you mean"),
    (FLOOR + 'radius = "1 cm"\n', "walls.0.radius: has no effect with shape 'rectangle'"),
    (FLOOR.replace('"0 cm", "5 cm", "0 cm"]]', '"5 cm", "0 cm", "0 cm"]]'), "that span an area"),
    (FLOOR + FLOOR, "walls.1.name = 'floor': is used twice"),
    (FLOOR.replace('"floor"', '"grains"'), "is the name of a plane or a group of grains already"),
    (FLOOR + 'amplitude = ["0 cm", "0 cm", "1 cm"]\n', "walls.0.frequency: missing"),
    (FLOOR + 'angular_velocity = ["0 rpm", "0 rpm", "9 rpm"]\n', "walls.0.axis_point: missing"),
    (FLOOR + 'axis_point = ["0 cm", "0 cm", "0 cm"]\n', "has no effect without angular_velocity"),
    (FLOOR + 'velocity = ["0 cm", "0 cm/s", "0 cm/s"]\n', "wrong unit"),
    (FLOOR.replace("-1 mm", "0.4 mm"), "and wall 'floor' by"),
    (FLOOR.replace("-2 cm", "-2 m").replace("5 cm", "5 km"), "times the largest grain"),
    (FLOOR.replace("5 cm", "1 mm").replace("-2 cm", "-2 m"), "smaller than the largest grain, 0.002 m"),
    ('[[walls]]\nname = "a"\nshape = "cylinder"\nradius = "1 cm"\n', "'cylinder' needs at, axis, radius"),
    (FLOOR.replace('"rectangle"', '"ridges"'), "number: missing; shape 'ridges' needs at, sides, number"),
    (FLOOR + 'height = "1 mm"\n', "walls.0.height: has no effect with shape 'rectangle'"),
    ('[[walls]]\nname = "a"\nshape = "disc"\nat = ["0 m","0 m","9 m"]\nradius = "1 m"\nnormal = [0, 0, 0]\n',
     "walls.0.normal = [0, 0, 0]: must not be zero"),
    (FLOOR + 'servo = { direction = [0, 0, 1], max_speed = "1 m/s" }\n', "needs either force or pressure"),
    (FLOOR + 'servo = { direction = [0, 0, 1], force = "1 N", pressure = "1 Pa", max_speed = "1 m/s" }\n',
     "walls.0.servo.force = '1 N': needs either force or pressure, and not both"),
    (FLOOR + 'servo = { direction = [0, 0, 1], force = "1 N" }\n', "walls.0.servo.max_speed"),
    (FLOOR + 'servo = { direction = [0, 0, 0], force = "1 N", max_speed = "1 m/s" }\n', "must not be zero"),
    (FLOOR + 'servo = { direction = [0, 1, 0], force = "1 N", max_speed = "1 m/s" }\n', "lies in the wall"),
    (FLOOR + 'servo = { direction = [0, 0, 1], force = "-1 N", max_speed = "1 m/s" }\n', "0.servo.force"),
    (FLOOR + PRESSED + 'axis_point = ["0 m", "0 m", "0 m"]\nangular_velocity = ["9 rpm", "0 rpm", "0 rpm"]\n',
     "must be along angular_velocity"),
    (FLOOR + PRESSED + '[[timeline]]\nat = "1 ms"\nmove = { wall = "floor" }\n', "has a servo, which"),
    ('[[walls]]\nname = "a"\nshape = "cylinder"\nat = ["0 m","0 m","9 m"]\nradius = "1 m"\n'
     'axis = ["0 m", "0 m", "1 m"]\n' + PRESSED, "needs a wall that is a rectangle, a disc or a mesh"),
    (FLOOR + '[[timeline]]\nat = "1 ms"\nmove = { wall = "flor" }\n', "must be a wall: floor"),
    (FLOOR + '[[timeline]]\nat = "1 ms"\nremove = "roof"\n', "a plane or a wall: floor"),
    (FLOOR + '[[timeline]]\nat = "1 ms"\nremove = "floor"\nslope = 0.1\n', "needs exactly one of"),
    (FLOOR.replace('"floor"', '"a\\nb"'), "walls.0.name = 'a\\nb': must be printable text on one line"),
    (BASE + FLOOR, "walls.0.name = 'floor': lies behind the plane 'base', where no grain gets: move it 0"),
    (DOMAIN + FLOOR.replace("-1 mm", "5 cm"), "lies outside domain.low and domain.high"),
    (FLOOR + 'velocity = ["0 m/s", "0 m/s", "-1e5 m/s"]\n', "walls.0 = 'floor': moves at up to 1e+05 m/s"),
    (FLOOR + '[[timeline]]\nat = "1 ms"\nmove = {wall = "floor", velocity = ["1e3 m/s", "0 m/s", "0 m/s"]}\n',
     "timeline.0.move = 'floor': moves at up to 1e+03 m/s and could pass through a grain in a step: at most"),
    (LID + 'servo = { direction = [0, 0, 1], force = "1 N", max_speed = "1 cm/s" }\n',
     "walls.0.servo.direction = [0.0, 0.0, 1.0]: presses away from all first grains"),
    (LID + 'servo = { direction = [0, 0, -1], force = "1 N", max_speed = "1 m/s", max_travel = "1 cm" }\n',
     "walls.0.servo.max_travel = 0.01: ends before the first grain, which is 0.0258"),
    (LID + 'servo = { direction = [0, 0, -1], force = "1 N", max_speed = "1 km/s" }\n', "moves at up to 1e"),
    (LID + 'servo = { direction = [0, 0, -1], pressure = "1 MPa", max_speed = "1 m/s", max_travel = "1 m"}\n',
     "walls.0.servo = 'lid': presses at most 32 grains side by side, each by at least 3.9 d, more than "
     "domain.overlap_limit, 0.5: lower its force or pressure below 0.13 of what it is, or raise contact."),
]  # fmt: skip


@pytest.mark.parametrize(("walls", "said"), BAD)
def test_a_wall_that_cannot_be_is_named_with_its_key(tmp_path: Path, walls: str, said: str) -> None:
    assert said in fault(tmp_path, walls)


def test_a_plane_scene_has_no_walls(tmp_path: Path) -> None:
    flat = CASE.replace("plane = false", "plane = true")
    assert "needs motion.plane = false" in fault(tmp_path, FLOOR, flat)


def test_elastic_spheres_meet_walls(tmp_path: Path) -> None:
    elastic = CASE.replace(
        'stiffness = "100 N/cm"',
        'law = "Hertz-Mindlin"\nyoungs_modulus = "10 MPa"\nexpected_speed = "0.5 m/s"',
    )
    path = tmp_path / "case.toml"
    path.write_text(elastic + FLOOR, encoding="utf-8")
    built = build(read(path))
    assert built.scene.walls is not None
    assert CpuEngine().refuses(built.scene) == ()


def test_a_mesh_that_cannot_be_is_named_with_its_file(tmp_path: Path) -> None:
    part = tmp_path / "part.stl"
    assert "walls.0.file = 'part.stl': no such file in the folder of the case" in fault(tmp_path, MESH)
    part.write_text("solid nothing\nendsolid nothing\n")
    assert "walls.0.file" in (said := fault(tmp_path, MESH))
    assert "no triangle" in said or "cannot be read as STL" in said
    part.write_bytes(b"\x00" * 200)
    assert "walls.0.file" in fault(tmp_path, MESH)
    write_stl(part, np.zeros((2, 3, 3)))
    assert "all its 2 triangles have no area" in fault(tmp_path, MESH)
    write_binary(part, np.full((1, 3, 3), np.nan))
    assert "triangle 0 has a corner that is not finite" in fault(tmp_path, MESH)
    write_stl(part, tetrahedron())
    assert "walls.0.unit = 'mmm'" in fault(tmp_path, MESH.replace('"mm"', '"mmm"'))
    assert "walls.0.unit = 's'" in fault(tmp_path, MESH.replace('"mm"', '"s"'))
    assert "smaller than the largest grain" in (said := fault(tmp_path, MESH.replace('"mm"', '"um"')))
    assert "check unit and scale" in said
    assert "STL or OBJ" in fault(tmp_path, MESH.replace("part.stl", "case.toml"))
    assert "needs a path inside the folder of the case file" in fault(
        tmp_path, MESH.replace("part.stl", "../part.stl")
    )
    assert "walls.0.turn_axis: missing" in fault(tmp_path, MESH + 'turn_angle = "3 deg"\n')


def test_text_binary_and_obj_files_give_the_same_triangles(tmp_path: Path) -> None:
    corners = tetrahedron()
    for name, write in (("a.stl", write_stl), ("b.stl", write_binary), ("c.obj", write_obj)):
        write(tmp_path / name, corners)
        assert np.array_equal(read_mesh(tmp_path / name, name), corners), name


def test_a_mesh_is_scaled_turned_and_placed(tmp_path: Path) -> None:
    write_stl(tmp_path / "part.stl", tetrahedron())
    turned = MESH + 'scale = 2\nturn_axis = [0, 0, 3]\nturn_angle = "90 deg"\n'
    (tmp_path / "case.toml").write_text(CASE + turned)
    walls = build(read(tmp_path / "case.toml")).scene.walls
    assert walls is not None
    face = walls.face[0]  # its corners are (0, 0, 0), (0, 1, 0) and (1, 0, 0) of 20 mm in the file
    assert face[:3] == pytest.approx([0, 0, -0.03])
    assert face[3:6] == pytest.approx([-0.04, 0, 0])
    assert face[6:9] == pytest.approx([0, 0.04, 0], abs=1e-15)


def test_check_says_what_a_mesh_is_like(tmp_path: Path) -> None:
    corners = np.concatenate([tetrahedron()[:3], np.zeros((1, 3, 3))])  # open, and one triangle of no area
    write_stl(tmp_path / "part.stl", corners)
    (tmp_path / "case.toml").write_text(CASE + MESH)
    rows = {one.name: one for one in explain(read(tmp_path / "case.toml"))}
    assert rows["part: triangles"].value == 3
    assert rows["part: left out"].value == 1
    assert rows["part: open sides"].value == 3
    assert "holes" in rows["part: open sides"].origin
    assert rows["part: size in x, y, z"].value == "2 x 2 x 2 cm"


def test_a_triangle_given_twice_counts_once_and_a_far_corner_is_not_forgotten(tmp_path: Path) -> None:
    part = tmp_path / "part.stl"
    whole = tetrahedron()
    write_stl(part, np.concatenate([whole, whole[:1], whole[1:2, [2, 0, 1]], whole[2:3, [0, 2, 1]]]))
    (tmp_path / "case.toml").write_text(CASE + MESH)
    case = read(tmp_path / "case.toml")
    rows = {one.name: one for one in explain(case)}
    assert (rows["part: triangles"].value, rows["part: doubled"].value) == (4, 3)
    assert "part: open sides" not in rows
    assert "part: shared sides" not in rows
    walls = build(case).scene.walls
    assert walls is not None
    assert walls.n_face == 4
    far = whole.copy()
    far[0, 0] = 1e30  # so long that it has no area beside its length
    write_stl(part, far)
    assert "check unit and scale" in fault(tmp_path, MESH)
    far[0, 0] = 1e12
    write_stl(part, far)
    assert "times the largest grain" in fault(tmp_path, MESH)


def test_a_hole_is_told_with_its_width_and_a_doubtful_unit_with_the_size(tmp_path: Path) -> None:
    write_stl(tmp_path / "part.stl", tetrahedron()[1:])
    (tmp_path / "case.toml").write_text(CASE + MESH)
    rows = {one.name: one for one in explain(read(tmp_path / "case.toml"))}
    assert "in 1 rim, the widest 2.83 cm across" in rows["part: open sides"].origin
    assert rows["part: size in x, y, z"].flag == ""
    assert rows["part: size in x, y, z"].origin == "mesh; 10 of the largest grains across"
    (tmp_path / "case.toml").write_text(CASE + MESH.replace('"mm"', '"m"').replace("-3 cm", "-30 m"))
    assert not [one for one in explain(read(tmp_path / "case.toml")) if "more than 10000" in one.origin]
    (tmp_path / "case.toml").write_text(
        CASE + MESH.replace('"mm"', '"ft"').replace("-3 cm", "-30 m") + "scale = 20\n"
    )
    wide = [one for one in explain(read(tmp_path / "case.toml")) if one.flag == "warning"]
    assert any("more than 10000: check its lengths and units" in one.origin for one in wide)


PERIODIC = CASE.replace(
    'kind = "fill"\nlow = ["0 cm", "0 cm", "0 cm"]\nhigh = ["1 cm", "1 cm", "0.5 cm"]',
    'kind = "packing"\ncolumns = 7\nrows = 7\nlayers = 2',
)
TUBE = """
[[walls]]
name = "tube"
shape = "cylinder"
at = ["0 m", "0 m", "-2 cm"]
axis = ["0 m", "0 m", "5 cm"]
radius = "3 cm"
"""


def test_a_wall_that_does_not_fit_a_period_is_named(tmp_path: Path) -> None:
    turning = FLOOR + 'angular_velocity = ["0 rpm", "0 rpm", "9 rpm"]\naxis_point = ["0 m", "0 m", "0 m"]\n'
    assert "walls.0.angular_velocity = ['0 rpm', '0 rpm', '9 rpm']" in (
        said := fault(tmp_path, turning, PERIODIC)
    )
    assert "across x, which is periodic" in said
    assert "walls.0: is 0.06 m wide in x, too wide for the period" in fault(tmp_path, TUBE, PERIODIC)
    long = FLOOR.replace("-2 cm", "-2 m").replace("5 cm", "9 m")
    assert "make it as long as the period" in fault(tmp_path, long, PERIODIC)
    along = TUBE.replace('["0 m", "0 m", "5 cm"]', '["5 cm", "0 m", "0 m"]').replace("3 cm", "3 mm")
    (tmp_path / "case.toml").write_text(PERIODIC + along)
    assert build(read(tmp_path / "case.toml")).scene.n_wall == 1


def test_builders_and_engines_agree_how_far_a_wall_may_go_in_a_step() -> None:
    assert MOST_STEP == LARGEST_DISPLACEMENT


def test_flipped_triangles_are_one_surface_with_their_neighbours(tmp_path: Path) -> None:
    square = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [0, 1, 0], [1, 1, 0]]]) * 20.0
    for corners in (square, square[:, [0, 2, 1]], np.stack([square[0], square[1, [0, 2, 1]]])):
        write_stl(tmp_path / "part.stl", corners)
        (tmp_path / "case.toml").write_text(CASE + MESH)
        walls = build(read(tmp_path / "case.toml")).scene.walls
        assert walls is not None
        assert walls.surface.tolist() == [0, 0]


def test_check_says_that_flipped_triangles_play_no_part(tmp_path: Path) -> None:
    whole = tetrahedron()
    flipped = whole.copy()
    flipped[1] = flipped[1, ::-1]
    for corners, sides in ((whole, 0), (whole[:, ::-1], 0), (flipped, 3)):
        write_stl(tmp_path / "part.stl", corners)
        (tmp_path / "case.toml").write_text(CASE + MESH)
        rows = {one.name: one for one in explain(read(tmp_path / "case.toml"))}
        assert ("part: flipped sides" in rows) == (sides > 0)
        if sides:
            found = rows["part: flipped sides"]
            assert (found.value, found.flag) == (sides, "")
            assert "plays no part" in found.origin


def test_the_default_domain_has_room_for_the_walls(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(CASE + FLOOR.replace("-1 mm", "-1 m"))
    scene = build(read(tmp_path / "case.toml")).scene
    assert scene.world_low[2] < -1.01


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(kind=st.sampled_from([".stl", ".obj"]), data=st.data())
def test_a_damaged_mesh_is_refused_or_read(tmp_path: Path, kind: str, data: st.DataObject) -> None:
    path = tmp_path / f"part{kind}"
    write = data.draw(st.sampled_from([write_stl, write_binary] if kind == ".stl" else [write_obj]))
    write(path, tetrahedron())
    whole = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        at = data.draw(st.integers(0, len(whole) - 1))
        whole[at] = data.draw(st.integers(0, 255))
    path.write_bytes(bytes(whole[: data.draw(st.integers(0, len(whole)))]))
    try:
        corners = read_mesh(path, path.name)
    except ParseError as error:
        assert path.name in str(error)
        assert "\n" not in str(error)
    else:
        assert corners.shape[1:] == (3, 3)
        assert np.isfinite(corners).all()


def test_a_servo_that_presses_grains_out_of_the_stable_range_is_noted() -> None:
    """Of 32 grains each bears 1/32 of 10 N: 0.0156 d of 2 mm with springs of 10 kN/m."""
    lid = (
        LID + 'servo = { direction = [0, 0, -1], force = "10 N", max_speed = "1 m/s", max_travel = "5 cm" }\n'
    )
    (said,) = (one for one in build(read_text(CASE + lid)).notes if "presses" in one)
    assert "wall 'lid' presses at most 32 grains side by side, each by at least 0.016 d, above 0.01 d" in said
    light = lid.replace("10 N", "1 N")
    assert not [one for one in build(read_text(CASE + light)).notes if "presses" in one]
    narrow = lid.replace('"5 cm", "0 cm"', '"4 mm", "0 cm"').replace('"0 cm", "5 cm"', '"0 cm", "4 mm"')
    (said,) = (
        one for one in build(read_text(CASE + narrow.replace("10 N", "1 N"))).notes if "presses" in one
    )
    assert "at most 5 grains" in said
