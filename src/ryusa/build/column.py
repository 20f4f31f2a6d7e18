"""The column of water over the first grains: cells, boundaries, driver, turbulence."""

import math

import numpy as np

from ryusa.build.placement import Placement
from ryusa.casefile.builders.schema import FlumeSection
from ryusa.casefile.builders.table import area_of_file
from ryusa.casefile.case import Case
from ryusa.casefile.choices import chosen
from ryusa.casefile.column.checks import SPARE
from ryusa.casefile.column.packed import packed
from ryusa.casefile.column.schema import CELL
from ryusa.casefile.facts import Derived
from ryusa.casefile.grains.values import slab_width
from ryusa.casefile.row.values import stream, water_alone
from ryusa.casefile.water.schema import WaterSection
from ryusa.casefile.water.values import u_star_given
from ryusa.errors import CaseError
from ryusa.laws.families import BedKind, Drive, Fluctuations, Mixing, SideWalls, Start, SurfaceRule
from ryusa.model import Column

MOST_CELLS = 100_000


def zero_of(water: WaterSection | None, z_zero: float) -> float:
    """Height of the zero of the water [m]; `z_zero` is the builder's.

    A fixed bed is the bottom of a column, and whichever of the two the case gives sets both.
    """
    if water is None or water.zero is not None:
        return z_zero if water is None or water.zero is None else water.zero
    keys = water.column
    if keys is not None and keys.bed != "moving" and keys.bottom is not None:
        return keys.bottom
    return z_zero


def column_of(case: Case, derived: Derived, placement: Placement) -> Column | None:
    """Column of water of a case over its first grains; None for water that does not feel them.

    Raises
    ------
    CaseError : the column cannot be: it begins above the bed, or asks for too many cells.
    """
    water, found = case.water, derived
    if water is None or water.profile != "column" or water_alone(case) or stream(case):
        return None
    assert water.depth is not None
    keys = case.column
    z_bed = zero_of(case.water, placement.z_zero)
    dz = keys.cell or CELL * found.d
    z_low = keys.bottom if keys.bottom is not None else min(bottom_of(placement), z_bed)
    if keys.bed != "moving":
        z_low = z_bed
    if z_low > z_bed:
        allowed = f"the column begins at {z_low:g} m, above the bed at {z_bed:g} m (water.zero); "
        allowed += f"must be at most {z_bed:g} m, or left out"
        raise CaseError("water.column.bottom", keys.bottom, allowed)
    z_high = max(z_bed + SPARE * water.depth, float(np.max(placement.x[:, 2] + 0.5 * placement.d)))
    n = math.ceil((z_high - z_low) / dz - 1e-9)
    if n > MOST_CELLS:
        raise CaseError("water.column.cell", keys.cell, f"asks for {n:,} cells; at most {MOST_CELLS:,}")
    column = Column(
        z_low=z_low,
        dz=dz,
        n=n,
        depth=water.depth,
        area=area_of(case, placement),
        z_bed=z_bed,
        rho_w=water.density,
        nu=water.viscosity,
        bed=BedKind.of(keys.bed),
        k_rough=found.k_rough,
        surface=chosen(case, SurfaceRule),
        side=SideWalls.NONE if keys.side_walls is None else SideWalls.of(keys.side_friction),
        width=math.nan if keys.side_walls is None else keys.side_walls,
        g_x=found.g * math.sin(found.slope),
        drive=Drive.of(keys.drive),
        gradient=keys.pressure_gradient or 0.0,
        tau=water.density * u_star_given(case) ** 2 if keys.drive == "tau_star" else math.nan,
        discharge=math.nan if keys.discharge is None else keys.discharge,
        mixing=Mixing.of(keys.mixing),
        kappa=keys.kappa,
        phi_max=packed(case),
        k_f=keys.pore_eddies,
        d=found.d,
        fluctuations=Fluctuations.of(keys.fluctuations),
        seed=case.seed,
        interval=keys.interval,
        start=chosen(case, Start),
    )
    if faults := column.refuses():
        raise CaseError("water.column", None, "; ".join(faults))
    return column


def bottom_of(placement: Placement) -> float:
    """Lower edge of the lowest grain [m]; where no grain is fixed, the highest floor below the free ones."""
    lowest = float(np.min(placement.x[:, 2] - 0.5 * placement.d))
    if len(placement.x_fixed):
        return min(lowest, float(np.min(placement.x_fixed[:, 2] - 0.5 * placement.d_fixed)))
    floors = [wall.point[2] for wall in placement.walls if wall.normal[2] > 0.0 and not any(wall.normal[:2])]
    below = [z for z in floors if z <= lowest + 1e-9 * placement.d_max]
    return min(max(below), lowest) if below else lowest


def area_of(case: Case, placement: Placement) -> float:
    """Bed under the column [m2]: in a plane scene a slab for every lane."""
    if case.motion.plane:
        lanes = len(np.unique(placement.x[:, 1]))
        return placement.period[0] * slab_width(case) * lanes
    if isinstance(case.build, FlumeSection) and case.build.width is not None:
        return placement.period[0] * case.build.width
    return area_of_file(case) or placement.period[0] * placement.period[1]
