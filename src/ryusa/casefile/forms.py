"""[shapes.NAME]: clumps made from a mesh or from ratios of axes."""

import json
import math
from collections.abc import Iterator
from functools import lru_cache, partial
from pathlib import Path

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.files import contents, inside
from ryusa.casefile.grains.schema import FormSection, GrainsSection
from ryusa.casefile.rows import ExplainRow, word
from ryusa.errors import CaseError
from ryusa.formats.mesh import KINDS, read_mesh
from ryusa.model.closed_mesh import ClosedMesh, MeshFault
from ryusa.model.clump import MOST_SPHERES, SHAPES, Clump
from ryusa.model.filling import LEAST_FILLED, Filling, fill_ellipsoid, fill_mesh

SPHERES = 12  # at most, where the case does not say
Spheres = tuple[tuple[float, float, float, float], ...]


def check_forms(grains: GrainsSection, shapes: dict[str, FormSection]) -> Iterator[CaseError]:
    """Find shapes that are neither a mesh nor ratios, names that are taken, and shapes without use."""
    given = grains.shape
    used = {given} if isinstance(given, str) else set(given)
    unknown = {one for one in used if one not in SHAPES and one not in shapes and not _is_table(one)}
    for name, form in shapes.items():
        key = f"shapes.{name}"
        if name in SHAPES or _is_table(name):
            yield CaseError(
                key, None, f"has the name of a shape of the library or of a file: {', '.join(SHAPES)}"
            )
        by_ratio = [one for one in ("elongation", "flatness") if getattr(form, one) is not None]
        if form.file is not None and by_ratio:
            yield CaseError(
                f"{key}.{by_ratio[0]}", getattr(form, by_ratio[0]), "excludes file: give one of them"
            )
        elif form.file is None and len(by_ratio) != 2:
            missing = "elongation" if by_ratio == ["flatness"] else "flatness" if by_ratio else "file"
            yield CaseError(
                f"{key}.{missing}", None, "missing; a shape needs a file, or elongation and flatness"
            )
        elif name not in used and not unknown:
            yield CaseError(key, None, f'has no effect; name it in grains.shape, such as shape = "{name}"')


def _is_table(name: str) -> bool:
    return name.lower().endswith(".csv")


def clump_of_form(case: Case, name: str) -> Clump:
    """Clump of a shape of the case, of the volume of a sphere of 1 m.

    Raises
    ------
    CaseError : its file bounds no body, or its spheres are no likeness of it.
    """
    return _clump(spheres_of_form(case, name))


def spheres_of_form(case: Case, name: str) -> Spheres:
    """Spheres of a shape of the case as x, y, z, d, in the unit of its mesh; those that its run made.

    Raises
    ------
    CaseError : as `clump_of_form`.
    """
    return _kept(case, name) or _made(case.folder, case.shapes[name], f"shapes.{name}")


def _kept(case: Case, name: str) -> Spheres | None:
    """Spheres that a run made of this shape, where the case is that of its folder."""
    from ryusa.results import schema

    folder = case.folder
    path = folder / schema.CASE_JSON
    if case.path is None or not schema.is_run_folder(folder) or not path.is_file() or path.is_symlink():
        return None
    try:
        was = json.loads(path.read_text(encoding="utf-8"))["shapes"][name]
        rows = was.pop("made_of")
        if was != case.shapes[name].model_dump(mode="json"):
            return None
        return tuple((float(x), float(y), float(z), float(d)) for x, y, z, d in rows)
    except (OSError, ValueError, KeyError, TypeError):
        return None


@lru_cache(maxsize=16)
def _clump(spheres: Spheres) -> Clump:
    rows = np.array(spheres)
    clump = Clump.of(rows[:, :3], rows[:, 3])
    return clump.scaled(1.0 / clump.d_volume)


