import io
from pathlib import Path
from typing import Any

import pytest

from ryusa.running.progress import Progress, ProgressNumbers


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def now() -> list[float]:
    return [0.0]


def make(path: Path, now: list[float], stream: io.StringIO, **more: Any) -> Progress:
    return Progress(path / "log.txt", shown=more.get("shown", True), stream=stream, clock=lambda: now[0])


def moment(share: float) -> ProgressNumbers:
    return ProgressNumbers(share=share, t=share * 10, rate=3e6, overlap=0.004, residual=1e-5, hops=3)


def test_lines_come_every_tenth_of_the_way_at_most_every_five_seconds(
    tmp_path: Path, now: list[float]
) -> None:
    stream = io.StringIO()
    progress = make(tmp_path, now, stream)
    for k in range(1000):
        now[0] = 0.1 * k
        if progress.due():
            progress.update(moment(k / 1000))
    progress.close()
    lines = stream.getvalue().splitlines()
    assert 8 <= len(lines) <= 11
    assert "3.00 M particle-steps/s" in lines[0]
    assert "saltations 3" in lines[0]
    assert "s left" in lines[0]
    assert (tmp_path / "log.txt").read_text().count("particle-steps/s") == len(lines)


@pytest.mark.parametrize("kind", [io.StringIO, Terminal])
def test_a_resumed_run_estimates_the_remaining_time_from_its_own_start(
    tmp_path: Path, now: list[float], kind: type[io.StringIO]
) -> None:
    progress = make(tmp_path, now, kind())
    now[0] = 1.0
    progress.start_at(0.5)
    now[0] = 7.0
    progress.update(moment(0.6))
    progress.close()
    assert "about 24 s left" in (tmp_path / "log.txt").read_text()


def test_at_first_the_remaining_time_follows_from_what_was_expected(tmp_path: Path, now: list[float]) -> None:
    progress = Progress(
        tmp_path / "log.txt", shown=False, expected=8000.0, stream=io.StringIO(), clock=lambda: now[0]
    )
    progress.start_at(0.5)
    for now[0], share in ((60.0, 0.5005), (120.0, 0.51)):
        progress.update(moment(share))
    progress.close()
    first, second = (tmp_path / "log.txt").read_text().splitlines()
    assert "about 3940 s left" in first  # half of it, less a minute
    assert "about 5880 s left" in second  # as fast as it goes


def test_the_remaining_time_is_not_estimated_before_a_thousandth_of_the_run(
    tmp_path: Path, now: list[float]
) -> None:
    progress = make(tmp_path, now, io.StringIO())
    for at, share in ((100.0, 2e-6), (300.0, 0.5)):
        now[0] = at
        progress.update(moment(share))
    progress.close()
    first, second = (tmp_path / "log.txt").read_text().splitlines()[-2:]
    assert "left" not in first
    assert "about 300 s left" in second


def test_a_slow_run_says_a_line_a_minute(tmp_path: Path, now: list[float]) -> None:
    stream = io.StringIO()
    progress = make(tmp_path, now, stream)
    for k in range(0, 600, 5):
        now[0] = float(k)
        progress.update(moment(1e-4 * k))
    assert 8 <= len(stream.getvalue().splitlines()) <= 10


def test_quiet_says_nothing_but_logs(tmp_path: Path, now: list[float]) -> None:
    stream = io.StringIO()
    progress = make(tmp_path, now, stream, shown=False)
    progress.line("compiling")
    progress.close()
    assert stream.getvalue() == ""
    assert "compiling" in (tmp_path / "log.txt").read_text()


def test_a_terminal_gets_a_bar_and_lines_stay_above_it(tmp_path: Path, now: list[float]) -> None:
    stream = Terminal()
    progress = make(tmp_path, now, stream)
    progress.line("a note [with brackets]")
    now[0] = 6.0
    progress.update(moment(0.5))
    progress.close()
    assert "a note [with brackets]" in stream.getvalue()
    assert "t 5 s" not in (tmp_path / "log.txt").read_text().splitlines()[0]


@pytest.mark.parametrize("kind", [io.StringIO, Terminal])
def test_time_in_which_the_run_waits_is_no_part_of_the_estimate(
    tmp_path: Path, now: list[float], kind: type[io.StringIO]
) -> None:
    progress = make(tmp_path, now, kind())
    progress.pause()
    now[0] = 100.0
    progress.busy("compiling: contacts and motion")
    progress.go_on()
    progress.update(moment(0.01))
    assert (tmp_path / "log.txt").read_text() == ""
    now[0] = 110.0
    progress.update(moment(0.5))
    assert progress.plain == (kind is io.StringIO)
    progress.close()
    assert "about 10 s left" in (tmp_path / "log.txt").read_text()
