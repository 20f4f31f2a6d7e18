"""Volume, surface and moments of a body made of spheres that overlap.

Where no point lies in three spheres, the body is the sum of its spheres less the lenses in which two overlap,
each a pair of caps: closed forms. Else the body is cut into sections across z. A section is a union of
circles, whose area and moments follow from the arcs of its outline (Green's theorem); along z they are summed
by a Gauss rule between the heights where the outline changes its form.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from ryusa.laws import slices
from ryusa.model.arrays import Floats

NODES = (10, 30)  # least and most of the Gauss rule between two heights
_ARC = np.polynomial.legendre.leggauss(24)  # exact to round-off for polynomials of degree 4 in cos and sin
_ALIKE = 1.0e-12  # heights nearer than this share of the whole are one


@dataclass(frozen=True)
class Moments:
    """Volume and moments of a body of density 1.

    Attributes
    ----------
    volume : [m3].
    surface : [m2].
    centre : centre of mass [m], shape (3,).
    second : integrals of the products of coordinates from the centre [m5], shape (3, 3), symmetric.
    exact : whether they are closed forms.
    error : largest error of the volume over the volume, and of `second` over its trace, as estimated [-];
        the difference to a rule of 2/3 as many nodes; 0 for closed forms, whose error is round-off.
    """

    volume: float
    surface: float
    centre: Floats
    second: Floats
    exact: bool
    error: float

    @property
    def inertia(self) -> Floats:
        """Tensor of inertia about the centre over the density [m5], shape (3, 3)."""
        return np.trace(self.second) * np.eye(3) - self.second


def moments_of_union(x: Floats, r: Floats, *, nodes: int | None = None) -> Moments:
    """Volume, centre and second moments of the union of spheres.

    Parameters
    ----------
    x : centres [m], shape (n, 3).
    r : radii [m], shape (n,), > 0. No sphere lies wholly inside another.
    nodes : of the Gauss rule between two heights, where sections are summed; fine when not given.

    Notes
    -----
    For one sphere, spheres apart from each other and spheres that overlap in pairs alone in closed form.

    >>> body = moments_of_union(np.zeros((1, 3)), np.ones(1))
    >>> round(body.volume / np.pi, 12), (body.inertia.diagonal() / body.volume).round(12).tolist()
    (1.333333333333, [0.4, 0.4, 0.4])
    """
    origin, scale = x.mean(axis=0), float(r.max())
    x, r = (x - origin) / scale, r / scale
    if three_overlap(x, r):
        heights = _heights(x, r)
        nodes = nodes or max(NODES[0], min(NODES[1], 1500 // len(heights)))
        fine, coarse = (_by_sections(x, r, heights, one) for one in (nodes, 2 * nodes // 3))
        change = np.abs(fine - coarse)
        second = fine[4:13].reshape(3, 3)
        error = max(float(change[0] / fine[0]), float(change[4:13].max() / np.trace(second)))
        error = max(error, float(np.finfo(np.float64).eps))
        total, exact = fine, False
    else:
        total, exact, error = _by_pairs(x, r), True, 0.0
    volume, centre = float(total[0]), total[1:4] / total[0]
    second = total[4:13].reshape(3, 3) - volume * np.outer(centre, centre)
    surface = float(total[13]) * scale**2
    return Moments(volume * scale**3, surface, origin + scale * centre, second * scale**5, exact, error)


def touching(x: Floats, r: Floats) -> list[tuple[int, int]]:
    """Pairs of spheres that overlap, i < j."""
    found = []
    for i, j in itertools.combinations(range(len(r)), 2):
        if math.dist(x[i], x[j]) < r[i] + r[j]:
            found.append((i, j))
    return found


def three_overlap(x: Floats, r: Floats) -> bool:
    """Whether some point lies inside three spheres."""
    return any(_nearest_in_lens(x, r, i, j, k) < r[k] for i, j, k in _triangles(x, r))


def _triangles(x: Floats, r: Floats) -> list[tuple[int, int, int]]:
    """Spheres of which each two overlap, i < j < k."""
    pairs = touching(x, r)
    known, after = set(pairs), {i: [j for a, j in pairs if a == i] for i in range(len(r))}
    return [(i, j, k) for i, j in pairs for k in after[i] if (j, k) in known]


def _nearest_in_lens(x: Floats, r: Floats, i: int, j: int, k: int) -> float:
    """Distance of the centre of sphere k from the nearest point of the lens of i and j."""
    for near, other in ((i, j), (j, i)):
        arm = x[k] - x[near]
        away = math.sqrt(arm @ arm)
        nearest = x[k] if away <= r[near] else x[near] + arm * (r[near] / away)
        if math.dist(nearest, x[other]) <= r[other]:
            return math.dist(nearest, x[k])
    middle, axis, radius = _circle(x, r, i, j)
    arm = x[k] - middle
    along = float(arm @ axis)
    across = math.sqrt(max(float(arm @ arm) - along * along, 0.0))
    return math.hypot(along, across - radius)


def _circle(x: Floats, r: Floats, i: int, j: int) -> tuple[Floats, Floats, float]:
    """Centre, axis and radius of the circle in which the surfaces of two spheres meet."""
    arm = x[j] - x[i]
    distance = math.sqrt(arm @ arm)
    axis = arm / distance
    height = 0.5 * (distance + (r[i] - r[j]) * (r[i] + r[j]) / distance)
    return x[i] + height * axis, axis, math.sqrt(max((r[i] - height) * (r[i] + height), 0.0))


def _by_pairs(x: Floats, r: Floats) -> Floats:
    """Volume, first and second moments about 0, surface: spheres less the lenses of pairs."""
    total = np.zeros(14)
    for one, radius in zip(x, r.tolist(), strict=True):
        total += _part(one, np.array([0.0, 0.0, 1.0]), radius, -radius)
    for i, j in touching(x, r):
        middle, axis, _ = _circle(x, r, i, j)
        total -= _part(x[i], axis, float(r[i]), float((middle - x[i]) @ axis))
        total -= _part(x[j], -axis, float(r[j]), float((x[j] - middle) @ axis))
    return total


def _part(centre: Floats, axis: Floats, r: float, low: float) -> Floats:
    """Volume, moments about 0 and curved surface of the cap of a sphere beyond a plane across `axis`."""
    volume = slices.sphere_slice(r, low, r)
    first, along, across = slices.sphere_slice_moments(r, low, r)
    arm = first * axis
    outer = np.outer(axis, axis)
    second = along * outer + across * (np.eye(3) - outer)
    second += np.outer(centre, arm) + np.outer(arm, centre) + volume * np.outer(centre, centre)
    curved = math.tau * r * (r - low)
    return np.concatenate([[volume], volume * centre + arm, second.ravel(), [curved]])


def _by_sections(x: Floats, r: Floats, heights: list[float], nodes: int) -> Floats:
    """Volume, first and second moments about 0, surface, summed over sections between heights."""
    node, weight = np.polynomial.legendre.leggauss(nodes)
    # z = a + (b - a) sin**2(pi u/2): roots of the distance to an end become smooth in u
    u = 0.25 * math.pi * (node + 1.0)
    place, slope = np.sin(u) ** 2, 0.25 * math.pi * np.sin(2.0 * u)
    total = np.zeros(14)
    for a, b in itertools.pairwise(heights):
        for one, each in zip(
            (a + (b - a) * place).tolist(), (weight * slope * (b - a)).tolist(), strict=True
        ):
            area, s_x, s_y, s_xx, s_yy, s_xy, outline = _section(x, r, one).tolist()
            second = [s_xx, s_xy, one * s_x, s_xy, s_yy, one * s_y, one * s_x, one * s_y, one * one * area]
            total += each * np.array([area, s_x, s_y, one * area, *second, outline])
    return total


def _heights(x: Floats, r: Floats) -> list[float]:
    """Heights at which the outline of a section changes its form, ascending."""
    up = np.array([0.0, 0.0, 1.0])
    points = [x[i] + sign * r[i] * up for i in range(len(r)) for sign in (-1.0, 1.0)]
    for i, j in touching(x, r):
        middle, axis, radius = _circle(x, r, i, j)
        steep = up - axis[2] * axis
        if not _level(axis):
            points += [middle + sign * radius / math.sqrt(steep @ steep) * steep for sign in (-1.0, 1.0)]
    for i, j, k in _triangles(x, r):
        points += _corners(x, r, i, j, k)
    level = [float(one[2]) for one in points if not _hidden(one, x, r)]
    level += [float((x[:, 2] - r).min()), float((x[:, 2] + r).max())]
    level += [float(_circle(x, r, i, j)[0][2]) for i, j in touching(x, r) if _level(x[j] - x[i])]
    level.sort()
    least = _ALIKE * (level[-1] - level[0])
    kept = level[:1]
    for one in level[1:]:
        if one - kept[-1] > least:
            kept.append(one)
    return kept


def _level(arm: Floats) -> bool:
    """Whether the circle across an arm is level."""
    return math.hypot(arm[0], arm[1]) <= 1.0e-6 * abs(float(arm[2]))


def _hidden(point: Floats, x: Floats, r: Floats) -> bool:
    """Whether a point lies inside a sphere, deeper than round-off."""
    return bool((np.linalg.norm(x - point, axis=1) < r * (1.0 - 1.0e-9)).any())


def _corners(x: Floats, r: Floats, i: int, j: int, k: int) -> list[Floats]:
    """Points that lie on the surfaces of three spheres."""
    middle, axis, radius = _circle(x, r, i, j)
    arm = x[k] - middle
    flat = arm - float(arm @ axis) * axis
    across = math.sqrt(flat @ flat)
    if across == 0.0 or radius == 0.0:
        return []
    flat /= across
    cosine = (float(arm @ arm) + (radius - r[k]) * (radius + r[k])) / (2.0 * radius * across)
    if abs(cosine) > 1.0:
        return []
    side = np.cross(axis, flat) * math.sqrt((1.0 - cosine) * (1.0 + cosine))
    return [middle + radius * (cosine * flat + sign * side) for sign in (-1.0, 1.0)]


def _section(x: Floats, r: Floats, z: float) -> Floats:
    """Area and integrals of x, y, x**2, y**2, x y over the section of the union at height z, and surface.

    The surface per height [m]: a sphere of radius r has r times the angle of its arc.
    """
    square = (r - (z - x[:, 2])) * (r + (z - x[:, 2]))
    cut = square > 0.0
    centres, radii, spheres = x[cut, :2].tolist(), np.sqrt(square[cut]).tolist(), r[cut].tolist()
    total = np.zeros(7)
    for k, ((x_c, y_c), radius) in enumerate(zip(centres, radii, strict=True)):
        arcs = _open_arcs(centres, radii, k)
        if not arcs:
            continue
        ends = np.array(arcs)
        half = 0.5 * (ends[:, 1] - ends[:, 0])[:, None]
        angle = 0.5 * (ends[:, 0] + ends[:, 1])[:, None] + half * _ARC[0]
        cosine, sine = np.cos(angle), np.sin(angle)
        px, py = x_c + radius * cosine, y_c + radius * sine
        dx, dy = -radius * sine, radius * cosine
        weight = half * _ARC[1]
        forms = (
            0.5 * (px * dy - py * dx),
            0.5 * px**2 * dy,
            -0.5 * py**2 * dx,
            px**3 * dy / 3.0,
            -(py**3) * dx / 3.0,
            0.5 * px**2 * py * dy,
        )
        outline = spheres[k] * float((ends[:, 1] - ends[:, 0]).sum())
        total += [*(float((weight * form).sum()) for form in forms), outline]
    return total


def _open_arcs(centres: list[list[float]], radii: list[float], k: int) -> list[tuple[float, float]]:
    """Arcs of circle k that lie inside no other circle: their first and last angles."""
    (x_k, y_k), r_k = centres[k], radii[k]
    covered: list[tuple[float, float]] = []
    for j, ((x_j, y_j), r_j) in enumerate(zip(centres, radii, strict=True)):
        if j == k:
            continue
        distance = math.hypot(x_j - x_k, y_j - y_k)
        if distance >= r_k + r_j or distance + r_j < r_k or (distance + r_j == r_k and j > k):
            continue
        if distance + r_k <= r_j:  # of two equal circles the first counts
            if distance + r_k < r_j or distance > 0.0 or j < k:
                return []
            continue
        cosine = (distance * distance + (r_k - r_j) * (r_k + r_j)) / (2.0 * distance * r_k)
        half = math.acos(min(max(cosine, -1.0), 1.0))
        begin = (math.atan2(y_j - y_k, x_j - x_k) - half) % math.tau
        end = begin + 2.0 * half
        covered += [(begin, end)] if end <= math.tau else [(begin, math.tau), (0.0, end - math.tau)]
    arcs, at = [], 0.0
    for begin, end in sorted(covered):
        if begin > at:
            arcs.append((at, begin))
        at = max(at, end)
    return [*arcs, (at, math.tau)] if at < math.tau else arcs
