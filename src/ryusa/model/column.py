"""The water column over a bed: its fixed properties, its state, and its momentum budget."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Annotated, Any, ClassVar

import numpy as np

from ryusa.laws.families import BedKind, Drive, Fluctuations, Mixing, SideWalls, Start, SurfaceRule
from ryusa.model.arrays import Floats
from ryusa.model.eddies import Eddies
from ryusa.model.flow import Field, Flow
from ryusa.printed import ByShape

NAN = float("nan")
AGREE = 0.02  # permitted relative difference of two inputs for the same quantity, because of rounding
STIFF = 0.25  # longest coupling interval over the relaxation time of drag


class Top(IntEnum):
    """Boundary at the top of the water."""

    FREE = 0  # a surface without stress
    LID = 1  # a plate that moves at u_lid, viscous stress in the highest half cell


@dataclass(frozen=True, repr=False)
class Column(Flow):
    """Fixed properties of a column of n equal cells, averaged along and across the bed."""

    z_low: float  # bottom [m]
    dz: float  # thickness of a cell [m]
    n: int  # number of cells
    depth: float  # height of the surface above z_bed [m]; the initial one if the volume is constant
    area: float = 1.0  # area of bed [m2]
    z_bed: float = NAN  # zero of the logarithmic law, where tau is prescribed [m]; nan: z_low
    rho_w: float = 1000.0  # density [kg/m3]
    nu: float = 1.0e-6  # kinematic viscosity [m2/s]
    # boundaries
    bed: BedKind = BedKind.NO_SLIP
    k_rough: float = NAN  # equivalent roughness of Eq. (9) [m]
    top: Top = Top.FREE
    u_lid: float = 0.0  # speed of the lid [m/s]
    surface: SurfaceRule = SurfaceRule.DEPTH
    side: SideWalls = SideWalls.NONE
    width: float = NAN  # distance of the side walls [m]
    # driver
    g_x: float = 0.0  # gravity along the bed, g sin(slope) [m/s2]
    drive: Drive = Drive.GRAVITY
    gradient: float = 0.0  # -dp/dx for GRADIENT [Pa/m]
    tau: float = NAN  # for TAU: rho_w u_star**2 [Pa]
    discharge: float = NAN  # of water per unit width, for DISCHARGE [m2/s]
    # turbulence
    mixing: Mixing = Mixing.LAMINAR
    kappa: float = 0.41  # von Karman's constant [-]; ln(10)/5.75 = 0.40045 goes with Eq. (9)
    phi_max: float = 0.61  # of LI_SAWAMOTO [-]
    # Coefficient of turbulence in the pores of a debris flow [-]; 0: none, 0.16 in the source
    k_f: float = 0.0
    d: float = NAN  # diameter of the grains [m], for k_f and for averaging phi in LI_SAWAMOTO
    fluctuations: Fluctuations = Fluctuations.NONE
    seed: int = 0  # of the random walk
    # exchange with the grains
    # largest coupling interval [steps]
    interval: int = 50  # pyright: ignore[reportIncompatibleMethodOverride] # read as the property is
    start: Start = Start.REST
    GROUP: ClassVar[str] = "water"  # of its datasets in a run folder

    @property
    def origin(self) -> float:
        """Height of the bed [m]: z_bed, or z_low if it is not given."""
        return self.z_low if math.isnan(self.z_bed) else self.z_bed

    @property
    def z_high(self) -> float:
        """Top of the highest cell [m]."""
        return self.z_low + self.n * self.dz

    @property
    def z_surface(self) -> float:
        """Initial height of the water surface [m]."""
        return self.origin + self.depth

    @property
    def z(self) -> Floats:
        """Heights of the cell centres [m], shape (n,)."""
        return self.z_low + (np.arange(self.n, dtype=np.float64) + 0.5) * self.dz

    @property
    def faces(self) -> Floats:
        """Heights of the cell faces [m], shape (n + 1,)."""
        return self.z_low + np.arange(self.n + 1, dtype=np.float64) * self.dz

    @property
    def text(self) -> str:
        """What it is, in words."""
        return f"a column of {self.n} cells of water"

    def account(self, found: Mapping[str, Any]) -> str:
        """What is said at the end of a run of the numbers in its summary."""
        return (
            f"{found['exchanges']} exchanges with grains, the last after {found['steps_between']} steps; "
            f"discharge {found['discharge']:.3g} m2/s; stress at the bottom of the column "
            f"{found['bed_stress']:.3g} Pa; momentum imbalance {found['momentum_residual']:.1e} "
            "of the largest term"
        )

    @property
    def places(self) -> dict[str, int]:
        """Cells of the column, and the faces between and around them."""
        return {"cell": self.n, "face": self.n + 1}

    def fields(self) -> dict[str, Field]:
        """What a run folder keeps of the water at a frame."""
        return {
            "u": Field("m/s", ("cell",)),  # speed along the bed
            "w": Field("m/s", ("cell",)),  # and upwards
            "phi": Field("-", ("cell",)),  # concentration of grains, fixed ones included
            "content": Field("m", ("cell",)),  # water in a cell per area of bed
            "tau": Field("Pa", ("face",)),  # shear stress of the water; the bed's is the first
            "nu_t": Field("m2/s", ("face",)),  # eddy viscosity
            "z_surface": Field("m"),  # height of the surface
            "gradient": Field("Pa/m"),  # -dp/dx that drives the water in addition to gravity
        }

    def tilted(self, g_x: float, g_z: float) -> "Column":
        """The same column with another gravity along the bed [m/s2]."""
        del g_z
        return replace(self, g_x=g_x)

    def first_surface(self, x: Floats) -> Floats:
        """Height of the surface at the start at places along x [m], same shape."""
        return np.full(x.shape, self.z_surface)

    def refuses(self, in_row: bool = False) -> tuple[str, ...]:
        """Reasons why this column cannot be solved, one sentence each; () if there are none."""
        faults = list(refuse(depth=self.depth, dz=self.dz, n=self.n, z_low=self.z_low, z_bed=self.origin))
        for name in ("area", "rho_w", "nu", "kappa", "phi_max"):
            if not getattr(self, name) > 0.0:
                faults.append(f"{name} = {getattr(self, name):g}: must be above 0")
        if self.bed is not BedKind.MOVING and abs(self.origin - self.z_low) > 1e-9 * abs(self.dz):
            faults.append(
                f"z_bed = {self.origin:g} m: a fixed bed is the bottom of the column, {self.z_low:g} m"
            )
        if self.bed is BedKind.ROUGH:
            if not self.k_rough > 0.0:
                faults.append(f"k_rough = {self.k_rough:g} m: a rough bed needs a roughness above 0")
            elif self.dz <= self.k_rough / 15.0:
                faults.append(
                    f"dz = {self.dz:g} m: Eq. (9) is zero below k_rough/30 = {self.k_rough / 30.0:.3g} m, "
                    f"and the middle of the lowest cell must lie above; ten times as much is a good choice"
                )
        if self.bed is BedKind.MOVING and "wall" in self.mixing.marks:
            faults.append(f"mixing length {self.mixing.word} needs a wall: choose another over a moving bed")
        if not in_row and "layers" in self.mixing.marks:
            faults.append(f"mixing length {self.mixing.word} is that of a row of columns: choose another")
        if self.top is Top.LID and self.surface is SurfaceRule.VOLUME:
            faults.append("a lid holds the surface in its place: keep the depth, not the volume")
        if self.side is not SideWalls.NONE and not self.width > 0.0:
            faults.append(f"width = {self.width:g} m: side walls need a width above 0")
        if self.drive is Drive.TAU and not math.isfinite(self.tau):
            faults.append("tau: this driver needs the stress asked for at the bed")
        if self.drive is Drive.DISCHARGE and not math.isfinite(self.discharge):
            faults.append("discharge: this driver needs the discharge asked for")
        if self.k_f < 0.0 or (self.k_f > 0.0 and not self.d > 0.0):
            faults.append(f"k_f = {self.k_f:g}, d = {self.d:g} m: eddies in pores need both above 0")
        return tuple(faults)


@dataclass(frozen=True, repr=False)
class WaterState(ByShape):
    """The water at one moment; cells above the surface have the speed of the surface. Arrays are read-only.

    It includes the values that the grains use during the next coupling interval, so that a resume is exact.
    """

    u: Annotated[Floats, "cell"]  # velocity along the bed [m/s]
    w: Annotated[Floats, "cell"]  # vertical velocity of the water from eps w + phi w_p = 0 [m/s]
    content: Annotated[Floats, "cell"]  # water per area of bed in each cell [m]
    shear: Annotated[Floats, "cell"]  # dU/dz at the cell centres [1/s]
    du_dt: Annotated[Floats, "cell"]  # acceleration of the water, DU/Dt [m/s2]
    dtau_dz: Annotated[Floats, "cell"]  # gradient of the shear stress of the water [N/m3]
    tau: Annotated[Floats, "face"]  # shear stress of the water [Pa]; the first is that at the bed
    nu_t: Annotated[Floats, "face"]  # eddy viscosity at the faces [m2/s]
    z_surface: float  # height of the surface [m]
    volume: float  # water per area of bed [m], constant with SurfaceRule.VOLUME
    gradient: float = 0.0  # -dp/dx of the driver [Pa/m]
    t: float = 0.0  # [s]
    step: int = 0  # steps of the water done

    @staticmethod
    def at_rest(column: Column, phi: Floats) -> "WaterState":
        """Water at rest among grains of concentration phi [-], shape (n,), up to the depth of the column."""
        wet = np.clip(column.z_surface - column.faces[:-1], 0.0, column.dz)
        content = (1.0 - np.asarray(phi, dtype=np.float64)) * wet
        content.flags.writeable = False
        still = np.zeros(column.n)
        face = np.zeros(column.n + 1)
        still.flags.writeable = face.flags.writeable = False
        return WaterState(
            u=still,
            w=still,
            content=content,
            shear=still,
            du_dt=still,
            dtau_dz=still,
            tau=face,
            nu_t=face,
            z_surface=column.z_surface,
            volume=float(content.sum()),
        )


@dataclass(frozen=True, repr=False)
class CouplingState(ByShape):
    """State of the coupling between two exchanges; with `FluidAtGrains` complete for a resume.

    Attributes
    ----------
    water : water since the last exchange.
    z : heights of the free grains at the last exchange [m], for their volumes in the cells, shape (n_grain,).
    force_z : force of the water on the grains along z per volume of the cell [N/m3], shape (n,).
    steps : steps of the engine in the present coupling interval.
    due : step of the next exchange.
    exchanges : number of exchanges so far.
    worst : largest residual of the momentum of the water over its largest term so far [-].
    eddies : present eddies of the grains; None without fluctuations.
    """

    water: WaterState
    z: Annotated[Floats, "grain"]
    force_z: Annotated[Floats, "cell"]
    steps: int
    due: int
    exchanges: int
    worst: float
    eddies: Eddies | None = None

    def fault(self, touched: int) -> str:
        """Why this is no state of a column that so many grains touch; "" where it is one."""
        del touched
        return "a negative eddy viscosity" if (self.water.nu_t < 0.0).any() else ""


@dataclass(frozen=True)
class Budget:
    """Momentum budget of the water along the bed over one step: forces on the water per area of bed [Pa]."""

    change: float  # change of momentum over the step
    gravity: float  # weight along the slope
    driver: float  # pressure gradient times depth of water
    bed: float  # stress of the bed; negative if it slows the water
    lid: float  # stress of the lid
    side: float  # stress of the side walls
    grains: float  # force of the free grains
    carried: float  # part of the stress gradient that acts on the grains, with buoyancy `stress`
    surface: float  # momentum of water that passed through the surface
    fixed: float = 0.0  # force of the fixed grains

    @property
    def residual(self) -> float:
        """Difference between the change and the sum of the forces [Pa]; round-off."""
        gains = self.gravity + self.driver + self.bed + self.lid + self.side
        return self.change - (gains + self.grains + self.fixed + self.carried + self.surface)

    @property
    def relative(self) -> float:
        """Residual over the largest term [-]; 0 if all terms are zero."""
        terms = (self.change, self.gravity, self.driver, self.bed, self.lid, self.side, self.grains)
        largest = max(abs(one) for one in (*terms, self.fixed, self.carried, self.surface))
        return abs(self.residual) / largest if largest > 0.0 else 0.0


def refuse(
    *,
    depth: float,
    dz: float | None = None,
    n: int | None = None,
    z_low: float = 0.0,
    z_bed: float = 0.0,
    slope: float | None = None,
    tau_star: float | None = None,
    u_star: float | None = None,
    d: float | None = None,
    rho_s: float = 2650.0,
    rho_w: float = 1000.0,
    g: float = 9.80665,
) -> tuple[str, ...]:
    """Contradictions between the properties of a column, one sentence each; () if there are none.

    Parameters
    ----------
    depth : height of the surface above z_bed [m].
    dz, n, z_low : thickness [m] and number of the cells, and bottom of the column [m]; None if not given.
    z_bed : height of the bed [m].
    slope : angle of the bed [rad]; with 0 or None the water has another driver, which is not checked.
    tau_star, u_star : Shields number [-], friction velocity [m/s]; None if not given.
    d : mean diameter of the grains [m], needed with tau_star.
    rho_s, rho_w : densities [kg/m3].
    g : gravity [m/s2].

    Notes
    -----
    In steady uniform flow u_star**2 = g depth sin(slope) = tau_star (rho_s/rho_w - 1) g d.

    >>> refuse(depth=0.02, slope=math.atan(1 / 20), tau_star=0.3, d=0.002)  # the paper's saltation
    ()
    >>> refuse(depth=-0.01)
    ('depth = -0.01 m: the surface lies below the bed; depth counts upwards from the bed',)
    """
    faults = _faults_of_cells(depth, dz, n, z_low, z_bed)
    if tau_star is not None and not tau_star > 0.0:
        faults.append(f"tau_star = {tau_star:g}: must be above 0")
    if u_star is not None and not u_star > 0.0:
        faults.append(f"u_star = {u_star:g} m/s: must be above 0")
    if faults:
        return tuple(faults)
    return _contradictions(depth, slope, tau_star, u_star, d, rho_s, rho_w, g)


def _faults_of_cells(depth: float, dz: float | None, n: int | None, z_low: float, z_bed: float) -> list[str]:
    """What is wrong with the cells of a column, as `refuse`."""
    faults: list[str] = []
    if not depth > 0.0:
        faults.append(
            f"depth = {depth:g} m: the surface lies below the bed; depth counts upwards from the bed"
        )
    if dz is not None and not dz > 0.0:
        faults.append(f"dz = {dz:g} m: the thickness of a cell must be above 0")
    if n is not None and n < 2:
        faults.append(f"n = {n}: a column needs at least 2 cells")
    if z_low > z_bed:
        faults.append(f"the column begins at {z_low:g} m, above the bed at {z_bed:g} m")
    if not faults and dz is not None and n is not None:
        high = z_low + n * dz
        if high < z_bed:
            faults.append(f"the column ends at {high:g} m, below the bed at {z_bed:g} m")
        elif high < z_bed + depth - 1e-9 * dz:
            need = math.ceil((z_bed + depth - z_low) / dz - 1e-9)
            faults.append(
                f"the column ends at {high:g} m, below the surface at {z_bed + depth:g} m: {need} cells of "
                f"{dz:g} m reach it"
            )
    return faults


def _contradictions(
    depth: float,
    slope: float | None,
    tau_star: float | None,
    u_star: float | None,
    d: float | None,
    rho_s: float,
    rho_w: float,
    g: float,
) -> tuple[str, ...]:
    """Contradictions between stress, slope and depth, one sentence each."""
    says: list[tuple[str, float]] = []  # input, and the u_star**2 that follows from it [m2/s2]
    weight = (rho_s / rho_w - 1.0) * g * d if d is not None else NAN
    if tau_star is not None and d is not None:
        says.append((f"tau_star = {tau_star:g}", tau_star * weight))
    if u_star is not None:
        says.append((f"u_star = {u_star:g} m/s", u_star * u_star))
    if slope is not None and slope != 0.0:
        if slope < 0.0 and says:
            return (f"slope = {math.tan(slope):g}: a bed that rises downstream cannot drive the water",)
        says.append((f"slope = {math.tan(slope):.4g} and depth = {depth:g} m", g * depth * math.sin(slope)))
    faults: list[str] = []
    for k, (who, square) in enumerate(says):
        for other, asked in says[:k]:
            if abs(square - asked) > AGREE * max(square, asked):
                text = (
                    f"{other} and {who} contradict each other: u_star is {math.sqrt(asked):.4g} m/s by the "
                )
                text += f"first, {math.sqrt(square):.4g} m/s by the second"
                if who.startswith("slope") and slope is not None:
                    right = asked / (g * math.sin(slope))
                    tilt = asked / (g * depth)
                    text += f"; a depth of {right:.4g} m"
                    if tilt < 1.0:
                        text += f" or a slope of {math.tan(math.asin(tilt)):.4g}"
                    if weight > 0.0:
                        text += f" or tau_star = {square / weight:.4g}"
                    text += " would agree, or leave one of them out"
                faults.append(text)
    return tuple(faults)
