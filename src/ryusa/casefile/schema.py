"""The case file as types: every key, its unit, its range and its meaning. Values are SI once read."""

import math
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, PrivateAttr, Tag

from ryusa.casefile.builders import Build
from ryusa.casefile.column import Column
from ryusa.casefile.quantities import (
    Acceleration,
    Angle,
    Count,
    Dashpot,
    Density,
    Duration,
    Force,
    Length,
    Moment,
    Number,
    Point,
    PositiveLength,
    Ratio,
    Speed,
    Stiffness,
    Viscosity,
)

if TYPE_CHECKING:
    from ryusa.casefile.derive import Derived
    from ryusa.casefile.explain import Row

FROZEN = ConfigDict(frozen=True, extra="forbid", populate_by_name=True, use_attribute_docstrings=True)
STEEPEST = 1.5  # slope angles stay below 86 deg [rad]


class Section(BaseModel):
    """A table of the case file; an unknown key in it is an error."""

    model_config = FROZEN


class Spread(Section):
    """How grain sizes scatter about their mean."""

    kind: Literal["uniform", "normal", "lognormal"] = "uniform"
    """Shape of the size distribution; normal and lognormal are cut at 2.5 standard deviations."""
    ratio: Number = Field(ge=0, lt=0.9)
    """Half width (uniform) or standard deviation over the mean diameter."""


def _spread_kind(value: Any) -> str:
    return "<number>" if isinstance(value, (int, float, str)) else "<table>"


class Grains(Section):
    """The free grains."""

    diameter: Annotated[Length, Field(ge=1.0e-7, le=1.0e3)]
    """Mean diameter d; with a table of grains the one that u_star, roughness and overlap/d refer to."""
    density: Annotated[Density, Field(ge=1.0, le=1.0e6)]
    """Density of the grain material, rho_s."""
    spread: Annotated[
        Annotated[Ratio, Field(ge=0, lt=0.9), Tag("<number>")] | Annotated[Spread, Tag("<table>")],
        Discriminator(_spread_kind),
    ] = 0.0
    """Scatter of sizes: a number means uniform within +-that part of the mean."""
    shape_volume: Annotated[Number, Field(gt=0, le=1)] = math.pi / 6
    """A_3: volume over d cubed; pi/6 for a sphere."""


class StiffnessForOverlap(Section):
    """Stiffness asked for by the largest overlap it allows."""

    overlap: Annotated[Number, Field(gt=0, le=0.5)]
    """Largest overlap over d in one impact on a fixed grain."""
    speed: Annotated[Speed, Field(gt=0)]
    """Impact speed at which that overlap is reached."""


class StiffnessForTime(Section):
    """Stiffness asked for by the collision time of Eq. (8)."""

    collision_time: Duration
    """Time a grain stays in touch with a fixed one, Eq. (8), added mass counted."""


def _stiffness_kind(value: Any) -> str:
    """Branch of what the file holds, and of what is held already, for writing it again."""
    if isinstance(value, StiffnessForTime):
        return "<time>"
    if isinstance(value, StiffnessForOverlap):
        return "<overlap>"
    if isinstance(value, dict):
        return "<time>" if "collision_time" in value else "<overlap>"
    return "<value>"


