"""The energy account of the water of a row: that it closes, and losses of known size (design/0027)."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.laws.bore import reflected_bore
from ryusa.laws.families import BedKind, Mixing, SurfaceRule
from ryusa.model.arrays import Floats
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowEnd, RowState
from ryusa.model.row_energy import RowTerm, row_imbalance
from ryusa.study import Finding, Found, Task, calculation
from ryusa.water import steady
from ryusa.water.row import advance_row, row_at_rest
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.river_impact import ALONE, against_a_wall

DECLARED = declared(__file__)

G, RHO = 9.80665, 1000.0
BY_SCHEME = [RowTerm.FALL, RowTerm.UPWIND, RowTerm.LATE, RowTerm.SURFACE]


def books(row: ColumnRow, now: RowState, times: Floats) -> Floats:
    """Accounts at some times from now on [J/m], shape (n_time, N_ROW_TERM)."""
    found = [now.energy]
    for k in range(1, len(times)):
        now = advance_row(row, now, float(times[k] - times[k - 1]))
        found.append(now.energy)
    return np.array(found)


def sloshing() -> dict[str, Floats]:
    """A row with a dam over bumps, half dry at its start: its account over 4 s."""
    rng, n = np.random.default_rng(1), 40
    c = Column(
        z_low=0.0, dz=0.005, n=60, depth=0.1, bed=BedKind.ROUGH, k_rough=0.002, mixing=Mixing.PARABOLIC,
        surface=SurfaceRule.VOLUME,
    )  # fmt: skip
    walls = RowEnd(EndKind.WALL), RowEnd(EndKind.WALL)
    solid = np.where(np.arange(n) == 20, 10, 0)
    row = ColumnRow(c, 0.02, 0.001 * np.sin(np.arange(n)), G, *walls, solid=solid)
    start = row_at_rest(row, np.where(rng.random(n) < 0.5, 0.0, rng.uniform(0.0, 0.15, n)))
    times = np.linspace(0.0, 4.0, 21)
    return {"t": times, "account": books(row, start, times)}


def bore() -> dict[str, Floats]:
    """A stream without friction against a wall: what it loses from 0.4 s on, and what the bore must [J/m]."""
    (h, u), (row, start) = ALONE, against_a_wall()
    now = advance_row(row, start, 0.4)
    times = np.linspace(0.0, 0.4, 9)
    account = books(row, now, times)
    account -= account[0]
    behind, celerity = reflected_bore(u, h, G)
    power = RHO * G * h * (u + celerity) * (behind - h) ** 3 / (4.0 * h * behind)
    return {"t": times, "lost": account[:, BY_SCHEME].sum(axis=1), "exact": power * times}


def uniform() -> dict[str, Floats]:
    """Uniform flow down a slope of 0.05, from inlet to outlet: account of its last second [J/m]."""
    theta, depth = math.atan(0.05), 0.028
    c = Column(
        z_low=0.0, dz=depth / 18, n=26, depth=depth, bed=BedKind.ROUGH, k_rough=0.004,
        mixing=Mixing.PARABOLIC, surface=SurfaceRule.VOLUME, g_x=G * math.sin(theta),
    )  # fmt: skip
    flow = steady(c)[0]
    exact = np.array(flow.u)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=float(flow.content @ exact), profile=exact, depth=depth)
    row = ColumnRow(c, 0.05, np.zeros(60), G * math.cos(theta), inlet, RowEnd(EndKind.UNIFORM))
    now = replace(row_at_rest(row, np.full(60, depth)), u=np.tile(0.9 * exact, (61, 1)))
    now = advance_row(row, now, 10.0)
    times = np.linspace(0.0, 1.0, 6)
    account = books(row, now, times)
    account -= account[0]
    lost = account[:, RowTerm.BED] + account[:, RowTerm.SHEAR]
    return {"t": times, "lost": lost, "given": account[:, RowTerm.GRAVITY]}


def tasks() -> Sequence[Task]:
    """All of them, seconds each."""
    return [calculation(one, seconds=1.0) for one in (sloshing, bore, uniform)]


def judge(found: Found) -> Sequence[Finding]:
    """Each beside what it must be."""
    closes, wave, flow = (found[one] for one in tasks())
    account = closes["account"]
    left = row_imbalance(account)
    terms = [
        Curve(name, closes["t"], account[:, which].sum(axis=1))
        for name, which in (
            ("kinetic and potential energy", [RowTerm.KINETIC, RowTerm.POTENTIAL]),
            ("lost at bed and between cells", [RowTerm.BED, RowTerm.SHEAR]),
            ("lost by the scheme and over the dam", BY_SCHEME),
        )
    ]
    rest = float(np.abs(left).max() / np.abs(account).max())
    off = abs(float(flow["lost"][-1] / flow["given"][-1]) - 1.0)
    return [
        DECLARED["energy"].finding(terms, [Curve("left over", closes["t"], left)], {"closes": rest}),
        DECLARED["energy-bore"].finding(
            [Curve("row", wave["t"], wave["lost"])], [Curve("bore", wave["t"], wave["exact"])],
            {"lost": float(wave["lost"][-1] / wave["exact"][-1])},
        ),
        DECLARED["energy-uniform"].finding(
            [Curve("lost", flow["t"], flow["lost"])], [Curve("given by gravity", flow["t"], flow["given"])],
            {"difference": off},
        ),
    ]  # fmt: skip
