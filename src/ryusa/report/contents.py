"""What the report says of one run: what ran, its measures, its pictures; each that fails gives its reason."""

import io
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from ryusa.catalogue import MEASURES, PICTURES, MeasureEntry, PictureEntry, called, load
from ryusa.errors import RyusaError
from ryusa.figures.style import applied
from ryusa.measure._run import settle_time
from ryusa.measure.long_section import LongSection
from ryusa.measure.table import ROUND_OFF
from ryusa.results import Results, schema
from ryusa.results.label import run_label
from ryusa.running.inspection import inspection_rows, state_of
from ryusa.study.html import embedded
from ryusa.view.page import encoded

if TYPE_CHECKING:
    from ryusa.casefile.facts import Derived

DPI = 200  # of a picture in the page
_ONE_COLUMN = 5.0  # inch; a wider picture takes the whole width of the page
_OWN = ("run", "next")  # rows that a page has no use for: its title, and a command with the path of a machine
_LINES = 400  # of the case file that are shown
_SEGMENTS = 24  # of a row that a table on the page lists
_LONG = {"x_t", "flow_field", "bed_waves"}  # tables that a page leaves to `ryusa measure`
_PLAIN = (
    "walls",
    "traffic",
    "row",
    "structures",
    "open",
)  # needs of measures that are seen in the scene of a run


@dataclass(frozen=True)
class ExplainedValue:
    """A value of the case or one that follows from it, as `ryusa check` prints it."""

    section: str
    name: str
    shown: str
    origin: str
    flag: str


@dataclass(frozen=True)
class MeasureTable:
    """What a measure found: a table, and notes beneath it."""

    name: str
    doc: str
    heads: tuple[str, ...]
    rows: list[tuple[str, ...]]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Drawing:
    """A picture as an address that holds it."""

    name: str
    doc: str
    address: str
    wide: bool  # its letters need the whole width of the page
    height: float  # over its width [-]


@dataclass
class RunContents:
    """All that the report says of one run."""

    title: str
    label: str
    folder: str
    status: str
    complete: bool
    rows: list[tuple[str, str]]
    values: list[ExplainedValue] = field(default_factory=list[ExplainedValue])
    measures: list[MeasureTable] = field(default_factory=list[MeasureTable])
    averages: dict[str, Any] = field(default_factory=dict[str, Any])  # quantity -> measure.statistics.Average
    drawings: list[Drawing] = field(default_factory=list[Drawing])
    missing: list[tuple[str, str]] = field(default_factory=list[tuple[str, str]])
    case_text: str = ""
    viewer: tuple[dict[str, Any], str] | None = None


def contents_of(results: Results, *, size: float, progress: Callable[[float], None]) -> RunContents:
    """Collect what the report says of a run; what cannot be had is listed with its reason."""
    found = RunContents(
        title=str(results.case.get("title") or results.folder.resolve().name),
        label=run_label(results),
        folder=results.folder.resolve().name,
        status=state_of(results),
        complete=results.complete,
        rows=[row for row in inspection_rows(results) if row[0] not in _OWN],
    )
    explain_values(found, results)
    kind = str((results.case.get("build") or {}).get("kind", ""))
    had = _had(results)
    along_row = _measures_of_row(results, had)
    for entry in MEASURES:
        if (kind in entry.builders and had >= _asked(entry)) or entry.name in along_row - _LONG:
            _attempt(found, f"measure {entry.name}", lambda one=entry: _measure(found, results, one))
    progress(0.2)
    lacking = {one.name for one in MEASURES if not had >= _asked(one)}
    for entry in PICTURES:
        if entry.measure not in lacking and (
            entry.measure in along_row
            or kind in entry.builders
            or (not kind and not entry.settled and not entry.measure)
        ):
            _attempt(found, f"picture {entry.name}", lambda one=entry: draw_picture(found, results, one))
    progress(0.5)

    def view() -> None:
        found.viewer = encoded(results, size=size, progress=lambda share: progress(0.5 + 0.5 * share))

    _attempt(found, "grains in motion", view)
    progress(1.0)
    return found


def _had(results: Results) -> set[str]:
    """What the run has of `_PLAIN`."""
    scene, row = results.scene, results.row
    there = {
        "walls": scene.walls is not None and bool(scene.n_grain),
        "traffic": scene.traffic is not None,
        "structures": row is not None
        and (bool(results.case.get("walls")) or not all(dam.porous for dam in row.row.dams)),
        "row": row is not None,
        "open": row is None or not row.row.periodic,
    }
    return {word for word in _PLAIN if there[word]}


def _asked(entry: MeasureEntry) -> set[str]:
    """What a measure needs that a run has or has not, whatever its numbers are."""
    return {*entry.needs} & {*_PLAIN}


def _measures_of_row(results: Results, had: set[str]) -> set[str]:
    """Names of the measures of a row of columns that it allows, of its grains where it has some."""
    if results.row is None:
        return set()
    grains = bool(results.scene.n_grain)
    return {
        one.name
        for one in MEASURES
        if "row" in one.needs and had >= {*one.needs} and (grains or one.grainless)
    }


def _attempt(found: RunContents, what: str, act: Callable[[], None]) -> None:
    try:
        act()
    except RyusaError as error:
        found.missing.append((what, str(error)))


