"""Files that are not what they should be: an error with line and column, and never a traceback."""

import base64
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ryusa.errors import ParseError
from ryusa.formats.grains import GrainTable
from ryusa.formats.read import read_grains
from ryusa.formats.text import ReadOptions

DUMP = """ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp ff ff
0 1
0 1
0 1
ITEM: ATOMS id type x y z diameter
2 1 0.1 0.1 0.1 0.01
1 2 0.2 0.1 0.1 0.01
"""
DATA = """LAMMPS data file

2 atoms
1 atom types

0 1 xlo xhi
0 1 ylo yhi
0 1 zlo zhi

Atoms # sphere

1 1 0.01 2650 0.1 0.1 0.1 0 0 0
2 1 0.01 2650 0.2 0.1 0.1 0 0 0

Velocities

2 0 0 1 0 0 0
1 1 0 0 0 0 0
"""
XYZ = """2
Lattice="1 0 0 0 1 0 0 0 1" Properties=species:S:1:pos:R:3:radius:R:1:fixed:I:1 pbc="T F F"
X 0.1 0.1 0.1 0.005 0
X 0.2 0.1 0.1 0.005 1
"""
CSV = """# ryusa {"period": [1.0, null], "planes": [], "water_zero": null, "bed_area": null}
t [s],id,fixed,group,x [m],y [m],z [m],d [m]
0,0,0,,0.1,0.1,0.1,0.01
0,1,1,"a, b",0.2,0.1,0.1,0.01
"""
TEXTS = {"lammps-dump": DUMP, "lammps-data": DATA, "xyz": XYZ, "csv": CSV}
Exported = Callable[[str], Path]


def found(folder: Path, kind: str, content: str | bytes, options: ReadOptions | None = None) -> GrainTable:
    path = folder / "strange"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_grains(path, "strange", kind, options or ReadOptions())


@pytest.mark.parametrize("kind", list(TEXTS))
def test_each_of_these_files_is_sound(tmp_path: Path, kind: str) -> None:
    table = found(tmp_path, kind, TEXTS[kind])
    assert table.n == 2
    assert sorted(table.column("x").tolist()) == [0.1, 0.2]
    assert table.column("d").tolist() == [0.01, 0.01]
    assert table.period == (None if kind == "lammps-data" else (1.0, float("inf")))


@pytest.mark.parametrize(
    ("kind", "old", "new", "where", "part"),
    [
        ("lammps-dump", "0.2 0.1", "0.2 zero", "11:9", "expected column 'y', a finite number, found 'zero'"),
        ("lammps-dump", "0.2 0.1", "nan 0.1", "11:5", "expected column 'x', a finite number, found 'nan'"),
        ("lammps-dump", "0.2 0.1", "1_0 0.1", "11:5", "a finite number, found '1_0'"),
        ("lammps-dump", "0.1 0.01\n1", "0.1 -0.01\n1", "10:17", "expected a diameter from 1e-07 to 1000 m"),
        ("lammps-dump", "ATOMS\n2", "ATOMS\n3", "12:1", "the file ends after 2 of 3 grains"),
        ("lammps-dump", "ATOMS\n2", "ATOMS\n1", "11:1", "expected 'ITEM: ...' as LAMMPS writes it"),
        ("lammps-dump", "ATOMS\n2", "ATOMS\n-2", "4:1", "a whole number of at least 0, found '-2'"),
        ("lammps-dump", "ATOMS\n2", "ATOMS\n" + "9" * 18, "12:1", "the file ends after 2 of"),
        ("lammps-dump", "pp ff ff", "xy xz yz pp ff ff", "5:18", "a box that is not skewed"),
        ("lammps-dump", "type x y", "type a y", "9:13", "expected a column 'x' (or xu, xs)"),
        ("lammps-dump", "1 2 0.2", "2 2 0.2", "11:1", "the id 2 appears twice"),
        ("lammps-dump", "1 2 0.2", "1.5 2 0.2", "11:1", "expected an id, a whole number, found '1.5'"),
        ("lammps-dump", "0.2", "1e300", "11:5", "expected column 'x' from -1e+12 to 1e+12 m"),
        ("lammps-data", "0.2 0.1", "0.2 -", "13:19", "expected 'y' of atom_style sphere"),
        (
            "lammps-data",
            "# sphere",
            "# full",
            "10:9",
            "expected grains with a diameter",
        ),
        ("lammps-data", "2 atoms", "2 bonds", "10:1", "the number of atoms before the first section"),
        (
            "lammps-data",
            "Velocities",
            "Bonds",
            "15:1",
            "expected Atoms or Velocities, found the section 'Bonds'",
        ),
        ("lammps-data", "2 0 0 1", "3 0 0 1", "17:1", "no atom has the id 3"),
        ("lammps-data", "2 0 0 1", "1 0 0 1", "18:1", "the id 1 appears twice"),
        ("xyz", "0.2 0.1", "0.2 ?", "4:7", "expected 'y', a finite number, found '?'"),
        ("xyz", " 1\n", "\n", "4:20", "expected 6 words, found 5"),
        ("xyz", "0 1 0 0", "0 1 0 2", "2:1", "a box that is not skewed"),
        ("xyz", "pos:R:3", "pos:R:2", "2:29", "expected 3 columns of 'pos', found 2"),
        ("xyz", "T F F", "T F", "2:81", "expected three of T and F"),
        ("xyz", "2\n", "two\n", "1:1", "expected the number of grains"),
        ("csv", '"a, b",0.2', '"a, b",far', "4:14", "expected column 'x', a finite number, found 'far'"),
        ("csv", "1.0, null", "-1.0, null", "1:9", "expected the JSON that ryusa export writes"),
        ("csv", "[m],d [m]", "[m],d", "2:40", "column 'd' needs its unit"),
    ],
)
def test_a_strange_file_is_refused_by_line_and_column(
    tmp_path: Path, kind: str, old: str, new: str, where: str, part: str
) -> None:
    assert old in TEXTS[kind]
    with pytest.raises(ParseError) as caught:
        found(tmp_path, kind, TEXTS[kind].replace(old, new, 1))
    assert str(caught.value).startswith(f"strange:{where}: ")
    assert part in str(caught.value)


