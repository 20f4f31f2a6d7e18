"""The results of a run, with the measures, pictures and pages that a notebook or a script asks for."""

import base64
import html
import re
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
from ryusa.results.read import RunArrays
from ryusa.spelling import nearest_word
from ryusa.units import UnitError, quantity, span

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame
    from xarray import Dataset


_HEIGHT = 560  # pixels of a page within a notebook
_FILM = "film of the run"


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
        return saved(self.text.encode("utf-8"), Path(path))

    def __repr__(self) -> str:
        return f"Page({len(self.text) / 1e6:.1f} MB; .save('run.html') writes it)"

    def _repr_html_(self) -> str:
        inside = html.escape(self.text, quote=True)
        titled = re.search(r"<title>(.*?)</title>", self.text, flags=re.DOTALL)
        title = html.escape(html.unescape(titled[1]), quote=True) if titled else "page of ryusa"
        return (
            f'<iframe srcdoc="{inside}" title="{title}" sandbox="allow-scripts allow-downloads" '
            f'style="width: 100%; height: {self.height}px; border: 0"></iframe>'
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
        return saved(self.data, path)

    def __repr__(self) -> str:
        return f"FilmFile({self.kind}, {len(self.data) / 1e6:.1f} MB; .save('film.{self.kind}') writes it)"

    def _repr_html_(self) -> str:
        held = base64.b64encode(self.data).decode("ascii")
        if self.kind == "mp4":
            return (
                f'<video src="data:video/mp4;base64,{held}" aria-label="{_FILM}" style="max-width: 100%" '
                "controls loop></video>"
            )
        return f'<img src="data:image/{self.kind};base64,{held}" alt="{_FILM}" style="max-width: 100%">'


def saved(data: bytes, path: Path) -> Path:
    """Write a page, a picture or a film, and its folder where there is none."""
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


class Results(RunArrays):
    """The results of a run, read-only. Open the folder again to see what was written since."""

    def measure(self, name: str, **options: Any) -> Any:
        """Measure the run, as `ryusa measure RUN name` does.

        Parameters
        ----------
        name : of a measure, such as "transport"; `ryusa measure --help` lists them.
        options : keywords of `ryusa.measure.<name>`, such as begin [s].

        Raises
        ------
        ResultsError : no such measure, or the run does not hold what it needs.
        """
        entry = _entry(name, MEASURES, "measure")
        function, given = called(entry), _in_si(options)
        taken = list(signature(function).parameters)[1:]
        for one in given:
            if one not in taken:
                allowed = f"{name} does not take it; it takes {', '.join(taken)}"
                raise CaseError(one, None, allowed, nearest_word(one, taken))
        return function(self, **given)

    def draw(self, name: str, **options: Any) -> "Figure":
        """Draw a picture of the run, as `ryusa draw RUN name` does; a notebook shows the figure.

        Parameters
        ----------
        name : of a picture, such as "tracks"; `ryusa draw --help` lists them.
        options : keywords of the picture, or of the measure that it draws.

        Raises
        ------
        ResultsError : no such picture, or the run does not hold what it needs.
        """
        entry, options = _entry(name, PICTURES, "picture"), _in_si(options)
        if not entry.measure:
            return called(entry)(self, **options)[0]
        of_measure, own = entry.parted(options)
        return load(entry.function)(self.measure(entry.measure, **of_measure), **own)

    def view(self, **options: Any) -> Page:
        """Give the page with the grains in motion that `ryusa view` writes; a notebook shows it.

        Parameters
        ----------
        options : begin and end of the window [s], and the largest size of the page [B].
        """
        return Page(load("ryusa.view.page:view_page")(self, **options))

    def film(self, kind: str = "webp", **options: Any) -> FilmFile:
        """Give the film of the grains that `ryusa film` writes; a notebook shows it.

        Parameters
        ----------
        kind : "webp", "avif", "gif" or "mp4".
        options : view, colour, begin and end of the window [s], speed or frames, fps, size (width, height)
            in pixels, and the grain to follow, as of `ryusa film`.

        Raises
        ------
        CaseError : an option out of its range, or a kind that cannot be written here.
        """
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"film.{kind}"
            try:
                load("ryusa.view.film:film")(self, path, **options)
            except CaseError as error:
                if error.key != "output":
                    raise
                raise CaseError("kind", kind, error.allowed) from None
            return FilmFile(path.read_bytes(), kind)

    def report(self, *others: "Results", size: float = 1.0e7) -> Page:
        """Give the page that `ryusa report` writes, with other runs beside this one; size in bytes."""
        return Page(load("ryusa.report.page:report_page")((self, *others), size=size), 2 * _HEIGHT)

    def to_xarray(self, frames: slice = slice(None)) -> "Dataset":
        """Give frames as an xarray Dataset in SI: x, v, omega over t, grain and axis; d and m over grain.

        Raises
        ------
        ResultsError : xarray is not installed.
        """
        xarray = needed("xarray")
        units = {"x": "m", "v": "m/s", "omega": "rad/s"}
        held = {
            name: (("t", "grain", "axis"), getattr(self.frames, name)[frames], {"units": unit})
            for name, unit in units.items()
        }
        held |= {
            name: ("grain", getattr(self.grains, name), {"units": unit})
            for name, unit in (("d", "m"), ("m", "kg"))
        }
        places = {"t": self.frames.t[frames], "grain": np.arange(self.scene.n_grain), "axis": list("xyz")}
        about = {
            "title": str(self.case.get("title", "")),
            "folder": str(self.folder),
            "status": self.status,
        }
        return xarray.Dataset(held, coords=places, attrs=about)

    def to_pandas(self, what: str = "contacts", **options: Any) -> "DataFrame":
        """Give a table as a pandas DataFrame in SI.

        Parameters
        ----------
        what : "contacts", or a measure: its averages where it has some, else its rows.
        options : of the measure.

        Raises
        ------
        ResultsError : pandas is not installed, or there is no such measure.
        """
        pandas = needed("pandas")
        if what == "contacts":
            rows = self.contacts
            columns: dict[str, Any] = {}
            for name in rows.dtype.names or ():
                if rows[name].ndim == 1:
                    columns[name] = rows[name]
                else:
                    columns |= {f"{name}_{axis}": rows[name][:, k] for k, axis in enumerate("xyz")}
            return pandas.DataFrame(columns)
        found = self.measure(what, **options)
        averages = getattr(found, "averages", None)
        return pandas.DataFrame(found.rows() if averages is None else averages.rows())

    def _repr_html_(self) -> str:
        rows = load("ryusa.running.inspection:inspection_rows")(self)
        return html_table((), [(heading, text) for heading, text in rows if heading != "next"])
