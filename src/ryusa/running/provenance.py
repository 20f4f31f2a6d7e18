"""Origin of a run: versions, commit, machine, threads, seed, command line; without the host name."""

import os
import platform
import sys
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from ryusa.engine import registry
from ryusa.results import schema
from ryusa.version import __version__, commit, git

_PACKAGES = ("numpy", "numba", "llvmlite", "h5py", "pydantic", "pint", "scipy")


def begin(*, threads: int, seed: int | None, engine: str, overrides: dict[str, str]) -> dict[str, Any]:
    """Provenance at the start of a run, with status running."""
    return {
        "format": schema.FORMAT,
        "read_by": schema.READ_BY,
        "status": schema.RUNNING,
        "message": "",
        "begin": now(),
        "end": None,
        "ryusa": __version__,
        "commit": commit(),
        "packages": versions(),
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.release()}",
        "machine": {"processor": processor(), "cores": os.cpu_count(), "architecture": platform.machine()},
        "threads": threads,
        "engine": engine,
        **_device(engine),
        "seed": seed,
        "overrides": overrides,
        "command": _command(),
    }


def _device(engine: str) -> dict[str, str]:
    """Device of an engine of the registry, where it is not the processor."""
    named = registry.device_of(engine) if registry.known(engine).device else ""
    return {"device": named} if named else {}


def versions() -> dict[str, str | None]:
    """Versions of the packages on which the numbers of a run depend."""
    return {name: _version(name) for name in _PACKAGES}


def now() -> str:
    """Present time, UTC, ISO 8601."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def last_commit(path: Path) -> str | None:
    """Git commit that last changed a file, with "+" if the file differs from it; None outside a checkout."""
    found = git(path.parent, "log", "-n", "1", "--format=%H", "--", str(path))
    if not found:
        return None
    return found + ("+" if git(path.parent, "status", "--porcelain", "--", str(path)) else "")


def processor() -> str:
    """Name of the processor."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _command() -> list[str]:
    """Command line, with the program name without its path."""
    return [Path(sys.argv[0]).name, *sys.argv[1:]] if sys.argv else []


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
