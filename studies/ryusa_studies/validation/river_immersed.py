"""A column of grains collapses under water, loose or dense (design/0030).

The limits are those that were asked for before the pressure knew of grains, but for the time, which was cut
after a first trial with a flume in which the loose column came to the far wall.
"""

import math
from collections.abc import Mapping, Sequence
from tempfile import TemporaryDirectory

import numpy as np

from ryusa.build import build
from ryusa.casefile import read
from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.laws.families import Pressure
from ryusa.measure.long_section import row_of
from ryusa.model import State
from ryusa.model.arrays import Floats
from ryusa.running.runner import run, run_scene
from ryusa.running.stops import Stop
from ryusa.study import Finding, Found, Task, calculation
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.river_dam_break import whole

DECLARED = declared(__file__)

CASE = "immersed_column.toml"
KINDS = ("loose", "dense")
LONG, G = 0.015, 9.80665  # of the column [m]
AT, EARLY = 0.005, 0.05  # where the pressure at the floor is read [m], and until when it is averaged [s]
FRONT = 30  # grains whose mean place is the front
# The column settles dry behind a gate: without friction it becomes dense, with friction of both kinds loose
SETTLING: Mapping[str, Mapping[str, str]] = {
    "dense": {"contact.friction_angle": "0 deg"},
    "loose": {
        "contact.friction_angle": "40 deg", "rolling.model": "spring-dashpot-slider",
        "rolling.arm": "reduced radius", "rolling.coefficient": "0.3",
    },
}  # fmt: skip
DRY: Mapping[str, str] = {
    "planes": '[{ name = "gate", point = ["15 mm", "0 m", "0 m"], normal = [-1, 0, 0] }]',
    "water.row.surface": '[["0 m", "-1 mm"], ["88 mm", "-1 mm"], ["90 mm", "0.6 mm"]]',  # a drop far away
    "water.row.pressure": "hydrostatic", "contact.timing": "exact", "time.steps_per_contact": "10",
    "stop.time": "0.15 s",
}  # fmt: skip


def collapsing(kind: str, pressure: str, seed: int = 1) -> dict[str, Floats]:
    """Let a column settle, then its collapse under water.

    Returns
    -------
    Over the times `t` [s]: `front`, how far the grains have come beyond the column over its length [-], and
    `pore`, pressure at the floor beyond the hydrostatic one over the weight of the column in water [-], nan
    where the pressure is hydrostatic. `phi` and `high` of the column at the start [-], [m].

    Raises
    ------
    KeyboardInterrupt : a run was stopped.
    """
    path = case_path(CASE)
    case = read(path, {"seed": str(seed), "water.row.pressure": pressure})
    with TemporaryDirectory() as folder:
        settling = read(path, {**DRY, **SETTLING[kind], "seed": str(seed)})
        x = np.array(whole(run(settling, f"{folder}/settled", progress=False)).frames.x[-1])
        scene = build(case).scene
        x[:, 1] %= scene.period[1]
        assert case.stop.time is not None
        done = whole(run_scene(
            scene, State.at_rest(x), f"{folder}/collapsed", frames=case.record.frames,
            stop=Stop(time=case.stop.time), progress=False,
        ))  # fmt: skip
        found, d = row_of(done), done.scene.d
        inside = (np.abs(x[:, 0] - 0.5 * LONG) < 0.3 * LONG) & (x[:, 2] > 0.002) & (x[:, 2] < 0.009)
        phi = math.pi / 6.0 * float((d[inside] ** 3).sum()) / (0.6 * LONG * 0.007 * scene.period[1])
        high = float(np.sort(x[:, 2])[-FRONT:].mean())
        weight = (case.grains.density - 1000.0) * G * phi * high
        pore = np.full(len(found.t), np.nan)
        if pressure == Pressure.FULL.word:
            pore = found.pressure[:, round(AT / found.row.dx), 0] / weight
        front = [float(np.sort(np.asarray(one)[:, 0])[-FRONT:].mean()) for one in done.frames.x]
        return {
            "t": found.t, "front": np.array(front) / LONG - 1.0, "pore": pore, "phi": np.array(phi),
            "high": np.array(high),
        }  # fmt: skip


def _runs() -> list[Task]:
    """Both columns, and the loose one in a hydrostatic row, which cannot carry the dense one: see `judge`."""
    given = [(kind, Pressure.FULL) for kind in KINDS] + [("loose", Pressure.HYDROSTATIC)]
    return [calculation(collapsing, kind=kind, pressure=word.word, seconds=500.0) for kind, word in given]


def tasks() -> Sequence[Task]:
    """Half an hour."""
    return _runs()


def judge(found: Found) -> Sequence[Finding]:
    """Sign of the pore pressure, and how far each runs."""
    runs = [found[one] for one in _runs()]
    loose, dense, _ = runs
    early = [float(one["pore"][(one["t"] > 0.0) & (one["t"] <= EARLY)].mean()) for one in (loose, dense)]
    ratio = float(dense["front"][-1] / loose["front"][-1])
    each = ", ".join(
        f"{kind} {float(one['phi']):.2f} and {1e3 * float(one['high']):.3g} mm high"
        for kind, one in zip(KINDS, runs, strict=False)
    )
    pressure = DECLARED["immersed-pore"].finding(
        [Curve(kind, one["t"], one["pore"]) for kind, one in zip(KINDS, runs, strict=False)], [],
        {"loose": early[0], "dense": early[1]}, each=each,
    )  # fmt: skip
    labels = [*KINDS, "loose, hydrostatic"]
    front = DECLARED["immersed-front"].finding(
        [Curve(label, one["t"], one["front"]) for label, one in zip(labels, runs, strict=True)], [],
        {"shorter": ratio}, each=each,
    )  # fmt: skip
    return [pressure, front]
