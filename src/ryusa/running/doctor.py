"""Report on the machine and the installation, as far as speed and bits of a run depend on them."""

import os
import platform
import sys
import tempfile
from typing import Any

from ryusa.compiled import store, tiers
from ryusa.compiled.shipped import shipped
from ryusa.engine import registry
from ryusa.running.provenance import processor, versions
from ryusa.version import described

_LEAST_ROOM = 2**20  # bytes on the disk of compiled code, more than any file of it

# Widest first; the widest that the processor has is reported.
_VECTORS = (("avx512f", "AVX-512"), ("avx2", "AVX2"), ("avx", "AVX"), ("neon", "NEON"), ("sse2", "SSE2"))


def diagnosis() -> list[tuple[str, str]]:
    """Name and finding of each line; a finding that needs action begins with "no"."""
    packages = ", ".join(f"{name} {found}" for name, found in versions().items() if found)
    return [
        ("ryusa", f"{described()}, Python {platform.python_version()}, {platform.system()}"),
        ("packages", packages),
        ("processor", processor()),
        ("vectors", _vectors()),
        ("threads", f"up to {_cores()} (ryusa run --threads N); the results do not depend on the number"),
        ("cache", _cache()),
        ("kernels", shipped().finding),
        *((f"engine {name}", _engine(name)) for name in registry.names()),
    ]


def _cores() -> int:
    """Cores that this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _vectors() -> str:
    """Vector instructions available to compiled code."""
    from llvmlite import binding

    has: Any = binding.get_host_cpu_features()
    name = next((name for flag, name in _VECTORS if has.get(flag)), "none known")
    fused = "fused multiply-add" if has.get("fma") or has.get("neon") else "no fused multiply-add"
    return f"{name}, {fused} ({binding.get_host_cpu_name()})"


def _cache() -> str:
    """Folder of compiled code: whether it can be written, what it holds, and what is wrong with it."""
    kept = store.own()
    advice = "so that every process compiles again. Set RYUSA_CACHE to a folder that you can write"
    try:
        kept.folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=kept.folder) as file:
            file.write(b"0" * _LEAST_ROOM)
    except OSError as error:
        return f"no permission to write to {kept.folder} ({error.strerror}), {advice}"
    files, size = kept.size()
    damaged = files - sum(1 for _ in kept.listed())
    return "; ".join(
        [
            f"{kept.folder}, writable, {size / 2**20:.0f} MiB of compiled code in {files} files "
            "(ryusa kernels lists it)",
            *([f"{damaged} files are damaged and are compiled anew when they are needed"] if damaged else []),
            *(one.trouble for one in tiers.in_order() if one.trouble),
        ]
    )


def _engine(name: str) -> str:
    """Whether an engine can be used here, and its device."""
    if reason := registry.unavailable(name):
        return f"no: {reason}"
    device = registry.device_of(name)
    return f"available: {device}" if device else "available"