class Contact(Section):
    """Springs, dashpots and slider of every contact, Eqs. (1)-(4)."""

    stiffness: Annotated[
        Annotated[Annotated[Stiffness, Field(ge=1.0e-9, le=1.0e15)], Tag("<value>")]
        | Annotated[StiffnessForOverlap, Tag("<overlap>")]
        | Annotated[StiffnessForTime, Tag("<time>")],
        Discriminator(_stiffness_kind),
    ]
    """Normal stiffness k_n, or { overlap, speed }, or { collision_time }."""
    shear_ratio: Annotated[Number, Field(ge=0, le=10)] | None = None
    """k_s over k_n; 2/7 when neither this nor shear_stiffness is given."""
    shear_stiffness: Annotated[Stiffness, Field(ge=0, le=1.0e15)] | None = None
    """Tangential stiffness k_s, instead of shear_ratio."""
    restitution: Annotated[Number, Field(gt=0, le=1)] | None = None
    """Normal restitution e, reached on fixed grains and between grains alike."""
    restitution_shear: Annotated[Number, Field(gt=0, le=1)] | None = None
    """Tangential restitution e_s; the normal one when not given."""
    damping: Annotated[Dashpot, Field(ge=0, le=1.0e12)] | None = None
    """Normal dashpot eta_n as a constant, instead of restitution."""
    shear_damping: Annotated[Dashpot, Field(ge=0, le=1.0e12)] | None = None
    """Tangential dashpot eta_s as a constant; zero when only damping is given."""
    friction_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] | None = None
    """Internal friction angle phi of Eq. (4)."""
    friction: Annotated[Number, Field(ge=0, le=1.0e6)] | None = None
    """Friction coefficient mu = tan(phi), instead of friction_angle."""
    cohesion: Annotated[Force, Field(ge=0)] = 0.0
    """Grain-level cohesion c of Eq. (4)."""
    slip: Literal["spring", "spring-drop", "total"] = "spring"
    """What the Coulomb cap holds: the spring (dashpot kept or dropped in sliding), or spring plus dashpot."""
    cap: Literal["spring", "total"] | None = None
    """Normal force that feeds the cap: spring e_n, or total f_n (the default of slip = "total")."""
    parting: Literal["no tension", "tension"] = "no tension"
    """May the normal dashpot pull before the overlap ends."""


class Rolling(Section):
    """Rolling friction, Eq. (13) and its variants."""

    model: Literal["none", "printed", "constant", "spring-dashpot-slider"] = "none"
    """Eq. (13) as printed, constant torque against the relative spin, or an elastic-plastic spring."""
    arm: Literal["contact width", "reduced radius"] | None = None
    """Length that turns the coefficient into a lever arm; contact width as in Eq. (13), but the
    spring-dashpot-slider always takes the reduced radius."""
    coefficient: Annotated[Number, Field(ge=0)] = 0.0
    """f' of Eq. (13) (contact width) or mu_r (reduced radius)."""
    stiffness_factor: Annotated[Number, Field(gt=0)] = 2.25
    """Rolling stiffness over k_n times lever arm squared, spring-dashpot-slider only."""
    damping_ratio: Annotated[Number, Field(ge=0)] = 0.3
    """Damping ratio of the rolling spring, spring-dashpot-slider only."""


class Motion(Section):
    """How grains may move, and the gravity that pulls them."""

    rotation: Literal["locked", "free"]
    """May grains spin."""
    plane: bool = True
    """Motion in the x-z plane only, or in three dimensions."""
    slope: Annotated[Ratio, Field(ge=-14, le=14)] | None = None
    """Bed slope as a tangent, down towards +x; 0 when no slope is given."""
    slope_angle: Annotated[Angle, Field(ge=-STEEPEST, le=STEEPEST)] | None = None
    """Bed slope as an angle, instead of slope."""
    gravity: Annotated[Acceleration, Field(ge=0, le=1.0e4)] = 9.80665
    """Acceleration of gravity g."""
    slab_width: PositiveLength | None = None
    """Width of a plane scene for concentrations; the mean diameter when not given."""


class Domain(Section):
    """Periods, world box and guards."""

    period_x: PositiveLength | None = None
    """Period along the bed; the builder's when not given."""
    period_y: PositiveLength | None = None
    """Period across; the builder's when not given."""
    low: Point | None = None
    """Lower corner of the world; a grain beyond it is lost and stops the run."""
    high: Point | None = None
    """Upper corner of the world."""
    overlap_limit: Annotated[Number, Field(gt=0, le=1)] = 0.5
    """Overlap over the smaller diameter that stops the run."""


class Plane(Section):
    """A flat wall with the same contact law."""

    name: Annotated[str, Field(min_length=1, max_length=64)]
    """Name of the plane, for the timeline."""
    point: Point
    """A point on the plane."""
    normal: tuple[Number, Number, Number]
    """Direction into the free side; need not have length 1."""


