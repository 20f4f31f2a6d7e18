"""[grains]: sizes, density and shape of the free grains, and the masses that follow."""

import math
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from ryusa.casefile.quantities import Density, Length, Number, Ratio
from ryusa.casefile.rows import ExplainRow, count, number
from ryusa.casefile.section import Section
from ryusa.laws import drag, motion

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.derive import Derived


CUT = 2.5  # standard deviations at which normal and lognormal sizes are cut


class SpreadSection(Section):
    """Distribution of grain sizes about the mean diameter."""

    kind: Literal["uniform", "normal", "lognormal"] = "uniform"
    """Shape of the size distribution; normal and lognormal are cut at 2.5 standard deviations."""
    ratio: Number = Field(ge=0, lt=0.9)
    """Half width (uniform) or standard deviation (normal, lognormal) over the mean diameter."""


def _spread_kind(value: Any) -> str:
    return "<number>" if isinstance(value, (int, float, str)) else "<table>"


class GrainsSection(Section):
    """The free grains."""

    diameter: Annotated[Length, Field(ge=1.0e-7, le=1.0e3)]
    """Mean diameter d; with a table of grains, the reference diameter of u_star, roughness and overlap/d."""
    density: Annotated[Density, Field(ge=1.0, le=1.0e6)]
    """Density of the grain material, rho_s."""
    spread: Annotated[
        Annotated[Ratio, Field(ge=0, lt=0.9), Tag("<number>")] | Annotated[SpreadSection, Tag("<table>")],
        Discriminator(_spread_kind),
    ] = 0.0
    """Spread of the sizes: a number is the half width of a uniform distribution over the mean diameter."""
    shape_volume: Annotated[Number, Field(gt=0, le=1)] = math.pi / 6
    """A_3: volume of a grain over d cubed; pi/6 for a sphere."""


def spread_of(grains: GrainsSection) -> tuple[str, float]:
    """Shape and relative width of the size distribution."""
    spread = grains.spread
    return (spread.kind, spread.ratio) if isinstance(spread, SpreadSection) else ("uniform", float(spread))


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
    rows = [number("grains", "mean diameter" if several else "diameter", derived.d, "cm", "grains.diameter")]
    if several:
        rows += [
            number("grains", "smallest diameter", derived.d_min, "cm", "lower end of the size distribution"),
            number("grains", "largest diameter", derived.d_max, "cm", "upper end of the size distribution"),
        ]
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
