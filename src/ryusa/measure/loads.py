"""Loads on dams and walls in a row of columns: of the water, of the grains, and of both."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, frames_between, settle_time
from ryusa.measure.approaching_front import ApproachingFront, approaching_front, rose_at_once
from ryusa.measure.statistics import Average, average
from ryusa.measure.structures import Structure, of_grains, structures_of, water_on_dam, water_on_mesh
from ryusa.measure.table import Averaged, Averages
from ryusa.model import ColumnRow

SHARES = (0.95, 0.99)  # of the time in which a load stays below a percentile


@dataclass(frozen=True, repr=False)
class Loads(Averaged):
    """Loads on dams and walls, for the whole width of the stream; means from frame to frame.

    Attributes
    ----------
    t : middle of the time between two frames [s], shape (n,).
    names : of the dams, and of the walls that water or grains push.
    width : of the stream [m].
    toe : x and z of the foot on the downstream side of each at the begin [m], shape (n_structure, 2).
    water, grains : force along x [N], force along z [N] and overturning moment [N m], positive where it turns
        the structure downstream about its toe, shape (n, n_structure, 3).
    height : at which the horizontal force of the water acts, over the toe [m], shape (n, n_structure); nan
        without such a force.
    window : averaging time of the largest load and its percentiles [s].
    largest : when the largest mean force along x begins [s], and that force [N], shape (n_structure, 2).
    fronts : what came against each dam, where the largest load is due to a front; else None.
    averages : means with their errors, then largest loads and percentiles, and the impulse of the window.
    """

    t: Floats
    names: tuple[str, ...]
    width: float
    toe: Floats
    water: Floats
    grains: Floats
    height: Floats
    window: float
    largest: Floats
    fronts: tuple[ApproachingFront | None, ...]
    averages: Averages

    @property
    def total(self) -> Floats:
        """Load of water and grains together, as `water`."""
        return self.water + self.grains

    @property
    def acts_at(self) -> dict[str, Floats]:
        """Height over the toe at which forces along x act [m], of "water", "grains" and "total".

        Shape (n, n_structure); nan without such a force. That of the water is of its horizontal force alone;
        of the grains only the whole moment is known, also that of what presses on a crest: it is taken as
        that of their force along x.
        """
        force = {"water": self.water[:, :, 0], "grains": self.grains[:, :, 0]}
        turn = {"water": force["water"] * np.nan_to_num(self.height), "grains": self.grains[:, :, 2]}
        for of in (force, turn):
            of["total"] = of["water"] + of["grains"]
        return {
            name: np.divide(turn[name], of, out=np.full(of.shape, np.nan), where=of != 0.0)
            for name, of in force.items()
        }

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per time between two frames and structure."""
        parts = {"water": self.water, "grains": self.grains, "total": self.total}
        acts_at = self.acts_at
        return [
            {
                "t_s": float(t),
                "structure": name,
                **{
                    f"{part}_{what}": float(of[k, d, a])
                    for part, of in parts.items()
                    for a, what in enumerate(("force_x_N", "force_z_N", "overturning_Nm"))
                },
                **{f"{part}_acts_at_m": float(of[k, d]) for part, of in acts_at.items()},
                "total_force_x_N_per_m": float(self.total[k, d, 0] / self.width),
            }
            for k, t in enumerate(self.t)
            for d, name in enumerate(self.names)
        ]


