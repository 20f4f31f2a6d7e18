"""What a row of columns must keep (rest, water, bits), and flow over an inclined bottom and a slope break."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from ryusa.figures.comparison import Curve
from ryusa.laws.families import BedKind, Drive, Mixing, SurfaceRule
from ryusa.model.arrays import Floats
from ryusa.model.column import Column, WaterState
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowEnd
from ryusa.study import Finding, Found, Level, Plan, Task, calculation
from ryusa.water import advance, steady
from ryusa.water.row import advance_row, row_at_rest
from ryusa.water.row_ends import with_inlet
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)

G = 9.80665
WALLS = RowEnd(EndKind.WALL), RowEnd(EndKind.WALL)
TILTS = {"level": 0.0, "1/10": 0.1}  # slopes of the frame
BEDS = {"rough": (BedKind.ROUGH, Mixing.PARABOLIC), "laminar": (BedKind.NO_SLIP, Mixing.LAMINAR)}
STEEP, LONG, FLAT, TAIL, FLOW = (
    0.06,
    2.0,
    4.0,
    0.064,
    0.03,
)  # slope break: slope, lengths and depth [m], [m2/s]
BEFORE, BEHIND = 0.15, 0.4  # from the middle of the jump to where depths are compared [m]


def _rough(depth: float, levels: int, **more: object) -> Column:
    given = {
        "z_low": 0.0, "dz": depth / levels, "n": levels + 4, "depth": depth, "bed": BedKind.ROUGH,
        "k_rough": 0.002, "mixing": Mixing.PARABOLIC, **more,
    }  # fmt: skip
    return Column(surface=SurfaceRule.VOLUME, **given)  # pyright: ignore[reportArgumentType]


def still(tilt: float, drag: bool) -> dict[str, Floats]:
    """Largest speed at each station after 3,000 steps of a pond over a bumpy porous bed [m/s]."""
    theta, n = math.atan(tilt), 30
    c = _rough(0.05, 12, dz=0.004, n=30, g_x=G * math.sin(theta))
    x = (np.arange(n, dtype=np.float64) + 0.5) * 0.01
    top = 0.05 + 0.02 * np.cos(2.0 * np.pi * x / 0.17)
    phi = np.random.default_rng(3).uniform(0.48, 0.6, (n, c.n)) * (c.z < top[:, None])
    solid = PorousSolid.of_grains(phi, 0.003, c.nu)
    if not drag:
        solid = PorousSolid(phi, 0.0 * phi, 0.0 * phi)
    bottom = 0.004 * np.sin(2.0 * np.pi * x / 0.3)
    row = ColumnRow(c, 0.01, bottom, G * math.cos(theta), *WALLS)
    now = advance_row(row, row_at_rest(row, 0.045 + tilt * x, solid), 3.0, longest=1e-3, solid=solid)
    return {"x": row.x_station, "u": np.abs(now.u).max(axis=1), "steps": np.array(float(now.steps))}


def mass() -> dict[str, Floats]:
    """Water over the first of a row that is half dry at its start, after each 1,000 steps [-]."""
    rng, n = np.random.default_rng(1), 40
    c = _rough(0.1, 20, n=60)
    solid = np.where(np.arange(n) == 20, 10, 0)
    row = ColumnRow(c, 0.02, 0.001 * np.sin(np.arange(n)), G, *WALLS, solid=solid)
    now = row_at_rest(row, np.where(rng.random(n) < 0.5, 0.0, rng.uniform(0.0, 0.15, n)))
    held = [float(now.volume[row.inner].sum())]
    while now.steps < 10_000:
        now = advance_row(row, now, 2.0, longest=2e-3)
        held.append(float(now.volume[row.inner].sum()))
    return {"t": 2.0 * np.arange(len(held), dtype=np.float64), "volume": np.array(held) / held[0]}


def same_bits(bed: str, columns: int) -> dict[str, Floats]:
    """Speeds of one column and largest difference of a period of columns after 400 steps [m/s]."""
    kind, mixing = BEDS[bed]
    c = _rough(0.0203, 40, dz=5e-4, n=44, g_x=G * 0.05, bed=kind, mixing=mixing)
    state = WaterState.at_rest(c, np.zeros(c.n))
    row = ColumnRow(c, 0.1, np.zeros(columns), G)
    now = row_at_rest(row, np.full(columns, c.depth))
    for _ in range(400):
        state, _ = advance(c, state, np.zeros(c.n), None, 1e-3)
        now = advance_row(row, now, 1e-3)
    faces = np.array([state.tau, state.nu_t])
    off = max(
        np.abs(now.u - state.u).max(),
        np.abs(now.edges - faces).max(),
        np.abs(now.content - state.content).max(),
    )
    return {"z": c.z, "u": np.array(state.u), "row": now.u[0].copy(), "off": np.array(float(off))}


def inclined() -> dict[str, Floats]:
    """Speeds along a bottom at 10 deg in a level frame, and those of one column in a frame along it [m/s]."""
    alpha = math.radians(10.0)
    c = _rough(0.02, 40, n=48, nu=1e-12)
    own = steady(replace(c, g_x=G * math.sin(alpha)))[0]
    q = float(own.content @ own.u)
    level = replace(c, g_x=0.0, dz=c.dz / math.cos(alpha), n=120)
    bottom = -math.tan(alpha) * (np.arange(20, dtype=np.float64) + 0.5) * 0.05
    profile = np.append(own.u, np.full(72, own.u[-1]))
    inlet = RowEnd(EndKind.DISCHARGE, discharge=q, profile=profile, depth=0.02 / math.cos(alpha))
    row = ColumnRow(level, 0.05, bottom, G, inlet, RowEnd(EndKind.UNIFORM))
    now = row_at_rest(row, bottom + 0.022)
    now = advance_row(row, replace(now, u=np.full_like(now.u, 1.8)), 6.0)
    depth = (now.surface[row.inner] * math.cos(alpha))[-5]
    return {
        "z": c.z[:40], "own": np.array(own.u[:40]), "row": now.u[-5, :40] / math.cos(alpha),
        "depth": np.array(float(depth)),
    }  # fmt: skip


def slope_break() -> dict[str, Floats]:
    """Depths on a steep and a level reach after 40 s, and those of gradually varied flow with a jump [m]."""
    dx = 0.02
    n = round((LONG + FLAT) / dx)
    c = Column(
        z_low=0.0, dz=0.002, n=50, depth=0.064, bed=BedKind.ROUGH, k_rough=0.001, mixing=Mixing.PARABOLIC,
        surface=SurfaceRule.VOLUME,
    )  # fmt: skip
    x = (np.arange(n, dtype=np.float64) + 0.5) * dx
    bottom = STEEP * np.maximum(LONG - x, 0.0)
    start = bottom + np.where(x < LONG + 1.7, 0.02, TAIL)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=FLOW, developed=True)
    row = with_inlet(ColumnRow(c, dx, bottom, G, inlet, RowEnd(EndKind.LEVEL, level=TAIL), start=start))
    assert row.upstream is not None
    now = replace(
        row_at_rest(row, start), u=np.where(row.x_station[:, None] < LONG + 1.7, 1.4, 0.4) + np.zeros(c.n)
    )
    now = advance_row(row, now, 40.0)
    normal = row.upstream.depth
    before, behind, jump = _profiles(c, normal)
    flat = x[x > LONG]
    return {
        "x": x, "h": now.surface[row.inner], "normal": np.array(normal), "flat": flat,
        "before": before(np.minimum(flat, before.x[-1])), "behind": behind(np.maximum(flat, behind.x[0])),
        "jump": np.array(jump),
    }  # fmt: skip


def _profiles(c: Column, first: float) -> tuple[CubicSpline, CubicSpline, float]:
    """Depth on the level reach before and behind a jump [m], and the place of equal momentum [m]."""
    some = np.linspace(0.016, 0.085, 47)
    flows = [steady(replace(c, depth=one, drive=Drive.DISCHARGE, discharge=FLOW))[0] for one in some]
    friction = CubicSpline(some, [one.gradient / c.rho_w / G for one in flows])
    beta = CubicSpline(some, [float(one.content @ one.u**2) * one.z_surface / FLOW**2 for one in flows])

    def rise(_: float, depth: Floats) -> Floats:
        froude = FLOW**2 / (G * depth**3)
        return -friction(depth) / (1.0 - froude * (beta(depth) - depth * beta(depth, 1)))

    def critical(_: float, depth: Floats) -> float:
        return float(depth[0]) - 0.042

    critical.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
    down, up = (
        solve_ivp(rise, span, [depth], events=critical, rtol=1e-9, atol=1e-10, max_step=0.02)
        for span, depth in (((LONG, LONG + FLAT), first), ((LONG + FLAT, LONG), TAIL))
    )
    before, behind = CubicSpline(down.t, down.y[0]), CubicSpline(up.t[::-1], up.y[0][::-1])

    def momentum(depth: Floats) -> Floats:
        return FLOW**2 * beta(depth) / depth + 0.5 * G * depth**2

    low, high = max(LONG, float(up.t[-1])), min(float(down.t[-1]), LONG + FLAT)
    x = np.linspace(low, high, 20_001)
    gain = momentum(before(x)) - momentum(behind(x))  # falls with friction from above 0 to below
    return before, behind, float(x[int(np.argmin(np.abs(gain)))])


def _still(tilt: float, drag: bool) -> Task:
    return calculation(still, tilt=tilt, drag=drag, seconds=1.0)


def _mass() -> Task:
    return calculation(mass, seconds=4.0)


def _bits(bed: str, columns: int) -> Task:
    return calculation(same_bits, bed=bed, columns=columns, seconds=1.0)


def _inclined() -> Task:
    return calculation(inclined, seconds=2.0)


def _break() -> Task:
    return calculation(slope_break, seconds=30.0)


def tasks(plan: Plan) -> Sequence[Task]:
    """All of them; the slope break, which takes longest, from the standard level on."""
    every = [_still(tilt, drag) for tilt in TILTS.values() for drag in (True, False)]
    every += [_mass(), *(_bits(bed, columns) for bed in BEDS for columns in (1, 8)), _inclined()]
    return every if plan.level is Level.QUICK else [*every, _break()]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Each beside what it must be."""
    basics = [_at_rest(found), _kept(found), _bitwise(found), _tilted(found)]
    return basics if plan.level is Level.QUICK else [*basics, _jump(found)]


