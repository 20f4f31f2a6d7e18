"""No key of a case is without effect and unsaid, and no column of a file that it reads.

The walk goes over the schema itself: a key that is added is in it. If `test_every_key_acts_somewhere` names
one, give it to a case of walked_cases.toml in which it acts.
"""

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.casefile import schema_walk as walk
from tests.casefile.schema_walk import Data, Key, Outcome

from ryusa.build import build
from ryusa.casefile import Case, read_text
from ryusa.cases import case_files
from ryusa.errors import CaseError, ParseError, RyusaError
from ryusa.formats.csv import read_csv
from ryusa.formats.mesh import read_mesh
from ryusa.formats.vtu import read_vtu, vtu_file

PACKAGED = {name: path.read_text(encoding="utf-8") for name, path in case_files().items()}
MOST, ENOUGH = 12, 4  # values tried of a key, and of those that are taken and change nothing
NAMED = ("schema", "title", "name")  # of the file itself; what pictures, tables and messages call a thing
MATERIAL = ("material", "bed_material")  # where "grains" is what holds without the key
QUICK = ("single", "drop", "box", "quiet", "saltation", "flat", "weir", "table", "plain")
NEVER = {  # always refused
    "water.row.upstream.stage",
    *(f"water.row.downstream.{one}" for one in ("depth", "discharge", "hydrograph", "profile", "run")),
}
# of files that only a run leaves: tests/formats/test_first_grains.py, tests/casefile/test_reach_record.py
OF_RUNS = {
    *(f"build(run).{one}" for one in ("folder", "at", "allow_overlap")),
    "build(stream).bed.run",
    "build(stream).bed.at",
    "water.row.upstream.run",
}

CASES = tomllib.loads(Path(__file__).with_name("walked_cases.toml").read_text(encoding="utf-8"))

STL = """solid box
{facets}endsolid box
"""


def stl(side: float) -> str:
    """A tetrahedron as text."""
    corners = ((0, 0, 0), (side, 0, 0), (0, side, 0), (0, 0, side))
    faces = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
    rows = ""
    for face in faces:
        vertices = "".join("vertex {} {} {}\n".format(*corners[k]) for k in face)
        rows += f"facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n"
    return STL.format(facets=rows)


GROUPS = "x [mm],z [mm],d [mm],group\n0,5,2,\n5,5,2,ball\n"
NEAR = "x [mm],z [mm],d [mm]\n0,0,2\n1.9,0,2\n"
GRAINS = "t [s],x [cm],z [cm],d [mm],fixed\n0,0.5,0.5,2,0\n0,1.0,0.5,2,1\n1,0.6,0.5,2,0\n1,1.0,0.6,2,1\n"
DUMP = """ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS ff ff ff
0 50
0 50
0 50
ITEM: ATOMS id type x y z vx vy vz diameter mass
1 1 10 10 10 0 0 1 4 0.08
2 2 20 10 10 0 0 0 4 0.08
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files of the cases."""
    at = tmp_path_factory.mktemp("case")
    (at / "wall.stl").write_text(stl(20.0), encoding="utf-8")
    (at / "body.stl").write_text(stl(1.0), encoding="utf-8")
    (at / "grains.csv").write_text(GRAINS, encoding="utf-8")
    (at / "near.csv").write_text(NEAR, encoding="utf-8")
    (at / "groups.csv").write_text(GROUPS, encoding="utf-8")
    (at / "grains.dump").write_text(DUMP, encoding="utf-8")
    return at


def data_of(name: str) -> Data:
    """A case of walked_cases.toml as data."""
    changes = dict(CASES[name])
    data: Data = tomllib.loads(PACKAGED[changes.pop("case")])
    return with_values(data, dict.fromkeys(changes.pop("without", ())) | changes)


def with_values(data: Data, changes: Data) -> Data:
    """A case with some keys set, None: taken out."""
    for key, value in changes.items():
        path = tuple(int(one) if one.isdecimal() else one for one in key.split("."))
        data = walk.with_value(data, path, value)
    return data


