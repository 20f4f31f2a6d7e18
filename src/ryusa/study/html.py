"""Shared parts of all pages: templates, and pictures embedded in the page."""

import base64
import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from PIL import Image

from ryusa.running.disk import write_atomically
from ryusa.study.cost import code_in_words

COLOURS = 256  # of an embedded picture
ONE_COLUMN = 1600  # pixels; a wider picture is shown at full page width, so that its text remains legible


def template(path: Path, **filters: Callable[..., Any]) -> Template:
    """Load the template of a study, which may include those of this package; an unknown name is an error."""
    folders = [path.parent, Path(__file__).parent]
    page = Environment(
        loader=FileSystemLoader(folders), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    page.filters.update({"number": number, "code": code_in_words, **filters})
    return page.get_template(path.name)


def embedded(picture: Path | BinaryIO) -> str:
    """Return a PNG as a data URL with at most COLOURS colours.

    It has about a third of the bytes of the file, which is not changed.
    """
    held = io.BytesIO()
    with Image.open(picture) as image:
        flat = image.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    flat.save(held, "PNG")  # `optimize` takes ten times as long for 3 % of the bytes
    return "data:image/png;base64," + base64.b64encode(held.getvalue()).decode("ascii")


def is_wide(picture: Path) -> bool:
    """Whether a picture spans two columns and needs the full page width."""
    with Image.open(picture) as image:
        return image.width > ONE_COLUMN


def number(value: object) -> str:
    """Return a value of a table as text, floats with four digits.

    >>> number(0.123456), number(None), number("30 deg")
    ('0.1235', '', '30 deg')
    """
    if value is None:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def write_page(page: Path, text: str, traces: Mapping[str, str]) -> None:
    """Write a page, and the tracebacks of errors in the program beside it; without errors, no log stays.

    Raises
    ------
    OSError : a file cannot be written.
    """
    log = page.with_name(f"{page.stem}-errors.log")
    if traces:
        write_atomically(log, "\n".join(f"{what}\n{trace}" for what, trace in traces.items()).encode())
    else:
        log.unlink(missing_ok=True)
    write_atomically(page, text.encode())


class ShownPicture(NamedTuple):
    """A picture as a page holds it: its name, its path in the folder, its address, its width."""

    name: str
    path: str
    address: str
    wide: bool


def shown_pictures(pictures: Mapping[str, Path], folder: Path) -> list[ShownPicture]:
    """Pictures of a folder, by name, with what a page needs of them."""
    return [
        ShownPicture(name, path.relative_to(folder).as_posix(), embedded(path), is_wide(path))
        for name, path in pictures.items()
    ]
