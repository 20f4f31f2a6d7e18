"""Keys of [water]."""

import math
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from ryusa.casefile.column.schema import ColumnSection
from ryusa.casefile.quantities import Density, Length, Number, PositiveLength, Speed, Viscosity, WordOf
from ryusa.casefile.row.schema import RowSection
from ryusa.casefile.section import Section
from ryusa.casefile.water.temperature import density_of_water, read_temperature, viscosity_of_water
from ryusa.laws import families

RIVALS = (("tau_star", "u_star"),)


class WaterSection(Section):
    """The water: its velocity profile, Eq. (9), drag, added mass and torque, Eqs. (10)-(11)."""

    profile: Annotated[str, WordOf(families.Profile)]
    """Velocity over height: Eq. (9), the log law of a smooth wall, the same speed everywhere, water at rest,
    or a column that exchanges momentum with the grains (see `water.column`)."""
    tau_star: Annotated[Number, Field(gt=0)] | None = None
    """Dimensionless shear stress; gives u_star with the grain density, g and the mean diameter. In a column
    the stress that drive = "tau_star" keeps up; with drive = "slope" it is compared with slope and depth."""
    u_star: Annotated[Speed, Field(gt=0)] | None = None
    """Friction velocity, instead of tau_star."""
    roughness: PositiveLength | None = None
    """Equivalent roughness k_s of Eq. (9), also of a column over a rough bed; the mean diameter when not
    given."""
    zero: Length | None = None
    """Height z at which the profile begins and from which the depth is measured; set by the builder when not
    given."""
    speed: Speed | None = None
    """Speed of the uniform profile."""
    depth: PositiveLength | None = None
    """Water depth above the zero; unlimited when not given. A column needs it."""
    above: Annotated[str, WordOf(families.Above)] = "continue"
    """Speed above the depth: that of the profile, that of the surface, or (dry) neither drag nor torque;
    buoyancy and added mass stay as under water."""
    density: Annotated[Density, Field(ge=1.0e-3, le=1.0e6)] = 1000.0
    """Density of water, rho_w."""
    viscosity: Annotated[Viscosity, Field(ge=1.0e-12, le=1.0e3)] = 1.0e-6
    """Kinematic viscosity nu."""
    temperature: (
        Annotated[
            float,
            BeforeValidator(read_temperature),
            WithJsonSchema({"type": "string", "title": "temperature", "examples": ["15 degC", "59 degF"]}),
        ]
        | None
    ) = None
    """Temperature of fresh water, "0 degC" to "40 degC": gives density and viscosity where they are not
    given."""
    drag: Annotated[str, WordOf(families.Drag)] = "Schiller-Naumann"
    """Law of the drag coefficient C_D; the default is that of smooth spheres, natural sand of the same
    diameter settles more slowly ("Ferguson-Church sand")."""
    drag_coefficient: Annotated[Number, Field(ge=0)] = 0.4
    """C_D of drag = "constant"."""
    drag_of_form: Annotated[str, WordOf(families.DragOfForm)] = "Bagheri-Bonadonna"
    """Law of the drag coefficient of clumps (`grains.shape`), by their sphericity or their three axes;
    "sphere" takes that of `drag`. Spheres always take `drag`."""
    shape_area: Annotated[Number, Field(gt=0, le=2)] = math.pi / 4
    """A_2: projected area of a grain over d squared; pi/4 for a sphere."""
    added_mass: Annotated[Number, Field(ge=0, le=5)] = 0.5
    """Added-mass coefficient C_M."""
    torque: Annotated[str, WordOf(families.WaterTorque)] = "none"
    """Torque of the water on a rotating grain."""
    rebound: Annotated[str, WordOf(families.Rebound)] = "dry"
    """Restitution of a contact under water: "dry" takes that of [contact]; the others reduce it by the Stokes
    number St at first touch, times exp(-St_c/St) (Legendre et al.) or times 1 + ln(2 asperity/d)/St (Davis
    et al.)."""
    rebound_stokes: Annotated[Number, Field(gt=0, le=1.0e4)] = 35.0
    """St_c of rebound = "exponential"."""
    rebound_least: Annotated[Number, Field(gt=0, le=1)] = 0.01
    """Lower bound of the restitution under water; zero would need an infinite dashpot."""
    film: Annotated[str, WordOf(families.Film)] = "none"
    """Force of the water film between grains that approach but do not touch. Exclusive with a rebound other
    than "dry", which includes the effect of the film."""
    film_reach: PositiveLength | None = None
    """Gap below which the film force acts; a quarter of the mean diameter when not given."""
    asperity: PositiveLength | None = None
    """Height of the surface asperities, the film thickness at which grains touch; needed by rebound = "Davis"
    and film = "lubrication"."""
    buoyancy: Annotated[str, WordOf(families.Buoyancy)] = "stress"
    """Column only. Force of the undisturbed water on a grain, beside drag, lift and added mass: pressure and
    shear stress as on an equal volume of water (design/0007), the weight of that volume as in
    Eqs. (10)-(11), or the pressure normal to the bed alone."""
    hindrance: Annotated[str, WordOf(families.Hindrance)] = "Di Felice"
    """Column only. How neighbouring grains change the drag."""
    hindrance_exponent: Annotated[Number, Field(ge=0, le=20)] | None = None
    """n of hindrance = "Richardson-Zaki", when not given that of Rowe at the settling velocity of a single
    grain; m of hindrance = "power"."""
    lift: Annotated[str, WordOf(families.Lift)] = "none"
    """Column only. Lift due to the shear of the water."""
    lift_coefficient: Annotated[Number, Field(ge=0, le=10)] = 0.2
    """C_L of lift = "Wiberg-Smith"."""
    magnus: Annotated[str, WordOf(families.Magnus)] = "none"
    """Column only. Lift due to the rotation of a grain relative to the water."""
    column: ColumnSection | None = None
    """The column of water of profile = "column"."""
    row: RowSection | None = None
    """Columns in a row along the stream instead of one, with profile = "column": a river."""

    @model_validator(mode="before")
    @classmethod
    def _by_temperature(cls, data: Any) -> Any:
        """Put density and viscosity where the temperature alone is given."""
        if not isinstance(data, dict) or data.get("temperature") is None:
            return data
        try:
            t = read_temperature(data["temperature"])
        except ValueError:
            return data  # reported with its key
        if "density" in data and "viscosity" in data and isinstance(data["temperature"], str):
            raise ValueError(
                "temperature has no effect beside density and viscosity: leave one of the three out"
            )
        made = {
            "density": f"{density_of_water(t):.9g} kg/m3",
            "viscosity": f"{viscosity_of_water(t):.9g} m2/s",
        }
        return made | data