class Water(Section):
    """Water: profile, drag, added mass, torque, Eqs. (9)-(11); or a column of water that feels the grains."""

    profile: Literal["log rough", "log smooth", "uniform", "still", "column"]
    """Velocity over height: Eq. (9), smooth wall, plug flow, or water at rest, all given once and for all;
    or a column of water that grains slow down and stir, see `water.column`."""
    tau_star: Annotated[Number, Field(gt=0)] | None = None
    """Dimensionless shear stress; gives u_star from grain density, g and mean d. In a column what
    drive = "tau_star" asks for, and with drive = "slope" a number to hold slope and depth against."""
    u_star: Annotated[Speed, Field(gt=0)] | None = None
    """Friction velocity, instead of tau_star."""
    roughness: PositiveLength | None = None
    """Equivalent roughness k_s of Eq. (9), also of a column over a rough bed; the mean diameter when not
    given."""
    zero: Length | None = None
    """Height z where the profile begins, and of the bed that the depth is counted from; the builder's choice
    when not given."""
    speed: Speed | None = None
    """Speed of the uniform profile."""
    depth: PositiveLength | None = None
    """Water depth above the zero; unlimited when not given, which a column cannot be."""
    above: Literal["continue", "hold", "dry"] = "continue"
    """Above the depth: the profile goes on, the surface speed goes on, or (dry) the water neither drags nor
    turns a grain; buoyancy and added mass stay as under water."""
    density: Annotated[Density, Field(ge=1.0e-3, le=1.0e6)] = 1000.0
    """Density of water, rho_w."""
    viscosity: Annotated[Viscosity, Field(ge=1.0e-12, le=1.0e3)] = 1.0e-6
    """Kinematic viscosity nu."""
    drag: Literal[
        "24/Re+0.4",
        "24/Re+2",
        "constant",
        "Schiller-Naumann",
        "Ferguson-Church sphere",
        "Ferguson-Church sand",
        "none",
    ] = "24/Re+0.4"
    """Law of the drag coefficient C_D."""
    drag_coefficient: Annotated[Number, Field(ge=0)] = 0.4
    """C_D of drag = "constant"."""
    shape_area: Annotated[Number, Field(gt=0, le=2)] = math.pi / 4
    """A_2: area over d squared; pi/4 for a sphere."""
    added_mass: Annotated[Number, Field(ge=0, le=5)] = 0.5
    """Added-mass coefficient C_M."""
    torque: Literal["none", "Stokes", "Dennis"] = "none"
    """Torque of the water on a spinning grain."""
    rebound: Literal["dry", "exponential", "Davis"] = "dry"
    """Restitution of a contact in water: that of [contact], or less by the Stokes number St of its first
    touch, times exp(-St_c/St) (Legendre et al.) or times 1 + ln(2 asperity/d)/St (Davis et al.)."""
    rebound_stokes: Annotated[Number, Field(gt=0, le=1.0e4)] = 35.0
    """St_c of rebound = "exponential"."""
    rebound_least: Annotated[Number, Field(gt=0, le=1)] = 0.01
    """Least restitution that a rebound leaves; a dashpot for none at all would be infinite."""
    film: Literal["none", "lubrication"] = "none"
    """Force of the film of water between grains that do not touch; instead of a rebound, which counts it."""
    film_reach: PositiveLength | None = None
    """Gap below which films act; a quarter of the mean diameter when not given."""
    asperity: PositiveLength | None = None
    """Thickness of the film at which grains touch, for rebound = "Davis" and for films."""
    buoyancy: Literal["stress", "weight", "pressure"] = "stress"
    """Only in a column. Force of the water beside drag, lift and added mass: pressure and shear stress
    carry a grain as they do water (design/0007), the weight of its volume of water as in Eqs. (10)-(11), or
    the pressure normal to the bed alone."""
    hindrance: Literal["none", "Richardson-Zaki", "power", "Wen-Yu", "Gidaspow", "Di Felice"] = "Di Felice"
    """Only in a column. How neighbours change the drag of a grain."""
    hindrance_exponent: Annotated[Number, Field(ge=0, le=20)] | None = None
    """n of hindrance = "Richardson-Zaki", by Rowe from the settling velocity of a lone grain when not given;
    m of hindrance = "power"."""
    lift: Literal["none", "Wiberg-Smith", "Saffman-Mei"] = "none"
    """Only in a column. Lift by the shear of the water."""
    lift_coefficient: Annotated[Number, Field(ge=0, le=10)] = 0.2
    """C_L of lift = "Wiberg-Smith"."""
    magnus: Literal["none", "Rubinow-Keller", "Loth", "Oesterle-Dinh"] = "none"
    """Only in a column. Lift by the spin of a grain against that of the water."""
    column: Column | None = None
    """The column of water of profile = "column"."""


