"""Run folders and checkpoints from strangers: read, inspected, gone on with, or refused by name."""

import hashlib
import json
import math
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.kernel_variants import full_but

sys.path.insert(0, str(Path(__file__).parent))

from kinds import case_of

import ryusa
from ryusa.errors import RyusaError
from ryusa.results import Results, schema
from ryusa.running import loop
from ryusa.running.checkpoint import _HEAD, _MAGIC, read_checkpoint
from ryusa.running.disk import hdf5_image
from ryusa.running.inspection import inspection

SHORT = {
    "dry-2d": "0.01 s", "two-way": "0.004 s", "rolling": "0.01 s", "walls": "0.01 s", "feeds": "0.05 s",
    "mesh": "0.01 s", "materials": "0.05 s", "servo": "0.02 s", "clumps": "0.01 s",
}  # fmt: skip
SHOWN = ("two-way", "feeds", "servo", "clumps")  # one for each thing that a folder may hold beside grains
QUICK = ("dry-2d", "rolling", "servo", "clumps")  # by `make test`
IN_SPACE = ("walls", "feeds", "mesh", "materials", "servo", "clumps")
FAST = settings(
    max_examples=25,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
SLOW = settings(FAST, max_examples=300)


def go(kind: str, folder: Path, **how: Any) -> Results:
    case = case_of(kind, {"stop.time": SHORT[kind], "record.frames": "1 ms", "timeline": "[]"})
    return ryusa.run(case, folder, progress=False, **how)


@pytest.fixture(scope="module", params=full_but(QUICK, SHORT))
def stopped(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """A run of each kind, stopped in the middle with a checkpoint."""
    kind, folder = request.param, tmp_path_factory.mktemp("run") / "run"
    advance = loop.Loop._advance

    def watched(self: Any, n_steps: int) -> None:
        advance(self, n_steps)
        if self._t > 0.6 * self.stop.time:
            self._signal.stop = "the test"

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(loop.Loop, "_advance", watched)
        patch.setattr(loop.Loop, "_chunk", lambda self: 101)
        assert go(kind, folder).status == "stopped"
    return kind, folder


def judged(kind: str, folder: Path) -> None:
    """Everything a user may do with a folder ends well, or in one named error."""
    for act in (read_all, inspection, lambda one: go(kind, one, resume=True)):
        try:
            act(folder)
        except RyusaError as error:
            assert str(error)


def read_all(folder: Path) -> None:
    results = Results.open(folder)
    for array in (results.frames.x, results.frames.v, results.frames.omega):
        array[:]
    assert len(results.contacts) >= 0
    assert results.tally
    assert results.water is None or len(results.water.u) >= 0


def damage_a_file(kind: str, folder: Path, data: st.DataObject) -> None:
    files = sorted(one for one in folder.rglob("*") if one.is_file())
    path = data.draw(st.sampled_from(files), "file")
    content = bytearray(path.read_bytes())
    how = data.draw(st.sampled_from(["cut", "flip", "zero", "swap", "away", "junk"]), "how")
    place = data.draw(st.integers(0, max(len(content) - 1, 0)), "place")
    if how == "cut":
        content = content[:place]
    elif how == "flip" and content:
        content[place] ^= 1 << data.draw(st.integers(0, 7))
    elif how == "zero":
        content[place : place + 64] = bytes(len(content[place : place + 64]))
    elif how == "swap":
        content = bytearray(data.draw(st.sampled_from(files)).read_bytes())
    elif how == "junk":
        content = bytearray(data.draw(st.binary(max_size=300)))
    if how == "away":
        path.unlink()
    else:
        path.write_bytes(content)
    judged(kind, folder)


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
    | st.sampled_from([-1, 0, 2**31, 2**63, 10**400, 1e308, -math.inf, math.nan]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=4,
)  # fmt: skip


def leaves(value: Any, way: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Ways to everything within plain data."""
    found = [way] if way else []
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return found + [one for key, child in inner for one in leaves(child, (*way, key))]


def change_json(kind: str, folder: Path, data: st.DataObject) -> None:
    path = data.draw(st.sampled_from(sorted(folder.glob("*.json"))), "file")
    content = json.loads(path.read_text())
    put(content, data)
    path.write_text(json.dumps(content))
    judged(kind, folder)


def put(content: Any, data: st.DataObject) -> None:
    *way, last = data.draw(st.sampled_from(leaves(content)), "way")
    for key in way:
        content = content[key]
    content[last] = data.draw(anything, "value")


def sign_another_checkpoint(kind: str, folder: Path, data: st.DataObject) -> None:
    """A checkpoint that a stranger changed, with the right digest."""
    n = Results.open(folder).scene.n_grain
    kept = read_checkpoint(folder / schema.CHECKPOINT, n)
    about, arrays = kept.values, dict(kept.arrays)
    if data.draw(st.booleans(), "numbers"):
        put(about, data)
    else:
        name = data.draw(st.sampled_from(sorted(arrays)), "array")
        arrays[name] = changed(arrays[name], data)
    sign(folder, about, arrays)
    judged(kind, folder)


def sign(folder: Path, about: dict[str, Any], arrays: dict[str, np.ndarray]) -> None:
    """Write a checkpoint with the right digest, whatever is in it."""
    text = json.dumps({**about, "arrays": sorted(arrays)}).encode()

    def fill(file: h5py.File) -> None:
        file["about"] = np.frombuffer(text, np.uint8)
        for name, array in arrays.items():
            file[name] = array

    body = hdf5_image(fill)
    head = _MAGIC + f"{len(body)} {hashlib.sha256(body).hexdigest()}\n".encode()
    (folder / schema.CHECKPOINT).write_bytes(head.ljust(_HEAD, b"\0") + body)


def changed(array: np.ndarray, data: st.DataObject) -> np.ndarray:
    how = data.draw(st.sampled_from(["value", "shorter", "longer", "other type", "flat"]), "how")
    if how == "value" and array.size and array.dtype.names is None:
        array = array.copy()
        integers, floats = st.integers(-3, 2**31 - 1), st.floats() | st.floats(-1e-3, 1e-3)
        value = data.draw(integers if array.dtype.kind in "iu" else floats, "value")
        array.flat[data.draw(st.integers(0, array.size - 1), "place")] = value
        return array
    if how == "longer" and array.ndim:
        return np.concatenate([array, array[-1:]])
    if how == "other type" and array.dtype.names is None:
        return array.astype(np.float32)
    return array.reshape(-1) if how == "flat" else array[:-1]


@pytest.mark.parametrize("value", [math.nan, 2e-3])  # no number; in a plane another lane, much too close
def test_a_state_no_engine_accepts_is_refused_and_a_good_one_still_resumes(
    value: float, stopped: tuple[str, Path], tmp_path: Path
) -> None:
    kind, source = stopped
    if kind in IN_SPACE and math.isfinite(value):
        pytest.skip("in space there are no lanes")
    folder = tmp_path / "run"
    shutil.copytree(source, folder)
    good = (folder / schema.CHECKPOINT).read_bytes()
    kept = read_checkpoint(folder / schema.CHECKPOINT, Results.open(folder).scene.n_grain)
    arrays = {name: array.copy() for name, array in kept.arrays.items()}
    assert kind in IN_SPACE or not arrays["state/x"][:, 1].any()  # the other kinds are plane
    arrays["state/x"][0, 1] = value
    sign(folder, dict(kept.values), arrays)
    with pytest.raises(RyusaError, match=r"cannot be used|not finite"):
        go(kind, folder, resume=True)
    assert Results.open(folder).status in ("stopped", "failed")
    (folder / schema.CHECKPOINT).write_bytes(good)
    assert go(kind, folder, resume=True).status == "complete"


@pytest.mark.slow
@pytest.mark.parametrize("value", [-sys.float_info.max, sys.float_info.max, 1e99, -1e99, 1e9, -1.0, -1e-169])
def test_an_extreme_number_anywhere_in_a_checkpoint_is_accepted_or_refused_by_name(
    value: float, stopped: tuple[str, Path], tmp_path: Path
) -> None:
    kind, source = stopped
    kept = read_checkpoint(source / schema.CHECKPOINT, Results.open(source).scene.n_grain)
    floats = [name for name, one in kept.arrays.items() if one.dtype.kind == "f" and one.size]
    assert floats
    folder = tmp_path / "run"
    for name in floats:
        for place in {0, kept.arrays[name].size - 1}:
            shutil.copytree(source, folder)
            arrays = {**kept.arrays, name: kept.arrays[name].copy()}
            arrays[name].flat[place] = value
            sign(folder, dict(kept.values), arrays)
            judged(kind, folder)
            shutil.rmtree(folder)


def test_an_impossible_eddy_viscosity_is_refused(stopped: tuple[str, Path], tmp_path: Path) -> None:
    kind, source = stopped
    shutil.copytree(source, folder := tmp_path / "run")
    kept = read_checkpoint(folder / schema.CHECKPOINT, Results.open(folder).scene.n_grain)
    name = "state/coupling/water/nu_t"
    assert (name in kept.arrays) == (kind == "two-way")
    if kind != "two-way":
        return
    for value, why in [(-1e-169, "negative eddy viscosity"), (sys.float_info.max, "at most 1e\\+100")]:
        arrays = {**kept.arrays, name: kept.arrays[name].copy()}
        arrays[name][0] = value
        sign(folder, dict(kept.values), arrays)
        with pytest.raises(RyusaError, match=why):
            go(kind, folder, resume=True)


Trick = Callable[[str, Path, st.DataObject], None]
TRICKS: list[Trick] = [damage_a_file, change_json, sign_another_checkpoint]


def fuzzed(trick: Trick, stopped: tuple[str, Path], tmp_path: Path, data: st.DataObject) -> None:
    kind, source = stopped
    folder = tmp_path / "run"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(source, folder)
    trick(kind, folder, data)


@pytest.mark.parametrize("trick", TRICKS)
@pytest.mark.parametrize("stopped", full_but(["clumps"], SHOWN), indirect=True, scope="module")
@FAST
@given(data=st.data())
def test_a_manipulated_folder_is_used_or_refused_by_name(
    trick: Trick, stopped: tuple[str, Path], tmp_path: Path, data: st.DataObject
) -> None:
    fuzzed(trick, stopped, tmp_path, data)


@pytest.mark.slow
@pytest.mark.parametrize("trick", TRICKS)
@SLOW
@given(data=st.data())
def test_thousands_of_manipulated_folders_are_used_or_refused_by_name(
    trick: Trick, stopped: tuple[str, Path], tmp_path: Path, data: st.DataObject
) -> None:
    fuzzed(trick, stopped, tmp_path, data)
