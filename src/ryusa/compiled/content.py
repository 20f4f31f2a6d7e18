"""The content of a function: a digest of all that decides what is compiled from it.

Numba compiles bytecode, not text, and reads every global when it does. So the digest covers the bytecode of a
function, without names of files, lines and docstring, and the value of every global and closed-over variable
that it names, functions and constants of other modules included. Nothing else decides: not the place, the age
or the rest of a file.
"""

import ast
import dis
import hashlib
import math
import sys
from collections.abc import Callable, Iterable
from enum import Enum
from functools import cached_property, lru_cache, update_wrapper
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any, cast
from weakref import WeakValueDictionary

# Modules below these are covered by the versions in a key (store.py), so that a name says it all.
_VERSIONED = (
    "numba",
    "numpy",
    "llvmlite",
    "math",
    "builtins",
    "operator",
    "typing",
    "collections",
    "functools",
)
_LOAD_GLOBAL = dis.opmap["LOAD_GLOBAL"]
_PLAIN = (bool, int, str, bytes, type(None), type(Ellipsis))


latest: "WeakValueDictionary[str, Compilable]" = WeakValueDictionary()  # of each name, the function made last


class UnknownContentError(TypeError):
    """A function holds something that has no content: it is compiled in every process."""


class _Digest:
    """Feeds values into one hash, each behind its kind and length, so that no two feeds read alike."""

    def __init__(self) -> None:
        self.hash = hashlib.sha256()
        self.open: set[int] = set()  # functions whose content is being taken: a cycle is told by name
        self.called: list[Any] = []  # compiled functions met

    def put(self, kind: str, data: str | bytes) -> None:
        raw = data.encode() if isinstance(data, str) else data
        self.hash.update(f"{kind}:{len(raw)}:".encode())
        self.hash.update(raw)

    def values(self, kind: str, values: Iterable[Any]) -> None:
        listed = list(values)
        self.put(kind, str(len(listed)))
        for value in listed:
            self.value(value)

    def value(self, value: Any) -> None:
        """Put a global, a constant or a closed-over variable."""
        kind: Any = type(value)
        if isinstance(value, Enum):
            self.put("member", f"{_name(kind)}.{value.name}")
            self.value(value.value)
        elif kind is float:
            self.put("float", "nan" if math.isnan(value) else value.hex())
        elif kind in _PLAIN or kind is complex:
            self.put(kind.__name__, repr(value))
        elif kind is CodeType:
            self.code(value, {})
        elif isinstance(value, ModuleType):
            self.put("module", value.__name__)
        elif isinstance(value, Compilable):
            self.called.append(value)
            self.put("compiled", value.content)
        elif isinstance(value, FunctionType):
            self.function(value)
        elif isinstance(value, MethodType):
            self.put("method", _name(value))
            self.value(value.__self__)
        elif isinstance(value, type):
            self.type(value)
        elif isinstance(value, (tuple, list)):
            self.type(kind)
            self.values("of", value)
        elif isinstance(value, (set, frozenset)):
            self.values("set", sorted(value, key=repr))
        elif isinstance(value, BuiltinFunctionType) or kind.__name__ in {"ufunc", "_ArrayFunctionDispatcher"}:
            self.put("builtin", f"{getattr(value, '__module__', '')}.{value.__name__}")
        else:
            self.of_numba(value)

    def of_numba(self, value: Any) -> None:
        """Put what Numba, numpy and llvmlite make."""
        kind: Any = type(value)
        if hasattr(value, "py_func") and hasattr(value, "targetoptions"):  # compiled by Numba itself
            self.put("dispatcher", repr(sorted(value.targetoptions.items(), key=str)))
            self.function(value.py_func)
        elif kind.__name__ == "_Intrinsic":
            self.put("intrinsic", value._name)
            self.function(value._defn)
        elif kind.__module__.startswith("numpy") and hasattr(value, "tobytes"):
            self.put("array", f"{value.dtype.str}{value.shape}")
            self.put("bytes", value.tobytes())
        elif kind.__name__ == "_Undefined":  # llvmlite's one value of this name
            self.put("undefined", "")
        elif any(base.__module__.partition(".")[0] in {"numba", "llvmlite"} for base in kind.__mro__):
            text = str(value)
            if " at 0x" in text:  # a name of this process alone
                raise UnknownContentError(f"{text} has no content")
            self.put("name", f"{_name(kind)} {text}")
            self.extension(kind.__module__)
        else:
            raise UnknownContentError(f"{value!r}, a {_name(kind)}, has no content")

    def type(self, kind: type) -> None:
        """Put a class: its name, and what a kernel can ask of it."""
        self.put("class", _name(kind))
        if issubclass(kind, Enum):
            self.values("members", [part for one in kind for part in (one.name, one.value)])
        self.values("fields", getattr(kind, "_fields", ()))
        self.extension(kind.__module__)

    def extension(self, module: str) -> None:
        """Put the text of a module that teaches Numba new types: its rules have no name in what uses them."""
        known = sys.modules.get(module)
        if known is not None and getattr(known, "EXTENDS_NUMBA", False) and known.__file__:
            self.put("extension", text_of(Path(known.__file__)))

    def function(self, function: Any) -> None:
        """Put a function: by name where a version covers it, else all that it says."""
        self.put("function", _name(function))
        module = function.__module__ or ""  # what Numba writes itself is of no module
        if module.partition(".")[0] in _VERSIONED:
            self.code(function.__code__, {})
            for cell in function.__closure__ or ():
                self.put("cell", str(cell.cell_contents))
            return
        if id(function) in self.open:
            return
        self.open.add(id(function))
        self.extension(module)
        self.code(function.__code__, function.__globals__)
        self.values(
            "defaults", [*(function.__defaults__ or ()), *sorted((function.__kwdefaults__ or {}).items())]
        )
        for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
            self.put("cell", name)
            try:
                self.value(cell.cell_contents)
            except ValueError:  # not bound yet
                self.put("empty", "")
        self.open.discard(id(function))

    def code(self, code: CodeType, known: dict[str, Any]) -> None:
        """Put bytecode with its constants, and the globals that it names."""
        self.put("code", code.co_code)
        counts = (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags)
        self.put(
            "shape", repr((*counts, code.co_varnames, code.co_freevars, code.co_cellvars, code.co_names))
        )
        self.put("table", getattr(code, "co_exceptiontable", b""))
        constants = list(code.co_consts)
        if constants and isinstance(constants[0], str):
            constants[0] = None  # the docstring
        for constant in constants:
            if isinstance(constant, CodeType):
                self.code(constant, known)
            else:
                self.value(constant)
        asked = [known[name] for name in _globals_of(code) if isinstance(known.get(name), ModuleType)]
        for name in _globals_of(code):
            if name in known:
                self.put("global", name)
                self.value(known[name])
        for module in asked:  # B.LANES: what a module may be asked for
            for name in code.co_names:
                if hasattr(module, name):
                    self.put("attribute", f"{module.__name__}.{name}")
                    self.value(getattr(module, name))


