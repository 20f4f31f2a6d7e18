"""Keys of [grains] and [shapes.NAME]."""

import math
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, ValidationError, model_validator
from pydantic_core import InitErrorDetails

from ryusa.casefile.files import RelativePath
from ryusa.casefile.quantities import Boolean, GrainDensity, Length, Number, Ratio
from ryusa.casefile.section import Section
from ryusa.model.clump import MOST_SPHERES
from ryusa.model.filling import LEAST_FILLED

OWN_SIZES = ("diameter", "spread", "sieve_curve")  # keys of a material


class SpreadSection(Section):
    """Distribution of grain sizes about the mean diameter."""

    kind: Literal["uniform", "normal", "lognormal"] = "uniform"
    """Shape of the size distribution; normal and lognormal are cut at 2.5 standard deviations."""
    ratio: Number = Field(ge=0, lt=0.9)
    """Half width (uniform) or standard deviation (normal, lognormal) over the mean diameter."""


def _spread_kind(value: Any) -> str:
    return "<number>" if isinstance(value, (int, float, str)) else "<table>"


def _shape_kind(value: Any) -> str:
    return "<name>" if isinstance(value, str) else "<shares>"


def _curve_kind(value: Any) -> str:
    return "<file>" if isinstance(value, str) else "<points>"


GrainLength = Annotated[Length, Field(ge=1.0e-7, le=1.0e3)]
Spread = Annotated[
    Annotated[Ratio, Field(ge=0, lt=0.9), Tag("<number>")] | Annotated[SpreadSection, Tag("<table>")],
    Discriminator(_spread_kind),
]
ShapeName = RelativePath
Percent = Annotated[Number, Field(ge=0, le=100)]
CurvePoints = Annotated[tuple[tuple[GrainLength, Percent], ...], Field(min_length=2, max_length=1000)]


class GrainsSection(Section):
    """The free grains."""

    diameter: GrainLength | None = None
    """Mean diameter d, needed without a sieve_curve; with a table of grains or a sieve_curve, the reference
    diameter of u_star, roughness, overlap/d and fixed grains, in a sieve_curve D50 when not given."""
    density: GrainDensity
    """Density of the grain material, rho_s."""
    buoyant: Boolean = False
    """true: grains may be lighter than the water, and rise, as pumice does."""
    spread: Spread = 0.0
    """Spread of the sizes: a number is the half width of a uniform distribution over the mean diameter."""
    sieve_curve: (
        Annotated[
            Annotated[RelativePath, Tag("<file>")] | Annotated[CurvePoints, Tag("<points>")],
            Discriminator(_curve_kind),
        ]
        | None
    ) = None
    """Sizes by mass: pairs of diameter and percent finer, from 0 to 100, such as [["1 mm", 0], ["2 mm", 30],
    ["4 mm", 100]], or a CSV file in the folder of the case with the header diameter [mm],finer [%]. Straight
    over log d between two pairs. Builders packing, flume, box, fill, empty and
    stream."""
    finest: GrainLength | None = None
    """Smallest grain of the sieve_curve that is laid; the mass of finer ones is left out."""
    coarsest: GrainLength | None = None
    """Largest grain of the sieve_curve that is laid; the mass of coarser ones is left out."""
    shape: Annotated[
        Annotated[RelativePath, Tag("<name>")]
        | Annotated[
            dict[ShapeName, Annotated[Number, Field(gt=0, le=1)]],
            Tag("<shares>"),
        ],
        Discriminator(_shape_kind),
    ] = "sphere"
    """Form of the free grains: "sphere", a clump of the library ("dumbbell", "pebble", "rod", "triangle",
    "tetrahedron", "disc", "blade"), one of [shapes], or a CSV file of spheres in the folder of the case with
    the header x [mm],y [mm],z [mm],d [mm]. Shares by number mix them, such as
    { rod = 0.5, "flint.csv" = 0.2 }; the rest are spheres. A clump has the volume of a
    sphere of its diameter; its orientation is random."""
    shape_volume: Annotated[Number, Field(gt=0, le=1)] = math.pi / 6
    """A_3: volume of a grain over d cubed; pi/6 for a sphere."""
    mixture: dict[str, Annotated[Number, Field(gt=0, le=1)]] = Field(default_factory=lambda: {})
    """Shares by number of free grains that are of other materials, such as { glass = 0.3 }, drawn at random
    among those that the builder lays; the rest are of the material of [grains]."""
    bed_material: Annotated[str, Field(min_length=1, max_length=64)] | None = None
    """Material of what the builder sets beside the free grains: fixed grains, floor and walls."""

    @model_validator(mode="after")
    def _has_a_size(self) -> Self:
        if self.diameter is None and self.sieve_curve is None:
            missing = InitErrorDetails(type="missing", loc=("diameter",), input=None)
            raise ValidationError.from_exception_data("grains", [missing])
        return self


RIVALS = (("spread", "sieve_curve"),)  # two keys for one thing


def spread_of(grains: GrainsSection) -> tuple[str, float]:
    """Shape and relative width of the size distribution."""
    spread = grains.spread
    return (spread.kind, spread.ratio) if isinstance(spread, SpreadSection) else ("uniform", float(spread))


class FormSection(Section):
    """A clump of your own; a mesh or both ratios of axes."""

    file: RelativePath | None = None
    """STL or OBJ file of a closed body, in the folder of the case; its unit does not matter, as clumps are
    scaled to the volume of a sphere of their diameter."""
    elongation: Annotated[Number, Field(ge=0.1, le=1)] | None = None
    """Ratio b/a of the axes a >= b >= c of an ellipsoid (Zingg)."""
    flatness: Annotated[Number, Field(ge=0.1, le=1)] | None = None
    """Ratio c/b of its axes."""
    spheres: Annotated[int, Field(ge=1, le=MOST_SPHERES)] | None = None
    """Largest number of spheres; 12 when neither this nor filled is given, 64 with filled alone."""
    filled: Annotated[Number, Field(ge=LEAST_FILLED, lt=1)] | None = None
    """Share of the volume of the body that the spheres are to fill; as few as fill it are taken."""