def explain_values(found: RunContents, results: Results) -> None:
    """Add the text of the case, and its values as `ryusa check` prints them."""
    path = results.folder / schema.CASE_TOML
    if path.is_symlink() or not path.is_file():
        found.missing.append(("case", "the run was made from a script and holds no case file"))
        return
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    found.case_text = "\n".join(lines[:_LINES])

    def explain_case() -> None:
        from ryusa.casefile import explain
        from ryusa.casefile.derive import derive
        from ryusa.casefile.read import read

        overrides = results.provenance.get("overrides")
        given = {str(key): str(one) for key, one in overrides.items()} if isinstance(overrides, dict) else {}
        case = read(path, given)
        found.values = [
            ExplainedValue(row.section, row.name, row.shown, row.origin, row.flag)
            for row in explain(case, _counted(derive(case), results))
        ]

    _attempt(found, "values of the case", explain_case)


def _counted(derived: "Derived", results: Results) -> "Derived":
    """What follows from a case, with the grains of the run instead of those expected of its feeds."""
    scene = results.scene
    if scene.traffic is None:
        return derived
    return replace(derived, n_grain=int(scene.heads.sum()), n_sphere=scene.n_grain)


def _need_settled(results: Results) -> None:
    settle = settle_time(results)
    last = float(results.frames.t[-1]) if len(results.frames) else 0.0
    if settle > 0.0 and last <= settle:
        raise RyusaError(f"the run ends at t = {last:.3g} s, while it still settles (until {settle:g} s)")


def _measure(found: RunContents, results: Results, entry: MeasureEntry) -> None:
    if entry.settled:
        _need_settled(results)
    record = called(entry)(results, **_means(results, entry))
    averages = getattr(record, "averages", None)
    if isinstance(record, LongSection):
        found.measures.append(_of_segments(entry, record))
        return
    if averages is None:
        rows = [(name, f"{value:.4g}", unit) for name, value, unit in record.quantities()]
        found.measures.append(MeasureTable(entry.name, entry.doc, ("quantity", "value", "unit"), rows))
        return
    sampled = [one for one in averages.items if one.n]
    found.averages.update({f"{entry.name}: {one.name}": one for one in sampled})
    heads = ("quantity", "value", "± s.e.", "unit", "samples", "window (s)", "steady")
    rows = [
        (
            one.name, f"{one.value:.4g}", one.error_text, one.unit, str(one.n),
            f"{one.window[0]:.3g} to {one.window[1]:.4g}", one.verdict,
        )
        for one in sampled
    ]  # fmt: skip
    notes = averages.remarks
    if not rows:
        notes = (*notes, "no samples in the window")
    found.measures.append(MeasureTable(entry.name, entry.doc, heads, rows, notes))


def _means(results: Results, entry: MeasureEntry) -> dict[str, float]:
    """Window of a measure that gives one moment without: what follows settling, where that has two frames."""
    settle = settle_time(results)
    if entry.name != "long_section" or int((results.frames.t >= settle).sum()) < 2:
        return {}
    return {"begin": settle}


def _of_segments(entry: MeasureEntry, found: LongSection) -> MeasureTable:
    """A long section as a table of its segments, each mean with its error."""
    columns = {
        "x": "x (m)", "bed": "bed (m)", "surface": "surface (m)", "depth": "depth (m)",
        "speed": "speed (m/s)", "froude": "Froude (–)", "discharge": "water q_w (m²/s)",
    }  # fmt: skip
    if found.grains:
        columns |= {"solid_discharge": "grains q_s (m²/s)", "concentration": "concentration (–)"}
    tiny = {name: ROUND_OFF * float(np.nanmax(np.abs(getattr(found, name)), initial=0.0)) for name in columns}

    def cell(name: str, k: int) -> str:
        value = float(getattr(found, name)[k])
        if math.isnan(value):
            return "–"
        text = f"{0.0 if abs(value) < tiny[name] else value:.4g}"
        if name not in found.error:
            return text
        error = float(found.error[name][k])
        return f"{text} ± {0.0 if error < tiny[name] else error:.2g}"

    every = -(-len(found.x) // _SEGMENTS)
    rows = [tuple(cell(name, k) for name in columns) for k in range(every // 2, len(found.x), every)]
    at = f"at t = {found.t:.4g} s"
    if found.window is not None:
        at = f"means with standard errors over t = {found.window[0]:.4g} to {found.window[1]:.4g} s"
    some = f"one in {every} is listed; `ryusa measure RUN long_section --csv FILE` writes all {len(found.x)}"
    return MeasureTable(entry.name, entry.doc, tuple(columns.values()), rows, (at, *[some] * (every > 1)))


def draw_picture(found: RunContents, results: Results, entry: PictureEntry, **how: Any) -> None:
    """Draw a picture of a run and add it; an error says why there is none. `how`: options of its function."""
    if entry.settled:
        _need_settled(results)
    if entry.measure:
        source = next(one for one in MEASURES if one.name == entry.measure)
        figure: Figure = load(entry.function)(called(source)(results), **how)
    else:
        figure, _ = called(entry)(results)
    held = io.BytesIO()
    with applied():
        figure.savefig(held, format="png", dpi=DPI, pil_kwargs={"compress_level": 0})  # packed by `embedded`
    held.seek(0)
    width, height = map(float, figure.get_size_inches())
    found.drawings.append(Drawing(entry.name, entry.doc, embedded(held), width > _ONE_COLUMN, height / width))
