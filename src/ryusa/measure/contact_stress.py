"""Stress of the grains over height by coarse graining: contacts, motion, mu, I, balance of momentum."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.laws.families import Profile
from ryusa.measure._run import Floats, Run, crest_of
from ryusa.measure.bed_area import area_of
from ryusa.measure.layers import Layers, layers_mean, layers_quotient
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import Average, average
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.measure.transport import window_of
from ryusa.model import Scene
from ryusa.model.scene import Bools
from ryusa.model.wall_contacts import away_from_surfaces

AXES = ((0, 0), (1, 1), (2, 2), (0, 2), (2, 0))  # components xx, yy, zz, xz, zx
XX, YY, ZZ, XZ = range(4)
FABRIC = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
PLANE = ((0, 0), (2, 2), (0, 2))  # components of the fabric over height: in the plane of shear
REACH = 4.0  # lengths of coarse graining beyond the outermost grains
FLAT = 1.0e-6  # branch vectors flatter than this, in lengths of coarse graining, count as level
BLOCK = 2_000  # contacts or grains taken at once
LID = 0.5  # vertical part of a branch vector from which on its fixed partner lies above the grain


@dataclass(frozen=True, repr=False)
class ContactStress(Averaged):
    """Stress over height, mean over time, along the bed and across; pressure is positive.

    Attributes
    ----------
    z : heights above the datum [m], shape (n_layer,), one length of coarse graining apart.
    length : of the coarse graining, the standard deviation of its Gaussian [m].
    crest : height of the top of the highest fixed grain above the datum [m]; nan where there is none.
    phi : concentration [-].
    v_x : velocity along the bed, weighted with mass [m/s].
    xx, yy, zz, xz, zx : stress of contacts and motion together [Pa]; xz is the force along x on a plane
        normal to z, below zero where what lies above drags the grains downstream.
    contact_zz, contact_xz : the part of the contacts [Pa].
    p : pressure, mean of xx, yy and zz, in a plane scene of xx and zz [Pa].
    mu : abs(xz)/p [-].
    shear_rate : dv_x/dz [1/s], shape (n_layer,).
    inertial_number : abs(shear_rate) d sqrt(rho_s/p) [-], shape (n_layer,).
    fabric_xx, fabric_zz, fabric_xz : mean of n_a n_b over the contacts of free grains at that height [-];
        1/3, 1/3 and 0 where their normals have no preferred direction.
    weight, weight_along : weight of the grains above less what fixed grains, planes and walls above carry,
        normal to the bed and along it [Pa], shape (n_layer,); a lid adds its force. In a steady dry flow
        equal to zz and -xz.
    deviation, deviation_along : largest difference from these over the whole weight, or over the largest load
        where a lid makes it more [-]; nan under water.
    area : by which the sums are divided [m2].
    averages : force per area of fixed grains, planes and walls on the grains, normal to the bed and against
        x: of those below and beside them as `bed_normal` and `bed_shear`, and where a lid presses from above
        `lid_normal`, downwards, and `lid_shear`, along x; fabric of the contacts of free grains.
    """

    z: Floats
    length: float
    crest: float
    phi: Layers
    v_x: Layers
    xx: Layers
    yy: Layers
    zz: Layers
    xz: Layers
    zx: Layers
    contact_zz: Layers
    contact_xz: Layers
    p: Layers
    mu: Layers
    shear_rate: Floats
    inertial_number: Floats
    fabric_xx: Layers
    fabric_zz: Layers
    fabric_xz: Layers
    weight: Floats
    weight_along: Floats
    deviation: float
    deviation_along: float
    area: float
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per height."""
        columns = (
            ("phi", self.phi), ("v_x_m_per_s", self.v_x), ("xx_Pa", self.xx), ("yy_Pa", self.yy),
            ("zz_Pa", self.zz), ("xz_Pa", self.xz), ("zx_Pa", self.zx), ("contact_zz_Pa", self.contact_zz),
            ("contact_xz_Pa", self.contact_xz), ("p_Pa", self.p), ("mu", self.mu),
            *((f"fabric_{one}", getattr(self, f"fabric_{one}")) for one in ("xx", "zz", "xz")),
        )  # fmt: skip
        of_layers = {"z_m": self.z} | {name: one.value for name, one in columns}
        of_layers |= {f"{one.name}_error": one.error for _, one in columns}
        of_layers |= {
            "shear_rate_per_s": self.shear_rate, "inertial_number": self.inertial_number,
            "weight_above_Pa": self.weight, "weight_above_along_Pa": self.weight_along,
        }  # fmt: skip
        return lines(of_layers)


