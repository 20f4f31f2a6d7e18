import math
from pathlib import Path

import pytest

from ryusa.figures.style import new, save
from ryusa.study import Band, Finding, Interval, Level, Plan, Trial
from ryusa.study.entry import LedgerEntry
from ryusa.study.ledger import Ledger
from ryusa_studies.osada2004._parts import PHI, ROTATION
from ryusa_studies.osada2004.claims import CLAIMS
from ryusa_studies.osada2004.study import PAPER

BAND = Band(1.0, 2.0, "m", "1 to 2 m")
NASTY = "<script>alert('x')</script> & \"quotes\" {{ 7 * 7 }}"


def number(value, half=0.1):
    return Interval(value, value - half, value + half, "m", 3, "95 % of the mean of 3 seeds, Student's t")


def trial(value, half=0.1, part="length", **choices):
    names = {"phi": PHI, "rotation": ROTATION}
    return Trial(part, {names.get(key, key): one for key, one in choices.items()}, number(value, half), BAND)


def finding(claim, *trials, **more):
    return Finding(claim, trials, "physics decides", {"grain": "0.2 cm"}, **more)


@pytest.fixture
def picture(tmp_path):
    figure, (axes,) = new()
    axes.plot([0, 1], [0, 1])
    return save(figure, tmp_path / "fig20" / "fig20.png")


@pytest.fixture
def every_word(tmp_path: Path, picture: Path) -> Ledger:
    """A ledger with every verdict, numbers that are none, and text that would break a page."""
    nan = Interval(math.nan, math.nan, math.nan, "m", 3, "mean of 3 seeds")
    found = {
        "fig20": finding("fig20", trial(1.5, phi="10 deg"), trial(1.6, phi="20 deg"), also=(NASTY, "b")),
        "fig7": finding(
            "fig7",
            *(
                trial(1.5 if phi == "10 deg" else 3.0, phi=phi, slip=slip, start=start)
                for phi in ("10 deg", "20 deg")
                for slip in ("spring", "total")
                for start in ("rest", "moving", "poured")
            ),
        ),
        "fig8": finding("fig8", trial(3.0, phi="10 deg"), trial(4.0, phi="20 deg", part=NASTY)),
        "fig12": finding("fig12", trial(1.5), contradiction="a band of 10 cannot hold 100"),
        "fig14": finding("fig14", Trial("speed", {"x" * 90: "y" * 90}, nan, BAND)),
        "eq13": finding("eq13", Trial("slope", {}, nan, BAND, decided=False, note="stands as a wall")),
    }
    rows = {name: LedgerEntry(name, "fig20", one) for name, one in found.items()}
    rows["fig20"] = LedgerEntry("fig20", "fig20", found["fig20"], (picture,))
    rows["fig4"] = LedgerEntry("fig4", "fig20", None, problem=f"1 of 2 runs failed {NASTY}")
    table = [{"seed": seed, "jump": 0.123456789, "word": NASTY, "none": None} for seed in range(70)]
    return Ledger(
        PAPER, tuple(rows[one] for one in CLAIMS if one in rows), Plan(Level.STANDARD, (1, 2, 3)), tmp_path,
        {f"fig20 {NASTY}": "grain 7 lost"},
        {
            "runs_made": 2, "runs_opened": 1, "wall_s": 61.0, "jobs": 2,
            "commits_of_runs": {"a" * 40: 1, "b" * 40 + "+": 2},
            "of_other_code": {"b" * 40 + "+": 2},
        },
        {"fig20": table},
    )  # fmt: skip
