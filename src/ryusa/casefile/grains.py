"""[grains]: sizes, density and shape of the free grains, and the masses that follow."""

import math
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, ValidationError, model_validator
from pydantic_core import InitErrorDetails

from ryusa.casefile.files import RelativePath
from ryusa.casefile.grading import grading_of, grading_rows, reference_diameter
from ryusa.casefile.quantities import Boolean, Density, Length, Number, Ratio
from ryusa.casefile.rows import ExplainRow, count, number
from ryusa.casefile.section import Section, given
from ryusa.laws import drag, motion

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.derive import Derived


CUT = 2.5  # standard deviations at which normal and lognormal sizes are cut
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
    density: Annotated[Density, Field(ge=1.0, le=1.0e6)]
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


def mean_cube(case: "Case") -> float:
    """Mean of d^3 over the sizes of [grains] [m3]."""
    grading = grading_of(case)
    if grading is not None:
        return grading.mean_cube
    kind, ratio = spread_of(case.grains)
    wider = {
        "uniform": 1.0 + ratio**2,
        "normal": 1.0 + 3.0 * ratio**2,
        "lognormal": (1.0 + ratio**2) ** 3,
    }[kind]
    return reference_diameter(case) ** 3 * wider


def has_own_sizes(case: "Case", name: str | None) -> bool:
    """Whether a material says how large its grains are."""
    own = case.materials.get(name) if name is not None else None
    return own is not None and any(given(own, key) for key in OWN_SIZES)


def sized_as(case: "Case", name: str | None) -> "Case":
    """The case with the sizes of a material as those of [grains]; as it is where the material has none."""
    if name is None or not has_own_sizes(case, name):
        return case
    own, grains = case.materials[name], case.grains
    curve = own.sieve_curve
    changed: dict[str, Any] = {"finest": None, "coarsest": None, "sieve_curve": curve}
    if curve is not None:
        changed |= {"diameter": None, "spread": 0.0}
    else:
        wide = grains.spread if grains.sieve_curve is None else 0.0
        changed["diameter"] = own.diameter or reference_diameter(case)
        changed["spread"] = wide if own.spread is None else own.spread
    return case.model_copy(update={"grains": grains.model_copy(update=changed)})


def laid_shares(case: "Case") -> dict[str | None, float]:
    """Shares by number of what the builder lays, by material; None is that of [grains]."""
    if case.build.kind == "empty" or (case.build.kind == "stream" and case.build.bed == 0.0):
        return {}
    rest = 1.0 - sum(case.grains.mixture.values())
    return {**({None: rest} if rest > 1e-9 else {}), **case.grains.mixture}


def graded(case: "Case") -> bool:
    """Whether the builder lays a sieve curve, or materials of sizes of their own."""
    laid = laid_shares(case)
    curves = (grading_of(sized_as(case, name)) for name in laid)
    return any(has_own_sizes(case, name) for name in laid) or any(one is not None for one in curves)


def laid_mean_cube(case: "Case") -> float:
    """Mean of d^3 over what the builder lays [m3]; of builder "empty" that of [grains]."""
    laid = laid_shares(case)
    return sum(share * mean_cube(sized_as(case, name)) for name, share in laid.items()) or mean_cube(case)


def mass(case: "Case", d: float) -> tuple[float, float, float, float]:
    """Mass, added mass, submerged mass [kg] and moment of inertia [kg m2] of a grain of diameter d [m]."""
    volume = drag.volume(d, case.grains.shape_volume)
    m = case.grains.density * volume
    inertia = motion.inertia_sphere(m, d)
    if case.water is None:
        return m, 0.0, m, inertia
    rho_w = case.water.density
    m_added = drag.added_mass(rho_w, case.water.added_mass, volume)
    return m, m_added, drag.submerged_mass(m, rho_w, volume), inertia


def grain_rows(case: "Case", derived: "Derived") -> list[ExplainRow]:
    """Sizes, numbers and masses of the grains."""
    several = derived.d_max > derived.d_min
    curve = grading_of(case) is not None
    which = "reference diameter" if curve else "mean diameter" if several else "diameter"
    origin = "grains.diameter" if case.grains.diameter is not None else "D50 of the sieve curve"
    rows = [number("grains", which, derived.d, "cm", origin)]
    if several:
        rows += [
            number("grains", "smallest diameter", derived.d_min, "cm", "lower end of the size distribution"),
            number("grains", "largest diameter", derived.d_max, "cm", "upper end of the size distribution"),
        ]
    rows += grading_rows(case, derived)
    builder = f"builder '{case.build.kind}'"
    rows += [
        count("grains", "free grains", derived.n_grain, builder),
        count("grains", "fixed grains", derived.n_fixed, builder),
        number(
            "grains",
            "mass m",
            derived.m,
            "kg",
            "rho_s A_3 d^3; that of spheres in a plane scene too",
        ),
    ]
    if case.water is not None:
        added = f"rho_w C_M A_3 d^3, C_M = {case.water.added_mass:g}; adds to inertia, not to weight"
        rows += [
            number("grains", "added mass", derived.m_added, "kg", added),
            number("grains", "submerged mass", derived.m_weight, "kg", "(rho_s - rho_w) A_3 d^3"),
        ]
    return [
        *rows,
        number("grains", "moment of inertia", derived.inertia, "kg m2", "m d^2/10, without added mass"),
    ]
