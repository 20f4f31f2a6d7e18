"""A case as data: every section of a case file, checked and in SI."""

from pathlib import Path
from typing import Annotated

from pydantic import Field, PrivateAttr

from ryusa.casefile.builders.schema import BuildSection
from ryusa.casefile.column.schema import ColumnSection
from ryusa.casefile.contact.schema import ContactSection, RollingSection
from ryusa.casefile.domain import DomainSection, PlaneSection
from ryusa.casefile.feeds.schema import ExitSection, FeedSection
from ryusa.casefile.grains.schema import FormSection, GrainsSection
from ryusa.casefile.materials.schema import MaterialSection, PairSection
from ryusa.casefile.motion import MotionSection
from ryusa.casefile.quantities import Count, Name
from ryusa.casefile.record.schema import ChangeSection, RecordSection, StopSection, TimeSection
from ryusa.casefile.row.schema import RowSection
from ryusa.casefile.section import Section
from ryusa.casefile.walls.schema import WallSection
from ryusa.casefile.water.schema import WaterSection
from ryusa.catalogue import load
from ryusa.notebook import html_table

SCHEMA = (
    1  # of case files; raised with the major version of ryusa, where a key changes its name or its meaning
)


class Case(Section):
    """A case: what one run is to compute; every value is in SI once read."""

    schema_version: Annotated[Count, Field(alias="schema", ge=1, le=SCHEMA)] = SCHEMA
    """Schema that the file is written in, the major version of ryusa; left out, it is that of the reader."""
    title: Annotated[str, Field(max_length=200)] = ""
    """What this case is about."""
    seed: Annotated[Count, Field(ge=0, lt=2**63)] = 1
    """Seed of all random numbers of the case."""
    grains: GrainsSection
    contact: ContactSection
    rolling: RollingSection = RollingSection()
    motion: MotionSection
    domain: DomainSection = DomainSection()
    planes: tuple[PlaneSection, ...] = ()
    """Flat walls without end."""
    walls: tuple[WallSection, ...] = ()
    """Finite walls, at rest or moving."""
    water: WaterSection | None = None
    """Water; left out of a dry case."""
    build: BuildSection
    """First grains: kind names the builder, its keys follow."""
    feeds: tuple[FeedSection, ...] = ()
    """Where grains enter during the run."""
    exits: tuple[ExitSection, ...] = ()
    """Where grains leave."""
    time: TimeSection = TimeSection()
    stop: StopSection
    materials: dict[Name, MaterialSection] = Field(default_factory=lambda: {})
    """Materials of grains and walls other than that of [grains] and [contact], by name."""
    pairs: tuple[PairSection, ...] = ()
    """Contacts of two different materials."""
    shapes: dict[str, FormSection] = Field(default_factory=lambda: {})
    """Clumps of your own, by name, for grains.shape: made from a mesh or from ratios of axes."""
    timeline: tuple[ChangeSection, ...] = ()
    """Changes of the scene during the run, in order of time."""
    record: RecordSection = RecordSection()

    _text: str = PrivateAttr("")
    _path: Path | None = PrivateAttr(None)
    _overrides: dict[str, str] = PrivateAttr(default_factory=lambda: {})

    @property
    def column(self) -> ColumnSection:
        """Keys of [water.column], all defaults where the case leaves the table out."""
        return (self.water and self.water.column) or ColumnSection()

    @property
    def row(self) -> RowSection | None:
        """Keys of [water.row]; None where the case has no row."""
        return None if self.water is None else self.water.row

    @property
    def text(self) -> str:
        """The case file as the user wrote it, without overrides."""
        return self._text

    @property
    def path(self) -> Path | None:
        """File the case was read from; None for a case given as text."""
        return self._path

    @property
    def folder(self) -> Path:
        """Folder of the case file; the current one for a case given as text."""
        return (self._path.parent if self._path is not None else Path()).resolve()

    @property
    def overrides(self) -> dict[str, str]:
        """Keys set from outside the file."""
        return dict(self._overrides)

    @property
    def name(self) -> str:
        """Name for folders: that of the file without its ending."""
        return self._path.stem if self._path is not None else "case"

    def __repr__(self) -> str:
        water = "dry" if self.water is None else f"water '{self.water.profile}'"
        stop = ", ".join(f"{key} = {value:g}" for key, value in self.stop if isinstance(value, float | int))
        parts = [f"builder '{self.build.kind}'", water, f"stop at {stop}", f"seed {self.seed}"]
        parts += [
            f"{len(held)} {name}" for name in ("walls", "feeds", "exits") if (held := getattr(self, name))
        ]
        changed = f"; changed: {', '.join(self._overrides)}" if self._overrides else ""
        return f"Case '{self.title}' ({self._path or 'given as text'}: {', '.join(parts)}{changed})"

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        rows = load("ryusa.casefile.explain:explain")(self)
        return html_table(
            ("name", "value", "where it comes from"),
            [(f"{one.section}: {one.name}", one.shown, one.origin) for one in rows],
        )
