"""[[feeds]] and [[exits]] of the case file: what they become, and what bad ones get."""

import math
from typing import Any

import numpy as np
import pytest

from ryusa.build import build
from ryusa.casefile.explain import explain
from ryusa.casefile.feeds.schema import read_rate
from ryusa.casefile.feeds.values import mean_mass
from ryusa.casefile.read import read_text
from ryusa.casefile.resolved import resolved
from ryusa.cases import case_path
from ryusa.errors import CaseError
from ryusa.model.feeds import NONE

HEAP = case_path("poured_heap.toml").read_text()
BOX = """
[[feeds]]
name = "tray"
low = ["-1 cm", "-1 cm", "6 cm"]
high = ["1 cm", "1 cm", "7 cm"]
"""


def case(text: str = HEAP, **overrides: str) -> Any:
    return read_text(text, {key.replace("__", "."): value for key, value in overrides.items()})


def changed(*pairs: tuple[str, str]) -> str:
    text = HEAP
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize(
    ("text", "rate"),
    [
        ("0.1 kg/s", (0.1, "kg/s")),
        ("6 kg/min", (0.1, "kg/s")),
        ("50 g/s", (0.05, "kg/s")),
        ("20 grains/s", (20.0, "grains/s")),
        ("1 grain/s", (1.0, "grains/s")),
        ("30 grains/min", (0.5, "grains/s")),
        ("20 1/s", (20.0, "grains/s")),
    ],
)
def test_a_rate_is_a_mass_or_a_number_in_a_time(text: str, rate: tuple[float, str]) -> None:
    value, unit = read_rate(text)
    assert (value, unit) == (pytest.approx(rate[0]), rate[1])


def test_feeds_bring_grains_that_wait_at_the_start() -> None:
    built = build(case())
    scene, state, traffic = built.scene, built.state, built.scene.traffic
    assert traffic is not None
    [hose], [rim] = traffic.feeds, traffic.exits
    assert (traffic.n_first, hose.first, hose.count, scene.n_grain) == (0, 0, 1200, 1200)
    assert not state.present.any()
    assert np.isnan(state.x).all()
    assert scene.groups["hose"] == (0, 1200)
    assert (hose.rate, hose.by_mass, hose.velocity, hose.radius) == (500.0, False, (0.0, 0.0, -0.3), 0.01)
    assert rim.normal == (0.0, 0.0, -1.0)
    assert rim.to == NONE
    assert 0.8 * 0.004 <= scene.d.min() < scene.d.max() <= 1.2 * 0.004
    assert scene.world_low[2] < -0.3
    np.testing.assert_allclose((scene.x_fixed[:, 2] + scene.d_fixed / 2).max(), 0.0, atol=1e-12)


def test_the_mass_of_a_feed_in_kilograms_is_that_asked_for() -> None:
    built = build(case(changed(('"500 grains/s"', '"0.05 kg/s"'))))
    traffic = built.scene.traffic
    assert traffic is not None
    [hose] = traffic.feeds
    m = built.scene.m[hose.first : hose.first + hose.count]
    assert m[:-1].sum() < 0.05 * 2.4 <= m.sum()
    due = hose.due(built.scene.m)
    assert due[0] == 0.0
    assert due[-1] < 2.4


def test_sizes_of_a_feed_follow_the_seed_alone() -> None:
    one, same = build(case()).scene.d, build(case()).scene.d
    other = build(case(seed="2")).scene.d
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)


def test_a_feed_beside_first_grains_leaves_them_as_they_were() -> None:
    text = case_path("box.toml").read_text()
    plain = build(read_text(text))
    more = (
        text
        + '[[feeds]]\nname = "hose"\ncentre = ["1 cm", "0 cm", "30 cm"]\nradius = "2 cm"\nrate = "50 1/s"\n'
    )
    fed = build(read_text(more))
    n = plain.scene.n_grain
    np.testing.assert_array_equal(fed.scene.d[:n], plain.scene.d)
    np.testing.assert_array_equal(fed.state.x[:n], plain.state.x)
    assert fed.state.present[:n].all()
    assert not fed.state.present[n:].any()


def test_a_case_without_feeds_is_resolved_as_before() -> None:
    data = resolved(read_text(case_path("box.toml").read_text()))
    assert "feeds" not in data
    assert "exits" not in data
    assert resolved(case())["feeds"][0]["rate"] == [500.0, "grains/s"]


def test_check_says_what_a_feed_brings() -> None:
    rows = {row.name: row for row in explain(case()) if row.section == "traffic"}
    assert rows["feed 'hose'"].value == 500.0
    assert rows["feed 'hose': grains"].value == 1200
    assert 0.0 < float(rows["feed 'hose': filled"].value) < 0.2
    assert "leave the run" in rows["exit 'rim'"].origin


