"""No key of a case is without effect and unsaid, and no column of a file that it reads.

The walk goes over the schema itself: a key that is added is in it. If `test_every_key_acts_somewhere` names
one, give it to a case of `CASES` in which it acts.
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
HERTZ = {
    "law": "Hertz-Mindlin",
    "youngs_modulus": "50 MPa",
    "restitution": 0.7,
    "friction": 0.5,
    "adhesion": "DMT",
    "work_of_adhesion": "0.05 J/m2",
}
WALL = {"name": "plate", "shape": "rectangle", "at": ["0 cm", "0 cm", "3 cm"]}
SIDES = [["3 cm", "0 cm", "0 cm"], ["0 cm", "3 cm", "0 cm"]]
SMOOTH = {"friction": 0.2, "restitution": 0.6, "density": "2000 kg/m3", "rolling_coefficient": 0.05}
PAIR = {"materials": ["grains", "smooth"], "friction": 0.3, "restitution": 0.5, "rolling_coefficient": 0.02}
MIXED: Data = {
    "materials": {"smooth": SMOOTH},
    "pairs": [PAIR],
    "grains.mixture": {"smooth": 0.3},
    "contact.friction": 0.5,
    "contact.timing": "exact",
    "rolling.model": "constant",
    "rolling.coefficient": 0.1,
    "build.most": 8,
    "planes": [{"name": "under", "point": ["0 cm", "0 cm", "-5 cm"], "normal": [0, 0, 1]}],
}
BLOWN: Data = {
    "water.drag": "constant",
    "water.drag_coefficient": 0.5,
    "water.torque": "Dennis",
    "motion.rotation": "free",
    "motion.slope": "1/20",
}
MOST, ENOUGH = 12, 4  # values tried of a key, and of those that are taken and change nothing
SMALL = ["-1 cm", "-1 cm", "1.4 cm"]  # of the silo, so that few grains are laid
NAMED = ("title", "name")  # what pictures, tables and messages call a thing
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

CASES: dict[str, tuple[str, Data]] = {
    "drop": ("drop", {"build.copies": 2, "build.height_step": "1 mm", "motion.rotation": "free"}),
    "single": ("drop", {}),
    "quiet": (
        "heap",
        {"build.columns": 4, "build.layers": 2, "motion.gravity": "0 m/s2", "contact.expected_speed": None},
    ),
    "flat": ("movable_bed", {"build.columns": 8, "build.layers": 2, "build.bed": "flat"}),
    "plain": ("flume", {"build.plate": "2 cm", "walls": [{**WALL, "sides": SIDES}]}),
    "oblique": ("drop", {"build.offset": "0.5 mm", "contact.slip": "spring", "build.copies": 2}),
    "box": (
        "box",
        {
            "grains.spread": {"kind": "uniform", "ratio": 0.1},
            "build.floor_height": 0.1,
            "build.drop": "3 cm",
            "build.run_out": "1 cm",
            "record.events": "tracked",
            "record.tracked": [1],
            "stop.rest": {"speed": "1 mm/s", "for": "0.1 s"},
            "timeline": [
                {"at": "0.2 s", "remove": "gate"},
                {"at": "0.3 s", "slope": 0.1},
                {"at": "0.35 s", "slope_angle": "3 deg"},
                {"at": "0.4 s", "rotation": "locked"},
                {"at": "0.45 s", "friction": 0.2},
                {"at": "0.46 s", "friction_angle": "9 deg"},
            ],
        },
    ),
    "space": (
        "box",
        {
            "motion.plane": False,
            "build.rows": 4,
            "build.columns": 3,
            "build.layers": 2,
            "build.floor": "plane",
            "build.walls": "planes",
        },
    ),
    "sheet": (
        "movable_bed",
        {
            "motion.plane": False,
            "build.rows": 4,
            "build.columns": 4,
            "build.layers": 2,
            "build.periodic": False,
            "water": None,
        },
    ),
    "springs": ("box", {"contact.stiffness": {"overlap": 0.01, "speed": "0.5 m/s"}, "build.layers": 2}),
    "slow": ("box", {"contact.stiffness": {"collision_time": "0.1 ms"}, "build.layers": 2}),
    "dashpots": (
        "box",
        {
            "contact.damping": "0.001 N s/cm",
            "contact.shear_damping": "0.001 N s/cm",
            "contact.restitution": None,
        },
    ),
    "hertz": (
        "box",
        {"contact": HERTZ, "rolling.model": "spring-dashpot-slider", "rolling.coefficient": 0.1},
    ),
    "sticky": ("box", {"contact.adhesion": "constant", "contact.pull_off_force": "1 mN"}),
    "area": (
        "box",
        {
            "contact": {
                **{k: v for k, v in HERTZ.items() if k != "work_of_adhesion"},
                "adhesion": "contact area",
                "adhesion_density": "10 kPa",
            }
        },
    ),
    "saltation": ("saltation", BLOWN | {"build.start_speed": "0.1 m/s"}),
    "davis": (
        "saltation",
        BLOWN | {"water.rebound": "Davis", "water.asperity": "0.01 mm", "water.rebound_least": 0.1},
    ),
    "stokes": ("saltation", {"water.rebound": "exponential", "water.rebound_least": 0.1}),
    "film": ("saltation", {"water.film": "lubrication", "water.asperity": "0.01 mm"}),
    "uniform": (
        "saltation",
        {
            "water.profile": "uniform",
            "water.speed": "0.3 m/s",
            "water.tau_star": None,
            "water.roughness": None,
        },
    ),
    "packing": ("movable_bed", {"build.columns": 8, "build.layers": 2, "build.speed": "0.1 m/s"}),
    "gradient": (
        "movable_bed",
        {
            "build.columns": 8,
            "build.layers": 2,
            "water.column.drive": "pressure gradient",
            "water.column.pressure_gradient": "50 Pa/m",
            "water.tau_star": None,
            "water.hindrance": "power",
            "water.hindrance_exponent": 3.0,
        },
    ),
    "flume": (
        "bedload_3d",
        {
            "build.length": "9.6 cm",
            "build.layers": 2.0,
            "build.waves": 1,
            "build.wave_height": "1 mm",
            "water.column.side_walls": "2 cm",
            "stop.time": "60 s",
            "stop.precision": {"q": "2 %"},
        },
    ),
    "discharge": (
        "bedload_3d",
        {
            "build.length": "4.8 cm",
            "build.layers": 1.0,
            "water.column.drive": "discharge",
            "water.column.discharge": "0.05 m2/s",
        },
    ),
    "mixture": ("hopper", MIXED | {"build.high": SMALL}),
    "kinds": (
        "hopper",
        {
            "contact": {
                "law": "Hertz-Mindlin",
                "youngs_modulus": "50 MPa",
                "restitution": 0.7,
                "friction": 0.5,
                "adhesion": "constant",
                "pull_off_force": "1 mN",
            },
            "materials": {
                "soft": {"youngs_modulus": "20 MPa", "poisson_ratio": 0.3, "pull_off_force": "2 mN"}
            },
            "pairs": [{"materials": ["grains", "soft"], "pull_off_force": "1 mN"}],
            "grains.mixture": {"soft": 0.3},
            "build.high": SMALL,
        },
    ),
    "coats": (
        "hopper",
        {
            "contact": HERTZ,
            "materials": {"soft": {"work_of_adhesion": "0.1 J/m2"}},
            "pairs": [{"materials": ["grains", "soft"], "work_of_adhesion": "0.02 J/m2"}],
            "grains.mixture": {"soft": 0.3},
            "build.high": SMALL,
        },
    ),
    "areas": (
        "hopper",
        {
            "contact": {
                **{k: v for k, v in HERTZ.items() if k != "work_of_adhesion"},
                "adhesion": "contact area",
                "adhesion_density": "10 kPa",
            },
            "materials": {"soft": {"adhesion_density": "20 kPa"}},
            "pairs": [{"materials": ["grains", "soft"], "adhesion_density": "5 kPa"}],
            "grains.mixture": {"soft": 0.3},
            "build.high": SMALL,
        },
    ),
    "sizes": (
        "hopper",
        {
            "materials": {
                "fine": {"diameter": "3 mm", "spread": {"kind": "uniform", "ratio": 0.1}},
                "curve": {"sieve_curve": [["3 mm", 0.0], ["4 mm", 100.0]]},
            },
            "grains.mixture": {"fine": 0.3, "curve": 0.2},
            "build.high": SMALL,
        },
    ),
    "curve": (
        "hopper",
        {
            "grains.spread": None,
            "grains.sieve_curve": [["2 mm", 0], ["4 mm", 50], ["6 mm", 100]],
            "grains.finest": "3 mm",
            "grains.coarsest": "5 mm",
            "build.high": SMALL,
        },
    ),
    "walls": (
        "hopper",
        {
            "walls": [
                WALL
                | {
                    "sides": SIDES,
                    "servo": {
                        "direction": [0, 0, -1],
                        "force": "1 N",
                        "max_speed": "1 cm/s",
                        "max_travel": "2 cm",
                    },
                },
                WALL
                | {
                    "name": "press",
                    "sides": SIDES,
                    "at": ["0 cm", "0 cm", "5 cm"],
                    "servo": {"direction": [0, 0, -1], "pressure": "1 kPa", "max_speed": "1 cm/s"},
                },
                WALL
                | {
                    "name": "rough",
                    "shape": "ridges",
                    "sides": SIDES,
                    "number": 4,
                    "height": "1 mm",
                    "at": ["0 cm", "0 cm", "7 cm"],
                },
                WALL
                | {
                    "name": "lid",
                    "shape": "disc",
                    "normal": [0, 0, 1],
                    "radius": "2 cm",
                    "amplitude": ["0 cm", "0 cm", "1 mm"],
                    "frequency": "10 Hz",
                    "phase": "10 deg",
                    "at": ["0 cm", "0 cm", "9 cm"],
                },
                WALL
                | {
                    "name": "pipe",
                    "shape": "cylinder",
                    "axis": ["0 cm", "0 cm", "2 cm"],
                    "radius": "2 cm",
                    "angular_velocity": ["0 rpm", "0 rpm", "10 rpm"],
                    "axis_point": ["1 cm", "0 cm", "0 cm"],
                    "velocity": ["0 m/s", "0 m/s", "0.01 m/s"],
                    "at": ["0 cm", "0 cm", "12 cm"],
                },
                {
                    "name": "mesh",
                    "shape": "mesh",
                    "file": "wall.stl",
                    "unit": "mm",
                    "scale": 2.0,
                    "at": ["0 cm", "0 cm", "-3 cm"],
                    "turn_axis": [0, 0, 1],
                    "turn_angle": "10 deg",
                },
            ],
            "timeline": [
                {
                    "at": "0.1 s",
                    "move": {
                        "wall": "pipe",
                        "velocity": ["0 m/s", "0 m/s", "0.02 m/s"],
                        "amplitude": ["0 mm", "0 mm", "1 mm"],
                        "frequency": "10 Hz",
                        "phase": "10 deg",
                        "angular_velocity": ["0 rpm", "0 rpm", "5 rpm"],
                        "axis_point": ["1 cm", "0 cm", "0 cm"],
                    },
                }
            ],
            "build.low": ["0.5 cm", "0.5 cm", "0.5 cm"],
            "build.high": ["1.5 cm", "1.5 cm", "1.5 cm"],
            "exits": [],
            "record.settle": "0 s",
            "stop.time": "0.11 s",
        },
    ),
    "period": (
        "hopper",
        {
            "walls": [],
            "exits": [],
            "timeline": [],
            "build.periodic": True,
            "build.low": ["0 cm", "0 cm", "0 cm"],
            "build.high": ["2 cm", "2 cm", "2 cm"],
        },
    ),
    "heap": (
        "gravel_heap",
        {
            "build.most": 10,
            "grains.shape": {"oval": 0.3, "full": 0.4},
            "build.plate": "2 cm",
            "shapes": {
                "oval": {"elongation": 0.8, "flatness": 0.9, "spheres": 9},
                "full": {"elongation": 0.8, "flatness": 0.9, "filled": 0.95},
            },
            "planes.0.material": None,
        },
    ),
    "body": (
        "gravel_heap",
        {
            "build.most": 10,
            "grains.shape": "stone",
            "build.plate": "2 cm",
            "shapes": {"stone": {"file": "body.stl", "spheres": 8}},
        },
    ),
    "clumps": ("gravel_heap", {"build.most": 10, "build.plate": "2 cm", "water.profile": "still"}),
    "feeds": (
        "flume",
        {
            "feeds.0.begin": "0.1 s",
            "feeds.0.total": "50 grains",
            "exits.0.to": None,
            "timeline": [{"at": "1 s", "move": {"wall": "weir", "velocity": ["0 m/s", "0 m/s", "1 mm/s"]}}],
            "exits": [
                {"name": "outlet", "low": ["29 cm", "-4 cm", "-1 cm"], "high": ["40 cm", "4 cm", "9 cm"]},
                {
                    "name": "end",
                    "point": ["28 cm", "0 cm", "0 cm"],
                    "normal": [1, 0, 0],
                    "to": "feeder",
                    "moves_with": "weir",
                },
            ],
        },
    ),
    "discs": (
        "flume",
        {
            "materials": {"smooth": {"friction_angle": "12 deg"}},
            "pairs": [{"materials": ["grains", "smooth"], "friction": 0.3}],
            "timeline": [{"at": "1 s", "move": {"wall": "weir", "velocity": ["0 m/s", "0 m/s", "1 mm/s"]}}],
            "build.plate": None,
            "feeds": [
                {
                    "name": "disc",
                    "centre": ["2 cm", "0 cm", "4 cm"],
                    "radius": "2 cm",
                    "normal": [0, 0, -1],
                    "rate": "50 grains/s",
                    "end": "1 s",
                    "velocity": ["0 m/s", "0 m/s", "-0.3 m/s"],
                    "moves_with": "weir",
                    "material": "smooth",
                }
            ],
        },
    ),
    "plate": (
        "flume",
        {
            "build.plate": "2 cm",
            "walls": [],
            "grains.bed_material": "smooth",
            "materials": {"smooth": {"friction": 0.2}},
            "pairs": [{"materials": ["grains", "smooth"], "friction": 0.3}],
        },
    ),
    "table": (
        "box",
        {
            "build": {"kind": "table", "file": "grains.csv", "frame": 0},
            "domain.period_x": "2 cm",
            "domain.low": ["-1 m", "-1 m", "-1 m"],
            "grains.bed_material": None,
        },
    ),
    "near": ("box", {"build": {"kind": "table", "file": "near.csv", "allow_overlap": True}}),
    "foreign": (
        "hopper",
        {
            "build": {
                "kind": "table",
                "file": "grains.dump",
                "format": "lammps-dump",
                "length_unit": "mm",
                "time_unit": "ms",
                "mass_unit": "g",
                "fixed_types": [2],
            },
            "walls": [],
            "timeline": [],
            "exits": [],
        },
    ),
    "open": (
        "hopper",
        {
            "build": {"kind": "table", "file": "grains.csv"},
            "domain.period_y": "5 cm",
            "walls": [],
            "timeline": [],
            "exits": [],
        },
    ),
    "weir": (
        "weir",
        {
            "timeline": [{"at": "1 s", "discharge": "0.02 m2/s"}],
            "water.row.height": "40 cm",
            "water.row.dams.0.concentration": 0.6,
            "water.row.dams.0.diameter": "5 mm",
            "water.temperature": "15 degC",
        },
    ),
    "basin": (
        "weir",
        {
            "water.row.upstream": {"end": "level", "level": "22 cm"},
            "water.depth": None,
            "water.row.downstream": {"end": "level", "level": "4 cm"},
            "water.row.dams.0.height": None,
            "water.row.dams.0.crest": "8 cm",
            "water.row.segment": None,
            "water.row.segments": 60,
            "water.row.surface": [["0 m", "22 cm"], ["6 m", "22 cm"]],
        },
    ),
    "whole": (
        "weir",
        {
            "water.row.upstream.discharge": "6 L/s",
            "water.row.width": "20 cm",
            "water.row.upstream.profile": "uniform",
            "water.row.upstream.depth": "4 cm",
        },
    ),
    "flood": (
        "weir",
        {
            "water.row.upstream.discharge": None,
            "water.row.downstream.level": "4 cm",
            "water.row.downstream.end": "level",
            "timeline": [{"at": "9 s", "level": "5 cm"}],
            "water.row.upstream.hydrograph": [["0 s", "0.03 m2/s"], ["20 s", "0.04 m2/s"]],
        },
    ),
    "tide": (
        "weir",
        {"water.row.downstream": {"end": "level", "stage": [["0 s", "4 cm"], ["9 s", "5 cm"]]}},
    ),
    "sediment": (
        "flume",
        {"feeds.0.rate": None, "feeds.0.sedigraph": [["0 s", "0.01 kg/s"], ["1 s", "0.05 kg/s"]]},
    ),
    "inside": ("hopper", {"build": {"kind": "fill", "inside": "silo", "most": 20}}),
    "stream": ("sabo_dam", {"build.begin": "0.6 m", "build.end": "0.75 m"}),
}

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
    (at / "grains.dump").write_text(DUMP, encoding="utf-8")
    return at


def data_of(name: str) -> Data:
    """A case of `CASES` as data."""
    base, changes = CASES[name]
    data: Data = tomllib.loads(PACKAGED[base])
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


def changed(name: str, changes: Data) -> Data:
    """A case of `CASES` with some keys set."""
    data = data_of(name)
    for key, value in changes.items():
        data = walk.with_value(data, tuple(int(k) if k.isdecimal() else k for k in key.split(".")), value)
    return data


@pytest.mark.parametrize(("name", "changes", "key"), REFUSED)
def test_a_key_that_would_mislead_is_refused(folder: Path, name: str, changes: Data, key: str) -> None:
    """The message names the key."""
    with pytest.raises(CaseError, match=rf"(?m)^ *{re.escape(key)}\b.*(has no effect|of the rest)"):
        walk.read_data(changed(name, changes), folder)


@pytest.mark.parametrize(("name", "changes", "part"), SAID)
def test_what_has_no_effect_is_said(folder: Path, name: str, changes: Data, part: str) -> None:
    """The log and `ryusa check` say it."""
    notes = build(walk.read_data(changed(name, changes), folder)).notes
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
