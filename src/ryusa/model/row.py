"""A row of water columns along a stream: its fixed properties, its ends, and its state."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ryusa.laws._family import numbers
from ryusa.laws.families import Buoyancy, Drive, Pressure, SurfaceRule
from ryusa.laws.porous import ergun_linear, ergun_quadratic
from ryusa.model.arrays import Floats
from ryusa.model.column import Column, Top
from ryusa.model.course import Course
from ryusa.model.eddies import Eddies
from ryusa.model.flow import Field, Flow
from ryusa.model.row_energy import N_ROW_TERM
from ryusa.printed import ByShape

Ints = NDArray[np.int64]
NAN = float("nan")
AGREE = 1.0e-9  # permitted relative difference of the length of a periodic row and the period of grains
OPEN, WALL, INFLOW = range(3)  # kinds of a station
DEPTH_GIVEN, SAME_DEPTH = range(2)  # rules of the segment beyond an end
N_BUDGET = 14  # numbers of the momentum budget of a station, as `momentum_balance` writes them
_HYDROSTATIC, _ = numbers(__name__, Pressure.HYDROSTATIC, Pressure.FULL)
STEEPEST = math.radians(20.0)  # largest angle between bottom and x axis


class EndKind(IntEnum):
    """What lies beyond an end of a row."""

    WALL = 0  # nothing passes
    LEVEL = 1  # water at rest with a given surface
    FREE_FALL = 2  # a drop, no water
    UNIFORM = 3  # the depth of the last segment; where the flow leaves supercritical, or is uniform
    DISCHARGE = 4  # a given discharge enters


@dataclass(frozen=True)
class RowEnd:
    """One end of a row."""

    kind: EndKind
    level: float = NAN  # height of the surface for LEVEL [m]
    discharge: float = NAN  # for DISCHARGE [m2/s]
    profile: Floats | None = None  # its speeds to any scale, shape (n,); None: uniform
    depth: float = NAN  # of the entering water [m], where it is supercritical; nan: that of the row
    developed: bool = False  # profile, and the depth of supercritical flow, of steady flow
    course: Course | None = None  # of level or discharge over time; the two above are those at the start


@dataclass(frozen=True)
class PorousSolid:
    """A fixed porous solid in the cells of the segments, such as a bed or a dam of grains at rest.

    Its force on the water per volume of mixture is rho (linear u + quadratic |u| u), with u in the pores, and
    it has the buoyancy of the form `stress`. Each array has the shape (n_segment, n).
    """

    phi: Floats  # concentration [-]
    linear: Floats  # [1/s]
    quadratic: Floats  # [1/m]

    @staticmethod
    def of_grains(phi: Floats, d: float, nu: float, *, inertia: bool = True) -> "PorousSolid":
        """Grains at rest, of phi [-] and d [m], in water of nu [m2/s], by Ergun's law; else Darcy's."""
        linear = np.array([[ergun_linear(one, d, nu) for one in row] for row in phi.tolist()])
        quadratic = np.array([[ergun_quadratic(one, d) * inertia for one in row] for row in phi.tolist()])
        return PorousSolid(phi, linear, quadratic)


@dataclass(frozen=True)
class RowDam:
    """A dam, a weir or a sill of a row, by its name."""

    name: str
    first: int  # segment
    end: int  # segment after the last
    crest: float  # height over the x axis [m]
    porous: bool = False
    aerated: bool = False  # air lies below the nappe behind it


@dataclass(frozen=True, repr=False)
class ColumnRow(Flow):
    """Fixed properties of a row of n_segment segments; without ends it is periodic."""

    column: Column  # of each station, its heights measured from the bottom
    dx: float  # length of a segment [m]
    bottom: Floats  # height of the bottom over the x axis [m], shape (n_segment,)
    g_z: float  # gravity normal to the x axis [m/s2]; `column.g_x` is that along it
    upstream: RowEnd | None = None
    downstream: RowEnd | None = None
    solid: Ints | None = None  # lowest cells of each segment that are solid, as in a dam; None: none
    x_low: float = 0.0  # where the first segment begins [m]
    porous: PorousSolid | None = None  # in the cells
    start: Floats | None = None  # height of the surface at the start [m], (n_segment,)
    dams: tuple[RowDam, ...] = ()  # names of what `solid` and `porous` hold
    pressure: Pressure = Pressure.HYDROSTATIC
    GROUP: ClassVar[str] = "row"  # of its datasets in a run folder

    @property
    def n_segment(self) -> int:
        """Number of segments."""
        return len(self.bottom)

    @property
    def periodic(self) -> bool:
        """Whether the last segment is followed by the first."""
        return self.upstream is None and self.downstream is None

    @property
    def hydrostatic(self) -> bool:
        """Whether the pressure is the weight of the water above."""
        return int(self.pressure) == _HYDROSTATIC

    @property
    def inner(self) -> slice:
        """The segments of the row among all that a state holds: one lies beyond each open end."""
        return slice(0, self.n_segment) if self.periodic else slice(1, self.n_segment + 1)

    @property
    def x(self) -> Floats:
        """Middles of the segments [m], shape (n_segment,)."""
        return self.x_low + (np.arange(self.n_segment, dtype=np.float64) + 0.5) * self.dx

    @property
    def x_station(self) -> Floats:
        """Where the stations are [m], shape (n_station,)."""
        return self.x_low + np.arange(self.n_segment + (not self.periodic), dtype=np.float64) * self.dx

    @property
    def stations_between(self) -> tuple[Ints, Ints]:
        """The segments before and behind each station, numbered as in a state, shape (n_station,)."""
        n = self.n_segment
        if self.periodic:
            return (np.arange(n) - 1) % n, np.arange(n)
        return np.arange(n + 1), np.arange(n + 1) + 1

    @property
    def interval(self) -> int:
        """Largest coupling interval [steps]."""
        return self.column.interval

    @property
    def text(self) -> str:
        """What it is, in words."""
        return f"a row of {self.n_segment} columns of {self.column.n} cells of water"

    def account(self, found: Mapping[str, Any]) -> str:
        """What is said at the end of a run of the numbers in its summary."""
        courant = f"Courant number at most {found['courant']:.2g}; per width {found['volume']:.4g} m2 in it"
        first = f"discharge {found['discharge_first']:.4g} m2/s"
        end = f"momentum imbalance {found['momentum_residual']:.1e} of the largest term"
        if found["grains"]:
            return (
                f"{found['exchanges']} exchanges with grains in a row of columns, the last after "
                f"{found['steps_between']} steps; {courant}; {first}; {end}"
            )
        return (
            f"{found['steps']} steps of a row, {courant}, {found['entered']:.4g} m2 entered and "
            f"{found['left']:.4g} m2 left; {first} upstream and "
            f"{found['discharge_last']:.4g} m2/s downstream; {end}"
        )

    def segment_at(self, x: Floats) -> Ints:
        """Number of the segment at places along x [m], beyond an end of that there, same shape."""
        return np.clip(np.floor((x - self.x_low) / self.dx), 0, self.n_segment - 1).astype(np.int64)

    def first_surface(self, x: Floats) -> Floats:
        """Height of the surface at the start at places along x [m], same shape; -inf if not given."""
        return np.full(x.shape, -np.inf) if self.start is None else self.start[self.segment_at(x)]

    @property
    def floor(self) -> Floats:
        """Height of the bottom, or of the top of solid cells on it [m], shape (n_segment,)."""
        return self.bottom if self.solid is None else self.bottom + self.solid * self.column.dz

    @property
    def places(self) -> dict[str, int]:
        """Segments from upstream on, stations between them, cells and faces of each; terms of `RowTerm`.

        Beyond each open end lies one segment that is filled as well.
        """
        n, segments = self.column.n, self.n_segment
        along = {"segment": segments, "filled": segments + 2 * (not self.periodic)}
        return {**along, "station": len(self.x_station), "cell": n, "face": n + 1, "term": N_ROW_TERM}

    def fields(self) -> dict[str, Field]:
        """What a run folder keeps of the water at a frame."""
        own = {
            "pressure": Field(
                "Pa", ("segment", "cell")
            ),  # beyond the hydrostatic one, below the surface's cell
            "w_faces": Field("m/s", ("segment", "face")),  # vertical speed of the water
        }
        return ({} if self.hydrostatic else own) | {
            "surface": Field("m", ("segment",)),  # its height; that of the bottom where it is dry
            "volume": Field("m", ("segment",)),  # water per area
            "content": Field("m", ("segment", "cell")),  # the part in each cell
            "phi": Field("-", ("segment", "cell")),  # concentration of grains, fixed ones included
            "discharge": Field("m2/s", ("station",)),  # what passed in the last step of the water, per width
            "passed": Field("m2", ("station",)),  # what has passed since the start, per width
            "tau": Field("Pa", ("station",)),  # shear stress of the water at the bottom
            "u": Field("m/s", ("station", "cell")),  # speed along x
            "w": Field("m/s", ("station", "cell")),  # and upwards
            "energy": Field("J/m", ("term",)),  # energy account since the start, per width
        }

    def tilted(self, g_x: float, g_z: float) -> "ColumnRow":
        """The same row with another gravity along and normal to the x axis [m/s2]."""
        return replace(self, column=replace(self.column, g_x=g_x), g_z=g_z)

    def with_ends(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of the segments, and beyond open ends those of the segment beside, in a new array."""
        if self.periodic:
            return np.array(values)
        return np.concatenate([values[:1], values, values[-1:]])

    def bottom_with_ends(self) -> Floats:
        """Heights of the bottom, continued as a line beyond open ends [m]."""
        b = self.with_ends(self.bottom)
        if not self.periodic and self.n_segment > 1:
            b[0], b[-1] = 2.0 * b[1] - b[2], 2.0 * b[-2] - b[-3]
        return b

    def solid_cells(self) -> Ints:
        """Number of solid cells of each segment; beyond an end with the flow of the row, as beside it."""
        solid = self.with_ends(np.zeros(self.n_segment, np.int64) if self.solid is None else self.solid)
        for at, end in ((0, self.upstream), (-1, self.downstream)):
            solid[at] *= end is None or end.kind >= EndKind.UNIFORM
        return solid

    def cells_of_dams(self) -> Ints:
        """Number of the lowest cells of each segment that a dam takes, seeping ones too, ends included."""
        taken, first = self.solid_cells(), self.inner.start
        for dam in self.dams:
            if dam.porous:
                over = (dam.crest - self.bottom[dam.first : dam.end]) / self.column.dz
                taken[first + dam.first : first + dam.end] = np.round(over).astype(np.int64)
        return taken

    def refuses(self) -> tuple[str, ...]:
        """Reasons why this row cannot be solved, one sentence each; () if there are none."""
        c = self.column
        faults = list(c.refuses(in_row=True))
        if (self.upstream is None) != (self.downstream is None):
            faults.append("a row has two ends, or is periodic and has none")
        if not self.dx > 0.0:
            faults.append(f"dx = {self.dx:g} m: must be above 0")
        if not self.g_z > 0.0:
            faults.append(f"g_z = {self.g_z:g} m/s2: must be above 0")
        if c.surface is not SurfaceRule.VOLUME:
            faults.append("the surface of a row follows from its water: keep the volume, not the depth")
        if c.top is not Top.FREE:
            faults.append("a row has a free surface: no lid")
        if c.drive in (Drive.DISCHARGE, Drive.TAU) and not (self.periodic and self.n_segment == 1):
            faults.append(
                f"driver {c.drive.word}: in a row of several segments the flow has no gradient of its own; "
                "give gravity, a pressure gradient, or a discharge at the upstream end"
            )
        elif c.drive in (Drive.DISCHARGE, Drive.TAU) and not self.hydrostatic:
            faults.append(
                f"driver {c.drive.word}: it takes a hydrostatic pressure; give gravity or a pressure gradient"
            )
        if self.solid is not None and (
            self.solid.shape != self.bottom.shape or self.solid.min() < 0 or self.solid.max() >= c.n
        ):
            faults.append(f"solid: one number of 0 to {c.n - 1} cells for each of {self.n_segment} segments")
        for name, end in (("upstream", self.upstream), ("downstream", self.downstream)):
            faults += [] if end is None else _faults_of_end(name, end, c.n)
        faults += [fault for dam in self.dams if dam.aerated for fault in self._faults_of_air(dam)]
        if not faults and self.n_segment:
            steepest = float(np.abs(np.arctan(np.diff(self.bottom) / self.dx)).max(initial=0.0))
            if steepest > STEEPEST:
                faults.append(
                    f"the bottom is inclined to the x axis by up to {math.degrees(steepest):.1f} deg: at "
                    f"most {math.degrees(STEEPEST):g} deg; turn the axis, or make steps of solid cells"
                )
        return tuple(faults)

    def _faults_of_air(self, dam: RowDam) -> list[str]:
        """Why air cannot lie behind a dam, one sentence each."""
        solid, i = self.solid_cells()[self.inner], dam.end
        why = {
            f"water falls freely with pressure {Pressure.FULL.word!r} alone": self.hydrostatic,
            "in a periodic row it could land upstream of the dam": self.periodic,
            "water leaves a porous dam below its crest": dam.porous,
            "the row ends behind it": i >= self.n_segment,
            "what stands behind it is as high": i < self.n_segment and not solid[i] < solid[i - 1],
        }
        return [f"dam '{dam.name}', aerated: {text}" for text, so in why.items() if so]

    def refuses_grains(self, buoyancy: Buoyancy, period: float) -> tuple[str, ...]:
        """Reasons why it cannot carry grains of a period along x [m], one sentence each; () if it can."""
        faults = list[str]()
        why = {
            Buoyancy.WEIGHT: "counts the slope of the surface twice",
            Buoyancy.PRESSURE: "lets still water among grains run down an inclined axis",
        }
        if buoyancy is not Buoyancy.STRESS:
            faults.append(
                f"water.buoyancy = {buoyancy.word!r}: in a row of columns it {why[buoyancy]}; take "
                f"{Buoyancy.STRESS.word!r}"
            )
        length = self.n_segment * self.dx
        if self.periodic and not math.isclose(length, period, rel_tol=AGREE):
            faults.append(
                f"the row is {length:.12g} m long, the period of the grains {period:.12g} m: must agree"
            )
        if not self.periodic and math.isfinite(period):
            faults.append(f"the row has ends, and the grains have the period {period:g} m: leave it out")
        return tuple(faults)


