"""The stress of water at its bed, known in closed form."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.measure import classical, transport, water
from ryusa.model import EVENT
from ryusa.model.scene import Water

D, RHO, TAU, BED = 0.002, 2650.0, 8.0, 0.01
CELLS, DZ, SURFACE = 150, 2.0e-4, 0.0271


def run_of(make, phi_bed=0.6, kind="moving", n_frame=6):
    """Water over a bed of that concentration up to 1 cm; clear water carries TAU there, below it fades."""
    scene = make.scene(3)
    scene = replace(
        scene, d=np.full(3, D), m=np.full(3, RHO * math.pi / 6 * D**3), gravity=np.array([0.4, 0.0, -9.8]),
        period=(20 * D, 5 * D), plane_case=False, water=Water(),
    )  # fmt: skip
    faces = np.arange(CELLS + 1) * DZ
    z = 0.5 * (faces[1:] + faces[:-1])
    phi = np.where(z < BED, phi_bed, 0.0)
    tau = TAU * np.clip((SURFACE - faces) / (SURFACE - BED), 0.0, None)
    if phi_bed:
        tau[faces < BED + 0.4 * D] = 0.0  # the grains take it
    u = np.where(z > BED, 0.5, 0.0)
    every = np.ones((n_frame, 1))
    x = np.zeros((n_frame, 3, 3))
    x[:, :, 0], x[:, :, 2] = [0.01, 0.02, 0.03], 0.5 * BED
    t = np.arange(n_frame) * 0.1
    wet = np.clip(SURFACE - faces[:-1], 0.0, DZ) * (1.0 - phi)
    return SimpleNamespace(
        case={
            "record": {},
            "contact": {"restitution": 0.7},
            "water": {"profile": "column", "column": {"bed": kind, "packed": 0.6}},
        },
        frames=SimpleNamespace(t=t, x=x, v=0.0 * x, omega=0.0 * x),
        contacts=np.zeros(0, EVENT), scene=scene, tally={},
        water=SimpleNamespace(
            t=t, z=z, faces=faces, u=u * every, w=0.0 * u * every, phi=phi * every, content=wet * every,
            tau=tau * every, nu_t=0.0 * tau * every, z_surface=np.full(n_frame, SURFACE),
            gradient=np.zeros(n_frame),
        ),
    )  # fmt: skip


def test_the_stress_of_clear_water_is_extrapolated_to_the_bed(make):
    found = water(run_of(make))
    assert found.bed == pytest.approx(BED, abs=0.2 * DZ)
    assert found.averages["depth"].value == pytest.approx(SURFACE - BED, abs=DZ)
    assert found.tau_bed == pytest.approx(TAU, rel=5e-3)
    star = found.tau_bed / (1650.0 * math.hypot(0.4, 9.8) * D)
    assert found.averages["tau_star"].value == pytest.approx(star)
    assert found.averages["u_star"].value == pytest.approx(math.sqrt(found.tau_bed / 1000.0))
    assert found.averages["speed"].value == pytest.approx(0.5, rel=1e-2)
    assert "too few samples to suggest a begin for discharge" in found.averages.notes[-1]
    assert found.faces[found.clear].min() > BED  # no face among the grains
    row = found.rows()[-20]
    assert row["in_water"] and row["phi"] == 0.0


def test_over_a_rigid_bed_the_stress_is_that_at_its_bottom(make):
    found = water(run_of(make, phi_bed=0.0, kind="rough"))
    assert found.bed == 0.0
    assert found.tau_bed == pytest.approx(TAU * SURFACE / (SURFACE - BED), rel=1e-9)


def test_without_a_bed_there_is_no_stress_at_it(make):
    found = water(run_of(make, phi_bed=0.1))
    assert math.isnan(found.bed)
    assert math.isnan(found.tau_bed)


def test_transport_is_set_against_the_stress_of_the_runs_own_water(make):
    run = run_of(make)
    found = transport(run)
    assert found.tau_star == water(run).averages["tau_star"].value
    assert found.averages["tau_star"].value == found.tau_star
    assert found.bed == pytest.approx(BED, abs=DZ)
    assert transport(run, tau_star=0.2).tau_star == 0.2
    lines = {one.label: one for one in classical(run, found)}
    assert set(lines) == {
        "Meyer-Peter & Müller 1948", "Wong & Parker 2006", "Ashida & Michiue 1972", "Egashira et al. 1997",
    }  # fmt: skip
    mueller = lines["Meyer-Peter & Müller 1948"]
    assert np.interp(0.297, mueller.tau_star, mueller.q_star) == pytest.approx(1.0, rel=1e-3)


def test_a_run_without_a_column_says_so(make):
    run = run_of(make)
    run.water = None
    with pytest.raises(ResultsError, match="no column of water"):
        water(run)
    assert "tau_star: none" in transport(run).averages.notes[0]