def test_the_mean_mass_is_that_of_the_sizes() -> None:
    found = case(changed(('"500 grains/s"', '"20000 grains/s"'), ('radius = "1 cm"', 'radius = "20 cm"')))
    scene = build(found).scene
    assert scene.m.mean() == pytest.approx(mean_mass(found), rel=0.01)


BAD = [
    # a change of the case, the key of the error, and words of it
    ([('radius = "1 cm"', 'radius = "1 mm"')], "feeds.0.radius", "too small for the largest grain"),
    ([('"500 grains/s"', '"500"')], "feeds.0.rate", "such as '0.1 kg/s' or '20 grains/s'"),
    ([('"500 grains/s"', '"0 grains/s"')], "feeds.0.rate", "must be greater than 0"),
    ([('"500 grains/s"', '"20000 grains/s"')], "feeds.0.rate", "cannot fit"),
    ([('"500 grains/s"', '"1e9 kg/s"')], "feeds.0.rate", "cannot fit"),
    ([('end = "2.4 s"', 'begin = "4 s"')], "feeds.0.begin", "leaves no time to feed"),
    ([('"rim"', '"rim"\nto = "hoes"')], "exits.0.to", "Did you mean 'hose'"),
    ([('"rim"', '"hose"')], "exits.0.name", "is used twice"),
    ([('"hose"', '"floor"')], "feeds.0.name", "already used by the builder"),
    ([('"-2 cm"]\nnormal', '"8 cm"]\nnormal')], "feeds.0", "lies within exits.0 ('rim')"),
    ([("normal = [0, 0, -1]   ", "normal = [0, 0, 0]   ")], "exits.0.normal", "must not be zero"),
    ([("normal = [0, 0, -1]   ", "# ")], "exits.0.normal", "missing; point needs it"),
    ([('radius = "1 cm"', 'low = ["0 cm", "0 cm", "1 cm"]')], "feeds.0", "needs either low and high"),
    ([('radius = "1 cm"', "# ")], "feeds.0.radius", "missing; centre needs it"),
    ([('time = "3.4 s"', "saltations = 5")], "stop.saltations", "cannot end a run with feeds"),
    ([("[time]", '[[planes]]\nname = "roof"\npoint = ["0 m", "0 m", "4 cm"]\nnormal = [0, 0, -1]\n[time]')],
     "feeds.0", "lies behind the plane 'roof'"),
    ([("[time]", '[[walls]]\nname = "hose"\nshape = "disc"\nat = ["0 m", "0 m", "9 m"]\nnormal = [0, 0, 1]\n'
      'radius = "1 cm"\n[time]')], "feeds.0.name", "is used twice"),
    ([("[time]", '[domain]\nhigh = ["1 m", "1 m", "4 cm"]\n[time]')], "feeds.0", "lies outside domain"),
]  # fmt: skip


@pytest.mark.parametrize(("pairs", "key", "words"), BAD)
def test_a_bad_feed_or_exit_is_named_before_the_run(pairs: Any, key: str, words: str) -> None:
    with pytest.raises(CaseError) as found:
        build(case(changed(*pairs)))
    assert key in str(found.value)
    assert words in str(found.value)


@pytest.mark.parametrize(
    ("rate", "key", "words"),
    [
        ("", "feeds.1.rate", "no exit leads to this feed"),
        ('rate = "1e5 grains/s"', "feeds.1.rate", "cannot fit"),
    ],
)
def test_a_bad_box_is_named(rate: str, key: str, words: str) -> None:
    with pytest.raises(CaseError) as found:
        case(HEAP + BOX + rate)
    assert key in str(found.value)
    assert words in str(found.value)
    narrow = (HEAP + BOX).replace('"7 cm"', '"6.2 cm"') + 'rate = "5 1/s"'
    with pytest.raises(CaseError, match="is smaller than the largest grain"):
        case(narrow)


def test_an_empty_builder_needs_a_feed() -> None:
    text = HEAP[: HEAP.index("[[feeds]]")] + HEAP[HEAP.index("[time]") :]
    with pytest.raises(CaseError, match=r"give \[\[feeds\]\]"):
        case(text)


def test_an_exit_can_lead_to_a_feed_of_its_own_without_a_rate() -> None:
    built = build(case(changed(('"rim"', '"rim"\nto = "tray"')) + BOX))
    traffic = built.scene.traffic
    assert traffic is not None
    assert traffic.exits[0].to == 1
    assert traffic.feeds[1].count == 0
    assert math.isinf(traffic.feeds[1].rate) is False
