"""What is left of compiling, and who is told of it."""

import os
import subprocess
import sys

import pytest

from ryusa.compiled import processor, store, tiers, waiting
from ryusa.compiled.function import compiled
from ryusa.compiled.seconds import Seconds


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A store without anything in it."""
    empty = store.Store(tmp_path, processor.own())
    monkeypatch.setattr(store, "own", lambda: empty)
    monkeypatch.setattr(tiers, "in_order", lambda: (empty,))
    return tmp_path


def make():
    @compiled()
    def inside(x):
        return x * x + 1.0

    @compiled()
    def other(x):
        return x - 1.0

    @compiled()
    def outside(x, turned):
        return inside(x) if turned is None else other(x)

    return inside, other, outside


def test_each_function_has_seconds_of_its_own_and_nothing_is_counted_twice(folder):
    before = waiting.done()
    inside, _, outside = make()
    assert outside(2.0, None) == 5.0
    new = waiting.done().since(before)
    assert new.functions == 2
    found = {one.about["name"]: one.about["seconds"] for one in store.own().listed()}
    assert set(found) == {inside.name, outside.name}
    assert 0.0 < sum(found.values()) < 1.05 * new.wall + 0.01


def test_a_listener_hears_of_functions_that_python_calls_and_of_nothing_from_the_store(folder):
    inside, _, outside = make()
    heard: list[tuple[str | None, bool]] = []
    with waiting.told(lambda name: heard.append((name, waiting.left() > 0.0))):
        outside(2.0, None)
        outside(3.0, None)
    assert heard == [(outside.name, True), (None, False)]
    with waiting.told(lambda name: heard.append((name, True))):
        make()[2](2.0, None)
    inside(1.0)
    assert len(heard) == 2


def test_what_will_be_called_counts_as_left_unless_it_is_in_the_store(folder):
    inside, _, outside = make()
    names: list[set[str]] = []

    def heard(name):
        left = [one if isinstance(one, str) else f"{one[0]} {one[1].__name__}" for one in waiting._now.left]
        names.append(set(left))

    with waiting.told(heard, {f"entry {outside.name}": 1.0, "piece not.yet.made": 3.0}):
        inside(1.0)
    called = {"entry inside", "entry outside", "inner inside", "inner other"}
    assert names[0] == {*called, "piece not.yet.made"} and names[1] == set()
    with waiting.told(lambda name: None):
        outside(1.0, None)
    _, third, again = make()  # the same text in new functions
    with waiting.told(heard, {f"entry {again.name}": 1.0}):
        third(1.0)
    assert names[2] == {"entry other"}


def test_what_comes_with_a_package_does_not_count_as_left(folder, monkeypatch):
    inside, other, outside = make()
    inside(1.0)
    outside(1.0, None)
    package = store.Store(folder, processor.own(), writable=False)
    empty = store.Store(folder / "own", processor.own())
    monkeypatch.setattr(store, "own", lambda: empty)
    monkeypatch.setattr(tiers, "in_order", lambda: (empty, package))
    waiting._packaged.cache_clear()
    left: list[set[str]] = []
    new, _, again = make()
    expected = {f"entry {again.name}": 1.0, f"entry {new.name}": 1.0, "piece not.yet.made": 3.0}
    with waiting.told(lambda _: left.append({str(one) for one in waiting._now.left}), expected):
        other(1.0)
    waiting._packaged.cache_clear()
    assert left[0] == {str(("entry", other)), "piece not.yet.made"}


def test_seconds_outlast_a_change_of_the_function_and_an_empty_store(folder):
    outside = make()[2]
    outside(2.0, None)
    found = Seconds(folder)
    name = outside.name
    assert found.by_name.keys() == {f"entry {name}", f"whole entry {name}", f"inner {make()[0].name}"}
    assert found.by_name[f"whole entry {name}"] >= found.by_name[f"entry {name}"]
    assert len(found.contents) == 2
    store.own().clear()
    assert Seconds(folder).by_name == found.by_name and not Seconds(folder).contents

    @compiled()
    def changed(x):
        return x + 2.0

    changed.name = outside.name
    expected: list[float] = []
    with waiting.told(lambda _: expected.append(sum(waiting._now.left.values()))):
        changed(1.0)
    assert expected == [found.by_name[f"entry {name}"], 0.0]


@pytest.mark.parametrize(
    "text", ["", "[]", '{"seconds": 1}', '{"seconds": {"a": "b"}, "contents": []}', "\0"]
)
def test_a_record_that_is_damaged_is_as_none(tmp_path, text):
    (tmp_path / "seconds.json").write_text(text)
    found = Seconds(tmp_path)
    assert not found.by_name and not found.contents
    found.add({"inner a": 1.0}, ["inner b"])
    assert Seconds(tmp_path).by_name == {"inner a": 1.0}


def test_what_two_processes_measure_is_kept_of_both(tmp_path):
    one, other = Seconds(tmp_path), Seconds(tmp_path)
    one.add({"inner a": 1.0}, ["inner a"])
    other.add({"inner b": 2.0}, ["inner b"])
    assert Seconds(tmp_path).by_name == {"inner a": 1.0, "inner b": 2.0}


def test_a_record_that_cannot_be_written_is_no_fault(tmp_path):
    (tmp_path / "file").write_text("no folder")
    Seconds(tmp_path / "file").add({"inner a": 1.0}, [])


def test_a_function_that_does_not_compile_leaves_nothing_open(folder):
    @compiled()
    def wrong(x):
        return x.no_such_thing

    with pytest.raises(Exception, match="no_such_thing"):
        wrong(1.0)
    assert waiting._now.open == [] and waiting._now.left == {} and waiting.left() == 0.0


def test_to_know_what_is_compiled_loads_no_numba():
    text = (
        "import sys, ryusa.compiled.waiting as w; print(w.done().functions, w.left(), 'numba' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", text], check=True, capture_output=True, text=True, env=os.environ
    )
    assert done.stdout.split() == ["0", "0.0", "False"]
