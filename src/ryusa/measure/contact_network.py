"""Contact forces at one moment, each with the line along which it acts: the network of forces."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.laws.families import Cap
from ryusa.measure._run import Floats, Run
from ryusa.measure.snapshot import Snapshot, frame_at, inside_periods, lanes_of, scene_at, snapshot
from ryusa.measure.table import lines
from ryusa.model import Scene
from ryusa.model.pair_springs import pair_attractions, pair_springs
from ryusa.model.scene import Bools
from ryusa.model.wall_contacts import away_from_surfaces, shares_of_contacts
from ryusa.printed import ByShape
from ryusa.results.touching import touching_pairs

AT_LIMIT = 1.0e-6  # relative round-off of a tangential force that was shortened to tau_c

Ints = NDArray[np.int64]


@dataclass(frozen=True, repr=False)
class ContactNetwork(ByShape):
    """Contacts at one moment, in one lane of a plane scene or one slice of a scene in 3D.

    Attributes
    ----------
    seen : the grains of the lane, or of the slice together with their partners beyond it.
    i, j : ids, shape (n_contact,); i is a free grain, j a free grain, a fixed grain, a plane or a
        face of a wall.
    begin, end : centre of i inside the period, and the nearest centre of j or the point of touch with a
        plane or wall [m], shape (n_contact, 3).
    f_n : normal force [N], positive pushes apart, shape (n_contact,).
    f_s : size of the tangential force [N]; nan where forces were not recorded.
    sliding : whether f_s has reached the shear strength tau_c; False where forces were not recorded.
    recorded : whether the forces are those that the engine applied, in the step before the frame; else they
        are the overlap at the frame times the stiffness of the pair (`model.pair_springs`).
    slice_y : of the slice that holds the points of touch [m], low and high; None in a plane scene.
    slice, slices : number of the slice, in order of y, and of all; 0 and 1 in a plane scene.
    """

    seen: Snapshot
    i: Ints
    j: Ints
    begin: Floats
    end: Floats
    f_n: Floats
    f_s: Floats
    sliding: Bools
    recorded: bool
    slice_y: tuple[float, float] | None = None
    slice: int = 0
    slices: int = 1

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per contact."""
        columns: dict[str, Any] = {"t_s": self.seen.t, "i": self.i, "j": self.j}
        for name, place in (("begin", self.begin), ("end", self.end)):
            columns |= {f"{name}_{axis}_m": place[:, n] for n, axis in enumerate("xyz")}
        return lines(columns | {"f_n_N": self.f_n, "f_s_N": self.f_s, "sliding": self.sliding})


def contact_network(run: Run, t: float | None = None, lane: int | None = None) -> ContactNetwork:
    """Contact forces at the frame nearest to a time.

    Parameters
    ----------
    run : a run folder; with record.forces = true the forces are those that the engine applied.
    t : [s]; default the last frame.
    lane : lane of a plane scene, default that of grain 0; in 3D a slice about one largest diameter thick,
        default the middle one. Both are counted from 0 in order of y.

    Raises
    ------
    ResultsError : no frame near that time, or no such lane or slice.

    Notes
    -----
    A contact is that of the step before the frame, at x - v dt, where forces were recorded. It slides where
    f_s has reached tau_c = max(c + mu p, 0) of Eq. (4), where p is the force of the spring or, with
    `contact.cap = "total"`, f_n, both without adhesion. In 3D a contact belongs to the slice that holds its
    point of touch. In a hollow of walls contacts share their force (design/0019).
    """
    k = frame_at(run, t)
    scene = scene_at(run, float(run.frames.t[k]))
    x = np.asarray(run.frames.x[k], dtype=np.float64)
    if scene.forces:
        x = inside_periods(x - np.asarray(run.frames.v[k], dtype=np.float64) * scene.dt, scene)
        held: np.ndarray = run.contact_forces(k)  # type: ignore[attr-defined]
        i, j, before = held["i"], held["j"], float(run.frames.t[k]) - scene.dt
        gap, normal, overlap = _geometry(x, i, j, scene, before)
        spring = shares_of_contacts(scene, x, before, i, j) * pair_springs(scene, i, j, overlap)[0] * overlap
        pull = pair_attractions(scene, i, j, overlap)[0]
        force = np.asarray(held["force"], dtype=np.float64)
        f_n, f_s, sliding = _parts(force, normal, spring, pull, i, j, scene)
    else:
        x = inside_periods(x, scene)
        now = float(run.frames.t[k])
        i, j = touching_pairs(x, scene, now)
        gap, normal, overlap = _geometry(x, i, j, scene, now)
        f_n = shares_of_contacts(scene, x, now, i, j) * pair_springs(scene, i, j, overlap)[0] * overlap
        f_s = np.full(len(i), np.nan)
        f_n -= pair_attractions(scene, i, j, overlap)[0]
        sliding = np.zeros(len(i), dtype=np.bool_)
    chosen, slices, slice_y = 0, 1, None
    if scene.plane_case:
        seen = snapshot(run, t, lane)
        shown = lanes_of(x[:, 1], scene)[0][i] == seen.lane
    else:
        low, thick, slices = _slices(x, scene)
        chosen = slices // 2 if lane is None else lane
        if not 0 <= chosen < slices:
            raise ResultsError(f"no slice {chosen}: there are {slices}, counted from 0 in order of y")
        low += chosen * thick
        touch = x[i, 1] + normal[:, 1] * 0.5 * (scene.d[i] - overlap)
        shown, slice_y = _within(touch, low, thick, scene), (low, low + thick)
        seen = _cut(snapshot(run, t), np.union1d(i[shown], j[shown]), low, thick, scene)
    begin, end = x[i], x[i] + gap
    return ContactNetwork(
        seen, i[shown], j[shown], begin[shown], end[shown], f_n[shown], f_s[shown], sliding[shown],
        scene.forces, slice_y, chosen, slices,
    )  # fmt: skip