class Time(Section):
    """The time step."""

    steps_per_contact: Annotated[Number, Field(ge=10, le=10_000)] | None = None
    """Steps within the shortest contact that can occur; 50 when no step is given."""
    step: Duration | None = None
    """Time step dt, instead of steps_per_contact."""


class Rest(Section):
    """What counts as everything at rest."""

    speed: Annotated[Speed, Field(gt=0)]
    """Every grain is slower than this ..."""
    duration: Annotated[Duration, Field(alias="for")]
    """... for this long."""


class Stop(Section):
    """When the run ends: whichever comes first; at least one is needed."""

    time: Duration | None = None
    """Simulated time."""
    saltations: Annotated[Count, Field(ge=1)] | None = None
    """Saltations done by every start after the settling time."""
    rest: Rest | None = None
    """All grains at rest."""


class Change(Section):
    """One change of the scene while it runs: exactly one besides `at`."""

    at: Moment
    """When."""
    remove: str | None = None
    """Name of the group of fixed grains or of the plane that goes."""
    slope: Annotated[Ratio, Field(ge=-14, le=14)] | None = None
    """New bed slope as a tangent."""
    slope_angle: Annotated[Angle, Field(ge=-STEEPEST, le=STEEPEST)] | None = None
    """New bed slope as an angle."""
    friction_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] | None = None
    """New internal friction angle."""
    friction: Annotated[Number, Field(ge=0, le=1.0e6)] | None = None
    """New friction coefficient."""
    rotation: Literal["locked", "free"] | None = None
    """Spin locked or set free."""


class Record(Section):
    """What the run folder keeps."""

    frames: Duration = 1.0e-3
    """Time between frames."""
    events: Literal["all", "tracked", "none"] | None = None
    """Contacts recorded: all, those of tracked grains, or none; when not given, all up to 1000 free grains
    or where saltations end the run, else none."""
    tracked: tuple[Annotated[Count, Field(ge=0)], ...] = ()
    """Ids of tracked grains."""
    settle: Moment = 0.0
    """Measures ignore what is before."""


class Case(Section):
    """A checked case in SI; made by `casefile.read`."""

    title: Annotated[str, Field(max_length=200)] = ""
    """What this case is about."""
    seed: Annotated[Count, Field(ge=0, lt=2**63)] = 1
    """The one seed of all randomness."""
    grains: Grains
    contact: Contact
    rolling: Rolling = Rolling()
    motion: Motion
    domain: Domain = Domain()
    planes: tuple[Plane, ...] = ()
    """Flat walls."""
    water: Water | None = None
    """Water; a dry case leaves it out."""
    build: Build
    """First grains: kind names the builder, its keys stand beside it."""
    time: Time = Time()
    stop: Stop
    timeline: tuple[Change, ...] = ()
    """Changes of the scene, in order of time."""
    record: Record = Record()

    _text: str = PrivateAttr("")
    _path: Path | None = PrivateAttr(None)
    _overrides: dict[str, str] = PrivateAttr(default_factory=lambda: {})

    @property
    def text(self) -> str:
        """The case file as the user wrote it, overrides not applied."""
        return self._text

    @property
    def path(self) -> Path | None:
        """Where the case was read from; None for a case given as text."""
        return self._path

    @property
    def overrides(self) -> dict[str, str]:
        """Keys set from outside the file."""
        return dict(self._overrides)

    @property
    def name(self) -> str:
        """Name for folders: that of the file without its ending."""
        return self._path.stem if self._path is not None else "case"

    @cached_property
    def derived(self) -> "Derived":
        """Everything that follows from the case: masses, stiffness, damping, step, friction velocity."""
        from ryusa.casefile.derive import derive

        return derive(self)

    def explain(self) -> "list[Row]":
        """Rows of name, value, unit and origin that explain the case back; for `ryusa check`."""
        from ryusa.casefile.explain import explain

        return explain(self)

    def resolved(self) -> dict[str, Any]:
        """Give the case as plain data in SI, what follows filled in; for case.json."""
        from ryusa.casefile.derive import resolved

        return resolved(self)
