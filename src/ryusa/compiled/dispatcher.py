"""Numba's dispatchers of a compiled function: one for kernels that call it, one for calls from Python."""

import pickle
from typing import Any

from numba.core import serialize, sigutils
from numba.core import types as numba_types
from numba.core.compiler import Compiler
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher

from ryusa.compiled import processor, store, tiers, waiting
from ryusa.compiled.content import Compilable, UnknownContentError, digest_of
from ryusa.compiled.numba_parts import (
    InnerPipeline,
    compiling,
    entry_of,
    inner_of,
    parts_of_entry,
    parts_of_inner,
    set_environments,
)
from ryusa.compiled.piece import LentType, Piece, PieceType

UNPICKLED = (
    pickle.UnpicklingError,
    AttributeError,
    ImportError,
    EOFError,
    IndexError,
    KeyError,
    TypeError,
    ValueError,
)


class _Kept:
    """What stands between a dispatcher and the store: as much of Numba's cache as a dispatcher asks for."""

    cache_path = ""

    def __init__(self, function: Compilable, kind: str) -> None:
        self._function, self._kind = function, kind

    def load_overload(self, signature: Any, context: Any) -> Any:
        """What the store has for these types; None where it is to be compiled."""
        rebuild = inner_of if self._kind == "inner" else entry_of
        for tier in tiers.in_order():
            key = self.key(signature, tier.processor)
            data = tier.load(key) if key else None
            if data is None:
                continue
            context.refresh()  # what loaded code calls of Numba is there only then
            try:
                return rebuild(context, pickle.loads(data))
            except UNPICKLED:  # of a class or module that is no longer there
                continue
        waiting.missed()
        return None

    def may_keep(self, signature: Any) -> bool:
        """Whether no store has code for these types, and the user's own takes it."""
        keys = [(tier, self.key(signature, tier.processor)) for tier in tiers.in_order()]
        return store.own().can_keep() and all(key and tier.load(key) is None for tier, key in keys)

    def save_overload(self, signature: Any, made: Any) -> None:
        """Keep what has been compiled; the store answers for disks that are full or closed."""
        key = self.key(signature, processor.own())
        if key is None:
            return
        if self._kind != "inner":
            set_environments(made)
        parts = parts_of_inner(made) if self._kind == "inner" else parts_of_entry(made)
        function = self._function
        about = {
            "name": function.name,
            "kind": self._kind,
            "seconds": round(waiting.own_seconds(), 3),
            "content": function.content[: waiting.DIGITS],
            "processor": processor.own().name,
        }
        store.own().save(key, about, serialize.dumps(parts))

    def key(self, signature: Any, of: "processor.Processor") -> str | None:
        """What names the code: content, types, versions and processor; None where content is unknown."""
        try:
            types, returned = sigutils.normalize_signature(signature)
            told = [_of_type(one) for one in (*types, returned)]
            return digest_of(self._kind, self._function.content, *told, *processor.versions(), *of.key)
        except UnknownContentError:
            return None

    def flush(self) -> None:
        """Nothing to do: what is kept is never changed."""


def _of_type(one: Any) -> Any:
    """A type of Numba in plain values."""
    if isinstance(one, numba_types.BaseTuple):
        parts: Any = one  # also iterates where the types are all alike
        fields, owner = getattr(one, "fields", ()), getattr(one, "instance_class", None)
        inside = [_of_type(part) for part in parts]
        return (
            "tuple",
            *((owner.__module__, owner.__qualname__) if owner else ()),
            tuple(fields),
            tuple(inside),
        )
    if isinstance(one, numba_types.Dispatcher):
        function = getattr(one.dispatcher, "function", None)
        if function is None:
            raise UnknownContentError(str(one))
        return ("function", function.content)
    if isinstance(one, LentType):
        return ("lent", _of_type(one.of))
    if isinstance(one, PieceType):
        return ("piece", *(_of_type(part) for part in (one.signature.return_type, *one.signature.args)))
    return (type(one), str(one))


class _Dispatcher(CPUDispatcher):  # type: ignore[misc]
    """Compiles a function of a kind, or loads it from a store."""

    kind: str
    without: tuple[str, ...] = ("no_cfunc_wrapper",)  # ways to call it that nobody takes
    pipeline: type[Compiler] = Compiler

    def __init__(self, function: Compilable, options: dict[str, Any]) -> None:
        options = options | dict.fromkeys(self.without, True)
        super().__init__(function.py_func, targetoptions=options, pipeline_class=self.pipeline)
        self.function, self._cache = function, _Kept(function, self.kind)

    def compile(self, sig: Any) -> Any:
        """Load or compile the code for these types."""
        with global_compiler_lock, compiling(), waiting.asked(self.function, self.kind):
            return super().compile(sig)


class Inner(_Dispatcher):
    """Compiles a function for the kernels that call it; it has no entry from Python."""

    kind = "inner"
    without = ("no_cpython_wrapper", "no_cfunc_wrapper")
    pipeline = InnerPipeline

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """The signature for these types: one for a number, be it a constant of the caller or not."""
        return super().get_call_template([numba_types.unliteral(one) for one in args], kws)

    def add_overload(self, cres: Any) -> None:
        """Note the code for kernels; Python cannot call it."""
        self.overloads[tuple(cres.signature.args)] = cres


class Pieces(_Dispatcher):
    """Compiles a function for kernels that call it by its address."""

    kind = "piece"
    without = Inner.without

    def may_keep(self, takes: Any) -> bool:
        """Whether the code for these types is in no store, and the user's own would take it."""
        return self._cache.may_keep(takes)

    def made(self, takes: Any) -> Any:
        """The code for these types."""
        self.compile(takes)
        return self.overloads[takes]

    def piece(self, *takes: Any) -> Piece:
        """The piece for arguments of these types."""
        made = self.made(takes)
        return Piece(made.signature, lambda: made)


class Entry(_Dispatcher):
    """Compiles a function for calls from Python, with all that it calls built into it."""

    kind = "entry"
