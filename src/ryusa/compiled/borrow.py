"""Arrays lent to a kernel: without the count of references that Numba keeps at every call of a function."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


def borrowed(builder: Any, kind: Any, value: Any) -> Any:
    """A value without the owners of its arrays, in the code that is being written."""
    if isinstance(kind, types.Array):
        owner = value.type.elements[0]
        return builder.insert_value(value, ir.Constant(owner, None), 0)
    if isinstance(kind, types.BaseTuple):
        parts: Any = kind
        for k, part in enumerate(parts):
            value = builder.insert_value(value, borrowed(builder, part, builder.extract_value(value, k)), k)
    return value


def _borrow(typingctx: Any, value: Any) -> Any:
    """The same array, or tuple of arrays, without an owner.

    Counting up and down is an atomic instruction each: a tenth of a step. Whoever lends has to hold the
    arrays until the borrower is done; the arguments of a call from Python are held by Python.
    """

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return borrowed(builder, signature.args[0], args[0])

    return value(value), codegen


borrow: Any = intrinsic(_borrow)
