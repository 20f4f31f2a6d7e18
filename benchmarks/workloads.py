"""What is timed: three workloads, their sizes, the law, and how long each is stepped. Data only; SI."""

from dataclasses import dataclass, replace

import numpy as np

K_N, K_S = 2.0e4, 1.5e3  # springs [N/m]
ETA_N, ETA_S = 0.1, 0.01  # dashpots [N s/m]
MU = 0.78
D, DENSITY, GRAVITY = 0.002, 2650.0, 9.8  # mean diameter [m], density [kg/m3], g [m/s2]
DT = 5.0e-6  # [s]
SLOPE = np.radians(26.0)  # of W1
WET_SLOPE = 0.1  # of W1 under water [rad]: at 26 deg it would be a waterfall
FRAME = 2000  # steps between two frames: 10 ms

# How sliding ends, by ryusa's names: what the peers do. All cap at mu |f_n| and let no normal force pull.
TOTAL, DROP = "total", "spring-drop"  # LAMMPS; LIGGGHTS and YADE


@dataclass(frozen=True)
class Size:
    """Grains of a workload: a block that ryusa settles, and how often it is repeated along x and y."""

    block: int  # columns of a block: x and y of a bed, x and layers of a plane column
    tiles: int  # along x and along y
    warm: int  # steps before the clock starts
    steps: int  # steps timed


@dataclass(frozen=True)
class Workload:
    """One thing to step."""

    name: str  # W1, W2 or W3
    what: str
    size: str
    spread: float  # sizes within +- this part of the mean
    column: bool = False  # under ryusa's column of water

    @property
    def plane(self) -> bool:
        return self.name == "W3"

    @property
    def grid(self) -> Size:
        return (PLANE if self.plane else BED)[self.size]

    @property
    def key(self) -> str:
        kind = "poly" if self.spread and not self.plane else ""
        return "-".join(part for part in (self.name, self.size, kind, "water" if self.column else "") if part)

    @property
    def gravity(self) -> float:
        """g [m/s2]; a gas (bulk.py) has none."""
        return 0.0 if self.name == "gas" else GRAVITY

    @property
    def slope(self) -> float:
        return 0.0 if self.name != "W1" else WET_SLOPE if self.column else float(SLOPE)


# 12 layers over one of fixed grains. 972 grains are what memory is held against.
BED = {
    "100": Size(3, 1, 1000, 200_000),
    "1k": Size(9, 1, 1000, 40_000),
    "2k": Size(13, 1, 2000, 32_000),
    "10k": Size(9, 3, 1000, 4000),
    "20k": Size(41, 1, 1000, 3000),
    "100k": Size(13, 7, 400, 800),
    "200k": Size(41, 3, 200, 400),
    "1M": Size(41, 7, 100, 200),
}
# A column as wide as it is high, half way between release and first fall of its top.
PLANE = {
    "1k": Size(31, 1, 2000, 40_000),
    "2k": Size(45, 1, 2000, 40_000),
    "20k": Size(142, 1, 1000, 5000),
    "200k": Size(447, 1, 200, 500),
}
POLY = 0.2  # spread of the polydisperse bed
PLANE_SPREAD = 0.1  # of every plane column, or it would be a crystal
_WHAT = {"W1": "dense flow at 26 deg", "W2": "static bed", "W3": "plane collapse"}


def workload(name: str, size: str, *, poly: bool = False, column: bool = False) -> Workload:
    """Workload by name and size."""
    spread = PLANE_SPREAD if name == "W3" else POLY if poly else 0.0
    return Workload(name, _WHAT[name], size, spread, column)


def named(key: str) -> Workload:
    """Workload by its key: name, size, then `poly` or `water`."""
    name, _, rest = key.partition("-")
    size, *more = rest.split("-")
    sizes = PLANE if name == "W3" else BED
    if name not in _WHAT or size not in sizes or set(more) - {"poly", "water"}:
        raise ValueError(
            f"{key!r} is no workload: one of {', '.join(_WHAT)}, a size of {', '.join(sizes)}, "
            "then poly or water, such as W1-20k-poly"
        )
    return workload(name, size, poly="poly" in more, column="water" in more)


QUICK = ("W1-2k", "W2-2k", "W3-2k", "W1-2k-poly", "W1-2k-water")
FULL = (
    "W1-2k", "W2-2k", "W3-2k", "W1-20k", "W2-20k", "W3-20k", "W1-20k-poly", "W2-20k-poly", "W1-20k-water",
    "W1-200k", "W2-200k", "W3-200k",
)  # fmt: skip


@dataclass(frozen=True)
class Grains:
    """First grains of a workload, the same for every code; arrays as in ryusa's Scene and State."""

    x: np.ndarray
    v: np.ndarray
    omega: np.ndarray
    d: np.ndarray
    x_fixed: np.ndarray
    d_fixed: np.ndarray
    period: tuple[float, float]  # inf where open

    @staticmethod
    def load(path: str) -> "Grains":
        with np.load(path) as kept:
            arrays = {name: kept[name] for name in kept.files}
        period = arrays.pop("period")
        return Grains(**arrays, period=(float(period[0]), float(period[1])))

    def save(self, path: str) -> None:
        np.savez(path, **{**vars(self), "period": np.array(self.period)})

    def tiled(self, k: int, noise: float) -> "Grains":
        """Repeat k times along x and y; velocities differ by `noise` [m/s], so that copies part ways."""
        if k == 1:
            return self
        rng = np.random.default_rng(1)
        steps = np.array([(i * self.period[0], j * self.period[1], 0.0) for j in range(k) for i in range(k)])
        spread = [(a[None] + steps[:, None]).reshape(-1, 3) for a in (self.x, self.x_fixed)]
        many = {
            name: np.concatenate([getattr(self, name)] * k * k) for name in ("v", "omega", "d", "d_fixed")
        }
        many["v"] = many["v"] + rng.normal(0.0, 1.0, many["v"].shape) * noise
        return replace(
            self, x=spread[0], x_fixed=spread[1], **many, period=(k * self.period[0], k * self.period[1])
        )