def _made(folder: Path, form: FormSection, key: str) -> Spheres:
    filling = _filling(folder, form, key)
    n = len(filling.d)
    if filling.filled < LEAST_FILLED:
        remedy = f"it is too thin for so few; ask for more in {key}.spheres (at most {MOST_SPHERES})"
        if n in {MOST_SPHERES, 0}:
            remedy = f"it is too thin for {MOST_SPHERES} spheres, the most that a clump has"
        raise CaseError(key, None, f"{n} spheres fill {100.0 * filling.filled:.3g} % of the body: {remedy}")
    if form.filled is not None and filling.filled < form.filled - 0.01:
        reached = (
            f"{n} spheres fill {100.0 * filling.filled:.3g} % of the body; ask for less, or for more spheres"
        )
        raise CaseError(f"{key}.filled", form.filled, reached)
    return tuple(map(tuple, np.column_stack([filling.x, filling.d]).tolist()))


def _filling(folder: Path, form: FormSection, key: str) -> Filling:
    most = form.spheres or (SPHERES if form.filled is None else MOST_SPHERES)
    share = form.filled or 1.0
    if form.file is None:
        return _in_ellipsoid(form.elongation or 1.0, form.flatness or 1.0, most, share)
    return _in_mesh(_body(folder, form.file, f"{key}.file"), most, share)


_in_ellipsoid = lru_cache(maxsize=16)(fill_ellipsoid)


class _Body:
    """A mesh as a key of the cache: the same as long as its file is."""

    def __init__(self, key: str, mesh: ClosedMesh) -> None:
        self.key, self.mesh = key, mesh


@lru_cache(maxsize=16)
def _in_mesh(body: _Body, most: int, share: float) -> Filling:
    try:
        return fill_mesh(body.mesh, most, share)
    except MeshFault as fault:
        raise CaseError(body.key, None, str(fault)) from None


def _body(folder: Path, file: str, key: str) -> _Body:
    """The body of a mesh.

    Raises
    ------
    CaseError : no such file, no mesh, or no closed body.
    """
    path = inside(folder, key, file)
    if path.suffix.lower() not in KINDS:
        raise CaseError(key, file, "must be an STL or OBJ file")
    return contents(folder, key, file, path, partial(_read, key))


@lru_cache(maxsize=8)
def _read(key: str, path: Path, name: str, _changed: int, _size: int) -> _Body:
    try:
        return _Body(key, ClosedMesh.of(read_mesh(path, name)))
    except MeshFault as fault:
        raise CaseError(key, name, str(fault)) from None


def form_rows(case: Case, name: str, clump: Clump) -> list[ExplainRow]:
    """How like its body the clump of a shape of the case is."""
    form = case.shapes.get(name)
    if form is None:
        return []
    label = f"shape '{name}': likeness"
    if form.file is None:
        assert form.elongation is not None
        assert form.flatness is not None
        long, wide, high = sorted(clump.widths, reverse=True)
        flat, thick = clump.zingg
        text = (
            f"b/a = {flat:.4g}, c/b = {thick:.4g} by inertia, for {form.elongation:g} and {form.flatness:g} "
            f"asked; {wide / long:.3g} and {high / wide:.3g} by calliper"
        )
        return [word("grains", label, f"{len(clump.d)} spheres", text)]
    key = f"shapes.{name}"
    body = _body(case.folder, form.file, f"{key}.file").mesh
    own, scale = (6.0 * body.volume / math.pi) ** (1.0 / 3.0), 100.0
    off = [scale * (one * own / other - 1.0) for one, other in zip(clump.lengths, body.lengths, strict=True)]
    turns = scale * (clump.inertia * own**5 / body.moments - 1.0)
    filled = _filling(case.folder, form, key).filled if _kept(case, name) is None else math.nan
    text = (
        f"{form.file}, {len(body.corners)} triangles; scaled to its volume, lengths of equal inertia off by "
        f"{off[0]:+.2g}, {off[1]:+.2g} and {off[2]:+.2g} %, moments of inertia by "
        f"{turns[0]:+.2g}, {turns[1]:+.2g} and {turns[2]:+.2g} %"
    )
    share = "as its run made it" if math.isnan(filled) else f"{scale * filled:.3g} % filled"
    return [word("grains", label, share, text)]