def _at_rest(found: Found) -> Finding:
    ours, speeds = list[Curve](), dict[str, float]()
    for name, tilt in TILTS.items():
        for drag in (True, False):
            got = found[_still(tilt, drag)]
            words = f"frame {name}, {'with' if drag else 'without'} drag"
            speeds[words] = float(got["u"].max())
            ours.append(Curve(words, got["x"], got["u"]))
    at_rest = Curve("at rest", ours[0].x, 0.0 * ours[0].x)
    return DECLARED["still"].finding(ours, [at_rest], {"speed": speeds})


def _kept(found: Found) -> Finding:
    got = found[_mass()]
    off = float(np.abs(got["volume"] - 1.0).max())
    return DECLARED["mass"].finding(
        [Curve("row", got["t"], got["volume"])], [Curve("kept", got["t"], np.ones(len(got["t"])))],
        {"kept": off},
    )  # fmt: skip


def _bitwise(found: Found) -> Finding:
    ours, off = list[Curve](), dict[str, float]()
    for bed in BEDS:
        for columns in (1, 8):
            got = found[_bits(bed, columns)]
            words = f"{bed}, {columns} column{'s' if columns > 1 else ''}"
            off[words] = float(got["off"])
            ours.append(Curve(words, got["z"], got["row"]))
    references = [
        Curve(f"one column, {bed}", got["z"], got["u"]) for bed in BEDS for got in [found[_bits(bed, 1)]]
    ]
    return DECLARED["same-bits"].finding(ours, references, {"difference": off})


