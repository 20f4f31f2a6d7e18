"""Files as other programs and spreadsheets of other countries write them: read whole, or said what is not."""

import gzip
from pathlib import Path

import numpy as np
import pytest

from ryusa.build import build
from ryusa.casefile import derive, read
from ryusa.errors import CaseError, ParseError
from ryusa.formats.csv import read_csv
from ryusa.formats.extxyz import xyz_frame
from ryusa.formats.lammps_dump import dump_frame
from ryusa.formats.line import read_line
from ryusa.formats.read import read_grains
from ryusa.formats.sieve import read_sieve_curve
from ryusa.formats.text import ReadOptions
from ryusa.formats.vtu import vtu_file
from ryusa.units import UnitError, quantity

FULL_WIDTH = {ord(one): 0xFEE0 + ord(one) for one in "0123456789[]m."}
BOUNDS = "-5e-05 0.02 xlo xhi\n0.0000000000000000e+00 1e-2 ylo yhi\n0 1.0E-01 zlo zhi\n"
ROW = "1 1 0.004 2650 0.005 0.005 0.03"
CASE = """
[grains]
diameter = "4 mm"
density = "2500 kg/m3"
[contact]
stiffness = "1000 N/m"
restitution = 0.6
friction = 0.5
[motion]
rotation = "free"
plane = false
[build]
kind = "table"
"""
TAIL = '[stop]\ntime = "1 ms"\n[record]\nframes = "1 ms"\n'


def data(rows: str, style: str = "", head: str = "", n: int = 1, bounds: str = BOUNDS) -> str:
    return f"by hand\n\n{n} atoms\n1 atom types\n{bounds}{head}\nAtoms{style}\n\n{rows}\n"


def dump(columns: str, *rows: str, sides: str = "ff ff ff", frames: tuple[int, ...] = ()) -> str:
    def frame(step: int, lines: tuple[str, ...]) -> str:
        head = f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(lines)}\nITEM: BOX BOUNDS {sides}\n"
        return head + "0 0.1\n" * 3 + "\n".join([f"ITEM: ATOMS {columns}", *lines, ""])

    return "".join(frame(k, rows[:n]) for k, n in enumerate(frames or (len(rows),)))


def grains(folder: Path, kind: str, content: str | bytes, **options: object):
    path = folder / "file"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_grains(path, "file", kind, ReadOptions(**options))


def built(folder: Path, name: str, kind: str, content: str, more: str = "", case: str = CASE):
    (folder / name).write_bytes(content.encode())
    (folder / "case.toml").write_text(f'{case}file = "{name}"\nformat = "{kind}"\n{more}{TAIL}')
    found = read(folder / "case.toml")
    return build(found, derive(found))


# ---------------------------------------------------------------------------------------- LAMMPS and LIGGGHTS


@pytest.mark.parametrize(
    ("style", "row"),
    [
        ("", ROW),
        ("", ROW + " 0 -1 0"),
        (" # sphere", ROW),
        (" # granular", ROW),
        (" # bpm/sphere", "1 7 1 0.004 2650 0.005 0.005 0.03"),
        (" # hybrid sphere", "1 1 0.005 0.005 0.03 0.004 2650"),
        (" # hybrid sphere bond", "1 1 0.005 0.005 0.03 0.004 2650 9 0 0 0"),
        (" # hybrid charge sphere", "1 1 0.005 0.005 0.03 -1.6 0.004 2650"),
    ],
)
def test_rows_of_every_style_with_a_diameter_give_the_same_grain(tmp_path, style, row):
    table = grains(tmp_path, "lammps-data", data(row, style, "0 0 0 xy xz yz\n"))
    assert [table.column(one)[0] for one in ("d", "density", "x", "y", "z")] == [
        0.004,
        2650,
        0.005,
        0.005,
        0.03,
    ]


