"""Named errors. Every one says what is wrong, where, and what to do about it."""


class RyusaError(Exception):
    """Base of every error a user can meet; the CLI prints it in one block and exits with `exit_code`."""

    exit_code = 2


class CaseError(RyusaError):
    """A case that cannot be run: names the key path, the value, what is allowed and the nearest known key.

    A file with several faults is told at once: `others` holds the errors after the first.
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
        """One error that tells all faults of a file; `source` names the file."""
        first = faults[0]
        return cls(
            first.key, first.value, first.allowed, first.nearest, others=tuple(faults[1:]), source=source
        )


class ResultsError(RyusaError):
    """A run folder that cannot be read or written."""


class DiskFull(ResultsError):
    """No room left where the run writes."""

    exit_code = 3


class CheckpointError(ResultsError):
    """A checkpoint that cannot be gone on from: damaged, of another run, or not of this code."""


class RunError(RyusaError):
    """A number that went wrong while stepping: names grain, partner, step and time, and what to try."""

    exit_code = 3

    def __init__(
        self, cause: str, *, grain: int, step: int, t: float, hint: str, partner: int | None = None
    ) -> None:
        self.cause, self.grain, self.step, self.t, self.hint, self.partner = (
            cause,
            grain,
            step,
            t,
            hint,
            partner,
        )
        pair = "" if partner is None else f" with partner {partner}"
        super().__init__(f"{cause}: grain {grain}{pair}, step {step}, t = {t:.6g} s. {hint}")


class NotANumber(RunError):
    """A force, position or velocity is no longer finite."""


class GrainLost(RunError):
    """A grain left the world."""


class OverlapTooLarge(RunError):
    """Two partners reach into each other beyond the limit."""


class ListUnsafe(RunError):
    """A grain moved further in one step than the neighbour list allows for."""


class ContactSlotsFull(RunError):
    """A fixed buffer of contacts is full and could not grow."""


class EnergyCreated(RunError):
    """The energy account does not hold: the grains have what nobody gave."""


class WaterError(RyusaError):
    """The column of water cannot go on: says why, at which of its steps, and what to try."""

    exit_code = 3

    def __init__(self, cause: str, *, step: int, t: float, hint: str) -> None:
        self.cause, self.step, self.t, self.hint = cause, step, t, hint
        super().__init__(f"{cause}: step {step} of the water, t = {t:.6g} s. {hint}")
