"""Functions that are compiled when a kernel needs them, and not before: Numba is loaded only then."""

from collections.abc import Callable
from functools import cached_property
from importlib import import_module
from typing import Any, TypeVar, cast

from ryusa.compiled.content import Compilable

F = TypeVar("F", bound=Callable[..., Any])

FAST = {"contract", "nsz"}  # fused multiply-add, sign of zero ignored; no flag that hides a NaN


class Compiled(Compilable):
    """A function that is compiled where it is called: into the kernel that calls it, or as one of its own."""

    def __call__(self, *given: Any) -> Any:
        """Call the compiled function, from the store or compiled now."""
        return self.entry(*given)

    @cached_property
    def entry(self) -> Any:
        """Numba's dispatcher for calls from Python."""
        from ryusa.compiled.dispatcher import Entry

        return Entry(self, self._plain())

    @cached_property
    def inner(self) -> Any:
        """Numba's dispatcher for calls from other kernels, into which the code is built."""
        from ryusa.compiled.dispatcher import Inner

        return Inner(self, self._plain())

    @cached_property
    def pieces(self) -> Any:
        """Numba's dispatcher for calls from kernels by address (piece.py)."""
        from ryusa.compiled.dispatcher import Pieces

        return Pieces(self, self._plain())

    @cached_property
    def on_card(self) -> Any:
        """numba-cuda's dispatcher for kernels of a card, which are compiled with options of their own."""
        dispatcher: Any = import_module("numba.cuda.dispatcher")
        return dispatcher.CUDADispatcher(
            self.py_func, self._plain() | {"device": True, "debug": False, "opt": True}
        )

    @property
    def _numba_type_(self) -> Any:
        """What Numba takes it for where a kernel calls it, on the processor or on a card."""
        from numba.core.target_extension import current_target

        return (self.on_card if current_target() == "cuda" else self.inner)._numba_type_


class Law(Compiled):
    """A scalar law: compiled into the kernels that call it, plain Python for everybody else.

    So a program that checks a case compiles nothing, nor do most measures. What Python refuses, a division by
    zero, the root of a negative number or an overflow, is left to the compiled law, which gives inf or nan.
    """

    def __init__(
        self, function: Callable[..., Any], options: dict[str, Any], here: Callable[..., Any] | None = None
    ) -> None:
        super().__init__(function, options)
        self._here = function if here is None else here

    def __call__(self, *given: Any) -> Any:
        """Evaluate the law."""
        for one in given:
            if type(one) is not float and hasattr(one, "item") and not getattr(one, "ndim", 0):
                given = tuple(
                    part.item() if hasattr(part, "item") and not part.ndim else part for part in given
                )
                break
        try:
            return self._here(*given)
        except (ZeroDivisionError, ValueError, OverflowError):
            return self.entry(*given)


def compiled(**options: Any) -> Callable[[F], F]:
    """Compile a function when it is first called. Typed as identity, so that the signature survives."""
    return lambda function: cast(F, Compiled(function, options))


def compiled_law(here: Callable[..., Any] | None = None, **options: Any) -> Callable[[F], F]:
    """Compile a law into its kernels; `here` is what Python calls in its place, if not the law as written."""
    return lambda function: cast(F, Law(function, options, here))
