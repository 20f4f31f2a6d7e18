"""The store gives out what it was given, or nothing."""

import os
import time

import pytest

from ryusa.compiled import store as store_module
from ryusa.compiled.processor import Processor
from ryusa.compiled.store import LARGEST, UNUSED_DAYS, Store

KEY, OTHER = "ab" * 32, "cd" * 32
HERE = Processor("x86_64", "any", "")
ABOUT = {"name": "a.b", "kind": "entry", "seconds": 1.0, "processor": "any"}


@pytest.fixture
def store(tmp_path) -> Store:
    return Store(tmp_path / "kernels", HERE)


def file_of(store: Store):
    (one,) = store.listed()
    return one.file


def test_what_is_kept_is_found_by_its_key_alone(store):
    store.save(KEY, ABOUT, b"code")
    assert store.load(KEY) == b"code" and store.load(OTHER) is None
    (one,) = store.listed()
    assert one.about == {"key": KEY, **ABOUT} and store.size() == (1, one.size)
    assert store.clear() == 1 and store.size() == (0, 0) and store.load(KEY) is None


@pytest.mark.parametrize("cut", [0, 5, 20, 60, -1])
def test_a_file_that_was_cut_is_not_read(store, cut):
    store.save(KEY, ABOUT, b"code" * 100)
    file = file_of(store)
    file.write_bytes(file.read_bytes()[:cut])
    assert store.load(KEY) is None and list(store.listed()) == []
    store.save(KEY, ABOUT, b"anew")  # and is mended by the next that compiles
    assert store.load(KEY) == b"anew"


def test_a_file_with_one_bit_changed_is_not_read(store):
    store.save(KEY, ABOUT, b"code" * 100)
    file = file_of(store)
    whole = file.read_bytes()
    for place in range(0, len(whole), 7):
        changed = bytearray(whole)
        changed[place] ^= 1
        file.write_bytes(bytes(changed))
        assert store.load(KEY) is None, place


def test_a_whole_file_under_the_name_of_another_is_not_read(store):
    store.save(KEY, ABOUT, b"code")
    other = store._file(OTHER)
    other.parent.mkdir(parents=True)
    os.replace(file_of(store), other)
    assert store.load(OTHER) is None


def test_foreign_files_are_neither_read_nor_removed(store):
    store.save(KEY, ABOUT, b"code")
    foreign = file_of(store).with_name("notes.txt")
    foreign.write_text("mine")
    file_of(store).write_bytes(b"not a kernel at all")
    assert store.load(KEY) is None
    store.clear()
    assert foreign.read_text() == "mine"


def test_a_folder_that_cannot_be_made_is_told_and_nothing_is_raised(tmp_path):
    (tmp_path / "file").write_text("no folder")
    store = Store(tmp_path / "file" / "kernels", HERE)
    store.save(KEY, ABOUT, b"code")
    assert store.load(KEY) is None
    assert str(store.folder) in store.trouble


def test_a_disk_that_is_full_leaves_no_part_of_a_file(store, monkeypatch):
    def full(handle, mode):
        os.close(handle)
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(store_module.os, "fdopen", full)
    store.save(KEY, ABOUT, b"code")
    assert "No space left" in store.trouble
    assert [file for file in store.folder.rglob("*") if file.is_file()] == []


def test_a_store_that_is_only_read_is_never_written(store):
    closed = Store(store.folder, HERE, writable=False)
    closed.save(KEY, ABOUT, b"code")
    assert not store.folder.exists()


def test_what_was_not_used_for_long_is_removed(store):
    store.save(KEY, ABOUT, b"old")
    old = time.time() - (UNUSED_DAYS + 1) * 86_400.0
    os.utime(file_of(store), (old, old))
    store.save(OTHER, ABOUT, b"new")
    store.tidy()
    assert store.load(KEY) is None and store.load(OTHER) == b"new"


def test_what_is_read_counts_as_used(store):
    store.save(KEY, ABOUT, b"code")
    old = time.time() - 10 * 86_400.0
    os.utime(file_of(store), (old, old))
    store.load(KEY)
    (one,) = store.listed()
    assert one.used > old


def test_a_store_that_is_too_large_gives_up_what_was_not_used_for_longest(store, monkeypatch):
    assert LARGEST > 100 * 2**20
    store.save(KEY, ABOUT, os.urandom(1000))
    older = time.time() - 3600.0
    os.utime(file_of(store), (older, older))
    store.save(OTHER, ABOUT, os.urandom(1000))
    monkeypatch.setattr(store_module, "LARGEST", 1500)
    store.tidy()
    assert store.load(KEY) is None and store.load(OTHER) is not None


def test_a_clock_that_was_set_back_changes_nothing(store, monkeypatch):
    store.save(KEY, ABOUT, b"code")
    monkeypatch.setattr(store_module.time, "time", lambda: 0.0)
    assert store.load(KEY) == b"code"
    store.tidy()
    assert store.load(KEY) == b"code"


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"RYUSA_CACHE": "/a", "NUMBA_CACHE_DIR": "/b"}, "/a"),
        ({"NUMBA_CACHE_DIR": "/b"}, "/b/ryusa"),
        ({"XDG_CACHE_HOME": "/c"}, "/c/ryusa/kernels"),
    ],
)
def test_the_folder_is_that_of_the_user_unless_told_otherwise(monkeypatch, given, expected):
    for name in ("RYUSA_CACHE", "NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in given.items():
        monkeypatch.setenv(name, value)
    assert store_module.folder().as_posix() == expected
