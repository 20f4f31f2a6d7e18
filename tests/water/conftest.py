"""Columns shared by the tests of the water."""

from dataclasses import replace

import numpy as np
import pytest

from ryusa.laws.families import BedKind, Mixing
from ryusa.model.column import Column


@pytest.fixture
def laminar() -> Column:
    """Viscous water 1 cm deep on a slope."""
    return Column(z_low=0.0, dz=5e-4, n=20, depth=0.01, nu=1e-5, g_x=0.01)


@pytest.fixture
def river() -> Column:
    """The saltation of the paper: water 2 cm deep over a rough bed, u_star 0.0985 m/s."""
    return Column(
        z_low=0.0,
        dz=5e-4,
        n=40,
        depth=0.02,
        bed=BedKind.ROUGH,
        k_rough=0.002,
        mixing=Mixing.PARABOLIC,
        kappa=np.log(10.0) / 5.75,
        g_x=0.0985**2 / 0.02,
    )


@pytest.fixture
def bedload(river: Column) -> Column:
    """Two centimetres of water over a bed of grains of the same depth."""
    return replace(
        river,
        n=90,
        z_bed=0.02,
        bed=BedKind.MOVING,
        mixing=Mixing.LI_SAWAMOTO,
        kappa=0.41,
        dz=5e-4,
        phi_max=0.61,
    )


@pytest.fixture
def phi(bedload: Column) -> np.ndarray:
    """Concentration of a bed with a layer of moving grains on it."""
    return 0.6 / (1.0 + np.exp((bedload.z - 0.02) / 1e-3))
