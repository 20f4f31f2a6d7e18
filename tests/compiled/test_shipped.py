"""Compiled code that comes as a package is used where all fits; else code is compiled, and why is told."""

import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import ryusa
import ryusa.laws
from ryusa.compiled import processor, shipped, store
from ryusa.compiled.processor import Processor
from ryusa.compiled.shipped import MANIFEST, STORE, SWITCH, Manifest, opened

KEY = "ab" * 32
ABOUT = {"name": "a.b", "kind": "entry", "seconds": 1.0, "processor": "any"}


def fitting(**changed: object) -> Manifest:
    """A manifest that fits this process but for what is named."""
    own = processor.own()
    name = "x86-64-v3" if own.triple.startswith("x86_64") else own.name
    made = Manifest(
        ryusa=ryusa.__version__, source=shipped.source_digest(), versions=processor.versions(),
        processor=(own.triple, name, "" if name == "x86-64-v3" else own.features), cases=("drop",), files=1,
    )  # fmt: skip
    return replace(made, **changed)


def package(folder: Path, manifest: Manifest) -> Path:
    """A package of one file."""
    folder.mkdir()
    manifest.write(folder / MANIFEST)
    store.Store(folder / STORE, Processor(*manifest.processor)).save(KEY, ABOUT, b"code")
    return folder


@pytest.fixture(autouse=True)
def _not_told_otherwise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(SWITCH, raising=False)
    has = shipped.FEATURES["x86-64-v3"] | shipped._written_out(processor.own())
    monkeypatch.setattr(shipped, "_own_features", lambda: has)


def test_code_that_fits_is_read_and_never_written(tmp_path):
    found = opened(package(tmp_path / "it", fitting()))
    assert found.store is not None and found.store.load(KEY) == b"code" and not found.store.writable
    assert found.store.processor.key == fitting().processor
    assert found.finding.startswith("1 for ") and "other source" not in found.finding


def test_a_manifest_is_read_as_it_was_written(tmp_path):
    fitting().write(tmp_path / "one")
    assert Manifest.read(tmp_path / "one") == fitting()


OTHER = processor.versions()


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"ryusa": "0.0.1"}, "made for ryusa 0.0.1, this is"),
        ({"versions": (*OTHER[:2], "numba 0.1", *OTHER[3:])}, "made with numba 0.1, here numba 0"),
        ({"versions": OTHER[:-1]}, "here svml"),
        ({"processor": ("sparc-sun-solaris", "x86-64-v3", "")}, "made for sparc-sun-solaris"),
        ({"processor": (processor.own().triple, "z15", "+vector")}, "lacks vector"),
        ({"processor": (processor.own().triple, "z15", "")}, "lacks its name"),
    ],
)
def test_what_does_not_fit_is_not_used_and_the_reason_is_told(tmp_path, changed, why):
    found = opened(package(tmp_path / "it", fitting(**changed)))
    assert found.store is None and why in found.finding


def test_a_processor_without_a_needed_feature_compiles_for_itself(tmp_path, monkeypatch):
    monkeypatch.setattr(shipped, "_own_features", lambda: shipped.FEATURES["x86-64-v3"] - {"avx2", "movbe"})
    made = (processor.own().triple, "x86-64-v3", "")
    found = opened(package(tmp_path / "it", fitting(processor=made)))
    assert found.store is None and "lacks avx2 movbe" in found.finding


def test_a_machine_that_asks_for_code_of_its_own_gets_it(tmp_path, monkeypatch):
    monkeypatch.setenv(SWITCH, "native")
    found = opened(package(tmp_path / "it", fitting()))
    assert found.store is None and "RYUSA_KERNELS=native" in found.finding


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "{}", "null", "[1, 2]", '{"processor": 1}', '{"processor": ["a"]}', "\xff"]
)
def test_a_damaged_manifest_is_told_and_nothing_is_used(tmp_path, text):
    folder = package(tmp_path / "it", fitting())
    (folder / MANIFEST).write_text(text, encoding="latin-1")
    found = opened(folder)
    assert found.store is None and "cannot be read" in found.finding


@pytest.mark.parametrize("field", ["ryusa", "source", "versions", "processor", "cases", "files"])
@pytest.mark.parametrize("value", [None, [], {}, 1e999, "x"])
def test_a_field_of_another_kind_never_ends_in_a_traceback(tmp_path, field, value):
    folder = package(tmp_path / "it", fitting())
    told = json.loads((folder / MANIFEST).read_text())
    (folder / MANIFEST).write_text(json.dumps({**told, field: value}))
    assert isinstance(opened(folder).finding, str)
    del told[field]
    (folder / MANIFEST).write_text(json.dumps(told))
    assert opened(folder).store is None


