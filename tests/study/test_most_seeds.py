"""Seeds are added to the parts that an interval leaves undecided, and to no others."""

import json
import math

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.figures.comparison import Axis, Curve
from ryusa.study import Band, Finding, Level, Plan, Source, calculation, comparison, misfit, over_seeds
from ryusa.study.ledger import make
from ryusa.study.ledger_file import read_ledger
from ryusa.study.page import made_by, write
from ryusa.study.study import Study


def drawn(mean: float, seed: int) -> dict[str, float]:
    """A number that scatters by 1 about the mean from seed to seed, the same at every call."""
    return {"value": mean + math.sqrt(2.0) * math.sin(2.4 * seed)}


class Part:
    """Asks a mean to be below 1."""

    def __init__(self, mean: float) -> None:
        self.TITLE, self.mean = f"mean {mean:g}", mean

    def tasks(self, plan):
        return [calculation(drawn, mean=self.mean, seed=seed) for seed in plan.seeds]

    def judge(self, found, plan) -> list[Finding]:
        values = [found[one]["value"] for one in self.tasks(plan)]
        seeds = np.array(plan.seeds, float)
        allowed = Band(-math.inf, 1.0, "-", "below 1")
        return [
            comparison(
                "mean", self.TITLE, Source("none"), Axis("seed"), Axis("value"),
                [Curve("mean", seeds, np.array(values))], [],
                [misfit("mean over seeds", over_seeds(values, "-"), "-", allowed)], {},
            )
        ]  # fmt: skip


class Three(Study):
    """One part that four seeds decide, one that sixteen do, one that none would."""

    name, title, command, stem = "three", "Three means", "ryusa study three", "ledger"
    parts = ("clear", "near", "at_the_limit")

    def part(self, name):
        return Part({"clear": -9.0, "near": 0.1, "at_the_limit": 1.0}[name])

    def entry_id(self, part, finding):
        return part if finding is None else f"{part}/{finding.id}"


@pytest.mark.parametrize(
    "most, seeds, outcomes",
    [
        (0, {}, ["holds", "undecided", "undecided"]),
        (7, {}, ["holds", "undecided", "undecided"]),
        (31, {"near": 16, "at_the_limit": 16}, ["holds", "holds", "undecided"]),
        (32, {"near": 16, "at_the_limit": 32}, ["holds", "holds", "undecided"]),
    ],
)
def test_they_are_doubled_until_it_is_decided_or_as_many_as_allowed(tmp_path, most, seeds, outcomes) -> None:
    ledger = make(Three(), None, Plan(seeds=(1, 2, 3, 4)), tmp_path, most_seeds=most)
    assert [str(one.outcome) for one in ledger.entries] == outcomes
    assert {name: len(own) for name, own in ledger.seeds.items()} == seeds
    assert all(own == tuple(range(1, len(own) + 1)) for own in ledger.seeds.values())
    made = 4 + sum(seeds.get(name, 4) for name in ("near", "at_the_limit"))
    assert ledger.counts["runs_made"] + ledger.counts["runs_opened"] == made  # each once
    write(ledger, None)
    plain = json.loads((tmp_path / "ledger.json").read_text(encoding="utf-8"))
    assert {name: len(own) for name, own in plain["more_seeds"].items()} == seeds
    n = [one["trials"][0]["n"] for one in plain["findings"]]
    assert n == [seeds.get(name, 4) for name in Three.parts]
    said = "its part got as many seeds again" in (tmp_path / "ledger.html").read_text(encoding="utf-8")
    assert said == bool(seeds)


def test_a_part_whose_runs_would_take_too_long_gets_none(tmp_path) -> None:
    """A calculation is taken to last 0.1 s, so that eight take 0.8 s and sixteen 1.6 s."""
    ledger = make(Three(), None, Plan(seeds=(1, 2, 3, 4)), tmp_path, most_seeds=32, longest=1.0)
    assert {name: len(own) for name, own in ledger.seeds.items()} == {"near": 8, "at_the_limit": 8}
    assert [str(one.outcome) for one in ledger.entries] == ["holds", "undecided", "undecided"]
    assert ledger.counts["runs_made"] + ledger.counts["runs_opened"] == 4 + 2 * 8
    write(ledger, None)
    plain = json.loads((tmp_path / "ledger.json").read_text(encoding="utf-8"))
    assert set(plain["too_long_minutes"]) == {"near", "at_the_limit"}
    assert "given no more seeds" in (tmp_path / "ledger.html").read_text(encoding="utf-8")


def test_a_part_made_again_takes_the_place_of_its_own_in_a_kept_ledger(tmp_path) -> None:
    kept = tmp_path / "kept.json.xz"
    write(make(Three(), None, Plan(seeds=(1, 2, 3, 4)), tmp_path / "whole"), kept)
    before = read_ledger(kept)
    again = make(Three(), ["near"], Plan(seeds=tuple(range(5, 21))), tmp_path / "part")
    write(again, kept)
    now = read_ledger(kept)
    clear, near, limit = now["findings"]
    assert [one["part"] for one in now["findings"]] == list(Three.parts)
    assert (clear, limit) == (before["findings"][0], before["findings"][2])
    assert (near["trials"][0]["n"], near["outcome"]) == (16, "holds")
    assert now["seeds"] == [1, 2, 3, 4]
    assert now["more_seeds"] == {"near": list(range(5, 21))}
    origin = dict(now["provenance"])
    assert origin.pop("parts")["near"]["runs_made"] == 16
    assert origin == before["provenance"]
    assert made_by(now).endswith(f"; near: {made_by(read_ledger(tmp_path / 'part' / 'ledger-part.json'))}")
    own = read_ledger(tmp_path / "part" / "ledger-part.json")
    assert [one["part"] for one in own["findings"]] == ["near"]


def test_a_part_is_not_put_into_a_ledger_of_another_level(tmp_path) -> None:
    kept = tmp_path / "kept.json"
    write(make(Three(), None, Plan(seeds=(1, 2)), tmp_path / "whole"), kept)
    before = kept.read_bytes()
    again = make(Three(), ["near"], Plan(Level.FULL, (1, 2)), tmp_path / "part")
    with pytest.raises(ResultsError, match="at level full have no place in it"):
        write(again, kept)
    assert kept.read_bytes() == before
