"""What the log says of a run that will be long."""

import math

from ryusa.casefile.wall_time import SECONDS_PER_RUN, WallTime
from ryusa.engine import registry
from ryusa.running.pace import other_engines


def taking(seconds):
    return WallTime(seconds, 0.5, 2.0, 0, "")


def test_a_run_of_days_names_the_other_engines_and_whether_they_are_there(monkeypatch):
    monkeypatch.setattr(registry, "unavailable", lambda name: "no card" if name == "cuda" else "")
    (note,) = other_engines("cpu", 10_000_000, taking(415_000.0), 2)
    assert note.startswith("about 4.8 days on 2 threads")
    assert "--engine lammps (LAMMPS, alone or under mpirun)" in note and "--engine cuda (no card)" in note
    assert "on 1 thread," in other_engines("cpu", 10_000_000, taking(830_000.0), 1)[0]
    assert other_engines("cpu", 4_000_000, taking(165_000.0), 2) == ()
    assert other_engines("lammps", 10**9, taking(1e9), 1) == ()
    assert other_engines(None, 10**9, taking(math.inf), 1) == ()


def test_a_wall_time_is_told_in_a_unit_of_its_size() -> None:
    said = {90.0: "90 s", 1590.0: "26.5 min", 9000.0: "2.5 h"}
    assert {seconds: str(WallTime(seconds - SECONDS_PER_RUN, 0.5, 2.0, 0, "")) for seconds in said} == said