def _globals_of(code: CodeType) -> list[str]:
    """Names that bytecode reads as globals, in the order of their first use."""
    found: dict[str, None] = {}
    more = 0
    raw = code.co_code
    for operation, low in zip(raw[::2], raw[1::2], strict=True):
        argument = low | more
        more = argument << 8 if operation == dis.EXTENDED_ARG else 0
        if operation == _LOAD_GLOBAL:
            found[code.co_names[argument >> 1]] = None  # the lowest bit says whether it is called
    return list(found)


def _name(thing: Any) -> str:
    return f"{getattr(thing, '__module__', '')}.{getattr(thing, '__qualname__', type(thing).__name__)}"


def content_of(function: Callable[..., Any], *more: Any, called: list[Any] | None = None) -> str:
    """Digest of a function and of all that it calls and reads, as hexadecimal digits.

    Compiled functions that it may call, though not those that these call, are added to `called`.

    Raises
    ------
    UnknownContentError : it names something of which nobody can say whether it has changed.
    """
    digest = _Digest()
    digest.values("more", more)
    digest.called = digest.called if called is None else called
    digest.function(function)
    return digest.hash.hexdigest()


class Compilable:
    """A function to be compiled, known by its content.

    Attributes
    ----------
    py_func : the function as written.
    options : options of Numba.
    name : module and name of the function.
    calls : compiled functions that its text names; known once its content is.
    """

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        update_wrapper(cast(Any, self), function)
        self.py_func, self.options = function, options
        self.name = f"{function.__module__}.{function.__qualname__}"
        self.calls: list[Compilable] = []
        self._asked = False
        latest[self.name] = self

    def __repr__(self) -> str:
        return f"<compiled {self.name}>"

    @cached_property
    def content(self) -> str:
        """Digest of all that decides what is compiled.

        Raises
        ------
        UnknownContentError : it holds something of which nobody can say whether it has changed.
        """
        if self._asked:
            raise UnknownContentError(f"{self!r} calls itself")
        self._asked = True
        try:
            return content_of(self.py_func, *sorted(self._plain().items()), called=self.calls)
        finally:
            self._asked = False

    def _plain(self) -> dict[str, Any]:
        """Options of Numba, those that are on by default included.

        A function has no `fastmath` and is not inlined by force unless the options say so. Numba would take
        both from the function that calls it first, and keep the result for all callers: the last bits would
        depend on what ran before on the machine. Inlining matters even where there is no `fastmath`:
        where the same product stands in a function and in a caller that fuses its own, LLVM makes one of the
        two, which is then not fused. With `error_model="numpy"` a division by zero gives inf or nan.
        """
        more = {"nopython": True, "error_model": "numpy", "fastmath": False, "forceinline": False}
        return more | self.options


def digest_of(*values: Any) -> str:
    """Digest of plain values."""
    digest = _Digest()
    digest.values("values", values)
    return digest.hash.hexdigest()


@lru_cache(maxsize=64)
def text_of(file: Path) -> str:
    """Digest of what a file says, without comments, layout and docstrings."""
    tree = ast.parse(file.read_bytes())
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.Module)) and ast.get_docstring(
            node, clean=False
        ):
            node.body = node.body[1:] or [ast.Pass()]
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest()