def _parts(
    force: Floats, normal: Floats, spring: Floats, pull: Floats, i: Ints, j: Ints, scene: Scene
) -> tuple[Floats, Floats, Bools]:
    """Normal force, size of the tangential force [N], and whether that has reached the shear strength."""
    f_n = -(force * normal).sum(axis=1)
    f_s = np.linalg.norm(force + f_n[:, None] * normal, axis=1)
    law = scene.contact
    push = f_n + pull if law.cap == Cap.TOTAL else spring
    mu = np.empty(len(i))
    for one, some in scene.by_pair(i, j):
        mu[some] = one.contact.mu
    tau_c = np.maximum(law.cohesion + mu * push, 0.0)
    return f_n, f_s, (spring > 0.0) & (f_s >= (1.0 - AT_LIMIT) * tau_c)


def _geometry(x: Floats, i: Ints, j: Ints, scene: Scene, t: float) -> tuple[Floats, Floats, Floats]:
    """Vectors to the nearest centre or point of j [m], unit normals from i to j, overlaps [m]."""
    n = scene.n_grain + scene.n_fixed
    every, plane = np.concatenate([x, scene.x_fixed.reshape(-1, 3)]), j >= n
    r = 0.5 * np.concatenate([scene.d, scene.d_fixed])
    gap, normal, reach = np.zeros((len(i), 3)), np.zeros((len(i), 3)), r[i]
    gap[~plane] = every[j[~plane]] - x[i[~plane]]
    for axis, period in enumerate(scene.period):
        if np.isfinite(period):
            gap[~plane, axis] -= period * np.round(gap[~plane, axis] / period)
    if scene.plane_case:
        gap[:, 1] = 0.0
    distance = np.linalg.norm(gap, axis=1)
    normal[~plane] = gap[~plane] / distance[~plane, None]
    reach[~plane] += r[j[~plane]]
    away, overlap = away_from_surfaces(scene, x, t, i[plane], j[plane])
    distance[plane], normal[plane] = reach[plane] - overlap, -away
    gap[plane] = -away * distance[plane, None]
    return gap, normal, reach - distance


def _slices(x: Floats, scene: Scene) -> tuple[float, float, int]:
    """Lower end and thickness of the slices of a scene in 3D [m], and how many there are."""
    low, high = 0.0, float(scene.period[1])
    if not np.isfinite(high):
        y, r = x[:, 1], 0.5 * scene.d  # nan: away
        low, high = float(np.nanmin(y - r)), float(np.nanmax(y + r))
    slices = max(int((high - low) / float(scene.d.max())), 1)
    return low, (high - low) / slices, slices


def _within(y: Floats, low: float, thick: float, scene: Scene) -> Bools:
    """Whether each y [m] lies in a slice that begins at `low`; y may be beyond a periodic limit."""
    off = y - low
    if np.isfinite(scene.period[1]):
        off = off % scene.period[1]
    return (off >= 0.0) & (off < thick)


def _cut(seen: Snapshot, partners: Ints, low: float, thick: float, scene: Scene) -> Snapshot:
    """The grains with their centres in a slice, and those that are partners in its contacts."""
    bed_ids = np.flatnonzero(scene.fixed_active) + scene.n_grain
    free = np.isin(seen.grains, partners) | _within(seen.x[:, 1], low, thick, scene)
    bed = np.isin(bed_ids, partners) | _within(seen.bed_x[:, 1], low, thick, scene)
    return replace(
        seen, grains=seen.grains[free], x=seen.x[free], d=seen.d[free], speed=seen.speed[free],
        spin=seen.spin[free], bed_x=seen.bed_x[bed], bed_d=seen.bed_d[bed],
    )  # fmt: skip
