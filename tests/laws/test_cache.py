"""Compiled laws are kept on disk, but never an old one."""

import os
import pickle
import shutil
import subprocess
import sys
from pathlib import Path

import numba
from numba.core.caching import IndexDataCacheFile

import ryusa.laws
from ryusa.laws import collision, dispatch
from ryusa.laws._law import EDITION

ASK = """
from ryusa.laws.collision import effective_mass as law
print(law(2.0, 2.0), sum(law.stats.cache_hits.values()))
"""


def test_a_law_that_calls_a_changed_law_in_another_file_is_compiled_anew(tmp_path):
    room = tmp_path / "ryusa" / "laws"
    shutil.copytree(Path(ryusa.laws.__path__[0]), room, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "ryusa" / "__init__.py").touch()
    surroundings = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | {
        "PYTHONPATH": str(tmp_path)
    }

    def ask():
        done = subprocess.run(
            [sys.executable, "-c", ASK],
            check=True,
            capture_output=True,
            text=True,
            cwd=tmp_path,
            env=surroundings,
        )
        return done.stdout.split()

    assert ask() == ["1.0", "0"]
    assert ask() == ["1.0", "1"]  # from disk
    inner = room / "reduced.py"
    inner.write_text(inner.read_text().replace("    return small /", "    return 10.0 * small /"))
    assert ask() == ["10.0", "0"]


def test_the_cache_of_another_edition_is_not_read(tmp_path):
    dispatcher = collision.effective_mass
    dispatcher.compile("float64(float64, float64)")
    kept = dispatcher._cache._cache_file
    assert EDITION in kept._version
    assert kept._load_index()
    other = IndexDataCacheFile(str(tmp_path), "law", kept._source_stamp)
    (tmp_path / "law.nbi").write_bytes(
        pickle.dumps(f"{numba.__version__} older") + b"of modules that are gone"
    )
    other._version = kept._version
    assert other._load_index() == {}


def test_code_of_another_key_is_not_given_out(tmp_path):
    """Two processes that compile for different types at the same time write to the same file."""
    kept = collision.effective_mass._cache._cache_file
    first, second = (type(kept)(_Place(tmp_path), "law", EDITION) for _ in range(2))
    seen = second._load_index()
    first.save("of one type", 1)
    assert first.load("of one type") == 1
    second._load_index = lambda: dict(seen)  # what the second process read before the first one wrote
    second.save("of another type", 2)
    del second._load_index
    assert second.load("of another type") == 2
    first._save_data(first._data_name(1), (first._version, "of one type", 1))
    assert second.load("of another type") is None


class _Place:
    """Where a cache of another process is: as much of it as a cache file asks for."""

    def __init__(self, folder):
        self._cache_path, self._source_stamp, self._version = str(folder), "stamp", numba.__version__


WHO_CALLS = """
import sys
from ryusa.laws._law import FAST, compiled

plain = compiled(None)(lambda x: x * x + 1.0)
fast = compiled(None, fastmath=FAST, forceinline=True)(lambda x: plain(x))
(fast if sys.argv[1] == "fast" else plain)(0.1)
plain(0.1)
text = next(iter(plain.inspect_llvm().values()))
print("contract" in text, any(made.fndesc.inline for made in plain.overloads.values()))
"""


def test_who_calls_a_function_first_changes_neither_its_arithmetic_nor_its_inlining():
    """Inlining counts: a product that a caller fuses and a law holds too is made once, and not fused."""
    for first in ("fast", "plain"):
        done = subprocess.run(
            [sys.executable, "-c", WHO_CALLS, first], check=True, capture_output=True, text=True
        )
        assert done.stdout.split() == ["False", "False"], first
    assert collision.effective_mass.targetoptions["forceinline"]  # said by `law`


def _closures(function, found):
    """Every compiled function that a dispatcher holds in its closure, itself included."""
    text = getattr(function, "py_func", None)
    if text is None or id(function) in found:
        return
    found[id(function)] = function
    for cell in text.__closure__ or ():
        _closures(cell.cell_contents, found)


def test_functions_of_different_closures_have_names_of_their_own():
    """Else a cached caller may bring one along under the symbol of another, which the linker then keeps."""
    found = {}
    for one in vars(dispatch).values():
        _closures(one, found)
    assert len(found) > 60
    held = {}
    for function in found.values():
        text = function.py_func
        inside = [cell.cell_contents for cell in text.__closure__ or ()]
        meaning = [one.py_func.__qualname__ if hasattr(one, "py_func") else repr(one) for one in inside]
        name = (text.__module__, text.__qualname__)
        assert held.setdefault(name, meaning) == meaning, name
