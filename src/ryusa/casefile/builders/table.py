"""First grains that a file holds: a table, a file of another program, or a frame of another run."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ryusa.casefile.builders.schema import BedOfRunSection, BuildSection, RunSection, TableSection
from ryusa.casefile.case import Case
from ryusa.casefile.files import contents, inside
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.section import given
from ryusa.errors import CaseError, ResultsError
from ryusa.formats.grains import UNITS, GrainTable
from ryusa.formats.read import read_grains
from ryusa.formats.text import ReadOptions
from ryusa.laws.drag import volume
from ryusa.laws.families import Profile
from ryusa.model.arrays import Bools, Floats
from ryusa.units import quantity

if TYPE_CHECKING:
    from ryusa.results import Results

_SAME = 1e-9  # relative difference of densities that are one
_LIGHTEST, _HEAVIEST = 1.0, 1.0e5  # densities of a grain [kg/m3]


def table_of(case: Case) -> GrainTable | None:
    """Read the grains that a case names; None for other builders."""
    if isinstance(case.build, TableSection):
        return _table_of_file(case, case.build)
    if isinstance(case.build, RunSection):
        return _table_of_run(case.folder, "build.folder", case.build.folder, case.build.at)
    bed = bed_of_run(case.build)
    return None if bed is None else _table_of_run(case.folder, "build.bed.run", bed.run, bed.at)


def bed_of_run(build: BuildSection) -> BedOfRunSection | None:
    """The run from which builder 'stream' takes its bed; None where it lays one, or none."""
    bed = build.bed if build.kind == "stream" else None
    return bed if isinstance(bed, BedOfRunSection) else None


def key_of(build: BuildSection) -> str:
    """Key that names the file or folder of the first grains; "build" for builders that lay them."""
    if isinstance(build, TableSection):
        return "build.file"
    if isinstance(build, RunSection):
        return "build.folder"
    return "build" if bed_of_run(build) is None else "build.bed.run"


def period_of(case: Case) -> tuple[float, float]:
    """Periods in x and y where grains come from a file [m], inf where open: the case's, or the file's."""
    table = table_of(case)
    stated = table.period if table is not None else None
    x, y = (case.domain.period_x, case.domain.period_y)
    file_x, file_y = stated or (math.inf, math.inf)
    return (file_x if x is None else x, file_y if y is None else y)


def made_of(build: BuildSection) -> dict[str, str]:
    """Materials of the first grains by their group in the file."""
    return build.made_of if isinstance(build, TableSection | RunSection) else {}


def rows_of_material(table: GrainTable, made: dict[str, str], name: str | None) -> Bools:
    """Which rows are free grains of a material; None is that of [grains]."""
    return ~table.fixed & np.array([made.get(group) == name for group in table.group], np.bool_)


def area_of_file(case: Case) -> float | None:
    """Area of bed under a column of water [m2], where the file states it: that of a channel between walls."""
    table = table_of(case)
    return table.bed_area if table is not None else None


def _table_of_file(case: Case, build: TableSection) -> GrainTable:
    path = inside(case.folder, "build.file", build.file)
    options = ReadOptions(
        frame=build.frame,
        length=quantity(f"1 {build.length_unit}", "m"),
        time=quantity(f"1 {build.time_unit}", "s"),
        mass=quantity(f"1 {build.mass_unit}", "kg"),
        stated=given(build, "length_unit") and given(build, "time_unit"),
        fixed_types=build.fixed_types,
    )
    table = contents(case.folder, "build.file", build.file, path, partial(_read, build.format, options))
    heavy = {"density", "m"} & table.columns.keys()
    if heavy and given(build, "length_unit") and not given(build, "mass_unit"):
        # a file in centimetres may count in grams
        note = f"masses of {table.name} are not used: their unit is not known (build.mass_unit not given)"
        columns = {name: one for name, one in table.columns.items() if name not in heavy}
        table = replace(table, columns=columns, notes=(*table.notes, note))
    table = replace(table, notes=(*table.notes, *_units_not_needed(build, table)))
    if "d" in table.columns:
        return table
    d = reference_diameter(case)
    note = f"{table.name} states no sizes (radius, diameter, ...): all grains have d = {1000.0 * d:.4g} mm"
    return replace(table, columns={**table.columns, "d": np.full(table.n, d)}, notes=(*table.notes, note))


def _units_not_needed(build: TableSection, table: GrainTable) -> Iterator[str]:
    """Units that a case gives and no column of its file needs."""
    if build.format in {"csv", "vtu"}:
        return
    kinds = {UNITS[one] for one in table.columns if one in UNITS}
    for key, needing in (("time_unit", {"m/s", "rad/s"}), ("mass_unit", {"kg", "kg/m3"})):
        if given(build, key) and not kinds & needing:
            what = "velocities and spins" if key == "time_unit" else "masses and densities"
            yield f"build.{key} has no effect: {table.name} states no {what}"


def densities_of_file(case: Case) -> Floats | None:
    """Density of each row of a table of grains [kg/m3], by its densities or masses.

    None where the table states neither, or that of the case, and where the case has materials.
    """
    if not isinstance(case.build, TableSection) or case.materials:
        return None
    table = _table_of_file(case, case.build)
    found = table.columns.get("density")
    if found is None and np.any(m := table.column("m")):
        found = m / np.array([volume(one, case.grains.shape_volume) for one in table.column("d").tolist()])
    if found is None or np.allclose(found, case.grains.density, rtol=_SAME, atol=0.0):
        return None
    free = ~table.fixed
    wrong = np.flatnonzero(free & ~((found >= _LIGHTEST) & (found <= _HEAVIEST)))
    if len(wrong):
        row = int(wrong[0])
        raise CaseError(
            "build.file", table.name,
            f"a density from {_LIGHTEST:g} to {_HEAVIEST:g} kg/m3 is expected, found {found[row]:.4g} kg/m3 "
            f"{table.labels[row]}; is build.mass_unit right?",
        )  # fmt: skip
    return np.where(free, found, case.grains.density)


def lightest_in_file(case: Case) -> Case:
    """The case with the least density of its free grains, where a table states densities."""
    found = densities_of_file(case)
    if found is None:
        return case
    grains = case.grains.model_copy(update={"density": float(found.min())})
    return case.model_copy(update={"grains": grains})


@lru_cache(maxsize=4)
def _read(kind: str, options: ReadOptions, path: Path, name: str, _changed: int, _size: int) -> GrainTable:
    return read_grains(path, name, kind, options)


def _table_of_run(folder: Path, key: str, name: str, at: float | None) -> GrainTable:
    """Read the frame nearest to a time [s], or the last; a run folder holds what its own run started from."""
    from ryusa.results import schema

    path = inside(folder, key, name)
    start = folder / schema.START
    if schema.is_run_folder(folder) and start.is_file() and not start.is_symlink():
        return contents(folder, key, schema.START, start, partial(_read, "csv", ReadOptions()))
    try:
        changed = (path / schema.PARTS).stat().st_mtime_ns
    except OSError:
        raise CaseError(key, name, f"no such run folder in the folder of the case, {folder}") from None
    return _frame(path, key, name, at, changed)


def _left_behind(run: "Results", name: str) -> Iterator[str]:
    """What another run has beside its grains, periods and planes: a case has to state it anew."""
    scene = run.scene
    there = {
        "walls": scene.walls is not None, "feeds and exits": scene.traffic is not None,
        "materials": scene.materials is not None, "water": scene.water.profile is not Profile.NONE,
    }  # fmt: skip
    if what := ", ".join(one for one, is_there in there.items() if is_there):
        yield f"not taken from {name}: its {what}, of which this case says its own"


@lru_cache(maxsize=4)
def _frame(path: Path, key: str, name: str, at: float | None, _changed: int) -> GrainTable:
    from ryusa.formats.grains import nearest_frame, table_of_frame
    from ryusa.results import Results

    try:
        run = Results.open(path)
        if not len(run.frames):
            raise ResultsError(f"{path}: has no frame yet")
        if run.scene.bodies is not None:
            raise ResultsError(f"{path}: holds clumps, and a frame gives single spheres only")
        table = table_of_frame(run, len(run.frames) - 1 if at is None else nearest_frame(run, at))
        return replace(table, notes=(*table.notes, *_left_behind(run, name)))
    except ResultsError as error:
        raise CaseError(key, name, str(error)) from None
