"""Keys of the [build] section, one model per builder."""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag

from ryusa.casefile.files import RelativePath
from ryusa.casefile.quantities import (
    Boolean,
    Count,
    Length,
    Moment,
    Name,
    Number,
    Point,
    PositiveLength,
    Speed,
    Spin,
)
from ryusa.casefile.row.schema import LineFile, LinePoints
from ryusa.casefile.section import Section
from ryusa.units import quantity


class BedOfRunSection(Section):
    """The bed that another run of builder 'stream' has left: its grains in one frame."""

    run: RelativePath
    """Its folder, within the folder of the case."""
    at: Moment | None = None
    """Time of the frame, the nearest; the last frame when not given."""


def _bed_kind(value: Any) -> str:
    if isinstance(value, dict | BedOfRunSection):
        return "<run>"
    if isinstance(value, str) and value.lower().endswith(".csv"):
        return "<file>"
    return "<points>" if isinstance(value, list | tuple) else "<thickness>"


BedThickness = Annotated[
    Annotated[Length, Field(ge=0), Tag("<thickness>")]
    | Annotated[LineFile, Tag("<file>")]
    | Annotated[LinePoints, Tag("<points>")]
    | Annotated[BedOfRunSection, Tag("<run>")],
    Discriminator(_bed_kind),
]


class DropSection(Section):
    """One grain dropped on a fixed grain, a free grain or a plane."""

    kind: Literal["drop"]
    """Name of the builder."""
    partner: Literal["fixed", "free", "plane"] = "fixed"
    """What is struck: a fixed grain, a free grain, or the plane z = 0."""
    height: Annotated[Length, Field(ge=0)] | None = None
    """Gap between the two surfaces at the start; 0.1 d when only a speed is given."""
    speed: Annotated[Speed, Field(ge=0)] = 0.0
    """Downward speed at the start."""
    speed_along: Speed = 0.0
    """Speed along x at the start."""
    spin: Spin = 0.0
    """Angular velocity about y at the start; positive rolls towards +x."""
    offset: Length = 0.0
    """Horizontal distance between the two centres, for an oblique impact."""
    copies: Annotated[Count, Field(ge=1, le=10_000)] = 1
    """Number of independent drops, side by side in separate lanes."""
    height_step: Annotated[Length, Field(ge=0)] = 0.0
    """Difference in height between one copy and the next."""


class SaltationSection(Section):
    """One free grain over a line of fixed, touching grains; several independent starts side by side."""

    kind: Literal["saltation"]
    """Name of the builder."""
    n_bed: Annotated[Count, Field(ge=4, le=1_000_000)] = 20
    """Number of fixed grains in one period of the bed."""
    starts: Annotated[Count, Field(ge=1, le=100_000)] = 1
    """Number of independent starts, each over a bed of its own."""
    start_height: PositiveLength | None = None
    """Gap between the crest of the bed and the grain at the start; 2 d when not given."""
    start_speed: Speed | None = None
    """Speed along x at the start; that of the water at the centre of the grain when not given."""


def _unit_of(dimension: str) -> AfterValidator:
    def check(unit: str) -> str:
        quantity(f"1 {unit}", dimension)
        return unit

    return AfterValidator(check)


class TableSection(Section):
    """Grains read from a file: a table, or what `ryusa export`, LAMMPS, OVITO or ASE write."""

    kind: Literal["table"]
    """Name of the builder."""
    file: RelativePath
    """File in the folder of the case. A CSV file has columns x, y, z, d, vx, vy, vz, wx, wy, wz with their
    units in the header, such as x [cm]; m or density; fixed (0 or 1) and group (a name). x, z and d are
    required. Columns may be separated by commas, semicolons or tabs."""
    format: Literal["csv", "lammps-dump", "lammps-data", "xyz", "vtu"] = "csv"
    """Format of the file: "lammps-data" with atom_style sphere, "xyz" plain or extended, "vtu" of ryusa
    alone. Where it states no diameters, grains have grains.diameter; where it states masses or densities,
    these hold in place of grains.density."""
    frame: Annotated[Count, Field(ge=0)] | None = None
    """Number of the frame, from 0; the last when not given."""
    length_unit: Annotated[str, _unit_of("m")] = "m"
    """Unit of the lengths in a LAMMPS or xyz file."""
    time_unit: Annotated[str, _unit_of("s")] = "s"
    """Unit of the times in the velocities and spins of a LAMMPS or xyz file."""
    mass_unit: Annotated[str, _unit_of("kg")] = "kg"
    """Unit of the masses in a LAMMPS or xyz file, also in its densities."""
    fixed_types: tuple[Annotated[Count, Field(ge=0)], ...] = ()
    """Atom types of a LAMMPS file whose grains never move; 2 in the dumps of ryusa."""
    made_of: dict[str, str] = Field(default_factory=dict)
    """Materials of free grains by their group in the file, such as { ball = "steel" }; the others are of the
    material of [grains]."""
    allow_overlap: Boolean = False
    """Whether grains may overlap at the start."""


