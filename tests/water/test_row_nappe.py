"""Aerated sills of a row: where water lands, what it brings, and that nothing is lost (design/0030)."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from ryusa.errors import WaterError
from ryusa.laws.families import BedKind, Buoyancy, Mixing, Pressure, SurfaceRule
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowDam, RowEnd, RowState
from ryusa.model.row_energy import RowTerm, row_imbalance
from ryusa.water.row import RowArrays, advance_row, row_at_rest
from ryusa.water.row_coupling import _residual
from ryusa.water.row_layout import RowWater
from ryusa.water.row_nappe import BEYOND, LANDED, STRIKES, hang, landing, open_state

G = 9.80665
DX, DZ, HIGH, SILL = 0.01, 0.005, 0.08, 20
INLET = RowEnd(EndKind.DISCHARGE, discharge=0.02)
DROP = RowEnd(EndKind.FREE_FALL)
N, CELLS = 60, 60


def row_of(
    cells: dict[int, int],
    down: RowEnd = DROP,
    *,
    air: Sequence[int] = (SILL,),
    bottom: np.ndarray | None = None,
    tilt: float = 0.0,
) -> ColumnRow:
    """A row with dams of one segment, so many cells high; those at `air` are aerated."""
    solid, angle = np.zeros(N, np.int64), math.atan(tilt)
    solid[list(cells)] = list(cells.values())
    c = Column(
        z_low=0.0, dz=DZ, n=CELLS, depth=0.1, nu=1e-6, surface=SurfaceRule.VOLUME, g_x=G * math.sin(angle),
        bed=BedKind.ROUGH, k_rough=0.002, mixing=Mixing.PARABOLIC,
    )  # fmt: skip
    bottom = np.zeros(N) if bottom is None else bottom
    dams = tuple(RowDam(f"dam {i}", i, i + 1, bottom[i] + cells[i] * DZ, False, i in air) for i in cells)
    return ColumnRow(
        c, DX, bottom, G * math.cos(angle), INLET, down, solid=solid, dams=dams, pressure=Pressure.FULL
    )


def at_rest(row: ColumnRow, behind: float, solid: PorousSolid | None = None) -> RowState:
    """Water as high as 4 cm over the first sill before it, and `behind` [m] deep behind it."""
    deep = np.where(np.arange(N) <= SILL, HIGH + 0.04, behind)
    assert row.solid is not None
    return row_at_rest(row, row.bottom + np.maximum(deep, row.solid * DZ), solid)


def parcel(row: ColumnRow, start: RowState, z: float, u: float, w: float) -> tuple[int, float, float]:
    """What becomes of a parcel, its place behind the sill, and the time of its fall."""
    arrays = RowArrays.of(row)
    nappe = arrays.nappe
    assert nappe is not None
    state = open_state(row, start)
    water = RowWater(*(np.array(getattr(state, name)) for name in RowWater._fields))
    hang(arrays.p, arrays.shape, water, False, nappe, np.zeros(len(RowTerm)))
    assert nappe.free[0] == 1
    sill = int(nappe.air[0]) - 1
    what, before, i, part, t = landing(arrays.p, arrays.shape, water, sill, z, u, w, nappe.is_air)
    passed = nappe.is_air[: i + 1].cumsum()  # segments of air have no length
    place = (
        (1.0 - part) * (before - passed[before])
        + part * (i - passed[i])
        - sill
        + nappe.is_air[:sill].sum()
        - 0.5
    )
    return what, place * DX, t


@pytest.mark.parametrize("w", [0.0, -0.3, 0.2])
@pytest.mark.parametrize("tilt", [0.0, 0.1])
def test_a_parcel_lands_where_its_parabola_meets_the_pool(tilt: float, w: float) -> None:
    row = row_of({SILL: 16}, tilt=tilt)
    pool, z, u = 0.033, 0.1, 0.7
    what, place, t = parcel(row, at_rest(row, pool), z, u, w)
    falls = (w + math.sqrt(w * w + 2.0 * row.g_z * (z - pool))) / row.g_z
    assert what == LANDED
    assert t == pytest.approx(falls, rel=1e-12)
    assert place == pytest.approx(u * falls + 0.5 * row.column.g_x * falls**2, rel=1e-12)


def test_a_parcel_meets_an_inclined_surface_on_its_line() -> None:
    row = row_of({SILL: 16})
    start = at_rest(row, 0.03)
    rising = np.array(start.surface)
    rising[SILL + 2 :] = 0.02 + 0.2 * DX * (np.arange(len(rising) - SILL - 2) + 0.5)
    what, place, t = parcel(row, replace(start, surface=rising), 0.1, 0.7, 0.0)
    assert what == LANDED
    assert place == pytest.approx(0.7 * t, rel=1e-12)
    assert 0.1 - 0.5 * G * t * t == pytest.approx(0.02 + 0.2 * place, rel=1e-12)


def test_a_parcel_lands_on_a_lower_dam_strikes_a_higher_one_or_leaves_the_row() -> None:
    low, high = row_of({SILL: 16, SILL + 9: 6, SILL + 10: 6}), row_of({SILL: 16, SILL + 9: 15})
    what, place, t = parcel(low, at_rest(low, 0.02), 0.1, 0.7, 0.0)
    assert (what, place) == (LANDED, pytest.approx(8.5 * DX))
    assert 0.1 - 0.5 * G * t * t == pytest.approx(0.03) and 8.0 * DX < 0.7 * t < 9.0 * DX
    assert parcel(high, at_rest(high, 0.02), 0.1, 0.7, 0.0)[0] == STRIKES
    assert parcel(low, at_rest(low, 0.02), 0.1, 4.0, 0.0)[0] == BEYOND
    late = row_of({SILL: 16, SILL + 9: 14}, air=(SILL, SILL + 9))  # flies over another with air behind it
    what, place, t = parcel(late, at_rest(late, 0.02), 0.1, 1.2, 0.0)
    assert (what, place) == (LANDED, pytest.approx(1.2 * t)) and place > 10.0 * DX


def flows() -> dict[str, tuple[ColumnRow, RowState, PorousSolid | None]]:
    """Water over aerated sills of all kinds."""
    fall, level = -0.05 * DX * np.arange(N), RowEnd(EndKind.LEVEL, level=0.095)
    bed = PorousSolid.of_grains(
        np.where(np.arange(CELLS)[None, :] * DZ < 0.03, 0.55, 0.0)
        * (np.arange(N)[:, None] > SILL), 0.004, 1e-6
    )  # fmt: skip
    rows = {
        "a free nappe": (row_of({SILL: 16}), 0.02, None),
        "on a dry floor": (row_of({SILL: 16}), 0.0, None),
        "a tilted axis and a falling bottom": (row_of({SILL: 16}, bottom=fall, tilt=0.05), 0.02, None),
        "drowned in the end": (row_of({SILL: 16}, level), 0.06, None),
        "two in a row": (row_of({SILL: 16, SILL + 16: 8}, air=(SILL, SILL + 16)), 0.05, None),
        "over a porous bed": (row_of({SILL: 16}), 0.04, bed),
    }
    return {name: (row, at_rest(row, deep, solid), solid) for name, (row, deep, solid) in rows.items()}


@pytest.mark.parametrize("name", flows())
def test_volume_momentum_and_energy_close(name: str) -> None:
    row, start, solid = flows()[name]
    now, arrays, worst, free = start, RowArrays.of(row), 0.0, list[int]()
    nappe = arrays.nappe
    assert nappe is not None
    for _ in range(16):
        now = advance_row(row, now, 0.1, solid=solid, arrays=arrays)
        worst = max(worst, _residual(now.budgets))
        free.append(int(nappe.free[0]))
        air = nappe.air[nappe.free == 1]
        flows_off, speeds = arrays.work.flux[air - 1], arrays.work.energy.speed[air]
        falls = float(flows_off.sum())
        assert nappe.lands.sum() * DX == pytest.approx(falls, rel=1e-12, abs=1e-15)
        assert nappe.given.sum() == pytest.approx(nappe.along.sum(), rel=1e-12)
        if row.column.g_x == 0.0:
            assert nappe.along.sum() * DX == pytest.approx(float((flows_off * speeds).sum()), rel=1e-12)
    gained = float((now.volume - start.volume)[row.inner].sum()) * DX
    entered = float(now.passed[0] - now.passed[-1])
    assert gained - entered == pytest.approx(0.0, abs=1e-13 * float(start.volume.sum()) * DX)
    assert worst < 1e-12
    assert abs(row_imbalance(now.energy)) < 1e-12 * np.abs(now.energy).max()
    assert now.energy[RowTerm.FALL] > 0.0 and float(now.passed[SILL + 1]) > 0.01
    if name == "drowned in the end":
        assert free[0] == 1 and free[-1] == 0
    elif name == "a free nappe":
        assert all(free) and np.abs(now.pressure).max() > 0.1


def test_an_aerated_run_cut_in_two_has_the_bits_of_one() -> None:
    row, start, _ = flows()["drowned in the end"]
    arrays, whole, again = RowArrays.of(row), start, start
    for _ in range(8):
        whole = advance_row(row, whole, 0.1, arrays=arrays)
        again = advance_row(row, again, 0.1, arrays=RowArrays.of(row))
    for name in (
        "u",
        "volume",
        "content",
        "passed",
        "w",
        "pressure",
        "energy",
        "budgets",
        "profiles",
        "edges",
    ):
        assert np.array_equal(getattr(whole, name), getattr(again, name)), name
        assert len(getattr(whole, name)) == len(getattr(start, name)), name


def test_a_drowned_sill_flows_as_one_without_air() -> None:
    row = row_of({SILL: 16}, RowEnd(EndKind.LEVEL, level=0.11))
    found = []
    for air in (True, False):
        one = replace(row, dams=tuple(replace(dam, aerated=air) for dam in row.dams))
        found.append(advance_row(one, at_rest(one, 0.11), 0.5))
    with_air, without = found
    assert with_air.surface == pytest.approx(without.surface, abs=1e-6)
    assert with_air.u[: SILL + 4, :20] == pytest.approx(without.u[: SILL + 4, :20], abs=1e-4)


def test_a_pool_that_rises_over_the_sill_drowns_it_without_a_leap() -> None:
    row, now, _ = flows()["drowned in the end"]
    arrays, before = RowArrays.of(row), list[tuple[int, float]]()
    for _ in range(60):
        now = advance_row(row, now, 0.05, arrays=arrays)
        assert arrays.nappe is not None
        before.append((int(arrays.nappe.free[0]), float(now.surface[row.inner][SILL - 5])))
    drowned = [k for k, ((a, _), (b, _)) in enumerate(pairwise(before)) if a != b]
    assert drowned
    for k in drowned:
        assert abs(before[k + 1][1] - before[k][1]) < 0.01
    assert np.abs(now.u).max() < 2.0


@pytest.mark.parametrize(("cells", "says"), [({SILL: 16, SILL + 5: 20}, "strikes"), ({N - 4: 16}, "beyond")])
def test_a_nappe_that_does_not_land_in_the_row_stops_the_run_with_its_place(
    cells: dict[int, int], says: str
) -> None:
    row = row_of(cells, air=(next(iter(cells)),))
    solid = row.solid
    assert solid is not None
    start = row_at_rest(row, np.where(np.arange(N) < N - 4, 0.12, np.maximum(solid * DZ, 0.01)))
    if says == "strikes":
        start = at_rest(row, 0.01)
    with pytest.raises(WaterError, match=says) as caught:
        advance_row(row, start, 2.0)
    assert f"x = {(min(cells) + 0.0) * DX:.4g} m" in str(caught.value)


def test_what_cannot_have_air_behind_it_is_refused_by_name() -> None:
    row = row_of({SILL: 16})
    (dam,) = row.dams
    cases = {
        "alone": replace(row, pressure=Pressure.HYDROSTATIC),
        "periodic": replace(row, upstream=None, downstream=None),
        "porous": replace(row, dams=(replace(dam, porous=True),)),
        "row ends": replace(row, dams=(replace(dam, end=N),)),
        "as high": replace(row, solid=np.where(np.arange(N) == SILL + 1, 20, row.solid)),
    }
    assert not row.refuses()
    for says, one in cases.items():
        (fault,) = one.refuses()
        assert says in fault and "'dam 20'" in fault
    assert not row.refuses_grains(Buoyancy.STRESS, math.inf)
