"""The file: what is written comes back bit for bit, and anything else is refused in one line."""

import hashlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from ryusa.errors import CheckpointError, RyusaError
from ryusa.model import Contacts, EngineBlock, State, Tally
from ryusa.model.contacts import N_EVENT
from ryusa.model.tally import N_TERM, PENDING
from ryusa.results import schema
from ryusa.running.checkpoint import CheckpointBlock, read_checkpoint, write_checkpoint
from ryusa.running.disk import hdf5_image
from ryusa.running.snapshot import state_block, state_from_block

N = 3


def bits(value: Any) -> Any:
    if is_dataclass(value):
        return {one.name: bits(getattr(value, one.name)) for one in fields(value)}
    if isinstance(value, Mapping):
        return {name: bits(one) for name, one in value.items()}
    return (value.dtype, value.tobytes()) if isinstance(value, np.ndarray) else repr(value)


def some_state() -> State:
    draw = np.random.default_rng(1)
    k = 2
    contacts = Contacts(
        i=np.array([0, 1]), j=np.array([2, 4]),
        **{name: draw.random((k, 3)) for name in ("spring_s", "dash_s", "spring_r", "dash_r")},
        **{name: draw.random(k) for name in ("dash_n", "f_n", "eta_n", "k_n", "overlap")},
        state=np.array([1, 3]),
        event=np.where(draw.random((k, N_EVENT)) < 0.1, np.nan, draw.random((k, N_EVENT))),
    )  # fmt: skip
    x = draw.random((N, 3))
    return State(
        x=x, v=draw.random((N, 3)), omega=draw.random((N, 3)), step=7, t=0.1 + 0.2,
        image=np.ones((N, 2), np.int32), contacts=contacts,
        tally=Tally(
            0.3, *draw.random(6).tolist(), tuple(draw.random(N_TERM).tolist()), 0.01, 2, 5, 1.5, 30.0, 2,
            tuple(draw.random(len(PENDING)).tolist()),
        ),
        engine=EngineBlock("cpu", 1, {"x_listed": x + 1e-9}, {"skin": 1 / 3e4, "since": 5.0}),
    )  # fmt: skip


def with_tally(**changes: Any) -> State:
    state = some_state()
    assert state.tally is not None
    return replace(state, tally=replace(state.tally, **changes))


@pytest.fixture
def path(tmp_path: Path) -> Path:
    write_checkpoint(tmp_path, CheckpointBlock.merged(state=state_block(some_state())))
    return tmp_path / schema.CHECKPOINT


def test_a_state_comes_back_with_the_same_bits(path: Path, scene: Any) -> None:
    found = state_from_block(read_checkpoint(path, N).block("state"), scene)
    assert bits(found) == bits(some_state())


def test_a_state_of_another_version_is_refused(scene: Any) -> None:
    block = state_block(some_state())
    older = {"tally/books" if key == "tally/terms" else key: value for key, value in block.values.items()}
    assert "tally/books" in older
    with pytest.raises(CheckpointError, match=r"or of another version .*tally/terms"):
        state_from_block(CheckpointBlock(older, block.arrays), scene)


def test_the_previous_checkpoint_is_kept_until_the_next_is_complete(tmp_path: Path) -> None:
    for k in range(4):
        write_checkpoint(tmp_path, CheckpointBlock({"k": k}))
    assert read_checkpoint(tmp_path / schema.CHECKPOINT, N).values == {"k": 3}
    assert read_checkpoint(tmp_path / schema.CHECKPOINT_BEFORE, N).values == {"k": 2}
    assert len(list(tmp_path.iterdir())) == 2


def test_a_checkpoint_for_which_there_is_no_room_leaves_the_last_one(tmp_path: Path) -> None:
    resource = pytest.importorskip("resource", reason="the size of files is limited on Unix alone")
    write_checkpoint(tmp_path, CheckpointBlock({"k": 0}))
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, limit[1]))
    try:
        with pytest.raises(OSError, match="large"):
            write_checkpoint(
                tmp_path, CheckpointBlock({"k": 1}, {"many": np.ones(100_000), "few": np.ones(3)})
            )
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert [path.name for path in tmp_path.iterdir()] == [schema.CHECKPOINT]
    assert read_checkpoint(tmp_path / schema.CHECKPOINT, N).values == {"k": 0}


def test_what_a_run_does_not_use_is_left_out_and_comes_back_as_zeros(scene: Any) -> None:
    plain = change_contacts(event=np.zeros((2, N_EVENT)), spring_r=np.zeros((2, 3)), dash_r=np.zeros((2, 3)))
    block = state_block(plain)
    assert not {"contacts/event", "contacts/spring_r", "contacts/dash_r"} & set(block.arrays)
    assert bits(state_from_block(block, scene)) == bits(plain)


def test_h5py_opens_a_checkpoint_as_it_is(path: Path) -> None:
    with h5py.File(path, "r") as file:
        assert np.array_equal(file["state/x"][:], some_state().x)


