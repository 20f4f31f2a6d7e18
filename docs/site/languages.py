"""Which language a page of the site is written in, said in its HTML."""

from typing import Any


def of_page(place: str) -> str:
    """Language of a page by its place in the site.

    Examples
    --------
    >>> of_page("ja/getting-started"), of_page("getting-started")
    ('ja', 'en')
    """
    return "ja" if place.startswith("ja/") else "en"


def tell(_app: Any, pagename: str, _template: str, context: dict[str, Any], _doctree: Any) -> None:
    """Put the language into `<html lang>`: by it a screen reader speaks and a browser takes its glyphs."""
    context["language"] = of_page(pagename)


def setup(app: Any) -> dict[str, bool]:
    """Have Sphinx ask for the language of every page."""
    app.connect("html-page-context", tell)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
