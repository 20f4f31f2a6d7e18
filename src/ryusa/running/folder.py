"""Creation of a run folder; refuses a folder in use, one that cannot be written, and a full disk."""

import json
import tempfile
from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ryusa.catalogue import PICTURES
from ryusa.errors import CaseError, DiskFull, ResultsError
from ryusa.results import schema
from ryusa.running.disk import disk_errors, free_bytes, overwrite, write_atomically
from ryusa.running.vtkhdf import POINTS

_FILES = (
    schema.CASE_TOML, schema.CASE_JSON, schema.SUMMARY, schema.LOG, schema.GRAINS, schema.BED,
    schema.CHECKPOINT, schema.CHECKPOINT_BEFORE, schema.VIEW, schema.FILM, schema.REPORT, schema.BRIEF,
    schema.START, schema.SIEVE, schema.REACH, schema.PROVENANCE,
)  # fmt: skip


def make_folder(folder: Path, *, overwrite: bool) -> None:
    """Create `folder`, unless it holds data that must not be overwritten.

    Raises
    ------
    ResultsError : it exists and `overwrite` is off or it is not a run folder, or it cannot be written.

    Notes
    -----
    A folder with nothing but a lock and an empty parts/ is left by a run that was killed at its start, before
    or after it created parts/; it is reused.
    """
    with _writing(folder):
        if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
            raise ResultsError(f"{folder}: exists and is not a folder. Choose another with -o")
        if folder.exists() and any(folder.iterdir()) and not _just_begun(folder):
            if not is_run(folder):
                raise ResultsError(
                    f"{folder}: exists and is not a run folder of ryusa, so it is not changed. "
                    "Choose another with -o"
                )
            if not overwrite:
                raise ResultsError(
                    f"{folder}: already holds a run. Choose another folder with -o, continue that run with "
                    f"`ryusa resume {folder}`, or replace it with --overwrite"
                )
        folder.mkdir(parents=True, exist_ok=True)


def prepare(folder: Path) -> None:
    """Delete an earlier run from the locked `folder`, and create parts/ in it."""
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
    """True for a folder written by ryusa."""
    if not schema.is_run_folder(folder):
        return False
    try:
        found = json.loads((folder / schema.PROVENANCE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(found, dict) and "format" in found and "ryusa" in found


def _just_begun(folder: Path) -> bool:
    """True for a folder with nothing but the lock and what `prepare` creates."""
    parts, unfinished, lock = (
        folder / one for one in (schema.PARTS, f".{schema.PROVENANCE}.new", schema.LOCK)
    )
    if not set(folder.iterdir()) <= {parts, unfinished, lock} or parts.is_symlink():
        return False
    return not any(parts.iterdir()) if parts.is_dir() else lock.is_file() and not parts.exists()


def clear(folder: Path) -> None:
    """Delete the files of a run, provenance last; other files in the folder are kept."""
    parts = folder / schema.PARTS
    for entry in list(parts.iterdir()):
        name = entry.name.removeprefix(".").removesuffix(".new")
        ours = (schema.PART_NAME, schema.SCENE_NAME, schema.SUBINDEX_NAME)
        if name == POINTS or any(one.fullmatch(name) for one in ours):
            entry.unlink()
    _clear_pictures(folder / schema.PICTURES)
    for name in _FILES:
        (folder / f".{name}.new").unlink(missing_ok=True)
        (folder / name).unlink(missing_ok=True)


def _clear_pictures(pictures: Path) -> None:
    """Delete what `ryusa draw` wrote beside the run."""
    if pictures.is_symlink() or not pictures.is_dir():
        return
    for entry in PICTURES:
        for suffix in (".png", ".csv"):
            (pictures / f"{entry.name}{suffix}").unlink(missing_ok=True)
    if not any(pictures.iterdir()):
        pictures.rmdir()


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write JSON atomically; numbers that are not finite become null.

    Raises
    ------
    ResultsError : the disk is full or the folder does not exist.
    """
    with disk_errors(path):
        write_atomically(path, _json(content))


def write_final_json(path: Path, content: Mapping[str, Any]) -> None:
    """As `write_json`; on a full disk the file is overwritten in place."""
    try:
        write_json(path, content)
    except DiskFull:
        with disk_errors(path):
            overwrite(path, _json(content))


def as_read_back(content: Mapping[str, Any]) -> dict[str, Any]:
    """Content as JSON returns it."""
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
    """Test with a temporary file that `folder` can be written.

    Raises
    ------
    ResultsError : nothing can be written there.
    """
    try:
        with tempfile.TemporaryFile(dir=nearest_existing(folder)):
            pass
    except OSError as error:
        raise ResultsError(
            f"{folder}: cannot be written ({error.strerror or error}). Choose another with -o"
        ) from error


def nearest_existing(folder: Path) -> Path:
    """`folder`, or the nearest parent folder that exists."""
    return next(place for place in (folder, *folder.absolute().parents) if place.is_dir())


def refuse_if_too_big(
    folder: Path, *, n_frame: float, interval: float, for_frames: float, for_events: float = 0.0
) -> None:
    """Compare the expected size of frames and contact records with the free space on the disk.

    Parameters
    ----------
    folder : where the run goes.
    n_frame, interval : frames, and the time between them [s].
    for_frames, for_events : their expected size on the disk [B].

    Raises
    ------
    CaseError : the free space is not sufficient.
    """
    place = nearest_existing(folder)
    needed, free = for_frames + for_events, free_bytes(place)
    if needed <= free:
        return
    events = f" and the contact records about {format_bytes(for_events)}" if for_events else ""
    many = for_events > for_frames
    raise CaseError(
        "record.events" if many else "record.frames",
        None if many else f"{interval:g} s",
        f"{n_frame:.3g} frames need {format_bytes(for_frames)}{events}, but only {format_bytes(free)} are "
        f"free at {place}. Record fewer {'contacts' if many else 'frames'}, stop earlier, or write to "
        "another disk with -o",
    )


def refuse_if_too_large(needed: float, n_grain: int) -> None:
    """Compare the memory that a run needs with the memory available.

    Parameters
    ----------
    needed : memory for the grains of the run [B].
    n_grain : free grains.

    Raises
    ------
    CaseError : the memory is not sufficient.
    """
    there = available_memory()
    if there is not None and needed > there:
        raise CaseError(
            "build", None,
            f"gives {n_grain} grains, which need {format_bytes(needed)} of memory; {format_bytes(there)} are "
            "available. Take fewer grains",
        )  # fmt: skip


def available_memory() -> float | None:
    """Memory available to this process [B]; None where the system does not report it."""
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


def format_bytes(nbytes: float) -> str:
    """Format a number of bytes.

    >>> format_bytes(2.5e9)
    '2.5 GB'
    """
    for unit in ("B", "kB", "MB", "GB", "TB"):
        if nbytes < 1000 or unit == "TB":
            return f"{nbytes:.3g} {unit}"
        nbytes /= 1000
    raise AssertionError
