"""Grains leave a row of columns soon after they have passed its end."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.build.case import build
from ryusa.build.feeds import leaving_row, steps_between
from ryusa.casefile import read
from ryusa.cases import case_path


def test_no_grain_goes_farther_than_half_a_diameter_beyond_the_end_of_a_row():
    scene = build(read(case_path("slope_break.toml"))).scene
    traffic, row = scene.traffic, scene.row
    assert traffic is not None and row is not None and traffic.exits
    high = row.column.g_x * row.x - row.g_z * row.bottom  # work of the weight down the row [m2/s2]
    fastest = math.sqrt(2.0 * (float(np.ptp(high)) + row.g_z * row.column.dz * row.column.n))
    way = traffic.interval * scene.dt * fastest
    assert 0.25 * scene.d.min() < way <= 0.5 * scene.d.min() * (1.0 + 1e-12)
    at_rest = steps_between(traffic.feeds, float(scene.d.min()), row.g_z, scene.dt)
    assert traffic.interval < at_rest  # the rule of scenes without a row, by a fall from rest


@pytest.mark.parametrize("key", ["exits", "row"])
def test_scenes_without_an_exit_or_a_row_keep_their_instants(key):
    scene = build(read(case_path("slope_break.toml"))).scene
    long = replace(scene.traffic, interval=10_000)
    lacking = {"exits": {"traffic": replace(long, exits=())}, "row": {"traffic": long, "flow": None}}
    assert leaving_row(replace(scene, **lacking[key])).traffic.interval == 10_000
    assert leaving_row(replace(scene, traffic=long)).traffic.interval == scene.traffic.interval
