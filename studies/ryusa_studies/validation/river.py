"""A row of columns: waters at rest, dam breaks, uniform flow, weirs, seepage, grains (design/0027)."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from ryusa.figures.comparison import Curve
from ryusa.laws.families import BedKind, Drive, Mixing, SurfaceRule
from ryusa.model.arrays import Floats
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowEnd
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Level, Plan, Task, calculation
from ryusa.water import steady
from ryusa.water.row import advance_row, discharges, row_at_rest
from ryusa_studies.validation import river_basics as basics
from ryusa_studies.validation import river_dam as dam
from ryusa_studies.validation import river_dam_break as over_bed
from ryusa_studies.validation import river_delta as delta
from ryusa_studies.validation import river_energy as energy
from ryusa_studies.validation import river_exner as exner
from ryusa_studies.validation import river_feeder as feeder
from ryusa_studies.validation import river_grains as with_grains
from ryusa_studies.validation import river_impact as impact
from ryusa_studies.validation import river_overload as overload
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.river_dam_break import ritter

TITLE = "A row of columns"
DECLARED = declared(__file__)
G = 9.80665
WALLS = RowEnd(EndKind.WALL), RowEnd(EndKind.WALL)
BREAK_TIME, HIGH = 0.6, 0.1  # of the dam breaks [s], [m]
SLOPES = {"0.002": (0.072, 120.0), "0.01": (0.072, 40.0), "0.05": (0.028, 20.0)}  # depth [m], time [s]
ACROSS = (20, 40, 80)
SEGMENTS = (5, 10)  # of the dam break over a dry bed [mm]
CRESTS = (1, 2, 3, 5, 10)
DAM_HIGH, DAM_LOW, DAM_LONG, DAM_PHI = 0.12, 0.03, 0.4, 0.6


def _column(depth: float, n: int, **more: object) -> Column:
    given = {"z_low": 0.0, "dz": depth / n, "n": n + 4, "depth": depth, "nu": 1e-15, **more}
    return Column(surface=SurfaceRule.VOLUME, **given)  # pyright: ignore[reportArgumentType]


def dam_break(ahead: float, mm: int, levels: int) -> dict[str, Floats]:
    """Depth [m], its places [m], and the discharge at the stations [m2/s] after BREAK_TIME."""
    dx = 1e-3 * mm
    row = ColumnRow(_column(HIGH, levels), dx, np.zeros(round(4.0 / dx)), G, *WALLS)
    now = advance_row(row, row_at_rest(row, np.where(row.x < 2.0, HIGH, ahead)), BREAK_TIME)
    return {"x": row.x - 2.0, "h": now.surface[row.inner], "q": discharges(row, now)[1:]}


def uniform(slope: str) -> dict[str, Floats]:
    """Speeds at three quarters of 200 segments, those of `steady` [m/s], and discharges over that asked."""
    (depth, time), theta = SLOPES[slope], math.atan(float(slope))
    c = replace(
        _column(depth, 18, nu=1e-6, bed=BedKind.ROUGH, k_rough=0.004, mixing=Mixing.PARABOLIC), n=26,
        g_x=G * math.sin(theta),
    )  # fmt: skip
    exact = np.array(steady(c)[0].u)
    q = float(steady(c)[0].content @ exact)
    fast = q / depth > math.sqrt(G * depth)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=q, profile=exact, depth=depth if fast else math.nan)
    outlet = RowEnd(EndKind.UNIFORM) if fast else RowEnd(EndKind.LEVEL, level=depth)
    row = ColumnRow(c, 0.05, np.zeros(200), G * math.cos(theta), inlet, outlet)
    now = replace(row_at_rest(row, np.full(200, depth)), u=np.tile(0.9 * exact, (201, 1)))
    now = advance_row(row, now, time)
    return {
        "z": c.z[:18], "u": now.u[150, :18], "exact": exact[:18], "q": discharges(row, now)[150] / np.array(q)
    }  # fmt: skip


def seepage(across: int, inertia: bool) -> dict[str, Floats]:
    """Discharge in the middle of a porous dam [m2/s], and depth in it [m]."""
    d, n = (4e-3 if inertia else 1.5e-3), across + 8
    c = _column(DAM_HIGH, 40, nu=1e-6)
    phi = np.full((n, c.n), DAM_PHI)
    phi[:4] = phi[-4:] = 0.0
    solid = PorousSolid.of_grains(phi, d, c.nu, inertia=inertia)
    ends = RowEnd(EndKind.LEVEL, level=DAM_HIGH), RowEnd(EndKind.LEVEL, level=DAM_LOW)
    row = ColumnRow(c, DAM_LONG / across, np.zeros(n), G, *ends)
    x = row.x - 4.0 * row.dx
    now = advance_row(row, row_at_rest(row, 0.98 * dupuit(x), solid), 20.0, longest=5e-3, solid=solid)
    return {"x": x[4:-4], "h": now.surface[row.inner][4:-4], "q": discharges(row, now)[n // 2]}


def weir(crest: int) -> dict[str, Floats]:
    """q/(sqrt(g) H**1.5) of a crest of so many segments of 2 cm, 8 cm high; 0: the channel ends in a drop."""
    q, height = 0.03, 0.08 if crest else 0.0
    c = replace(_column(0.1, 25), n=60)
    solid = np.zeros(150, np.int64)
    solid[100 : 100 + crest] = round(height / c.dz)
    inlet, outlet = RowEnd(EndKind.DISCHARGE, discharge=q), RowEnd(EndKind.FREE_FALL)
    row = ColumnRow(c, 0.02, np.zeros(150), G, inlet, outlet, solid=solid)
    head = (q / 0.5 / math.sqrt(G)) ** (2.0 / 3.0)
    start = np.where(np.arange(150) < 100 + crest, height + head, 0.02 if crest else head)
    now = advance_row(row, row_at_rest(row, start), 30.0 if crest else 60.0)
    depth = now.surface[row.inner][75]
    total = depth - height + (q / depth) ** 2 / (2.0 * G)
    return {"x": row.x, "h": now.surface[row.inner], "c": q / math.sqrt(G) / total**1.5}


def backwater() -> dict[str, Floats]:
    """Depth before a dam of 8 cm after 80 s, and that of the equation of gradually varied flow [m]."""
    q, theta, dx = 0.03, math.atan(0.005), 0.04
    c = replace(
        _column(0.1, 25, nu=1e-6, bed=BedKind.ROUGH, k_rough=0.004, mixing=Mixing.PARABOLIC), n=50,
        g_x=G * math.sin(theta),
    )  # fmt: skip
    solid = np.zeros(200, np.int64)
    solid[175:180] = 20
    inlet, outlet = RowEnd(EndKind.DISCHARGE, discharge=q), RowEnd(EndKind.FREE_FALL)
    row = ColumnRow(c, dx, np.zeros(200), G * math.cos(theta), inlet, outlet, solid=solid)
    start = np.where(np.arange(200) < 180, np.interp(row.x, [0.0, 7.0], [0.11, 0.145]), 0.03)
    now = advance_row(row, row_at_rest(row, start), 80.0)
    h = now.surface[row.inner]
    some = np.linspace(0.06, 0.19, 53)
    flows = [steady(replace(c, g_x=0.0, depth=one, drive=Drive.DISCHARGE, discharge=q))[0] for one in some]
    friction = np.array([one.gradient for one in flows]) / c.rho_w / row.g_z
    beta = np.array([float(one.content @ one.u**2) * one.z_surface / q**2 for one in flows])
    slope_of, beta_of = CubicSpline(some, friction), CubicSpline(some, beta)

    def rise(_: float, depth: Floats) -> Floats:
        froude = q * q / (row.g_z * depth**3)
        below = 1.0 - froude * (beta_of(depth) - depth * beta_of(depth, 1))
        return (c.g_x / row.g_z - slope_of(depth)) / below

    part = slice(12, 168)  # from 0.5 m to 0.3 m before the dam
    x = row.x[part][::-1]
    exact = solve_ivp(rise, (x[0], x[-1]), [h[part][-1]], t_eval=x, rtol=1e-9, atol=1e-10).y[0][::-1]
    return {"x": x[::-1], "h": h[part], "exact": exact}


def dupuit(x: Floats) -> Floats:
    """Dupuit's parabola in the porous dam [m]."""
    part = np.clip(x / DAM_LONG, 0.0, 1.0)
    return np.sqrt(DAM_HIGH**2 - (DAM_HIGH**2 - DAM_LOW**2) * part)


