"""Four doubles at once: rows of four are copied, added and taken off by whole vectors.

The compiler does not see by itself that a row of an array may be moved as one vector, since two arrays might
overlap. Rows lie at a flat place counted from the first element of an array, and are not checked.
"""

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

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


def _filled(builder: Any, value: Any) -> Any:
    """A register with one number at all four places."""
    one = builder.insert_element(ir.Constant(_FOUR, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(ir.IntType(32), 4), [0, 0, 0, 0]))


def _spread(typingctx: Any, to: Any, at: Any, value: Any) -> Any:
    """Put one number at four places."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        into = _row(context, builder, signature.args[0], args[0], args[1])
        builder.store(_filled(builder, args[2]), into, align=8)
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


class Four(types.Type):
    """Four doubles in one register: what a law does to a number it does to each of them."""

    def __init__(self) -> None:
        super().__init__(name="Four")


FOUR = Four()


@register_model(Four)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _FOUR)


def _as_four(builder: Any, kind: Any, value: Any) -> Any:
    """A register of four, a number at all four places of one."""
    return value if isinstance(kind, Four) else _filled(builder, value)


def _made_operator(operation: Any, name: str) -> None:
    """Let `operation` take registers of four, and numbers beside them."""

    class Typed(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            if any(isinstance(a, Four) for a in args):
                return signature(FOUR, *(a if isinstance(a, Four) else types.float64 for a in args))
            return None

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = (_as_four(builder, kind, value) for kind, value in zip(sig.args, args, strict=True))
        return getattr(builder, name)(a, b)

    register: Any = infer_global(operation)
    register(Typed)
    for kinds in ((Four, Four), (Four, types.Float), (types.Float, Four)):
        lower_builtin(operation, *kinds)(codegen)


for _operation, _name in (
    (operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"), (operator.truediv, "fdiv"),
):  # fmt: skip
    _made_operator(_operation, _name)


def _read(typingctx: Any, array: Any, at: Any) -> Any:
    """The row of four at `at`."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(_row(context, builder, signature.args[0], args[0], args[1]), align=8)

    return FOUR(array, types.intp), codegen


def _write(typingctx: Any, array: Any, at: Any, row: Any) -> Any:
    """Put a row of four at `at`."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[2], _row(context, builder, signature.args[0], args[0], args[1]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, row), codegen


def _four_of(typingctx: Any, x: Any, y: Any, z: Any, last: Any) -> Any:
    """Four numbers as one register."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        row = ir.Constant(_FOUR, ir.Undefined)
        for k, value in enumerate(args):
            row = builder.insert_element(row, value, ir.Constant(ir.IntType(32), k))
        return row

    return FOUR(*(types.float64,) * 4), codegen


def _part(typingctx: Any, row: Any, k: Any) -> Any:
    """Number k of the four."""
    place = k.literal_value

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.extract_element(args[0], ir.Constant(ir.IntType(32), place))

    return types.float64(row, k), codegen


def _with_last(typingctx: Any, row: Any, value: Any) -> Any:
    """The same row with another fourth number."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.insert_element(args[0], args[1], ir.Constant(ir.IntType(32), 3))

    return FOUR(row, types.float64), codegen


read4: Any = intrinsic(_read)
write4: Any = intrinsic(_write)
four_of: Any = intrinsic(_four_of)
part: Any = intrinsic(prefer_literal=True)(_part)
with_last: Any = intrinsic(_with_last)


def _ask(typingctx: Any, array: Any, at: Any) -> Any:
    """Ask for the line of memory that holds place `at`, to have it at hand soon."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        number, name = ir.IntType(32), "llvm.prefetch.p0i8"
        row = _row(context, builder, signature.args[0], args[0], args[1])
        line = builder.bitcast(row, ir.IntType(8).as_pointer())
        kind = ir.FunctionType(ir.VoidType(), [line.type, number, number, number])
        function = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
        builder.call(function, [line, number(0), number(3), number(1)])  # to read, to keep, data
        return context.get_dummy_value()

    return types.void(array, types.intp), codegen


ask: Any = intrinsic(_ask)
