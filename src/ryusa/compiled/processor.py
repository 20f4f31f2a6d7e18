"""What compiled code depends on beside its content: the processor, and the versions of the compiler."""

import importlib.util
import platform
import sys
from dataclasses import dataclass
from functools import cache
from typing import Any

_SWITCHES = (
    "OPT",
    "LOOP_VECTORIZE",
    "SLP_VECTORIZE",
    "DEBUGINFO_DEFAULT",
    "BOUNDSCHECK",
    "LLVM_REFPRUNE_FLAGS",
)


@dataclass(frozen=True)
class Processor:
    """A kind of processor, as LLVM names it.

    Attributes
    ----------
    triple : architecture and system.
    name : kind of processor.
    features : comma-separated, each with + or -; empty where the name says all.
    """

    triple: str
    name: str
    features: str

    @property
    def key(self) -> tuple[str, str, str]:
        """What a key holds of it."""
        return self.triple, self.name, self.features


@cache
def own() -> Processor:
    """The processor that Numba compiles for in this process."""
    from numba.core.registry import cpu_target

    context: Any = cpu_target.target_context
    triple, name, features = context.codegen().magic_tuple()
    return Processor(triple, name, features)


@cache
def versions() -> tuple[str, ...]:
    """Versions of Python's bytecode, of Numba, LLVM and numpy, and the switches that Numba compiles with.

    Of numpy the minor version: Numba has numpy's functions written anew and asks for no more.
    """
    import llvmlite
    import numba
    import numpy
    from numba.core import config

    found = [f"{one.__name__} {one.__version__}" for one in (numba, llvmlite)]
    found.append(f"numpy {'.'.join(numpy.__version__.split('.')[:2])}")
    switches = [f"{name} {getattr(config, name, None)}" for name in _SWITCHES]
    switches.append(f"svml {getattr(config, 'USING_SVML', None)}")
    python = f"{platform.python_implementation()} {sys.version_info.major}.{sys.version_info.minor}"
    return python, importlib.util.MAGIC_NUMBER.hex(), *found, *switches
