"""Parts of Numba that are replaced while ryusa compiles: to write less code, and to spend less on it.

All of it relies on private parts of Numba; tests/compiled tests each.
"""

import contextlib
import copy
import gc
from collections.abc import Generator
from typing import Any

import llvmlite.binding as llvm
from numba.core import bytecode
from numba.core.codegen import JITCodeLibrary, _parse_refprune_flags
from numba.core.compiler import Compiler, CompileResult
from numba.core.targetconfig import TargetConfig

from ryusa.compiled import processor
from ryusa.compiled.content import UnknownContentError, content_of, digest_of

_REFERENCES: Any = _parse_refprune_flags()  # Numba's own pass, which leaves out counts of references
_RARELY = 50_000, 20, 100  # thresholds of the garbage collector: a compiler makes many objects that all stay


class InlinedLibrary(JITCodeLibrary):
    """Code that is only ever built into other code: simplified, without machine code of its own.

    The rest is left to the code that it is built into, which is optimised as a whole. LLVM's higher levels
    would do harm here: they make a branch of the choice of one of two numbers, and a loop with such branches
    does not become vector instructions. Stock Numba escapes it by chance: emission undoes some of it.
    """

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout
        builder = self._codegen._pass_builder(opt=1)
        passes = builder.getFunctionPassManager()
        passes.add_refprune_pass(_REFERENCES)
        for function in ll_module.functions:
            passes.run(function, builder)

    def _optimize_final_module(self) -> None:
        """Build in what the functions call."""
        builder = self._codegen._pass_builder(opt=0, loop_vectorize=False, slp_vectorize=False)
        passes = builder.getModulePassManager()
        passes.add_refprune_pass(_REFERENCES)
        passes.run(self._final_module, builder)

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """There is nothing to call."""
        return 0


class InnerPipeline(Compiler):
    """Compiles a function that only kernels call."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.state.targetctx = without_code(self.state.targetctx)

    def compile_extra(self, func: Any) -> Any:
        """Compile into a library without machine code."""
        self.state.library = InlinedLibrary(self.state.targetctx.codegen(), func.__qualname__)
        return super().compile_extra(func)


def without_code(context: Any) -> Any:
    """The same context, where the entry point of a function is a mere key: nobody can call it from Python."""
    context = copy.copy(context)
    context.get_executable = lambda library, descriptor, environment: object()
    return context


def set_environments(made: Any) -> None:
    """Let compiled code find the environments of the functions that are built into it."""
    engine = made.codegen._engine
    for environment in made._find_referenced_environments():
        if engine.is_symbol_defined(environment.env_name):
            made.codegen.set_env(environment.env_name, environment)


def parts_of_inner(made: CompileResult) -> tuple[Any, ...]:
    """What is kept of a function that only kernels call: bitcode and its description."""
    made.fndesc.typemap = made.fndesc.calltypes = None
    code = made.library._get_module_for_linking().as_bitcode()
    return code, made.fndesc, made.environment, made.signature


def parts_of_entry(made: CompileResult) -> tuple[Any, ...]:
    """What is kept of a function that Python calls: machine code, its symbols and its description."""
    made.fndesc.typemap = made.fndesc.calltypes = None
    library = made.library
    symbols = [
        one.name
        for group in (library._final_module.functions, library._final_module.global_variables)
        for one in group
        if not one.is_declaration
    ]
    environments = tuple(made._find_referenced_environments())
    return (
        library._get_compiled_object(),
        symbols,
        made.fndesc,
        made.environment,
        made.signature,
        environments,
    )


def inner_of(context: Any, parts: tuple[Any, ...]) -> CompileResult:
    """A function that only kernels call, from what was kept of it."""
    code, descriptor, environment, signature = parts
    library: Any = InlinedLibrary(context.codegen(), descriptor.qualname)
    library._final_module = library._shared_module = llvm.parse_bitcode(code)
    library._finalized = True
    return _result(context, library, descriptor, environment, signature, object(), ())


def entry_of(context: Any, parts: tuple[Any, ...]) -> CompileResult:
    """A function that Python calls, from what was kept of it."""
    code, symbols, descriptor, environment, signature, environments = parts
    library: Any = JITCodeLibrary(context.codegen(), descriptor.qualname)
    library.enable_object_caching()
    library._set_compiled_object(code)
    library._finalize_final_module()
    context.codegen()._engine._defined_symbols.update(symbols)
    entry = context.get_executable(library, descriptor, environment)
    made = _result(context, library, descriptor, environment, signature, entry, environments)
    for one in environments:
        library.codegen.set_env(one.env_name, one)
    return made


def _result(
    context: Any,
    library: Any,
    descriptor: Any,
    environment: Any,
    signature: Any,
    entry: Any,
    environments: Any,
) -> CompileResult:
    return CompileResult(
        target_context=context,
        typing_context=context.typing_context,
        library=library,
        environment=environment,
        entry_point=entry,
        fndesc=descriptor,
        type_annotation=None,
        signature=signature,
        objectmode=False,
        lifted=(),
        typing_error=None,
        call_helper=None,
        metadata=None,
        reload_init=(),
        referenced_envs=environments,
    )


# ------------------------------------------------------------------------------------------ while it compiles

_plain_identity = bytecode.FunctionIdentity.from_function.__func__  # type: ignore[attr-defined]
_slow_equal, _slow_hash = TargetConfig.__eq__, TargetConfig.__hash__
_hashes: dict[type, int] = {}
_depth = 0


def _identity(kind: Any, function: Any) -> Any:
    """A function's identity, whose number is its content: Numba counts, each process in an order of its own.

    The number is part of the symbol. Kept code brings along what is built into it under the symbols of the
    process that compiled it; two functions that met under one symbol would be taken for one, and the linker
    keeps the first. The processor is in the number, too: code for another may be loaded beside (shipped.py).
    """
    made = _plain_identity(kind, function)
    try:
        made.unique_id = digest_of(content_of(function), *processor.own().key)[:24]
    except UnknownContentError:
        return made  # never kept
    made.unique_name = f"{made.func_qualname}${made.unique_id}"
    return made


def _equal(one: Any, other: Any) -> Any:
    if one is other or (type(one) is type(other) and one._values == other._values):
        return True
    return _slow_equal(one, other)


def _hash(one: Any) -> int:
    """The same number as Numba's, which is of the names of the options alone."""
    kind = type(one)
    if kind not in _hashes:
        _hashes[kind] = _slow_hash(one)
    return _hashes[kind]


@contextlib.contextmanager
def compiling() -> Generator[None]:
    """Name functions by their content, and spare Numba work that nobody asks for: a fifth of the time.

    Held under Numba's own lock. Left out are the two events that Numba reports for each of some 200,000 calls
    of LLVM, comparisons of options one by one, and most of the runs of the garbage collector.
    """
    global _depth  # noqa: PLW0603  (one compiler in a process, under one lock)
    if _depth:
        yield
        return
    _depth += 1
    options: Any = TargetConfig
    lock: Any = llvm.ffi.lib._lock
    thresholds, callbacks = gc.get_threshold(), list(lock._cblist)
    bytecode.FunctionIdentity.from_function = classmethod(_identity)  # type: ignore[assignment]
    options.__eq__, options.__hash__ = _equal, _hash
    lock._cblist.clear()
    gc.set_threshold(*_RARELY)
    try:
        yield
    finally:
        _depth -= 1
        gc.set_threshold(*thresholds)
        lock._cblist.extend(callbacks)
        options.__eq__, options.__hash__ = _slow_equal, _slow_hash
        bytecode.FunctionIdentity.from_function = classmethod(_plain_identity)  # type: ignore[assignment]
