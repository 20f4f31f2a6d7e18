"""Clumps: rigid bodies of spheres, their mass properties, form, and a small library of shapes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from ryusa.laws._family import numbers
from ryusa.laws.families import DragOfForm
from ryusa.laws.nonspherical import shape_factors_bagheri_bonadonna, shape_factors_ganser
from ryusa.model.arrays import Floats
from ryusa.model.union_of_spheres import moments_of_union
from ryusa.printed import ByShape

MOST_SPHERES = 64
_GAP = 1.0e-9  # spheres nearer than this share of the sum of their radii touch
_, GANSER, _, BAGHERI_BONADONNA = numbers(
    __name__,
    DragOfForm.SPHERE,
    DragOfForm.GANSER,
    DragOfForm.HAIDER_LEVENSPIEL,
    DragOfForm.BAGHERI_BONADONNA,
)
_EQUAL = 1.0e-9  # moments of inertia that differ by less than this share are equal


class ClumpFault(ValueError):
    """Spheres that make no clump: what is wrong, and at which sphere.

    Attributes
    ----------
    sphere : number of the sphere, from 0, in the order given.
    """

    def __init__(self, message: str, sphere: int) -> None:
        self.sphere = sphere
        super().__init__(message)


@dataclass(frozen=True, repr=False)
class Clump(ByShape):
    """A rigid body of spheres in the frame of its principal axes, with the centre of mass at 0.

    Its matter fills the union of the spheres evenly: what spheres share counts once.

    Attributes
    ----------
    x : centres of the spheres [m], shape (n_sphere, 3).
    d : their diameters [m], shape (n_sphere,).
    volume : of the union [m3].
    surface : of the union [m2].
    inertia : principal moments over the density [m5], ascending, shape (3,); axis 1 is the long one.
    centre : centre of mass in the frame in which the spheres were given [m], shape (3,).
    axes : principal axes in that frame, one per column, right-handed, shape (3, 3).
    exact : whether volume, surface and inertia are closed forms.
    error : relative error of volume and inertia, as estimated; 0 for closed forms [-]. That of the surface is
        larger, 1e-8 for a tetrahedron.
    """

    x: Floats
    d: Floats
    volume: float
    surface: float
    inertia: Floats
    centre: Floats
    axes: Floats
    exact: bool
    error: float

    @classmethod
    def of(cls, x: Floats, d: Floats) -> Self:
        """Clump of spheres of centres x [m] and diameters d [m], in any frame.

        Raises
        ------
        ClumpFault : a number that is not finite, a diameter that is not positive, no sphere or too many,
            one wholly inside another, or spheres that do not touch the rest.

        >>> pair = Clump.of(np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([1.0, 1.0]))
        >>> round(pair.volume / (math.pi / 6.0), 12), (pair.inertia / pair.volume).round(12).tolist()
        (2.0, [0.1, 0.35, 0.35])
        >>> pair.x.round(12).tolist()
        [[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]
        """
        x, d = np.array(x, dtype=np.float64), np.array(d, dtype=np.float64)
        _check(x, d)
        body = moments_of_union(x, 0.5 * d)
        inertia, axes = _principal(body.inertia)
        return cls(
            (x - body.centre) @ axes, d, body.volume, body.surface, inertia, body.centre, axes, body.exact,
            body.error,
        )  # fmt: skip

    @property
    def d_volume(self) -> float:
        """Diameter of the sphere of the same volume [m]."""
        return (6.0 * self.volume / math.pi) ** (1.0 / 3.0)

    @property
    def lengths(self) -> tuple[float, float, float]:
        """Lengths a >= b >= c of the ellipsoid whose inertia over volume is that of the clump [m].

        Notes
        -----
        The second moment of an ellipsoid along an axis of length a is volume times a**2/20. They depend on
        the form alone, also where principal axes are not unique, as those of a tetrahedron.
        """
        second = 0.5 * self.inertia.sum() - self.inertia  # along axes 1, 2, 3
        a, b, c = np.sqrt(20.0 * np.maximum(second, 0.0) / self.volume).tolist()
        return a, b, c

    @property
    def widths(self) -> tuple[float, float, float]:
        """What a calliper finds along the principal axes 1, 2, 3 [m].

        Where moments are equal, the axes are a choice and so are these.
        """
        half = 0.5 * self.d[:, None]
        a, b, c = ((self.x + half).max(axis=0) - (self.x - half).min(axis=0)).tolist()
        return a, b, c

    @property
    def zingg(self) -> tuple[float, float]:
        """Ratios b/a and c/b of the lengths [-] (Zingg 1935)."""
        a, b, c = self.lengths
        return b / a, c / b

    @property
    def zingg_class(self) -> str:
        """Zingg's class: disc, equant, blade or rod, divided at 2/3."""
        flat, thick = self.zingg
        if flat > 2.0 / 3.0:
            return "equant" if thick > 2.0 / 3.0 else "disc"
        return "rod" if thick > 2.0 / 3.0 else "blade"

    @property
    def corey(self) -> float:
        """Corey's shape factor c/sqrt(a b) of the lengths [-]."""
        a, b, c = self.lengths
        return c / math.sqrt(a * b)

    @property
    def sphericity(self) -> float:
        """Surface of the sphere of the same volume over that of the clump [-] (Wadell 1933).

        >>> round(Clump.of(np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]), np.ones(2)).sphericity, 6)
        0.793701
        """
        return math.pi * self.d_volume**2 / self.surface

    @property
    def precision(self) -> str:
        """How well volume and inertia are known, in words.

        >>> Clump.of(np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]), np.ones(2)).precision
        'in closed form'
        """
        return "in closed form" if self.exact else f"summed over sections, to {self.error:.1g}"

    @property
    def least_mass(self) -> float:
        """Least effective mass of a push through the centre of one of its spheres, over the mass [-].

        Notes
        -----
        A push along n at the arm a turns the clump too: 1/m_e = 1/m + (a x n) . I^-1 (a x n).

        >>> round(Clump.of(np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]), np.ones(2)).least_mass, 6)
        0.583333
        """
        most = 0.0
        for a_x, a_y, a_z in self.x:
            cross = np.array([[0.0, -a_z, a_y], [a_z, 0.0, -a_x], [-a_y, a_x, 0.0]])
            mobility = cross.T @ (cross / self.inertia[:, None])
            most = max(most, float(np.linalg.eigvalsh(mobility)[-1]))
        return 1.0 / (1.0 + self.volume * most)

    @property
    def extent(self) -> float:
        """Diameter of the sphere about the centre of mass that holds all spheres [m]."""
        return 2.0 * float((np.linalg.norm(self.x, axis=1) + 0.5 * self.d).max())

    def scaled(self, factor: float) -> "Clump":
        """The same form, all lengths times a factor > 0.

        >>> ball = Clump.of(np.zeros((1, 3)), np.ones(1)).scaled(2.0)
        >>> round(ball.d_volume, 12), ball.d.tolist()
        (2.0, [2.0])
        """
        return Clump(
            self.x * factor,
            self.d * factor,
            self.volume * factor**3,
            self.surface * factor**2,
            self.inertia * factor**5,
            self.centre * factor,
            self.axes,
            self.exact,
            self.error,
        )


def _check(x: Floats, d: Floats) -> None:
    """Refuse spheres that make no clump, by the number of the first that is wrong."""
    if x.ndim != 2 or x.shape[1] != 3 or d.shape != (len(x),):
        raise ClumpFault(f"centres of shape {x.shape} and diameters of shape {d.shape}; need (n, 3), (n,)", 0)
    n = len(d)
    if not 1 <= n <= MOST_SPHERES:
        raise ClumpFault(f"{n} spheres; a clump has 1 to {MOST_SPHERES}", min(n, MOST_SPHERES))
    for k in range(n):
        if not (np.isfinite(x[k]).all() and math.isfinite(d[k])):
            raise ClumpFault(f"sphere {k} has a centre or diameter that is not finite", k)
        if d[k] <= 0.0:
            raise ClumpFault(f"sphere {k} has the diameter {d[k]:g} m; it must be positive", k)
    r = 0.5 * d
    apart = np.linalg.norm(x[:, None] - x[None], axis=2)
    for k in range(n):
        for j in range(n):
            if j != k and apart[k, j] + r[k] <= r[j] * (1.0 + _GAP) and (r[k] < r[j] or j < k):
                raise ClumpFault(f"sphere {k} lies wholly inside sphere {j}; leave it out", k)
    together = apart <= (r[:, None] + r[None]) * (1.0 + _GAP)
    reached = np.zeros(n, dtype=np.bool_)
    reached[0] = True
    while (more := together[reached].any(axis=0) & ~reached).any():
        reached |= more
    if not reached.all():
        k = int(np.argmin(reached))
        gap = float((apart[k] - r - r[k])[reached].min())
        raise ClumpFault(
            f"sphere {k} is not joined to sphere 0, its gap to the spheres that are is {gap:.3g} m;"
            " the spheres of a clump touch",
            k,
        )


def _principal(tensor: Floats) -> tuple[Floats, Floats]:
    """Principal moments, ascending, and a right-handed frame of axes that depends on the tensor alone.

    Where moments are equal the axes are the directions of the frame given, as near as they can be, so that
    round-off turns nothing.
    """
    values, vectors = np.linalg.eigh(tensor)
    groups: list[list[int]] = [[0]]
    for k in (1, 2):
        if values[k] - values[k - 1] <= _EQUAL * values[2]:
            groups[-1].append(k)
        else:
            groups.append([k])
    columns: list[Floats] = []
    for group in groups:
        space = vectors[:, group]
        onto = space @ space.T
        for _ in group:
            k = int(np.argmax(np.round(np.diag(onto), 6)))
            one = onto[:, k] / math.sqrt(onto[k, k])
            columns.append(one)
            onto = onto - np.outer(one, one)
    axes = np.stack(columns, axis=1)
    if np.linalg.det(axes) < 0.0:
        axes[:, 2] = -axes[:, 2]
    return np.array([axes[:, k] @ tensor @ axes[:, k] for k in range(3)]), axes


_EDGE = 0.75 / math.sqrt(8.0)  # corners of a cube of twice this are those of a tetrahedron of edge 3/4

# name: what it is, and its spheres as x, y, z, d
SHAPES: dict[str, tuple[str, tuple[tuple[float, float, float, float], ...]]] = {
    "sphere": ("one sphere", ((0.0, 0.0, 0.0, 1.0),)),
    "dumbbell": ("two spheres that touch", ((-0.5, 0.0, 0.0, 1.0), (0.5, 0.0, 0.0, 1.0))),
    "pebble": ("two spheres half a diameter apart", ((-0.25, 0.0, 0.0, 1.0), (0.25, 0.0, 0.0, 1.0))),
    "rod": (
        "three spheres in a row, half a diameter apart",
        ((-0.5, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0), (0.5, 0.0, 0.0, 1.0)),
    ),
    "triangle": (
        "three spheres on the corners of a triangle, 3/4 of a diameter apart",
        tuple(
            (math.sqrt(3.0) / 4.0 * math.cos(angle), math.sqrt(3.0) / 4.0 * math.sin(angle), 0.0, 1.0)
            for angle in (0.0, math.tau / 3.0, 2.0 * math.tau / 3.0)
        ),
    ),
    "tetrahedron": (
        "four spheres on the corners of a tetrahedron, 3/4 of a diameter apart",
        tuple(
            (x * _EDGE, y * _EDGE, z * _EDGE, 1.0)
            for x, y, z in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
        ),
    ),
    "disc": (
        "a sphere amid a ring of six, 3/4 of a diameter apart",
        (
            (0.0, 0.0, 0.0, 1.0),
            *(
                (0.75 * math.cos(k * math.tau / 6.0), 0.75 * math.sin(k * math.tau / 6.0), 0.0, 1.0)
                for k in range(6)
            ),
        ),
    ),
    "blade": (
        "two rows of four spheres, 3/4 of a diameter apart",
        tuple((0.75 * (i - 1.5), 0.75 * (j - 0.5), 0.0, 1.0) for i in range(4) for j in range(2)),
    ),
}


def shape(name: str, d: float = 1.0) -> Clump:
    """A clump of the library whose volume is that of a sphere of diameter d [m].

    Parameters
    ----------
    name : a key of `SHAPES`.
    d : diameter of the sphere of the same volume [m].

    Raises
    ------
    ValueError : no such shape, or d is not positive and finite.

    >>> [round(one, 3) for one in shape("dumbbell").zingg], shape("dumbbell").zingg_class
    ([0.408, 1.0], 'rod')
    """
    if name not in SHAPES:
        raise ValueError(f"no shape {name!r}; there are {', '.join(SHAPES)}")
    if not 0.0 < d < math.inf:
        raise ValueError(f"d = {d!r}: the diameter of a shape must be positive and finite [m]")
    clump = of_spheres(SHAPES[name][1])
    return clump.scaled(d / clump.d_volume)


def drag_form(law: DragOfForm, clump: Clump, density_ratio: float) -> tuple[float, float, float]:
    """Form of a clump as a law of drag takes it: its shape factors Stokes and Newton, and its sphericity [-].

    Parameters
    ----------
    density_ratio : density of the clump over that of the water [-].
    """
    stokes = newton = 1.0
    if int(law) == GANSER:
        stokes, newton = shape_factors_ganser(clump.sphericity)
    elif int(law) == BAGHERI_BONADONNA:
        a, b, c = clump.lengths
        fullness = clump.d_volume**3 / (a * b * c)
        stokes, newton = shape_factors_bagheri_bonadonna(b / a, c / b, fullness, density_ratio)
    return stokes, newton, clump.sphericity


def of_spheres(spheres: Sequence[tuple[float, float, float, float]]) -> Clump:
    """Clump of spheres as x, y, z, d [m].

    Raises
    ------
    ClumpFault : as `Clump.of`.
    """
    rows = np.array(spheres, dtype=np.float64).reshape(-1, 4)
    return Clump.of(rows[:, :3], rows[:, 3])
