"""Builder 'fill' with `inside`: whole grains in a mesh or a cylinder, and which walls are refused."""

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial import KDTree

import ryusa
from ryusa.build import build
from ryusa.build.case import Built
from ryusa.casefile.case import Case
from ryusa.casefile.explain import explain
from ryusa.casefile.read import read
from ryusa.casefile.resolved import resolved
from ryusa.errors import CaseError
from ryusa.model.wall_shape import nearest_on_face

D = 2.0e-3
TEXT = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
spread = 0.1
[contact]
stiffness = "1e4 N/m"
restitution = 0.7
friction = 0.5
[motion]
rotation = "free"
plane = false
[build]
kind = "fill"
inside = "vessel"
[stop]
time = "0.02 s"
[record]
frames = "5 ms"
[[walls]]
name = "vessel"
"""
MESH = 'shape = "mesh"\nfile = "vessel.stl"\nunit = "mm"\n'
TILTED = (
    'shape = "cylinder"\nat = ["3 cm", "0 cm", "1 cm"]\naxis = ["8 mm", "6 mm", "14 mm"]\nradius = "9 mm"\n'
)
BOX_KEYS = 'low = ["0 m", "0 m", "0 m"]\nhigh = ["1 cm", "1 cm", "1 cm"]'
CURVE = '[["0.5 mm", 0], ["1 mm", 40], ["2 mm", 100]]'


def case_of(folder: Path, wall: trimesh.Trimesh | str, **keys: str) -> Case:
    """The case above with a wall: a mesh in mm, or keys of another shape."""
    text = TEXT + (wall if isinstance(wall, str) else MESH)
    if not isinstance(wall, str):
        wall.export(folder / "vessel.stl")
    (folder / "case.toml").write_text(text)
    return read(folder / "case.toml", keys)


def fault(folder: Path, wall: trimesh.Trimesh | str, **keys: str) -> str:
    with pytest.raises(CaseError) as found:
        build(case_of(folder, wall, **keys))
    return str(found.value)


def whole_and_apart(made: Built) -> np.ndarray:
    """Centres in units of the case file, mm, of grains of which none reaches into a face or another grain."""
    scene, x = made.scene, made.state.x
    walls = scene.walls
    assert walls is not None
    for face, kind in zip(walls.face, walls.kind, strict=True):
        away = np.array([nearest_on_face(face, int(kind), one) - one for one in x])
        assert np.all(np.linalg.norm(away, axis=1) >= 0.5 * scene.d * (1.0 - 1e-9))
    pairs = KDTree(x).query_pairs(float(scene.d.max()), output_type="ndarray")
    if len(pairs):
        apart = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1)
        assert np.all(apart >= 0.5 * (scene.d[pairs[:, 0]] + scene.d[pairs[:, 1]]) * (1.0 - 1e-9))
    return x * 1000.0


def prism(outline: list[tuple[float, float]], caps: list[tuple[int, int, int]]) -> trimesh.Trimesh:
    """A closed prism of height 10 on an outline in x and z, its ends cut into triangles."""
    n = len(outline)
    points = [(x, y, z) for y in (0.0, 10.0) for x, z in outline]
    faces = [*caps, *((a + n, c + n, b + n) for a, b, c in caps)]
    for k in range(n):
        a, b = k, (k + 1) % n
        faces += [(a, a + n, b), (b, a + n, b + n)]
    return trimesh.Trimesh(points, faces, process=False)


def frustum(low: float, high: float, height: float, bottom: bool = False) -> trimesh.Trimesh:
    """A cone of two radii that is open above, and below unless it has a bottom."""
    angle = 2.0 * math.pi * np.arange(24) / 24
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    points = [*(low * ring), *(high * ring + [0, 0, height]), (0.0, 0.0, 0.0)]
    faces = [one for k in range(24) for one in _strip(k, (k + 1) % 24)]
    faces += [(k, (k + 1) % 24, 48) for k in range(24)] if bottom else []
    return trimesh.Trimesh(points, faces, process=False)


def _strip(k: int, after: int) -> list[tuple[int, int, int]]:
    return [(k, after, k + 24), (after, after + 24, k + 24)]


# a vessel in the form of a U: the notch is 10 < x < 20 above z = 10
U = prism(
    [(0, 0), (30, 0), (30, 30), (20, 30), (20, 10), (10, 10), (10, 30), (0, 30)],
    [(0, 1, 4), (0, 4, 5), (0, 5, 7), (5, 6, 7), (1, 2, 4), (2, 3, 4)],
)


def test_a_ball_of_triangles_is_filled_with_whole_grains(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=2, radius=12.0)
    x = whole_and_apart(build(case_of(tmp_path, ball)))
    assert np.linalg.norm(x, axis=1).max() < 11.1
    assert len(x) > 300
    assert np.abs(x.mean(axis=0)).max() < 0.3


def test_a_box_of_triangles_holds_as_many_as_a_box(tmp_path: Path) -> None:
    """Also turned inside out, or with some triangles flipped: what is inside does not depend on that."""
    box = trimesh.creation.box((21.0, 14.0, 17.0))
    count = len(whole_and_apart(build(case_of(tmp_path, box))))
    plain = TEXT.replace(
        'inside = "vessel"', 'low = ["0 m", "0 m", "0 m"]\nhigh = ["21 mm", "14 mm", "17 mm"]'
    )
    (tmp_path / "plain.toml").write_text(plain.partition("[[walls]]")[0])
    assert count == len(build(read(tmp_path / "plain.toml")).state.x)
    flipped = box.faces.copy()
    flipped[::3] = flipped[::3, ::-1]
    for faces in (box.faces[:, ::-1], flipped):
        other = trimesh.Trimesh(box.vertices, faces, process=False)
        assert len(whole_and_apart(build(case_of(tmp_path, other)))) == count


@pytest.mark.parametrize("ends", ["open", "closed"])
def test_a_tilted_cylinder_is_filled_between_its_ends(tmp_path: Path, ends: str) -> None:
    made = build(case_of(tmp_path, f'{TILTED}ends = "{ends}"\n'))
    x, r = whole_and_apart(made), 500.0 * made.scene.d
    away, along = x - np.array([30.0, 0.0, 10.0]), np.array([8.0, 6.0, 14.0])
    length = float(np.linalg.norm(along))
    h = away @ along / length
    assert np.all(h >= r - 1e-9)
    assert np.all(h <= length - r + 1e-9)
    assert np.all(np.linalg.norm(away - h[:, None] * along / length, axis=1) <= 9.0 - r + 1e-9)
    assert len(x) > 200


@pytest.mark.parametrize("bottom", [False, True])
def test_openings_of_a_hopper_count_as_closed_by_lids(tmp_path: Path, bottom: bool) -> None:
    case = case_of(tmp_path, frustum(4.0, 14.0, 20.0, bottom))
    made = build(case)
    x, r = whole_and_apart(made), 500.0 * made.scene.d
    assert np.all((x[:, 2] >= r - 1e-9) & (x[:, 2] <= 20.0 - r + 1e-9))
    assert np.all(np.hypot(x[:, 0], x[:, 1]) < 4.0 + 0.5 * x[:, 2])
    found = {row.name.partition(": ")[2]: row for row in explain(case) if row.section == "build"}
    polygon = 12.0 * math.sin(2.0 * math.pi / 24) * 20.0 / 3.0 * (4.0**2 + 4.0 * 14.0 + 14.0**2)
    assert found["volume"].value == pytest.approx(1e-9 * polygon, rel=1e-3)
    assert f"lids on its openings: {1 if bottom else 2}" in found["volume"].origin
    assert found["grains that fit"].value == len(x)
    assert 0.2 < float(found["filled"].value) < 0.5


def test_no_grain_lies_in_a_notch(tmp_path: Path) -> None:
    made = build(case_of(tmp_path, U, **{"grains.spread": "0"}))
    x = whole_and_apart(made)
    assert not np.any((x[:, 0] > 9.0) & (x[:, 0] < 21.0) & (x[:, 2] > 9.0))
    for leg in (x[:, 0] < 9.0, x[:, 0] > 21.0, (x[:, 0] > 10.0) & (x[:, 0] < 20.0)):
        assert leg.any()


@pytest.mark.parametrize("wall", ["ball", "U", "cylinder"])
def test_a_sieve_curve_is_laid_whole_too(tmp_path: Path, wall: str) -> None:
    walls = {"ball": trimesh.creation.icosphere(subdivisions=2, radius=8.0), "U": U, "cylinder": TILTED}
    keys = {"grains.sieve_curve": CURVE, "build.gap": "0.1"}
    text = TEXT.replace('diameter = "2 mm"\n', "").replace("spread = 0.1\n", "")
    if not isinstance(shape := walls[wall], str):
        shape.export(tmp_path / "vessel.stl")
    (tmp_path / "case.toml").write_text(text + (shape if isinstance(shape, str) else MESH))
    made = build(read(tmp_path / "case.toml", keys))
    x = whole_and_apart(made)
    assert made.scene.d.min() < 0.6e-3
    assert made.scene.d.max() > 1.9e-3
    if wall == "ball":
        assert np.linalg.norm(x, axis=1).max() < 8.0
    if wall == "U":
        assert not np.any((x[:, 0] > 10.0) & (x[:, 0] < 20.0) & (x[:, 2] > 10.0))


def test_a_wall_that_moves_is_filled_where_it_begins(tmp_path: Path) -> None:
    turning = 'angular_velocity = ["0 rpm", "60 rpm", "0 rpm"]\naxis_point = ["3 cm", "0 cm", "1 cm"]\n'
    swinging = 'amplitude = ["5 mm", "0 m", "0 m"]\nfrequency = "3 Hz"\nphase = "90 deg"\n'
    still = build(case_of(tmp_path, TILTED)).state.x
    assert np.array_equal(build(case_of(tmp_path, TILTED + turning + swinging)).state.x, still)


def test_the_lowest_are_taken_of_those_that_fit(tmp_path: Path) -> None:
    every = build(case_of(tmp_path, TILTED)).state.x
    some = build(case_of(tmp_path, TILTED, **{"build.number": "50"})).state.x
    assert len(some) == 50
    assert some[:, 2].max() <= np.sort(every[:, 2])[60] + 0.1 * D
    assert len(build(case_of(tmp_path, TILTED, **{"build.most": "50"})).state.x) == 50
    assert len(build(case_of(tmp_path, TILTED, **{"build.most": "5000"})).state.x) == len(every)
    said = fault(tmp_path, TILTED, **{"build.number": "5000"})
    assert f"build.number = 5000: do not fit: 'vessel' holds {len(every)}; ask for no more" in said
    both = {"build.number": "5", "build.most": "5"}
    assert "build.number = 5: excludes build.most" in fault(tmp_path, TILTED, **both)


def test_a_ball_that_just_holds_one_grain_holds_it(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=1.4)
    assert len(whole_and_apart(build(case_of(tmp_path, ball)))) == 1


def opened(mesh: trimesh.Trimesh, faces: slice) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices, mesh.faces[faces], process=False)


def cup(thick: float) -> trimesh.Trimesh:
    """A closed vessel of outer radius 15 whose walls are so thick, turned about the z axis."""
    inner = 15.0 - thick
    line = [(0.0, 0.0), (15.0, 0.0), (15.0, 20.0), (inner, 20.0), (inner, thick), (0.0, thick)]
    return trimesh.creation.revolve(np.array(line), sections=24)


BALL = trimesh.creation.icosphere(subdivisions=2, radius=12.0)
BOX = trimesh.creation.box((20.0, 20.0, 20.0))
DIAGONAL = [int(np.argmin(np.abs(BOX.vertices - one).sum(axis=1))) for one in
            [(-10, -10, -10), (10, 10, -10), (10, 10, 10), (-10, -10, 10)]]  # fmt: skip
SPLIT = trimesh.Trimesh(
    BOX.vertices, [*BOX.faces, DIAGONAL[:3], [DIAGONAL[k] for k in (0, 2, 3)]], process=False
)
REFUSED = {
    "half a bent rim": (opened(BALL, slice(0, 170)), "has a rim that leaves a plane by", "build.low"),
    "a sheet": (opened(BOX, slice(0, 1)), "is a flat sheet", "build.low and build.high"),
    "a partition": (SPLIT, "sides three or more triangles meet", "mend the mesh"),
    "thin walls": (cup(1.0), "holds no grain: it is 30 x 30 x 20 m", "a vessel with thick walls"),
    "small": (trimesh.creation.box((1.0, 1.0, 1.0)), "one needs 0.00231 m each way; take smaller", ""),
    "a disc": ('shape = "disc"\nat = ["0 m", "0 m", "0 m"]\nnormal = [0, 0, 1]\nradius = "2 cm"\n',
               "is a disc, which has no inside; must be a mesh or a cylinder", "build.low"),
    "no radius": (TILTED.replace("radius", "#"), "walls.0.radius: missing", ""),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_a_wall_without_a_known_inside_is_refused_with_the_remedy(tmp_path: Path, name: str) -> None:
    wall, about, remedy = REFUSED[name]
    said = fault(tmp_path, wall)
    if "walls.0" not in about:
        assert "build.inside = 'vessel': " in said
    assert about.replace("30 x 30 x 20", "0.03 x 0.03 x 0.02") in said
    assert remedy in said


def test_a_vessel_with_thick_walls_is_filled_between_its_surfaces_alone(tmp_path: Path) -> None:
    x = whole_and_apart(build(case_of(tmp_path, cup(6.0))))
    assert not np.any((np.hypot(x[:, 0], x[:, 1]) < 9.0) & (x[:, 2] > 6.0))


@pytest.mark.parametrize(
    ("keys", "about"),
    [
        ({"build.inside": "vesel"}, "must be one of [[walls]]: vessel. Did you mean 'vessel'?"),
        ({"build.low": '["0 m", "0 m", "0 m"]'}, "build.low: excludes build.inside"),
        ({"build.periodic": "true"}, "build.periodic = True: needs build.low and build.high"),
        ({"motion.plane": "true"}, "needs motion.plane = false"),
    ],
)
def test_what_does_not_go_with_a_wall_is_named(tmp_path: Path, keys: dict[str, str], about: str) -> None:
    assert about in fault(tmp_path, TILTED, **keys)


def test_a_fill_says_where(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(TEXT.replace('inside = "vessel"\n', "") + TILTED)
    with pytest.raises(CaseError, match=r"build.low: missing; give low and high, or inside with the name"):
        read(tmp_path / "case.toml")


def test_a_box_holds_the_number_asked_or_says_how_many(tmp_path: Path) -> None:
    box = TEXT.replace('inside = "vessel"', BOX_KEYS)
    (tmp_path / "case.toml").write_text(box.partition("[[walls]]")[0])
    assert len(build(read(tmp_path / "case.toml", {"build.number": "60"})).state.x) == 60
    with pytest.raises(CaseError, match=r"build.number = 65: do not fit: the box holds 64"):
        read(tmp_path / "case.toml", {"build.number": "65"})


def test_a_case_without_the_new_keys_is_kept_as_by_earlier_versions(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(TEXT.replace('inside = "vessel"', BOX_KEYS) + TILTED)
    assert not {"inside", "number"} & set(resolved(read(tmp_path / "case.toml"))["build"])
    assert resolved(case_of(tmp_path, TILTED))["build"]["inside"] == "vessel"


def test_grains_stay_in_the_vessel_that_they_fill(tmp_path: Path) -> None:
    keys = {"build.number": "120"}
    run = ryusa.run(case_of(tmp_path, BALL, **keys), tmp_path / "run", progress=False)
    last = run.frames.x[-1]
    assert len(last) == 120
    assert np.linalg.norm(last, axis=1).max() < 11.3e-3
