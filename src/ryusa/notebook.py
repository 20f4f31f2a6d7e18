"""Tables as HTML, which notebooks show for an object that offers `_repr_html_`."""

import html
from collections.abc import Sequence


def html_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table of texts as HTML, every text escaped.

    >>> html_table(("a",), [("1 < 2",)]).count("&lt;")
    1
    """

    def row(kind: str, cells: Sequence[str]) -> str:
        made = "".join(f'<{kind} style="text-align: left">{html.escape(one)}</{kind}>' for one in cells)
        return f"<tr>{made}</tr>"

    head = row("th", heads) if heads else ""
    return f"<table>{head}{''.join(row('td', one) for one in rows)}</table>"