def _tilted(found: Found) -> Finding:
    got = found[_inclined()]
    off = float(np.abs(got["row"] - got["own"]).max() / got["own"][-1])
    return DECLARED["inclined"].finding(
        [Curve("row", got["z"], got["row"])], [Curve("column", got["z"], got["own"])],
        {"profile": off, "depth": abs(float(got["depth"]) / 0.02 - 1.0)},
    )  # fmt: skip


def _jump(found: Found) -> Finding:
    got = found[_break()]
    x, h, flat = got["x"], got["h"], got["flat"]
    level = x > LONG
    middle = 0.5 * (got["before"] + got["behind"])
    k = int(np.flatnonzero((h[level] > middle) & (flat > LONG + 0.3))[0])
    place = float(flat[k])

    def off(at: float, exact: Floats) -> float:
        return abs(float(np.interp(at, x, h)) / float(np.interp(at, flat, exact)) - 1.0)

    normal, jump = float(got["normal"]), float(got["jump"])
    before, behind = off(place - BEFORE, got["before"]), off(place + BEHIND, got["behind"])
    steep = abs(float(np.interp(0.75 * LONG, x, h)) / normal - 1.0)
    exact = np.where(flat < jump, got["before"], got["behind"])
    line = Curve("gradually varied flow, jump", flat, exact)
    return DECLARED["slope-break"].finding(
        [Curve("row", x, h)], [line],
        {"steep": steep, "before": before, "behind": behind, "place": abs(place - jump)},
    )  # fmt: skip
