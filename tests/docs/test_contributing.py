"""CONTRIBUTING.md is true: the files that it names exist, and its steps work in a copy of the source."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import ryusa
from ryusa.casefile.read import read
from ryusa.laws.families import Drag
from ryusa.results import Results

pytestmark = pytest.mark.full

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
STEPS = re.findall(r"```\w+ title=(\S+)\n(.*?)```", PAGE, re.DOTALL)  # file, text
LAW, FAMILIES, UNITS, MEASURE, ENTRY, FIGURE, PICTURE, REGISTRY = STEPS


def test_every_file_and_folder_that_the_page_names_exists() -> None:
    named = set(re.findall(r"`((?:src|tests|design|docs|benchmarks|changelog)/[\w./-]*)`", PAGE)) - {
        MEASURE[0],
        FIGURE[0],
    }
    rooms = {f"src/ryusa/{name}" for name in re.findall(r"^\| `(\w+(?:/|\.py))`", PAGE, re.MULTILINE)}
    assert len(named) > 10 and len(rooms) > 8
    assert not [name for name in sorted(named | rooms) if not (ROOT / name).exists()]


def test_every_room_of_the_package_is_on_the_map() -> None:
    rooms = {one.name for one in (ROOT / "src" / "ryusa").iterdir() if (one / "__init__.py").is_file()}
    on_the_map = PAGE.split("## Map of the rooms")[1].split("## To add X")[0]
    assert not [room for room in sorted(rooms - {"cases"}) if f"`{room}/`" not in on_the_map]


def test_every_make_target_that_the_page_names_exists() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in set(re.findall(r"`make ([a-z]+)`", PAGE)):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target


def test_a_law_takes_two_files_and_its_units_a_measure_two_a_picture_two_an_engine_one_line() -> None:
    assert [file for file, _ in STEPS] == [
        "src/ryusa/laws/drag.py",
        "src/ryusa/laws/families.py",
        "tests/laws/test_units_of_laws.py",
        "src/ryusa/measure/reach.py",
        "src/ryusa/catalogue.py",
        "src/ryusa/figures/reach.py",
        "src/ryusa/catalogue.py",
        "src/ryusa/engine/registry.py",
    ]
    lines = (FAMILIES, UNITS, ENTRY, PICTURE, REGISTRY)
    assert all(len(text.strip().splitlines()) == 1 for _, text in lines)
    assert PICTURE[1].count("picture_of(") == 1


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The source with all steps of the page carried out."""
    root = tmp_path_factory.mktemp("contributor")
    shutil.copytree(ROOT / "src", root / "src", ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    append(root / LAW[0], LAW[1])
    insert(root / FAMILIES[0], r"from ryusa\.laws\.drag import \(\n", "    c_d_abraham,\n")
    insert(root / FAMILIES[0], r"class Drag\(.*?(?=\n\n\nclass )", "\n" + numbered(FAMILIES[1].rstrip()))
    for file, text in (MEASURE, FIGURE):
        (root / file).write_text(text, encoding="utf-8")
    insert(root / ENTRY[0], r"^MEASURES = \(\n", ENTRY[1])
    insert(root / PICTURE[0], r"^PICTURES = \(\n", PICTURE[1])
    append(root / REGISTRY[0], REGISTRY[1])
    return root


def numbered(line: str) -> str:
    """The line of a law with the next number of its family, whichever the page was written with."""
    found, changed = re.subn(r"\(\d+,", f"({max(Drag) + 1},", line, count=1)
    assert changed == 1, line
    return found


def append(file: Path, text: str) -> None:
    file.write_text(file.read_text(encoding="utf-8").rstrip() + "\n\n\n" + text, encoding="utf-8")


def insert(file: Path, after: str, text: str) -> None:
    source = file.read_text(encoding="utf-8")
    found = re.search(after, source, re.DOTALL | re.MULTILINE)
    assert found, f"{file.name} has no {after}"
    file.write_text(source[: found.end()] + text + source[found.end() :], encoding="utf-8")


def ryusa_of(copy: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return python_of(copy, "-m", "ryusa", *words)


def python_of(copy: Path, *words: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(copy / "src"), "COLUMNS": "200"}
    return subprocess.run(
        [sys.executable, *words], cwd=copy, env=environment, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def case(copy: Path) -> Path:
    path = copy / "saltation.toml"
    done = ryusa_of(copy, "new", "saltation", str(path))
    assert done.returncode == 0, done.stderr
    return path


def test_the_new_drag_law_is_a_word_of_the_case_file(copy: Path, case: Path) -> None:
    refused = subprocess.run(
        [sys.executable, "-m", "ryusa", "check", str(case), "--set", "water.drag=Abraham"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert refused.returncode == 2 and "Abraham" in refused.stderr + refused.stdout
    done = ryusa_of(copy, "check", str(case), "--set", "water.drag=Abraham")
    assert done.returncode == 0, done.stderr
    assert "drag Abraham" in done.stdout


def test_the_doctest_of_the_new_law_passes(copy: Path) -> None:
    finding = "import doctest, ryusa.laws.drag as m; print(doctest.run_docstring_examples"
    done = python_of(copy, "-c", f"{finding}(m.c_d_abraham.py_func, vars(m), name='law'))")
    assert done.returncode == 0 and done.stdout == "None\n", done.stdout + done.stderr


@pytest.fixture(scope="module")
def run(copy: Path, case: Path) -> Results:
    """A short run of two grains."""
    short = {"stop.time": "0.02 s", "record.settle": "0 s", "build.starts": "2"}
    return ryusa.run(read(case, short), copy / "runs" / "short", progress=False)


def test_the_new_measure_is_printed_and_written(copy: Path, run: Results) -> None:
    done = ryusa_of(copy, "measure", str(run.folder), "reach", "--csv", str(copy / "reach.csv"))
    assert done.returncode == 0, done.stderr
    head, row = (copy / "reach.csv").read_text(encoding="utf-8").splitlines()
    way = abs(run.frames.x[-1][:, 0] - run.frames.x[0][:, 0])
    assert head == "grain,distance" and float(row.split(",")[1]) == pytest.approx(way.max())


def test_the_units_of_the_new_law_are_written_as_those_of_its_neighbours() -> None:
    table = (ROOT / UNITS[0]).read_text(encoding="utf-8").split("UNITS = {")[1]
    name = re.findall(r"def (\w+)", LAW[1])[0]
    assert UNITS[1].replace(name, "c_d_re_04") in table


def test_the_new_picture_is_drawn_with_the_rows_of_its_measure(copy: Path, run: Results) -> None:
    done = ryusa_of(copy, "draw", str(run.folder), "reach", "-o", str(copy / "reach.svg"))
    assert done.returncode == 0, done.stderr
    assert "distance along the bed" in (copy / "reach.svg").read_text(encoding="utf-8")
    assert (copy / "reach.csv").read_text(encoding="utf-8").startswith("grain,distance")


def test_the_new_engine_is_known_by_name(copy: Path, case: Path) -> None:
    done = ryusa_of(copy, "doctor")
    assert "mirror" in done.stdout, done.stdout + done.stderr
    done = ryusa_of(copy, "run", str(case), "--engine", "miror")
    assert done.returncode == 2 and "mirror" in done.stderr


@pytest.mark.slow
def test_a_run_with_the_new_law_and_the_new_engine(copy: Path, case: Path) -> None:
    words = ["--set", "water.drag=Abraham", "--set", "stop.time=0.01 s", "--set", "record.settle=0 s"]
    done = ryusa_of(copy, "run", str(case), *words, "--engine", "mirror", "-o", str(copy / "runs" / "new"))
    assert done.returncode == 0, done.stderr
    assert ryusa_of(copy, "inspect", str(copy / "runs" / "new")).returncode == 0