def contact_stress(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    layer: float = 0.5,
) -> ContactStress:
    """Stress of contacts and motion over height, with pressure, mu and I, and the balance of momentum.

    Parameters
    ----------
    run : a run folder, periodic along x or in space, with record.forces = true; in Python
        `ryusa.run_scene(..., forces=True)`.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.
    layer : length of the coarse graining in mean diameters: standard deviation of its Gaussian and distance
        of the heights.

    Raises
    ------
    ResultsError : no frame in the window, no contact forces in it, or an area of bed that is not bounded.

    Notes
    -----
    With a Gaussian G of the height, and all lengths along x and y: a contact adds f_a l_b/A times the mean of
    G over its branch vector l, where f is the force on i and l points to i from j, or from the point of
    contact with a fixed grain or plane; motion adds m v_a' v_b' G/A, with v' about the mean velocity at that
    height over the window (Goldhirsch 2010, Granular Matter 12, 239; at the bed Weinhart et al. 2012,
    Granular Matter 14, 289). Summed over all heights the first part is the Love-Weber stress. The stress on a
    plane normal to z is exactly the weight above, less the forces of fixed grains and planes above, where the
    flow is steady and dry. Forces are those of the step before the frame. The area is that of a period, or
    within upright walls and planes; else, in space and open along x, that of the grains seen from above: the
    hull of their centres, wider by the mean radius. The fabric tensor is the mean of n_a n_b over the
    contacts of free grains with each other (Satake 1982), at a height weighted as their stress is: its trace
    is 1.
    """
    # One function: half of it is what it returns
    open_ = not math.isfinite(run.scene.period[0]) and not run.scene.plane_case
    t, first, last, scene, area = window_of(run, begin, end, least=1, plan=_plan if open_ else None)
    length = layer * float(scene.d.mean())
    z = _heights(run, first, last, scene, length)
    frames = [_frame(run, k, z, length) for k in range(first, last)]
    *sums, directions, fabric = (np.array(one) for one in zip(*frames, strict=True))
    contact, moved, weights, held = (one / area for one in sums)
    mass, (mean, kinetic) = moved[:, 0], _kinetic(moved)
    whole = contact + kinetic
    pressure = whole[:, (XX, ZZ) if scene.plane_case else (XX, YY, ZZ)].mean(axis=1)
    p = layers_mean("p", "Pa", pressure)
    sign = np.where(whole[:, XZ].mean(axis=0) < 0.0, -1.0, 1.0)
    d, density = float(scene.d.mean()), float(scene.m.sum() / (np.pi / 6.0 * scene.d**3).sum())
    shear = np.gradient(mean[0], length)
    inertial = np.abs(shear) * d * np.sqrt(density / np.where(p.value > 0.0, p.value, np.nan))
    above = weights.mean(axis=0)
    stress = {
        name: layers_mean(name, "Pa", whole[:, c]) for c, name in enumerate(("xx", "yy", "zz", "xz", "zx"))
    }
    wet = bool(run.case.get("water")) or scene.water.profile != Profile.NONE
    load = max(float(scene.m.sum() * np.abs(scene.gravity[2]) / area), float(np.abs(above[1]).max()))
    total = math.nan if wet or load == 0.0 else load
    off = float(np.abs(stress["zz"].value - above[1]).max()) / total
    off_along = float(np.abs(stress["xz"].value + above[0]).max()) / total
    window = float(t[0]), float(t[-1])
    return ContactStress(
        z=z,
        length=length,
        crest=crest_of(scene) if scene.n_fixed else math.nan,
        phi=layers_mean("phi", "-", mass / density),
        v_x=layers_quotient("v_x", "m/s", moved[:, 1], mass),
        **stress,
        contact_zz=layers_mean("contact_zz", "Pa", contact[:, ZZ]),
        contact_xz=layers_mean("contact_xz", "Pa", contact[:, XZ]),
        p=p,
        mu=layers_quotient("mu", "-", sign * whole[:, XZ], pressure),
        shear_rate=shear,
        inertial_number=inertial,
        **{
            f"fabric_{name}": layers_quotient(f"fabric_{name}", "-", directions[:, 1 + c], directions[:, 0])
            for c, name in enumerate(("xx", "zz", "xz"))
        },
        weight=above[1],
        weight_along=above[0],
        deviation=off,
        deviation_along=off_along,
        area=area,
        averages=Averages(
            "contact_stress", _averages(held, fabric, window),
            (
                *_balance(scene, area, off, off_along),
                f"area {area:.4g} m2; coarse graining: Gaussian of standard deviation {length:.3g} m, mean "
                f"of {len(t)} frames",
            ),
        ),
    )  # fmt: skip


