"""The row of columns of a run: its water, alone or among grains (design/0027)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import GrainLost
from ryusa.laws.families import BedKind, Start
from ryusa.model import ColumnRow, RowCouplingState, RowState, Scene
from ryusa.model.fluid import N_SAMPLED
from ryusa.model.row import EndKind
from ryusa.model.scene import Floats
from ryusa.water._kernel import parameters_of
from ryusa.water.closures import averaged, bed_thickness
from ryusa.water.coupling_interval import refuse_unresolved, steps_resolved
from ryusa.water.momentum_balance import B_ADVECTED, B_CHANGE, B_GRAVITY
from ryusa.water.protocol import Fluid
from ryusa.water.row import RowArrays, advance_row, discharges, row_at_rest
from ryusa.water.row_ends import EndsOverTime, with_inlet
from ryusa.water.row_grains import GrainsInRow
from ryusa.water.row_layout import RowEnds
from ryusa.water.row_threads import RowThreads

_SETTLED = 0.7  # of the packed concentration; a bed with less is as it was laid, and settles
_DRY = 1.0e-12  # of the volume that all cells can hold; less is a dry row


@dataclass
class RowCoupling(Fluid):
    """The row of columns of a run.

    Attributes
    ----------
    scene : its water has the profile COLUMN, and its row is this one.
    row : with the inlet that `with_inlet` found.
    steps : steps of the engine in the present interval.
    sampled : water at the grains as given last, columns of `model.fluid`.
    due : step of the engine at which the next exchange is due.
    exchanges : number of exchanges so far.
    worst : largest residual of the momentum of a station so far, over the largest term in the row [-].
    state : present state of the water.
    passing : what passed each station in the last interval, per time and width [m2/s], shape (n_station,).
    grains : free and fixed grains; None without any.
    """

    scene: Scene
    row: ColumnRow
    steps: int
    sampled: Floats
    due: int
    exchanges: int
    worst: float
    state: RowState
    passing: Floats
    grains: GrainsInRow | None = None

    def __post_init__(self) -> None:
        self._arrays = RowArrays.of(self.row) if self.grains is None else None
        self._courses = None if self.scene.row is None else EndsOverTime.of(self.scene.row)

    @staticmethod
    def begin(scene: Scene, row: ColumnRow, x: Floats, step: int = 0, threads: int = 1) -> "RowCoupling":
        """Fill the row with its first water, at rest or in steady flow; else as `Fluid.begin`.

        Raises
        ------
        ValueError : the row is not valid, does not carry the grains, or has no surface at the start.
        WaterError : no steady flow was found.
        """
        if row.start is None:
            raise ValueError("the row needs its surface at the start")
        start, row = row.start, with_inlet(row)
        about = scene, row, 1, np.zeros((0, N_SAMPLED)), step + 1, 0, 0.0
        if not scene.n_grain + scene.n_fixed:
            state = row_at_rest(row, start, row.porous)
            return RowCoupling(*about, state, np.zeros_like(state.passed))
        grains = GrainsInRow.begin(scene, row, x, threads=RowThreads(threads))
        flows = row.column.start is Start.STEADY
        state = grains.flowing(start) if flows else grains.at_rest(start)
        grains.meet(state)
        made = RowCoupling(*about, state, discharges(row, state), grains)
        made.sampled = grains.sampled
        return made

    @staticmethod
    def resume(
        scene: Scene, row: ColumnRow, found: RowCouplingState, sampled: Floats | None = None, threads: int = 1
    ) -> "RowCoupling":
        """Go on from a snapshot; `sampled` is the water at the grains, columns of `model.fluid`."""
        row, grains, sampled = with_inlet(row), None, np.zeros((0, N_SAMPLED)) if sampled is None else sampled
        if found.grains is not None:
            shared = RowThreads(threads)
            grains = GrainsInRow.resume(scene, row, found.water, found.grains, sampled, shared)
            sampled = grains.sampled
        about = found.steps, sampled, found.due, found.exchanges, found.worst, found.water, found.passing
        return RowCoupling(scene, row, *about, grains)

    def snapshot(self, kept: Floats | None = None) -> RowCouplingState:
        """All that `resume` needs; a row is in one process, so that nothing is `kept` elsewhere."""
        del kept
        grains = None if self.grains is None else self.grains.snapshot()
        about = self.state, self.steps, self.due, self.exchanges, self.worst, self.passing
        return RowCouplingState(*about, grains)

    def ends_with(self, after: Scene) -> bool:
        """Whether a discharge or a level changes, so that each has to act in its own time."""
        before, row = self.scene.row, after.row
        if before is None or row is None:
            return False
        above, below = (before.upstream, row.upstream), (before.downstream, row.downstream)
        return bool(above[0] and above[1] and above[0].discharge != above[1].discharge) or bool(
            below[0] and below[1] and below[0].kind is EndKind.LEVEL and below[0].level != below[1].level
        )

    def change(self, scene: Scene) -> None:
        """Take over a scene that the timeline changed: its slope, its ends, or removed fixed grains."""
        assert scene.row is not None
        self.scene, self.row = scene, with_inlet(scene.row)
        self._courses = EndsOverTime.of(scene.row)
        if self.grains is None:
            self._arrays = RowArrays.of(self.row)
        else:
            self.grains = self.grains.changed(scene, self.row, self.state)

    def exchange(self, x: Floats, v: Floats, impulse: Floats) -> Floats:
        """Move the water on, and give what the grains are told; parameters as of `Fluid`.

        Raises
        ------
        ValueError : a grain is at no finite place.
        GrainLost : a grain is beyond the ends of the row, and the scene has no exit.
        WaterError : the water cannot be moved on, with the place; or drag acts faster than a step resolves.
        """
        time, grains, before = self.steps * self.scene.dt, self.grains, self.state.passed
        if self._courses is not None:
            self._follow(self._courses.over(self.state.t, self.state.t + time))
        if self.scene.traffic is None:
            self.refuse_lost(x, np.arange(len(x)), self.due, self.state.t + time)
        if grains is None:
            self.state = advance_row(self.row, self.state, time, solid=self.row.porous, arrays=self._arrays)
        else:
            self.state = grains.exchange(self.state, x, v, impulse, time)
            self.sampled, now = grains.sampled, self.state
            refuse_unresolved(grains.fastest_grain, self.scene.dt, 1.0, now.t, now.steps)
            self.steps = steps_resolved(grains.fastest, self.scene.dt, self.row.column.interval)
        self.passing = (self.state.passed - before) / time
        self.exchanges += 1
        self.worst = max(self.worst, _residual(self.state.budgets))
        self.due += self.steps
        return self.sampled

    def _follow(self, ends: RowEnds) -> None:
        """Let other discharges and levels act at the ends."""
        if self._arrays is not None:
            self._arrays = replace(self._arrays, ends=ends)
        elif self.grains is not None:
            self.grains.follow(ends)

    def among(self, x: Floats, step: int) -> "RowCoupling":
        """The same water at a step at which grains have entered or left; parameters as of `Fluid.among`.

        Notes
        -----
        The water in each cell is what it was. What entering grains displace raises the surface with the next
        exchange, a step later, and what leaving grains have held sinks. With a pressure of its own that comes
        after an interval like others: a flux that begins within a step would be pressed into it within that
        step, and the grains be told of this pressure for the whole of the next interval.
        """
        assert self.grains is not None
        grains = self.grains.among(x, self.state)
        steps = 1 if self.row.hydrostatic else self.steps
        return replace(self, steps=steps, due=step + steps, grains=grains, sampled=grains.sampled)

    def surface_at(self, x: Floats) -> Floats:
        """Height of the surface over z = 0 at places along the row [m], same shape."""
        row = self.row
        return (row.bottom + self.state.surface[row.inner] - row.column.z_low)[row.segment_at(x)]

    def frame(self) -> Mapping[str, Floats]:
        """Segments and stations of a frame, as `ColumnRow.frame_shapes`."""
        row, state, lowest = self.row, self.state, self.row.solid_cells()
        stations = row.stations_between
        sill = np.maximum(lowest[stations[0]], lowest[stations[1]])
        own, w = dict[str, Floats](), state.profiles[:, 1].copy()
        if state.pressure is not None and state.w is not None:
            own = {
                "pressure": row.column.rho_w * state.pressure[row.inner],
                "w_faces": state.w[row.inner].copy(),
            }
            in_cells = 0.5 * (state.w[:, 1:] + state.w[:, :-1])
            w = 0.5 * (in_cells[stations[0]] + in_cells[stations[1]])
        return own | {
            "surface": state.surface[row.inner] - row.column.z_low + row.bottom,
            "volume": state.volume[row.inner].copy(),
            "content": state.content[row.inner].copy(),
            "phi": np.array(self.phi),
            "u": state.u.copy(),
            "w": w,
            "discharge": self.passing.copy(),
            "passed": state.passed.copy(),
            "tau": state.edges[np.arange(len(sill)), 0, sill],
            "energy": state.energy.copy(),
        }

    @property
    def bed_at_inlet(self) -> float:
        """Height of the bed or dam in the first segment over which water enters (`row_inlet`) [m].

        It is that at the last exchange.
        """
        solid, p = int(self.row.solid_cells()[self.row.inner.start]), parameters_of(self.row.column)
        return solid * p.dz + bed_thickness(p, np.ascontiguousarray(self.phi[0][solid:]))

    def refuse_lost(self, x: Floats, grains: NDArray[np.int64], step: int, t: float) -> None:
        """Raise a `GrainLost` for a grain beyond the ends of the row; parameters as of `Fluid.refuse_lost`.

        To be called where no grain is on its way through an exit.
        """
        row = self.row
        if row.periodic:
            return
        high = row.x_low + row.n_segment * row.dx
        lost = np.flatnonzero((x[:, 0] < row.x_low) | (x[:, 0] > high))
        if len(lost):
            i = int(lost[0])
            raise GrainLost(
                f"the grain is at x = {x[i, 0]:.4g} m, beyond the row of columns from {row.x_low:g} to "
                f"{high:g} m", grain=int(grains[i]), step=step, t=t,
                hint="Give an exit that takes what leaves the row there ([[exits]]), or a wall.",
            )  # fmt: skip

    @property
    def phi(self) -> Floats:
        """Concentration of grains, fixed ones included [-], shape (n_segment, n)."""
        row = self.row
        if self.grains is not None:
            return self.grains.phi
        return np.zeros((row.n_segment, row.column.n)) if row.porous is None else row.porous.phi

    @property
    def volume(self) -> float:
        """Water in the row per width [m2]."""
        return float(self.state.volume[self.row.inner].sum() * self.row.dx)

    @property
    def dry(self) -> bool:
        """Whether there is no water."""
        room = self.row.n_segment * self.row.column.n * self.row.column.dz * self.row.dx
        return self.volume <= _DRY * room

    def numbers(self) -> dict[str, float | int]:
        """State of the water for the summary of a run; SI."""
        row, state = self.row, self.state
        depth = _depths(row, state)
        passed = (0.0, 0.0) if row.periodic else (float(state.passed[0]), float(state.passed[-1]))
        return {
            "grains": self.scene.n_grain,
            "exchanges": self.exchanges,
            "steps_between": self.steps,
            "steps": state.steps,
            "momentum_residual": self.worst,
            "courant": state.courant,
            "volume": self.volume,
            "entered": passed[0],
            "left": passed[1],
            "deepest": float(depth.max()),
            "discharge_first": float(self.passing[0]),
            "discharge_last": float(self.passing[-1]),
            "speed_max": float(np.abs(state.u).max()),
        }

    @property
    def text(self) -> str:
        """State of the water in a line, for the progress of a run."""
        found = self.numbers()
        return (
            f"in {found['discharge_first']:.4g} m2/s  out {found['discharge_last']:.4g} m2/s  "
            f"deepest {found['deepest']:.3g} m  Courant {found['courant']:.2g}"
        )

    def warnings(self) -> list[str]:
        """Warnings about the water, one sentence each."""
        if self.dry:
            return ["the row is dry: no water is left in it"]
        column, beds = self.row.column, self.densest_beds()
        if self.grains is None or "grains" not in column.mixing.marks or not len(beds):
            return []
        typical = float(np.median(beds))
        if not _SETTLED * column.phi_max <= typical < column.phi_max:
            return []
        if self.row.periodic and column.bed is not BedKind.MOVING:
            return []
        thick = "" if self.row.periodic else ", and it is thicker than build.bed says"
        return [
            f"the bed at rest does not reach the packed concentration {column.phi_max:.3g}: its largest, "
            f"averaged over the height of a grain, is {typical:.3g} in the median of the segments with one, "
            f"so turbulence enters it{thick}. Set water.column.packed to its concentration"
        ]

    def densest_beds(self) -> Floats:
        """Largest concentration in each bed at rest, averaged over the height of a grain [-], shape (n_bed,).

        Notes
        -----
        One for each segment without a dam in which a bed at least two grains thick lies on the bottom. It is
        at rest where the water in the pores of its lower half is slower than sqrt(g_z d)/2, as that of a
        debris flow is not.
        """
        row, p, found = self.row, parameters_of(self.row.column), list[float]()
        left, right = row.stations_between
        speed = np.abs(self.state.u)
        taken = row.cells_of_dams()
        for i, phi in enumerate(np.ascontiguousarray(self.phi), start=row.inner.start):
            thick = bed_thickness(p, phi)
            if taken[i] or not thick >= 2.0 * p.d:
                continue
            lower = speed[(left == i) | (right == i), : math.ceil(0.5 * thick / p.dz)]
            if lower.mean() < 0.5 * math.sqrt(row.g_z * p.d):
                found.append(float(averaged(p.dz, p.d, p.n - 1, phi).max()))
        return np.array(found)


def _depths(row: ColumnRow, state: RowState) -> Floats:
    """Depth over the bottom or the top of solid cells [m], shape (n_segment,)."""
    depth = state.surface[row.inner] - row.column.z_low
    return depth if row.solid is None else depth - row.solid * row.column.dz


def _residual(budgets: Floats) -> float:
    """Largest residual of a station over the largest term in the row [-]; budgets (n_station, N_OUT)."""
    terms = budgets[:, B_GRAVITY : B_ADVECTED + 1].copy()
    terms[:, B_CHANGE - B_GRAVITY] *= -1.0
    largest = float(np.abs(terms).max(initial=0.0))
    return float(np.abs(terms.sum(axis=1)).max()) / largest if largest > 0.0 else 0.0
