"""Prefetch: ask for a cache line before it is needed."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from ryusa.engine.cpu.simd.vec4 import row_pointer


def _prefetch(typingctx: Any, array: Any, at: Any) -> Any:
    """Ask for the line of memory that holds place `at`, to have it at hand soon."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        number, name = ir.IntType(32), "llvm.prefetch.p0i8"
        row = row_pointer(context, builder, signature.args[0], args[0], args[1])
        line = builder.bitcast(row, ir.IntType(8).as_pointer())
        kind = ir.FunctionType(ir.VoidType(), [line.type, number, number, number])
        function = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
        builder.call(function, [line, number(0), number(3), number(1)])  # to read, to keep, data
        return context.get_dummy_value()

    return types.void(array, types.intp), codegen


prefetch: Any = intrinsic(_prefetch)
