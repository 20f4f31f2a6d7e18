"""Grains in a row of columns with ends: a bed along its bottom, and bottom and dams as walls for them."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ryusa.build.nested_lattice import LatticeCells, nested_lattice
from ryusa.build.placement import Placement, Wall, at_rest
from ryusa.build.sizes import draw, draw_laid
from ryusa.build.table import first_grains
from ryusa.build.walls import SolidWall, triangles
from ryusa.casefile.builders.schema import StreamSection
from ryusa.casefile.builders.table import bed_of_run
from ryusa.casefile.builders.values import stream_cells, stream_count, stream_thickness
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.grains.values import graded
from ryusa.casefile.row.ends import width_of
from ryusa.casefile.row.values import bottom_points, crest_of, dam_span, row_plan, stream
from ryusa.casefile.shape import extent
from ryusa.model.scene import Floats

FLOOR, SCREEN, END = "bottom", "upstream", "downstream"  # names of floor and ends


def stream_bed(case: Case, derived: Derived) -> Placement:
    """A lattice that follows the bottom of the row, column by column of its cells.

    Planes `upstream`, which only holds grains, `downstream` where that end is a wall, and the side walls.
    """
    keys, width = case.build, width_of(case)
    assert isinstance(keys, StreamSection)
    assert width is not None
    points, ends = bottom_points(case), _ends(case, keys, width)
    period = (math.inf, math.inf if keys.walls else width)
    if (bed := bed_of_run(case.build)) is not None:
        return replace(first_grains(case, bed.run, True), walls=ends, period=period)
    rng = np.random.default_rng(case.seed)
    n = stream_count(case)
    sized = draw_laid(case, n, rng) if graded(case) else draw(case, n, rng)
    x = at_rest(n)
    if n:
        begin, pitch, columns, rows = stream_cells(case)
        thick = None if isinstance(keys.bed, float | int) else stream_thickness(case)
        cells = LatticeCells((*pitch, derived.room * (1.0 + keys.gap)), len(columns), rows, thick)
        x = nested_lattice(sized * extent(case), cells, keys.gap, keys.jitter, False, rng)
        at = np.minimum((x[:, 0] / pitch[0]).astype(np.int64), len(columns) - 1)
        x[:, 0] += begin + (columns[at] - at) * pitch[0]
        low = np.asarray(begin + columns * pitch[0], dtype=np.float64)
        x[:, 2] += _highest(points, low, pitch[0])[at]
    return Placement(d=sized, x=x, v=at_rest(n), omega=at_rest(n), walls=ends, period=period)


def _ends(case: Case, keys: StreamSection, width: float) -> tuple[Wall, ...]:
    """Planes at the ends of the stream and at its sides."""
    row, points = case.row, bottom_points(case)
    assert row is not None
    ends = [Wall(SCREEN, (points[0][0], 0.0, 0.0), (1.0, 0.0, 0.0))]
    if row.downstream is not None and row.downstream.end == "wall":
        ends.append(Wall(END, (points[-1][0], 0.0, 0.0), (-1.0, 0.0, 0.0)))
    if keys.walls:
        ends.append(Wall("right", (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
        ends.append(Wall("left", (0.0, width, 0.0), (0.0, -1.0, 0.0)))
    return tuple(ends)


def _highest(points: tuple[tuple[float, float], ...], low: Floats, pitch: float) -> Floats:
    """Highest point of a line between low and low + pitch [m], shape as low."""
    x, z = np.array(points).T
    found = np.maximum(np.interp(low, x, z), np.interp(low + pitch, x, z))
    for at, height in points:
        found = np.where((low < at) & (at < low + pitch), np.maximum(found, height), found)
    return found


def stream_walls(case: Case) -> tuple[SolidWall, ...]:
    """Bottom and dams of a row as walls for its grains; none where no grains enter and leave it.

    A dam stands from border to border of its segments, as it does for the water.
    """
    row = case.row
    if not stream(case) or row is None or (width := width_of(case)) is None:
        return ()
    points, plan = bottom_points(case), row_plan(case)
    found = [_across(FLOOR, points, width)]
    x, z = np.array(points).T
    for dam in row.dams:
        first, last = (plan.x_low + i * plan.dx for i in dam_span(plan, dam))
        crest, floor = crest_of(plan, dam), np.interp([first, last], x, z)
        line = ((first, floor[0]), (first, crest), (last, crest), (last, floor[1]))
        found.append(_across(dam.name, line, width))
    return tuple(found)


def _across(name: str, line: tuple[tuple[float, float], ...], width: float) -> SolidWall:
    """Rectangles from y = 0 to a width [m] over the pieces of a line of x and z."""
    corners: list[list[tuple[float, float, float]]] = []
    for (a, low), (b, high) in pairwise(line):
        p, q, r, s = (a, 0.0, low), (b, 0.0, high), (b, width, high), (a, width, low)
        corners += [[p, q, r], [p, r, s]]
    return triangles(name, corners)
