"""What this machine and installation are, as far as the speed and the bits of a run depend on it."""

import os
import platform
import sys
import tempfile
from pathlib import Path
from typing import Any

from ryusa import __version__
from ryusa.engine import registry
from ryusa.running.provenance import processor, versions

# Of those the processor has, the widest that numbers of a run are reckoned with.
_VECTORS = (("avx512f", "AVX-512"), ("avx2", "AVX2"), ("avx", "AVX"), ("neon", "NEON"), ("sse2", "SSE2"))


def diagnosis() -> list[tuple[str, str]]:
    """Name and finding of each line; a finding that wants something done begins with "no"."""
    packages = ", ".join(f"{name} {found}" for name, found in versions().items() if found)
    return [
        ("ryusa", f"{__version__}, Python {platform.python_version()}, {platform.system()}"),
        ("packages", packages),
        ("processor", processor()),
        ("vectors", _vectors()),
        ("threads", f"{_cores()} at most; `ryusa run --threads N`, any number gives the same bits"),
        ("cache", _cache()),
        *((f"engine {name}", _engine(name)) for name in registry.names()),
    ]


def _cores() -> int:
    """Cores that this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _vectors() -> str:
    """Vector instructions that compiled code may use."""
    from llvmlite import binding

    has: Any = binding.get_host_cpu_features()
    name = next((name for flag, name in _VECTORS if has.get(flag)), "none known")
    fused = "fused multiply-add" if has.get("fma") or has.get("neon") else "no fused multiply-add"
    return f"{name}, {fused} ({binding.get_host_cpu_name()})"


def _cache() -> str:
    """Where numba keeps compiled code, and whether it can."""
    from ryusa.engine.shared import dashpots

    kept: Any = dashpots.dashpots
    place = getattr(getattr(kept, "_cache", None), "cache_path", None)
    if place is None:
        return "no folder found: every process compiles anew. Set NUMBA_CACHE_DIR to a folder of yours"
    folder = Path(place)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        return f"no writing to {folder} ({error.strerror}): every process compiles anew. Set NUMBA_CACHE_DIR"
    size = sum(file.stat().st_size for file in folder.iterdir() if file.is_file())
    return f"{folder}, writable, holds {size / 2**20:.0f} MiB"


def _engine(name: str) -> str:
    """Whether an engine can be used here, and its device."""
    if reason := registry.unavailable(name):
        return f"no: {reason}"
    device = registry.device_of(name)
    return f"available: {device}" if device else "available"
