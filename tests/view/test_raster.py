"""Spheres, lines and faces as pixels."""

import numpy as np
import pytest

from ryusa.view.raster import BACKGROUND, Canvas, Face, Line, Spheres

WIDE, HIGH = 120, 90
RED, BLUE = (255, 0, 0), (0, 0, 255)


def spheres(places, radii, colours=None, chosen=-1):
    """Spheres at places in pixels; the raster takes samples, two in a pixel."""
    places, radii = 2.0 * np.array(places, dtype=np.float32).reshape(-1, 3), 2.0 * np.array(radii)
    colours = np.array(colours or [RED] * len(radii), dtype=np.uint8).reshape(-1, 3)
    return Spheres(places.astype(np.float32), radii.astype(np.float32), colours, chosen)


def drawn(some, lines=(), faces=()):
    return Canvas(WIDE, HIGH).draw(some, list(lines), list(faces)).astype(int)


def covered(picture):
    """Share of each pixel that a red sphere covers: it takes away all of the background's green."""
    return 1.0 - picture[..., 1] / BACKGROUND[1]


@pytest.mark.parametrize(("x", "y", "r"), [(60.0, 45.0, 20.0), (40.3, 33.8, 11.7), (70.6, 20.1, 3.2)])
def test_a_sphere_covers_a_disc_of_its_radius_around_its_centre(x, y, r):
    share = covered(drawn(spheres([(x, y, 0.0)], [r])))
    rows, columns = np.indices(share.shape)
    assert share.sum() == pytest.approx(np.pi * r**2, rel=0.01, abs=1.0)
    assert (share * (columns + 0.5)).sum() / share.sum() == pytest.approx(x, abs=0.1)
    assert (share * (rows + 0.5)).sum() / share.sum() == pytest.approx(y, abs=0.1)


def test_a_sphere_half_outside_the_picture_is_cut_at_its_edge():
    share = covered(drawn(spheres([(0.0, 45.0, 0.0), (60.0, HIGH, 0.0)], [10.0, 10.0])))
    assert share.sum() == pytest.approx(np.pi * 10.0**2, rel=0.02)


def test_the_nearer_sphere_hides_the_farther_whatever_their_order():
    places, colours = [(50.0, 45.0, 30.0), (58.0, 45.0, 0.0)], [RED, BLUE]
    one = drawn(spheres(places, [10.0, 10.0], colours))
    other = drawn(spheres(places[::-1], [10.0, 10.0], colours[::-1]))
    assert (one == other).all()
    assert one[45, 56, 0] > 60  # both are there; red is nearer
    assert one[45, 56, 2] == 0
    assert one[45, 64, 2] > 60


def test_spheres_that_reach_into_each_other_part_in_the_middle():
    seen = drawn(spheres([(50.0, 45.0, 0.0), (60.0, 45.0, 0.0)], [10.0, 10.0], [RED, BLUE]))
    assert (seen[40:50, 54, 2] == 0).all()
    assert (seen[40:50, 55, 0] == 0).all()


def test_light_is_the_formula_of_the_page():
    seen = drawn(spheres([(60.0, 45.0, 0.0)], [40.0], [(200, 100, 50)]))
    light = np.array([-0.35, 0.75, 0.55]) / np.linalg.norm([-0.35, 0.75, 0.55])
    for column, row in [(60, 45), (45, 30), (80, 60), (60, 10), (30, 50)]:
        across, down = (column + 0.5 - 60.0) / 40.0, (row + 0.5 - 45.0) / 40.0
        normal = np.array([across, -down, np.sqrt(1.0 - across**2 - down**2)])
        rim = min(normal[2] / 0.4, 1.0)
        rim = 0.55 + 0.45 * rim * rim * (3.0 - 2.0 * rim)
        strong = (0.5 + 0.5 * max(normal @ light, 0.0)) * rim
        assert seen[row, column] == pytest.approx(strong * np.array([200, 100, 50]), abs=3.0)


def test_equal_spheres_look_alike_wherever_they_are():
    seen = drawn(spheres([(30.0, 30.0, 5.0), (80.0, 60.0, -7.0)], [15.0, 15.0]))
    assert (seen[14:46, 14:46] == seen[44:76, 64:96]).all()


def test_a_grain_smaller_than_a_sample_is_still_seen():
    rng = np.random.default_rng(1)
    for x, y in rng.uniform(10.0, 80.0, (20, 2)):
        assert (drawn(spheres([(x, y, 0.0)], [0.375])) != BACKGROUND).any()


def test_a_line_is_hidden_by_what_is_nearer_and_runs_from_end_to_end():
    ball = spheres([(60.0, 45.0, 0.0)], [10.0])
    ends = 2.0 * np.array([(20.0, 45.5, 0.0), (100.0, 45.5, 0.0)], dtype=np.float32)
    for shift, hidden in ((0.0, True), (40.0, False)):
        line = Line(ends + np.float32([0.0, 0.0, shift]), BLUE)
        blue = (drawn(ball, [line])[44:46] == BLUE).all(axis=2).any(axis=0)
        assert blue[22:49].all()
        assert blue[71:98].all()
        assert not blue[:18].any()
        assert blue[52:68].any() != hidden


@pytest.mark.parametrize(("depth", "hidden"), [(-20.0, True), (40.0, False)])
def test_a_translucent_face_mixes_with_what_is_behind_it(depth, hidden):
    ball = spheres([(60.0, 45.0, 0.0)], [10.0])
    corners = 2.0 * np.array([(30, 20, depth), (90, 20, depth), (90, 70, depth), (30, 70, depth)])
    bare = drawn(ball)
    seen = drawn(ball, faces=[Face(corners.astype(np.float32), BLUE, 0.25)])
    mixed = np.rint(0.25 * np.array(BLUE) + 0.75 * bare)
    inside = np.zeros((HIGH, WIDE), dtype=bool)
    inside[20:70, 30:90] = True
    on_ball = np.hypot(*(np.indices((HIGH, WIDE)) + 0.5 - np.array([45.0, 60.0])[:, None, None])) < 8.0
    assert np.abs(seen - mixed)[inside & ~on_ball & (bare == BACKGROUND).all(axis=2)].max() <= 1
    assert np.abs(seen - (bare if hidden else mixed))[on_ball].max() <= 1
    assert (seen == bare)[~inside].all()


def test_the_marked_rim_belongs_to_the_chosen_sphere_alone():
    plain = drawn(spheres([(30.0, 45.0, 0.0), (90.0, 45.0, 0.0)], [15.0, 15.0], [BLUE, BLUE]))
    marked = drawn(spheres([(30.0, 45.0, 0.0), (90.0, 45.0, 0.0)], [15.0, 15.0], [BLUE, BLUE], chosen=1))
    assert (plain[:, :60] == marked[:, :60]).all()
    assert (marked[45, 104] != plain[45, 104]).any()
    assert (marked[45, 90] == plain[45, 90]).all()
