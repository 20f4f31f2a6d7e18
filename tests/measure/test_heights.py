"""Heights above datum: every measure counts from z = 0 of the case, whatever bed lies under the grains."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.measure import (
    contact_stress,
    coordination,
    kinetic_stress,
    profiles,
    segregation,
    tracks,
    transport,
)

D = 0.002
Z = 7.3 * D  # height of the centres above datum; the bed crest is at 2.6 D
FORCE = np.dtype([("i", "i4"), ("j", "i4"), ("force", "f8", (3,))])


@pytest.fixture
def run(make):
    """Two grains of different size that move along x at one height over fixed grains."""
    x = np.zeros((40, 2, 3))
    x[:, :, 0] = 0.01 * np.arange(40)[:, None] + [0.0, 5 * D]
    x[:, :, 2] = Z
    scene = make.scene(2)
    scene = replace(scene, x_fixed=scene.x_fixed + np.array([0.0, 0.0, 1.6 * D]), d=np.array([D, 1.001 * D]))
    return SimpleNamespace(
        case={"record": {}}, scene=scene, contacts=np.zeros(0), tally={},
        frames=SimpleNamespace(t=0.1 * np.arange(40), x=x, v=0 * x + [0.1, 0.0, 0.0], omega=0 * x),
        contact_forces=lambda _k: np.zeros(0, FORCE),
    )  # fmt: skip


def middle(z, amount):
    return float((z * amount).sum() / amount.sum())


def test_every_measure_over_height_finds_a_grain_at_its_height_above_datum(run):
    found = profiles(run, layer=0.1)
    moving = kinetic_stress(run, layer=0.1).profiles
    stress = contact_stress(run, layer=0.1)
    carried = transport(run, layer=0.02)
    touching = coordination(run, layer=0.1)
    heights = {
        "profile": middle(found.z, found.phi.value),
        "stress": middle(moving.z, moving.phi.value),
        "contact_stress": middle(stress.z, stress.phi.value),
        "transport": middle(carried.z, carried.flux.value),
        "transport layer": 0.5 * (carried.averages["layer_low"].value + carried.averages["layer_high"].value),
        "coordination": float(touching.z[np.isfinite(touching.over_height.value)][0]),
        "segregation": segregation(run).z[0],
        "tracks": tracks(run).z[0, 0],
    }
    assert heights == pytest.approx(dict.fromkeys(heights, Z), abs=0.06 * D)
    assert stress.crest == pytest.approx(2.6 * D)


def test_layers_of_two_beds_coincide(run):
    whole = profiles(run)
    run.scene = replace(run.scene, x_fixed=run.scene.x_fixed + np.array([0.0, 0.0, 0.3 * D]))
    np.testing.assert_array_equal(profiles(run).z, whole.z)
    assert math.isclose(whole.z[0] / whole.thickness % 1.0, 0.5, abs_tol=1e-9)
