"""Rows of `ryusa check` about the wall that builder 'fill' fills."""

from ryusa.casefile.builders.inside import enclosure_of
from ryusa.casefile.builders.schema import FillSection
from ryusa.casefile.builders.values import fill_count, fill_inside, fill_most
from ryusa.casefile.case import Case
from ryusa.casefile.grains.values import laid_mean_cube
from ryusa.casefile.rows import ExplainRow, count, number
from ryusa.model.enclosure import MeshInside


def fill_rows(case: Case) -> list[ExplainRow]:
    """Volume of the inside of the wall, how many grains fit, and what share they fill at the start."""
    build = case.build
    if not isinstance(build, FillSection) or build.inside is None:
        return []
    enclosure, name = enclosure_of(case.folder, case.walls, build), f"inside '{build.inside}'"
    what = "of a cylinder between its ends"
    if isinstance(enclosure, MeshInside):
        lids = f", with flat lids on its openings: {enclosure.lids}" if enclosure.lids else ""
        what = f"that the mesh encloses{lids}"
    solid = fill_count(case, build) * case.grains.shape_volume * laid_mean_cube(case) / enclosure.volume
    pitch = 100.0 * fill_inside(case, build).grid.side
    lattice = f"whole, on a lattice of {pitch:.4g} cm"
    return [
        number("build", f"{name}: volume", enclosure.volume, "cm3", what),
        count("build", f"{name}: grains that fit", fill_most(case, build), lattice),
        number("build", f"{name}: filled", solid, "-", "volume of the grains laid over that of the inside"),
    ]
