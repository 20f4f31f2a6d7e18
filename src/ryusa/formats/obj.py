"""Triangles of OBJ files: vertices and faces, every fault with its line.

trimesh reads OBJ files too, but takes relative indices from the end of the file and mixes faces with and
without textures; both give other triangles than the file holds.
"""

from pathlib import Path

import numpy as np

from ryusa.errors import ParseError
from ryusa.model.arrays import Floats

_CURVED = {"cstype", "curv", "curv2", "surf"}  # statements of curves and surfaces that are no triangles


def read_obj(path: Path, name: str) -> Floats:
    """Corners of the triangles of an OBJ file, in the unit of the file, shape (n, 3, 3).

    Polygons are cut into triangles that meet in one of their corners. Groups, materials, textures, normals,
    lines and points are left out.

    Parameters
    ----------
    name : of the file as the user wrote it, for errors.

    Raises
    ------
    ParseError : a vertex without three numbers, a face with fewer than three corners or a corner that is not
        there, a polygon that cannot be cut from one of its corners, or a curved surface.
    """
    vertices: list[tuple[float, float, float]] = []
    polygons: list[list[int]] = []
    lines: list[int] = []
    for number, words in _lines(path):
        if words[0] == "v":
            vertices.append(_vertex(words, name, number))
        elif words[0] == "f":
            polygons.append(_polygon(words, len(vertices), name, number))
            lines.append(number)
        elif words[0] in _CURVED:
            text = (
                f"holds a curved surface ('{words[0]}'), which is not read; export it as a mesh of triangles"
            )
            raise ParseError(name, number, 1, text)
    points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    for polygon, number in zip(polygons, lines, strict=True):
        if max(polygon) >= len(points):
            text = f"names vertex {max(polygon) + 1}; the file has {len(points)}"
            raise ParseError(name, number, 1, text)
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise ParseError(name, 1, 1, f"vertex {bad[0] + 1} is not finite")
    cut = [
        three
        for polygon, number in zip(polygons, lines, strict=True)
        for three in ([polygon] if len(polygon) == 3 else _cut(polygon, points, name, number))
    ]
    return points[np.array(cut, dtype=np.int64).reshape(-1, 3)]


def _lines(path: Path) -> list[tuple[int, list[str]]]:
    """Words of each line that has some, with its number; a line that ends in a backslash goes on."""
    found: list[tuple[int, list[str]]] = []
    before: list[str] = []
    for number, line in enumerate(path.read_bytes().decode("utf-8-sig", "replace").splitlines(), 1):
        words = before + line.partition("#")[0].split()
        before = []
        if words and words[-1].endswith("\\"):
            before = [*words[:-1], *filter(None, [words[-1][:-1]])]
        elif words:
            found.append((number, words))
    return [*found, (len(found), before)] if before else found


def _vertex(words: list[str], name: str, number: int) -> tuple[float, float, float]:
    try:
        x, y, z = (float(one) for one in words[1:4])
    except ValueError:
        text = f"a vertex needs three numbers, found '{' '.join(words[1:])[:40]}'"
        raise ParseError(name, number, 1, text) from None
    return x, y, z


def _polygon(words: list[str], n_vertex: int, name: str, number: int) -> list[int]:
    """Numbers of the vertices of a face, from 0; relative ones count back from the line."""
    if len(words) < 4:
        raise ParseError(name, number, 1, f"a face needs three corners, found {len(words) - 1}")
    found: list[int] = []
    for word in words[1:]:
        try:
            index = int(word.partition("/")[0])
        except ValueError:
            raise ParseError(name, number, 1, f"a corner is a number, found '{word[:40]}'") from None
        if index == 0:
            raise ParseError(name, number, 1, "names vertex 0; vertices count from 1")
        if index < -n_vertex:
            raise ParseError(name, number, 1, f"names vertex {index}; {n_vertex} are above this line")
        found.append(index - 1 if index > 0 else n_vertex + index)
    return found


def _cut(polygon: list[int], points: Floats, name: str, number: int) -> list[list[int]]:
    """Triangles of a polygon, all from the first corner from which none of them lies outside of it."""
    at = points[polygon]
    whole = np.cross(at - at[0], np.roll(at, -1, axis=0) - at[0]).sum(axis=0)  # twice the area, normal to it
    for first in range(len(polygon)):
        turned = np.roll(at, -first, axis=0)
        each = np.cross(turned[1:-1] - turned[0], turned[2:] - turned[0]) @ whole
        if (each >= 0.0).all():
            order = polygon[first:] + polygon[:first]
            return [[order[0], order[k], order[k + 1]] for k in range(1, len(order) - 1)]
    text = "a polygon so hollow that it cannot be cut from a corner; export the mesh as triangles"
    raise ParseError(name, number, 1, text)
