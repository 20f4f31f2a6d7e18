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

EXTENDS_NUMBA = True  # kernels hold the text of this module as their content (compiled/content.py)
_VEC4 = ir.VectorType(ir.DoubleType(), 4)


def row_pointer(context: Any, builder: Any, kind: Any, array: Any, at: Any) -> Any:
    """Pointer to four doubles of an array."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [at]), _VEC4.as_pointer())


def _made(combine: Callable[[Any, Any, Any], Any]) -> Any:
    """An intrinsic f(to, at, source, of): four places of `to` get combine(what is there, what comes)."""

    def typed(typingctx: Any, to: Any, at: Any, source: Any, of: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            kinds = signature.args
            into = row_pointer(context, builder, kinds[0], args[0], args[1])
            come = builder.load(row_pointer(context, builder, kinds[2], args[2], args[3]), align=8)
            builder.store(combine(builder, into, come), into, align=8)
            return context.get_dummy_value()

        return types.void(to, types.intp, source, types.intp), codegen

    return intrinsic(typed)


copy4 = _made(lambda builder, into, come: come)
add4 = _made(lambda builder, into, come: builder.fadd(builder.load(into, align=8), come))
subtract4 = _made(lambda builder, into, come: builder.fsub(builder.load(into, align=8), come))


def _filled(builder: Any, value: Any) -> Any:
    """A register with one number at all four places."""
    one = builder.insert_element(ir.Constant(_VEC4, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(ir.IntType(32), 4), [0, 0, 0, 0]))


def _fill(typingctx: Any, to: Any, at: Any, value: Any) -> Any:
    """Put one number at four places."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        into = row_pointer(context, builder, signature.args[0], args[0], args[1])
        builder.store(_filled(builder, args[2]), into, align=8)
        return context.get_dummy_value()

    return types.void(to, types.intp, types.float64), codegen


def _difference(typingctx: Any, to: Any, at: Any, source: Any, j: Any, i: Any) -> Any:
    """Put the way from row i to row j at `at`, three differences, and the sum of what is fourth in both."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        kinds = signature.args
        of_j, of_i = (
            builder.load(row_pointer(context, builder, kinds[2], args[2], k), align=8) for k in args[3:]
        )
        signs = ir.Constant(_VEC4, [-1.0, -1.0, -1.0, 1.0])
        way = builder.fadd(of_j, builder.fmul(signs, of_i))
        builder.store(way, row_pointer(context, builder, kinds[0], args[0], args[1]), align=8)
        return context.get_dummy_value()

    return types.void(to, types.intp, source, types.intp, types.intp), codegen


fill4: Any = intrinsic(_fill)
difference4: Any = intrinsic(_difference)


class Vec4(types.Type):
    """Four doubles in one register: what a law does to a number it does to each of them."""

    def __init__(self) -> None:
        super().__init__(name="Four")


VEC4 = Vec4()


@register_model(Vec4)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VEC4)


def _as_vec4(builder: Any, kind: Any, value: Any) -> Any:
    """A register of four, a number at all four places of one."""
    return value if isinstance(kind, Vec4) else _filled(builder, value)


def _made_operator(operation: Any, name: str) -> None:
    """Let `operation` take registers of four, and numbers beside them."""

    class Typed(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            if any(isinstance(a, Vec4) for a in args):
                return signature(VEC4, *(a if isinstance(a, Vec4) else types.float64 for a in args))
            return None

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        a, b = (_as_vec4(builder, kind, value) for kind, value in zip(sig.args, args, strict=True))
        return getattr(builder, name)(a, b)

    register: Any = infer_global(operation)
    register(Typed)
    for kinds in ((Vec4, Vec4), (Vec4, types.Float), (types.Float, Vec4)):
        lower_builtin(operation, *kinds)(codegen)


for _operation, _name in (
    (operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"), (operator.truediv, "fdiv"),
):  # fmt: skip
    _made_operator(_operation, _name)


def _read(typingctx: Any, array: Any, at: Any) -> Any:
    """The row of four at `at`."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(row_pointer(context, builder, signature.args[0], args[0], args[1]), align=8)

    return VEC4(array, types.intp), codegen


def _write(typingctx: Any, array: Any, at: Any, row: Any) -> Any:
    """Put a row of four at `at`."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[2], row_pointer(context, builder, signature.args[0], args[0], args[1]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, row), codegen


def _vec4_of(typingctx: Any, x: Any, y: Any, z: Any, last: Any) -> Any:
    """Four numbers as one register."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        row = ir.Constant(_VEC4, ir.Undefined)
        for k, value in enumerate(args):
            row = builder.insert_element(row, value, ir.Constant(ir.IntType(32), k))
        return row

    return VEC4(*(types.float64,) * 4), codegen


def _component(typingctx: Any, row: Any, k: Any) -> Any:
    """Number k of the four."""
    place = k.literal_value

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.extract_element(args[0], ir.Constant(ir.IntType(32), place))

    return types.float64(row, k), codegen


def _with_fourth(typingctx: Any, row: Any, value: Any) -> Any:
    """The same row with another fourth number."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.insert_element(args[0], args[1], ir.Constant(ir.IntType(32), 3))

    return VEC4(row, types.float64), codegen


read4: Any = intrinsic(_read)
write4: Any = intrinsic(_write)
vec4_of: Any = intrinsic(_vec4_of)
component: Any = intrinsic(prefer_literal=True)(_component)
with_fourth: Any = intrinsic(_with_fourth)
