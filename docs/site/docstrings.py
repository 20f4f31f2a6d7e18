"""Docstrings of ryusa as numpydoc reads them, with the comments beside fields as their description.

A parameter stands in a docstring as ``name : what it is [unit]``, because its type is in the signature.
numpydoc would take the text behind the colon for a type; here it becomes the description.
"""

import ast
import importlib
import inspect
import re
import textwrap
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any

ENTRIES = {"Parameters", "Attributes", "Returns", "Yields", "Raises", "Other Parameters"}
ENTRY = re.compile(r"^(\*{0,2}[\w.]+(?:, \*{0,2}[\w.]+)*) : (.*)$")


def described(lines: list[str]) -> list[str]:
    """Docstring whose ``name : text`` entries are a name, then an indented description.

    >>> text = "Parameters|----------|d : diameter [m],|    of a sphere.||Notes|-----|a : b"
    >>> described(text.split("|"))
    ['Parameters', '----------', 'd', '    diameter [m], of a sphere.', '', 'Notes', '-----', 'a : b']
    >>> described(["Returns", "-------", "d : diameter [m].", "", ">>> 1 + 1", "2"])[3:]
    ['    diameter [m].', '', 'Examples', '--------', '>>> 1 + 1', '2']
    """
    found: list[str] = []
    inside = False
    for k, line in enumerate(lines):
        if k + 1 < len(lines) and re.fullmatch(r"-{3,}", lines[k + 1].strip()):
            inside = line.strip() in ENTRIES
        if inside and line.startswith(">>>"):  # an example without a heading ends the section
            inside = False
            found += ["Examples", "--------"]
        entry = ENTRY.match(line) if inside else None
        if entry:
            found += [entry[1], "    " + entry[2]]
        elif inside and line.strip() and found and found[-1].startswith("    "):
            found[-1] += " " + line.strip()
        else:
            found.append(line)
    return found


def escaped(lines: list[str]) -> list[str]:
    r"""Docstring as plain text: no markup but code between backticks, doctests and headings.

    A table drawn with bars becomes a block of literal text.

    >>> escaped(["eta |v| and k_ `|v|`", ">>> a**2", "", "| a | b |", "|---|---|"])
    ['eta \\|v\\| and k\\_ `|v|`', '>>> a**2', '', '', '::', '', '    | a | b |', '    |---|---|']
    """
    found: list[str] = []
    doctest = False
    for line in lines:
        doctest = line.lstrip().startswith(">>>") or (doctest and bool(line.strip()))
        if doctest or re.fullmatch(r"\s*-{3,}", line):
            found.append(line)
        elif line.startswith("|"):
            if not (found and found[-1].startswith("    |")):
                found += ["", "::", ""]
            found.append("    " + line)
        else:
            parts = re.split(r"(``[^`]*``|`[^`]*`)", line)
            found.append("".join(part if part.startswith("`") else _plain(part) for part in parts))
    return found


def _plain(text: str) -> str:
    return re.sub(r"([|*\\]|(?<=\w)_(?!\w))", r"\\\1", text)


@cache
def _classes(file: str) -> tuple[list[ast.ClassDef], list[str]]:
    """Classes of a file, and its lines."""
    text = Path(file).read_text(encoding="utf-8")
    return [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ClassDef)], text.splitlines()


def comments_of(kind: type) -> dict[str, str]:
    """Comment beside each field of a dataclass or member of an enum, as its source has it."""
    try:
        classes, lines = _classes(inspect.getsourcefile(kind) or "")
    except (OSError, TypeError):
        return {}
    found: dict[str, str] = {}
    for node in classes:
        if node.name != kind.__name__:
            continue
        for field in node.body:
            name = _field_name(field)
            if name is None or name.startswith("_"):
                continue
            # The comment may lie behind the field, or stand alone on lines below it.
            tail = lines[field.end_lineno - 1][field.end_col_offset :].strip()
            found[name] = tail.removeprefix("#").strip() if tail.startswith("#") else ""
    return found


def _field_name(node: ast.stmt) -> str | None:
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        return node.target.id
    if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
        return node.targets[0].id
    return None


def fields_of(kind: type) -> dict[str, str]:
    """Description of each field: of a pydantic model from its schema, else from the comments."""
    models: dict[str, Any] = getattr(kind, "__pydantic_fields__", {})
    if models:
        return {name: field.description or "" for name, field in models.items()}
    fields = comments_of(kind)
    return (
        fields
        if issubclass(kind, Enum) or hasattr(kind, "__dataclass_fields__") or any(fields.values())
        else {}
    )


def rewrite(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Make a docstring one that numpydoc reads; runs before numpydoc does."""
    lines[:] = described(escaped(lines))
    if what in {"class", "exception"} and isinstance(obj, type) and "Attributes" not in lines:
        fields = fields_of(obj)
        if fields:
            lines += ["", "Attributes", "----------"]
            for field, text in fields.items():
                lines += [
                    field,
                    *textwrap.wrap(
                        _plain(text) if text and "`" not in text else text or "..",
                        100,
                        initial_indent="    ",
                        subsequent_indent="    ",
                    ),
                ]


def signature(app: Any, what: str, name: str, obj: Any, options: Any, args: str, returned: str) -> Any:
    """Leave out the signature of a pydantic model or an enum: their fields are in the table below it."""
    if what == "class" and isinstance(obj, type) and (hasattr(obj, "model_fields") or issubclass(obj, Enum)):
        return "", None
    return None


def without_page(app: Any, env: Any, node: Any, text: Any) -> Any:
    """Show a name that exists but has no entry (an alias, a private class) without a link."""
    module, _, name = node.get("reftarget", "").rpartition(".")
    if node.get("refdomain") != "py" or not module.startswith("ryusa"):
        return None
    try:
        return text if hasattr(importlib.import_module(module), name) else None
    except ImportError:
        return None


def setup(app: Any) -> None:
    """Connect to Sphinx, ahead of numpydoc (whose priority is 500)."""
    from jinja2 import FileSystemLoader
    from jinja2.sandbox import SandboxedEnvironment
    from numpydoc import docscrape_sphinx

    # numpydoc compiles its one template anew for each docstring; here it is compiled once
    folder = Path(docscrape_sphinx.__file__).parent / "templates"
    templates = SandboxedEnvironment(loader=FileSystemLoader(folder))
    docscrape_sphinx.SandboxedEnvironment = lambda loader: templates
    app.connect("autodoc-process-docstring", rewrite, priority=100)
    app.connect("autodoc-process-signature", signature)
    app.connect("missing-reference", without_page)
