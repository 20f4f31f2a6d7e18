"""A thin plate and a drop within a row of columns, with air below their nappe (design/0030).

The limits were written down before any nappe was run: 3 % of the discharge and 5 % of the landing place were
asked for; those of the pool and of the jet behind a drop allow for a pool without eddies and for cells of a
third of the jet's depth.
"""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.laws.families import Pressure, SurfaceRule
from ryusa.model.arrays import Floats
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowDam, RowEnd, RowState
from ryusa.study import Finding, Found, Task, calculation
from ryusa.water.row import RowArrays, advance_row, row_at_rest
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)

G = 9.80665
DX, DZ = 0.01, 0.005
PLATE = 0.08  # height of plate and drop [m]
HEAD = 0.06  # about that over the plate [m]
TIME = 15.0  # [s]


def reach_of_nappe(fall: float, head: float, velocity_head: float) -> float:
    """Way from a sharp crest to where the middle of its nappe is `fall` below the crest [m].

    Parameters
    ----------
    fall : below the crest [m].
    head : energy head of the flow over the crest [m].
    velocity_head : the part of it that is u**2/(2 g) in the approach [m].

    Notes
    -----
    Blaisdell 1954 (as Chow 1959, Eqs. 14-2 to 14-6), lower and upper face: y/H = A (x/H)**2 + B x/H + C, and
    D more; for x above H/2. The lower one is that of the profile of the WES within 1 % of H up to 1.5 H.
    """
    v = velocity_head / head
    a = -0.425 + 0.25 * v
    b = 0.411 - 1.603 * v - math.sqrt(1.568 * v**2 - 0.892 * v + 0.127)
    m = 10.0 * (v - 0.208)
    c, d = 0.150 - 0.45 * v, 0.57 - 0.02 * m**2 * math.exp(m)
    rest = c + 0.5 * d + fall / head
    return head * (-b - math.sqrt(b * b - 4.0 * a * rest)) / (2.0 * a)


def drop_of_rand(q: float, high: float, g: float) -> tuple[float, float, float]:
    """Depths of the pool below the nappe of a drop and of the jet behind it, and its length [m].

    Parameters
    ----------
    q : discharge [m2/s].
    high : of the drop [m].
    g : gravity [m/s2].

    Notes
    -----
    Rand 1955, Flow geometry at straight drop spillways, by the drop number q**2/(g high**3).
    """
    number = q * q / (g * high**3)
    return 1.00 * number**0.22 * high, 0.54 * number**0.425 * high, 4.30 * number**0.27 * high


def of_dam(crest: int, high: float, head: float, dz: float, *, aerated: bool) -> tuple[ColumnRow, RowState]:
    """A row of 1 m before a dam of so many segments and 0.8 m behind it, without friction, at rest."""
    before, behind = round(1.0 / DX), round(0.8 / DX)
    n, q = before + crest + behind, 0.5 * math.sqrt(G) * head**1.5
    at = np.arange(n)
    solid = np.where((at >= before) & (at < before + crest), round(high / dz), 0)
    column = Column(
        z_low=0.0, dz=dz, n=round(0.2 / dz), depth=high + head, nu=1e-15, surface=SurfaceRule.VOLUME
    )
    row = ColumnRow(
        column, DX, np.zeros(n), G, RowEnd(EndKind.DISCHARGE, discharge=q), RowEnd(EndKind.FREE_FALL),
        solid=solid, pressure=Pressure.FULL, x_low=-(before + (0.5 if crest == 1 else crest)) * DX,
        dams=(RowDam("dam", before, before + crest, high, False, aerated),),
    )  # fmt: skip
    deep = np.where(at < before, high + head, np.where(solid > 0, high + 0.7 * head, 0.25 * high))
    return row, row_at_rest(row, deep)