def _faults_of_end(name: str, end: RowEnd, n: int) -> list[str]:
    """Faults of one end, one sentence each."""
    faults: list[str] = []
    if end.kind is EndKind.LEVEL and not math.isfinite(end.level):
        faults.append(f"{name}: this end needs the height of its surface, level")
    if end.kind is EndKind.DISCHARGE:
        if name == "downstream":
            faults.append("downstream: a discharge can only be given at the upstream end")
        if not end.discharge >= 0.0 or math.isinf(end.discharge):
            faults.append(f"{name}: discharge = {end.discharge:g} m2/s: must be 0 or above")
        if end.profile is not None and (end.profile.shape != (n,) or not (end.profile > 0.0).all()):
            faults.append(f"{name}: profile: {n} speeds above 0")
        if not math.isnan(end.depth) and not end.depth > 0.0:
            faults.append(f"{name}: depth = {end.depth:g} m: must be above 0")
    return faults


@dataclass(frozen=True, repr=False)
class RowState(ByShape):
    """The water of a row at one moment; arrays are read-only. Segments beyond open ends are included.

    Cells above the surface have the speed of the surface. `profiles`, `edges` and `budgets` are those of the
    last step at every station, as `momentum_balance` writes them.
    """

    u: Annotated[Floats, "station", "cell"]  # speed along x at the stations [m/s]
    volume: Annotated[Floats, "filled"]  # water per area of a segment [m]
    content: Annotated[Floats, "filled", "cell"]  # the part in each cell [m]
    wet: Annotated[Floats, "filled", "cell"]  # wet thickness of each cell [m]
    surface: Annotated[Floats, "filled"]  # height of the surface above the bottom, plus z_low [m]
    passed: Annotated[Floats, "station"]  # water that has passed each station since the start [m2]
    profiles: Annotated[Floats, "station", 6, "cell"]  # u, w, content, shear, du_dt, dtau_dz
    edges: Annotated[Floats, "station", 2, "face"]  # stress [Pa] and eddy viscosity [m2/s] at the faces
    budgets: Annotated[Floats, "station", N_BUDGET]  # momentum budget
    # energy account since the start [J/m], indexed by RowTerm
    energy: Annotated[Floats, "term"] = field(default_factory=lambda: np.zeros(N_ROW_TERM))
    # with a pressure of its own: vertical speed at the faces [m/s], and pressure beyond the hydrostatic one
    # over density, in the cells below that of the surface [m2/s2]
    w: Annotated[Floats, "filled", "face"] | None = None
    pressure: Annotated[Floats, "filled", "cell"] | None = None
    t: float = 0.0  # [s]
    steps: int = 0  # steps of the water done
    courant: float = 0.0  # largest Courant number met [-]