@pytest.mark.parametrize(
    ("style", "row", "said"),
    [
        ("", "1 1 0.01 0.02 0.03 0 0 0", "expected 7 words as of atom_style sphere"),
        ("", "1 1 0.01 0.02 0.03", "or 10 with image flags, found 5"),
        (" # hybrid sphere", "1 1 0.005 0.005 0.03 0.004", "expected 7 words as of atom_style hybrid sphere"),
        (" # atomic", ROW, "expected grains with a diameter"),
        (" # hybrid atomic bond", ROW, "expected grains with a diameter"),
    ],
)
def test_rows_of_another_style_are_refused(tmp_path, style, row, said):
    with pytest.raises(ParseError, match=said):
        grains(tmp_path, "lammps-data", data(row, style))


def test_a_skewed_box_is_refused_and_one_of_no_tilt_is_not(tmp_path):
    with pytest.raises(ParseError, match="not skewed"):
        grains(tmp_path, "lammps-data", data(ROW, head="1e-3 0 0 xy xz yz\n"))


@pytest.mark.parametrize("frames", [(0, 2), (0, 0, 2), (2, 0)])
def test_frames_without_grains_are_passed_over(tmp_path, frames):
    text = dump("id x y z radius", "1 0.01 0.02 0.03 0.002", "2 0.03 0.02 0.03 0.003", frames=frames)
    assert grains(tmp_path, "lammps-dump", text).column("d").tolist() == [0.004, 0.006]
    with pytest.raises(ParseError, match="this frame holds no grain"):
        grains(tmp_path, "lammps-dump", text, frame=frames.index(0))


def test_a_file_of_empty_frames_alone_is_refused(tmp_path):
    with pytest.raises(ParseError, match="expected a frame of grains, found none"):
        grains(tmp_path, "lammps-dump", dump("id x y z radius", frames=(0, 0)))


def test_a_box_that_is_periodic_in_z_is_read_and_said(tmp_path):
    table = grains(tmp_path, "lammps-dump", dump("id x y z d", "1 0 0 0.01 0.002", sides="pp pp pp"))
    assert table.period == (0.1, 0.1)
    assert table.notes == ("file is periodic in z, the scene is open there",)


# ------------------------------------------------------------------------------- sizes and masses of grains


@pytest.mark.parametrize(
    ("column", "value", "d"),
    [
        ("radius", 0.003, 0.006), ("diameter", 0.006, 0.006), ("Radius", 0.003, 0.006),
        ("c_rad", 0.003, 0.006), ("v_d", 0.006, 0.006), ("f_size_radius", 0.003, 0.006),
        ("c_diam[1]", 0.006, 0.006),
    ],
)  # fmt: skip
def test_a_size_under_any_of_its_names_is_used(tmp_path, column, value, d):
    table = grains(tmp_path, "lammps-dump", dump(f"id x y z {column}", f"1 0.01 0.02 0.03 {value}"))
    assert table.column("d").tolist() == [d]
    if column.isalpha():
        xyz = f'1\nProperties=species:S:1:pos:R:3:{column}:R:1 pbc="F F F"\nSand 0.01 0.02 0.03 {value}\n'
        assert grains(tmp_path, "xyz", xyz).column("d").tolist() == [d]


def test_columns_that_are_not_used_are_named(tmp_path):
    table = grains(tmp_path, "lammps-dump", dump("id x y z fx c_size", "1 0.01 0.02 0.03 1.0 0.5"))
    assert table.notes == ("columns of file that are not used: fx, c_size",)
    xyz = (
        '1\nProperties=species:S:1:pos:R:3:force:R:3 Lattice="1 0 0 0 1 0 0 0 1"\nSand 0.01 0.02 0.03 1 2 3\n'
    )
    assert grains(tmp_path, "xyz", xyz).notes == (
        "columns of file that are not used: force",
        "file has a Lattice but no pbc: its sides are taken as open",
    )