def test_types_that_the_file_has_not_are_refused(tmp_path: Path) -> None:
    assert found(tmp_path, "lammps-dump", DUMP, ReadOptions(fixed_types=(2,))).fixed.tolist() == [True, False]
    with pytest.raises(ParseError, match="expected grains of type 3; there are 1, 2"):
        found(tmp_path, "lammps-dump", DUMP, ReadOptions(fixed_types=(3,)))
    with pytest.raises(ParseError, match="at least one free grain"):
        found(tmp_path, "lammps-dump", DUMP, ReadOptions(fixed_types=(1, 2)))


def test_a_line_without_end_and_a_file_that_is_no_text_are_refused(tmp_path: Path) -> None:
    for kind in TEXTS:
        with pytest.raises(ParseError, match="longer than 65536 characters"):
            found(tmp_path, kind, "1" * 100_000)
        with pytest.raises(ParseError, match="strange:1:1: expected text in UTF-8, in UTF-16 with its mark"):
            found(tmp_path, kind, b"\x81\x00\x8d")


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        (b"<?xml", b'<!DOCTYPE a [<!ENTITY b "c">]><?xml', ":1:13: expected no DOCTYPE"),
        (b'NumberOfPoints="4"', b'NumberOfPoints="5"', "'Points': expected 15 numbers, found 12"),
        (
            b'header_type="UInt64"',
            b'header_type="UInt32"',
            ":3:1: expected header_type='UInt64', found 'UInt32'",
        ),
        (b'Name="diameter"', b'Name="radius"', "expected an array 'diameter'"),
        (b"</Points>", b"</Point>", "mismatched tag"),
        (b'Name="spin" NumberOfComponents="3" format="binary">', b'Name="spin" format="binary">?', "'spin'"),
    ],
)
def test_a_strange_vtu_is_refused(
    exported: Exported, tmp_path: Path, old: bytes, new: bytes, part: str
) -> None:
    sound = next(exported("vtu").with_suffix("").iterdir()).read_bytes()
    assert found(tmp_path, "vtu", sound).n == 4
    assert old in sound
    with pytest.raises(ParseError) as caught:
        found(tmp_path, "vtu", sound.replace(old, new, 1))
    assert part in str(caught.value)


def test_a_diameter_that_is_not_a_number_is_refused_in_a_vtu(exported: Exported, tmp_path: Path) -> None:
    sound = next(exported("vtu").with_suffix("").iterdir()).read_bytes()
    d = np.array([0.004, 0.002, 0.003, 0.004])
    old, new = (
        base64.b64encode(np.array([32], "<u8").tobytes() + values.tobytes()) for values in (d, d * np.nan)
    )
    assert old in sound
    with pytest.raises(ParseError, match="'diameter': expected numbers from 1e-07 to 1000, found nan"):
        found(tmp_path, "vtu", sound.replace(old, new))


def test_a_file_above_the_limit_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "large"
    with path.open("wb") as file:
        file.truncate((1 << 30) + 1)
    with pytest.raises(ParseError, match="larger than 1 GiB"):
        read_grains(path, "large", "csv", ReadOptions())


PIECES = st.sampled_from(
    ["", " ", "\n", "-", "nan", "inf", "1e999", "9" * 30, "1_0", "\x00", '"', "'", ",", ":", "[",
     "\u0661", "#", "ITEM: ATOMS id x", "ITEM:", "Atoms", "Properties=", "pbc=T", "=", "<", "&#0;", "]]>",
     "T", "0", "1e-320"]
)  # fmt: skip


@settings(max_examples=300, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
@pytest.mark.parametrize("kind", [*TEXTS, "vtu"])
def test_a_mangled_file_is_read_or_refused_by_line_and_column(
    exported: Exported, tmp_path: Path, kind: str, data: st.DataObject
) -> None:
    text = TEXTS.get(kind) or next(exported("vtu").with_suffix("").iterdir()).read_text()
    for _ in range(data.draw(st.integers(1, 3))):
        begin = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(begin, min(begin + 20, len(text))))
        piece = data.draw(PIECES | st.text(max_size=4).filter(lambda one: one.isascii() or one.isprintable()))
        text = text[:begin] + piece + text[end:]
    if data.draw(st.booleans()):
        text = text[: data.draw(st.integers(0, len(text)))]
    frame = data.draw(st.none() | st.integers(0, 2))
    try:
        table = found(tmp_path, kind, text.encode("utf-8", "replace"), ReadOptions(frame=frame))
    except ParseError as error:
        assert error.line >= 1
        assert error.column >= 1
        assert "\n" not in str(error)
    else:
        assert np.isfinite(table.vectors("x", "y", "z")).all()
        assert not table.fixed.all()
