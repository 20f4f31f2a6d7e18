"""Pages of the API reference: one for each public module, found by walking the package."""

import ast
import importlib
import pkgutil
from pathlib import Path
from types import ModuleType

from docstrings import escaped

import ryusa


def modules() -> list[str]:
    """Dotted names of all public modules, in order."""
    found = ["ryusa"]
    for one in pkgutil.walk_packages(ryusa.__path__, "ryusa."):
        if not any(part.startswith("_") for part in one.name.split(".")):
            found.append(one.name)
    return sorted(found)


def undocumented() -> list[str]:
    """Public modules, functions, classes and methods without a docstring."""
    silent: list[str] = []
    for name in modules():
        source = Path(importlib.util.find_spec(name).origin)
        tree = ast.parse(source.read_text(encoding="utf-8"))
        if not ast.get_docstring(tree):
            silent.append(name)
        silent += [f"{name}.{one}" for one in _silent(tree.body, "")]
    return silent


def _silent(body: list[ast.stmt], before: str) -> list[str]:
    found: list[str] = []
    for node in body:
        if not isinstance(node, ast.FunctionDef | ast.ClassDef) or node.name.startswith("_"):
            continue
        if not ast.get_docstring(node):
            found.append(before + node.name)
        if isinstance(node, ast.ClassDef):
            found += _silent(node.body, f"{node.name}.")
    return found


def write_pages(folder: Path) -> list[Path]:
    """Write a page for each module into a folder; return what was written."""
    names = modules()
    pages: list[Path] = []
    for name in names:
        page = folder / f"{name}.rst"
        inner = [one for one in names if one.rpartition(".")[0] == name]
        page.write_text(_page(name, inner), encoding="utf-8")
        pages.append(page)
    return pages


def _page(name: str, inner: list[str]) -> str:
    module = importlib.import_module(name)
    title = name
    lines = [title, "=" * len(title), ""]
    if not inner and not hasattr(module, "__path__"):
        lines += [
            f".. automodule:: {name}",
            "   :members:",
            "   :exclude-members: model_config, model_post_init",
        ]
        return "\n".join([*lines, ""])
    lines += [f".. automodule:: {name}", "   :no-members:", ""]
    lines += _exports(name, module)
    if inner:
        lines += [
            ".. toctree::",
            "   :maxdepth: 1",
            "",
            *(f"   {one.rpartition('.')[2]} <{one}>" for one in inner),
        ]
    return "\n".join([*lines, ""])


def _exports(name: str, module: ModuleType) -> list[str]:
    """Names a package offers itself: those it takes from its modules as links, its own in full."""
    tree = ast.parse(Path(module.__file__ or "").read_text(encoding="utf-8"))
    own = [
        n.name
        for n in tree.body
        if isinstance(n, ast.FunctionDef | ast.ClassDef) and not n.name.startswith("_")
    ]
    lines: list[str] = []
    taken: list[str] = []
    for one in getattr(module, "__all__", []):
        thing = getattr(module, one)
        if isinstance(thing, ModuleType) or one in own or not callable(thing):
            continue
        home = getattr(thing, "__module__", "")
        if any(part.startswith("_") for part in home.split(".")):
            own.append(one)
        elif home.startswith("ryusa"):
            first = " ".join((thing.__doc__ or "").split("\n\n")[0].split())
            taken.append(f"* :py:obj:`{one} <{home}.{thing.__qualname__}>`: {escaped([first])[0]}")
    if taken:
        lines += [".. rubric:: Names offered here", "", *sorted(taken), ""]
    for one in own:
        kind = "autoclass" if isinstance(getattr(module, one), type) else "autofunction"
        lines += [f".. {kind}:: {name}.{one}", *(["   :members:"] if kind == "autoclass" else []), ""]
    return lines