def test_a_case_says_that_a_file_states_no_sizes(tmp_path):
    made = built(tmp_path, "g.dump", "lammps-dump", dump("id x y z", "1 0.01 0.02 0.03"))
    assert made.scene.d.tolist() == [0.004]
    assert any("g.dump states no sizes" in note and "d = 4 mm" in note for note in made.notes)


@pytest.mark.parametrize(
    ("kind", "content"),
    [
        ("lammps-data", data("1 1 0.002 7800 0 0 0.003\n2 1 0.004 1200 0.01 0 0.003", n=2)),
        ("lammps-dump", dump("id x y z d density", "1 0 0 0.003 0.002 7800", "2 0.01 0 0.003 0.004 1200")),
        ("csv", "x [mm],y [mm],z [mm],d [mm],density [g/cm3]\n0,0,3,2,7.8\n10,0,3,4,1.2\n"),
        ("csv", "x [mm],y [mm],z [mm],d [mm],m [mg]\n0,0,3,2,32.6725635973\n10,0,3,4,40.2123859659\n"),
        (
            "xyz",
            "2\nProperties=species:S:1:pos:R:3:radius:R:1:Density:R:1\n"
            "A 0 0 .003 .001 7800\nA .01 0 .003 .002 1200\n",
        ),
    ],
)  # fmt: skip
def test_densities_and_masses_of_a_file_are_those_of_its_grains(tmp_path, kind, content):
    made = built(tmp_path, "g", kind, content)
    volume = np.pi / 6.0 * np.array([0.002, 0.004]) ** 3
    assert made.scene.m == pytest.approx(np.array([7800.0, 1200.0]) * volume, rel=1e-9)
    assert any("densities of g, 1200 to 7800 kg/m3, in place of grains.density" in one for one in made.notes)
    alike = read(tmp_path / "case.toml", {"grains.density": "1200 kg/m3"})
    # the lightest grain sets the step
    assert derive(alike).dt == pytest.approx(derive(read(tmp_path / "case.toml")).dt, rel=0.2)


def test_masses_of_an_export_in_any_format_are_read(tmp_path):
    table = grains(tmp_path, "csv", "x [mm],y [mm],z [mm],d [mm],m [mg]\n0,0,3,2,30\n10,0,3,4,40\n")
    for kind, content in (
        ("vtu", vtu_file(table)),
        ("lammps-dump", dump_frame(table)),
        ("xyz", xyz_frame(table)),
    ):
        assert grains(tmp_path, kind, content).column("m").tolist() == table.column("m").tolist()


def test_masses_in_a_unit_that_is_not_known_are_not_used(tmp_path):
    text = data("1 1 0.2 7.8 0 0 0.3", bounds="-1 1 xlo xhi\n-1 1 ylo yhi\n-1 1 zlo zhi\n")
    made = built(tmp_path, "g", "lammps-data", text, 'length_unit = "cm"\n')
    assert made.scene.m[0] == pytest.approx(2500.0 * np.pi / 6.0 * 0.002**3)
    assert any("masses of g are not used" in note for note in made.notes)
    made = built(tmp_path, "g", "lammps-data", text, 'length_unit = "cm"\nmass_unit = "g"\n')
    assert made.scene.m[0] == pytest.approx(7800.0 * np.pi / 6.0 * 0.002**3)
    with pytest.raises(CaseError, match=r"is build\.mass_unit right"):
        built(tmp_path, "g", "lammps-data", text, 'length_unit = "cm"\nmass_unit = "kg"\n')


# ----------------------------------------------------------------------------------------------- spreadsheets