def stoker(ahead: float) -> tuple[float, float, float]:
    """Depth [m] and speed [m/s] of the plateau of a dam break over water, and speed of its front [m/s]."""
    c, low, high = math.sqrt(G * HIGH), ahead, HIGH
    h, behind = HIGH, 0.0
    for _ in range(200):
        h = 0.5 * (low + high)
        behind = 2.0 * (c - math.sqrt(G * h))
        if behind > (h - ahead) * math.sqrt(G * (h + ahead) / (2.0 * h * ahead)):
            low = h
        else:
            high = h
    return h, behind, behind * h / (h - ahead)


def _break(ahead: float, mm: int, levels: int) -> Task:
    return calculation(dam_break, ahead=ahead, mm=mm, levels=levels, seconds=3.0)


def _uniform(slope: str) -> Task:
    return calculation(uniform, slope=slope, seconds=8.0)


def _seepage(across: int, inertia: bool) -> Task:
    return calculation(seepage, across=across, inertia=inertia, seconds=5.0)


def _weir(crest: int) -> Task:
    return calculation(weir, crest=crest, seconds=8.0)


def _backwater() -> Task:
    return calculation(backwater, seconds=12.0)


STOKERS = {"0.02 m": (0.02, 1), "0.002 m": (0.002, 1), "0.02 m, 20 levels": (0.02, 20)}