@dataclass(frozen=True, repr=False)
class RowGrainState(ByShape):
    """What the grains of a row know of its water between two exchanges.

    Attributes
    ----------
    x : their centres at the last exchange [m], for their volumes in the cells, shape (n_grain, 3).
    w : vertical speed of the water in the segments, relative to the bottom [m/s], shape (n_all, n).
    force_z : force of the water on the grains along z per volume of the cell [N/m3], shape (n_all, n).
    u : speed of the water at the stations as free grains meet it [m/s], shape (n_station, n).
    eddies : present eddies of the grains; None without fluctuations.
    du_dt, moves : acceleration along x [m/s2], (n_station, n), and push upwards on added mass [N/m3],
        (n_all, n), as they were told; None where the pressure is hydrostatic.
    """

    x: Annotated[Floats, "grain", 3]
    w: Annotated[Floats, "filled", "cell"]
    force_z: Annotated[Floats, "filled", "cell"]
    u: Annotated[Floats, "station", "cell"]
    eddies: Eddies | None = None
    du_dt: Annotated[Floats, "station", "cell"] | None = None
    moves: Annotated[Floats, "filled", "cell"] | None = None


@dataclass(frozen=True, repr=False)
class RowCouplingState(ByShape):
    """State of a row of a run between two exchanges, complete for a resume.

    Attributes
    ----------
    water : water since the last exchange.
    steps : steps of the engine in the present coupling interval.
    due : step of the next exchange.
    exchanges : number of exchanges so far.
    worst : largest residual of the momentum of a station over its largest term so far [-].
    passing : what passed each station in the last interval, per time and width [m2/s], shape (n_station,).
    grains : None without free and fixed grains.
    """

    water: RowState
    steps: int
    due: int
    exchanges: int
    worst: float
    passing: Annotated[Floats, "station"]
    grains: RowGrainState | None = None

    def fault(self, touched: int) -> str:
        """Why this is no state of a row that so many grains touch; "" where it is one."""
        water, grains = self.water, self.grains
        if min(water.volume.min(), water.content.min(), water.wet.min()) < 0.0:
            return "a negative amount of water"
        if water.pressure is not None and grains is not None and grains.du_dt is None:
            return "a row without the accelerations that its grains were told"
        return "a row of water without its grains" if touched and grains is None else ""