TABLE = "x [mm];y [mm];z [mm];d [mm];vz [m/s]\n0;0;3;2;-0,3\n5;0;3;2,5;-0,3\n"


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(TABLE.encode(), id="semicolons"),
        pytest.param(TABLE.replace(";", "\t").encode(), id="tabs"),
        pytest.param(TABLE.replace("\n", ";\n").encode(), id="empty last column"),
        pytest.param(TABLE.replace("\n", ";;\r\n").encode(), id="two of them, lines of Windows"),
        pytest.param(TABLE.replace(",", ".").replace(";", ",").encode(), id="commas"),
        pytest.param(b"\xef\xbb\xbf" + TABLE.encode(), id="byte-order mark"),
        pytest.param(TABLE.replace(";", "\t").encode("utf-16"), id="UTF-16"),
        pytest.param(gzip.compress(TABLE.encode(), mtime=0), id="gzip"),
        pytest.param(("# 礫の座標\n" + TABLE).encode("cp932"), id="Shift-JIS"),
        pytest.param(("# Größe in mm, µ = 0,5\n" + TABLE).encode("cp1252"), id="Windows-1252"),
        pytest.param(TABLE.translate(FULL_WIDTH).encode(), id="full width"),
        pytest.param(TABLE.replace("-0,3", '"-0,3"').replace("2,5", '"2,5"').encode(), id="quoted"),
        pytest.param(
            TABLE.replace("-0,3", '"-0,3"').replace("2,5", '"2,5"').replace(";", ",").encode(),
            id="quoted decimal commas between commas",
        ),
    ],
)
def test_a_table_is_read_as_every_country_writes_it(tmp_path, content):
    path = tmp_path / "g.csv"
    path.write_bytes(content)
    table = read_csv(path, "g.csv")
    assert table.column("d") == pytest.approx([0.002, 0.0025])
    assert table.column("vz").tolist() == [-0.3, -0.3]
    assert [note for note in table.notes if "is read as" in note] == [
        f"g.csv is read as {words}"
        for begin, words in ((b"# \xe2I", "Shift-JIS"), (b"# Gr\xf6", "Windows-1252, Western Europe"))
        if content.startswith(begin)
    ]


def test_a_comma_of_two_meanings_is_refused(tmp_path):
    path = tmp_path / "g.csv"
    path.write_text("x [mm]\ty [mm]\tz [mm]\td [mm]\n0\t0\t1,234\t2\n")
    with pytest.raises(ParseError, match="found '1,234'"):
        read_csv(path, "g.csv")


def test_sieve_curves_and_lines_come_from_spreadsheets_too(tmp_path):
    path = tmp_path / "curve.csv"
    path.write_text("diameter [mm];finer [%];\n0,5;0;\n2,5;45,5;\n10;100;\n")
    assert read_sieve_curve(path, "curve.csv") == ((0.0005, 0.0), (0.0025, 45.5), (0.01, 100.0))
    path.write_text("diameter [mm],finer [%]\n0.5,0 %\n2.5,45.5%\n10,100%\n")
    assert read_sieve_curve(path, "curve.csv") == ((0.0005, 0.0), (0.0025, 45.5), (0.01, 100.0))
    path.write_text("x [m]\tz [cm]\n0\t2,5\n1,5\t0\n")
    assert read_line(path, "line.csv") == ((0.0, 0.025), (1.5, 0.0))


def test_a_file_that_is_cut_off_within_its_packing_is_named(tmp_path):
    path = tmp_path / "g.csv"
    path.write_bytes(gzip.compress(TABLE.encode())[:-12])
    with pytest.raises(ParseError, match="cannot be read"):
        read_csv(path, "g.csv")


# ------------------------------------------------------------------------------------------------ case files


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_case_file_is_read_with_the_marks_of_windows(tmp_path, encoding):
    (tmp_path / "g.csv").write_bytes(TABLE.encode(encoding))
    text = f'title = "礫"\n{CASE}file = "g.csv"\n{TAIL}'
    (tmp_path / "case.toml").write_bytes(text.encode(encoding))
    assert read(tmp_path / "case.toml").title == "礫"


def test_quantities_in_full_width_and_with_decimal_commas():
    assert quantity("2.5 mm".translate(FULL_WIDTH), "m") == 0.0025
    assert quantity("\u22125 deg", "rad") < 0.0
    with pytest.raises(UnitError, match=r"write '2\.65 g/cm3'"):
        quantity("2,65 g/cm3", "kg/m3")
