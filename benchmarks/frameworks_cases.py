"""Three bulk processes of Dosta et al. 2024: materials, walls, first grains, forms, what is measured.

Numbers are those of the paper as its codes have them: the scripts of YADE (examples/DEM2020Benchmark) and of
MercuryDPM (Drivers/Papers/DEMBenchmark, BSD: geometry, and restitution and friction of steel on steel). Their
packings are not at hand: grains fall from a lattice into the walls and come to rest (`settled`), and every
code reads the same file.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from walls import square

from ryusa.build import scene
from ryusa.build.walls import disc, triangles
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import ContactTiming
from ryusa.model.scene import EventRule

Floats = NDArray[np.float64]
MATERIALS = ("M1", "M2", "steel")
YOUNG, NU, DENSITY = (1.0e9, 0.5e9, 210.0e9), 0.2, (2500.0, 2000.0, 7200.0)  # [Pa], [-], [kg/m3]
RESTITUTION = ((0.5, 0.45, 0.4), (0.45, 0.4, 0.4), (0.4, 0.4, 0.6))
FRICTION = ((0.3, 0.2, 0.2), (0.2, 0.4, 0.2), (0.2, 0.2, 0.5))
G = 9.81  # [m/s2]
SEGMENTS = 64  # of a circle


@dataclass(frozen=True)
class Bulk:
    """One case in one form.

    Attributes
    ----------
    kinds : material, diameter [m] and number of grains, in the order in which they are laid.
    soft : by what all Young's moduli are divided.
    radius, length : of silo and drum [m]; half the sides of the box in x and y.
    opening : radius of the opening of the silo [m].
    spin : of the drum about y [rad/s].
    time, frame : simulated, and between two frames [s].
    dt : step of the paper over sqrt(1/soft) [s]; `own` is the usual one of each code.
    """

    name: str
    kinds: tuple[tuple[str, float, int], ...]
    soft: float
    radius: float
    length: float
    time: float
    frame: float
    dt: float
    own: dict[str, float]
    opening: float = 0.0
    spin: float = 0.0
    ball: float = 0.0  # diameter [m]
    speed: float = 0.0  # of the ball, downwards [m/s]
    above: float | None = None  # height of its centre over the floor at the start [m]; just over the bed

    @property
    def n(self) -> int:
        """Grains, the ball among them."""
        return sum(n for _, _, n in self.kinds) + (self.ball > 0.0)

    def mesh(self) -> Floats:
        """Corners of the triangles of the walls, (n, 3, 3) [m]."""
        turn = 2.0 * np.pi * np.arange(SEGMENTS + 1) / SEGMENTS
        around = np.stack([np.cos(turn), np.sin(turn)], axis=1)
        r, h = self.radius, self.length
        if self.name == "silo":
            cone = r - self.opening  # 45 deg
            return np.concatenate(
                [_shell(around, self.opening, 0.0, r, cone, 3), _shell(around, r, cone, r, cone + h, 6)]
            )
        if self.name == "drum":
            shell = _shell(around, r, -h / 2.0, r, h / 2.0, 4)
            ends = [_shell(around, 0.0, z, r, z, 3) for z in (-h / 2.0, h / 2.0)]
            turned = np.concatenate([shell, *ends])[..., [0, 2, 1]]
            return turned[np.linalg.norm(np.cross(*_sides(turned)), axis=1) > 1e-12]
        o, x, y, z = np.array([-r, -h, 0.0]), *np.diag([2.0 * r, 2.0 * h, 10.0 * self.ball])
        sides = ((o, x, y), (o, x, z), (o, y, z), (o + x, y, z), (o + y, x, z))
        return np.concatenate([square(4, *one) for one in sides])


def _sides(corners: Floats) -> tuple[Floats, Floats]:
    return corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]


def _shell(around: Floats, r_0: float, z_0: float, r_1: float, z_1: float, rows: int) -> Floats:
    """Triangles between two circles about z."""
    share = np.linspace(0.0, 1.0, rows + 1)[:, None, None]
    r = r_0 + share * (r_1 - r_0)
    z = np.broadcast_to(z_0 + share * (z_1 - z_0), (rows + 1, len(around), 1))
    p = np.concatenate([r * around, z], axis=2)
    a, b, c, e = p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]
    return np.concatenate([np.stack([a, c, b], axis=2), np.stack([a, e, c], axis=2)]).reshape(-1, 3, 3)


def _own(yade: float, liggghts: float, ryusa: float) -> dict[str, float]:
    return {"YADE": yade, "LIGGGHTS": liggghts, "ryusa": ryusa}


def forms() -> dict[str, dict[str, Bulk]]:
    """Cases by form and name.

    `short` has a tenth of the grains, and less. Its silo keeps the opening of 15 diameters and is 30
    diameters wide; its drum is smaller by 0.368 at the same Froude number and makes half a turn; its ball has
    4 diameters of a grain, and is slower. Silo and drum are softer by a hundred. Usual steps: 0.8 of YADE's
    PWaveTimeStep, 0.2 of the Rayleigh time in LIGGGHTS, 25 steps in the shortest contact in ryusa at the
    `expected_speed` of the case files. `full` are the cases of the paper; `soft` is its silo with softer
    grains, and its deepest bed, for what can be had of it in hours.
    """
    kilo = 1000
    return {
        "short": {
            "silo": Bulk("silo", (("M1", 4e-3, 10 * kilo),), 100.0, 0.06, 0.15, 0.6, 5e-3, 1.5e-5,
                         _own(2.5e-5, 3.4e-5, 1.45e-5), opening=0.03),
            "drum": Bulk("drum", (("M2", 4e-3, 400), ("M1", 2e-3, 1500)), 100.0, 0.0368, 0.0221, 0.96,
                         0.02, 8e-6, _own(1.25e-5, 1.7e-5, 8.3e-6), spin=2.0 / 0.368**0.5),
            "impact": Bulk("impact", (("M1", 2e-3, 4 * kilo),), 1.0, 0.0196, 0.012, 0.04, 5e-4, 5e-7,
                           _own(1.25e-6, 1.7e-6, 6.9e-7), ball=8e-3, speed=2.0),
        },
        "full": {
            "silo": Bulk("silo", (("M1", 4e-3, 100 * kilo),), 1.0, 0.1, 0.3, 5.0, 0.1, 1.5e-6,
                         _own(2.5e-6, 3.4e-6, 2.3e-6), opening=0.03),
            "drum": Bulk("drum", (("M2", 4e-3, 8 * kilo), ("M1", 2e-3, 30 * kilo)), 1.0, 0.1, 0.06, 5.0, 0.1,
                         8e-7, _own(1.25e-6, 1.7e-6, 1.32e-6), spin=2.0),
            "impact": Bulk("impact", (("M1", 2e-3, 25 * kilo),), 1.0, 0.049, 0.03, 0.1, 1e-3, 5e-7,
                           _own(1.25e-6, 1.7e-6, 6.9e-7), ball=0.02, speed=5.0, above=0.1502431),
        },
        "soft": {
            "silo": Bulk("silo", (("M1", 4e-3, 100 * kilo),), 100.0, 0.1, 0.3, 5.0, 0.05, 1.5e-5,
                         _own(2.5e-5, 3.4e-5, 1.45e-5), opening=0.03),
            "impact": Bulk("impact", (("M1", 2e-3, 100 * kilo),), 1.0, 0.049, 0.03, 0.06, 1e-3, 5e-7,
                           _own(1.25e-6, 1.7e-6, 6.9e-7), ball=0.02, speed=5.0, above=0.1502431),
        },
    }  # fmt: skip


def _lattice(bulk: Bulk, seed: int) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Centres, diameters and materials of loose grains inside the walls, the lowest first."""
    rng, parts, low = np.random.default_rng(seed), [], -np.inf
    flat = np.cos(np.pi / SEGMENTS)  # the middle of a chord lies this much nearer to the axis
    for name, d, n in bulk.kinds:
        pitch, tall = 1.07 * d, 4.0 * max(bulk.radius, bulk.length)
        wide = np.arange(-bulk.radius, bulk.radius + pitch, pitch)
        deep = np.arange(-bulk.length if bulk.name == "drum" else -bulk.radius, bulk.radius + pitch, pitch)
        up = np.arange(-bulk.radius, tall, pitch)
        p = np.stack(np.meshgrid(up, wide, deep, indexing="ij"), axis=-1).reshape(-1, 3)[:, [1, 2, 0]]
        p = p + rng.uniform(-0.03, 0.03, p.shape) * d
        x, y, z = p.T
        r = 0.52 * d
        if bulk.name == "silo":
            wall = np.minimum(bulk.radius * flat, bulk.opening * flat + z * flat - 0.42 * r)
            inside = (np.hypot(x, y) < wall - r) & (z > r)
        elif bulk.name == "drum":
            inside = (np.hypot(x, z) < bulk.radius * flat - r) & (np.abs(y) < bulk.length / 2.0 - r)
        else:
            inside = (np.abs(x) < bulk.radius - r) & (np.abs(y) < bulk.length - r) & (z > r)
        p = p[inside & (z > low + r)]
        if len(p) < n:
            raise SystemExit(f"{bulk.name}: {len(p)} of {n} grains of {name} fit in")
        parts.append((p[np.argsort(p[:, 2], kind="stable")[:n]], d, MATERIALS.index(name)))
        low = float(parts[-1][0][:, 2].max()) + 0.5 * d
    x = np.concatenate([p for p, _, _ in parts])
    d = np.concatenate([np.full(len(p), one) for p, one, _ in parts])
    return x, d, np.concatenate([np.full(len(p), one) for p, _, one in parts])


