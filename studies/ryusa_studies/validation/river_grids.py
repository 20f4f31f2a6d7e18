"""Grids of different openings hold back a debris flow (design/0028)."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Task, case_run
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)

SEEDS = (1, 2)
GRID = "debris_grid"
# Openings over the largest diameter; that, and the diameter of the bars [m]; the place of their centres [m]
OPENINGS, D_MAX, BAR, AT = (1.2, 2.0, 3.0), 9.6e-3, 8e-3, 0.7
EARLIER = 2.5  # where runs ended at first, while grains still passed the widest: shown [s]


def grid(seed: int, opening: float) -> CaseRun:
    """Two bars in a channel of two openings, periodic across."""
    pitch = opening * D_MAX + BAR
    bars = {f"walls.{k}.at": f'["{AT:g} m", "{1e3 * (k + 0.5) * pitch:.6g} mm", "0 m"]' for k in (0, 1)}
    width = {"water.row.width": f"{2e3 * pitch:.6g} mm"}
    return case_run(case_path("validation/debris_grid.toml"), {**bars, **width}, seed=seed)


def tasks() -> Sequence[Task]:
    """Every opening with every seed."""
    return [grid(seed, opening) for seed in SEEDS for opening in OPENINGS]


def held_back(run: Results) -> dict[str, Floats]:
    """Share of the grains that are upstream of the grid over the times `t` [s]: `share` [-]."""
    volume = run.scene.solid_volume
    t, share = np.asarray(run.frames.t), []
    for k in range(len(t)):
        share.append(float(volume[np.asarray(run.frames.x[k])[:, 0] < AT].sum() / volume.sum()))
    return {"t": t, "share": np.array(share)}


def of_grids(found: Found) -> Finding:
    """Shares that are held back, against the opening."""
    held = {
        opening: [float(found[grid(seed, opening)]["share"][-1]) for seed in SEEDS] for opening in OPENINGS
    }
    mean = {opening: float(np.mean(shares)) for opening, shares in held.items()}
    more = max(mean[after] - mean[before] for before, after in pairwise(OPENINGS))
    narrow, wide = OPENINGS[0], OPENINGS[-1]
    least, most = min(held[narrow]), max(held[wide])
    runs = [found[grid(seed, wide)] for seed in SEEDS]
    earlier = max(float(np.interp(EARLIER, one["t"], one["share"])) for one in runs)
    x, end = np.array(OPENINGS), float(found[grid(SEEDS[0], narrow)]["t"][-1])
    curves = [
        Curve(f"seed {seed}", x, np.array([shares[k] for shares in held.values()]))
        for k, seed in enumerate(SEEDS)
    ]
    each = "; ".join(
        f"{opening:g} d_max: {', '.join(f'{one:.3f}' for one in shares)}" for opening, shares in held.items()
    )
    return DECLARED["grid"].finding(
        curves, [], {"narrow": least, "wide": most, "rise": more, "earlier": earlier}, end=end, each=each,
    )  # fmt: skip