def falling(crest: int, dz: float = DZ, aerated: bool = True) -> dict[str, Floats]:
    """Steady flow over a dam of so many segments: surface, landing place, discharge over a plate.

    x counts from the middle of a plate of one segment, where a thin one would stand, or from the downstream
    face. `lands` is the mean place of what lands, and `pool` the surface there.
    """
    row, now = of_dam(crest, PLATE, HEAD, dz, aerated=aerated)
    arrays, q = RowArrays.of(row), 0.5 * math.sqrt(G) * HEAD**1.5
    now = advance_row(row, now, TIME - 2.0, arrays=arrays)
    surface, landed = np.zeros((2, row.n_segment))
    for _ in range(20):
        now = advance_row(row, now, 0.1, arrays=arrays)
        surface += now.surface[row.inner] / 20.0
        if arrays.nappe is not None:
            landed += np.delete(arrays.nappe.lands, arrays.nappe.air)[row.inner] * row.dx / 20.0
    x, over = row.x, float(surface[row.dams[0].first - 25]) - PLATE
    energy = over + (q / (over + PLATE)) ** 2 / (2.0 * G)
    rehbock = 2.0 / 3.0 * math.sqrt(2.0) * (0.602 + 0.083 * over / PLATE) * ((over + 0.0011) / energy) ** 1.5
    whole = max(float(landed.sum()), 1e-12)
    lands = float(landed @ x) / whole
    return {
        "x": x, "surface": surface, "landed": landed, "lands": np.array(lands),
        "pool": np.array(landed @ surface / whole), "c": np.array(q / (math.sqrt(G) * energy**1.5)),
        "rehbock": np.array(rehbock), "head": np.array(energy), "q": np.array(q),
        "velocity_head": np.array(energy - over),
    }  # fmt: skip


def _plate() -> Task:
    return calculation(falling, crest=1, seconds=20.0)


def _drop() -> Task:
    return calculation(falling, crest=60, dz=0.0025, seconds=80.0)


def tasks() -> Sequence[Task]:
    """Two minutes."""
    return [_plate(), _drop()]


def judge(found: Found) -> Sequence[Finding]:
    """Plate and drop within a row, beside what was measured."""
    return [_of_plate(found), _of_drop(found)]


def _near(name: str, run: dict[str, Floats]) -> Curve:
    """The surface near the crest."""
    near = np.abs(run["x"]) < 0.4
    return Curve(name, run["x"][near], run["surface"][near])


def _of_plate(found: Found) -> Finding:
    own = found[_plate()]
    c, rehbock, lands, pool = (float(own[name]) for name in ("c", "rehbock", "lands", "pool"))
    head, velocity_head = float(own["head"]), float(own["velocity_head"])
    fall = np.linspace(0.0, PLATE - pool, 20)
    middle = np.array([reach_of_nappe(float(one), head, velocity_head) for one in fall])
    return DECLARED["sill"].finding(
        [_near("air behind it", own)], [Curve("middle of the measured nappe", middle, PLATE - fall)],
        {"rehbock": abs(c / rehbock - 1.0), "lands": abs(lands / float(middle[-1]) - 1.0)}, head=100.0 * head,
        lands=100.0 * lands, c=c, rehbock=rehbock,
    )  # fmt: skip


def _of_drop(found: Found) -> Finding:
    own = found[_drop()]
    x, surface, lands, q = own["x"], own["surface"], float(own["lands"]), float(own["q"])
    pool, jet, length = drop_of_rand(q, PLATE, G)
    beneath = float(surface[(x > 0.0) & (x < 0.5 * lands)].mean())
    behind = float(surface[(x > length) & (x < length + 2.0 * PLATE)].mean())
    return DECLARED["drop"].finding(
        [_near("row", own)],
        [
            Curve("pool, measured", np.array([0.0, 0.5 * lands]), np.full(2, pool)),
            Curve("jet, measured", np.array([length, length + 2.0 * PLATE]), np.full(2, jet)),
        ],
        {"pool": abs(beneath / pool - 1.0), "jet": abs(behind / jet - 1.0)}, number=q * q / (G * PLATE**3),
        lands=100 * lands,
    )  # fmt: skip
