"""What a page holds of a run, decoded again."""

import base64
import json
import math
import re
import zlib

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.results.touching import contacts_per_grain
from ryusa.view.colouring import COLOURINGS, value_range
from ryusa.view.encode import LEVELS, Blob, add_positions
from ryusa.view.page import LEAST_SIZE, encoded, thinned, view_page


def unpacked(data, blob, name):
    """An array of a page, as the script of the page unpacks it."""
    about, raw = data["arrays"][name], base64.b64decode(blob)
    one = zlib.decompress(raw[about["from"] : about["from"] + about["bytes"]])
    return np.frombuffer(one, about["type"]).reshape(about["shape"])


def summed(split):
    folded = sum(split[place].astype(np.int64) << (8 * place) for place in range(len(split)))
    whole = np.where(folded % 2, -(folded + 1) // 2, folded // 2).transpose(1, 2, 0)
    for k in range(1, len(whole)):
        whole[k] += whole[0] if k == 1 else 2 * whole[k - 1] - whole[k - 2]
    return whole


def test_positions_come_back_to_half_a_hundredth_of_a_diameter(saltation):
    data, blob = encoded(saltation)
    x = summed(unpacked(data, blob, "x")) * data["quantum"]
    far = np.abs(x - saltation.frames.x[:])
    assert far.max() <= 0.5 * saltation.scene.d.min() / 100 * (1 + 1e-9)


def test_a_period_is_a_whole_number_of_steps(saltation):
    data, _ = encoded(saltation)
    cells = data["period"][0] / data["quantum"][0]
    assert cells == pytest.approx(round(cells), abs=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_random_paths_come_back_bit_by_bit(seed):
    rng = np.random.default_rng(seed)
    whole = rng.integers(-(10 ** rng.integers(1, 9)), 10**8, (7, 5, 3)).astype(np.int32)
    blob = Blob()
    add_positions(blob, whole)
    data = {"arrays": blob.contents}
    assert (summed(unpacked(data, base64.b64encode(blob.bytes()), "x")) == whole).all()


def test_colours_are_those_of_the_values_to_one_level(saltation):
    data, blob = encoded(saltation)
    for one in COLOURINGS:
        about = next(each for each in data["colourings"] if each["word"] == one.word)
        if one.word not in data["arrays"]:
            assert one.word == "height"  # drawn from the positions
            continue
        level = unpacked(data, blob, one.word)
        if data["arrays"][one.word]["differences"]:
            level = np.cumsum(level, axis=0, dtype=np.uint8)
        values = np.stack([one.values(saltation, k) for k in range(len(level))]) * one.scale
        shown = about["low"] + level / (LEVELS - 1) * (about["high"] - about["low"])
        clipped = np.clip(values, about["low"], about["high"])
        assert np.abs(shown - clipped).max() <= 0.51 * (about["high"] - about["low"]) / (LEVELS - 1)


def test_a_scale_covers_all_but_one_value_in_a_hundred(saltation):
    rng = np.random.default_rng(3)
    for one in COLOURINGS:
        values = np.abs(rng.standard_normal(20_000)) if not one.signed else rng.standard_normal(20_000)
        low, high = value_range(one, values, saltation.scene)
        assert 0.985 <= ((values >= low) & (values <= high)).mean() <= 1.0
        assert low < high


@pytest.mark.parametrize("one", COLOURINGS, ids=lambda one: one.word)
@pytest.mark.parametrize("values", [np.zeros(0), np.zeros(4), np.full(4, 2.5)], ids=["none", "zero", "alike"])
def test_a_scale_has_two_ends_whatever_the_values_are(saltation, one, values):
    low, high = value_range(one, values, saltation.scene)
    assert math.isfinite(low)
    assert low < high


def test_contacts_are_those_of_all_pairs(three, saltation):
    scene = saltation.scene
    for k in range(0, len(saltation.frames), 7):
        x = saltation.frames.x_wrapped[k]
        every = np.concatenate([x, scene.x_fixed])
        d = np.concatenate([scene.d, scene.d_fixed])
        gap = every[None] - x[:, None]
        for axis, period in enumerate(scene.period):
            if math.isfinite(period):
                gap[..., axis] -= period * np.round(gap[..., axis] / period)
        near = np.linalg.norm(gap, axis=2) < 0.5 * (d[None] + scene.d[:, None])
        near[np.arange(len(x)), np.arange(len(x))] = False
        assert (contacts_per_grain(x, scene) == near.sum(axis=1)).all()
    on_the_floor = np.array([[0.01, 0.01, 0.0019], [0.03, 0.01, 0.0011], [0.02, 0.03, 0.02]])
    assert contacts_per_grain(on_the_floor, three.scene).tolist() == [1, 0, 0]


def test_frames_are_thinned_before_grains_and_evenly():
    window = np.arange(1000)
    few = thinned(window, 50, 50 * 400)
    assert len(few.grains) == 50
    assert len(few.frames) == 400
    assert few.frames[0] == 0
    assert few.frames[-1] == 999
    assert set(np.diff(few.frames)) <= {2, 3}
    fewer = thinned(window, 50_000, 60 * 10_000)
    assert len(fewer.frames) == 60
    assert len(fewer.grains) == 10_000
    assert (np.diff(fewer.grains) > 0).all()


def test_a_few_frames_less_are_better_than_grains_that_are_missing():
    window = np.arange(31)
    for room, frames, grains in ((30.5, 30, 1000), (24.0, 24, 1000), (20.0, 31, 20_000 // 31)):
        found = thinned(window, 1000, room * 1000)
        assert (len(found.frames), len(found.grains)) == (frames, grains)


def test_a_page_is_no_larger_than_asked_and_says_what_it_left_out(saltation):
    _, every = encoded(saltation)
    assert len(view_page(saltation)) - len(every) < LEAST_SIZE  # script, style and words
    size = LEAST_SIZE + 0.9 * len(every)
    data, blob = encoded(saltation, size=size)
    assert len(blob) + LEAST_SIZE <= size
    assert len(data["t"]) < data["frames"] == len(saltation.frames)


def test_a_window_without_frames_is_refused_with_the_times_there_are(saltation):
    with pytest.raises(ResultsError, match="the run holds 0"):
        encoded(saltation, begin=5.0)


def test_text_of_a_stranger_stays_text(saltation, monkeypatch):
    script = "</script><script>alert(1)</script><img src=x onerror=alert(2)><!--"
    monkeypatch.setitem(saltation.case, "title", script)
    page = view_page(saltation)
    assert "<img" not in page
    assert "alert(1)</script>" not in page
    assert page.count("<script") == 3
    kept = re.search(r'id="ryusa-data-0">(.*?)</script>', page, re.DOTALL)
    assert kept
    assert json.loads(kept[1])["title"] == script


def test_a_page_may_load_nothing_from_anywhere(saltation):
    page = view_page(saltation)
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)
    assert policy
    assert policy[1].startswith("default-src &#39;none&#39;; script-src &#39;sha256-")
    assert not re.search(r"(src|href)=[\"']?(https?:)?//", page)
