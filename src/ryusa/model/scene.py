"""Fixed data of a run: sizes and masses of grains, bed, planes, laws, water, time step."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.laws.families import (
    Above,
    Adhesion,
    Arm,
    Buoyancy,
    Cap,
    ContactForce,
    ContactTiming,
    Drag,
    DragOfForm,
    Hindrance,
    Lift,
    Magnus,
    Profile,
    Rebound,
    Rolling,
    Slip,
    Unloading,
    WaterTorque,
)
from ryusa.model.arrays import Bools, Floats
from ryusa.model.column import Column
from ryusa.model.feeds import Traffic
from ryusa.model.flow import Flow
from ryusa.model.rigid_bodies import RigidBodies
from ryusa.model.row import ColumnRow
from ryusa.model.walls import Walls
from ryusa.printed import ByShape

_INF = float("inf")


class Damping(IntEnum):
    """How the dashpots are determined."""

    RESTITUTION = 0  # from the restitution of the case and the effective mass of the pair
    CONSTANTS = 1  # eta_n, eta_s given in N s/m


class EventRule(IntEnum):
    """Which contacts are recorded."""

    NONE = 0
    TRACKED = 1
    ALL = 2


@dataclass(frozen=True, repr=False)
class ContactLaw(ByShape):
    """Springs, dashpots and slider of every contact, Eqs. (1)-(4).

    With elastic spheres k_n and k_s are those of linear springs of the same contact time at `speed`, for a
    mean grain on a fixed one: rolling springs and estimates take them.
    """

    k_n: float  # normal stiffness [N/m]
    k_s: float  # tangential stiffness [N/m]
    mu: float  # tan(friction angle) [-]
    cohesion: float = 0.0  # grain-level cohesion c [N]
    damping: Damping = Damping.RESTITUTION
    e_n: float = float("nan")  # restitution of the case [-]; nan if the dashpots are constants
    e_s: float = float("nan")
    zeta_n: float = 0.0  # damping ratio that gives e_n under `tension` [-]
    zeta_s: float = 0.0
    eta_n: float = 0.0  # dashpots [N s/m], used if damping is CONSTANTS
    eta_s: float = 0.0
    slip: Slip = Slip.TOTAL
    cap: Cap = Cap.TOTAL
    tension: bool = False  # whether the dashpot may pull before the overlap ends
    timing: ContactTiming = ContactTiming.EXACT
    # elastic spheres, HERTZ_MINDLIN; contacts begin and end at steps then
    force: ContactForce = ContactForce.LINEAR
    youngs_modulus: float = float("nan")  # [Pa]
    poisson_ratio: float = float("nan")  # [-]
    unloading: Unloading = Unloading.RESCALED
    speed: float = float("nan")  # impact speed to be expected [m/s]
    adhesion: Adhesion = Adhesion.NONE  # contacts begin and end at steps then
    adhesion_amount: float = 0.0  # pull-off force [N], work of adhesion [J/m2] or energy density [Pa]


# Fields of ContactLaw that are the same for all pairs of materials.
ALIKE = ("cohesion", "damping", "slip", "cap", "tension", "timing", "force", "unloading", "adhesion")
# Fields of ContactLaw that only elastic spheres have.
ONLY_HERTZ = ("force", "youngs_modulus", "poisson_ratio", "unloading", "speed")
# Fields of ContactLaw that only adhesive contacts have.
ONLY_ADHESIVE = ("adhesion", "adhesion_amount")


@dataclass(frozen=True, repr=False)
class RollingLaw(ByShape):
    """Rolling friction, Eq. (13) and its variants."""

    model: Rolling = Rolling.NONE
    arm: Arm = Arm.CONTACT_WIDTH
    coefficient: float = 0.0  # f' (contact width) or mu_r (reduced radius) [-]
    stiffness_factor: float = 2.25  # EPSD: k_r = factor * k_n * f**2, f = mu_r R* [-]
    zeta_r: float = 0.3  # EPSD: damping ratio of the rolling spring [-]
    twisting: float = 0.0  # largest torque about the normal over f_n R*, in space [-]; 0: none


@dataclass(frozen=True, repr=False)
class Materials(ByShape):
    """Materials of grains and walls, and the contact of each two of them (design/0020)."""

    names: tuple[str, ...]
    of: NDArray[np.int8]  # number of the material of each id, shape (n_partner,)
    contact: tuple[ContactLaw, ...]  # of materials a and b at a n + b; that of b and a is the same
    rolling: tuple[RollingLaw, ...]  # as `contact`

    @property
    def n(self) -> int:
        """Number of materials."""
        return len(self.names)

    def pair_name(self, k: int) -> str:
        """Name of pair k of `contact`."""
        return f"'{self.names[k // self.n]}' and '{self.names[k % self.n]}'"


@dataclass(frozen=True, repr=False)
class Water(ByShape):
    """One-way water: a velocity profile, a drag law, added mass and a torque, Eqs. (9)-(11)."""

    profile: Profile = Profile.NONE
    u_star: float = 0.0  # friction velocity [m/s]
    k_rough: float = 0.0  # equivalent roughness of Eq. (9) [m]
    z_zero: float = 0.0  # height of z = 0 in the profile [m]
    u_uniform: float = 0.0  # speed of the uniform profile [m/s]
    depth: float = float("inf")  # depth above z_zero [m]
    above: Above = Above.CONTINUE
    nu: float = 1.0e-6  # kinematic viscosity [m2/s]
    rho_w: float = 1000.0  # density [kg/m3]
    drag: Drag = Drag.NONE
    c_d: float = 0.4  # constant drag coefficient [-]
    drag_of_form: DragOfForm = DragOfForm.SPHERE  # of clumps
    a_2: float = float(np.pi / 4)  # area coefficient of Eq. (10) [-]
    c_m: float = 0.5  # added-mass coefficient [-]
    torque: WaterTorque = WaterTorque.NONE
    # the film between two grains, and between a grain and a wall
    rebound: Rebound = Rebound.DRY
    st_c: float = 35.0  # Stokes number of EXPONENTIAL [-]
    e_least: float = 0.01  # smallest restitution with a film [-]; a dashpot for 0 is infinite
    asperity: float = 0.0  # thickness of the film at which grains touch [m]
    film_reach: float = 0.0  # gap below which the film exerts a force before touch [m]; 0: no force
    # only with profile COLUMN
    buoyancy: Buoyancy = Buoyancy.WEIGHT
    hindrance: Hindrance = Hindrance.NONE
    hindrance_exponent: float = 3.1  # n of Richardson-Zaki, m of POWER [-]
    lift: Lift = Lift.NONE
    c_l: float = 0.2  # lift coefficient of Wiberg & Smith [-]
    magnus: Magnus = Magnus.NONE


@dataclass(frozen=True, repr=False)
class Scene(ByShape):
    """All data that are fixed during a run, or between two changes of its timeline.

    Free grains have ids 0 to n_grain - 1, fixed grains n_grain to n_grain + n_fixed - 1; planes follow, then
    faces of walls. With feeds they include those that have not entered yet (design/0021).
    """

    # free grains, each of shape (n_grain,)
    d: Floats  # diameter [m]
    m: Floats  # mass [kg], without added mass
    m_added: Floats  # added mass [kg]; 0 when dry
    m_weight: Floats  # submerged mass, (rho_s - rho_w) V [kg]
    inertia: Floats  # moment of inertia [kg m2], without added mass
    # bed and walls
    x_fixed: Floats  # centres of fixed grains [m], shape (n_fixed, 3)
    d_fixed: Floats  # their diameters [m], shape (n_fixed,)
    fixed_active: Bools  # False once removed (a gate), shape (n_fixed,)
    plane_normal: Floats  # unit normals pointing into the free side, shape (n_plane, 3)
    plane_point: Floats  # a point on each plane [m], shape (n_plane, 3)
    plane_active: Bools  # shape (n_plane,)
    # laws and forces
    contact: ContactLaw
    dt: float  # [s]
    gravity: Floats = field(default_factory=lambda: np.array([0.0, 0.0, -9.80665]))  # [m/s2], shape (3,)
    rolling: RollingLaw = field(default_factory=RollingLaw)
    rotation: bool = True  # False: spin locked at zero
    water: Water = field(default_factory=Water)
    flow: Flow | None = None  # what the water that feels the grains moves in, with profile COLUMN
    traffic: Traffic | None = None  # feeds and exits; None: the grains are always the same
    # space
    plane_case: bool = False  # motion in x-z only; y, v_y, omega_x, omega_z are constant
    period: tuple[float, float] = (float("inf"), float("inf"))  # period in x and y [m]; inf if not periodic
    world_low: tuple[float, float, float] = (-_INF, -_INF, -_INF)  # limits of the domain [m]
    world_high: tuple[float, float, float] = (_INF, _INF, _INF)
    slab_width: float = float("nan")  # width of a plane scene, for concentrations [m]
    # guards and records
    overlap_limit: float = 0.5  # overlap over smaller diameter that stops the run [-]
    events: EventRule = EventRule.ALL
    forces: bool = False  # contact forces are recorded with every frame
    tracked: Bools = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))  # (n_grain,) or empty
    # names of groups, for timeline and measures: slices of the ids above
    groups: dict[str, tuple[int, int]] = field(default_factory=lambda: {})
    walls: Walls | None = None  # finite walls, at rest or moving
    materials: Materials | None = None  # None: all contacts are those of `contact` and `rolling`
    bodies: RigidBodies | None = None  # clumps, whose spheres are free grains

    @property
    def n_grain(self) -> int:
        """Number of free grains, with those that a feed will bring."""
        return len(self.d)

    def whole_grains(self) -> tuple[Floats, Floats]:
        """Diameters [m] and masses [kg] of grains, each clump as one, of the sphere of the same volume."""
        if self.bodies is None:
            return self.d, self.m
        alone = np.ones(self.n_grain, np.bool_)
        alone[self.bodies.members] = False
        return np.concatenate([self.d[alone], self.bodies.d]), np.concatenate([self.m[alone], self.bodies.m])

    @property
    def heads(self) -> Bools:
        """Whether each sphere is a grain of its own or the first of a clump, shape (n_grain,)."""
        heads = np.ones(self.n_grain, np.bool_)
        if self.bodies is not None:
            heads[self.bodies.members], heads[self.bodies.first] = False, True
        return heads

    def spheres_of(self, ids: NDArray[np.int64]) -> NDArray[np.int64]:
        """Ids of free grains with those of all members of their clumps, ascending."""
        if self.bodies is None:
            return np.sort(ids)
        of = self.bodies.of_grain(self.n_grain)[ids]
        members = self.bodies.members[self.bodies.rows(np.unique(of[of >= 0]))]
        return np.sort(np.concatenate([ids[of < 0], members]))

    def of_heads(self) -> tuple[Floats, Floats]:
        """Diameters [m] and masses [kg] by id; the first member of a clump has those of the clump."""
        d, m = self.d.copy(), self.m.copy()
        if self.bodies is not None:
            d[self.bodies.first], m[self.bodies.first] = self.bodies.d, self.bodies.m
        return d, m

    @property
    def d_mean(self) -> float:
        """Mean diameter of the free grains, each clump as the sphere of its volume [m]."""
        return float(self.whole_grains()[0].mean())

    @property
    def d_min(self) -> float:
        """Smallest diameter of free and fixed grains [m]; inf without any."""
        return float(np.concatenate([self.d, self.d_fixed]).min(initial=np.inf))

    @property
    def d_max(self) -> float:
        """Largest diameter of free and fixed grains [m]; 0 without any."""
        return float(np.concatenate([self.d, self.d_fixed]).max(initial=0.0))

    @property
    def solid_volume(self) -> Floats:
        """Volume of each sphere [m3], shape (n_grain,); of a member of a clump its share of the clump."""
        ball = np.pi / 6.0 * self.d**3
        if self.bodies is not None:
            bodies, members = self.bodies, self.bodies.members
            whole = np.repeat(np.pi / 6.0 * bodies.d**3 / bodies.m, bodies.count)
            ball[members] = whole * self.m[members]
        return ball

    @property
    def column(self) -> Column | None:
        """The flow, if it is one column of water."""
        return self.flow if isinstance(self.flow, Column) else None

    @property
    def row(self) -> ColumnRow | None:
        """The flow, if it is columns of water along the stream."""
        return self.flow if isinstance(self.flow, ColumnRow) else None

    @property
    def coupled(self) -> bool:
        """Whether water feels the grains."""
        return self.flow is not None

    @property
    def n_fixed(self) -> int:
        """Number of fixed grains, including removed ones."""
        return len(self.d_fixed)

    @property
    def n_plane(self) -> int:
        """Number of planes, including removed ones."""
        return len(self.plane_normal)

    @property
    def n_face(self) -> int:
        """Number of faces of walls, including removed ones."""
        return 0 if self.walls is None else self.walls.n_face

    @property
    def n_wall(self) -> int:
        """Number of walls, including removed ones; planes do not count."""
        return 0 if self.walls is None else self.walls.n_wall

    @property
    def has_servo(self) -> bool:
        """Whether a servo presses one of the walls."""
        return self.walls is not None and len(self.walls.servo) > 0

    @property
    def n_partner(self) -> int:
        """Number of ids: grains, fixed grains, planes and faces of walls."""
        return self.n_grain + self.n_fixed + self.n_plane + self.n_face

    def of_pair(self, k: int) -> "Scene":
        """The same scene in which all contacts are those of pair k of its materials."""
        made = self.materials
        assert made is not None
        return replace(self, contact=made.contact[k], rolling=made.rolling[k], materials=None)

    def by_pair(self, i: NDArray[np.int64], j: NDArray[np.int64]) -> Iterator[tuple["Scene", Any]]:
        """Scenes of one contact law each, and which of the pairs i, j of ids have it."""
        made = self.materials
        if made is None:
            yield self, slice(None)
            return
        pair = made.of[i].astype(np.int64) * made.n + made.of[j]
        for k in np.unique(pair).tolist():
            yield self.of_pair(k), pair == k
