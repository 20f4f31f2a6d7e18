"""Keys of [water.column]."""

from typing import Annotated

from pydantic import Field

from ryusa.casefile.quantities import (
    Count,
    Length,
    Number,
    PositiveLength,
    PressureGradient,
    UnitDischarge,
    WordOf,
)
from ryusa.casefile.section import Section
from ryusa.laws import families

# keys of [water] that have an effect only with profile "column"
ONLY_IN_A_COLUMN = (
    "buoyancy",
    "hindrance",
    "hindrance_exponent",
    "lift",
    "lift_coefficient",
    "magnus",
    "column",
    "row",
)
CELL = 0.1  # thickness of a cell when the case gives none, in mean diameters


class ColumnSection(Section):
    """The column of water over the bed, averaged over x and y, that exchanges momentum with the grains."""

    cell: PositiveLength | None = None
    """Thickness of a cell; a tenth of the mean diameter when not given."""
    bottom: Length | None = None
    """Height of the lowest cell face. When not given: over a moving bed the lower edge of the lowest grain or
    the floor, over a fixed bed the zero of the water."""
    bed: Annotated[str, WordOf(families.BedKind)] = "moving"
    """Lower boundary of the water: grains whose drag brings it to rest, the rough bed of Eq. (9), or a smooth
    wall."""
    surface: Annotated[str, WordOf(families.SurfaceRule)] | None = None
    """What is held constant while grains move: the height of the surface or the volume of water. When not
    given the height, and in a row the volume."""
    drive: Annotated[str, WordOf(families.Drive)] = "slope"
    """What drives the water: the slope alone, or beside it a pressure gradient: the one that gives the stress
    water.tau_star (or u_star) at the zero of the water, the one given, or the one that keeps the discharge
    constant."""
    pressure_gradient: PressureGradient | None = None
    """-dp/dx of drive = "pressure gradient"; positive drives towards +x."""
    discharge: UnitDischarge | None = None
    """Discharge of water per width of drive = "discharge"."""
    start: Annotated[str, WordOf(families.Start)] | None = None
    """State of the water at the start: at rest, or in steady flow. Steady flow is computed over a moving bed
    with the grains settled to the concentration `packed`, over a fixed bed without free grains; it is the
    default, except without drag and in a row."""
    mixing_length: Annotated[str, WordOf(families.Mixing)] | None = None
    """Mixing length of the turbulence: kappa times the integral of (packed - phi)/packed over height (default
    over a moving bed), the same bounded in shear layers (in a row), kappa z, kappa z
    sqrt(1 - z/depth) of Nezu (default over a fixed bed), kappa z with van Driest's damping at the wall, or no
    turbulence."""
    kappa: Annotated[Number, Field(gt=0, le=1)] = 0.41
    """Von Karman constant."""
    packed: Annotated[Number, Field(gt=0, lt=1)] | None = None
    """Concentration phi_max of Li and Sawamoto, that of the bed at rest: where the concentration averaged
    over the height of a grain reaches it, and below, the mixing length is zero. When not given 0.61, and in
    a plane scene 0.55 times mean diameter over slab width. A run warns when the bed never reaches it."""
    pore_eddies: Annotated[Number, Field(ge=0, le=10)] = 0.0
    """Coefficient k_f of the turbulence in the pores of a debris flow (Egashira); 0.16 in the source, 0 for
    none."""
    side_walls: PositiveLength | None = None
    """Distance between two smooth side walls that slow the water; no side walls when not given."""
    side_friction: Annotated[str, WordOf(families.SideWalls)] = "Blasius"
    """Friction law of turbulent water at the side walls."""
    fluctuations: Annotated[str, WordOf(families.Fluctuations)] = "none"
    """Turbulent velocity fluctuations at each grain beside the mean velocity: none, or a random walk with the
    strength of the turbulent stress and the time scale at which the eddy viscosity spreads momentum."""
    interval: Annotated[Count, Field(ge=1, le=100_000)] = 50
    """Most steps between two exchanges of momentum of water and grains; fewer where the drag is stiff."""

    @property
    def mixing(self) -> str:
        """Mixing length given, or the default of the bed."""
        return self.mixing_length or ("Li-Sawamoto" if self.bed == "moving" else "parabolic")