def _averages(held: Floats, fabric: Floats, window: tuple[float, float]) -> tuple[Average, ...]:
    """Stress at bed and lid (n_frame, 2, 3) [Pa], and the fabric of all contacts (n_frame, 6) [-]."""
    bed, lid = held[:, 0], held[:, 1]
    return (
        average("bed_normal", "Pa", [bed[:, 2]], window),
        average("bed_shear", "Pa", [-bed[:, 0]], window),
        *(
            average(name, "Pa", [force], window)
            for name, force in (("lid_normal", -lid[:, 2]), ("lid_shear", lid[:, 0]))
            if lid.any()
        ),
        *(
            average(f"fabric_{name}", "-", [fabric[np.isfinite(fabric[:, c]), c]], window)
            for c, name in enumerate(("xx", "yy", "zz", "xy", "xz", "yz"))
        ),
    )


def _plan(run: Run, first: int, last: int, scene: Scene) -> float:
    """Area within upright walls, or else of the grains seen from above, mean of a window [m2]."""
    within = area_of(run, first, scene, 1)
    if math.isfinite(within):
        return within
    from scipy.spatial import ConvexHull, QhullError

    r, found = 0.5 * float(scene.d.mean()), list[float]()
    for k in range(first, last):
        x = np.asarray(run.frames.x[k], dtype=np.float64)[:, :2]
        try:
            hull = ConvexHull(x[np.isfinite(x[:, 0])])
        except QhullError:
            raise ResultsError(
                "the scene is open along x, and its grains lie on a line: no area to divide by"
            ) from None
        # In a plane these are area and rim
        found.append(float(hull.volume + hull.area * r + math.pi * r * r))
    return float(np.mean(found))


def _heights(run: Run, first: int, last: int, scene: Scene, length: float) -> Floats:
    """Heights from below the lowest contact to above the highest grain [m], one length apart."""
    ends = np.array([(z.min(), z.max()) for z in (run.frames.x[k][:, 2] for k in range(first, last))])
    radius = 0.5 * float(scene.d.max())  # the lowest point of contact is as far below the lowest centre
    low = math.floor((float(ends[:, 0].min()) - radius) / length - REACH)
    high = math.ceil(float(ends[:, 1].max()) / length + REACH)
    return np.asarray(np.arange(low, high + 1) * length, dtype=np.float64)


def _kinetic(moved: Floats) -> tuple[Floats, Floats]:
    """Mean velocity over the window, (3, n_layer), and stress of motion about it, (n_frame, 5, n_layer)."""
    mass, momentum = moved[:, 0], moved[:, 1:4]
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(mass.sum(axis=0) > 0.0, momentum.sum(axis=0) / mass.sum(axis=0), 0.0)
    terms = [
        moved[:, 4 + c] - mean[a] * momentum[:, b] - mean[b] * momentum[:, a] + mean[a] * mean[b] * mass
        for c, (a, b) in enumerate(AXES)
    ]
    return mean, np.stack(terms, axis=1)


def _balance(scene: Scene, area: float, off: float, off_along: float) -> tuple[str, ...]:
    """The weight beside the force of the bed, and how far the stress differs from the weight above."""
    weight = float(scene.m.sum()) / area * scene.gravity
    said = (
        f"weight of the grains per area: {-weight[2]:.4g} Pa normal to the bed, {weight[0]:.4g} Pa along it"
    )
    if math.isnan(off):
        why = "the grains carry nothing" if weight[2] == 0.0 else "water carries part of the weight"
        return (said, f"no balance of momentum: {why}")
    return (
        said,
        f"balance of momentum: zz differs from the weight above by at most {off:.2%} of the whole load, "
        f"xz by {off_along:.2%}",
    )