def tasks(plan: Plan) -> Sequence[Task]:
    """All of them; the two comparisons that the row misses are left to the standard level."""
    every = [*basics.tasks(plan), *(_break(0.0, mm, 1) for mm in SEGMENTS)]
    every += [_break(ahead, 10, levels) for ahead, levels in (STOKERS[name] for name in _stokers(plan))]
    every += [_uniform(slope) for slope in SLOPES]
    every += [_seepage(across, inertia) for across in ACROSS for inertia in (False, True)]
    every += [
        _backwater(),
        impact.alone(),
        *energy.tasks(),
        *with_grains.tasks(plan),
        *delta.tasks(plan),
        *exner.tasks(plan),
    ]
    every += [*dam.tasks(plan), *overload.tasks(plan), *over_bed.tasks(plan), *feeder.tasks(plan)]
    return [*every, *(_weir(crest) for crest in (0, *_crests(plan)))]


def _stokers(plan: Plan) -> list[str]:
    """Names of the dam breaks; when quick without the one that misses its band, whose levels do not mix."""
    return [name for name, (_, levels) in STOKERS.items() if levels == 1 or plan.level is not Level.QUICK]


def _crests(plan: Plan) -> tuple[int, ...]:
    """Lengths of the crests of weirs; without that of one segment, which misses its band, when quick.

    The quick level fails where anything lies outside its band, so that a change shows; both misses are in the
    ledger of the standard level.
    """
    return CRESTS[1:] if plan.level is Level.QUICK else CRESTS


