"""What a run will cost before it starts: steps, frames, bytes, seconds."""

import math
import shutil

from ryusa.casefile.builders.schema import BoxSection, FillSection, FlumeSection, FromFile, PackingSection
from ryusa.casefile.case import Case
from ryusa.casefile.contact.values import timing
from ryusa.casefile.facts import Derived
from ryusa.casefile.record.schema import RecordSection
from ryusa.casefile.record.values import MANY, events_of
from ryusa.casefile.row.values import water_alone
from ryusa.casefile.rows import ExplainRow, Flag, count, number, word
from ryusa.casefile.wall_time import cells_of_row, steps_expected, time_expected, wall_time, wall_time_by_rule
from ryusa.laws.families import ContactTiming
from ryusa.model.contacts import N_EVENT

BYTES_PER_GRAIN = 80  # of a frame: x, v, omega, image
BYTES_OF_FORCES = 120  # per grain and frame where forces are recorded: three contacts of 40 bytes
BYTES_PER_FRAME = 272  # t, step, offset for ParaView and tally
BYTES_OF_ROW = 8 * 4  # of a cell of a row of columns and frame: two speeds, water, concentration
BYTES_PER_RUN = 100_000  # headers of the parts, log, summary, bed
# Memory, measured (design/lab/0008-memory-of-a-run.md) [B]:
MEMORY_PER_RUN = 219_000_000  # Python, its packages and the compiled code
MEMORY_PER_GRAIN = 600  # scene, state, Verlet list, one frame; a checkpoint is written in less
MEMORY_PER_FIXED = 350
MEMORY_IN_COLUMN = 850  # of a grain on top, in a column of water
MEMORY_PER_CONTACT = 100
MEMORY_WITH_TIMING = 100  # of a contact on top, where contacts begin and end within steps
WRITING = 2.1  # copies of a part while it is written: HDF5 in memory, and its bytes
HELD_MOST = 64 << 20  # frames and contacts that wait to be written
FASTER = 3.0  # than the rule of thumb: so much sooner may frames come
HELD_SHORTEST, HELD_SHARE, HELD_LONGEST = 2.0, 0.01, 60.0  # s, of the time so far, s: as the recorder flushes
SETTLED, SETTLED_PLANE, IN_FLOW, APART = 2.1, 1.6, 1.5, 0.1  # contacts per free grain, the most in a run
BYTES_PER_EVENT = 8 * N_EVENT
EVENTS_ALONE = 20.0  # contacts that end per second, of a saltating or dropped grain
EVENTS_DENSE = 20.0  # of a grain among others, per sqrt(d/g); between 3 and 50 where counted


def frames_expected(case: Case) -> int:
    """Frames of the run at most, or by guess where only events end it."""
    return math.floor(time_expected(case.stop, case.record)[0] / case.record.frames) + 2


def bytes_per_grain(record: RecordSection) -> int:
    """Bytes of one grain in a frame."""
    return BYTES_PER_GRAIN + BYTES_OF_FORCES * record.forces


def disk_needed(case: Case, derived: Derived) -> int:
    """Bytes that the frames of a run will take; contacts recorded come on top."""
    return frames_expected(case) * (_frame(case, derived) + BYTES_PER_FRAME) + BYTES_PER_RUN


def events_expected(case: Case, derived: Derived) -> int:
    """Contacts recorded, by a rule of thumb."""
    kept, n = events_of(case), derived.n_sphere
    if kept == "tracked":
        n = len(set(case.record.tracked))
    rate = EVENTS_ALONE
    dense = isinstance(case.build, PackingSection | FlumeSection | FromFile | BoxSection | FillSection)
    if (dense or case.feeds) and derived.meet:
        rate = max(rate, EVENTS_DENSE * math.sqrt(derived.g / derived.d))
    return 0 if kept == "none" else math.ceil(n * rate * time_expected(case.stop, case.record)[0])


def disk_for_events(case: Case, derived: Derived) -> int:
    """Bytes that the contacts recorded will take, by a rule of thumb."""
    return events_expected(case, derived) * BYTES_PER_EVENT


def disk_in_all(case: Case, derived: Derived) -> int:
    """Bytes that a run will take on the disk; `ryusa run` refuses what does not fit."""
    return disk_needed(case, derived) + disk_for_events(case, derived)


def free_here() -> int:
    """Free space on the disk of the current folder [B]."""
    return shutil.disk_usage(".").free


def contacts_expected(case: Case, derived: Derived) -> float:
    """Contacts per free grain at most, by counts in packaged cases."""
    if not derived.meet:
        return APART
    if case.motion.plane:
        return SETTLED_PLANE
    return SETTLED if case.water is None else IN_FLOW


