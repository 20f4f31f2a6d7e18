"""Origin of a run: versions, commit, machine, threads, seed, command line; without the host name."""

import os
import platform
import subprocess
import sys
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from ryusa.engine import registry
from ryusa.results import schema
from ryusa.version import __version__

_PACKAGES = ("numpy", "numba", "llvmlite", "h5py", "pydantic", "pint", "scipy")
_GIT_PATIENCE = 5.0  # s


def begin(*, threads: int, seed: int | None, engine: str, overrides: dict[str, str]) -> dict[str, Any]:
    """Provenance at the start of a run, with status running."""
    return {
        "format": schema.FORMAT,
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


@cache
def commit() -> str | None:
    """Git commit of the checkout that contains this package, with "+" if files differ; None otherwise."""
    here = Path(__file__).resolve().parent
    top = _git(here, "rev-parse", "--show-toplevel")
    if top is None or not (Path(top) / "src" / "ryusa").is_dir():
        return None
    found = _git(here, "rev-parse", "HEAD")
    changed = _git(here, "status", "--porcelain", "--untracked-files=no", "--", str(here.parent))
    return None if found is None else found + ("+" if changed else "")


def last_commit(path: Path) -> str | None:
    """Git commit that last changed a file, with "+" if the file differs from it; None outside a checkout."""
    found = _git(path.parent, "log", "-n", "1", "--format=%H", "--", str(path))
    if not found:
        return None
    return found + ("+" if _git(path.parent, "status", "--porcelain", "--", str(path)) else "")


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


def _git(folder: Path, *words: str) -> str | None:
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *words],
            capture_output=True,
            text=True,
            timeout=_GIT_PATIENCE,
            check=False,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() if done.returncode == 0 else None
