"""What a run will cost before it starts: steps, frames, bytes, seconds."""

import math

from ryusa.casefile.schema import Case

BYTES_PER_GRAIN = 112  # of a frame: x, v, omega and what ParaView needs beside them
BYTES_PER_FRAME = 8192  # headers of one write-once part
MEMORY_PER_GRAIN = 1000  # bytes while running
SECONDS_PER_STEP = 1.0e-6  # of any step, and per grain in it, on one core of an ordinary machine
SECONDS_PER_GRAIN = 1.0e-7
SECONDS_PER_SALTATION = 0.15  # simulated, where only a number of saltations ends the run
SECONDS_TO_REST = 10.0  # simulated, where only rest ends it


def time_expected(case: Case) -> tuple[float, str]:
    """Simulated time at most [s], and where that number comes from."""
    found: list[tuple[float, str]] = []
    if case.stop.time is not None:
        found.append((case.stop.time, "stop.time"))
    if case.stop.saltations is not None:
        guess = case.record.settle + case.stop.saltations * SECONDS_PER_SALTATION
        found.append((guess, f"guess: settle + {SECONDS_PER_SALTATION} s per saltation"))
    if not found:
        found.append((SECONDS_TO_REST, f"guess: at rest within {SECONDS_TO_REST:g} s"))
    return min(found)


def steps_expected(case: Case) -> int:
    """Steps of the run at most, or by guess where only events end it."""
    return math.ceil(time_expected(case)[0] / case.derived.dt)


def frames_expected(case: Case) -> int:
    """Frames of the run at most, or by guess where only events end it."""
    return math.floor(time_expected(case)[0] / case.record.frames) + 2


def disk_needed(case: Case) -> int:
    """Bytes that the frames of a run will take; contact events come on top."""
    return frames_expected(case) * (case.derived.n_grain * BYTES_PER_GRAIN + BYTES_PER_FRAME)


def memory_needed(case: Case) -> int:
    """Bytes of memory the grains will take while running."""
    return (case.derived.n_grain + case.derived.n_fixed) * MEMORY_PER_GRAIN


def seconds_needed(case: Case) -> float:
    """Wall time by a rule of thumb [s], one core."""
    return steps_expected(case) * (SECONDS_PER_STEP + SECONDS_PER_GRAIN * case.derived.n_grain)
