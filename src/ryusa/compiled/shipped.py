"""Compiled code that comes as a package, `ryusa-kernels`: it is read after the user's own store.

The package holds files of a store and a manifest that says what they were made of and for which processor
(`make kernels`). A key says the same, so that a file is right or is not found; the manifest spares asking in
vain, and tells `ryusa doctor` why nothing is used.
"""

import hashlib
import importlib.util
import json
import os
import sys
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

from ryusa.compiled import processor
from ryusa.compiled.processor import Processor
from ryusa.compiled.store import Store

PACKAGE = "ryusa_kernels"
MANIFEST, STORE = "manifest.json", "store"  # a file and a folder in it
SWITCH = "RYUSA_KERNELS"  # in the environment; `native`: the package is not used
_V3 = (
    "avx avx2 bmi bmi2 cmov crc32 cx16 cx8 f16c fma fxsr lzcnt mmx movbe popcnt sahf sse sse2 sse3 sse4.1 "
    "sse4.2 ssse3 xsave"
)
# What a kind of processor must have, by LLVM's names, where its features are not written out.
FEATURES = {"x86-64-v3": frozenset(_V3.split())}


@dataclass(frozen=True)
class Manifest:
    """What a package of compiled code says of itself.

    Attributes
    ----------
    ryusa : version.
    source : digest of the files that it was made of (`source_digest`).
    versions : of the compiler (processor.py).
    processor : triple, name and features of the processor that it is for.
    cases : names of the cases whose code it holds.
    files : number of files in the store.
    """

    ryusa: str
    source: str
    versions: tuple[str, ...]
    processor: tuple[str, str, str]
    cases: tuple[str, ...]
    files: int

    @classmethod
    def read(cls, file: Path) -> "Manifest":
        """Read a manifest.

        Raises
        ------
        OSError, ValueError, TypeError, KeyError, ArithmeticError : it is not there, or it is not one.
        """
        told: dict[str, Any] = dict(json.loads(file.read_bytes()))
        triple, name, features = map(str, told["processor"])
        return cls(
            ryusa=str(told["ryusa"]),
            source=str(told["source"]),
            versions=tuple(map(str, told["versions"])),
            processor=(triple, name, features),
            cases=tuple(map(str, told["cases"])),
            files=int(told["files"]),
        )

    def write(self, file: Path) -> None:
        """Write it for `read`."""
        file.write_text(json.dumps(asdict(self), indent=1) + "\n", encoding="utf-8")


@dataclass(frozen=True)
class Shipped:
    """The package of compiled code.

    Attributes
    ----------
    store : its files; None where they are not used.
    why : why they are not used; empty where they are.
    manifest : what the package says of itself; None where there is none that can be read.
    """

    store: Store | None
    why: str
    manifest: Manifest | None = None

    @property
    def finding(self) -> str:
        """What is used of it, or why nothing is."""
        if self.store is None or self.manifest is None:
            return self.why
        files, size = self.store.size()
        text = (
            f"{files} for {self.store.processor.name}, of {len(self.manifest.cases)} packaged cases, "
            f"{size / 2**20:.0f} MiB in {self.store.folder}, asked after the cache"
        )
        if files != self.manifest.files:
            text += f"; {self.manifest.files} were made, what is missing is compiled"
        if self.manifest.source != source_digest():
            text += "; made of other source files than these, what has changed is compiled"
        return text


@cache
def shipped() -> Shipped:
    """The installed package, and whether its code fits this process."""
    found = importlib.util.find_spec(PACKAGE)
    if found is None or not found.submodule_search_locations:
        return Shipped(None, "package ryusa-kernels is absent, the first run of a case compiles")
    return opened(Path(found.submodule_search_locations[0]))


def opened(folder: Path) -> Shipped:
    """The package in a folder."""
    try:
        manifest = Manifest.read(folder / MANIFEST)
    except (OSError, ValueError, TypeError, KeyError, ArithmeticError) as error:
        return Shipped(None, f"not used: {folder / MANIFEST} cannot be read ({error!r})")
    if why := refusal(manifest):
        return Shipped(None, f"not used: {why}", manifest)
    return Shipped(Store(folder / STORE, Processor(*manifest.processor), writable=False), "", manifest)


def refusal(manifest: Manifest) -> str:
    """Why the code of a package is not used in this process; empty where it is."""
    from numba.core import config

    version = sys.modules["ryusa"].__version__  # of the package that holds this one

    made, own = Processor(*manifest.processor), processor.own()
    if os.environ.get(SWITCH) == "native":
        return f"{SWITCH}=native, code is compiled for this processor"
    if manifest.ryusa != version:
        return f"made for ryusa {manifest.ryusa}, this is {version}"
    here = processor.versions()
    if manifest.versions != here:
        differ = set(manifest.versions) ^ set(here)
        there, this = ([one for one in said if one in differ] for said in (manifest.versions, here))
        return f"made with {', '.join(there)}, here {', '.join(this)}"
    if made == own:
        return ""
    if getattr(config, "CPU_NAME", None):
        return f"made for {made.name}, while NUMBA_CPU_NAME is {own.name}"
    if made.triple != own.triple:
        return f"made for {made.triple}, this is {own.triple}"
    needed = FEATURES.get(made.name) or _written_out(made)
    missing = sorted(needed - _own_features())
    if missing or not needed:
        return f"made for {made.name}, this processor lacks {' '.join(missing) or 'its name'}"
    return ""


def source_digest() -> str:
    """Digest of all files of the package ryusa that hold code."""
    top, digest = Path(__file__).resolve().parent.parent, hashlib.sha256()
    for file in sorted(top.rglob("*.py"), key=lambda one: one.relative_to(top).as_posix()):
        digest.update(file.relative_to(top).as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()


def _written_out(made: Processor) -> frozenset[str]:
    return frozenset(one[1:] for one in made.features.split(",") if one.startswith("+"))


def _own_features() -> frozenset[str]:
    from llvmlite import binding

    has: Any = binding.get_host_cpu_features()
    return frozenset(name for name, there in has.items() if there)
