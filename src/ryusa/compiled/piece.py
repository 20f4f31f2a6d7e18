"""Pieces: compiled code that a kernel calls by its address, and so is not compiled anew with each of them.

A kernel takes the address of a piece as an argument, whose type says what the piece takes and returns. Arrays
are lent: their owner keeps a tuple of them, and the piece reads it at its address, in place of some hundred
words that each call would copy.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Any

from llvmlite import ir
from numba.core import cgutils
from numba.core import types as numba_types
from numba.core.pythonapi import unbox
from numba.core.typing.templates import Signature
from numba.extending import NativeValue, intrinsic, models, register_model

from ryusa.compiled.borrow import borrowed

EXTENDS_NUMBA = True  # kernels hold the text of this module as their content (content.py)


class PieceType(numba_types.Type):  # type: ignore[misc]
    """Address of compiled code with this signature."""

    def __init__(self, signature: Signature) -> None:
        self.signature = signature
        super().__init__(name=f"Piece{signature}")  # all that tells it from others: a hash that Python keeps


class LentType(numba_types.Type):  # type: ignore[misc]
    """Address of a tuple of arrays that somebody else holds."""

    def __init__(self, of: Any) -> None:
        self.of = of
        super().__init__(name=f"Lent({of})")


register_model(PieceType)(models.OpaqueModel)
register_model(LentType)(models.OpaqueModel)


class Piece:
    """A piece for calls from kernels.

    Parameters
    ----------
    signature : what it takes and returns.
    find : returns the compiled piece; called when a kernel is called with it.
    """

    def __init__(self, signature: Signature, find: Callable[[], Any]) -> None:
        self._numba_type_, self._find = PieceType(signature), find

    @cached_property
    def address(self) -> int:
        """Of its machine code."""
        self._made = made = self._find()  # whoever has the address keeps the code
        if PieceType(made.signature) is not self._numba_type_:
            raise TypeError(f"a piece for {self._numba_type_} was compiled as {made.signature}")
        address = int(made.library.get_pointer_to_function(made.fndesc.mangled_name))
        assert address, made.fndesc.mangled_name
        return address


@unbox(PieceType)
def _unboxed(kind: Any, given: Any, c: Any) -> NativeValue:
    number = c.pyapi.object_getattr_string(given, "address")
    place = cgutils.alloca_once_value(c.builder, ir.Constant(cgutils.voidptr_t, None))
    failed = cgutils.is_null(c.builder, number)
    with c.builder.if_then(c.builder.not_(failed)):
        c.builder.store(c.pyapi.long_as_voidptr(number), place)
        c.pyapi.decref(number)
    return NativeValue(c.builder.load(place), is_error=failed)


def _lend(typingctx: Any, value: Any) -> Any:
    """Address of a tuple of arrays, which stay where they are until the function that lends returns."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        place = cgutils.alloca_once_value(builder, borrowed(builder, value, args[0]))
        return builder.bitcast(place, cgutils.voidptr_t)

    return LentType(value)(value), codegen


def _taken(typingctx: Any, lent: Any) -> Any:
    """The tuple of arrays at an address, known to the compiler to be borrowed: it counts no references."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        kind = context.get_value_type(signature.return_type)
        there = builder.load(builder.bitcast(args[0], kind.as_pointer()))
        return borrowed(builder, signature.return_type, there)

    return lent.of(lent), codegen


def _call(typingctx: Any, piece: Any, given: Any) -> Any:
    """What a piece returns for a tuple of arguments; none of them raises."""
    takes = piece.signature.args
    if len(given) != len(takes):
        raise TypeError(f"{piece} takes {len(takes)} arguments, not {len(given)}")
    for have, want in zip(given, takes, strict=True):
        if typingctx.can_convert(have, want) is None:
            raise TypeError(f"{piece} takes {want}, not {have}")

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        values = cgutils.unpack_tuple(builder, args[1])
        values = [
            context.cast(builder, value, have, want)
            for value, have, want in zip(values, given, takes, strict=True)
        ]
        convention, returns = context.call_conv, piece.signature.return_type
        kind = convention.get_function_type(returns, takes)
        places = [cgutils.alloca_once(builder, one.pointee, zfill=True) for one in kind.args[:2]]
        code = builder.bitcast(args[0], ir.PointerType(kind))
        builder.call(code, [*places, *context.get_arg_packer(takes).as_arguments(builder, values)])
        return context.get_returned_value(builder, returns, builder.load(places[0]))

    return piece.signature.return_type(piece, given), codegen


lend: Any = intrinsic(_lend)
taken: Any = intrinsic(_taken)
call: Any = intrinsic(_call)
