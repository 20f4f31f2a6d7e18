"""Builder 'fill': a box of grains, open or periodic, between plates that may have ridges."""

import math

import numpy as np
import pytest

from ryusa.build import build
from ryusa.build.walls import ridges
from ryusa.casefile.read import read
from ryusa.errors import CaseError
from ryusa.model.wall_shape import nearest_on_face

CASE = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction = 0.5
[motion]
rotation = "free"
plane = false
[build]
kind = "fill"
low = ["1 cm", "0 cm", "0 cm"]
high = ["4 cm", "1.6 cm", "2 cm"]
periodic = true
[stop]
time = "1 s"
"""


def built(folder, text):
    (folder / "case.toml").write_text(text)
    return build(read(folder / "case.toml"))


def test_a_periodic_box_has_the_period_of_its_sides_and_no_overlap_across_them(tmp_path):
    made = built(tmp_path, CASE)
    scene, state = made.scene, made.state
    assert scene.period == pytest.approx((0.03, 0.016))
    apart = state.x[:, None] - state.x[None]
    apart[..., :2] -= np.round(apart[..., :2] / scene.period) * scene.period
    far = np.linalg.norm(apart, axis=2) + np.eye(len(state.x))
    assert far.min() >= 0.002


def test_a_box_is_open_unless_it_is_asked_to_be_periodic(tmp_path):
    assert built(tmp_path, CASE.replace("periodic = true", "")).scene.period == (math.inf, math.inf)


def test_a_periodic_box_narrower_than_its_grains_need_is_refused(tmp_path):
    with pytest.raises(CaseError, match=r"build.high .* in y, which is periodic"):
        built(tmp_path, CASE.replace("1.6 cm", "3 mm"))


def test_a_ball_in_the_valley_between_ridges_touches_both_of_their_sides():
    made = ridges("plate", (0, 0, 0), (0.04, 0, 0), (0, 0.016, 0), 20, 0.001)
    r = 0.0004
    x = np.array(
        [0.002, 0.008, r * math.sqrt(2.0)]
    )  # sides of 45 deg: the centre is r sqrt(2) above the valley
    near = [
        np.linalg.norm(nearest_on_face(f, int(k), x) - x) for f, k in zip(made.face, made.kind, strict=True)
    ]
    touching = np.isclose(near, r, rtol=1e-12)
    assert min(near) == pytest.approx(r, rel=1e-12)
    assert touching.sum() >= 2
