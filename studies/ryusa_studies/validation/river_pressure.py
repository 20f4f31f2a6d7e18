"""A row of columns with a pressure of its own, water alone: waves, beds, sills, jumps, nappes (design/0030).

The limits are twice the errors of a throw-away prototype of the same equations, unless their reason says
otherwise; they were written down before the package had a pressure, those of the jump before its first run.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.laws.families import Pressure, SurfaceRule
from ryusa.model.arrays import Floats
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowEnd
from ryusa.study import Finding, Found, Level, Plan, Task, calculation
from ryusa.water.row import RowArrays, advance_row, row_at_rest
from ryusa_studies.validation import river_bar as over_bar
from ryusa_studies.validation import river_jump as jump
from ryusa_studies.validation import river_shear_layers as shear_layers
from ryusa_studies.validation import river_sill as sill
from ryusa_studies.validation.declared import declared

TITLE = "Pressure along a row"
DECLARED = declared(__file__)
G = 9.80665
WALLS = RowEnd(EndKind.WALL), RowEnd(EndKind.WALL)
BOTH = (Pressure.FULL.word, Pressure.HYDROSTATIC.word)
FULL, HYDROSTATIC = BOTH
DEPTH = 0.1  # of waves [m]
LENGTHS = (0.5, 1.0, 3.0)  # of standing waves: wave number times depth
ANTIDUNE = 1.31  # Froude number of the flow over a wavy bed
OVER_WAVES = (0.5, 1.0, 2.0)
IN_BED = (1.0, 3.0)  # depth of a porous bed times the wave number


def water(dz: float, n: int, depth: float, **more: object) -> Column:
    """Water without friction, unless `more` says so."""
    given = {"z_low": 0.0, "dz": dz, "n": n, "depth": depth, "nu": 1e-15, **more}
    return Column(surface=SurfaceRule.VOLUME, **given)  # pyright: ignore[reportArgumentType]


def standing(kh: float, levels: int, pressure: str) -> dict[str, Floats]:
    """Frequency of a small standing wave over sqrt(g k tanh kh)."""
    n, k, dz = 40, kh / DEPTH, DEPTH / (levels - 0.5)
    row = ColumnRow(
        water(dz, levels + 3, DEPTH), math.pi / k / n, np.zeros(n), G, *WALLS, pressure=Pressure.of(pressure)
    )
    high = min(1e-3 * DEPTH, 0.2 * dz)
    now, arrays = row_at_rest(row, DEPTH + high * np.cos(k * row.x)), RowArrays.of(row)
    period = 2.0 * math.pi / math.sqrt(G * k * math.tanh(kh))
    t, height = np.zeros((2, 300))
    for one in range(300):
        now = advance_row(row, now, period / 200, longest=0.25 * row.dx / math.sqrt(G * DEPTH), arrays=arrays)
        t[one], height[one] = now.t, (now.surface[row.inner] - DEPTH) @ np.cos(k * row.x)
    at = np.flatnonzero(height[:-1] * height[1:] < 0.0)
    crosses = t[at] - height[at] * np.diff(t)[at] / np.diff(height)[at]
    return {"ratio": np.array(period / (2.0 * (crosses[-1] - crosses[0]) / (len(crosses) - 1)))}


def grimshaw(eps: float, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Height over depth, (n,), and speed over sqrt(g h), (n, m), of a solitary wave to third order.

    x and y are distance from the crest and height over the bottom, over the depth. Grimshaw 1971.
    """
    wide = math.sqrt(0.75 * eps) * (1.0 - 5.0 / 8.0 * eps + 71.0 / 128.0 * eps**2)
    s = 1.0 / np.cosh(wide * x) ** 2
    t = 1.0 - s
    rise = eps * s - 0.75 * eps**2 * s * t + eps**3 * (5.0 / 8.0 * s * t - 101.0 / 80.0 * s**2 * t)
    s, y = s[:, None], y[None, :]
    second = -s / 4.0 + s**2 + y**2 * (1.5 * s - 2.25 * s**2)
    third = 19.0 / 40.0 * s + s**2 / 5.0 - 1.2 * s**3 + y**2 * (-1.5 * s - 3.75 * s**2 + 7.5 * s**3)
    third = third + y**4 * (-3.0 / 8.0 * s + 45.0 / 16.0 * (s**2 - s**3))
    return rise, eps * s - eps**2 * second - eps**3 * third