def settled(bulk: Bulk, seed: int, folder: Path, threads: int = 2) -> Path:
    """Grains of a case at rest in its walls, and the ball above them, as arrays; made once.

    They settle under linear springs, a little larger than they are, so that none is pressed into another.
    """
    path = folder / f"{bulk.name}-{bulk.n}-{seed}.npz"
    if path.exists():
        return path
    x, d, of = _lattice(bulk, seed)
    walls = [triangles("wall", bulk.mesh())]
    if bulk.name == "silo":
        walls.append(disc("lid", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), bulk.opening))
    made, first = scene(
        x, 1.001 * d, density=2500.0, walls=walls, stiffness=2.0e4, restitution=0.4, friction=0.3, gravity=G,
        timing=ContactTiming.AT_STEPS, events=EventRule.NONE, steps_per_contact=20.0,
    )  # fmt: skip
    engine = CpuEngine(threads)
    engine.load(made, first)
    for _ in range(200):
        engine.advance(round(0.01 / made.dt)).raise_if_any()
        speed = np.linalg.norm(engine.state().v, axis=1)
        if engine.state().t > 0.15 and np.sqrt(np.mean(speed**2)) < 2e-3:
            break
    x, v = engine.state().x.copy(), np.zeros((len(x), 3))
    if bulk.ball:
        top = float(x[:, 2].max()) + 0.5 * float(d.max()) + 0.1 * bulk.ball
        x = np.vstack([x, [0.0, 0.0, bulk.above or top + 0.5 * bulk.ball]])
        v = np.vstack([v, [0.0, 0.0, -bulk.speed]])
        d, of = np.append(d, bulk.ball), np.append(of, MATERIALS.index("steel"))
    folder.mkdir(parents=True, exist_ok=True)
    np.savez(path, x=x, v=v, d=d, of=of)
    return path