def test_a_checkpoint_cut_anywhere_is_refused(path: Path) -> None:
    whole = path.read_bytes()
    for length in (0, 5, 100, 511, 512, 513, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        with pytest.raises(CheckpointError) as caught:
            read_checkpoint(path, N)
        assert "\n" not in str(caught.value)
    path.write_bytes(whole + b"x")
    with pytest.raises(CheckpointError, match="wrong length"):
        read_checkpoint(path, N)


def test_any_flipped_bit_is_refused(path: Path) -> None:
    whole = bytearray(path.read_bytes())
    draw = np.random.default_rng(2)
    head = len(whole[:512].rstrip(b"\0"))
    places = [*range(head), *draw.integers(512, len(whole), 200).tolist()]
    for place in places:
        hurt = bytearray(whole)
        hurt[place] ^= 1 << int(draw.integers(8))
        path.write_bytes(hurt)
        with pytest.raises(CheckpointError) as caught:
            read_checkpoint(path, N)
        assert "\n" not in str(caught.value)


def signed(path: Path, fill: Any) -> None:
    """A file that a stranger made, with the right digest."""
    body = hdf5_image(fill)
    head = f"ryusa checkpoint 2\n{len(body)} {hashlib.sha256(body).hexdigest()}\n".encode()
    path.write_bytes(head.ljust(512, b"\0") + body)


def put_json(file: h5py.File, text: bytes) -> None:
    file["about"] = np.frombuffer(text, np.uint8)


def test_a_checkpoint_of_an_earlier_format_is_refused_with_both_formats(path: Path) -> None:
    path.write_bytes(path.read_bytes().replace(b"checkpoint 2", b"checkpoint 1", 1))
    with pytest.raises(CheckpointError, match="in format 1; this version of ryusa reads format 2"):
        read_checkpoint(path, N)


@pytest.mark.parametrize(
    "fill",
    [
        lambda file: None,
        lambda file: put_json(file, b"{"),
        lambda file: put_json(file, b"[]"),
        lambda file: put_json(file, b'{"arrays": 3}'),
        lambda file: put_json(file, b'{"arrays": ["x"]}'),
        lambda file: put_json(file, b'{"arrays": ["/about/.."]}'),
        lambda file: put_json(file, b'{"arrays": ' + b"[" * 100_000 + b"]" * 100_000 + b"}"),
        lambda file: file.create_dataset("about", (10**12,), np.uint8, chunks=(10**6,)),
        lambda file: file.create_dataset("about", data=np.zeros(10**6, np.uint8), compression="gzip"),
        lambda file: file.__setitem__("about", h5py.ExternalLink("/etc/hostname", "x")),
    ],
)
def test_a_forged_checkpoint_is_refused_without_filling_memory(tmp_path: Path, fill: Any) -> None:
    path = tmp_path / schema.CHECKPOINT
    signed(path, fill)
    with pytest.raises(CheckpointError):
        read_checkpoint(path, N)


def test_a_link_and_a_file_larger_than_any_are_refused(path: Path, tmp_path: Path) -> None:
    link = tmp_path / "link.h5"
    link.symlink_to(path)
    with pytest.raises(CheckpointError, match="links are not followed"):
        read_checkpoint(link, N)
    with path.open("r+b") as file:
        file.truncate(1 << 33)
    with pytest.raises(CheckpointError, match="larger than any"):
        read_checkpoint(path, N)


def change_contacts(**arrays: np.ndarray) -> State:
    state = some_state()
    return replace(state, contacts=replace(state.contacts, **arrays))


@pytest.mark.parametrize(
    "state",
    [
        change_contacts(i=np.array([0, 3])),
        change_contacts(i=np.array([-1, 1])),
        change_contacts(j=np.array([2, 6])),
        change_contacts(j=np.array([0, 4])),
        change_contacts(i=np.array([0, 0]), j=np.array([2, 2])),
        change_contacts(spring_s=np.zeros((3, 3))),
        change_contacts(f_n=np.array([1.0, np.inf])),
        change_contacts(event=np.ones((2, 3))),
        replace(some_state(), x=np.zeros((4, 3))),
        replace(some_state(), x=np.full((3, 3), np.nan)),
        replace(some_state(), x=np.full((3, 3), 1e300)),
        replace(some_state(), x=np.zeros((3, 3), np.float32)),
        replace(some_state(), v=np.full((3, 3), np.inf)),
        replace(some_state(), step=-1),
        replace(some_state(), t=float("nan")),
        with_tally(terms=(0.0,) * 3),
        with_tally(terms=(float("nan"),) * N_TERM),
        with_tally(pending=(1e300,) * 5),
        with_tally(overlap_step="x"),
        replace(some_state(), engine=EngineBlock("cpu", 1, {"x_listed": np.full((N, 3), np.inf)}, {})),
        replace(some_state(), engine=EngineBlock("cpu", 1, {}, dict.fromkeys(map(str, range(100)), 1.0))),
        replace(some_state(), image=np.zeros((2, 2), np.int32)),
    ],
)
def test_a_state_that_no_engine_accepts_is_refused(state: State, scene: Any, tmp_path: Path) -> None:
    write_checkpoint(tmp_path, CheckpointBlock.merged(state=state_block(state)))
    with pytest.raises(RyusaError) as caught:
        state_from_block(read_checkpoint(tmp_path / schema.CHECKPOINT, N).block("state"), scene)
    assert "\n" not in str(caught.value)
