"""Keys of the [build] section, one model per builder."""

from pathlib import PurePosixPath
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from ryusa.casefile.quantities import Count, Length, Number, PositiveLength, Speed, Spin
from ryusa.casefile.section import Section


class DropSection(Section):
    """One grain dropped on a fixed grain, a free grain or a plane."""

    kind: Literal["drop"]
    """Name of the builder."""
    partner: Literal["fixed", "free", "plane"] = "fixed"
    """What is struck: a fixed grain, a free grain, or the plane z = 0."""
    height: Annotated[Length, Field(ge=0)] | None = None
    """Gap between the two surfaces at the start; 0.1 d when a speed is given."""
    speed: Annotated[Speed, Field(ge=0)] = 0.0
    """Downward speed at the start."""
    speed_along: Speed = 0.0
    """Speed along x at the start."""
    spin: Spin = 0.0
    """Spin about y at the start; positive rolls towards +x."""
    offset: Length = 0.0
    """Horizontal distance of the two centres; makes the impact oblique."""
    copies: Annotated[Count, Field(ge=1, le=10_000)] = 1
    """Drops side by side, each in its own lane."""
    height_step: Annotated[Length, Field(ge=0)] = 0.0
    """How much higher each further copy starts."""


class SaltationSection(Section):
    """A grain over a line of fixed, touching grains, several starts side by side."""

    kind: Literal["saltation"]
    """Name of the builder."""
    n_bed: Annotated[Count, Field(ge=4, le=1_000_000)] = 20
    """Fixed grains in one period of the bed."""
    starts: Annotated[Count, Field(ge=1, le=100_000)] = 1
    """Independent grains, each over its own bed."""
    start_height: PositiveLength | None = None
    """Gap between bed crest and grain at the start; 2 d when not given."""
    start_speed: Speed | None = None
    """Speed along the bed at the start; that of the water at the grain's centre when not given."""


def _relative(path: str) -> str:
    parts = PurePosixPath(path.replace("\\", "/"))
    if parts.is_absolute() or ".." in parts.parts or ":" in path or "\0" in path:
        raise ValueError("needs a path inside the folder of the case file, such as 'grains.csv'")
    return str(parts)


class TableSection(Section):
    """Grains read from a CSV table."""

    kind: Literal["table"]
    """Name of the builder."""
    file: Annotated[str, Field(min_length=1, max_length=400), AfterValidator(_relative)]
    """CSV file inside the folder of the case; columns x, y, z, d, vx, vy, vz, wx, wy, wz with units in the
    header, such as x [cm], then fixed (0 or 1) and group (a name)."""
    allow_overlap: bool = False
    """May first grains overlap."""


class PackingSection(Section):
    """Layers of grains on a jittered lattice over fixed grains of random height; settles when run."""

    kind: Literal["packing"]
    """Name of the builder."""
    columns: Annotated[Count, Field(ge=3, le=100_000)]
    """Free grains along x in one layer."""
    rows: Annotated[Count, Field(ge=1, le=100_000)] = 1
    """Free grains along y in one layer; 1 in a plane scene."""
    layers: Annotated[Count, Field(ge=1, le=100_000)]
    """Layers above the bed."""
    gap: Annotated[Number, Field(ge=0, le=2)] = 0.1
    """Free room between lattice neighbours, in largest diameters."""
    jitter: Annotated[Number, Field(ge=0, le=1)] = 0.9
    """Part of that room used by random displacement."""
    bed: Literal["random", "flat", "plane"] = "random"
    """Bed of fixed grains of random height, of equal height, or a plane."""
    bed_height: Annotated[Number, Field(ge=0, le=2)] = 0.5
    """Range of the random heights, in mean diameters."""
    speed: Speed = 0.0
    """Speed along x at the start: grains that begin at rest may lie down and never start to move."""
    periodic: bool = True
    """Periodic along x, and along y in three dimensions; false leaves the ends open: give walls as
    [[planes]], at x = 0 and x = columns (1 + gap) largest diameters, or grains roll off the bed."""


class FlumeSection(Section):
    """A channel, periodic along x: loose grains over a base of fixed ones, between side walls or not."""

    kind: Literal["flume"]
    """Name of the builder."""
    length: PositiveLength
    """Period along x."""
    width: PositiveLength | None = None
    """Width along y; none in a plane scene."""
    walls: bool = True
    """Smooth side walls at y = 0 and y = width, planes `right` and `left`; false makes y periodic."""
    layers: Annotated[Number, Field(gt=0, le=100_000)]
    """Free grains, in layers of as many whole mean diameters as fit the length, times those that fit the
    width; a flume one grain wide holds layers x length/d of them."""
    gap: Annotated[Number, Field(ge=0, le=2)] = 0.05
    """Least free room between first neighbours, in largest diameters."""
    jitter: Annotated[Number, Field(ge=0, le=1)] = 0.9
    """Part of that room used by random displacement."""
    bed: Literal["random", "flat", "plane"] = "random"
    """Base of fixed grains of random height, of equal height, or a plane."""
    bed_height: Annotated[Number, Field(ge=0, le=2)] = 0.9167
    """Range of the random heights, in mean diameters; z = 0 is their mean, at the centres of the base. Frey
    2014 has 11/12."""


class BoxSection(Section):
    """Grains fall into a box of floor, back wall and gate; what the timeline removes lets them out."""

    kind: Literal["box"]
    """Name of the builder."""
    columns: Annotated[Count, Field(ge=1, le=100_000)]
    """Free grains along x in one layer; the gate stands columns (1 + gap) largest diameters from the back
    wall, rounded up to whole fixed grains where floor or walls are grains."""
    rows: Annotated[Count, Field(ge=1, le=100_000)] = 1
    """Free grains along y in one layer, periodic in y; 1 in a plane scene."""
    layers: Annotated[Count, Field(ge=1, le=100_000)]
    """Layers above the floor."""
    gap: Annotated[Number, Field(ge=0, le=2)] = 0.1
    """Free room between lattice neighbours, in largest diameters."""
    jitter: Annotated[Number, Field(ge=0, le=1)] = 0.9
    """Part of that room used by random displacement."""
    height: Annotated[Length, Field(ge=0)] = 0.0
    """Free height between the floor and the lowest layer, through which the whole lattice falls."""
    floor: Literal["grains", "plane"] = "grains"
    """Floor of touching fixed grains of mean diameter from the back wall to the end of the run-out, or the
    plane z = 0, which never ends. Group `floor`."""
    floor_height: Annotated[Number, Field(ge=0, le=1)] = 0.0
    """Range of random heights of the floor's grains, in mean diameters."""
    walls: Literal["grains", "planes"] = "planes"
    """Back wall with its face at x = 0 and gate: planes, or stacks of touching fixed grains of mean
    diameter. Groups `back` and `gate`."""
    run_out: Annotated[Length, Field(ge=0)] = 0.0
    """How far the floor of grains goes on beyond the gate, rounded up to whole grains; 0 ends it there."""
    drop: Annotated[Length, Field(ge=0)] | None = None
    """Depth below z = 0 of a plane that catches what leaves a floor of grains; none when not given.
    Group `pit`."""


BuildSection = Annotated[
    DropSection | SaltationSection | TableSection | PackingSection | FlumeSection | BoxSection,
    Field(discriminator="kind"),
]
