"""A folder for a run: refused when taken, when it cannot be written, when the frames would not fit."""

import json
import tempfile
from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ryusa.errors import CaseError, DiskFull, ResultsError
from ryusa.results import schema
from ryusa.running.disk import disk, free_bytes, write_over, write_whole
from ryusa.running.vtkhdf import POINTS

_FILES = (
    schema.CASE_TOML, schema.CASE_JSON, schema.SUMMARY, schema.LOG, schema.GRAINS, schema.BED,
    schema.CHECKPOINT, schema.CHECKPOINT_BEFORE, schema.PROVENANCE,
)  # fmt: skip


def make_folder(folder: Path, *, overwrite: bool) -> None:
    """Make `folder`, unless it holds what must not be touched.

    Raises
    ------
    ResultsError : it exists (and `overwrite` is off, or it is no run of ryusa), or it cannot be written.

    Notes
    -----
    A folder with an empty parts/ and nothing else was left by a run killed as it began; it is used.
    """
    with _writing(folder):
        if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
            raise ResultsError(f"{folder}: is there and is not a folder. Choose another with -o")
        if folder.exists() and any(folder.iterdir()) and not _just_begun(folder):
            if not is_run(folder):
                raise ResultsError(
                    f"{folder}: is there, is no run of ryusa, and is left alone. Choose another with -o"
                )
            if not overwrite:
                raise ResultsError(
                    f"{folder}: holds a run already. Choose another folder with -o, go on with --resume, "
                    "or say --overwrite"
                )
        folder.mkdir(parents=True, exist_ok=True)


def prepare(folder: Path) -> None:
    """Empty `folder`, which is locked, of an earlier run, and make parts/ in it."""
    with _writing(folder):
        if is_run(folder):
            clear(folder)
        (folder / schema.PARTS).mkdir(exist_ok=True)


@contextmanager
def _writing(folder: Path) -> Generator[None]:
    try:
        yield
    except OSError as error:
        raise ResultsError(
            f"{folder}: cannot be written ({error.strerror or error}). Choose another with -o"
        ) from error


def is_run(folder: Path) -> bool:
    """True for a folder that ryusa wrote."""
    if not schema.is_run_folder(folder):
        return False
    try:
        found = json.loads((folder / schema.PROVENANCE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(found, dict) and "format" in found and "ryusa" in found


def _just_begun(folder: Path) -> bool:
    """True for a folder that holds what `prepare` makes and nothing a run wrote."""
    parts, unfinished = folder / schema.PARTS, folder / f".{schema.PROVENANCE}.new"
    return (
        set(folder.iterdir()) <= {parts, unfinished, folder / schema.LOCK}
        and parts.is_dir()
        and not parts.is_symlink()
        and not any(parts.iterdir())
    )


def clear(folder: Path) -> None:
    """Delete what a run wrote, provenance last; anything else in the folder stays."""
    parts = folder / schema.PARTS
    for entry in list(parts.iterdir()):
        name = entry.name.removeprefix(".").removesuffix(".new")
        ours = (schema.PART_NAME, schema.SCENE_NAME, schema.SHELF_NAME)
        if name == POINTS or any(one.fullmatch(name) for one in ours):
            entry.unlink()
    for name in _FILES:
        (folder / f".{name}.new").unlink(missing_ok=True)
        (folder / name).unlink(missing_ok=True)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write JSON so that `path` is either as before or whole; numbers that are not finite become null.

    Raises
    ------
    ResultsError : the disk is full or the folder is gone.
    """
    with disk(path):
        write_whole(path, _json(content))


def write_last_words(path: Path, content: Mapping[str, Any]) -> None:
    """As `write_json`; on a disk without room, over the old ones in their place."""
    try:
        write_json(path, content)
    except DiskFull:
        with disk(path):
            write_over(path, _json(content))


def as_written(content: Mapping[str, Any]) -> dict[str, Any]:
    """Content as it will be read back from JSON."""
    return json.loads(_json(content))


def _json(content: Mapping[str, Any]) -> bytes:
    text = json.dumps(_plain(content), indent=1, ensure_ascii=False, allow_nan=False)
    return f"{text}\n".encode()


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if hasattr(value, "tolist"):  # numpy scalars and arrays
        return _plain(value.tolist())
    if isinstance(value, float) and value - value != 0.0:  # inf, nan
        return None
    return value


def refuse_if_not_writable(folder: Path) -> None:
    """Try a nameless file where `folder` is or will be.

    Raises
    ------
    ResultsError : nothing can be written there.
    """
    try:
        with tempfile.TemporaryFile(dir=existing(folder)):
            pass
    except OSError as error:
        raise ResultsError(
            f"{folder}: cannot be written ({error.strerror or error}). Choose another with -o"
        ) from error


def existing(folder: Path) -> Path:
    """`folder`, or the nearest folder above it that is there."""
    return next(place for place in (folder, *folder.absolute().parents) if place.is_dir())


def refuse_if_too_big(
    folder: Path, *, n_frame: float, interval: float, for_frames: float, for_events: float = 0.0
) -> None:
    """Compare the frames and contact events to come with the free space on the disk.

    Parameters
    ----------
    folder : where the run goes.
    n_frame, interval : frames, and the time between them [s].
    for_frames, for_events : what they take on the disk [B].

    Raises
    ------
    CaseError : they would not fit.
    """
    place = existing(folder)
    needed, free = for_frames + for_events, free_bytes(place)
    if needed <= free:
        return
    events = f" and the contact events about {size(for_events)}" if for_events else ""
    many = for_events > for_frames
    raise CaseError(
        "record.events" if many else "record.frames",
        None if many else f"{interval:g} s",
        f"{n_frame:.3g} frames need {size(for_frames)}{events}, but only {size(free)} are free "
        f"at {place}. Record fewer {'events' if many else 'frames'}, or stop earlier, "
        "or choose another disk with -o",
    )


def refuse_if_too_large(needed: float, n_grain: int) -> None:
    """Compare the memory that a run takes with what this machine has to give.

    Parameters
    ----------
    needed : by the run's grains [B].
    n_grain : free grains.

    Raises
    ------
    CaseError : it would not fit.
    """
    there = memory_there()
    if there is not None and needed > there:
        raise CaseError(
            "build", None,
            f"gives {n_grain} grains, which need {size(needed)} of memory; this machine has {size(there)} to "
            "give. Take fewer grains, or record.events = 'none', which needs half",
        )  # fmt: skip


def memory_there() -> float | None:
    """Memory that this process could still have [B]; None where the system does not say."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        free = next(int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:"))
    except (OSError, StopIteration, ValueError, IndexError):
        return None
    with suppress(OSError, ValueError, StopIteration):  # a container may have less
        group = Path("/sys/fs/cgroup")
        most = int((group / "memory.max").read_text(encoding="ascii"))
        used = int((group / "memory.current").read_text(encoding="ascii"))
        stat = (group / "memory.stat").read_text(encoding="ascii").splitlines()
        cached = next(int(line.split()[1]) for line in stat if line.startswith("inactive_file "))
        free = min(free, most - used + cached)
    return float(free)


def size(nbytes: float) -> str:
    """Say a number of bytes.

    >>> size(2.5e9)
    '2.5 GB'
    """
    for unit in ("B", "kB", "MB", "GB", "TB"):
        if nbytes < 1000 or unit == "TB":
            return f"{nbytes:.3g} {unit}"
        nbytes /= 1000
    raise AssertionError
