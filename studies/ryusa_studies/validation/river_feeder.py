"""A river that is fed by a reach over the same bed: its bed neither rises nor falls (design/0028)."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from ryusa.casefile.read import read, read_text
from ryusa.casefile.row.reach_source import reach_of, repeated
from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.measure.along_row import grains_along_row
from ryusa.measure.long_section import bed_line, row_of
from ryusa.model.arrays import Floats
from ryusa.model.feeds import IN
from ryusa.results import Results
from ryusa.running.runner import run
from ryusa.study import Finding, Found, Level, Plan, Task, calculation
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.river_dam_break import whole

DECLARED = declared(__file__)

CASE, REACH = "fed_river", "even_bed"
SEED = 1
FED = {"water.row.upstream": "{ end = 'feeder reach', run = 'reach' }"}
JUDGED = 0.2, 0.8  # where the bed is judged: 25 diameters from the upper end, 12 from the sill [m]
CORE = 8e-3, 24e-3  # heights between which the settled bed is dense [m]


def fed() -> dict[str, Floats]:
    """Run the reach, then the river that it feeds.

    Returns
    -------
    `t` [s] and `bed` [m], shape (n_frame,), mean height of the bed where it is judged, from the settling
    time on; `rate` of its rise [m/s]; `core`, concentration of the settled bed [-]; `q_s` and its standard
    `error`, of the reach [m2/s]; `crossed`, volume that crossed its end over its q_s and duration [-];
    `carried`, mean q_s of the river over that of the reach [-]; `due` and `waiting`, grains that should have
    entered and those of them that did not; `discharge`, largest relative error of the discharge that enters.

    Raises
    ------
    KeyboardInterrupt : a run was stopped.
    """
    with TemporaryDirectory() as folder:
        even = read(case_path(f"{REACH}.toml"), {"seed": str(SEED)})
        whole(run(even, f"{folder}/reach", progress=False))
        path = case_path(f"{CASE}.toml")
        text = path.read_text(encoding="utf-8")
        case = read_text(text, {**FED, "seed": str(SEED)}, path=Path(folder) / path.name)
        reach = reach_of(case)
        assert reach is not None
        done = whole(run(case, f"{folder}/river", progress=False))
        volume = float((np.pi / 6.0 * reach.d**3).sum())
        due = len(repeated(case, reach).t)
        entered = int((done.passages["way"] == IN).sum())
        return {
            **over_time(done), "q_s": np.array(reach.solid_discharge), "error": np.array(reach.error),
            "crossed": np.array(volume / (reach.width * reach.duration * reach.solid_discharge)),
            "due": np.array(float(due)), "waiting": np.array(float(due - entered)),
        } | _passed(done, reach.discharge, reach.solid_discharge)  # fmt: skip


def over_time(done: Results) -> dict[str, Floats]:
    """`t`, `bed`, `rate` and `core` of a river, as `fed` gives them."""
    found = row_of(done)
    frames = np.flatnonzero(found.t >= float(done.case["record"]["settle"]) - 1e-9)
    part, t = (found.row.x > JUDGED[0]) & (found.row.x < JUDGED[1]), found.t[frames]
    bed = bed_line(done, found, frames, "packed")[:, part].mean(axis=1)
    z = found.row.column.z - found.row.column.z_low
    inside = (z > CORE[0]) & (z < CORE[1])
    core = float(found.phi[frames][:, part][:, :, inside].mean())
    return {"t": t, "bed": bed, "rate": np.array(np.polyfit(t, bed, 1)[0]), "core": np.array(core)}


def _passed(done: Results, q: float, q_s: float) -> dict[str, Floats]:
    """`carried` and `discharge`, as `fed` gives them; q and q_s of the reach [m2/s]."""
    found = row_of(done)
    frames = np.flatnonzero(found.t >= float(done.case["record"]["settle"]) - 1e-9)
    x, t = found.row.x_station, found.t[frames]
    part = (x > JUDGED[0]) & (x < JUDGED[1])
    passed = grains_along_row(done, found.row, frames[[0, -1]]).passed
    carried = float((passed[-1] - passed[0])[part].mean() / (t[-1] - t[0])) / q_s
    off = np.abs(found.discharge[frames, 0] / q - 1.0).max()
    return {"carried": np.array(carried), "discharge": np.array(float(off))}


def _task() -> Task:
    return calculation(fed, seconds=460.0)


def tasks(plan: Plan) -> Sequence[Task]:
    """Reach and river, at the full level alone: some eight minutes together."""
    return [_task()] if plan.level is Level.FULL else []


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """The rise of the bed over what the feed would raise it by."""
    if plan.level is not Level.FULL:
        return []
    got = found[_task()]
    t, bed = got["t"], got["bed"]
    q_s, core, rate = (float(got[name]) for name in ("q_s", "core", "rate"))
    kept = core * (JUDGED[1] - JUDGED[0]) * rate / q_s
    lost = -q_s / (core * (JUDGED[1] - JUDGED[0]))  # rate if all that passes came from this bed [m/s]
    span = t[0] + np.linspace(0.0, 0.01 / abs(lost), 41)
    return [
        DECLARED["feeder-reach"].finding(
            [Curve("river", t, 1e3 * (bed - bed[0]))],
            [
                Curve("balance", t, np.zeros_like(t)),
                Curve("all of q_s taken from this bed", span, 1e3 * lost * (span - t[0])),
            ],
            {
                "kept": kept, "crossed": float(got["crossed"]), "waiting": float(got["waiting"] / got["due"]),
                "discharge": float(got["discharge"]), "carried": float(got["carried"]),
                "error": float(got["error"]) / q_s,
            },
            rate=1e3 * rate, begin=t[0], end=t[-1], lost=-1e3 * lost, q_s=1e4 * q_s, due=float(got["due"]),
            core=core,
        )
    ]  # fmt: skip
