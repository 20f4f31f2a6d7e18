from typing import Any

import pytest
from typer.testing import CliRunner

from ryusa.cli import app
from ryusa.compiled import store, tiers
from ryusa.engine.cuda import availability
from ryusa.running import doctor


def test_the_doctor_names_cache_threads_vectors_and_engines() -> None:
    done = CliRunner().invoke(app, ["doctor"])
    assert done.exit_code == 0
    for name in (
        "packages",
        "processor",
        "vectors",
        "threads",
        "cache",
        "kernels",
        "engine cpu",
        "engine lammps",
    ):
        assert f"\n{name} " in done.output
    assert "numba" in done.output


def test_the_doctor_says_why_cuda_cannot_be_used_or_what_card_there_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(availability, "unavailable", lambda: "the CUDA driver finds no card")
    assert dict(doctor.diagnosis())["engine cuda"] == "no: the CUDA driver finds no card"
    monkeypatch.setattr(availability, "unavailable", lambda: "")
    monkeypatch.setattr(availability, "device_name", lambda: "A card")
    assert dict(doctor.diagnosis())["engine cuda"] == "available: A card"


def test_the_doctor_says_when_the_cache_cannot_be_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    (tmp_path / "file").write_text("no folder")
    closed = store.Store(tmp_path / "file" / "cache", store.own().processor)
    monkeypatch.setattr(store, "own", lambda: closed)
    found = dict(doctor.diagnosis())["cache"]
    assert found.startswith("no permission to write to")
    assert "RYUSA_CACHE" in found


def test_the_doctor_says_what_the_cache_holds_what_is_damaged_and_what_cannot_be_read(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    own = store.Store(tmp_path / "own", store.own().processor)
    shipped = store.Store(tmp_path / "shipped", own.processor, writable=False, trouble="shipped: unreadable")
    monkeypatch.setattr(store, "own", lambda: own)
    monkeypatch.setattr(tiers, "in_order", lambda: (own, shipped))
    about = {"name": "a.b", "kind": "entry", "seconds": 1.0, "processor": "any"}
    for key in ("ab" * 32, "cd" * 32):
        own.save(key, about, b"code")
    next(own.listed()).file.write_bytes(b"cut")
    found = dict(doctor.diagnosis())["cache"]
    assert found.startswith(f"{own.folder}, writable, 0 MiB of compiled code in 2 files")
    assert "1 files are damaged" in found
    assert found.endswith("; shipped: unreadable")
