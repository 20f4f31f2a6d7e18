"""grains.shape: clumps in place of spheres, from the library, from [shapes] or from tables of spheres."""

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.files import contents, inside
from ryusa.casefile.forms import check_forms, clump_of_form, form_rows, spheres_of_form
from ryusa.casefile.grains.schema import FormSection, GrainsSection
from ryusa.casefile.rows import ExplainRow, count, number, word
from ryusa.casefile.water.schema import WaterSection
from ryusa.errors import CaseError
from ryusa.formats.clump import read_clump
from ryusa.model.clump import SHAPES, Clump, shape
from ryusa.spelling import nearest_word

KEY = "grains.shape"
SPHERE = "sphere"
BUILDERS = ("packing", "flume", "box", "fill", "table", "empty", "stream")  # those that leave room for clumps
WHOLE = 1.0e-9  # shares that add up to 1 within this are all


class Shape(NamedTuple):
    """One shape of a case, with the diameter 1 m of the sphere of its volume."""

    name: str
    share: float  # of the free grains, by number
    clump: Clump


def shapes_of(case: Case) -> tuple[Shape, ...]:
    """Clumps of a case; the rest of the grains are spheres.

    Raises
    ------
    CaseError : an unknown name, a file that cannot be read, or spheres that make no clump.
    """
    given = case.grains.shape
    shares = {given: 1.0} if isinstance(given, str) else given
    found: list[Shape] = []
    for name, share in shares.items():
        key = KEY if isinstance(given, str) else f"{KEY}.{name}"
        clump = _clump_of(case, key, name)
        if name != SPHERE:
            found.append(Shape(name, share, clump))
    return tuple(found)


def clump_files(grains: GrainsSection, shapes: dict[str, FormSection]) -> list[str]:
    """Names of the files that `grains.shape` and [shapes] give."""
    given = grains.shape
    tables = [name for name in ([given] if isinstance(given, str) else given) if _is_file(name)]
    return tables + [form.file for form in shapes.values() if form.file is not None]


def spheres_of(case: Case, name: str) -> list[list[float]]:
    """Spheres of one of [shapes] as x, y, z, d, in the unit of its mesh, for the resolved case."""
    return [list(one) for one in spheres_of_form(case, name)]


def has_clumps(grains: GrainsSection) -> bool:
    """Whether some grains are clumps; their file need not be there."""
    given = grains.shape
    return any(name != SPHERE for name in ([given] if isinstance(given, str) else given))


def extent(case: Case) -> float:
    """Largest sphere about the centre of a grain that holds it, over the diameter of its volume [-]."""
    return max((one.clump.extent for one in shapes_of(case)), default=1.0)


def least_mass(case: Case) -> float:
    """Least effective mass of a push on a grain over its mass: off the centre it also turns a clump [-]."""
    return min((one.clump.least_mass for one in shapes_of(case)), default=1.0)


def spheres_per_grain(case: Case) -> float:
    """Mean number of spheres of a grain."""
    return 1.0 + sum(one.share * (len(one.clump.d) - 1) for one in shapes_of(case))


def check_shape(case: Case) -> Iterator[CaseError]:
    """Find shapes that are unknown, and cases that cannot have clumps."""
    given = case.grains.shape
    if faults := list(check_forms(case.grains, case.shapes)):
        yield from faults
        return
    if not has_clumps(case.grains) and isinstance(given, str):
        return
    try:
        shapes_of(case)
    except CaseError as error:
        yield error
        return
    if not isinstance(given, str) and (total := sum(given.values())) > 1.0 + WHOLE:
        yield CaseError(KEY, None, f"the shares add up to {total:g}: at most 1, the rest are spheres")
    if not has_clumps(case.grains):
        return
    if case.motion.plane:
        yield CaseError(KEY, None, "needs motion in space: motion.plane = false")
    if case.motion.rotation != "free":
        yield CaseError(KEY, None, "needs motion.rotation = 'free'")
    yield from _check_water(case.water)
    if case.stop.precision is not None:
        yield CaseError("stop.precision", None, "cannot end a run with clumps; give stop.time")
    if case.build.kind not in BUILDERS:
        yield CaseError(KEY, None, f"needs builder {', '.join(BUILDERS)}; this one is '{case.build.kind}'")
    if "shape_volume" in case.grains.model_fields_set:
        yield CaseError("grains.shape_volume", case.grains.shape_volume, f"excludes {KEY}")


def _check_water(water: WaterSection | None) -> Iterator[CaseError]:
    """Find keys of the water that clumps exclude."""
    if water is None:
        return
    for key in ("rebound", "film"):
        if getattr(water, key) != ("dry" if key == "rebound" else "none"):
            text = f"excludes clumps ({KEY}): films between grains of other forms are not known"
            yield CaseError(f"water.{key}", getattr(water, key), text)
    if water.column is not None and water.column.fluctuations != "none":
        text = f"excludes clumps ({KEY}): every sphere of a clump would have an eddy of its own"
        yield CaseError("water.column.fluctuations", water.column.fluctuations, text)
    if "shape_area" in water.model_fields_set and water.drag_of_form != "sphere":
        text = f"excludes drag_of_form '{water.drag_of_form}', which refers to pi/4 d^2"
        yield CaseError("water.shape_area", water.shape_area, text)


def shape_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Clumps of a case: their form, and what they change."""
    shapes, rows = shapes_of(case), list[ExplainRow]()
    if not shapes:
        return rows
    for one in shapes:
        a, b, c = one.clump.lengths
        flat, thick = one.clump.zingg
        form = (
            f"{len(one.clump.d)} spheres; b/a = {flat:.3g}, c/b = {thick:.3g} ({one.clump.zingg_class}); "
            f"lengths of equal inertia {a:.3g}, {b:.3g} and {c:.3g} times the diameter; sphericity "
            f"{one.clump.sphericity:.3g}; volume and inertia {one.clump.precision}"
        )
        rows.append(word("grains", f"shape '{one.name}'", f"{100.0 * one.share:.4g} %", form))
        rows += form_rows(case, one.name, one.clump)
    most = "free grains with the spheres of clumps counted one by one: what a step costs"
    rows.append(count("grains", "spheres to compute", derived.n_sphere, most))
    lever = "of its mass, of the sphere farthest out: a push off the centre also turns a clump; sets the step"
    rows.append(number("grains", "least effective mass of a clump", least_mass(case), "-", lever))
    return rows


def _is_file(name: str) -> bool:
    return name.lower().endswith(".csv")


def _clump_of(case: Case, key: str, name: str) -> Clump:
    """A shape of the library or of a file, of the volume of a sphere of 1 m."""
    if name in case.shapes:
        return clump_of_form(case, name)
    if not _is_file(name):
        if name not in SHAPES:
            words = (*SHAPES, *case.shapes)
            known = (
                f"must be {', '.join(words)}, or a CSV file of spheres in the folder of the case; "
                "[shapes.NAME] makes one of a mesh or of ratios of axes"
            )
            raise CaseError(key, name, known, nearest_word(name, words))
        return _of_library(name)
    return contents(case.folder, key, name, inside(case.folder, key, name), _of_file)


@lru_cache(maxsize=16)
def _of_library(name: str) -> Clump:
    return shape(name)


@lru_cache(maxsize=16)
def _of_file(path: Path, name: str, _changed: int, _size: int) -> Clump:
    clump = read_clump(path, name)
    return clump.scaled(1.0 / clump.d_volume)
