"""What a run shows in a notebook or a script: measures, pictures, pages and tables, made when asked for."""

import base64
import html
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ryusa.catalogue import MEASURES, PICTURES, MeasureEntry, PictureEntry, called, load
from ryusa.errors import CaseError, ResultsError
from ryusa.notebook import html_table
from ryusa.spelling import nearest_word
from ryusa.units import UnitError, quantity, span

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame
    from xarray import Dataset

    from ryusa.results.read import Results

_HEIGHT = 560  # pixels of a page within a notebook


@dataclass(frozen=True)
class Page:
    """An HTML page that holds everything itself; a notebook shows it.

    Attributes
    ----------
    text : the page.
    height : pixels that a notebook gives it.
    """

    text: str
    height: int = _HEIGHT

    def save(self, path: str | Path) -> Path:
        """Write the page to a file and return its path."""
        return _saved(self.text.encode("utf-8"), Path(path))

    def __repr__(self) -> str:
        return f"Page({len(self.text) / 1e6:.1f} MB; .save('run.html') writes it)"

    def _repr_html_(self) -> str:
        inside = html.escape(self.text, quote=True)
        return (
            f'<iframe srcdoc="{inside}" style="width: 100%; height: {self.height}px; border: 0" '
            'sandbox="allow-scripts allow-downloads"></iframe>'
        )


@dataclass(frozen=True)
class FilmFile:
    """A film of the grains; a notebook shows it.

    Attributes
    ----------
    data : the file.
    kind : "webp", "avif", "gif" or "mp4".
    """

    data: bytes
    kind: str

    def save(self, path: str | Path) -> Path:
        """Write the film to a file that ends in its kind, and return its path."""
        path = Path(path)
        if path.suffix.lower() != f".{self.kind}":
            raise CaseError("path", str(path), f"must end in .{self.kind}; film(kind=...) makes another kind")
        return _saved(self.data, path)

    def __repr__(self) -> str:
        return f"FilmFile({self.kind}, {len(self.data) / 1e6:.1f} MB; .save('film.{self.kind}') writes it)"

    def _repr_html_(self) -> str:
        held = base64.b64encode(self.data).decode("ascii")
        if self.kind == "mp4":
            return f'<video src="data:video/mp4;base64,{held}" style="max-width: 100%" controls loop></video>'
        return f'<img src="data:image/{self.kind};base64,{held}" style="max-width: 100%">'


def _saved(data: bytes, path: Path) -> Path:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from None
    return path


_UNITS = {
    **{name: "s" for name in ("begin", "end", "t", "settle", "window")},
    **{name: "m" for name in ("reach", "threshold", "length")},
}


def _in_si(options: dict[str, Any]) -> dict[str, Any]:
    """Options as functions take them, from those by the names and in the words of the command line."""
    found: dict[str, Any] = {}
    for name, value in options.items():
        keyword = "t" if name == "at" else name
        read = span if keyword == "reach" else quantity
        try:
            text = isinstance(value, str) and keyword in _UNITS
            found[keyword] = read(value, _UNITS[keyword]) if text else value
        except UnitError as error:
            raise CaseError(name, value, str(error)) from None
    return found


def measured(results: "Results", name: str, options: dict[str, Any]) -> Any:
    """Give what a measure finds in a run."""
    entry = _entry(name, MEASURES, "measure")
    function, given = called(entry), _in_si(options)
    taken = list(signature(function).parameters)[1:]
    for one in given:
        if one not in taken:
            raise CaseError(
                one, None, f"{name} does not take it; it takes {', '.join(taken)}", nearest_word(one, taken)
            )
    return function(results, **given)


def drawn(results: "Results", name: str, options: dict[str, Any]) -> "Figure":
    """Give a picture of a run; the options are its own, or of the measure that it draws."""
    entry, options = _entry(name, PICTURES, "picture"), _in_si(options)
    if not entry.measure:
        return called(entry)(results, **options)[0]
    of_measure, own = entry.parted(options)
    return load(entry.function)(measured(results, entry.measure, of_measure), **own)


def view_of(results: "Results", options: dict[str, Any]) -> Page:
    """Give the page with the grains in motion."""
    return Page(load("ryusa.view.page:view_page")(results, **options))


def film_of(results: "Results", kind: str, options: dict[str, Any]) -> FilmFile:
    """Give a film of the grains."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"film.{kind}"
        try:
            load("ryusa.view.film:film")(results, path, **options)
        except CaseError as error:
            if error.key != "output":
                raise
            raise CaseError("kind", kind, error.allowed) from None
        return FilmFile(path.read_bytes(), kind)


def report_of(runs: Sequence["Results"], size: float) -> Page:
    """Give the page about some runs."""
    return Page(load("ryusa.report.page:report_page")(runs, size=size), 2 * _HEIGHT)


def xarray_of(results: "Results", frames: slice) -> "Dataset":
    """Give frames as an xarray Dataset."""
    xarray = needed("xarray")
    units = {"x": "m", "v": "m/s", "omega": "rad/s"}
    held = {
        name: (("t", "grain", "axis"), getattr(results.frames, name)[frames], {"units": unit})
        for name, unit in units.items()
    }
    held |= {
        name: ("grain", getattr(results.grains, name), {"units": unit})
        for name, unit in (("d", "m"), ("m", "kg"))
    }
    places = {"t": results.frames.t[frames], "grain": np.arange(results.scene.n_grain), "axis": list("xyz")}
    about = {
        "title": str(results.case.get("title", "")),
        "folder": str(results.folder),
        "status": results.status,
    }
    return xarray.Dataset(held, coords=places, attrs=about)


def pandas_of(results: "Results", what: str, options: dict[str, Any]) -> "DataFrame":
    """Give contacts, energy account or a measure as a pandas DataFrame."""
    pandas = needed("pandas")
    if what == "contacts":
        rows = results.contacts
        columns: dict[str, Any] = {}
        for name in rows.dtype.names or ():
            if rows[name].ndim == 1:
                columns[name] = rows[name]
            else:
                columns |= {f"{name}_{axis}": rows[name][:, k] for k, axis in enumerate("xyz")}
        return pandas.DataFrame(columns)
    found = measured(results, what, options)
    averages = getattr(found, "averages", None)
    return pandas.DataFrame(found.rows() if averages is None else averages.rows())


def summary_table(results: "Results") -> str:
    """Give what `ryusa inspect` prints as HTML."""
    rows = load("ryusa.running.inspection:inspection_rows")(results)
    return html_table((), [(heading, text) for heading, text in rows if heading != "next"])


def _entry(name: str, entries: Sequence[Any], kind: str) -> Any:
    known: dict[str, MeasureEntry | PictureEntry] = {one.name: one for one in entries}
    if name not in known:
        near = nearest_word(name, list(known))
        meant = f"; did you mean '{near}'?" if near else ""
        raise ResultsError(f"no {kind} '{name}': there are {', '.join(known)}{meant}")
    return known[name]


def needed(package: str) -> Any:
    """Import a package of the extra `notebook`; where it is missing an error says how to install it."""
    from importlib import import_module

    try:
        return import_module(package)
    except ImportError:
        raise ResultsError(f"{package} is not installed; pip install 'ryusa[notebook]' adds it") from None
