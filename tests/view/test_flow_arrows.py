"""Arrows of the water of a row on a page: speeds as bytes come back, and none where there is no water."""

import zlib

import numpy as np
import pytest
from tests.measure.made_rows import CELLS, DX, DZ, row_of

from ryusa.measure.flow_field import speeds_in_cells
from ryusa.results.water import WaterFrames
from ryusa.view.encode import Blob
from ryusa.view.flow_arrows import ALONG, NONE, OVER, STEPS, ZERO, add_arrows


def test_arrows_are_the_speeds_of_some_cells_within_a_step_and_none_outside_the_water():
    n, t = 90, np.arange(3.0)
    row = row_of(n)
    shapes = row.frame_shapes()
    frames = {name: np.zeros((len(t), *shape)) for name, shape in shapes.items()}
    wet = np.arange(CELLS) < 30 + 10 * t[:, None, None]
    frames["content"][:] = np.where(wet, DZ, 0.0)
    x, z = np.arange(n) * DX, (np.arange(CELLS) + 0.5) * DZ
    frames["u"][:] = (1.0 + t[:, None, None]) * np.sin(x)[:, None] * z / z[-1]
    frames["w"][:] = -0.5 * np.cos(x)[:, None] * z / z[-1]
    found = WaterFrames(row, t, **frames)
    blob = Blob()
    about = add_arrows(blob, found, np.array([0, 2]))
    at, kept = np.array(about["at"]), blob.contents["arrows"]
    packed = blob.bytes()[kept["from"] : kept["from"] + kept["bytes"]]
    arrows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(kept["shape"])
    assert kept["type"] == "uint8" and arrows.shape == (2, len(at), 2)
    assert len(np.unique(at[:, 0])) <= ALONG and len(np.unique(at[:, 1])) <= OVER
    assert about["length"] == pytest.approx(3.0 * DX)
    i = np.rint((at[:, 0] - row.x[0]) / DX).astype(int)
    k = np.rint(at[:, 1] / DZ - 0.5).astype(int)
    for m, frame in enumerate((0, 2)):
        u, w = speeds_in_cells(found, frame)
        for axis, speed in enumerate((u[i, k], w[i, k])):
            dry = ~np.isfinite(speed)
            assert (arrows[m, dry] == NONE).all() and dry.any() == (m == 0)
            told = (arrows[m, ~dry, axis].astype(float) - ZERO) / STEPS * about["fastest"]
            assert told == pytest.approx(speed[~dry], abs=0.51 / STEPS * about["fastest"])


def test_water_at_rest_has_no_arrows():
    row = row_of(8)
    frames = {name: np.zeros((1, *shape)) for name, shape in row.frame_shapes().items()}
    frames["content"][:, :, :10] = DZ
    blob = Blob()
    about = add_arrows(blob, WaterFrames(row, np.zeros(1), **frames), np.array([0]))
    assert about["at"] == [] and blob.contents["arrows"]["shape"] == [1, 0, 2]