def measure(run: Results, one: CaseRun) -> dict[str, Floats]:
    """Of the runs with grains."""
    if one.case == exner.CASE:
        return exner.measure(run, one)
    if one.case in dam.CASES:
        return dam.measure(run, one)
    if one.case == overload.CASE:
        return overload.measure(run, one)
    return (delta if one.case in delta.CASES else with_grains).measure(run, one)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Each flow beside its closed form."""
    stokers = [_stoker(found, name) for name in _stokers(plan)]
    uniforms = [_uniform_flow(found, slope) for slope in SLOPES]
    seepages = [_darcy(found), _ergun(found)]
    return [
        *basics.judge(found, plan),
        _ritter(found),
        *stokers,
        *uniforms,
        _m1(found),
        impact.of_bore(found),
        *energy.judge(found),
        *seepages,
        _weirs(found, _crests(plan)),
        *with_grains.judge(found, plan),
        *delta.judge(found, plan),
        *exner.judge(found, plan),
        *dam.judge(found, plan),
        *overload.judge(found, plan),
        *over_bed.judge(found, plan),
        *feeder.judge(found, plan),
    ]


def _ritter(found: Found) -> Finding:
    ours, errors = list[Curve](), dict[int, float]()
    for mm in SEGMENTS:
        got = found[_break(0.0, mm, 1)]
        errors[mm] = float(np.abs(got["h"] - ritter(got["x"], BREAK_TIME, HIGH)).mean() / HIGH)
        ours.append(Curve(f"segments of {mm} mm", got["x"], got["h"]))
    fine = found[_break(0.0, 5, 1)]
    front = fine["x"][fine["h"] > 0.01 * HIGH].max() / (1.7 * math.sqrt(G * HIGH) * BREAK_TIME) - 1.0
    x = np.linspace(-1.0, 1.5, 200)
    return DECLARED["ritter"].finding(
        ours, [Curve("closed form", x, ritter(x, BREAK_TIME, HIGH))],
        {"depth": errors, "front": abs(float(front))},
    )  # fmt: skip


def _stoker(found: Found, name: str) -> Finding:
    ahead, levels = STOKERS[name]
    got, (h, u, front) = found[_break(ahead, 10, levels)], stoker(ahead)
    start, end = (u - math.sqrt(G * h)) * BREAK_TIME, front * BREAK_TIME
    flat = (got["x"] > start + 0.3 * (end - start)) & (got["x"] < start + 0.7 * (end - start))
    depth = float(got["h"][flat].mean())
    between = 0.5 * (got["h"] + np.append(got["h"][1:], got["h"][-1]))
    speed = float((got["q"] / between)[flat].mean())
    i = int(np.flatnonzero(got["h"] > 0.5 * (h + ahead)).max())
    place = float(got["x"][i] + 0.01 * (got["h"][i] - 0.5 * (h + ahead)) / (got["h"][i] - got["h"][i + 1]))
    off = {"front": abs(place - end)} if levels == 1 else {"front-levels": abs(place / end - 1.0)}
    exact = Curve("closed form", np.array([start, end, end]), np.array([h, h, ahead]))
    kind = DECLARED["stoker-{ahead}-{levels}"]
    return kind.finding(
        [Curve("row", got["x"], got["h"])], [exact],
        [
            kind.trial("depth", abs(depth / h - 1.0), name), kind.trial("speed", abs(speed / u - 1.0), name),
            *(kind.trial(*one) for one in off.items()),
        ],
        ahead=f"{ahead:g}".replace(".", "-"), levels=levels, name=name,
        said="" if levels == 1 else "Levels that do not mix are not one layer: upper ones run ahead.",
    )  # fmt: skip


def _uniform_flow(found: Found, slope: str) -> Finding:
    got, kind = found[_uniform(slope)], DECLARED["uniform-{name}"]
    off = float(np.abs(got["u"] - got["exact"]).max() / got["exact"][-1])
    return kind.finding(
        [Curve("row", got["z"], got["u"])], [Curve("column", got["z"], got["exact"])],
        [kind.trial("profile", off, slope), kind.trial("discharge", abs(float(got["q"]) - 1.0), slope)],
        name=slope.replace(".", "-"), slope=slope,
    )  # fmt: skip


def _m1(found: Found) -> Finding:
    got = found[_backwater()]
    off = float(np.abs(got["h"] - got["exact"]).max())
    return DECLARED["backwater"].finding(
        [Curve("row", got["x"], got["h"])], [Curve("gradually varied flow", got["x"], got["exact"])],
        {"difference": off},
    )  # fmt: skip


def _darcy(found: Found) -> Finding:
    conductivity = G * (1.0 - DAM_PHI) ** 3 * 1.5e-3**2 / (150.0 * 1e-6 * DAM_PHI**2)
    exact = conductivity * (DAM_HIGH**2 - DAM_LOW**2) / (2.0 * DAM_LONG)
    ours, errors = list[Curve](), []
    for across in ACROSS:
        got = found[_seepage(across, False)]
        off = float(np.abs(got["h"] - dupuit(got["x"])).max() / DAM_HIGH)
        errors.append(DECLARED["darcy"].trial("discharge", abs(float(got["q"]) / exact - 1.0), across))
        errors.append(DECLARED["darcy"].trial("surface", off, across))
        ours.append(Curve(f"{across} segments", got["x"], got["h"]))
    x = np.linspace(0.0, DAM_LONG, 200)
    return DECLARED["darcy"].finding(ours, [Curve("Dupuit", x, dupuit(x))], errors)


def _ergun(found: Found) -> Finding:
    eps, d = 1.0 - DAM_PHI, 4e-3
    one = 150.0 * 1e-6 * DAM_PHI**2 / (eps**3 * d * d) / G
    two = 1.75 * DAM_PHI / (eps**3 * d) / G
    h, low, high = np.linspace(DAM_LOW, DAM_HIGH, 4001), 1e-6, 1.0
    q = high
    for _ in range(200):
        q = math.sqrt(low * high)
        reach = float(np.trapezoid(1.0 / (one * q / h + two * (q / h) ** 2), h))
        low, high = (q, high) if reach > DAM_LONG else (low, q)
    q_of = np.array([float(found[_seepage(across, True)]["q"]) for across in ACROSS])
    n = np.array(ACROSS, dtype=np.float64)
    return DECLARED["ergun"].finding(
        [Curve("row", n, q_of)], [Curve("integral", n, np.full(3, q))],
        {
            "discharge": {
                across: abs(float(each) / q - 1.0) for across, each in zip(ACROSS, q_of, strict=True)
            },
        },
    )  # fmt: skip


def _weirs(found: Found, crests: Sequence[int]) -> Finding:
    critical = (2.0 / 3.0) ** 1.5
    got = np.array([float(found[_weir(crest)]["c"]) for crest in (0, *crests)])
    off = np.abs(got / critical - 1.0)
    n = np.array(crests, dtype=np.float64)
    return DECLARED["weir"].finding(
        [Curve("row", n, got[1:])], [Curve("critical", n, np.full(len(n), critical))],
        {"drop": float(off[0]), "crest": dict(zip(crests, off[1:].tolist(), strict=True))},
    )  # fmt: skip