def test_files_that_are_gone_or_foreign_or_cut_are_not_read(tmp_path):
    folder = package(tmp_path / "it", fitting(files=2))
    found = opened(folder)
    assert found.store is not None and "2 were made" in found.finding
    (file,) = (folder / STORE).rglob("*.kernel")
    file.with_name("notes.txt").write_text("mine")
    for text in (b"not a kernel", file.read_bytes()[:-1]):
        file.write_bytes(text)
        assert found.store.load(KEY) is None


def test_code_of_other_source_files_is_told(tmp_path):
    assert "made of other source files" in opened(package(tmp_path / "it", fitting(source="0"))).finding


def test_without_the_package_nothing_is_asked(monkeypatch):
    monkeypatch.setattr(shipped.importlib.util, "find_spec", lambda name: None)
    found = shipped.shipped.__wrapped__()
    assert found.store is None and "absent" in found.finding


ASK = """
import sys
from ryusa.compiled import store
from ryusa.laws.collision import effective_mass as law
print(law.entry(2.0, 2.0), sum(law.entry.stats.cache_hits.values()), len(list(store.own().listed())))
"""


class Installed:
    """A copy of the laws and a package of code beside it, asked by processes of their own."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.package = folder, folder / shipped.PACKAGE
        for room in ("laws", "compiled"):
            place = folder / "ryusa" / room
            shutil.copytree(
                Path(ryusa.__path__[0]) / room, place, ignore=shutil.ignore_patterns("__pycache__")
            )
        (folder / "ryusa" / "__init__.py").write_text("__version__ = '1'\n")
        self.package.mkdir()
        (self.package / "__init__.py").touch()

    def ask(self, cache: Path, **more: str) -> list[str]:
        return self.python(ASK, RYUSA_CACHE=str(cache), **more).split()

    def python(self, text: str, **more: str) -> str:
        around = {**os.environ, "PYTHONPATH": str(self.folder), **more}
        return subprocess.run(
            [sys.executable, "-c", text], check=True, capture_output=True, text=True, cwd=self.folder,
            env=around,
        ).stdout  # fmt: skip

    def ship(self, **named: str) -> None:
        """Compile for a kind of processor, and put it into the package."""
        assert self.ask(self.package / STORE, RYUSA_KERNELS="native", **named)[:2] == ["1.0", "0"]
        tell = (
            "from ryusa.compiled import processor, shipped\nfrom pathlib import Path\n"
            "shipped.Manifest('1', shipped.source_digest(), processor.versions(), processor.own().key, (), 1)"
            f".write(Path({str(self.package / MANIFEST)!r}))"
        )
        self.python(tell, **named)


@pytest.mark.skipif(
    not shipped.FEATURES["x86-64-v3"] <= shipped._own_features(), reason="this processor is no x86-64-v3"
)
def test_code_for_a_lesser_processor_is_taken_after_the_users_own(tmp_path):
    installed = Installed(tmp_path / "it")
    installed.ship(NUMBA_CPU_NAME="x86-64-v3", NUMBA_CPU_FEATURES="")
    assert installed.ask(tmp_path / "cache") == ["1.0", "1", "0"]  # taken, and nothing kept
    own = installed.ask(tmp_path / "cache", RYUSA_KERNELS="native")
    assert own[:2] == ["1.0", "0"] and int(own[2]) > 0
    assert installed.ask(tmp_path / "cache", RYUSA_KERNELS="native")[1] == "1"
    assert installed.ask(tmp_path / "other", NUMBA_CPU_NAME="generic", NUMBA_CPU_FEATURES="")[1] == "0"


def test_code_of_a_changed_law_is_compiled_though_the_version_is_the_same(tmp_path):
    installed = Installed(tmp_path / "it")
    installed.ship()
    assert installed.ask(tmp_path / "cache")[:2] == ["1.0", "1"]
    law = tmp_path / "it" / "ryusa" / "laws" / "reduced.py"
    law.write_text(law.read_text().replace("    return small /", "    return 10.0 * small /", 1))
    assert installed.ask(tmp_path / "cache")[:2] == ["10.0", "0"]
