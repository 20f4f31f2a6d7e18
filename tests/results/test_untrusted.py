"""A run folder from a stranger: every trick ends in one ResultsError; none reads outside or fills memory."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.model import EVENT
from ryusa.results import Results


def touch_all(folder: Path) -> None:
    results = Results.open(folder)
    for array in (results.frames.x, results.frames.v, results.frames.omega):
        array[:]
    assert len(results.contacts) >= 0
    assert len(results.tally) > 0


def part(folder: Path, k: int = 1) -> Path:
    return folder / "parts" / f"part-{k:06d}.h5"


def replace_dataset(path: Path, name: str, make: Callable[[h5py.File], object]) -> None:
    with h5py.File(path, "r+") as file:
        del file[name]
        make(file)


def outside(folder: Path) -> Path:
    path = folder.parent / "secret.h5"
    with h5py.File(path, "w") as file:
        file["x"] = np.full((1, 2, 3), 42.0)
    return path


def external_link(folder: Path) -> None:
    link = h5py.ExternalLink(str(outside(folder)), "x")
    replace_dataset(part(folder), "x", lambda file: file.__setitem__("x", link))


def soft_link(folder: Path) -> None:
    replace_dataset(part(folder), "x", lambda file: file.__setitem__("x", h5py.SoftLink("/v")))


def virtual(folder: Path) -> None:
    layout = h5py.VirtualLayout((1, 2, 3), np.float64)
    layout[:] = h5py.VirtualSource(str(outside(folder)), "x", shape=(1, 2, 3))
    replace_dataset(part(folder), "x", lambda file: file.create_virtual_dataset("x", layout))


def external_storage(folder: Path) -> None:
    (folder.parent / "secret.bin").write_bytes(bytes(48))
    where = [(str(folder.parent / "secret.bin"), 0, 48)]
    replace_dataset(
        part(folder), "x", lambda file: file.create_dataset("x", (1, 2, 3), np.float64, external=where)
    )


def huge(folder: Path) -> None:
    def make(file: h5py.File) -> None:
        for name in ("t", "step"):
            del file[name]
            file.create_dataset(name, (10**12,), np.float64 if name == "t" else np.int64, chunks=(10**6,))
        file.create_dataset("x", (10**12, 2, 3), np.float64, chunks=(10**5, 2, 3))

    replace_dataset(part(folder), "x", make)


def compressed_bomb(folder: Path) -> None:
    rows = np.zeros(10**6, dtype=EVENT)
    replace_dataset(
        part(folder), "contacts", lambda file: file.create_dataset("contacts", data=rows, compression="gzip")
    )


def objects(folder: Path) -> None:
    replace_dataset(
        part(folder), "t", lambda file: file.create_dataset("t", data=["a"], dtype=h5py.string_dtype())
    )


def wrong_shape(folder: Path) -> None:
    replace_dataset(part(folder), "v", lambda file: file.create_dataset("v", data=np.zeros((1, 2, 2))))


def wrong_type(folder: Path) -> None:
    replace_dataset(
        part(folder), "v", lambda file: file.create_dataset("v", data=np.zeros((1, 2, 3), np.float32))
    )


def missing_dataset(folder: Path) -> None:
    replace_dataset(part(folder), "tally", lambda file: None)


def group_for_dataset(folder: Path) -> None:
    replace_dataset(part(folder), "x", lambda file: file.create_group("x"))


def linked_part(folder: Path) -> None:
    part(folder).rename(folder.parent / "elsewhere.h5")
    part(folder).symlink_to(folder.parent / "elsewhere.h5")


def linked_parts(folder: Path) -> None:
    (folder / "parts").rename(folder.parent / "parts")
    (folder / "parts").symlink_to(folder.parent / "parts")


def missing_part(folder: Path) -> None:
    part(folder).unlink()


def cut_part(folder: Path) -> None:
    part(folder, 2).write_bytes(part(folder, 2).read_bytes()[:3000])


def no_hdf5(folder: Path) -> None:
    part(folder).write_bytes(b"no HDF5")


def cut_scene(folder: Path) -> None:
    (folder / "parts" / "scene-000000.h5").write_bytes(b"")


def no_scene(folder: Path) -> None:
    (folder / "parts" / "scene-000000.h5").unlink()


def odd_scene(folder: Path) -> None:
    path = folder / "parts" / "scene-000000.h5"
    text = b'{"step": 0, "t": 0, "contact": {"k_n": 1, "__class__": 2}}'
    replace_dataset(
        path, "scalars", lambda file: file.create_dataset("scalars", data=np.frombuffer(text, np.uint8))
    )


def odd_scene_shape(folder: Path) -> None:
    path = folder / "parts" / "scene-000000.h5"
    replace_dataset(path, "m", lambda file: file.create_dataset("m", data=np.zeros(7)))


def bad_json(folder: Path) -> None:
    (folder / "summary.json").write_text("{")


def deep_json(folder: Path) -> None:
    (folder / "case.json").write_text("[" * 100_000)


def list_json(folder: Path) -> None:
    (folder / "provenance.json").write_text("[]")


def linked_json(folder: Path) -> None:
    (folder / "case.json").unlink()
    (folder / "case.json").symlink_to(folder.parent / "secret.json")


def binary_json(folder: Path) -> None:
    (folder / "case.json").write_bytes(b"\xff\xfe{}")


def later_format(folder: Path) -> None:
    (folder / "provenance.json").write_text('{"format": 99, "ryusa": "9.0"}')


TRICKS = [
    external_link,
    soft_link,
    virtual,
    external_storage,
    huge,
    compressed_bomb,
    objects,
    wrong_shape,
    wrong_type,
    missing_dataset,
    group_for_dataset,
    linked_part,
    linked_parts,
    missing_part,
    cut_part,
    no_hdf5,
    cut_scene,
    no_scene,
    odd_scene,
    odd_scene_shape,
    bad_json,
    deep_json,
    list_json,
    linked_json,
    binary_json,
    later_format,
]


@pytest.mark.parametrize("trick", TRICKS, ids=lambda trick: trick.__name__)
def test_a_tampered_folder_is_one_clear_error(folder: Path, trick: Callable[[Path], None]) -> None:
    touch_all(folder)
    trick(folder)
    with pytest.raises(ResultsError) as caught:
        touch_all(folder)
    assert str(folder) in str(caught.value)


def test_a_byte_changed_anywhere_never_escapes_as_another_error(folder: Path) -> None:
    rng = np.random.default_rng(5)
    clean = part(folder).read_bytes()
    for _ in range(60):
        spoiled = bytearray(clean)
        for at in rng.integers(0, len(clean), 3):
            spoiled[at] = rng.integers(0, 256)
        part(folder).unlink()
        part(folder).write_bytes(bytes(spoiled))
        with suppress(ResultsError):
            touch_all(folder)
