"""Runs of grains in a row of columns of water, made up by hand."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from ryusa import build
from ryusa.laws.families import BedKind, SurfaceRule
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowEnd
from ryusa.results.water import WaterFrames

D, WIDTH, DX, DZ, CELLS = 2.0e-3, 0.01, 0.01, 0.5e-3, 80
PACKED, G = 0.6, 9.81
BALL = np.pi / 6.0 * D**3


def row_of(n: int = 8, *, ends: bool = False, bottom: Any = None, dx: float = DX) -> ColumnRow:
    column = Column(
        0.0, DZ, CELLS, 0.02, area=WIDTH * n * dx, bed=BedKind.MOVING, phi_max=PACKED, g_x=0.01 * G,
        surface=SurfaceRule.VOLUME,
    )  # fmt: skip
    end = RowEnd(EndKind.WALL) if ends else None
    return ColumnRow(column, dx, np.zeros(n) if bottom is None else bottom, G, end, end, x_low=0.1)


def run_of(row: ColumnRow, t: Any, x: Any, v: Any, rows: Any = None, **water: Any) -> Any:
    """A run of grains at x [m], speeds v [m/s], shape (n_frame, n_grain, 3) each, in water of a row."""
    gates = {}
    if rows is not None:
        feed = build.feed_disc("feed", np.full(x.shape[1] - 1, D), 1.0, (0.11, 0, 0.1), 0.005)
        gates = {"feeds": [feed], "exits": [build.exit_plane("end", (0.18, 0, 0), (1, 0, 0))]}
    apart = 2.0 * D * np.arange(x.shape[1] if rows is None else 1)[:, None] * np.ones(3)
    scene, _ = build.scene(apart, D, dt=1.0e-3, stiffness=1.0, **gates)
    object.__setattr__(scene, "gravity", np.array([0.01 * G, 0.0, -G]))
    shapes = row.frame_shapes()
    frames = {name: np.zeros((len(t), *shape)) for name, shape in shapes.items()} | water
    found = WaterFrames(row, t, **frames)
    steps = np.round(t / 1.0e-3).astype(np.int64)
    shown = SimpleNamespace(t=t, step=steps, x=x, v=v)
    return SimpleNamespace(case={}, scene=scene, frames=shown, row=found, passages=rows)


def layered(row: ColumnRow, levels: Any, above: float) -> Any:
    """Concentrations: packed up to a height over the bottom in each segment, and of some value above it."""
    z = (np.arange(CELLS) + 0.5) * DZ
    return np.where(z < np.asarray(levels)[:, None], PACKED, above * (z < 0.03))