def tried(
    data: Data, before: Case, folder: Path, path: Key, schema: Data
) -> Iterator[tuple[Any, Outcome | None]]:
    """Values of a key that change the case, each with what follows; None where it is refused."""
    now, words = walk.value_at(data, path), walk.words_in(data)
    same = before.model_dump(mode="json")
    for value in walk.values_for(schema, now, words)[:MOST]:
        changed = walk.with_value(data, path, value)
        try:
            case = walk.read_data(changed, folder)
            if case.model_dump(mode="json") != same:
                yield value, walk.outcome(case)
        except RyusaError:
            yield value, None


def is_table(schema: Data) -> bool:
    """Whether a key is a table, or a list of tables: their keys are what acts."""
    kinds = list(walk.branches(schema))
    lists = [one["items"] for one in kinds if "items" in one]
    inner = [part for one in lists for part in walk.branches(one)]
    return all("properties" in one or one.get("type") in {"array", "object"} for one in kinds) and (
        any("properties" in one for one in (*kinds, *inner))
        or any("$ref" in str(one.get("additionalProperties", "")) for one in kinds)
    )


def _walked(data: Data) -> Iterator[tuple[Key, str, Data]]:
    for path, schema in walk.keys(here=data):
        if path[-1] not in NAMED and "const" not in schema and not is_table(schema):
            yield path, walk.general(path, data), schema


@pytest.mark.full
def test_every_key_acts_somewhere(folder: Path) -> None:
    """Every key of the schema changes a scene, its rows or the control of a run, in some case."""
    acting: set[str] = set()
    every: set[str] = set()
    for name in CASES:
        data = data_of(name)
        case = walk.read_data(data, folder)
        before = walk.outcome(case)
        for path, key, schema in _walked(data):
            every.add(key)
            if key in acting:
                continue
            for value, after in tried(data, case, folder, path, schema):
                if after is not None and (after.acts, after.rows) != (before.acts, before.rows):
                    acting.add(key)
                    break
                if value is None and after is None:  # the case needs it
                    acting.add(key)
                    break
    assert sorted(every - acting - NEVER - OF_RUNS) == []


def silent(name: str, folder: Path) -> list[str]:
    """Keys that a case takes, that change nothing in it, and of which nothing is said."""
    data = data_of(name)
    case = walk.read_data(data, folder)
    before, found = walk.outcome(case), list[str]()
    for path, _, schema in _walked(data):
        key, taken, unsaid = ".".join(map(str, path)), 0, list[Any]()
        for value, after in tried(data, case, folder, path, schema):
            if after is None or value is None or is_default(data, before, after, path, value):
                continue
            if (after.acts, after.rows) != (before.acts, before.rows):
                unsaid = []
                break
            taken += 1
            if not any(key in one for one in after.said):
                unsaid.append(value)
            if taken == ENOUGH:
                break
        found += [f"{key} = {unsaid[0]}"] if unsaid else []
    return found


def is_default(data: Data, before: Outcome, after: Outcome, path: Key, value: Any) -> bool:
    """Whether a value is what holds without the key as well, so that writing it changes nothing."""
    law = before.rows.get(("laws", ".".join(map(str, path))), "").strip()
    return (
        before.filled_in == after.filled_in
        or law == str(value)
        or (path[0] == "materials" and value == walk.value_at(data, ("contact", path[-1])))
        or (path[-1] in MATERIAL and value == "grains")
        or (path[-1] in {"ratio", "frame", "allow_overlap"} and value in {0, True})
    )


@pytest.mark.parametrize("name", QUICK)
def test_no_key_is_silent(folder: Path, name: str) -> None:
    """A key that a small case takes changes something, or is said to have no effect."""
    assert silent(name, folder) == []


@pytest.mark.full
@pytest.mark.parametrize("name", sorted(set(CASES) - set(QUICK)))
def test_no_key_is_silent_anywhere(folder: Path, name: str) -> None:
    """The same in every other case of the list."""
    assert silent(name, folder) == []