def celerity(eps: float) -> float:
    """Speed of a solitary wave over sqrt(g h), to third order."""
    return math.sqrt(1.0 + eps - eps**2 / 20.0 - 3.0 * eps**3 / 70.0)


def solitary(eps: float = 0.2, levels: int = 10) -> dict[str, Floats]:
    """Height over depth and place [m] of a solitary wave after each depth of way, 60 of them."""
    h, dx, n = DEPTH, DEPTH / 10.0, 900
    dz, c = h / (levels - 0.5), celerity(eps) * math.sqrt(G * h)
    row = ColumnRow(water(dz, levels + 6, h), dx, np.zeros(n), G, *WALLS, pressure=Pressure.FULL)
    within = [
        grimshaw(eps, (row.x + dx * one) / h - 15.0, np.zeros(1))[0] for one in np.linspace(-0.5, 0.5, 9)
    ]
    rise: Floats = np.array(within).mean(axis=0) * h  # of segments
    at, u = grimshaw(eps, row.x_station / h - 15.0, row.column.z / h)
    start = row_at_rest(row, h + rise)
    left, right = row.stations_between
    flow = (0.5 * (start.content[left] + start.content[right]) * u).sum(axis=1)
    u = u * np.where(flow > 1e-12, c * at * h / np.where(flow > 1e-12, flow, 1.0), 0.0)[:, None]
    u[0] = u[-1] = 0.0
    w = np.zeros((n + 2, row.column.n + 1))
    for k in range(row.column.n):
        w[1:-1, k + 1] = w[1:-1, k] - np.diff(u[:, k]) / dx * np.clip(h + rise - k * dz, 0.0, dz)
    now, arrays = replace(start, u=u, w=w), RowArrays.of(row)
    height, place = np.zeros((2, 60))
    for one in range(60):
        now = advance_row(row, now, h / c, longest=0.2 * dx / c, arrays=arrays)
        surface = np.array(now.surface[row.inner] - h)
        i = int(surface.argmax())
        before, here, after = surface[i - 1 : i + 2]
        shift = 0.5 * (before - after) / (before - 2.0 * here + after)
        height[one], place[one] = (here - 0.25 * (before - after) * shift) / h, row.x[i] + shift * dx
    return {"t": np.linspace(h, 60.0 * h, 60) / c, "height": height, "place": place}


def wavy(kh: float, pressure: str, levels: int = 20) -> dict[str, Floats]:
    """Supercritical flow over a wavy bed: surface and bottom [m], and their amplitudes over one wave."""
    h, waves, per = 0.05, 6, 24
    k = kh / h
    long, count = 2.0 * math.pi / k, per * (waves + 2)
    x = (np.arange(count) + 0.5) * long / per - long
    ramp = np.clip(x / long, 0.0, 1.0) * np.clip((waves * long - x) / long, 0.0, 1.0)
    bottom, speed = 0.02 * h * np.sin(k * x) * ramp, ANTIDUNE * math.sqrt(G * h)
    ends = RowEnd(EndKind.DISCHARGE, discharge=speed * h, depth=h), RowEnd(EndKind.UNIFORM)
    row = ColumnRow(
        water(h / (levels - 0.5), levels + 6, h),
        long / per,
        bottom,
        G,
        *ends,
        x_low=-long,
        pressure=Pressure.of(pressure),
    )
    start = row_at_rest(row, h + bottom)
    now = advance_row(
        row, replace(start, u=np.full_like(start.u, speed)), 1.5 * count * row.dx / (speed - math.sqrt(G * h))
    )
    inside = (x > (waves / 2 - 1) * long) & (x < (waves / 2) * long)
    rise = now.surface[row.inner] - h + bottom

    def amplitude(values: Floats) -> complex:
        return complex((values[inside] * np.exp(-1j * k * x[inside])).sum()) * 2.0 / inside.sum()

    ratio = amplitude(rise - rise[inside].mean()) / amplitude(bottom)
    return {
        "x": x, "surface": rise / h, "bottom": bottom / h, "ratio": np.array(abs(ratio)),
        "phase": np.array(math.degrees(np.angle(ratio))),
    }  # fmt: skip


