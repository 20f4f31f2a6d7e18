"""Meshes as programs write them and as they arrive: relative indices, polygons, files cut off."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "casefile"))
from test_walls import tetrahedron, write_binary, write_stl

from ryusa.errors import ParseError
from ryusa.formats.mesh import read_mesh

SQUARE = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\n"
HOLLOW = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\n"  # a swallowtail, hollow at its fourth corner


def obj(folder: Path, text: str) -> np.ndarray:
    (folder / "part.obj").write_text(text)
    return read_mesh(folder / "part.obj", "part.obj")


def area(corners: np.ndarray) -> float:
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(across, axis=1).sum() / 2)


@pytest.mark.parametrize(
    "faces",
    [
        "f 1 2 3\n",
        "f -4 -3 -2\n",
        "f 1/1/1 2/1 3 # with and without texture\nvt 0 0\n",
        "mtllib a.mtl\ng a\no b\ns off\nusemtl red\nf 1//1 2//1 3//1\nl 1 2\np 3\n",
        "f 1 2 \\\n3\n",
        "f 1 2 3\r\n",
        "f 1 2 3\\",
    ],
)
def test_a_triangle_is_the_same_however_it_is_written(tmp_path: Path, faces: str) -> None:
    assert obj(tmp_path, SQUARE + faces).tolist() == [[[0, 0, 0], [4, 0, 0], [4, 4, 0]]]


def test_relative_indices_count_back_from_their_line(tmp_path: Path) -> None:
    part = "v 0 0 {0}\nv 1 0 {0}\nv 0 1 {0}\nf -3 -2 -1\n"
    corners = obj(tmp_path, part.format(0) + part.format(9))
    assert corners[:, :, 2].tolist() == [[0, 0, 0], [9, 9, 9]]


def test_a_polygon_is_cut_within_its_outline(tmp_path: Path) -> None:
    assert area(obj(tmp_path, SQUARE + "f 1 2 3 4\n")) == pytest.approx(16.0)
    for turn in range(5):
        words = [str((turn + k) % 5 + 1) for k in range(5)]
        corners = obj(tmp_path, HOLLOW + "f " + " ".join(words) + "\n")
        assert area(corners) == pytest.approx(10.0)
        assert len(corners) == 3


BAD_OBJ = {
    "f 1 2 0\n": "5:1: names vertex 0; vertices count from 1",
    "f 1 2 9\n": "5:1: names vertex 9; the file has 4",
    "f -9 1 2\n": "5:1: names vertex -9; 4 are above this line",
    "f 1 2\n": "5:1: a face needs three corners, found 2",
    "f 1 2 x\n": "5:1: a corner is a number, found 'x'",
    "v 1 1\nf 1 2 3\n": "5:1: a vertex needs three numbers, found '1 1'",
    "v 1 1 nan\nf 1 2 3\n": "vertex 5 is not finite",
    "": "holds no triangle",
}


@pytest.mark.parametrize("faces", BAD_OBJ)
def test_a_bad_line_of_an_obj_file_is_named(tmp_path: Path, faces: str) -> None:
    with pytest.raises(ParseError) as found:
        obj(tmp_path, SQUARE + faces)
    assert BAD_OBJ[faces] in str(found.value)


def test_a_polygon_that_cannot_be_cut_is_named(tmp_path: Path) -> None:
    slot = [(0, 0), (4, 0), (4, 4), (3, 4), (3, 1), (1, 1), (1, 4), (0, 4)]
    text = "".join(f"v {x} {y} 0\n" for x, y in slot)
    with pytest.raises(ParseError, match="9:1: a polygon so hollow"):
        obj(tmp_path, text + "f 1 2 3 4 5 6 7 8\n")


def stl(folder: Path, content: str | bytes) -> np.ndarray:
    path = folder / "part.stl"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_mesh(path, path.name)


def written(folder: Path) -> tuple[str, bytes]:
    """The same tetrahedron as text and as binary."""
    write_stl(folder / "a.stl", tetrahedron())
    write_binary(folder / "b.stl", tetrahedron())
    return (folder / "a.stl").read_text(), (folder / "b.stl").read_bytes()


def test_text_and_binary_are_told_apart_whatever_their_first_word(tmp_path: Path) -> None:
    text, binary = written(tmp_path)
    for content in (text, text.upper(), text.replace("\n", "\r\n"), b"solid part".ljust(80) + binary[80:]):
        assert np.array_equal(stl(tmp_path, content), tetrahedron())
    assert len(stl(tmp_path, text + text.replace("part", "facet vertex"))) == 8


@pytest.mark.parametrize("share", [0.05, 0.3, 0.5, 0.9, 0.97])
def test_an_stl_file_that_is_cut_off_is_refused_wherever_it_ends(tmp_path: Path, share: float) -> None:
    for content in written(tmp_path):
        with pytest.raises(ParseError, match=r"cut off|neither text nor binary"):
            stl(tmp_path, content[: int(share * len(content))])


def test_a_text_file_that_ends_after_a_whole_facet_is_refused(tmp_path: Path) -> None:
    text, _ = written(tmp_path)
    with pytest.raises(ParseError, match=r"holds 4 facets.*ends without 'endsolid'"):
        stl(tmp_path, text.rpartition("endsolid")[0])


def test_what_is_no_stl_file_is_named(tmp_path: Path) -> None:
    text, binary = written(tmp_path)
    for content, said in (
        (b"", "is empty"),
        (b"\n\n", "is empty"),
        ("<html></html>", "neither text nor binary STL"),
        (SQUARE + "f 1 2 3\n", "neither text nor binary STL"),
        (binary[:-3], "would hold 4 triangles in 284 bytes, but has 281"),
        (text.replace("vertex", "vertx"), "holds 4 facets, of which 4 end, and 0 vertices"),
        (text.replace("20", "2,0"), r"a vertex needs three numbers, found '2,0 0 0'|found '0 2,0 0'"),
        (text.replace("vertex 0 0 20", "vertex 0 0 20 1"), "found '0 0 20 1'"),
        (bytes(84), "holds no triangle"),
    ):
        with pytest.raises(ParseError, match=said):
            stl(tmp_path, content)
