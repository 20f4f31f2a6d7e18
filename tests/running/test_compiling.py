"""A run says what it waits for while it compiles."""

import importlib
import inspect
import io
from pathlib import Path
from types import CodeType
from typing import Any

import pytest

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.compiled import processor, store, tiers, waiting
from ryusa.compiled.content import latest
from ryusa.compiled.function import compiled
from ryusa.compiled.seconds import Seconds
from ryusa.running import compiling
from ryusa.running.compiling import compiling_row, compiling_told, expected_of, words_of
from ryusa.running.progress import Progress

SOURCE = Path(compiling.__file__).parents[2]


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def told(tmp_path: Any, stream: io.StringIO, looks: list[tuple[str, float, float]]) -> list[str]:
    """What a progress says when it looks at these functions, after these seconds, with these left."""
    progress = Progress(tmp_path / "log.txt", shown=True, stream=stream)
    teller = compiling._Teller(progress)
    for one in looks:
        teller.look(*one)
    progress.close()
    return [line.partition("  ")[2] for line in (tmp_path / "log.txt").read_text().splitlines()]


FORCES = "ryusa.engine.cpu.block_forces.make_block_forces.<locals>.block_forces"
PRUNE = "ryusa.engine.cpu.prune.prune_blocks"


@pytest.mark.parametrize("kind", [io.StringIO, Terminal])
def test_lines_say_what_is_compiled_how_much_is_left_and_that_it_happens_once(tmp_path, kind):
    stream = kind()
    looks = [
        (PRUNE, 1.0, 20.0), (PRUNE, 2.0, 24.0), (FORCES, 4.0, 17.0), (FORCES, 12.5, 8.6), (FORCES, 20.0, 3.0),
        (FORCES, 45.0, 0.0), ("a.b.own", 60.0, 0.0),
    ]  # fmt: skip
    assert told(tmp_path, stream, looks) == [
        "compiling for this processor, once for this kind of case: pruning of pairs, about 25 s left",
        "compiling: contacts, about 9 s left",
    ]
    assert stream.getvalue().count("once for this kind of case") >= 1


def test_a_quick_compilation_is_not_worth_a_word(tmp_path):
    stream = io.StringIO()
    assert told(tmp_path, stream, [(FORCES, 0.5, 1.0), (PRUNE, 1.4, 0.5)]) == [] and stream.getvalue() == ""


def test_a_run_that_compiles_nothing_says_nothing_and_starts_no_thread(tmp_path, scene):
    stream = io.StringIO()
    progress = Progress(tmp_path / "log.txt", shown=True, stream=stream)
    with compiling_told(progress, scene):
        pass
    assert stream.getvalue() == "" and waiting._now.listeners == []


def test_a_thread_looks_while_a_function_is_compiled_and_ends_with_the_run(tmp_path, scene, monkeypatch):
    monkeypatch.setattr(compiling, "_AFTER", 0.0)
    monkeypatch.setattr(compiling, "_LOOK", 0.001)
    empty = store.Store(tmp_path, processor.own())
    monkeypatch.setattr(store, "own", lambda: empty)
    monkeypatch.setattr(tiers, "in_order", lambda: (empty,))
    stream = io.StringIO()
    progress = Progress(tmp_path / "log.txt", shown=True, stream=stream)

    @compiled()
    def of_a_new_kind(x):
        return x * x + 3.25 / (x + 0.125)

    with compiling_told(progress, scene):
        of_a_new_kind(1.0)
    progress.close()
    assert "once for this kind of case: of_a_new_kind" in stream.getvalue()


def test_functions_that_are_expected_exist_under_these_names(scene_with):
    """Those of a factory are told by its module: they are made for a kind of case."""
    grains = {*compiling._OF_GRAINS, *compiling._OF_BODIES, *compiling._OF_GRAINS_IN_ROW}
    known = sorted({*grains, *compiling._OF_COLUMN, *compiling._OF_ROW})
    for named in known:
        kind, _, name = named.partition(" ")
        whole, _, made = name.partition(".<locals>.")
        module, _, function = whole.rpartition(".")
        found = getattr(importlib.import_module(module), function)
        assert kind in {"entry", "piece"} and callable(found), named
        if made:
            inside = inspect.unwrap(found).__code__.co_consts
            assert any(isinstance(one, CodeType) and one.co_name == made for one in inside)
        else:
            assert latest[name] is found
    assert expected_of(grains=True, clumps=False, column=False, row=False) == compiling._OF_GRAINS


def test_check_says_how_long_compiling_takes_at_most(tmp_path, monkeypatch):
    empty = store.Store(tmp_path, processor.own())
    monkeypatch.setattr(store, "own", lambda: empty)
    monkeypatch.setattr(waiting, "_packaged", frozenset)
    row = compiling_row(read(case_path("weir.toml")))
    assert row.value == pytest.approx(sum(compiling._OF_ROW.values())) and row.shown == "up to 14 s"
    assert compiling_row(read(case_path("river.toml"))).value > row.value
    empty.folder.mkdir(exist_ok=True)
    name = next(iter(compiling._OF_ROW))
    Seconds(tmp_path).add({f"whole {name}": 100.0}, [])
    waiting._record_in.cache_clear()
    assert compiling_row(read(case_path("weir.toml"))).value > 100.0
    monkeypatch.setattr(waiting, "_packaged", lambda: frozenset(compiling._OF_ROW))
    assert compiling_row(read(case_path("weir.toml"))).value == 0.0


def test_every_entry_of_the_table_of_words_names_something():
    for first in compiling._WORDS:
        place = first.replace(".", "/")
        names = (f"{place[:-1]}.py", place[:-1]) if place.endswith("/") else (f"{place}*.py",)
        assert any(list(SOURCE.glob(name)) for name in names), first
    assert words_of("somewhere.function") == "function"
