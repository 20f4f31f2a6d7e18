"""Rigid bodies of a scene: clumps whose spheres are grains of the scene, and how they move."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ryusa.laws.rigid_body import angular_momentum, rotate, spin
from ryusa.model.arrays import Floats
from ryusa.printed import ByShape

Ints = NDArray[np.int64]
# Columns of `RigidBodies.drag_form`.
STOKES, NEWTON, SPHERICITY = 0, 1, 2  # shape factors of the drag, and the sphericity [-]
N_DRAG_FORM = 3


@dataclass(frozen=True, repr=False)
class RigidBodies(ByShape):
    """Fixed data of clumps. The spheres of a clump are free grains of successive ids: its members.

    Grains that belong to no clump move on their own. The mass of a member in `Scene.m` is its share of the
    mass of its clump, by volume of spheres; contacts see the mass of the clump.
    """

    first: Ints  # ids of the members of clump b are first[b] to first[b] + count[b] - 1, shape (n_body,)
    count: Ints  # members, shape (n_body,)
    arm: Floats  # centres of members in the frame of the principal axes [m], in the order of clumps, (k, 3)
    m: Floats  # mass [kg], shape (n_body,)
    m_weight: Floats  # mass that gravity sees [kg], shape (n_body,)
    inertia: Floats  # principal moments of inertia [kg m2], shape (n_body, 3)
    d: Floats  # diameter of the sphere of the same volume [m], shape (n_body,)
    names: tuple[str, ...] = ()  # names of the forms
    form: Ints = field(default_factory=lambda: np.zeros(0, np.int64))  # number of the form of each, (n_body,)
    # form as the drag of the water sees it, columns as above, (n_body, N_DRAG_FORM); without rows when dry
    drag_form: Floats = field(default_factory=lambda: np.zeros((0, N_DRAG_FORM)))

    @property
    def n(self) -> int:
        """Number of clumps."""
        return len(self.first)

    @property
    def members(self) -> Ints:
        """Ids of all members, in the order of `arm`."""
        offset = np.arange(len(self.arm)) - np.repeat(np.cumsum(self.count) - self.count, self.count)
        return np.repeat(self.first, self.count) + offset

    def rows(self, which: Ints) -> Ints:
        """Rows of `arm` of the members of some clumps, in the order of those."""
        count = self.count[which]
        offset = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
        return np.repeat((np.cumsum(self.count) - self.count)[which], count) + offset

    def some(self, which: Ints, first: Ints) -> "RigidBodies":
        """Some of the clumps, their first members with other ids."""
        rows = {name: getattr(self, name)[which] for name in ("count", "m", "m_weight", "inertia", "d")}
        if len(self.form):
            rows["form"] = self.form[which]
        if len(self.drag_form):
            rows["drag_form"] = self.drag_form[which]
        return replace(self, first=first, arm=self.arm[self.rows(which)], **rows)

    def extent(self, d: Floats) -> Floats:
        """Diameter of the sphere about the centre of each clump that holds it [m], (n_body,).

        `d` are the diameters of all spheres of the scene [m].
        """
        reach = 2.0 * np.linalg.norm(self.arm, axis=1) + d[self.members]
        return np.maximum.reduceat(reach, np.cumsum(self.count) - self.count) if self.n else np.zeros(0)

    def sums(self, of_members: Floats) -> Floats:
        """Sums over the members of each clump of numbers in the order of `arm`, shape (n_body, ...)."""
        if not self.n:
            return np.zeros((0, *of_members.shape[1:]))
        return np.add.reduceat(of_members, np.cumsum(self.count) - self.count, axis=0)

    @property
    def least_mass(self) -> Floats:
        """Least effective mass of a push through the centre of a member of each clump [kg], (n_body,).

        As `Clump.least_mass`: a push along n at the arm a meets 1/m_e = 1/m + (a x n) . I^-1 (a x n).
        """
        a_x, a_y, a_z = self.arm.T
        none = np.zeros_like(a_x)
        cross = np.array([[none, -a_z, a_y], [a_z, none, -a_x], [-a_y, a_x, none]]).transpose(2, 0, 1)
        over = np.repeat(1.0 / self.inertia, self.count, axis=0)
        most = np.linalg.eigvalsh(np.swapaxes(cross, 1, 2) @ (over[:, :, None] * cross))[:, -1]
        most = np.maximum.reduceat(most, np.cumsum(self.count) - self.count) if self.n else np.zeros(0)
        return np.asarray(1.0 / (1.0 / self.m + most))

    def of_grain(self, n_grain: int) -> Ints:
        """Number of the clump of each free grain, -1 for a grain of its own, shape (n_grain,)."""
        found = np.full(n_grain, -1, np.int64)
        found[self.members] = np.repeat(np.arange(self.n), self.count)
        return found

    def fault(self, n_grain: int) -> str:
        """What is wrong with these data for a scene of so many free grains; "" where nothing is."""
        k = int(self.count.sum())
        shapes = {
            "first": (self.first, (self.n,)), "count": (self.count, (self.n,)), "arm": (self.arm, (k, 3)),
            "m": (self.m, (self.n,)), "m_weight": (self.m_weight, (self.n,)),
            "inertia": (self.inertia, (self.n, 3)), "d": (self.d, (self.n,)),
        }  # fmt: skip
        for name, (array, shape) in shapes.items():
            if array.shape != shape:
                return f"bodies.{name} has shape {array.shape}, expected {shape}"
        if (self.count < 1).any() or len(np.unique(self.members)) < k:
            return "a clump has no member, or two clumps share one"
        if k and (self.members.min() < 0 or self.members.max() >= n_grain):
            return f"a member of a clump is none of the {n_grain} free grains"
        if self.drag_form.shape not in ((0, N_DRAG_FORM), (self.n, N_DRAG_FORM)):
            return f"bodies.drag_form has shape {self.drag_form.shape}, expected {(self.n, N_DRAG_FORM)}"
        for name, array in (("m", self.m), ("inertia", self.inertia), ("drag_form", self.drag_form)):
            if not (np.isfinite(array).all() and (array > 0.0).all()):
                return f"bodies.{name} is not finite and positive"
        return ""


@dataclass(frozen=True, repr=False)
class BodyState(ByShape):
    """Motion of clumps; velocities and angular momenta belong to half a step before the rest."""

    x: Floats  # centres of mass [m], shape (n_body, 3)
    v: Floats  # velocities [m/s], shape (n_body, 3)
    q: Floats  # unit quaternions (w, x, y, z) from the frame of the principal axes to space, (n_body, 4)
    momentum: Floats  # angular momenta, in space [N m s], shape (n_body, 3)
    image: NDArray[np.int32]  # periods crossed by the centre of mass in x, y, shape (n_body, 2)

    @staticmethod
    def of(bodies: RigidBodies, x: Floats, v: Floats, q: Floats, omega: Floats) -> "BodyState":
        """Clumps at x with velocities v, orientation q and spin omega in space [rad/s]."""
        q = q / np.linalg.norm(q, axis=1, keepdims=True)
        momentum = np.stack(angular_momentum(*q.T, *omega.T, *bodies.inertia.T), axis=1)
        return BodyState(
            np.array(x, np.float64), np.array(v, np.float64), q, momentum, np.zeros((len(x), 2), np.int32)
        )

    def some(self, which: Ints) -> "BodyState":
        """Motion of some of the clumps."""
        return BodyState(**{name: array[which] for name, array in vars(self).items()})

    def spin(self, bodies: RigidBodies) -> Floats:
        """Spin in space [rad/s], shape (n_body, 3)."""
        return np.stack(spin(*self.q.T, *self.momentum.T, *(1.0 / bodies.inertia).T), axis=1)

    def arms(self, bodies: RigidBodies) -> Floats:
        """From the centre of mass to each member, in space [m], in the order of `RigidBodies.arm`."""
        q = np.repeat(self.q, bodies.count, axis=0)
        return np.stack(rotate(*bodies.arm.T, *q.T), axis=1)

    def of_members(self, bodies: RigidBodies) -> tuple[Floats, Floats, Floats]:
        """Centres [m], velocities [m/s] and spins [rad/s] of all members, each of shape (k, 3)."""
        arms, omega = self.arms(bodies), np.repeat(self.spin(bodies), bodies.count, axis=0)
        x, v = (np.repeat(one, bodies.count, axis=0) for one in (self.x, self.v))
        return x + arms, v + np.cross(omega, arms), omega