def memory_of_grains(
    n_grain: int, n_fixed: int, contacts: float, timed: ContactTiming, column: bool
) -> float:
    """Bytes that grains take at rest, with one frame of them; within 5 % (design/lab/0008).

    Parameters
    ----------
    n_grain, n_fixed : free and fixed grains.
    contacts : per free grain [-].
    timed : timing of contacts.
    column : whether they are in a column of water, or in a row of such.
    """
    each = MEMORY_PER_GRAIN + (MEMORY_IN_COLUMN if column else 0)
    contact = MEMORY_PER_CONTACT + (MEMORY_WITH_TIMING if timed is ContactTiming.EXACT else 0)
    return n_grain * (each + contacts * contact) + n_fixed * MEMORY_PER_FIXED


def held_back(case: Case, derived: Derived) -> float:
    """Bytes of frames and contacts that wait to be written, one frame at least."""
    seconds = wall_time_by_rule(case, derived).seconds
    interval = min(max(HELD_SHORTEST, HELD_SHARE * seconds), HELD_LONGEST)
    whole = frames_expected(case) * _frame(case, derived) + disk_for_events(case, derived)
    return max(_frame(case, derived), min(whole * min(FASTER * interval / seconds, 1.0), HELD_MOST))


def _frame(case: Case, derived: Derived) -> int:
    """Bytes of one frame."""
    return derived.n_sphere * bytes_per_grain(case.record) + BYTES_OF_ROW * cells_of_row(case)


def memory_needed(case: Case, derived: Derived) -> int:
    """Bytes of memory that a run will take at most, on any number of threads.

    Notes
    -----
    Beside program, grains and contacts it holds frames that wait to be written, and copies of them while
    they are.
    """
    more = held_back(case, derived) - _frame(case, derived)  # one is in the memory of the grains
    column = case.water is not None and case.water.profile == "column"
    contacts = contacts_expected(case, derived)
    grains = memory_of_grains(derived.n_sphere, derived.n_fixed, contacts, timing(case), column)
    return round(MEMORY_PER_RUN + grains + (1.0 + WRITING) * more)


def cost_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Steps, frames, disk, memory and wall time."""
    simulated, origin = time_expected(case.stop, case.record)
    disk, took = disk_needed(case, derived), wall_time(case, derived)
    memory, contacts = memory_needed(case, derived), contacts_expected(case, derived)
    alone = water_alone(case)
    held = "of the program; a first run compiles its laws and takes up to 0.4 GB more"
    held = (
        held
        if alone
        else (
            f"at most, on any number of threads: {human(MEMORY_PER_RUN)} for the program, grains with "
            f"{contacts:g} contacts each, {human(held_back(case, derived))} not yet written, and what is "
            "being written; a first run compiles its laws and takes up to 0.4 GB more"
        )
    )
    return [
        number("cost", "simulated time", simulated, "s", origin),
        count("cost", "steps", steps_expected(case.stop, case.record, derived), "simulated time over dt"),
        count("cost", "frames", frames_expected(case), f"one every {case.record.frames:g} s (record.frames)"),
        _size(
            "disk for frames",
            disk,
            "speeds and water in the cells"
            if alone
            else "positions, velocities and spins of the free grains",
        ),
        *([] if alone else _events(case, derived)),
        *_disk(case, derived),
        _size("memory", memory, held),
        ExplainRow("cost", "wall time", took.seconds, "s", str(took), took.origin),
    ]


def _events(case: Case, derived: Derived) -> list[ExplainRow]:
    kept, asked = events_of(case), case.record.events
    origin = "record.events"
    if asked is None:
        origin = f"record.events not given: all with up to {MANY} free grains or where saltations end the run"
    rows = [word("cost", "contacts recorded", kept, origin, "" if asked else "note")]
    if kept != "none":
        contacts = f"about {events_expected(case, derived):,} contacts, rule of thumb"
        rows.append(_size("disk for events", disk_for_events(case, derived), contacts))
    return rows


def _disk(case: Case, derived: Derived) -> list[ExplainRow]:
    """Disk needed in all, where more is needed than is free."""
    needed, free = disk_in_all(case, derived), free_here()
    if needed <= free:
        return []
    origin = f"frames and events, but only {human(free)} are free in this folder: `ryusa run` will refuse"
    return [_size("disk in all", needed, origin, "warning")]


def _size(name: str, size: int, origin: str, flag: Flag = "") -> ExplainRow:
    return ExplainRow("cost", name, size, "B", human(size), origin, flag)


def human(size: float) -> str:
    """Bytes as a person writes them.

    >>> human(2_500_000)
    '2.5 MB'
    """
    for unit in ("B", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.3g} TB"