REFUSED: list[tuple[str, Data, str]] = [
    ("drop", {"build.copies": 1}, "build.height_step"),
    ("table", {"build.mass_unit": "g"}, "build.mass_unit"),
    ("walls", {"walls.0.phase": "10 deg"}, "walls.0.phase"),
    (
        "walls",
        {"timeline.0.move.amplitude": None, "timeline.0.move.frequency": None},
        "timeline.0.move.phase",
    ),
    ("feeds", {"feeds.0.normal": [0, 0, 1]}, "feeds.0.normal"),
    (
        "feeds",
        {
            "feeds.0.rate": None,
            "build": {"kind": "fill", "low": ["0 cm", "-2 cm", "5 cm"], "high": ["3 cm", "2 cm", "7 cm"]},
        },
        "feeds.0.begin",
    ),
    ("mixture", {"grains.mixture.grains": 0.2}, "grains.mixture.grains"),
    ("mixture", {"grains.bed_material": "smooth"}, "grains.bed_material"),
    ("box", {"motion.gravity": "0 m/s2", "contact.expected_speed": None}, "timeline.1.slope"),
    ("uniform", {"water.depth": None, "water.above": None}, "water.zero"),
    ("uniform", {"water.drag": "none", "water.shape_area": 0.7}, "water.shape_area"),
    ("box", {"record.events": "none"}, "record.tracked"),
    ("weir", {"planes": [{"name": "lid", "point": ["0 m", "0 m", "0 m"], "normal": [0, 0, 1]}]}, "planes.0"),
]
SAID: list[tuple[str, Data, str]] = [
    ("drop", {"seed": 3}, "seed has no effect"),
    ("stream", {"build.bed": "0 cm"}, "build.begin, build.end"),
    ("packing", {"build.bed": "flat", "build.bed_height": 0.2}, "build.bed_height has no effect"),
    ("flume", {"build.bed": "plane", "build.bed_height": 0.2}, "build.bed_height has no effect"),
    ("weir", {}, "contact.stiffness"),
    ("weir", {"water.row.width": "20 cm"}, "water.row.width"),
    ("mixture", {"build.most": 10_000}, "build.most = 10,000 has no effect"),
    ("table", {"grains.spread": 0.1}, "grains.spread has no effect"),
    ("packing", {"build.gap": 0.0, "build.jitter": 0.5}, "build.jitter has no effect"),
    ("box", {"record.events": "all"}, "record.tracked has no effect"),
    ("drop", {"build.height_step": None, "contact.slip": "spring"}, "contact.slip"),
    ("box", {"contact.restitution": 1.0, "contact.parting": "tension"}, "contact.parting has no effect"),
    (
        "box",
        {"contact.shear_ratio": 0.0, "contact.restitution_shear": 0.5},
        "contact.restitution_shear has no",
    ),
    ("box", {"timeline": [{"at": "0.2 s", "rotation": "free"}]}, "timeline.0.rotation has no effect"),
    ("box", {"timeline": [{"at": "0.5 s", "remove": "gate"}]}, "timeline.0 has no effect"),
    ("feeds", {"timeline": []}, "exits.1.moves_with has no effect"),
    ("feeds", {"feeds.0.end": "1 s"}, "feeds.0.end has no effect"),
    ("heap", {"shapes.full.spheres": 40}, "shapes.full.spheres = 40 has no effect"),
    ("plate", {}, "materials.smooth.friction has no effect"),
]


@pytest.mark.parametrize(("name", "changes", "key"), REFUSED)
def test_a_key_that_would_mislead_is_refused(folder: Path, name: str, changes: Data, key: str) -> None:
    """The message names the key."""
    with pytest.raises(CaseError, match=rf"(?m)^ *{re.escape(key)}\b.*(has no effect|of the rest)"):
        walk.read_data(with_values(data_of(name), changes), folder)


@pytest.mark.parametrize(("name", "changes", "part"), SAID)
def test_what_has_no_effect_is_said(folder: Path, name: str, changes: Data, part: str) -> None:
    """The log and `ryusa check` say it."""
    notes = build(walk.read_data(with_values(data_of(name), changes), folder)).notes
    assert any(part in one for one in notes)