class RunSection(Section):
    """Grains of a frame of another run, free and fixed, with its periods and planes."""

    kind: Literal["run"]
    """Name of the builder."""
    folder: RelativePath
    """Run folder, within the folder of the case."""
    at: Moment | None = None
    """Time of the frame, the nearest; the last frame when not given."""
    made_of: dict[str, str] = Field(default_factory=dict)
    """Materials of free grains by their group in the run, such as { ball = "steel" }; the others are of the
    material of [grains]. What a feed brought is a group of its name."""
    allow_overlap: Boolean = True
    """Whether grains may overlap at the start, as grains in contact do."""


FromFile = TableSection | RunSection  # builders whose grains exist before the case is read


class PackingSection(Section):
    """Layers of free grains, randomly displaced from a lattice, over a bed; they settle during the run."""

    kind: Literal["packing"]
    """Name of the builder."""
    columns: Annotated[Count, Field(ge=3, le=100_000)]
    """Free grains along x in one layer."""
    rows: Annotated[Count, Field(ge=1, le=100_000)] = 1
    """Free grains along y in one layer; 1 in a plane scene."""
    layers: Annotated[Count, Field(ge=1, le=100_000)]
    """Number of layers above the bed."""
    gap: Annotated[Number, Field(ge=0, le=2)] = 0.1
    """Gap between neighbours on the lattice, in largest diameters."""
    jitter: Annotated[Number, Field(ge=0, le=1)] = 0.9
    """Fraction of that gap used for random displacements."""
    bed: Literal["random", "flat", "plane"] = "random"
    """Bed of fixed grains at random heights ("random") or equal heights ("flat"), or a plane."""
    bed_height: Annotated[Number, Field(ge=0, le=2)] = 0.5
    """Range of the random heights, in mean diameters."""
    speed: Speed = 0.0
    """Speed along x at the start; grains released at rest may settle and never start to move."""
    periodic: Boolean = True
    """Periodic in x, and in y in three dimensions. With false the ends are open and grains leave the bed,
    unless [[planes]] close it at x = 0 and x = columns (1 + gap) largest diameters."""


class FlumeSection(Section):
    """A channel, periodic in x: loose grains over a base of fixed grains, with or without side walls."""

    kind: Literal["flume"]
    """Name of the builder."""
    length: PositiveLength
    """Length of the channel, its period in x."""
    width: PositiveLength | None = None
    """Width of the channel in y; needed in three dimensions, not allowed in a plane scene."""
    walls: Boolean = True
    """Smooth side walls, the planes `right` at y = 0 and `left` at y = width; false makes y periodic."""
    layers: Annotated[Number, Field(gt=0, le=100_000)]
    """Number of free grains, in layers; one layer is as many grains of mean diameter as fit side by side
    along the length, times those that fit across the width; of a sieve_curve as many as have that volume."""
    gap: Annotated[Number, Field(ge=0, le=2)] = 0.05
    """Smallest gap between neighbours at the start, in largest diameters."""
    jitter: Annotated[Number, Field(ge=0, le=1)] = 0.9
    """Fraction of that gap used for random displacements."""
    bed: Literal["random", "flat", "plane"] = "random"
    """Base of fixed grains at random heights ("random") or equal heights ("flat"), or a plane."""
    bed_height: Annotated[Number, Field(ge=0, le=2)] = 0.9167
    """Range of the random heights, in mean diameters; the mean height of the centres is z = 0. 11/12 in Frey
    2014."""
    waves: Annotated[Count, Field(ge=0, le=100_000)] = 0
    """Waves of the loose bed along the length at the start: its thickness is the mean plus half of
    wave_height times cos(2 pi waves x/length), with a crest at x = 0. `layers` is then a mean."""
    wave_height: Annotated[Length, Field(ge=0)] = 0.0
    """Height of these waves from trough to crest, of the bed settled to the concentration
    water.column.packed."""