def loads(run: Run, begin: float | None = None, end: float = math.inf, window: float | None = None) -> Loads:
    """Force and overturning moment of water and grains on dams and walls in a row of columns.

    Parameters
    ----------
    run : a run folder whose water is a row with dams or [[walls]].
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.
    window : averaging time of the largest load [s]; default the time between two frames, the shortest there
        is.

    Raises
    ------
    ResultsError : no row, no dam that stops water and no wall, or fewer than two frames in the window.

    Notes
    -----
    The water stands against each face of a dam with the level of the segment beside it, at rest:
    p = rho g_z (surface - z); on the top of a dam lies the weight of the water over it. A mesh among the
    [[walls]] has the same pressure on the outer side of its triangles, under a surface that is straight
    between the middles of segments; but a mesh round a dam adds its grains to those of the dam, and the
    water acts on the dam. The water flows through other walls than dams. Neither the momentum
    of a bore or a jet that strikes, nor uplift below the foot, nor friction is in it. Grains in the water
    leave its pressure as it is: what they carry from grain to grain is in their own force. The
    forces of the grains are those of `measure.walls`, means of every step between two frames; grains act on
    a dam where it is a wall for them, by its name. Where the largest load on a dam is that of a front, three
    formulae for its force are given beside it.
    """
    frames = run.row
    if frames is None:
        raise ResultsError(
            "loads are those on dams and walls in a row of columns; the run has no [water.row]"
        )
    since = settle_time(run) if begin is None else begin
    every = np.asarray(frames.t, dtype=np.float64)
    kept = frames_between(every, since, end)
    t, row = every[kept], frames.row
    found, grains, said = _pushed(run, row, kept, float(t[0]))
    width = row.column.area / (row.n_segment * row.dx)
    at = np.array([_of_water(run, one, kept, width) for one in found]).transpose(1, 0, 2)
    water = 0.5 * (at[1:] + at[:-1])
    pushed = water[:, :, 0] != 0.0
    height = np.full(pushed.shape, np.nan)
    np.divide(water[:, :, 3], water[:, :, 0], out=height, where=pushed)
    dt, both = np.diff(t), water[:, :, :3] + grains
    span, ends = float(dt.max()) if window is None else max(window, float(dt.max())), (t[0], t[-1])
    largest = [_largest(both[:, s, 0], t, span) for s in range(len(found))]
    sought = [
        "" if one.dam is None else approaching_front(run, one.dam, kept, both[:, s, 0], largest[s][1])
        for s, one in enumerate(found)
    ]
    fronts = [None if isinstance(one, str) else one for one in sought]
    items: list[Average] = []
    for s, one in enumerate(found):
        parts = {"water": water[:, s, :3], "grains": grains[:, s], "both": both[:, s]}
        items += _averages(one, parts, dt, ends, height[:, s], width, span, largest[s][1])
        items += _of_front(one, fronts[s], largest[s][1] / width, ends)
        said += _said_of(one, sought[s], both[:, s, 0], largest[s])
    first = f"for a width of {width:.4g} m; largest loads and percentiles are of means over {span:.3g} s"
    return Loads(
        0.5 * (t[1:] + t[:-1]), tuple(one.name for one in found), width,
        np.array([one.toe for one in found]), water[:, :, :3], grains, height, span, np.array(largest),
        tuple(fronts), Averages("loads", tuple(items), (first, *said)),
    )  # fmt: skip


def _pushed(run: Run, row: ColumnRow, kept: slice, t: float) -> tuple[list[Structure], Floats, list[str]]:
    """Structures that water or grains push, force and moment of the grains on each, and what is said of them.

    Raises
    ------
    ResultsError : there is none.
    """
    found, said = structures_of(run, t)
    if not found:
        seeping = ", ".join(one.name for one in row.dams)
        raise ResultsError(
            "no [[walls]], and no dam that stops the water of the row"
            f"{f': it seeps through {seeping}' if seeping else ''}"
        )
    grains, touched = of_grains(run, found, kept)
    shown = [s for s, one in enumerate(found) if one.dam or one.mesh or touched[s]]
    if not shown:
        raise ResultsError(f"neither water nor a grain pushes {', '.join(one.name for one in found)}")
    if left := [one.name for s, one in enumerate(found) if s not in shown]:
        said.append(f"left out, as neither water nor a grain pushes it: {', '.join(left)}")
    return [found[s] for s in shown], grains[:, shown], said


def _of_water(run: Run, one: Structure, kept: slice, width: float) -> Floats:
    """Load of the water on a structure at each frame, as `water_on_dam` for the whole width."""
    if one.dam is not None:
        return width * water_on_dam(run.row, one.dam)[kept]
    if one.mesh:
        return water_on_mesh(run, one, kept)
    return np.zeros((len(range(len(run.row.t))[kept]), 4))