def kennedy(kh: float) -> float:
    """Height of the surface over that of a wavy bed in potential flow (Kennedy 1963), at ANTIDUNE."""
    return 1.0 / (math.cosh(kh) - math.sinh(kh) / (ANTIDUNE**2 * kh))


def pore(kd: float, pressure: str = FULL) -> dict[str, Floats]:
    """Pressure in a porous bed under a crest of a standing wave, kh 1, over that at its top."""
    n, k = 40, 1.0 / DEPTH
    deep = kd / k
    cells = round(deep / (DEPTH / (19.5 if kd < 1.5 else 12.5)))
    dz = deep / cells
    c = water(dz, cells + int(DEPTH / dz) + 5, deep + DEPTH, nu=1e-6)
    solid = PorousSolid.of_grains(
        np.where(c.z < deep, 0.6, 0.0) * np.ones((n, 1)), 0.001, 1e-6, inertia=False
    )
    row = ColumnRow(c, math.pi / k / n, np.zeros(n), G, *WALLS, pressure=Pressure.of(pressure))
    start = row_at_rest(row, deep + DEPTH + 0.15 * dz * np.cos(k * row.x), solid)
    period = 2.0 * math.pi / math.sqrt(G * k * math.tanh(1.0))
    now = advance_row(row, start, period, longest=period / 200, solid=solid)
    own = np.zeros(cells) if now.pressure is None else now.pressure[1, :cells]
    whole, z = G * (now.surface[1] - deep - DEPTH) + own, c.z[:cells]
    return {"z": z / deep, "p": whole / whole[-1], "exact": np.cosh(k * z) / np.cosh(k * z[-1])}


def plate(pressure: str, high: float = 0.08, head: float = 0.06) -> dict[str, Floats]:
    """A thin plate at the end of a row, air behind it: q/(sqrt(g) H**1.5), and that by Rehbock's formula."""
    dx, dz, before = 0.01, 0.005, 100
    q = 0.5 * math.sqrt(G) * head**1.5
    solid = np.where(np.arange(before + 1) < before, 0, round(high / dz))
    ends = RowEnd(EndKind.DISCHARGE, discharge=q), RowEnd(EndKind.FREE_FALL)
    row = ColumnRow(
        water(dz, 40, high + head),
        dx,
        np.zeros(before + 1),
        G,
        *ends,
        solid=solid,
        pressure=Pressure.of(pressure),
    )
    now = advance_row(row, row_at_rest(row, np.where(solid > 0, high + 0.7 * head, high + head)), 10.0)
    there = now.surface[row.inner][before - 25]
    over = there - high
    energy = over + (q / there) ** 2 / (2.0 * G)
    rehbock = 2.0 / 3.0 * math.sqrt(2.0) * (0.602 + 0.083 * over / high) * ((over + 0.0011) / energy) ** 1.5
    return {
        "x": row.x, "surface": now.surface[row.inner], "c": np.array(q / (math.sqrt(G) * energy**1.5)),
        "rehbock": np.array(rehbock),
    }  # fmt: skip