class BoxSection(Section):
    """Grains fall into a box of floor, back wall and gate; [[timeline]] removes a part and lets them out."""

    kind: Literal["box"]
    """Name of the builder."""
    columns: Annotated[Count, Field(ge=1, le=100_000)]
    """Free grains along x in one layer. The gate stands columns (1 + gap) largest diameters from the back
    wall, rounded up to whole grains where floor or walls consist of grains."""
    rows: Annotated[Count, Field(ge=1, le=100_000)] = 1
    """Free grains along y in one layer, periodic in y; 1 in a plane scene."""
    layers: Annotated[Count, Field(ge=1, le=100_000)]
    """Number of layers above the floor."""
    gap: Annotated[Number, Field(ge=0, le=2)] = 0.1
    """Gap between neighbours on the lattice, in largest diameters."""
    jitter: Annotated[Number, Field(ge=0, le=1)] = 0.9
    """Fraction of that gap used for random displacements."""
    height: Annotated[Length, Field(ge=0)] = 0.0
    """Height between the floor and the lowest layer, through which all grains fall."""
    floor: Literal["grains", "plane"] = "grains"
    """Floor of touching fixed grains of mean diameter from the back wall to the end of the run-out, or the
    unbounded plane z = 0. Group `floor`."""
    floor_height: Annotated[Number, Field(ge=0, le=1)] = 0.0
    """Range of the random heights of the grains of the floor, in mean diameters."""
    walls: Literal["grains", "planes"] = "planes"
    """Back wall, its face at x = 0, and gate: planes, or stacks of touching fixed grains of mean diameter.
    Groups `back` and `gate`."""
    run_out: Annotated[Length, Field(ge=0)] = 0.0
    """Length of the floor of grains beyond the gate, rounded up to whole grains."""
    drop: Annotated[Length, Field(ge=0)] | None = None
    """Depth below z = 0 of a plane that catches grains leaving a floor of grains; no plane when not given.
    Group `pit`."""


class EmptySection(Section):
    """No free grain at the start: all come from [[feeds]]; on a plate of fixed grains, or between planes."""

    kind: Literal["empty"]
    """Name of the builder."""
    plate: PositiveLength | None = None
    """Radius of a round plate of touching fixed grains of mean diameter, centred on x = y = 0 with its top at
    z = 0; in a plane scene a row from -plate to plate. No plate when not given. Group `floor`."""


class FillSection(Section):
    """Grains in a box of space, or inside a wall, to fall between [[walls]] and [[planes]] of the case."""

    kind: Literal["fill"]
    """Name of the builder."""
    low: Point | None = None
    """Lower corner of the box that the grains fill at the start."""
    high: Point | None = None
    """Upper corner of the box."""
    inside: Name | None = None
    """Name of a wall that the grains fill instead of a box, where it is at the start: a cylinder, between its
    ends, or a mesh that is closed or whose openings have flat rims, which count as closed by lids. Whole
    grains lie inside."""
    most: Annotated[Count, Field(ge=1, le=20_000_000)] | None = None
    """Most grains, the lowest ones; as many as the box or the wall holds when not given."""
    number: Annotated[Count, Field(ge=1, le=20_000_000)] | None = None
    """Number of grains, the lowest ones; it is an error if fewer fit."""
    plate: PositiveLength | None = None
    """Radius of a round plate of touching fixed grains of mean diameter, as of builder "empty"."""
    periodic: Boolean = False
    """Periodic in x, and in y in three dimensions, with the lengths of the box; otherwise open."""
    gap: Annotated[Number, Field(ge=0, le=2)] = 0.05
    """Gap between neighbours on the lattice, in largest diameters."""
    jitter: Annotated[Number, Field(ge=0, le=1)] = 0.9
    """Fraction of that gap used for random displacements."""


class StreamSection(Section):
    """Grains in a row of columns with ends, [water.row]: a bed along its bottom, or none at the start."""

    kind: Literal["stream"]
    """Name of the builder. The line water.row.bottom is the floor, each of water.row.dams a wall, and
    water.row.width the width; a screen, the plane `upstream`, holds grains at the upper end."""
    bed: BedThickness = 0.0
    """Thickness of a bed along the bottom, settled to the concentration water.column.packed; it is laid loose
    and settles in the run. Or its thickness along the stream: pairs of x and thickness, straight between
    them, or a CSV file with the header x [m],z [mm], z the thickness. Or the grains of another run, such as
    { run = "runs/settled" }, as they are there, so that the bed has settled before this run begins. None when
    not given: all grains come from [[feeds]]."""
    begin: Length | None = None
    """Where the bed begins along x; when not given at the upper end, or at the first point of its
    thickness."""
    end: Length | None = None
    """Where the bed ends; when not given at the lower end, or at the last point of its thickness. There is
    none on dams."""
    walls: Boolean = True
    """Smooth side walls, the planes `right` at y = 0 and `left` at y = water.row.width; false makes y
    periodic."""
    gap: Annotated[Number, Field(ge=0, le=2)] = 0.05
    """Gap between neighbours on the lattice, in largest diameters."""
    jitter: Annotated[Number, Field(ge=0, le=1)] = 0.9
    """Fraction of that gap used for random displacements."""


BuildSection = Annotated[
    DropSection
    | SaltationSection
    | TableSection
    | RunSection
    | PackingSection
    | FlumeSection
    | BoxSection
    | EmptySection
    | FillSection
    | StreamSection,
    Field(discriminator="kind"),
]
