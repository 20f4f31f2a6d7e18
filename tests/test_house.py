"""The house itself: walls between rooms, a light front door, short files, nothing of one machine."""

import ast
import re
import subprocess
import sys
from fnmatch import fnmatch
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "ryusa"
STUDIES = ROOT / "studies" / "ryusa_studies"
LONGEST = 420  # lines; past that a file is two files
LONGEST_FUNCTION = 80  # lines; past that a function says why it is one
REASON = "# One function: "
HEAVY = {"numba", "llvmlite", "h5py", "pint", "pydantic", "matplotlib", "scipy", "vtk", "rich", "typer"}
SLOW = {f"scipy.{part}" for part in ("fft", "linalg", "optimize", "sparse", "spatial", "special", "stats")}
MACHINE = re.compile(r"file:/|/(?:home|root|Users|work|opt|mnt|tmp)/[A-Za-z0-9_.-]")


def tracked() -> list[Path]:
    try:
        listed = subprocess.run(
            ["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
        )
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a git checkout")
    return [ROOT / name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]


def modules() -> list[Path]:
    return [*SOURCE.rglob("*.py"), *STUDIES.rglob("*.py")]


def imported_by(code: str) -> set[str]:
    """Top-level modules loaded after running `code` in a fresh interpreter."""
    show = "import sys; print(*sorted({name.partition('.')[0] for name in sys.modules}))"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{show}"], check=True, capture_output=True, text=True
    )
    return set(done.stdout.split())


def test_importing_ryusa_loads_nothing_heavy() -> None:
    assert not imported_by("import ryusa") & (HEAVY | {"numpy"})


def test_a_case_is_checked_without_what_only_runs_and_pictures_need() -> None:
    case = SOURCE / "cases" / "saltation.toml"
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "ryusa", "check", str(case)],
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    loaded = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert "ryusa.casefile.read" in loaded
    assert not loaded & {"h5py", "jinja2", "matplotlib", "PIL", "pint", "trimesh", "urllib.request"}


@pytest.mark.parametrize("room", ["build", "casefile", "measure", "campaigns.sweep", "study"])
def test_a_room_loads_no_part_of_scipy_before_it_is_used(room: str) -> None:
    code = f"import ryusa.{room}, sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert not set(done.stdout.split()) & SLOW


def test_every_public_name_of_ryusa_is_there_and_documented() -> None:
    import ryusa

    for name in getattr(ryusa, "__all__", []):
        assert getattr(ryusa, name) is not None
    assert set(getattr(ryusa, "__all__", [])) <= set(dir(ryusa))


def test_the_walls_between_rooms_hold() -> None:
    linter = Path(sys.executable).parent / "lint-imports"
    if not linter.exists():
        pytest.skip("import-linter is not installed")
    done = subprocess.run([linter, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_modules_import_each_other_in_a_circle_not_even_as_types() -> None:
    names = {
        ".".join(path.relative_to(root.parent).with_suffix("").parts).removesuffix(".__init__"): path
        for root in (SOURCE, STUDIES)
        for path in root.rglob("*.py")
    }
    imported: dict[str, set[str]] = {}
    for name, path in names.items():
        found: set[str] = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module is not None:
                parts = {f"{node.module}.{one.name}" for one in node.names}
                found |= {one if one in names else node.module for one in parts}
            elif isinstance(node, ast.Import):
                found |= {one.name for one in node.names}
        imported[name] = (found & names.keys()) - {name}
    assert sum(map(len, imported.values())) > 3000
    TopologicalSorter(imported).prepare()  # a CycleError names the circle


def test_no_file_of_the_source_is_too_long() -> None:
    long = {
        str(path.relative_to(ROOT)): count
        for path in modules()
        if (count := len(path.read_text(encoding="utf-8").splitlines())) > LONGEST
    }
    assert not long


def own_lines(node: ast.FunctionDef, lines: list[str]) -> list[str]:
    """Lines of a function, without those of functions defined in it."""
    assert node.end_lineno is not None
    inner = {
        number
        for one in ast.walk(node)
        if isinstance(one, ast.FunctionDef) and one is not node and one.end_lineno
        for number in range(one.lineno, one.end_lineno + 1)
    }
    return [lines[k - 1] for k in range(node.lineno, node.end_lineno + 1) if k not in inner]


def test_a_function_of_more_than_80_lines_says_why_it_is_one() -> None:
    checked, silent = 0, list[str]()
    for path in modules():
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)):
            if not isinstance(node, ast.FunctionDef):
                continue
            own = own_lines(node, text.splitlines())
            checked += 1
            if len(own) > LONGEST_FUNCTION and not any(line.strip().startswith(REASON) for line in own):
                silent.append(f"{path.relative_to(ROOT)}: {node.name}, {len(own)} lines")
    assert checked > 1000
    assert not silent


def test_every_module_and_public_function_says_what_it_is() -> None:
    silent: list[str] = []
    for path in modules():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if tree.body and not ast.get_docstring(tree):
            silent.append(str(path.relative_to(ROOT)))
        for node in tree.body:
            public = isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")
            if public and not ast.get_docstring(node):
                silent.append(f"{path.relative_to(ROOT)}: {node.name}")
    assert not silent


def test_no_public_class_name_has_two_meanings() -> None:
    homes: dict[str, list[str]] = {}
    for path in modules():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes.setdefault(node.name, []).append(str(path.relative_to(ROOT)))
    assert len(homes) > 100
    assert not {name: paths for name, paths in homes.items() if len(paths) > 1}


def test_no_tracked_file_names_a_path_of_one_machine() -> None:
    found: list[str] = []
    for path in tracked():
        if path == Path(__file__):
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        found += [f"{path.relative_to(ROOT)}: {hit.group()}" for hit in MACHINE.finditer(text)]
    assert not found


def test_constraints_are_exact_versions_without_addresses() -> None:
    for line in (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines():
        assert re.fullmatch(r"[A-Za-z0-9_.-]+==[0-9][A-Za-z0-9.+]*", line), line


def test_every_dependency_has_its_line_in_the_design_note() -> None:
    import tomllib

    told = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    note = (ROOT / "design" / "0002-dependencies.md").read_text(encoding="utf-8")
    groups = told["dependency-groups"]
    for need in [*told["project"]["dependencies"], *groups["test"], *groups["docs"], *groups["fuzz"]]:
        name = re.match(r"[A-Za-z0-9_-]+", need)
        assert name is not None
        assert re.search(rf"^\| [^|]*\b{re.escape(name.group())}\b", note, flags=re.MULTILINE), need


def test_no_folder_with_tests_is_passed_over(pytestconfig: pytest.Config) -> None:
    # pytest looks into no folder called "build" unless told so: tests/build was once never run
    passed_over = pytestconfig.getini("norecursedirs")
    files = [*modules(), *(ROOT / "tests").rglob("test_*.py")]
    folders = {name for file in files for name in file.relative_to(ROOT).parts[:-1]} - {"__pycache__"}
    assert {"build", "engine"} <= folders
    assert not [name for name in folders if any(fnmatch(name, one) for one in passed_over)]
