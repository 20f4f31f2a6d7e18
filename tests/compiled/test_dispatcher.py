"""Compiled code is found again by whatever process asks for the same, and never where anything differs."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import ryusa.compiled
import ryusa.laws
from ryusa.compiled import processor, store, tiers
from ryusa.compiled.dispatcher import _Kept, _of_type
from ryusa.compiled.function import FAST, compiled
from ryusa.laws import collision

ASK = """
from ryusa.laws.collision import effective_mass as law
print(law.entry(2.0, 2.0), sum(law.entry.stats.cache_hits.values()))
"""


class Rooms:
    """A copy of the laws in a folder of its own, asked by a process of its own."""

    def __init__(self, folder: Path, cache: Path) -> None:
        self.folder, self.cache = folder, cache
        for room in (ryusa.laws, ryusa.compiled):
            place = folder / "ryusa" / room.__name__.rpartition(".")[2]
            shutil.copytree(Path(room.__path__[0]), place, ignore=shutil.ignore_patterns("__pycache__"))
        (folder / "ryusa" / "__init__.py").touch()

    def ask(self, text: str = ASK, **more: str) -> list[str]:
        around = {"PYTHONPATH": str(self.folder), "RYUSA_CACHE": str(self.cache), **more}
        done = subprocess.run(
            [sys.executable, "-c", text], check=True, capture_output=True, text=True, cwd=self.folder,
            env={**os.environ, **around},
        )  # fmt: skip
        return done.stdout.split()

    def edit(self, file: str, before: str, after: str) -> None:
        place = self.folder / "ryusa" / file
        text = place.read_text()
        assert before in text
        place.write_text(text.replace(before, after, 1))


@pytest.fixture
def rooms(tmp_path) -> Rooms:
    return Rooms(tmp_path / "first", tmp_path / "cache")


def test_a_second_process_and_a_second_clone_compile_nothing(rooms, tmp_path):
    assert rooms.ask() == ["1.0", "0"]
    assert rooms.ask() == ["1.0", "1"]
    assert Rooms(tmp_path / "second", rooms.cache).ask() == ["1.0", "1"]
    moved = rooms.folder.rename(tmp_path / "moved")
    rooms.folder = moved
    for file in moved.rglob("*.py"):
        os.utime(file, (1.0e9, 1.0e9))
    assert rooms.ask() == ["1.0", "1"]


def test_a_law_that_calls_a_changed_law_in_another_file_is_compiled_anew(rooms):
    assert rooms.ask() == ["1.0", "0"]
    rooms.edit("laws/reduced.py", "    return small /", "    return 10.0 * small /")
    assert rooms.ask() == ["10.0", "0"]
    rooms.edit("laws/reduced.py", "    return 10.0 * small /", "    return small /")
    assert rooms.ask() == ["1.0", "1"]  # what was compiled before is still there


def test_a_changed_constant_of_another_module_is_compiled_in(rooms):
    rooms.edit("laws/reduced.py", "    return small /", "    return other.SCALE * small /")
    rooms.edit(
        "laws/reduced.py",
        "from ryusa.laws._law import law\n",
        "from ryusa.laws import other\nfrom ryusa.laws._law import law\n",
    )
    (rooms.folder / "ryusa" / "laws" / "other.py").write_text("SCALE = 1.0\n")
    assert rooms.ask() == ["1.0", "0"]
    assert rooms.ask() == ["1.0", "1"]
    (rooms.folder / "ryusa" / "laws" / "other.py").write_text("SCALE = 3.0\n")
    assert rooms.ask() == ["3.0", "0"]


def test_an_edited_docstring_compiles_nothing(rooms):
    assert rooms.ask() == ["1.0", "0"]
    rooms.edit("laws/reduced.py", '"""', '"""Other words. ')
    rooms.edit("laws/collision.py", "@law\n", "# a remark\n\n@law\n")
    assert rooms.ask() == ["1.0", "1"]


def test_another_processor_or_numba_is_not_answered(rooms):
    assert rooms.ask() == ["1.0", "0"]
    assert rooms.ask(NUMBA_CPU_NAME="x86-64-v3", NUMBA_CPU_FEATURES="") == ["1.0", "0"]
    assert rooms.ask(NUMBA_OPT="1") == ["1.0", "0"]
    older = "import numba; numba.__version__ = '0.1'\n" + ASK
    assert rooms.ask(older) == ["1.0", "0"]
    assert rooms.ask() == ["1.0", "1"]


def test_processes_that_compile_at_once_leave_what_any_of_them_can_read(rooms):
    around = {**os.environ, "PYTHONPATH": str(rooms.folder), "RYUSA_CACHE": str(rooms.cache)}
    several = [
        subprocess.Popen([sys.executable, "-c", ASK], env=around, cwd=rooms.folder, stdout=subprocess.PIPE)
        for _ in range(4)
    ]
    for one in several:
        out, _ = one.communicate()
        assert one.returncode == 0 and out.split()[0] == b"1.0"
    assert rooms.ask() == ["1.0", "1"]
    assert not list(rooms.cache.rglob("*.part"))


def test_a_folder_that_cannot_be_written_compiles_in_every_process(rooms):
    rooms.cache.write_text("a file, not a folder")
    assert rooms.ask() == ["1.0", "0"]
    assert rooms.ask() == ["1.0", "0"]


def test_code_of_a_class_that_is_gone_is_compiled_anew(rooms):
    assert rooms.ask() == ["1.0", "0"]
    broken = "import pickle\nimport ryusa.compiled.dispatcher as d\n" + (
        "def gone(data): raise AttributeError('gone')\nd.pickle.loads = gone\n" + ASK
    )
    assert rooms.ask(broken) == ["1.0", "0"]


WHO_CALLS = """
import sys
from ryusa.compiled.function import FAST, compiled