TABLE = """
[grains]
diameter = "2 mm"
density = "2000 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
[build]
kind = "table"
file = "{file}"
{more}
[stop]
time = "0.1 s"
"""
XYZ = "2\nProperties=species:S:1:pos:R:3:radius:R:1:diameter:R:1 energy=3.5\nX 0 0 0 1 2\nX 9 0 0 1 2\n"
ATOMS = """grains

2 atoms
1 atom types
4 bonds
0 9 xlo xhi

Atoms # hybrid sphere charge

1 1 0 0 0 0.002 2000 0.1
2 1 9 0 0 0.002 2000 0.1

Pair Coeffs

1 1.0 2.0
"""
UNUSED: list[tuple[str, str, str, str]] = [  # file, its text, keys of [build], what is said
    ("a.csv", "x [mm],z [mm],d [mm],qw,qx,qy,qz\n0,0,2,1,0,0,0\n9,0,2,1,0,0,0\n", "", "qw, qx, qy, qz"),
    (
        "a.csv",
        "x [mm],z [mm],d [mm],m [g],density [kg/m3]\n0,0,2,1,2000\n9,0,2,1,2000\n",
        "",
        "masses of a.csv",
    ),
    ("a.csv", "x [mm],z [mm],d [mm],vx [m/s],fixed\n0,0,2,1,0\n9,0,2,1,1\n", "", "vx of the fixed grains"),
    (
        "a.csv",
        '# ryusa {"period": [null, null], "planes": [], "water_zero": null, "bed_area": null, "age": 3}\n'
        "x [mm],z [mm],d [mm]\n0,0,2\n9,0,2\n",
        "",
        "'age'",
    ),
    ("a.xyz", XYZ, 'format = "xyz"\nlength_unit = "mm"', "not used: diameter"),
    ("a.xyz", XYZ, 'format = "xyz"\nlength_unit = "mm"', "keys of a.xyz that are not used: energy"),
    ("a.xyz", XYZ, 'format = "xyz"\nlength_unit = "mm"\ntime_unit = "ms"', "build.time_unit has no effect"),
    ("a.xyz", XYZ, 'format = "xyz"\nlength_unit = "mm"\nmass_unit = "g"', "build.mass_unit has no effect"),
    ("a.data", ATOMS, 'format = "lammps-data"', "sections of a.data that are not used: Pair"),
    ("a.data", ATOMS, 'format = "lammps-data"', "columns of a.data that are not used: charge"),
    ("a.data", ATOMS, 'format = "lammps-data"', "'4 bonds'"),
]


@pytest.mark.parametrize(("file", "text", "more", "part"), UNUSED)
def test_what_a_file_holds_and_a_case_does_not_take_is_said(
    tmp_path: Path, file: str, text: str, more: str, part: str
) -> None:
    """Columns, sections and keys of tables of grains."""
    (tmp_path / file).write_text(text, encoding="utf-8")
    case = read_text(TABLE.format(file=file, more=more), path=tmp_path / "case.toml")
    assert any(part in one for one in build(case).notes)


def test_an_array_of_a_vtu_file_that_is_not_used_is_said(tmp_path: Path) -> None:
    """Such as one that ParaView has computed."""
    text = vtu_file(read_csv(_grains(tmp_path), "a.csv")).decode()
    more = '<DataArray type="Float64" Name="curl" format="binary">AAAA</DataArray></PointData>'
    (tmp_path / "a.vtu").write_text(text.replace("</PointData>", more), encoding="utf-8")
    assert read_vtu(tmp_path / "a.vtu", "a.vtu").notes == ("arrays of a.vtu that are not used: curl",)


def _grains(folder: Path) -> Path:
    path = folder / "a.csv"
    path.write_text(NEAR, encoding="utf-8")
    return path


def test_a_curved_surface_of_an_obj_file_is_refused(tmp_path: Path) -> None:
    """It would be missing from the wall."""
    path = tmp_path / "a.obj"
    path.write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ncstype bspline\nsurf 0 1 0 1 1 2 3\n", encoding="utf-8"
    )
    with pytest.raises(ParseError, match="curved surface"):
        read_mesh(path, "a.obj")
