"""What a run says while it compiles: what is compiled, about how much is left, and that it happens once."""

import threading
from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ryusa.casefile.row.values import water_alone
from ryusa.casefile.rows import ExplainRow
from ryusa.casefile.shape import has_clumps
from ryusa.compiled import waiting
from ryusa.model import Scene
from ryusa.running.progress import Progress

if TYPE_CHECKING:
    from ryusa.casefile.case import Case

_AFTER = 1.5  # s of a compilation before a word is said
_LOOK = 0.5  # s between two looks at what is compiled
_AGAIN, _STILL = 4.0, 30.0  # s between two lines: of something else, of the same
_ONCE = "compiling for this processor, once for this kind of case"

# Words of the field for entries and pieces, by the first characters of their names.
_WORDS = {
    "ryusa.engine.cpu.cell_list.": "neighbour list",
    "ryusa.engine.cpu.reorder.": "neighbour list",
    "ryusa.engine.cpu.block_exchange.": "neighbour list",
    "ryusa.engine.cpu.prune": "pruning of pairs",
    "ryusa.engine.cpu.block_forces.": "contacts",
    "ryusa.engine.cpu.integration.": "motion",
    "ryusa.engine.cpu.time_loop.": "steps in time",
    "ryusa.engine.cpu.rigid_bodies.": "clumps",
    "ryusa.engine.cpu.": "grains in memory",
    "ryusa.engine.shared.dashpots.": "springs and dashpots",
    "ryusa.engine.shared.skin.": "neighbour list",
    "ryusa.engine.shared.wall_pose.": "walls",
    "ryusa.engine.lammps.": "water on grains",
    "ryusa.water.eddies.": "eddies",
    "ryusa.water.row": "water along the stream",
    "ryusa.water.time_step.": "flow of the water",
    "ryusa.water.": "water and grains",
}
# Processor time [s] on one core of an AMD EPYC (Zen 5), with what is compiled within.
_OF_GRAINS = {
    "entry ryusa.engine.cpu.cell_list.build_list": 0.7,
    "piece ryusa.engine.cpu.prune.make_prune.<locals>.prune": 2.0,
    "piece ryusa.engine.cpu.block_forces.make_block_forces.<locals>.block_forces": 8.4,
    "piece ryusa.engine.cpu.integration.make_integrate.<locals>.integrate": 2.1,
    "entry ryusa.engine.cpu.prune.prune_blocks": 0.9,
    "entry ryusa.engine.cpu.time_loop.run": 1.9,
}
_OF_BODIES = {"piece ryusa.engine.cpu.rigid_bodies.make_move_bodies.<locals>.move_bodies": 2.0}
_OF_COLUMN = {
    "entry ryusa.water.exchange_step.water_at_grains": 1.8,
    "entry ryusa.water.exchange_step.exchange_step": 10.0,
}
_OF_ROW = {
    "entry ryusa.water.time_step.time_step": 6.7,
    "entry ryusa.water.row_step.advance_row": 7.2,
}
_OF_GRAINS_IN_ROW = {
    "entry ryusa.water.row_sums.sum_fixed_in_row": 2.0,
    "entry ryusa.water.row_exchange.continue_ends": 1.6,
    "entry ryusa.water.row_exchange.tell": 2.5,
    "entry ryusa.water.row_exchange.means_at_grains": 1.4,
    "entry ryusa.water.row_grain_sums.sum_grains_in_row": 2.9,
}


def words_of(name: str) -> str:
    """What a compiled function does, in words of the field; its own name where the table has none.

    >>> words_of("ryusa.engine.cpu.cell_list.build_list")
    'neighbour list'
    >>> words_of("mine.own")
    'own'
    """
    return next((words for first, words in _WORDS.items() if name.startswith(first)), name.rpartition(".")[2])


def expected_of(*, grains: bool, clumps: bool, column: bool, row: bool) -> dict[str, float]:
    """Functions of a run that take long to compile, with what each takes [s].

    Parameters
    ----------
    grains, clumps : whether there are any.
    column, row : whether the water is a column, or a row of such.
    """
    expected: dict[str, float] = {}
    if grains:
        expected |= _OF_GRAINS | (_OF_BODIES if clumps else {})
    if row:
        expected |= _OF_ROW | (_OF_GRAINS_IN_ROW if grains else {})
    elif column:
        expected |= _OF_COLUMN
    return expected


def compiling_row(case: "Case") -> ExplainRow:
    """Row of `ryusa check` of the time that compiling takes at most."""
    row = case.row is not None
    column = case.water is not None and case.water.profile == "column"
    expected = expected_of(
        grains=not water_alone(case), clumps=has_clumps(case.grains), column=column, row=row
    )
    seconds = waiting.at_most(expected)
    origin = "before the first step, once for this kind of case: what is kept of earlier runs takes none"
    return ExplainRow("cost", "compiling", seconds, "s", f"up to {_round(seconds)} s", origin)


@contextmanager
def compiling_told(progress: Progress, scene: Scene) -> Generator[None]:
    """Say in a progress what is compiled within this block, and nothing where nothing is."""
    teller = _Teller(progress)
    try:
        expected = expected_of(
            grains=scene.n_grain > 0, clumps=scene.bodies is not None,
            column=scene.column is not None, row=scene.row is not None,
        )  # fmt: skip
        with waiting.told(teller.heard, expected):
            yield
    finally:
        teller.end()


class _Teller:
    """Looks now and then at what is compiled; its thread lives while something is."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._name: str | None = None  # of the function that is compiled
        self._changed = threading.Event()
        self._thread: threading.Thread | None = None
        self._over = False
        self._began = waiting.done().wall
        self._line = 0.0  # [s] of compiling at which a line was written last; 0: none yet
        self._said = ""

    def heard(self, name: str | None) -> None:
        """Take note of what is compiled; None where it is done."""
        self._name = name
        if name is None:
            self._progress.go_on()
            return
        self._progress.pause()
        if self._thread is None:
            self._thread = threading.Thread(target=self._watch, name="ryusa compiling", daemon=True)
            self._thread.start()

    def end(self) -> None:
        """Stop looking."""
        self._over = True
        self._changed.set()
        if self._thread is not None:
            self._thread.join()

    def _watch(self) -> None:
        while not self._over:
            self._changed.wait(_LOOK)
            name = self._name
            if name is not None and not self._over:
                self.look(name, waiting.done().wall - self._began, waiting.left())

    def look(self, name: str, spent: float, left: float) -> None:
        """Show what is compiled after some seconds of compiling, and write a line where one is due."""
        if spent < _AFTER:
            return
        what = words_of(name)
        rest = f", about {_round(left)} s left" if left >= 1.0 else ""
        self._progress.busy(f"compiling: {what}{rest}")
        first = not self._said
        since = spent - self._line
        if first or (rest and since >= (_STILL if what == self._said else _AGAIN)):
            self._line, self._said = spent, what
            lead = f"{_ONCE}: " if first else "compiling: "
            self._progress.line(f"{lead}{what}{rest}", shown=first or self._progress.plain)


def _round(seconds: float) -> int:
    """Whole seconds, beyond 20 in steps of 5: an estimate is no better.

    >>> _round(7.4), _round(43.0)
    (7, 45)
    """
    return round(seconds) if seconds < 20.0 else 5 * round(seconds / 5.0)