plain = compiled()(lambda x: x * x + 1.0)
fast = compiled(fastmath=FAST, forceinline=True)(lambda x: plain(x))
(fast if sys.argv[1] == "fast" else plain)(0.1)
plain(0.1)
text = next(iter(plain.entry.inspect_llvm().values()))
print("contract" in text, any(made.fndesc.inline for made in plain.entry.overloads.values()))
"""


def test_who_calls_a_function_first_changes_neither_its_arithmetic_nor_its_inlining(tmp_path):
    """Inlining counts: a product that a caller fuses and a law holds too is made once, and not fused."""
    for first in ("fast", "plain"):
        done = subprocess.run(
            [sys.executable, "-c", WHO_CALLS, first], check=True, capture_output=True, text=True,
            env={**os.environ, "RYUSA_CACHE": str(tmp_path / first)},
        )  # fmt: skip
        assert done.stdout.split() == ["False", "False"], first
    assert collision.effective_mass.options["forceinline"]  # said by `law`


def test_functions_of_one_name_and_other_closures_are_told_apart():
    """Both are built into one kernel: under one symbol the linker would keep the first."""

    def of(k):
        def times(x):
            return k * x

        return compiled()(times)

    two, three = of(2.0), of(3.0)

    @compiled()
    def both(x):
        return two(x), three(x)

    assert both(1.0) == (2.0, 3.0)


def test_what_python_calls_and_what_kernels_call_do_not_depend_on_the_order(tmp_path, monkeypatch):
    empty = store.Store(tmp_path, processor.own())
    monkeypatch.setattr(store, "own", lambda: empty)
    monkeypatch.setattr(tiers, "in_order", lambda: (empty,))

    @compiled(fastmath=FAST)
    def inmost(x):
        return x * x + 1.0

    @compiled(fastmath=FAST)
    def outer(x):
        return inmost(x) * x + 1.0

    for first in (inmost, outer):
        assert first(0.3) == pytest.approx({"inmost": 1.09, "outer": 1.327}[first.__name__])
    made = list(inmost.inner.overloads.values())
    assert len(made) == 1 and made[0].library.get_pointer_to_function("anything") == 0
    assert "@_ZN7cpython" not in str(made[0].library._get_module_for_linking())


def test_the_key_covers_types_and_what_they_are_made_of():
    import numba
    import numpy as np

    law = _Kept(collision.effective_mass, "entry")
    here = processor.own()
    one, other = (numba.types.float64,) * 2, (numba.types.float64, numba.types.int64)
    assert law.key(one, here) != law.key(other, here)
    assert law.key(one, here) != _Kept(collision.effective_mass, "inner").key(one, here)
    rows, read_only = np.ones((2, 2)), np.ones((2, 2))
    read_only.flags.writeable = False
    assert _of_type(numba.typeof(rows)) != _of_type(numba.typeof(read_only))
    assert _of_type(numba.typeof(rows)) != _of_type(numba.typeof(rows.T))


def test_numba_is_as_before_after_compiling():
    import llvmlite.binding as llvm
    from numba.core import bytecode
    from numba.core.targetconfig import TargetConfig

    from ryusa.compiled.numba_parts import compiling

    def parts():
        return (
            TargetConfig.__eq__, TargetConfig.__hash__, list(llvm.ffi.lib._lock._cblist),
            bytecode.FunctionIdentity.from_function.__func__,
        )  # fmt: skip

    before = parts()
    with pytest.raises(ZeroDivisionError), compiling():
        with compiling():
            assert parts()[:2] != before[:2] and parts()[2] == []
        assert parts()[2] == []
        raise ZeroDivisionError
    assert parts() == before