def brink(pressure: str) -> dict[str, Floats]:
    """Free overfall of a flow of Froude number 0.6: depth over critical depth along the last of the row."""
    h, dx, levels = 0.05, 0.005, 25
    q = 0.6 * math.sqrt(G * h) * h
    critical = (q * q / G) ** (1.0 / 3.0)
    ends = RowEnd(EndKind.DISCHARGE, discharge=q), RowEnd(EndKind.FREE_FALL)
    row = ColumnRow(
        water(h / (levels - 0.5), levels + 5, h), dx, np.zeros(160), G, *ends, pressure=Pressure.of(pressure)
    )
    start = row_at_rest(row, np.full(160, 1.05 * critical))
    now = advance_row(row, replace(start, u=np.full_like(start.u, q / (1.05 * critical))), 6.0)
    depth = now.surface[row.inner] / critical
    last = 1.5 * depth[-1] - 0.5 * depth[-2]
    return {"x": (row.x - 0.8) / critical, "depth": depth, "brink": np.array(last)}


# Front of a column 57 mm wide and twice as high: t sqrt(2 g/a), x/a (Martin & Moyce 1952, table 2)
FRONT_T = (0.41, 0.84, 1.19, 1.43, 1.63, 1.83, 1.98, 2.20, 2.32, 2.51, 2.65, 2.83, 2.97, 3.11)
FRONT_X = (1.11, 1.22, 1.44, 1.67, 1.89, 2.11, 2.33, 2.56, 2.78, 3.00, 3.22, 3.44, 3.67, 3.89)


def collapse(pressure: str) -> dict[str, Floats]:
    """Place of the front of a collapsing column over its width at the times of FRONT_T."""
    a, per, levels = 0.05715, 20, 20
    dx, dz = a / per, 2.0 * a / levels
    row = ColumnRow(
        water(dz, levels + 6, 2.0 * a, nu=1e-6),
        dx,
        np.zeros(6 * per),
        G,
        *WALLS,
        pressure=Pressure.of(pressure),
    )
    now, found = row_at_rest(row, np.where(row.x < a, 2.0 * a, 0.0)), list[float]()
    for t in np.array(FRONT_T) * math.sqrt(a / (2.0 * G)):
        now = advance_row(row, now, float(t) - now.t)
        wet = np.flatnonzero(now.surface[row.inner] > 0.02 * a)
        found.append(float(row.x[wet[-1]] + 0.5 * dx) / a)
    return {"x": np.array(found)}


def _waves() -> list[Task]:
    return [
        calculation(standing, kh=kh, levels=10, pressure=one, seconds=0.5) for kh in LENGTHS for one in BOTH
    ]


def _alone() -> Task:
    return calculation(solitary, seconds=10.0)


def _lengths(plan: Plan) -> tuple[float, ...]:
    """Wave numbers times depth over a wavy bed; one when quick."""
    return plan.pick(OVER_WAVES[1:2], OVER_WAVES)


def _over_waves(plan: Plan) -> list[Task]:
    return [calculation(wavy, kh=kh, pressure=FULL, seconds=4.0) for kh in _lengths(plan)]


def _in_beds() -> list[Task]:
    return [calculation(pore, kd=kd, seconds=0.5) for kd in IN_BED]


def _of_both(function: object) -> list[Task]:
    return [calculation(function, pressure=one, seconds=2.0) for one in BOTH]


