"""Keys of [water.row]."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, WithJsonSchema

from ryusa.casefile.course import FILE_OR_POINTS, AtPoints, CourseFile, file_or_points
from ryusa.casefile.files import RelativePath
from ryusa.casefile.quantities import Count, Length, Moment, Name, Number, PositiveLength, WordOf
from ryusa.casefile.section import Section
from ryusa.laws import families
from ryusa.units import UnitError, quantity

End = Literal["wall", "level", "free fall", "same depth", "discharge", "feeder reach"]
Discharge = tuple[float, Literal["m2/s", "m3/s"]]


def read_discharge(value: Any) -> Any:
    """Read a discharge per width, or one of the whole width.

    >>> read_discharge("300 cm2/s"), read_discharge("6 L/s")
    ((0.03, 'm2/s'), (0.006, 'm3/s'))
    """
    if isinstance(value, list | tuple):  # as case.json holds it
        return tuple(value)
    for unit in ("m2/s", "m3/s"):
        try:
            return quantity(value, unit), unit
        except UnitError:
            continue
    raise ValueError(
        "needs a discharge per width or of the whole width, such as '0.03 m2/s' or '0.006 m3/s'"
    ) from None


RowDischarge = Annotated[
    Discharge,
    BeforeValidator(read_discharge),
    WithJsonSchema(
        {
            "type": "string", "format": "quantity", "title": "discharge",
            "examples": ["0.03 m2/s", "6 L/s"],
        }
    ),
]  # fmt: skip


HydrographPoints = Annotated[tuple[tuple[Moment, RowDischarge], ...], AtPoints, Tag("<points>")]
Hydrograph = Annotated[CourseFile | HydrographPoints, FILE_OR_POINTS]
StagePoints = Annotated[tuple[tuple[Moment, Length], ...], AtPoints, Tag("<points>")]
Stage = Annotated[CourseFile | StagePoints, FILE_OR_POINTS]
LineFile = RelativePath
LinePoints = Annotated[tuple[tuple[Length, Length], ...], Field(min_length=2, max_length=10_000)]
Line = Annotated[
    Annotated[LineFile, Tag("<file>")] | Annotated[LinePoints, Tag("<points>")], Discriminator(file_or_points)
]


class RowEndSection(Section):
    """An end of the row."""

    end: End
    """What lies beyond: a wall; water at rest with the surface at `level`; a drop without water; the depth of
    the last segment, for flow that is uniform or supercritical; an inlet that keeps `discharge`; or a
    reach over an even bed, the finished periodic `run`, that feeds water and grains."""
    level: Length | None = None
    """Height of the surface beyond end = "level", over the x axis."""
    stage: Stage | None = None
    """Height of the surface over time beyond end = "level", downstream alone and instead of `level`: a CSV
    file in the folder of the case with the header t [s],z [m], or pairs of time and height, straight between
    them. Before the first and after the last it stays."""
    discharge: RowDischarge | None = None
    """Discharge of end = "discharge", upstream alone: per width, or of the whole width (`width`)."""
    hydrograph: Hydrograph | None = None
    """Discharge over time, instead of `discharge`: a CSV file in the folder of the case with the header
    t [s],q [m3/s] (or m2/s), or pairs of time and discharge, straight between them. Before the first and
    after the last it stays."""
    depth: PositiveLength | None = None
    """Depth of the water that enters, with end = "discharge" alone; over a dam or a bed of grains in the
    first segment it counts from the top. When not given: that of the row, and where normal flow is
    supercritical the normal depth."""
    profile: Literal["developed", "uniform"] = "developed"
    """Velocity over height with end = "discharge": that of steady flow over the bottom, or the same at every
    height."""
    run: RelativePath | None = None
    """Run folder of end = "feeder reach", upstream alone, within the folder of the case: a finished run of a
    periodic row over a moving bed. Discharge, profile and depth are its means after its record.settle; its
    grains enter as they cross its downstream end, and its record is repeated where it is the shorter one."""


class RowDamSection(Section):
    """A dam, a weir or a sill across the row, from the bottom up to a crest."""

    name: Name
    """Its name."""
    begin: Length
    """Where it begins along x; it takes the segments whose middles lie between begin and end."""
    end: Length
    """Where it ends."""
    crest: Length | None = None
    """Height of its crest over the x axis."""
    height: PositiveLength | None = None
    """Height over the bottom in its middle, instead of crest."""
    concentration: Annotated[Number, Field(gt=0, lt=0.9)] | None = None
    """Concentration of the grains of a dam that lets water through (Ergun's law); impermeable when not
    given."""
    diameter: PositiveLength | None = None
    """Diameter of its grains; the mean diameter of the case when not given."""
    aerated: bool = False
    """Whether air lies below the nappe, the water that falls over the crest; else it clings to the dam. With
    pressure = "full" alone: the water leaves the crest freely and lands in the pool, until the pool has risen
    above the crest."""


class RowSection(Section):
    """Columns of water in a row along x, each as [water.column] says: water that varies along the stream."""

    bottom: Line
    """Rigid bottom: pairs of x and z from upstream to downstream, straight between them, such as
    [["0 m", "0 cm"], ["4 m", "-8 cm"]], or a CSV file in the folder of the case with the header x [m],z [mm].
    The row reaches from the first to the last point. motion.slope tilts both axes. With grains of builder
    "stream" it is their floor; with those of other builders the row is periodic, as long as their period, and
    the bottom is the x axis."""
    segments: Annotated[Count, Field(ge=1, le=100_000)] | None = None
    """Number of segments of equal length."""
    segment: PositiveLength | None = None
    """Length of a segment, instead of their number; the row is divided into the nearest whole number."""
    height: PositiveLength | None = None
    """Height of the cells over the bottom; water that stands higher stops the run. When not given 1.5 times
    the largest depth that the case lets expect, with the bed below it."""
    surface: Line | None = None
    """Surface of the water at the start, as pairs of x and z or a CSV file; below the bottom it is dry.
    Instead of water.depth, the depth over the bottom."""
    pressure: Annotated[str, WordOf(families.Pressure)] = "hydrostatic"
    """Pressure of the water: the weight of what lies above, or with what turns the water up and down, which
    short waves, flow over sills, jumps and pores need. A step of the water takes two to three times as
    long."""
    width: PositiveLength | None = None
    """Width of the stream, for grains and for a discharge in m3/s; `column.side_walls` when not given."""
    upstream: RowEndSection | None = None
    """Upper end, at the first point of the bottom. Without both ends the row is periodic."""
    downstream: RowEndSection | None = None
    """Lower end, at the last point."""
    dams: tuple[RowDamSection, ...] = ()
    """Dams, weirs and sills: [[water.row.dams]]."""
