"""Fuzz case files: in process, through the command line, or guided by coverage.

    python tests/faults/fuzz.py cases N SEED    # read, explained, laid out; or refused
    python tests/faults/fuzz.py cli N SEED      # `ryusa check`, a process each
    python tests/faults/fuzz.py guided SECONDS  # atheris on schema, units, results and resume

Each tells how many were used and refused and the slowest answer, and leaves with 1 where anything but a named
error came out, or an answer took more than 2 s of computing (so that a busy machine is no fault). Case files
are made by hypothesis (strange_cases.py).
"""

import contextlib
import json
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings

sys.path.insert(0, str(Path(__file__).parent))

from strange_cases import FILES, lay, strange_cases, strange_files

from ryusa.build import build
from ryusa.casefile import derive, explain, resolved
from ryusa.casefile.read import read
from ryusa.errors import CaseError

ANSWER = 2.0  # s
HANG = 20  # s
LAID_OUT = 20_000  # grains
RUN = "import sys; from ryusa.cli import main; main(sys.argv[1:])"


@dataclass
class Tally:
    """What came out."""

    outcomes: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0  # s of computing
    longest: float = 0.0  # s by the clock
    wrong: list[str] = field(default_factory=list)

    def took(self, seconds: float, clock: float, text: str) -> None:
        """Note how long an answer took, in computing and by the clock."""
        self.slowest, self.longest = max(self.slowest, seconds), max(self.longest, clock)
        if seconds > ANSWER:
            self.wrong.append(f"{seconds:.2f} s for:\n{text}")

    def said(self, what: str) -> int:
        """Print the figures; the exit code."""
        figures = ", ".join(f"{n} {name}" for name, n in sorted(self.outcomes.items()))
        print(
            f"{what}: {figures}; slowest {self.slowest:.2f} s of computing, "
            f"{self.longest:.2f} s by the clock; {len(self.wrong)} faults",
            flush=True,
        )
        for one in self.wrong[:10]:
            print("----", one, sep="\n", flush=True)
        return int(bool(self.wrong))


@contextlib.contextmanager
def alarm(seconds: int) -> Generator[None]:
    """Raise TimeoutError in what hangs."""

    def ring(number: int, frame: Any) -> None:
        raise TimeoutError(f"no answer in {seconds} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def answer(path: Path) -> str:
    """Do with a case file what `ryusa check` does, and look at all that comes out."""
    try:
        case = read(path)
        for row in explain(case):
            assert row.name
            assert isinstance(row.shown, str)
        json.dumps(resolved(case))
        derived = derive(case)
        if derived.n_grain + derived.n_fixed > LAID_OUT:
            return "read"
        built = build(case)
    except CaseError as error:
        assert 0 < len(str(error)) < 100_000
        return "refused"
    state = built.state
    there = state.present if len(state.present) else slice(None)  # grains that feeds will bring are nan
    assert np.isfinite(np.hstack([state.x, state.v, state.omega])[there]).all()
    assert built.scene.dt > 0.0
    return "laid out"


def _changed(files: Mapping[str, str]) -> str:
    """Files that are not as they were."""
    return "\n".join(f"{name}:\n{text}" for name, text in files.items() if text != FILES[name])


def judged(folder: Path, text: str, files: Mapping[str, str], tally: Tally) -> None:
    """One case file, in process."""
    path = lay(folder, text, files)
    begun, clock = time.process_time(), time.perf_counter()
    try:
        with alarm(HANG), warnings.catch_warnings():
            warnings.simplefilter("error")
            tally.outcomes[answer(path)] += 1
    except Exception as error:
        tally.outcomes["wrong"] += 1
        where = traceback.extract_tb(error.__traceback__)[-1]
        tally.wrong.append(
            f"{type(error).__name__}: {error} ({where.filename}, {where.lineno})\n{text}\n{_changed(files)}"
        )
    tally.took(time.process_time() - begun, time.perf_counter() - clock, text)


def cases(folder: Path, n: int, start: int) -> Tally:
    """So many case files in process."""
    tally, done = Tally(), [0]
    judged(folder, "title = 1\n[grains]\ndiameter = '1 cm'", FILES, Tally())  # loads units and laws

    while done[0] < n:

        @seed(start + done[0])
        @settings(
            max_examples=n - done[0], deadline=None, database=None, phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )  # fmt: skip
        @given(text=strange_cases(), files=strange_files())
        def one(text: str, files: dict[str, str]) -> None:
            done[0] += 1
            judged(folder, text, files, tally)

        one()
    return tally


def children() -> float:
    """Computing of the processes begun here that have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def cli(folder: Path, n: int, start: int) -> Tally:
    """So many case files through `ryusa check`, a process each."""
    tally, texts = Tally(), list[tuple[str, dict[str, str]]]()

    @seed(start)
    @settings(
        max_examples=n, deadline=None, database=None, phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    @given(text=strange_cases(), files=strange_files())
    def one(text: str, files: dict[str, str]) -> None:
        texts.append((text, files))

    one()
    for text, files in texts[:n]:
        path = lay(folder, text, files)
        begun, clock = children(), time.perf_counter()
        words = [sys.executable, "-c", RUN, "check", str(path)]
        try:
            done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=HANG)
        except subprocess.TimeoutExpired:
            tally.wrong.append(f"no answer in {HANG} s:\n{text}")
            continue
        taken, waited = children() - begun, time.perf_counter() - clock
        tally.outcomes[{0: "explained", 2: "refused"}.get(done.returncode, "wrong")] += 1
        if done.returncode not in {0, 2} or "Traceback" in done.stderr or "Warning" in done.stderr:
            tally.wrong.append(f"left with {done.returncode}:\n{done.stderr}\n{text}")
        elif done.returncode == 2 and not done.stderr.startswith("ryusa: "):
            tally.wrong.append(f"no named error:\n{done.stderr}\n{text}")
        tally.took(taken, waited, text)
    return tally


def main() -> None:
    """Read the command line."""
    how, n = sys.argv[1], int(sys.argv[2])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if how == "guided":
            from guided import guided

            sys.exit(guided(folder, n))
        kinds = {"cases": cases, "cli": cli}
        sys.exit(kinds[how](folder, n, int(sys.argv[3])).said(how))


if __name__ == "__main__":
    main()
