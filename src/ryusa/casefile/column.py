"""Keys of [water.column]: cells, boundaries, driver and turbulence of water that feels the grains."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from ryusa.casefile.quantities import (
    Count,
    Length,
    Number,
    PositiveLength,
    PressureGradient,
    UnitDischarge,
)

Mixing = Literal["Li-Sawamoto", "Prandtl", "parabolic", "van Driest", "none"]
# keys of [water] beside this table that only a column understands
ONLY_IN_A_COLUMN = (
    "buoyancy",
    "hindrance",
    "hindrance_exponent",
    "lift",
    "lift_coefficient",
    "magnus",
    "column",
)
CELL = 0.1  # thickness of a cell when the case gives none, in mean diameters
PACKED, PACKED_PLANE = 0.61, 0.55  # of a bed at rest; in a plane, spheres in a slab one diameter wide


class Column(BaseModel):
    """The column of water over the bed, averaged over x and y."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    cell: PositiveLength | None = None
    """Thickness of a cell; a tenth of the mean diameter when not given."""
    bottom: Length | None = None
    """Height of the lowest face; over a moving bed the lower edge of the lowest grain or the floor when not
    given, over a fixed bed the zero of the water."""
    bed: Literal["moving", "rough", "smooth"] = "moving"
    """What the water meets at the bottom: grains whose drag stops it, the rough bed of Eq. (9), or a smooth
    wall."""
    surface: Literal["depth", "volume"] = "depth"
    """What stays when grains come and go: the height of the surface, or the volume of the water."""
    drive: Literal["slope", "tau_star", "pressure gradient", "discharge"] = "slope"
    """What drives the water beside gravity along the slope: nothing, or the pressure gradient that gives the
    stress of water.tau_star (or u_star) at the zero of the water, that is given, or that keeps the
    discharge."""
    pressure_gradient: PressureGradient | None = None
    """-dp/dx of drive = "pressure gradient"; positive drives towards +x."""
    discharge: UnitDischarge | None = None
    """Discharge of water per width of drive = "discharge"."""
    start: Literal["steady", "rest"] | None = None
    """How the water begins: at rest, or flowing steadily, over a moving bed as if the grains lay there as
    dense as `packed`, over a fixed one as if there were no free grains; steady when not given, and at rest
    where there is no drag."""
    mixing_length: Mixing | None = None
    """Mixing length of the eddies: kappa times the integral of (packed - phi)/packed (over a moving bed when
    not given), kappa z, kappa z sqrt(1 - z/depth) of Nezu (over a fixed bed when not given), kappa z with
    van Driest's damping at the wall, or no eddies."""
    kappa: Annotated[Number, Field(gt=0, le=1)] = 0.41
    """Constant of von Karman."""
    packed: Annotated[Number, Field(gt=0, lt=1)] | None = None
    """Concentration phi_max of Li and Sawamoto: no eddy grows where it is reached, averaged over the height
    of a grain, nor below. When not given 0.61, and in a plane 0.55 times mean diameter over slab width. It
    must be what the bed at rest reaches; a run tells when it never did."""
    pore_eddies: Annotated[Number, Field(ge=0, le=10)] = 0.0
    """k_f of the eddies in the pores of a debris flow, Egashira; 0.16 in the source, 0 for none."""
    side_walls: PositiveLength | None = None
    """Width between two smooth side walls that slow the water; none when not given."""
    side_friction: Literal["Blasius", "Karman-Prandtl"] = "Blasius"
    """Friction of turbulent water at the side walls."""
    fluctuations: Literal["none", "random walk"] = "none"
    """Turbulent speeds that grains meet beside the mean: none, or those of eddies that each grain walks
    through, as strong as the turbulent stress and as long as fluid needs to spread like momentum."""
    interval: Annotated[Count, Field(ge=1, le=100_000)] = 50
    """Steps between two exchanges of water and grains, at most; fewer where drag is stiff."""

    @property
    def mixing(self) -> Mixing:
        """Mixing length, chosen by the bed where the case gives none."""
        return self.mixing_length or ("Li-Sawamoto" if self.bed == "moving" else "parabolic")
