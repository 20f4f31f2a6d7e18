"""[grains]: sizes, density and shape of the free grains, and the masses that follow."""

from typing import Any

from ryusa.casefile.builders.schema import BuildSection
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import grading_of, grading_rows, reference_diameter
from ryusa.casefile.grains.schema import OWN_SIZES, GrainsSection, spread_of
from ryusa.casefile.materials.schema import MaterialSection
from ryusa.casefile.rows import ExplainRow, count, number
from ryusa.casefile.section import given
from ryusa.laws import drag, motion

CUT = 2.5  # standard deviations at which normal and lognormal sizes are cut


def slab_width(case: Case) -> float:
    """Width that a plane scene stands for [m]."""
    return case.motion.slab_width or reference_diameter(case)


def mean_cube(case: Case) -> float:
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


def has_own_sizes(materials: dict[str, MaterialSection], name: str | None) -> bool:
    """Whether a material says how large its grains are."""
    own = materials.get(name) if name is not None else None
    return own is not None and any(given(own, key) for key in OWN_SIZES)


def sized_as(case: Case, name: str | None) -> Case:
    """The case with the sizes of a material as those of [grains]; as it is where the material has none."""
    if name is None or not has_own_sizes(case.materials, name):
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


def laid_shares(grains: GrainsSection, build: BuildSection) -> dict[str | None, float]:
    """Shares by number of what the builder lays, by material; None is that of [grains]."""
    if build.kind == "empty" or (build.kind == "stream" and build.bed == 0.0):
        return {}
    rest = 1.0 - sum(grains.mixture.values())
    return {**({None: rest} if rest > 1e-9 else {}), **grains.mixture}


def graded(case: Case) -> bool:
    """Whether the builder lays a sieve curve, or materials of sizes of their own."""
    laid = laid_shares(case.grains, case.build)
    curves = (grading_of(sized_as(case, name)) for name in laid)
    return any(has_own_sizes(case.materials, name) for name in laid) or any(one is not None for one in curves)


def laid_mean_cube(case: Case) -> float:
    """Mean of d^3 over what the builder lays [m3]; of builder "empty" that of [grains]."""
    laid = laid_shares(case.grains, case.build)
    return sum(share * mean_cube(sized_as(case, name)) for name, share in laid.items()) or mean_cube(case)


def mass(case: Case, d: float) -> tuple[float, float, float, float]:
    """Mass, added mass, submerged mass [kg] and moment of inertia [kg m2] of a grain of diameter d [m]."""
    volume = drag.volume(d, case.grains.shape_volume)
    m = case.grains.density * volume
    inertia = motion.inertia_sphere(m, d)
    if case.water is None:
        return m, 0.0, m, inertia
    rho_w = case.water.density
    m_added = drag.added_mass(rho_w, case.water.added_mass, volume)
    return m, m_added, drag.submerged_mass(m, rho_w, volume), inertia


def grain_rows(case: Case, derived: Derived) -> list[ExplainRow]:
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
