"""Checks of a column of water: keys that are missing, and contradictions."""

import math
from collections.abc import Iterator

from ryusa.casefile.builders.schema import FlumeSection
from ryusa.casefile.builders.table import area_of_file
from ryusa.casefile.builders.values import periodic, sizes
from ryusa.casefile.case import Case
from ryusa.casefile.column.bed import bed_top, water_over
from ryusa.casefile.column.packed import packed
from ryusa.casefile.column.schema import CELL, ColumnSection
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.motion import slope_at_last
from ryusa.casefile.row.values import stream, water_alone
from ryusa.casefile.section import given
from ryusa.casefile.water.schema import WaterSection
from ryusa.casefile.water.values import u_star_given
from ryusa.errors import CaseError
from ryusa.laws.families import Mixing
from ryusa.model.column import AGREE, refuse

MOST_CELLS = 20_000
DENSEST = math.pi / math.sqrt(18.0)  # concentration of the densest packing of equal spheres
SPARE = 1.2  # height of the column over the depth


def check_column(case: Case) -> Iterator[CaseError]:
    """Find faults of the column of water."""
    water = case.water
    if water is None or water.profile != "column" or water_alone(case):
        return
    keys = case.column
    if stream(case):
        yield from _laws(water)
        yield from _closures(keys)
        return
    yield from _place(case, water)
    yield from _laws(water)
    yield from _closures(keys)
    yield from _boundaries(case, water, keys)
    driver = [*_driver(case, water, keys)]
    yield from driver
    if water.depth is None:
        yield CaseError("water.depth", None, "missing; a column of water needs its depth above water.zero")
    elif not driver:
        shallow = [*_over_bed(case, water, keys)]
        over = water_over(case)
        yield from shallow or _contradictions(case, water, keys, over if over > 0.0 else water.depth)


def _place(case: Case, water: WaterSection) -> Iterator[CaseError]:
    """A column is averaged over x and y, so the bed under it must be periodic."""
    along, across = periodic(case)
    kind = case.build.kind
    if not along:
        ways = {"packing": "; give build.periodic = true"}
        ways |= dict.fromkeys(("table", "run"), "; give domain.period_x")
        yield CaseError(
            "water.profile",
            water.profile,
            f"needs a bed periodic in x, and that of builder '{kind}' is not{ways.get(kind, '')}",
        )
    elif not (across or case.motion.plane or kind == "flume" or area_of_file(case) is not None):
        way = "domain.period_y" if kind in {"table", "run"} else "motion.plane = true"
        yield CaseError(
            "water.profile",
            water.profile,
            f"needs a bed that is periodic in y as well in three dimensions; give {way}",
        )


def _laws(water: WaterSection) -> Iterator[CaseError]:
    if water.hindrance == "power" and water.hindrance_exponent is None:
        yield CaseError("water.hindrance_exponent", None, "missing; hindrance 'power' needs it")
    if given(water, "hindrance") and water.hindrance != "none" and water.drag == "none":
        yield CaseError("water.hindrance", water.hindrance, "has no effect with drag 'none'")


def _closures(keys: ColumnSection) -> Iterator[CaseError]:
    if keys.packed is not None and keys.packed > DENSEST:
        yield CaseError(
            "water.column.packed",
            keys.packed,
            f"must be at most {DENSEST:.4g}, pi/sqrt(18), the densest packing of equal spheres",
        )
    if keys.fluctuations != "none" and keys.mixing == "none" and keys.pore_eddies == 0.0:
        yield CaseError(
            "water.column.fluctuations", keys.fluctuations, "has no effect with mixing_length 'none'"
        )
    if given(keys, "side_friction") and keys.side_walls is None:
        yield CaseError("water.column.side_friction", keys.side_friction, "needs water.column.side_walls")


def _boundaries(case: Case, water: WaterSection, keys: ColumnSection) -> Iterator[CaseError]:
    if "wall" in Mixing.of(keys.mixing).marks and keys.bed == "moving":
        yield CaseError(
            "water.column.mixing_length", keys.mixing, "needs a wall: water.column.bed 'smooth' or 'rough'"
        )
    if "layers" in Mixing.of(keys.mixing).marks and water.row is None:
        yield CaseError(
            "water.column.mixing_length",
            keys.mixing,
            "is that of jets and eddies in a row of columns: give [water.row]",
        )
    if keys.side_walls is not None:
        yield from _side_walls(case, keys.side_walls)
    if keys.start == "steady" and water.drag == "none":
        yield CaseError(
            "water.column.start",
            keys.start,
            "needs drag: without it nothing slows the water between the grains",
        )
    fixed = keys.bed != "moving"
    if fixed and keys.bottom is not None and water.zero is not None and keys.bottom != water.zero:
        yield CaseError(
            "water.column.bottom",
            keys.bottom,
            f"must be water.zero, {water.zero:g} m (or left out): a fixed bed is the bottom of the column",
        )


def _side_walls(case: Case, width: float) -> Iterator[CaseError]:
    """Side walls have room for a grain, and stand no closer than those of the flume."""
    largest, build = sizes(case)[2], case.build
    if width < largest:
        text = f"must be at least {largest:.4g} m, the largest diameter, for a grain to fit between the walls"
        yield CaseError("water.column.side_walls", width, text)
        return
    stands = build.width if isinstance(build, FlumeSection) and build.walls else None
    if stands is not None and width < (1.0 - AGREE) * stands:
        text = f"must be at least build.width, {stands:g} m, because build.walls = true"
        yield CaseError("water.column.side_walls", width, text)