def tasks(plan: Plan) -> Sequence[Task]:
    """Twelve minutes with jumps and sills; when quick without what takes longest, or misses its limit."""
    every = [*_waves(), *_over_waves(plan), *_in_beds(), *_of_both(plate), *_of_both(brink)]
    if plan.level is Level.QUICK:
        return every
    return [
        *every,
        _alone(),
        *_of_both(collapse),
        *jump.tasks(),
        *sill.tasks(),
        *shear_layers.tasks(),
        *over_bar.tasks(),
    ]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Each beside what theory or experiment has."""
    every = [_standing(found), _wavy(found, plan), _pore(found), _plate(found), _brink(found)]
    if plan.level is Level.QUICK:
        return every
    return [
        *every,
        _solitary(found),
        _collapse(found),
        *jump.judge(found),
        *sill.judge(found),
        *shear_layers.judge(found),
        *over_bar.judge(found),
    ]


def _standing(found: Found) -> Finding:
    ratios = np.array([float(found[one]["ratio"]) for one in _waves()]).reshape(len(LENGTHS), 2)
    kh = np.array(LENGTHS)
    return DECLARED["waves"].finding(
        [Curve(word, kh, ratios[:, n]) for n, word in enumerate(BOTH)],
        [Curve("theory", kh, np.ones(len(kh)))],
        {"kh": {f"{one:g}": abs(ratios[n, 0] - 1.0) for n, one in enumerate(LENGTHS)}},
    )  # fmt: skip


def _solitary(found: Found) -> Finding:
    run = found[_alone()]
    early, late = float(run["height"][7:12].mean()), float(run["height"][-5:].mean())
    mean = float(run["height"][9:].mean())
    speed = float(np.polyfit(run["t"][9:], run["place"][9:], 1)[0])
    theory = celerity(mean) * math.sqrt(G * DEPTH)
    return DECLARED["solitary"].finding(
        [Curve("row", run["t"], run["height"])],
        [Curve("at ten depths", run["t"], np.full(len(run["t"]), early))],
        {"height": abs(late / early - 1.0), "speed": abs(speed / theory - 1.0)},
    )  # fmt: skip


def _wavy(found: Found, plan: Plan) -> Finding:
    lengths, runs = _lengths(plan), [found[one] for one in _over_waves(plan)]
    kh = np.linspace(0.4, 2.2, 50)
    return DECLARED["wavy"].finding(
        [Curve("row", np.array(lengths), np.array([float(run["ratio"]) for run in runs]))],
        [Curve("potential flow", kh, np.array([kennedy(one) for one in kh]))],
        {
            "kh": {
                f"{one:g}": abs(float(run["ratio"]) / kennedy(one) - 1.0)
                for one, run in zip(lengths, runs, strict=True)
            },
        },
    )  # fmt: skip


def _pore(found: Found) -> Finding:
    runs = [found[one] for one in _in_beds()]
    return DECLARED["pore-waves"].finding(
        [Curve(f"row, kD {kd:g}", run["p"], run["z"]) for kd, run in zip(IN_BED, runs, strict=True)],
        [Curve(f"theory, kD {kd:g}", run["exact"], run["z"]) for kd, run in zip(IN_BED, runs, strict=True)],
        {
            "kd": {
                f"{kd:g}": float(np.abs(run["p"] - run["exact"]).max())
                for kd, run in zip(IN_BED, runs, strict=True)
            },
        },
    )  # fmt: skip


def _plate(found: Found) -> Finding:
    own, still = (found[one] for one in _of_both(plate))
    off = abs(float(own["c"]) / float(own["rehbock"]) - 1.0)
    return DECLARED["plate"].finding(
        [Curve(word, run["x"], run["surface"]) for word, run in zip(BOTH, (own, still), strict=True)], [],
        {"rehbock": off}, c=float(own["c"]), still=float(still["c"]), rehbock=float(own["rehbock"]),
    )  # fmt: skip


def _brink(found: Found) -> Finding:
    own, still = (found[one] for one in _of_both(brink))
    return DECLARED["brink"].finding(
        [Curve(word, run["x"], run["depth"]) for word, run in zip(BOTH, (own, still), strict=True)],
        [Curve("measured at the brink", np.zeros(1), np.array([0.715]))],
        {"brink": abs(float(own["brink"]) - 0.715)},
    )  # fmt: skip


def _collapse(found: Found) -> Finding:
    own, still = (found[one]["x"] for one in _of_both(collapse))
    measured = np.array(FRONT_X)
    t, off = np.array(FRONT_T), float(np.sqrt(((own - measured) ** 2).mean()))
    return DECLARED["front"].finding(
        [Curve(FULL, t, own), Curve(HYDROSTATIC, t, still)], [Curve("measured", t, measured)], {"rms": off},
    )  # fmt: skip
