"""No module imports, directly or through others, a module that imports it: nothing goes in a circle."""

import ast
from collections.abc import Iterator
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src" / "ryusa"


def modules(root: Path) -> dict[str, Path]:
    """Dotted name of every module below a package."""
    found: dict[str, Path] = {}
    for path in root.rglob("*.py"):
        parts = path.relative_to(root.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def statements(node: ast.AST) -> Iterator[ast.Import | ast.ImportFrom]:
    """Imports that run at some time, those inside functions too; not those for type checkers alone."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test):
            for other in child.orelse:
                yield from statements(other)
            continue
        if isinstance(child, ast.Import | ast.ImportFrom):
            yield child
        yield from statements(child)


def imports(root: Path) -> dict[str, set[str]]:
    """Modules of a package that each of its modules imports when it runs."""
    known = modules(root)
    graph: dict[str, set[str]] = {}
    for name, path in known.items():
        found: set[str] = set()
        for one in statements(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(one, ast.Import):
                found |= {alias.name for alias in one.names}
            else:
                assert one.level == 0, f"{path} imports relatively"
                inner = {f"{one.module}.{alias.name}" for alias in one.names}
                found |= {each if each in known else str(one.module) for each in inner}
        graph[name] = (found & set(known)) - {name}
    return graph


def circles(graph: dict[str, set[str]]) -> list[str]:
    """Modules left once those that import nothing left are taken away, again and again."""
    left = {name: set(needs) for name, needs in graph.items()}
    while ready := {name for name, needs in left.items() if not needs & set(left)}:
        left = {name: needs for name, needs in left.items() if name not in ready}
    return sorted(left)


def test_no_module_of_the_package_imports_itself_through_others() -> None:
    graph = imports(SOURCE)
    assert len(graph) > 150
    assert "ryusa.casefile.derive" in graph["ryusa.running.runner"] | graph["ryusa.casefile"]
    assert circles(graph) == []
    assert circles(imports(SOURCE.parents[1] / "studies" / "ryusa_studies")) == []


def test_a_circle_is_found_also_where_an_import_hides_in_a_function(tmp_path: Path) -> None:
    package = tmp_path / "toy"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "low.py").write_text("def f():\n    from toy.high import g\n    return g\n")
    (package / "high.py").write_text("from toy import low\n\ng = low.f\n")
    assert circles(imports(package)) == ["toy.high", "toy.low"]
    only_types = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from toy.high import g\n"
    (package / "low.py").write_text(only_types)
    assert circles(imports(package)) == []
