"""`ryusa kernels` and `ryusa warm`."""

import os

import pytest
from typer.testing import CliRunner

from ryusa.cases import case_path
from ryusa.cli import app
from ryusa.compiled import processor, store, tiers
from ryusa.compiled.waiting import Done
from ryusa.running import warm


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """A store with two types of one entry, a piece and two functions built into them."""
    own = store.Store(tmp_path / "kernels", processor.own())
    monkeypatch.setattr(store, "own", lambda: own)
    monkeypatch.setattr(tiers, "in_order", lambda: (own,))
    names = ("prune.prune_blocks", "prune.prune_blocks", "block_forces.make[kind].forces", "a.one", "a.two")
    kinds = ("entry", "entry", "piece", "inner", "inner")
    for k, (name, kind) in enumerate(zip(names, kinds, strict=True)):
        about = {"name": f"ryusa.engine.cpu.{name}", "kind": kind, "seconds": 1.5, "processor": "any"}
        own.save(f"{k}{k}" * 32, about, b"code")
    return own


def asked(*words: str):
    return CliRunner().invoke(app, list(words))


def test_the_store_is_listed_by_function_with_totals(kept):
    done = asked("kernels")
    assert done.exit_code == 0
    rows = {line.split()[-6]: line.split() for line in done.output.splitlines() if " any" in line}
    assert rows["engine.cpu.prune.prune_blocks"][:3] == ["pruning", "of", "pairs"]
    assert rows["engine.cpu.prune.prune_blocks"][4:7:2] == ["2", "3.0"]
    assert "engine.cpu.block_forces.make[kind].forces" in rows
    assert "functionsbuiltintothese20" in "".join(done.output.split())  # 2 of them, of 0 kB
    assert f"{kept.folder}: 5 functions, 0.0 MiB, compiled in 8 s of processor time" in done.output


def test_a_store_that_is_only_read_and_one_in_trouble_are_told(kept, monkeypatch, tmp_path):
    closed = store.Store(tmp_path / "shipped", processor.own(), writable=False, trouble="no disk")
    monkeypatch.setattr(tiers, "in_order", lambda: (kept, closed))
    lines = asked("kernels").output.splitlines()
    assert (
        lines[-2].startswith(f"{closed.folder}, only read: 0 functions") and lines[-1] == "warning: no disk"
    )


def test_the_help_says_what_is_removed_by_itself():
    text = asked("kernels", "--help").output
    assert f"{store.UNUSED_DAYS} days" in text and f"{store.LARGEST // 2**20} MiB" in text


def test_the_store_is_emptied(kept):
    done = asked("kernels", "clear")
    assert done.exit_code == 0 and f"{kept.folder}: 5 files removed, 0.0 MiB" in done.output
    assert kept.size() == (0, 0)
    assert "0 files removed" in asked("kernels", "clear").output


@pytest.mark.parametrize("words", [("claer",), ("clear", "now"), ("--all",)])
def test_what_makes_no_sense_is_refused(kept, words):
    done = asked("kernels", *words)
    assert done.exit_code == 2 and kept.size()[0] == 5
    assert words != ("claer",) or ("ACTION = 'claer'" in done.output and "clear" in done.output)


def test_files_that_cannot_be_removed_are_told(kept, monkeypatch):
    monkeypatch.setattr(store.Store, "clear", lambda self: 3)
    done = asked("kernels", "clear")
    assert done.exit_code != 0 and "2 of 5 files cannot be removed" in done.output


def test_cases_are_compiled_ahead_by_file_and_by_name(monkeypatch, tmp_path):
    said: list[tuple[object, int]] = []

    def ahead(path, *, threads):
        said.append((path, threads))
        return Done(3, 2.5) if len(said) == 1 else Done()

    monkeypatch.setattr(warm, "warm", ahead)
    monkeypatch.delenv("RYUSA_KERNELS", raising=False)
    own = tmp_path / "own.toml"
    done = asked("warm", str(own), "paper/fig19", "--threads", "2")
    assert done.output == f"{own}: compiled 3 functions in 2.5 s\npaper/fig19: already compiled\n"
    assert said == [(own, 2), (case_path("paper/fig19.toml"), 2)] and "RYUSA_KERNELS" not in os.environ


def test_native_asks_for_this_very_processor(monkeypatch):
    monkeypatch.setenv("RYUSA_KERNELS", "")
    asked_for: list[str] = []
    monkeypatch.setattr(
        warm, "warm", lambda path, **more: (asked_for.append(os.environ["RYUSA_KERNELS"]), Done())[1]
    )
    assert asked("warm", "drop", "--native").exit_code == 0 and asked_for == ["native"]


def test_an_unknown_case_is_named_with_the_nearest():
    done = asked("warm", "saltaton")
    assert done.exit_code == 2
    assert "CASE = 'saltaton'" in done.output and "Did you mean 'saltation'?" in done.output
    assert asked("warm").exit_code == 2