def _driver(case: Case, water: WaterSection, keys: ColumnSection) -> Iterator[CaseError]:
    """The driver of the water is given once, and nothing else drives it."""
    for key, drive in (("pressure_gradient", "pressure gradient"), ("discharge", "discharge")):
        value = getattr(keys, key)
        if keys.drive == drive and value is None:
            yield CaseError(f"water.column.{key}", None, f"missing; drive '{drive}' needs it")
    key = "u_star" if water.u_star is not None else "tau_star"
    stress = getattr(water, key)
    level = case.motion.gravity * slope_at_last(case.motion, case.timeline) == 0.0
    if keys.drive == "discharge" and keys.discharge is not None and not keys.discharge > 0.0:
        yield CaseError("water.column.discharge", keys.discharge, "must be above 0 m2/s, along +x")
    if keys.drive == "pressure gradient" and keys.pressure_gradient == 0.0 and level:
        yield CaseError(
            "water.column.pressure_gradient",
            keys.pressure_gradient,
            "nothing drives the water on a level bed: must not be 0 Pa/m; for still water leave drive out",
        )
    if keys.drive == "tau_star" and stress is None:
        yield CaseError("water.tau_star", None, "missing; drive 'tau_star' needs tau_star or u_star")
    elif keys.drive == "slope" and stress is not None and level:
        yield CaseError(
            f"water.{key}",
            stress,
            "nothing drives the water; give motion.slope, or water.column.drive = 'tau_star'",
        )


def _over_bed(case: Case, water: WaterSection, keys: ColumnSection) -> Iterator[CaseError]:
    """The surface of water that is driven lies above the loose bed."""
    over, depth = water_over(case), water.depth or 0.0
    driven = keys.drive != "slope" or case.motion.gravity * slope_at_last(case.motion, case.timeline) != 0.0
    if over > 0.0 or not driven or case.grains.density <= water.density:
        return
    top = bed_top(case)
    yield CaseError(
        "water.depth",
        water.depth,
        f"puts the surface into the bed: water.zero + depth is z = {top + over:.4g} m, and loose grains at "
        f"concentration {packed(case):g} reach z = {top:.4g} m; must be above {depth - over:.4g} m, or leave "
        "out water.zero to measure the depth from the top of the bed",
    )


def _contradictions(
    case: Case, water: WaterSection, keys: ColumnSection, depth: float
) -> Iterator[CaseError]:
    """Cells that do not fit the depth, and stress, slope and depth that contradict each other."""
    d = reference_diameter(case)
    cell = keys.cell or CELL * d
    if not SPARE * depth / cell <= MOST_CELLS:
        yield CaseError(
            "water.column.cell", keys.cell, f"{cell:g} m asks for more than {MOST_CELLS:,} cells in the depth"
        )
    if water.depth is not None and cell > 0.5 * water.depth:
        yield CaseError(
            "water.column.cell",
            keys.cell,
            f"{cell:.3g} m must be at most half of water.depth, {water.depth:g} m, to give two cells",
        )
        return
    rough = water.roughness or d
    if keys.bed == "rough" and cell <= rough / 15.0:
        yield CaseError(
            "water.column.cell",
            keys.cell,
            f"{cell:.3g} m must be above 1/15 of the roughness, {rough / 15.0:.3g} m, because Eq. (9) is "
            "zero below 1/30; 1/10 is a good choice",
        )
    known = keys.bottom is not None and water.zero is not None and keys.bed == "moving"
    falls = keys.drive == "slope" and case.motion.gravity > 0.0
    estimated = water.depth is not None and depth != water.depth
    asked = u_star_given(case)
    along = case.motion.gravity * math.sin(slope_at_last(case.motion, case.timeline))
    if estimated and falls and along > 0.0 and asked > 0.0:  # the top of a loose bed is known to half a grain
        fits = asked**2 / along
        if water.depth is not None and abs(fits - water.depth) <= AGREE * water.depth:
            depth = water.depth  # no deposit: the stress is that on the rigid bed, all grains move over it
        else:
            depth = min(max(fits, depth - 0.5 * d, 0.5 * depth), depth + 0.5 * d)
    for text in refuse(
        depth=depth,
        dz=cell,
        z_low=(keys.bottom or 0.0) if known else 0.0,
        z_bed=(water.zero or 0.0) if known else 0.0,
        slope=slope_at_last(case.motion, case.timeline) if falls else None,
        tau_star=water.tau_star if case.grains.density > water.density else None,
        u_star=water.u_star,
        d=d,
        rho_s=case.grains.density,
        rho_w=water.density,
        g=case.motion.gravity,
    ):
        if "column begins" in text:
            allowed = f"{text}; must be at most water.zero, {water.zero:g} m, or left out"
            yield CaseError("water.column.bottom", keys.bottom, allowed)
            continue
        key, more = "u_star" if water.u_star else "tau_star", ""
        if estimated:
            over = water_over(case)
            more += f"; the depth is that over the loose bed, {over:.3g} m, give or take half a grain"
        if "rises downstream" in text:
            more += "; motion.slope must be above 0, or give water.column.drive = 'tau_star'"
        yield CaseError(f"water.{key}", getattr(water, key), text + more)
