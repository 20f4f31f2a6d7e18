"""The stress of water on the bed, in flows known in closed form."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.measure.bed_stress import bed_stress
from ryusa.model import EVENT
from ryusa.model.scene import Water

D, DZ, RHO_W, RHO_S, G_X, G_Z = 2.0e-3, 2.0e-4, 1000.0, 2650.0, 0.5, 9.8
FACES = np.arange(101) * DZ  # 10 d; the surface at 8 d
SURFACE = 8.0 * D


@pytest.fixture
def flow(make):
    """A run of water over a bed up to 3 d with grains on the move up to 4 d."""

    def build(phi_above=0.1, gradient=0.0, n_frame=6, gain=0.0, water=True):
        scene = make.scene(4)
        scene = replace(
            scene, d=np.full(4, D), m=np.full(4, RHO_S * math.pi / 6 * D**3), plane_case=False,
            period=(10 * D, 5 * D), gravity=np.array([G_X, 0.0, -G_Z]), water=Water(rho_w=RHO_W),
        )  # fmt: skip
        z = 0.5 * (FACES[1:] + FACES[:-1])
        phi = np.where(z < 3.0 * D, 0.6, np.where(z < 4.0 * D, phi_above, 0.0))
        content = (1.0 - phi) * np.clip(SURFACE - FACES[:-1], 0.0, DZ)
        tau = (RHO_W * (G_X - gain) + gradient) * np.maximum(SURFACE - FACES, 0.0)  # where it is clear
        tau[FACES < 3.99 * D] = -1.0  # below, nobody may look

        def rows(one):
            return np.broadcast_to(one, (n_frame, *np.shape(one)))

        profiles = SimpleNamespace(
            faces=FACES, phi=rows(phi), content=rows(content), tau=rows(tau), z_surface=rows(SURFACE),
            gradient=rows(gradient),
        )  # fmt: skip
        x = np.zeros((n_frame, 4, 3))
        return SimpleNamespace(
            case={"record": {}, "water": {"profile": "column"}},
            frames=SimpleNamespace(t=0.01 * np.arange(n_frame), x=x, v=0.0 * x, omega=0.0 * x),
            contacts=np.zeros(0, EVENT),
            scene=scene,
            tally={},
            water=profiles if water else None,
        )

    return build


def test_in_steady_flow_the_bed_carries_the_weight_of_the_water_above(flow):
    found = bed_stress(flow())
    tau = RHO_W * G_X * (4.0 + 0.9) * D  # 4 d of clear water and one with a tenth of grains
    assert found.z_bed == pytest.approx(3.0 * D, abs=1.01 * DZ)
    assert found.z_clear == pytest.approx(4.0 * D, abs=1e-12)
    assert found.densest == pytest.approx(0.6)
    assert found.averages["tau_bed"].value == pytest.approx(tau, rel=0.03)  # bed to half a cell
    star = found.averages["tau_bed"].value / ((RHO_S - RHO_W) * math.hypot(G_X, G_Z) * D)
    assert found.averages["tau_star"].value == pytest.approx(star, rel=1e-12)
    assert found.averages["tau_bed"].error == pytest.approx(0.0, abs=1e-12)


def test_a_driving_gradient_counts_like_weight_over_the_whole_height(flow):
    still, driven = (bed_stress(flow(gradient=one)) for one in (0.0, 300.0))
    more = driven.averages["tau_bed"].value - still.averages["tau_bed"].value
    assert more == pytest.approx(300.0 * (SURFACE - still.z_bed), rel=1e-9)


def test_clear_water_that_gains_speed_puts_less_on_the_bed(flow):
    still, faster = (bed_stress(flow(gain=one)) for one in (0.0, 0.2))
    less = still.averages["tau_bed"].value - faster.averages["tau_bed"].value
    assert less == pytest.approx(RHO_W * 0.2 * (SURFACE - 4.0 * D), rel=1e-9)


def test_a_run_without_a_column_or_without_grains_has_no_stress_on_the_bed(flow):
    with pytest.raises(ResultsError, match="no column of water"):
        bed_stress(flow(water=False))
    run = flow()
    run.water.phi = 0.0 * run.water.phi
    with pytest.raises(ResultsError, match="no bed"):
        bed_stress(run)
