"""[[feeds]] that stop at a number or a mass of grains."""

import pytest
from tests.casefile.texts import FED

import ryusa
from ryusa.casefile.feeds.values import fed_count, feed_end
from ryusa.casefile.read import read_text
from ryusa.errors import CaseError


def case_of(rate, total):
    return read_text(FED.format(keys=f'rate = "{rate}"' + (f'\ntotal = "{total}"' if total else "")))


@pytest.mark.parametrize(
    ("rate", "total", "count", "end"),
    [
        ("200 grains/s", "20 grains", 20, 0.1),
        ("200 grains/s", "", 60, 0.3),
        ("200 grains/s", "1 grain", 1, 0.005),
        ("2.22e-3 kg/s", "20 grains", 20, None),
        ("200 grains/s", "0.222 g", 20, None),
    ],
)
def test_a_feed_stops_at_its_total(rate, total, count, end):
    case = case_of(rate, total)
    assert fed_count(case, case.feeds[0]) == count
    if end is not None:
        assert feed_end(case, case.feeds[0]) == pytest.approx(end)


@pytest.mark.parametrize(
    ("total", "said"),
    [("90 grains", "not fed by 0.3 s"), ("0 grains", "above|greater than 0"), ("5 cm", "0.5 kg")],
)
def test_a_total_that_is_none_or_too_much_is_refused(total, said):
    with pytest.raises(CaseError, match=said):
        case_of("200 grains/s", total)


@pytest.mark.full
def test_the_run_holds_the_total(tmp_path):
    run = ryusa.run(case_of("200 grains/s", "20 grains"), tmp_path / "run", progress=False)
    assert run.summary["traffic"]["feeds"][0]["entered"] == 20
