"""Lists of what the package holds: every law, every packaged case, every question that a case answers."""

import ast
import importlib
import re
from importlib import resources
from pathlib import Path
from typing import Any

import api


def choices_page() -> str:
    """Every choice of physics that a case can name, from the table of `ryusa.laws.families`."""
    from ryusa.laws.families import FAMILIES

    lines = [
        "# Choices of physics",
        "",
        "Every word that a case file can use to choose a law, with what it stands for, its source and the "
        "keys that only this choice takes. The tables follow from `ryusa.laws.families`.",
    ]
    for family in FAMILIES:
        about = " ".join((family.__doc__ or "").split()).partition(" Marks:")[0]
        lines += ["", f"## {family.key}", "", about, ""]
        lines += ["| word | what it gives | source | keys | law |", "|---|---|---|---|---|"]
        for choice in family:
            if choice.word:
                keys = ", ".join(f"`{key}`" for key in choice.takes)
                cells = [
                    f'`"{choice.word}"`',
                    _plain(choice.about),
                    _plain(choice.source),
                    keys,
                    _law(choice),
                ]
                lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def _law(choice: Any) -> str:
    if choice.function is None:
        return ""
    function = getattr(choice.function, "py_func", choice.function)
    return f"{{py:func}}`{function.__name__} <{function.__module__}.{function.__name__}>`"


def laws_page() -> str:
    """Every law with its one-line description and its source, by module."""
    lines = [
        "# All laws",
        "",
        "Every function of `ryusa.laws` that carries the decorator `@law`: scalars in, scalars out, SI "
        "units, compiled for the CPU and for CUDA from the same text. The name leads to the full docstring "
        "with parameters, source and a worked number; [Theory](theory.md) says how the laws belong together.",
    ]
    for name in api.modules():
        if not name.startswith("ryusa.laws."):
            continue
        module = importlib.import_module(name)
        tree = ast.parse(Path(module.__file__ or "").read_text(encoding="utf-8"))
        laws = [node for node in tree.body if isinstance(node, ast.FunctionDef) and _is_law(node)]
        if not laws:
            continue
        about = (ast.get_docstring(tree) or "").split("\n\n")[0].replace("\n", " ")
        lines += [
            "",
            f"## {name.removeprefix('ryusa.')}",
            "",
            about,
            "",
            "| law | what it gives | source |",
            "|---|---|---|",
        ]
        for node in laws:
            text = ast.get_docstring(node) or ""
            first = " ".join(text.split("\n\n")[0].split())
            link = f"{{py:func}}`{node.name} <{name}.{node.name}>`"
            lines.append(f"| {link} | {_plain(first)} | {_plain(_source(text))} |")
    return "\n".join([*lines, ""])


def _is_law(node: ast.FunctionDef) -> bool:
    return not node.name.startswith("_") and any(
        isinstance(d, ast.Name) and d.id == "law" for d in node.decorator_list
    )


def _source(text: str) -> str:
    found = re.search(r"Source: (.*?)(?:;|(?<!Eq)(?<!Eqs)(?<! al)\.)(?:\s|$)", text, flags=re.DOTALL)
    return " ".join(found[1].split()) if found else ""


def _plain(text: str) -> str:
    return re.sub(r"([|*_])", r"\\\1", text) if "`" not in text else text.replace("|", "\\|")


def cases_page() -> str:
    """Every packaged case in full, with the command that writes it."""
    lines = [
        "# Packaged cases",
        "",
        "`ryusa new KIND` writes one of these files, commented, as a start for a case of your own.",
    ]
    folder = resources.files("ryusa") / "cases"
    for entry in sorted(folder.iterdir(), key=lambda one: one.name):
        if entry.name.endswith(".toml"):
            kind = entry.name.removesuffix(".toml")
            lines += ["", f"## {kind}", "", "```sh", f"ryusa new {kind}", "```", "", "```toml"]
            lines += [entry.read_text(encoding="utf-8").rstrip(), "```"]
    return "\n".join([*lines, ""])


def questions() -> str:
    """Rows of the front page: what a user asks, what to type first, what comes out."""
    from ryusa.cases.questions import QUESTIONS

    lines = []
    for one in QUESTIONS:
        first = f"ryusa new {one.cases[0]}" if one.cases else next(iter(one.commands), "")
        typed = f"`{first}`" if first else ""
        lines.append(f"| [{one.asked}]({one.page}) | {typed} | {one.answer} |")
    return "\n".join(lines)