def _frame(run: Run, k: int, z: Floats, length: float) -> tuple[Floats, ...]:
    """Sums of one frame over heights z of the scene [m], times the area.

    Returns
    -------
    contact : stress of the contacts [N], (5, n_layer).
    moved : G times mass, momentum and its flux, (9, n_layer) [kg/m], [kg/s], [N].
    weights : along the bed and normal to it, less what fixed grains and planes carry above, (2, n_layer) [N].
    held : force of fixed grains, planes and walls on the grains [N], of those below and beside them and of
        those above, (2, 3).
    directions : G along contacts of free grains, alone and times n_x n_x, n_z n_z and n_x n_z, (4, n_layer).
    fabric : mean of n_a n_b of the contacts of free grains, xx, yy, zz, xy, xz, yz [-], (6,).
    """
    from scipy.special import ndtr

    scene = scene_at(run, float(run.frames.t[k]))
    x = np.asarray(run.frames.x[k], dtype=np.float64)
    v = np.asarray(run.frames.v[k], dtype=np.float64)
    forces: np.ndarray = run.contact_forces(k)  # type: ignore[attr-defined]
    f = np.asarray(forces["force"], dtype=np.float64)
    before = float(run.frames.t[k]) - scene.dt
    branch, tip, bound = _branches(x, forces["i"], forces["j"], scene, before)
    contact, moved, weights = np.zeros((5, len(z))), np.zeros((9, len(z))), np.zeros((2, len(z)))
    directions, n = np.zeros((4, len(z))), branch / np.linalg.norm(branch, axis=1)[:, None]
    for a in range(0, len(f), BLOCK):
        one = slice(a, a + BLOCK)
        line = _line(z, x[forces["i"][one], 2], branch[one, 2], length)
        for c, (p, q) in enumerate(AXES):
            contact[c] += (f[one, p] * branch[one, q]) @ line
        held, free = bound[one], n[one] * ~bound[one, None]
        for c, weight in enumerate((~held * 1.0, *(free[:, p] * free[:, q] for p, q in PLANE))):
            directions[c] += weight @ line
        share = ndtr((tip[one][held, 2, None] - z) / length)
        weights += np.array([f[one][held, 0] @ share, -f[one][held, 2] @ share])
    for a in range(0, len(x), BLOCK):
        one = slice(a, a + BLOCK)
        off = (x[one, 2, None] - z) / length
        kernel = np.exp(-0.5 * off**2) / (length * math.sqrt(2.0 * math.pi))
        m = scene.m[one]
        flux = [v[one, p] * v[one, q] for p, q in AXES]
        moved += np.stack([m, *(m * v[one].T), *(m * np.stack(flux))]) @ kernel
        share = m @ ndtr(off)
        weights += np.array([scene.gravity[0] * share, -scene.gravity[2] * share])
    n = n[~bound]
    every = [(n[:, a] * n[:, b]).mean() if len(n) else math.nan for a, b in FABRIC]
    above = bound & (branch[:, 2] < -LID * np.linalg.norm(branch, axis=1))
    held = np.array([f[bound & ~above].sum(axis=0), f[above].sum(axis=0)])
    return contact, moved, weights, held, directions, np.array(every)


def _line(z: Floats, top: Floats, rise: Floats, length: float) -> Floats:
    """Mean of the Gaussian over straight lines that end at `top` and rise by `rise` [1/m], (n, n_layer)."""
    from scipy.special import ndtr

    flat = np.abs(rise) < FLAT * length
    steep = np.where(flat, FLAT * length, rise)[:, None]
    level = (top - 0.5 * np.where(flat, rise, 0.0))[:, None]
    sloped = (ndtr((top[:, None] - z) / length) - ndtr((top[:, None] - steep - z) / length)) / steep
    even = np.exp(-0.5 * ((level - z) / length) ** 2) / (length * math.sqrt(2.0 * math.pi))
    return np.where(flat[:, None], even, sloped)


def _branches(
    x: Floats, i: np.ndarray, j: np.ndarray, scene: Scene, t: float
) -> tuple[Floats, Floats, Bools]:
    """Branch vectors that end at the centre of i [m], where they begin, and whether j is fixed.

    They begin at the centre of a free partner, and at the point of contact with a fixed grain, plane
    or wall.
    """
    n, n_fixed = scene.n_grain, scene.n_fixed
    branch = np.zeros((len(i), 3))
    plane, bound = j >= n + n_fixed, j >= n
    every = np.concatenate([x, scene.x_fixed.reshape(-1, 3)])
    branch[~plane] = x[i[~plane]] - every[j[~plane]]
    for axis, period in enumerate(scene.period):
        if math.isfinite(period):
            branch[~plane, axis] -= period * np.round(branch[~plane, axis] / period)
    away, overlap = away_from_surfaces(scene, x, t, i[plane], j[plane])
    branch[plane] = away * (0.5 * scene.d[i[plane]] - overlap)[:, None]
    r = 0.5 * np.concatenate([scene.d, scene.d_fixed])
    fixed = bound & ~plane
    distance = np.linalg.norm(branch[bound], axis=1)
    reach = np.where(plane[bound], r[i[bound]], 0.0)
    reach[fixed[bound]] = r[i[fixed]] + r[j[fixed]]
    arm = r[i[bound]] - 0.5 * (reach - distance)  # to the middle of the overlap
    branch[bound] *= (arm / distance)[:, None]
    return branch, x[i] - branch, bound