def measured(bulk: Bulk, kept: Path, t: Floats, x: Floats) -> dict[str, Any]:
    """What is compared, from places (n_frame, n, 3) [m], nan where a grain has left."""
    with np.load(kept) as file:
        d, of = file["d"], file["of"]
    return {"silo": _discharge, "drum": _mixing, "impact": _depth}[bulk.name](bulk, t, x, d, of)


def _discharge(bulk: Bulk, t: Floats, x: Floats, _d: Floats, _of: Floats) -> dict[str, Any]:
    """Grains a second between 80 % and 30 % full, by quarters of that, and the time at which 1 % is left."""
    left = np.array([np.count_nonzero(one[:, 2] > 0.0) for one in x])
    marks = np.interp(-np.linspace(0.8, 0.3, 5) * bulk.n, -left, t)
    quarters = 0.125 * bulk.n / np.diff(marks)
    found = {"rate [1/s]": 0.5 * bulk.n / (marks[-1] - marks[0]), "quarters [1/s]": quarters.tolist()}
    empty = left <= 0.01 * bulk.n
    end = float(np.interp(-0.01 * bulk.n, -left, t)) if empty.any() else None
    return found | {"empty [s]": end, "t [s]": t.tolist(), "left": left.tolist()}


def _mixing(bulk: Bulk, t: Floats, x: Floats, d: Floats, of: Floats) -> dict[str, Any]:
    """Lacey's index by volume, and M1 in the quarters of the drum that rise and that fall.

    The paper counts in x, z > 0 and in x, z < 0 of a drum that turns the other way.
    """
    small, turns = of == 0, bulk.spin * t / (2.0 * np.pi)
    found: dict[str, Any] = {"number of M1": int(small.sum()), "t [s]": t.tolist()}
    for large in (3, 2):
        index = [_lacey(one, d**3, small, large * float(d.max())) for one in x]
        found[f"index {large}"] = index
        for turn in (0.25, 0.5, 0.75, 1.0):
            if turns[-1] >= turn:
                found[f"index {large} at {turn} turns"] = float(np.interp(turn, turns, index))
    up, down = (x[..., 0] < 0) & (x[..., 2] > 0), (x[..., 0] > 0) & (x[..., 2] < 0)
    counts = [(zone & kind).sum(axis=1) for zone in (up, down) for kind in (small, ~small)]
    return found | {"zones (M1, M2 in 1, in 2)": np.stack(counts, axis=1).tolist()}


def _lacey(x: Floats, volume: Floats, small: Any, side: float) -> float:
    """Index of mixing over cubes of a side [m] that are half as full as the median one."""
    whole = float(volume[small].sum() / volume.sum())
    cell = np.floor(x / side + 1000.0).astype(np.int64) @ np.array([1_000_000, 1000, 1])
    _, at = np.unique(cell, return_inverse=True)
    each = np.bincount(at, volume)
    share = np.bincount(at, np.where(small, volume, 0.0)) / each
    weight = np.where(each > 0.5 * np.median(each), each, 0.0)
    return 1.0 - float(np.average((share - whole) ** 2, weights=weight)) / (whole * (1.0 - whole))


def _depth(bulk: Bulk, t: Floats, x: Floats, d: Floats, _of: Floats) -> dict[str, Any]:
    """Way of the ball downwards [m]: the deepest, when, and at the end."""
    way = x[0, -1, 2] - x[:, -1, 2]
    k = int(way.argmax())
    return {"deepest [m]": float(way[k]), "at [s]": float(t[k]), "end [m]": float(way[-1]),
            "t [s]": t.tolist(), "way [m]": way.tolist()}  # fmt: skip
