"""Mass properties of clumps against closed forms, the library of shapes, and spheres that make no clump."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ryusa.model.clump import MOST_SPHERES, SHAPES, Clump, ClumpFault, of_spheres, shape
from ryusa.model.union_of_spheres import _by_sections, _heights, moments_of_union, three_overlap

place = st.floats(-1.0, 1.0)
radius = st.floats(0.3, 1.0)


def ball(r):
    return 4.0 / 3.0 * math.pi * r**3


@given(x=st.tuples(place, place, place), r=radius)
def test_one_sphere_is_exact(x, r):
    body = moments_of_union(np.array([x]), np.array([r]))
    assert body.volume == pytest.approx(ball(r), rel=1e-15)
    assert body.centre == pytest.approx(x, abs=1e-15)
    assert body.surface == pytest.approx(4.0 * math.pi * r * r, rel=1e-15)
    assert body.inertia == pytest.approx(0.4 * ball(r) * r * r * np.eye(3), rel=1e-14, abs=1e-16)
    assert body.exact
    assert body.error == 0.0


@given(r=st.tuples(radius, radius), gap=st.floats(0.0, 1.0))
def test_spheres_apart_obey_the_parallel_axis_theorem(r, gap):
    a, b = r
    distance = a + b + gap
    body = moments_of_union(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, distance]]), np.array(r))
    m_a, m_b = ball(a), ball(b)
    own = 0.4 * (m_a * a * a + m_b * b * b)
    across = own + m_a * m_b / (m_a + m_b) * distance**2
    assert body.volume == pytest.approx(m_a + m_b, rel=1e-14)
    assert body.centre[2] == pytest.approx(distance * m_b / (m_a + m_b), rel=1e-14)
    assert np.diag(body.inertia) == pytest.approx([across, across, own], rel=1e-13)


@given(r=st.tuples(radius, radius), share=st.floats(0.02, 0.98))
def test_two_spheres_lose_the_lens_once(r, share):
    a, b = r
    distance = abs(a - b) + share * (a + b - abs(a - b))
    body = moments_of_union(np.array([[0.0, 0.0, 0.0], [distance, 0.0, 0.0]]), np.array(r))
    lens = (
        math.pi
        * (a + b - distance) ** 2
        * (distance**2 + 2.0 * distance * (a + b) - 3.0 * (a - b) ** 2)
        / (12.0 * distance)
    )
    assert body.volume == pytest.approx(ball(a) + ball(b) - lens, rel=1e-13)
    # Archimedes: a zone of a sphere has the surface 2 pi r h, whatever its place
    plane = 0.5 * (distance + (a * a - b * b) / distance)
    hidden = math.tau * (a * (a - plane) + b * (b - (distance - plane)))
    assert body.surface == pytest.approx(4.0 * math.pi * (a * a + b * b) - hidden, rel=1e-13)
    assert body.exact


def test_two_equal_spheres_have_the_inertia_of_four_spherical_segments():
    r, half = 1.0, 0.4
    body = moments_of_union(np.array([[-half, 0.0, 0.0], [half, 0.0, 0.0]]), np.array([r, r]))
    # twice the solid of revolution of y**2 = r**2 - (x - half)**2 over 0 < x < half + r
    x, weight = np.polynomial.legendre.leggauss(8)
    x, weight = 0.5 * (half + r) * (x + 1.0), 0.5 * (half + r) * weight
    square = r * r - (x - half) ** 2
    along = 2.0 * math.pi * float((weight * 0.5 * square**2).sum())
    across = 0.5 * along + 2.0 * math.pi * float((weight * square * x * x).sum())
    assert np.diag(body.inertia) == pytest.approx([along, across, across], rel=1e-14)


@settings(max_examples=40, deadline=None)
@given(
    r=st.tuples(radius, radius),
    share=st.floats(0.05, 0.95),
    turn=st.tuples(place, place, place),
)
def test_sections_agree_with_the_closed_form(r, share, turn):
    a, b = r
    distance = abs(a - b) + share * (a + b - abs(a - b))
    x = np.array([[0.0, 0.0, 0.0], Rotation.from_rotvec(turn).apply([distance, 0.0, 0.0])])
    body = moments_of_union(x, np.array(r))
    total = _by_sections(x, np.array(r), _heights(x, np.array(r)), 60)
    assert total[0] == pytest.approx(body.volume, rel=1e-9)
    assert total[13] == pytest.approx(body.surface, rel=1e-7)
    second = total[4:13].reshape(3, 3) - total[0] * np.outer(body.centre, body.centre)
    assert second == pytest.approx(body.second, abs=1e-9 * np.trace(body.second))


def test_three_spheres_on_a_line_that_all_overlap_have_the_volume_of_their_closed_form():
    rotated = Rotation.from_rotvec([0.3, -0.7, 1.1]).apply(np.array([[k * 0.5, 0.0, 0.0] for k in range(3)]))
    lens = math.pi * 4.5 * 1.5**2 / 12.0
    for x in (rotated, rotated[[2, 0, 1]], np.array([[0.0, 0.0, 0.5 * k] for k in range(3)])):
        body = moments_of_union(x, np.ones(3))
        assert not body.exact
        assert body.volume == pytest.approx(3.0 * ball(1.0) - 2.0 * lens, rel=1e-9)
        assert body.error < 1e-9


@pytest.mark.parametrize("seed", range(4))
def test_many_overlapping_spheres_agree_with_random_points(seed):
    draw = np.random.default_rng(seed)
    x, r = draw.uniform(-1.0, 1.0, (8, 3)), draw.uniform(0.5, 0.9, 8)
    body = moments_of_union(x, r)
    assert three_overlap(x, r)
    low, high = (x - r[:, None]).min(axis=0), (x + r[:, None]).max(axis=0)
    n, box = 400_000, float(np.prod(high - low))
    points = draw.uniform(low, high, (n, 3))
    inside = np.zeros(n, dtype=np.bool_)
    for one, radius in zip(x, r, strict=True):
        inside |= ((points - one) ** 2).sum(axis=1) < radius**2
    share = inside.mean()
    assert abs(body.volume - box * share) < 5.0 * box * math.sqrt(share * (1.0 - share) / n)
    arms = points[inside] - body.centre
    products = arms[:, :, None] * arms[:, None, :]
    slack = 5.0 * products.std(axis=0) / math.sqrt(len(arms))
    assert (np.abs(products.mean(axis=0) - body.second / body.volume) < slack).all()
    assert (np.abs(arms.mean(axis=0)) < 5.0 * arms.std(axis=0) / math.sqrt(len(arms))).all()
    assert body.error < 1e-8
    seen = 0.0
    spread = 0.0
    for k, (one, radius) in enumerate(zip(x, r, strict=True)):
        there = draw.normal(size=(50_000, 3))
        there = one + radius * there / np.linalg.norm(there, axis=1)[:, None]
        apart = ((there[:, None] - np.delete(x, k, axis=0)) ** 2).sum(axis=2)
        bare = (apart > np.delete(r, k) ** 2).all(axis=1).mean()
        seen += 4.0 * math.pi * radius**2 * bare
        spread += (4.0 * math.pi * radius**2) ** 2 * bare * (1.0 - bare) / len(there)
    assert abs(body.surface - seen) < 5.0 * math.sqrt(spread)


@settings(max_examples=20, deadline=None)
@given(
    turn=st.tuples(place, place, place), shift=st.tuples(place, place, place), name=st.sampled_from([*SHAPES])
)
def test_neither_turning_nor_shifting_changes_a_clump(turn, shift, name):
    spheres = np.array(SHAPES[name][1])
    x = Rotation.from_rotvec(turn).apply(spheres[:, :3]) + shift
    here, there = of_spheres(SHAPES[name][1]), Clump.of(x, spheres[:, 3])
    assert there.volume == pytest.approx(here.volume, rel=1e-8)
    assert there.inertia == pytest.approx(here.inertia, rel=1e-8)
    assert there.zingg == pytest.approx(here.zingg, rel=1e-7)
    back = there.x @ there.axes.T + there.centre
    assert back == pytest.approx(x, abs=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_the_body_frame_is_that_of_the_principal_axes(name):
    clump = shape(name, 0.002)
    assert clump.d_volume == pytest.approx(0.002, rel=1e-14)
    assert clump.axes.T @ clump.axes == pytest.approx(np.eye(3), abs=1e-14)
    assert np.linalg.det(clump.axes) == pytest.approx(1.0, rel=1e-14)
    assert (np.diff(clump.inertia) >= -1e-9 * clump.inertia[2]).all()
    body = moments_of_union(clump.x, 0.5 * clump.d)
    assert body.inertia == pytest.approx(np.diag(clump.inertia), abs=1e-9 * clump.inertia[2])
    assert body.centre == pytest.approx(0.0, abs=1e-12 * clump.d_volume)


def test_shapes_fall_into_the_classes_that_their_names_say():
    found = {name: shape(name).zingg_class for name in SHAPES}
    assert found == {
        "sphere": "equant", "dumbbell": "rod", "pebble": "rod", "rod": "rod", "triangle": "disc",
        "tetrahedron": "equant", "disc": "disc", "blade": "blade",
    }  # fmt: skip


def test_ratios_of_known_forms():
    assert shape("sphere").zingg == pytest.approx((1.0, 1.0), rel=1e-12)
    assert shape("tetrahedron").zingg == pytest.approx((1.0, 1.0), rel=1e-8)
    assert shape("dumbbell").zingg == pytest.approx((1.0 / math.sqrt(6.0), 1.0), rel=1e-12)
    pair = of_spheres(SHAPES["dumbbell"][1])
    assert pair.widths == pytest.approx((2.0, 1.0, 1.0), rel=1e-15)
    assert pair.corey == pytest.approx(6.0**-0.25, rel=1e-12)


def test_three_spheres_that_overlap_by_pairs_alone_are_exact():
    spread = np.array([[math.cos(k * math.tau / 3.0), math.sin(k * math.tau / 3.0), 0.0] for k in range(3)])
    assert not three_overlap(spread * 1.001, np.ones(3))  # all meet in the middle at 1
    assert three_overlap(spread * 0.999, np.ones(3))
    apart = moments_of_union(spread * 1.0000001, np.ones(3))
    near = moments_of_union(spread * 0.9999999, np.ones(3))
    assert apart.exact
    assert not near.exact
    assert near.volume == pytest.approx(apart.volume, rel=1e-6)


BAD = {
    "inside": ([(0.0, 0.0, 0.0, 2.0), (0.1, 0.0, 0.0, 1.0)], 1, "sphere 1 lies wholly inside sphere 0"),
    "twice": ([(0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0)], 1, "sphere 1 lies wholly inside sphere 0"),
    "apart": (
        [(0.0, 0.0, 0.0, 1.0), (0.9, 0.0, 0.0, 1.0), (2.0, 0.0, 0.0, 1.0)],
        2,
        "sphere 2 is not joined to sphere 0, its gap to the spheres that are is 0.1 m",
    ),
    "negative": ([(0.0, 0.0, 0.0, -1.0)], 0, "sphere 0 has the diameter -1 m"),
    "nan": ([(0.0, math.nan, 0.0, 1.0)], 0, "sphere 0 has a centre or diameter that is not finite"),
    "none": ([], 0, "0 spheres; a clump has 1 to"),
    "many": ([(0.5 * k, 0.0, 0.0, 1.0) for k in range(MOST_SPHERES + 1)], MOST_SPHERES, "1 to"),
}


@pytest.mark.parametrize("name", BAD)
def test_spheres_that_make_no_clump_are_named(name):
    spheres, sphere, message = BAD[name]
    with pytest.raises(ClumpFault, match=message) as fault:
        of_spheres(spheres)
    assert fault.value.sphere == sphere


def test_arrays_of_other_shapes_are_refused():
    with pytest.raises(ClumpFault, match=r"need \(n, 3\), \(n,\)"):
        Clump.of(np.zeros((2, 2)), np.ones(2))


@pytest.mark.parametrize("name", ["rods", ""])
def test_a_shape_that_is_not_there_is_refused_with_those_that_are(name):
    with pytest.raises(ValueError, match="there are sphere, dumbbell"):
        shape(name)


@pytest.mark.parametrize("d", [0.0, -1.0, math.inf, math.nan])
def test_a_shape_without_a_size_is_refused(d):
    with pytest.raises(ValueError, match="must be positive and finite"):
        shape("rod", d)


def test_the_order_of_the_spheres_does_not_matter():
    spheres = SHAPES["triangle"][1]
    volumes = [of_spheres(one).volume for one in itertools.permutations(spheres)]
    assert max(volumes) == pytest.approx(min(volumes), rel=1e-12)
