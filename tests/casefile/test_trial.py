"""`ryusa run CASE --try TIME`: every packaged case may be cut short."""

import pytest

from ryusa.casefile.read import read
from ryusa.casefile.trial import read_shortened
from ryusa.cases import case_files, case_path
from ryusa.errors import CaseError


@pytest.mark.parametrize("name", case_files(""))
def test_every_packaged_case_may_be_tried(name):
    path = case_path(f"{name}.toml")
    whole = read(path)
    asked = whole.stop.time or 1.0
    case = read_shortened(path, {}, f"{0.05 * asked} s")
    assert case.stop.time == pytest.approx(0.05 * asked)
    assert case.record.settle < case.stop.time
    assert case.record.frames <= case.stop.time / 10 * (1 + 1e-9)
    assert len(case.timeline) == len(whole.timeline)
    assert all(one.at <= case.stop.time for one in case.timeline)
    assert [one.at for one in case.timeline] == sorted(one.at for one in case.timeline)


def test_the_timeline_shrinks_as_the_whole_does():
    path = case_path("heap.toml")
    case = read_shortened(path, {"seed": "3"}, "20 ms")
    assert case.timeline[0].at == pytest.approx(0.4 * 0.02 / 2.0)
    assert case.seed == 3


@pytest.mark.parametrize(
    ("time", "said"),
    [("5 s", "shorter than stop.time, 2 s"), ("20", "20 ms"), ("2 cm", "20 ms"), ("-1 s", "above 0")],
)
def test_what_is_no_shorter_time_is_refused(time, said):
    with pytest.raises(CaseError, match=said):
        read_shortened(case_path("heap.toml"), {}, time)
