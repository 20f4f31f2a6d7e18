"""How averages are printed: errors, verdicts, and the begin that is suggested."""

from dataclasses import fields
from types import SimpleNamespace

import numpy as np

from ryusa.cli.printing import print_found
from ryusa.measure import Averages, average
from ryusa.measure.long_section import LongSection

WINDOW = (4.0, 8.0)


def printed(capsys, *items, notes=()):
    found = SimpleNamespace(averages=Averages("made up", items, notes))
    print_found("made up", found, SimpleNamespace())
    return capsys.readouterr().out


def line(text, name):
    return next(one for one in text.splitlines() if one.startswith(f" {name} "))


def test_a_steady_a_short_and_a_changing_record_are_told_apart(capsys):
    noise = np.random.default_rng(2).normal(1.0, 0.1, 400)
    transient = noise + 5.0 * np.exp(-np.arange(400) / 20.0)
    text = printed(
        capsys,
        average("settled", "-", [noise], WINDOW),
        average("few", "-", [noise[:12]], WINDOW),
        average("falling", "-", [transient], WINDOW),
        average("rising", "-", [noise + np.linspace(0.0, 1.0, 400)], WINDOW),
        average("none", "-", [], WINDOW),
    )
    assert " yes" in line(text, "settled")
    assert "*" not in line(text, "settled")
    assert "* " in line(text, "few")
    assert "too short" in line(text, "few")
    assert "no, drift -" in line(text, "falling")
    assert "no, drift +" in line(text, "rising")
    assert line(text, "none").split() == ["none", "-", "-", "-", "0", "-", "-"]
    assert "* worth fewer than 20 independent samples: the error may be larger" in text
    begins = next(one for one in text.splitlines() if one.startswith("not steady over the window"))
    assert "rising never" in begins
    assert 4.4 < float(begins.split("falling ")[1].split(" s")[0]) < 6.5
    assert "settled" not in begins


def test_a_table_of_steady_records_says_nothing_more(capsys):
    noise = np.random.default_rng(2).normal(1.0, 0.1, 400)
    text = printed(capsys, average("settled", "-", [noise], WINDOW), notes=("a note",))
    assert "MSER" not in text
    assert "independent" not in text
    assert "a note" in text


def test_round_off_of_a_long_section_is_printed_as_0(capsys):
    names = ("bottom", "floor", "bed", "surface", "depth", "discharge", "speed", "froude", "critical",
             "energy", "tau", "volume", "transport_concentration", "concentration")  # fmt: skip
    one = {name: np.array([0.5, 0.5]) for name in names}
    found = LongSection(
        t=1.0, slope=0.0, x=np.array([0.1, 0.2]), dams=(), solid_discharge=np.array([-1.168e-18, 2.0e-4]),
        grains=True, **one,
    )  # fmt: skip
    print_found("long_section", found, None)
    text = capsys.readouterr().out
    assert "e-18" not in text and "0.0002" in text


def test_where_a_flow_is_as_dense_as_a_bed_its_table_says_how_to_end_the_bed(capsys):
    n = 4
    numbers = {"t": 0.0, "slope": 0.0, "dams": (), "window": None, "error": {}, "grains": True}
    arrays = {one.name: np.ones(n) for one in fields(LongSection) if one.name not in numbers}
    arrays["transport_concentration"] = np.full(n, 0.4)
    fast = {"froude": np.array([0.5, 12.0, 80.0, np.nan])}
    print_found("long_section", LongSection(**numbers, **(arrays | fast)), None)
    assert "in 2 of 4 segments most grains flow below the line of the bed" in capsys.readouterr().out
    print_found("long_section", LongSection(**numbers, **arrays), None)
    assert "--bed rest" not in capsys.readouterr().out
