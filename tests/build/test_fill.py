"""Builder 'fill': a box of grains, open or periodic, between plates that may have ridges."""

import math

import numpy as np
import pytest

from ryusa.build import build
from ryusa.build.walls import ridges, surfaces
from ryusa.casefile.builders.values import bed_area
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.errors import CaseError
from ryusa.model.wall_shape import nearest_on_face

PERIODIC = {"build.periodic": "true", "build.low": '["1 cm", "0 cm", "0 cm"]', "walls": "[]"}


def built(**keys):
    """Grains of the packaged drum in a box of 3 cm x 1.6 cm, without the drum."""
    box = PERIODIC | {"build.high": '["4 cm", "1.6 cm", "2 cm"]'} | keys
    return build(read(case_path("drum.toml"), box))


def test_a_periodic_box_has_the_period_of_its_sides_and_no_overlap_across_them():
    made = built()
    scene, state = made.scene, made.state
    assert scene.period == pytest.approx((0.03, 0.016))
    apart = state.x[:, None] - state.x[None]
    apart[..., :2] -= np.round(apart[..., :2] / scene.period) * scene.period
    gap = np.linalg.norm(apart, axis=2) - 0.5 * (scene.d[:, None] + scene.d[None])
    np.fill_diagonal(gap, 1.0)
    assert gap.min() >= 0.0


def test_a_box_is_open_unless_it_is_asked_to_be_periodic():
    assert built(**{"build.periodic": "false"}).scene.period == (math.inf, math.inf)


def test_the_bed_under_a_periodic_box_is_that_of_its_sides():
    case = read(case_path("drum.toml"), PERIODIC | {"build.high": '["4 cm", "1.6 cm", "2 cm"]'})
    assert bed_area(case) == pytest.approx(0.03 * 0.016)


@pytest.mark.parametrize(
    ("key", "value", "fault"),
    [
        ("build.high", '["4 cm", "3 mm", "2 cm"]', r"build.high .* in y, which is periodic"),
        ("build.plate", '"1 cm"', r"build.plate .* cannot be in a periodic box"),
    ],
)
def test_what_does_not_go_with_a_periodic_box_is_refused(key, value, fault):
    with pytest.raises(CaseError, match=fault):
        built(**{key: value})


def test_a_ball_in_the_valley_between_ridges_touches_both_of_their_sides():
    made = ridges("plate", (0, 0, 0), (0.04, 0, 0), (0, 0.016, 0), 20, 0.001)
    r = 0.0004
    # sides of 45 deg: the centre is r sqrt(2) above the valley
    x = np.array([0.002, 0.008, r * math.sqrt(2.0)])
    faces = zip(made.face, made.kind, strict=True)
    apart = [float(np.linalg.norm(nearest_on_face(face, int(kind), x) - x)) for face, kind in faces]
    assert min(apart) == pytest.approx(r, rel=1e-12)
    valley = surfaces(made.face, made.kind)[np.isclose(apart, r, rtol=1e-12)]
    assert len(set(valley.tolist())) == 2  # the two sides fold by 90 deg: two contacts
