"""Functions that are compiled when a kernel needs them, and not before: Numba is loaded only then."""

import functools
from collections.abc import Callable
from functools import cached_property
from importlib import import_module
from typing import Any, TypeVar, cast

from ryusa.compiled.content import UnknownContentError, content_of, latest

F = TypeVar("F", bound=Callable[..., Any])

FAST = {"contract", "nsz"}  # fused multiply-add, sign of zero ignored; no flag that hides a NaN


class Compiled:
    """A function that is compiled where it is called: into the kernel that calls it, or as one of its own.

    Attributes
    ----------
    py_func : the function as written.
    options : options of Numba.
    name : module and name of the function.
    calls : compiled functions that its text names; known once its content is.
    """

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        functools.update_wrapper(self, function)
        self.py_func, self.options = function, options
        self.name = f"{function.__module__}.{function.__qualname__}"
        self.calls: list[Compiled] = []
        self._asked = False
        latest[self.name] = self

    def __call__(self, *given: Any) -> Any:
        """Call the compiled function, from the store or compiled now."""
        return self.entry(*given)

    def __repr__(self) -> str:
        return f"<compiled {self.name}>"

    @cached_property
    def content(self) -> str:
        """Digest of all that decides what is compiled (content.py).

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

    @property
    def keepable(self) -> bool:
        """Whether a store can hold it."""
        try:
            return bool(self.content)
        except UnknownContentError:
            return False

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
