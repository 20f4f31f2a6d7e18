"""Exceptions of ryusa. Each message states what is wrong, where, and how to correct it."""

from typing import Any


class RyusaError(Exception):
    """Base of all errors of ryusa; the command line prints the message and exits with `exit_code`."""

    exit_code = 2

    def __reduce__(self) -> tuple[Any, ...]:
        """As it is, not made anew from its message: errors go from process to process."""
        return _restored, (type(self), self.args, self.__dict__)


def _restored(kind: type[RyusaError], arguments: tuple[Any, ...], known: dict[str, Any]) -> RyusaError:
    error = kind.__new__(kind, *arguments)
    error.__dict__.update(known)
    return error


class CaseError(RyusaError):
    """A case that cannot be run: names the key path, the value, what is allowed and the nearest known key.

    All faults of a file are reported together: `others` holds those after the first.
    """

    def __init__(
        self,
        key: str,
        value: object,
        allowed: str,
        nearest: str | None = None,
        *,
        others: "tuple[CaseError, ...]" = (),
        source: str | None = None,
    ) -> None:
        self.key, self.value, self.allowed, self.nearest = key, value, allowed, nearest
        self.others, self.source = others, source
        lines = [self.line, *(other.line for other in others)]
        head = f"{source}: " if source else ""
        if others:
            text = f"{head}{len(lines)} faults\n" + "\n".join(f"  {line}" for line in lines)
        else:
            text = head + lines[0]
        super().__init__(text)

    @property
    def line(self) -> str:
        """The first fault alone, on one line."""
        text = (
            f"{self.key}: {self.allowed}"
            if self.value is None
            else f"{self.key} = {self.value!r}: {self.allowed}"
        )
        return f"{text}. Did you mean '{self.nearest}'?" if self.nearest else text

    @classmethod
    def together(cls, faults: "list[CaseError]", source: str | None = None) -> "CaseError":
        """One error for all faults of a file; `source` names the file."""
        first = faults[0]
        return cls(
            first.key, first.value, first.allowed, first.nearest, others=tuple(faults[1:]), source=source
        )


class ParseError(RyusaError):
    """A file that cannot be read as what it should be: names file, line, column and what was expected."""

    def __init__(self, name: str, line: int, column: int, expected: str) -> None:
        self.name, self.line, self.column, self.expected = name, line, column, expected
        super().__init__(f"{name}:{line}:{column}: {expected}")


class ResultsError(RyusaError):
    """A run folder that cannot be read or written."""


class DiskFull(ResultsError):
    """The disk of the run folder is full."""

    exit_code = 3


class CheckpointError(ResultsError):
    """A checkpoint from which the run cannot be resumed: damaged, of another run or of another version."""


class RunError(RyusaError):
    """An invalid state while stepping: names grain, partner, step and time, and a remedy."""

    exit_code = 3

    def __init__(
        self, cause: str, *, grain: int, step: int, t: float, hint: str, partner: int | None = None,
        surface: str = "",
    ) -> None:  # fmt: skip
        self.cause, self.grain, self.step, self.t, self.hint = cause, grain, step, t, hint
        self.partner, self.surface = partner, surface  # the name of the plane or wall that the partner is
        pair = f" with {surface}" if surface else "" if partner is None else f" with partner {partner}"
        super().__init__(f"{cause}: grain {grain}{pair}, step {step}, t = {t:.6g} s. {hint}")


class NotANumber(RunError):
    """A force, position or velocity is not finite."""


class GrainLost(RunError):
    """A grain left the domain."""


class OverlapTooLarge(RunError):
    """The overlap of two grains exceeds the limit."""


class GrainThroughWall(RunError):
    """The centre of a grain went through a face of a wall, which then would push it on."""


class ListUnsafe(RunError):
    """A grain moved further in one step than the Verlet list allows."""


class ContactSlotsFull(RunError):
    """A fixed buffer of contacts is full and cannot grow."""


class EnergyCreated(RunError):
    """The energy account does not close: the grains gained energy that no force supplied."""


class WallLost(RyusaError):
    """A wall that a servo presses has gone too far: states wall, distance and force, step and remedy."""

    exit_code = 3

    def __init__(self, cause: str, step: int, t: float, hint: str) -> None:
        self.cause, self.step, self.t, self.hint = cause, step, t, hint
        super().__init__(f"{cause}: step {step}, t = {t:.6g} s. {hint}")


class WaterError(RyusaError):
    """The column of water cannot be stepped further: states cause, step and remedy."""

    exit_code = 3

    def __init__(self, cause: str, *, step: int, t: float, hint: str) -> None:
        self.cause, self.step, self.t, self.hint = cause, step, t, hint
        super().__init__(f"{cause}: step {step} of the water, t = {t:.6g} s. {hint}")