def _averages(
    one: Structure, parts: dict[str, Floats], dt: Floats, ends: tuple[float, float], height: Floats,
    width: float, window: float, largest: float,
) -> list[Average]:  # fmt: skip
    """Means with errors, then what is largest, and the impulse, of one structure."""
    acts = {"water": one.dam is not None or one.mesh, "grains": bool(one.walls), "both": True}
    shown = [(name, of) for name, of in parts.items() if acts[name]]
    both = parts["both"]
    items = [average(f"{one.name}: force x, {name}", "N", [of[:, 0]], ends) for name, of in shown]
    items.append(average(f"{one.name}: force x, both, by width", "N/m", [both[:, 0] / width], ends))
    items.append(average(f"{one.name}: force z, both", "N", [both[:, 1]], ends))
    items += [average(f"{one.name}: overturning, {name}", "N m", [of[:, 2]], ends) for name, of in shown]
    if acts["water"]:
        items.append(average(f"{one.name}: water acts over the toe at", "m", [height], ends))
    over, turns = (running_mean(both[:, a], dt, window) for a in (0, 2))
    for share in SHARES:
        what = f"{one.name}: force x, both, {100.0 * share:g} % below"
        items.append(_one(what, "N", float(np.quantile(over, share)), ends))
    items.append(_one(f"{one.name}: force x, both, largest", "N", largest, ends))
    items.append(_one(f"{one.name}: force x, both, largest, by width", "N/m", largest / width, ends))
    items.append(_one(f"{one.name}: overturning, both, largest", "N m", float(turns.max()), ends))
    by_width = float(turns.max()) / width
    items.append(_one(f"{one.name}: overturning, both, largest, by width", "N m/m", by_width, ends))
    items.append(_one(f"{one.name}: impulse x, both", "N s", float(both[:, 0] @ dt), ends))
    return items


def _of_front(
    one: Structure, front: ApproachingFront | None, largest: float, ends: tuple[float, float]
) -> list[Average]:
    """Speed, depth and concentration of a front, and the largest force [N/m] beside formulae."""
    if front is None:
        return []
    of = {"speed": ("m/s", front.u), "depth": ("m", front.h), "concentration": ("-", front.c)}
    of |= {"Froude number": ("-", front.froude)}
    items = [_one(f"{one.name}: front, {name}", unit, value, ends) for name, (unit, value) in of.items()]
    for name, force in front.forces.items():
        items.append(_one(f"{one.name}: formula, {name}", "N/m", force, ends))
        items.append(_one(f"{one.name}: largest over {name}", "-", largest / force, ends))
    return items


def _said_of(
    one: Structure, front: ApproachingFront | str, force: Floats, largest: tuple[float, float]
) -> list[str]:
    """Where and when the front against a dam was measured and what the formulae are, or why there is none."""
    when, most = largest
    if isinstance(front, str):
        if one.dam is None:
            return []
        if rose_at_once(force, most):
            return [
                f"the load on {one.name} rose so fast that a front may have struck it; frames are too far "
                "apart to measure one and to hold formulae against it (`record.frames`)"
            ]
        return [f"no formulae for a front against {one.name}: {front}"]
    said = (
        f"front against {one.name}: flow from x = {front.reach[0]:.3g} to {front.reach[1]:.3g} m, from "
        f"{front.came:.3g} s until it struck at {front.struck:.3g} s; rho = {front.rho:.4g} kg/m3. Formulae: "
        "fluid at rest of its depth; the bore that a wall reflects, as Armanini et al. 2011 have it; "
        "momentum that is stopped, rho u^2 h, without the coefficients of practice"
    )
    if front.behind_bore > front.tall:
        said += f". Behind that bore it would be {front.behind_bore:.3g} m deep: the dam is lower"
    if when > front.struck + (front.struck - front.came):
        said += (
            f". Its largest load came at {when:.3g} s, from what followed the front: the formulae are not "
            "for that"
        )
    return [said]


def running_mean(values: Floats, dt: Floats, window: float) -> Floats:
    """Means over a time of a record of means over given times.

    Parameters
    ----------
    values : means over `dt` that follow one another.
    dt : their times [s].
    window : averaging time [s]; the whole record where that is shorter.

    >>> running_mean(np.array([0.0, 1.0, 0.0, 0.0]), np.ones(4), 2.0).tolist()
    [0.5, 0.5, 0.0]
    """
    at = np.concatenate([[0.0], np.cumsum(dt)])
    whole = np.concatenate([[0.0], np.cumsum(values * dt)])
    window = min(window, float(at[-1]))
    starts = at[at <= at[-1] - window * (1.0 - 1e-9)]
    return (np.interp(starts + window, at, whole) - np.interp(starts, at, whole)) / window


def _largest(force: Floats, t: Floats, window: float) -> tuple[float, float]:
    """When the largest mean over a time begins [s], and that mean; by its magnitude."""
    over = running_mean(force, np.diff(t), window)
    k = int(np.argmax(np.abs(over)))
    return float(t[k]), float(over[k])


def _one(name: str, unit: str, value: float, span: tuple[float, float]) -> Average:
    """A number of the whole record, which has no error of a mean."""
    nan = math.nan
    return Average(name, unit, float(value), nan, 1, 0, nan, span, nan, nan, nan)
