"""Four doubles at once: rows of four are copied, added and taken off by whole vectors.

The compiler does not see by itself that a row of an array may be moved as one vector, since two arrays might
overlap. Rows lie at a flat place counted from the first element of an array, and are not checked.
"""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

_FOUR = ir.VectorType(ir.DoubleType(), 4)


def _row(context: Any, builder: Any, kind: Any, array: Any, at: Any) -> Any:
    """Pointer to four doubles of an array."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [at]), _FOUR.as_pointer())


def _made(combine: Callable[[Any, Any, Any], Any]) -> Any:
    """An intrinsic f(to, at, source, of): four places of `to` get combine(what is there, what comes)."""

    def typed(typingctx: Any, to: Any, at: Any, source: Any, of: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            kinds = signature.args
            into = _row(context, builder, kinds[0], args[0], args[1])
            come = builder.load(_row(context, builder, kinds[2], args[2], args[3]), align=8)
            builder.store(combine(builder, into, come), into, align=8)
            return context.get_dummy_value()

        return types.void(to, types.intp, source, types.intp), codegen

    return intrinsic(typed)


copy4 = _made(lambda builder, into, come: come)
add4 = _made(lambda builder, into, come: builder.fadd(builder.load(into, align=8), come))
take4 = _made(lambda builder, into, come: builder.fsub(builder.load(into, align=8), come))


def _spread(typingctx: Any, to: Any, at: Any, value: Any) -> Any:
    """Put one number at four places."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        lane = ir.Constant(ir.VectorType(ir.IntType(32), 4), [0, 0, 0, 0])
        one = builder.insert_element(
            ir.Constant(_FOUR, ir.Undefined), args[2], ir.Constant(ir.IntType(32), 0)
        )
        into = _row(context, builder, signature.args[0], args[0], args[1])
        builder.store(builder.shuffle_vector(one, one, lane), into, align=8)
        return context.get_dummy_value()

    return types.void(to, types.intp, types.float64), codegen


def _apart(typingctx: Any, to: Any, at: Any, source: Any, j: Any, i: Any) -> Any:
    """Put the way from row i to row j at `at`, three differences, and the sum of what is fourth in both."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        kinds = signature.args
        of_j, of_i = (builder.load(_row(context, builder, kinds[2], args[2], k), align=8) for k in args[3:])
        signs = ir.Constant(_FOUR, [-1.0, -1.0, -1.0, 1.0])
        way = builder.fadd(of_j, builder.fmul(signs, of_i))
        builder.store(way, _row(context, builder, kinds[0], args[0], args[1]), align=8)
        return context.get_dummy_value()

    return types.void(to, types.intp, source, types.intp, types.intp), codegen


spread4: Any = intrinsic(_spread)
apart4: Any = intrinsic(_apart)
