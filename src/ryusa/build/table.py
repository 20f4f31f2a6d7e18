"""First grains from a table, a file of another program or a frame of another run."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ryusa.build.placement import Placement, Wall
from ryusa.casefile.builders.schema import FromFile, RunSection
from ryusa.casefile.builders.table import densities_of_file, key_of, period_of, table_of
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.errors import CaseError
from ryusa.formats.grains import GrainTable
from ryusa.laws.drag import volume
from ryusa.model.scene import Floats

_SAME = 1e-6  # relative difference of masses that are one


def table(case: Case, _derived: Derived) -> Placement:
    """Grains of the table; ids follow its order, with the rows of one group together.

    Its planes are walls of the scene, but for those that the case names itself.
    """
    keys = case.build
    assert isinstance(keys, FromFile)
    found = first_grains(case, keys.folder if isinstance(keys, RunSection) else None, keys.allow_overlap)
    return replace(found, period=period_of(case))


def first_grains(case: Case, run: str | None, allow_overlap: bool) -> Placement:
    """The same without the period.

    Parameters
    ----------
    run : folder of the run that they are of, as the case names it; None for a table.
    allow_overlap : whether grains may overlap.
    """
    grid = table_of(case)
    assert grid is not None
    key = key_of(case.build)
    if case.motion.plane:
        for name in ("vy", "wx", "wz"):
            if np.any(grid.column(name)):
                raise CaseError(key, grid.name, f"column '{name}' must be zero in a plane scene")
    if case.motion.rotation == "locked" and np.any(grid.column("wy")):
        raise CaseError(key, grid.name, "column 'wy' must be zero while rotation is locked")
    firsts: dict[tuple[bool, str], int] = {}
    for fixed, group in zip(grid.fixed.tolist(), grid.group, strict=True):
        firsts.setdefault((fixed, group), len(firsts))
    places = [firsts[fixed, group] for fixed, group in zip(grid.fixed.tolist(), grid.group, strict=True)]
    order = np.argsort(places, kind="stable")
    free, fixed = order[~grid.fixed[order]], order[grid.fixed[order]]
    x, d = _columns(grid.column("x"), grid.column("y"), grid.column("z")), grid.column("d")
    labels = [grid.labels[row] for row in (*free, *fixed)]
    own, heavy = {plane.name for plane in case.planes}, densities_of_file(case)
    return Placement(
        d=d[free],
        x=x[free],
        v=_columns(grid.column("vx"), grid.column("vy"), grid.column("vz"))[free],
        omega=_columns(grid.column("wx"), grid.column("wy"), grid.column("wz"))[free],
        d_fixed=d[fixed],
        x_fixed=x[fixed],
        fixed_groups=_groups([grid.group[row] for row in fixed]),
        free_groups=_groups([grid.group[row] for row in free]),
        walls=tuple(Wall(one.name, one.point, one.normal) for one in grid.planes if one.name not in own),
        z_zero=grid.z_zero or 0.0,
        allow_overlap=allow_overlap,
        names=tuple(labels),
        density=None if heavy is None else heavy[free],
        notes=_notes(case, run, grid, heavy),
    )


def _notes(case: Case, run: str | None, grid: GrainTable, heavy: Floats | None) -> tuple[str, ...]:
    notes = [*grid.notes, *_unused(case, run, grid)]
    if heavy is not None:
        low, high = heavy[~grid.fixed].min(), heavy[~grid.fixed].max()
        shown = f"{low:.4g}" if high - low < 1e-4 * high else f"{low:.4g} to {high:.4g}"
        notes.append(
            f"densities of {grid.name}, {shown} kg/m3, in place of grains.density = "
            f"{case.grains.density:.4g} kg/m3"
        )
    elif case.materials and (np.any(grid.column("density")) or (run is None and np.any(grid.column("m")))):
        notes.append(f"densities of the materials, not those of {grid.name}")
    if run is not None:
        notes.append(f"grains as in {run} at {grid.t:g} s; their contacts begin anew")
    if case.water is not None and case.water.zero is None and case.build.kind != "stream":
        where = f"at z = {grid.z_zero:g} m, as in {grid.name}" if grid.z_zero is not None else "at z = 0"
        notes.append(f"zero of the water profile {where} (water.zero not given)")
    return tuple(notes)


def _unused(case: Case, run: str | None, grid: GrainTable) -> Iterator[str]:
    """What a file says of its grains and a run does not take."""
    moving = [name for name in ("vx", "vy", "vz", "wx", "wy", "wz") if np.any(grid.column(name)[grid.fixed])]
    if moving:
        yield f"{', '.join(moving)} of the fixed grains of {grid.name} are not used: they never move"
    masses = np.any(grid.column("m"))
    if masses and np.any(grid.column("density")):
        yield f"masses of {grid.name} are not used: it states densities too"
    if run is not None and masses and not case.materials:
        ours = np.array([case.grains.density * volume(d, case.grains.shape_volume) for d in grid.column("d")])
        if not np.allclose(grid.column("m")[~grid.fixed], ours[~grid.fixed], rtol=_SAME, atol=0.0):
            yield f"masses of the grains of {run} are not used: grains.density and shape_volume give them"


def _columns(*columns: Floats) -> Floats:
    return np.stack(columns, axis=1)


def _groups(names: list[str]) -> tuple[tuple[str, int, int], ...]:
    found: dict[str, list[int]] = {}
    for k, name in enumerate(names):
        if name:
            found.setdefault(name, []).append(k)
    return tuple((name, ks[0], len(ks)) for name, ks in found.items())
