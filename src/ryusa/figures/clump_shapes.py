"""Forms of the clumps of a run, from two sides, to scale with the sphere of the same volume."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ryusa.errors import ResultsError
from ryusa.figures import style
from ryusa.model.clump import Clump
from ryusa.model.rigid_bodies import RigidBodies
from ryusa.model.scene import Floats, Scene
from ryusa.results import Results

NEAR, FAR = np.array([0.86, 0.83, 0.77]), np.array([0.45, 0.42, 0.37])  # colours of spheres by depth
SIDES = (((0, 1, 2), "b"), ((0, 2, 1), "c"))  # axes across, up and towards the reader; name of the one up


def clump_shapes(results: Results) -> tuple[Figure, list[dict[str, object]]]:
    """Draw the first clump of each form, and list its spheres.

    Returns
    -------
    figure : forms beside each other; above seen along axis c, below along axis b, with the sphere of the same
        volume as a dashed circle.
    rows : every sphere of every form: centre and diameter over that of the sphere of the same volume, and the
        relative error of the volume of the form, 0 for a closed form.

    Raises
    ------
    ResultsError : the run has no clumps.
    """
    bodies = results.scene.bodies
    if bodies is None or not bodies.n:
        raise ResultsError("the run has no clumps: all its grains are spheres")
    forms = [int(np.flatnonzero(bodies.form == k)[0]) for k in np.unique(bodies.form)]
    rows: list[dict[str, object]] = []
    for body in forms:
        x, d = _spheres(results.scene, bodies, body)
        error = Clump.of(x, d).error
        for i in range(len(d)):
            row: dict[str, object] = {"shape": _name(bodies, body)}
            row |= {"x_over_d": x[i, 0], "y_over_d": x[i, 1], "z_over_d": x[i, 2], "d_sphere_over_d": d[i]}
            row["volume_error"] = error
            rows.append(row)
    return _drawn(results.scene, bodies, forms), rows


@style.house
def _drawn(scene: Scene, bodies: RigidBodies, forms: list[int]) -> Figure:
    n = len(forms)
    figure, panels = style.new(2, n, width=max(0.95 * n, 2.0), height=2.3)
    reach = max(float(np.abs(_spheres(scene, bodies, one)[0]).max()) for one in forms) + 0.5
    for column, body in enumerate(forms):
        x, d = _spheres(scene, bodies, body)
        for axes, (order, up) in zip((panels[column], panels[n + column]), SIDES, strict=True):
            _side(axes, x[:, order], d, reach)
            if not column:
                axes.annotate(up, (0, 0.5), (-6, 0), xycoords="axes fraction", textcoords="offset points")
        a, b, c = _lengths(bodies, body)
        count = int(bodies.count[body])
        panels[column].set_title(f"{_name(bodies, body)}\n{count} sphere{'s' * (count > 1)}", fontsize=6.5)
        clump = Clump.of(x, d)
        known = "exact" if clump.exact else f"to {clump.error:.0e}"
        panels[n + column].annotate(
            f"b/a {b / a:.2f}\nc/b {c / b:.2f}\nvolume {known}", (0.5, 0), (0, -2), xycoords="axes fraction",
            textcoords="offset points", ha="center", va="top", fontsize=6.5,
        )  # fmt: skip
    return figure


def _side(axes: Axes, x: Floats, d: Floats, reach: float) -> None:
    """Spheres seen along the third coordinate, the nearest last and lightest."""
    depth = x[:, 2]
    span = max(float(np.ptp(depth)), 1e-9)
    for i in np.argsort(depth, kind="stable"):
        share = float((depth[i] - depth.min()) / span) if span > 1e-6 else 1.0
        colour = tuple((FAR + share * (NEAR - FAR)).tolist())
        axes.add_patch(Circle((x[i, 0], x[i, 1]), 0.5 * float(d[i]), fc=colour, ec="black", lw=0.4))
    axes.add_patch(Circle((0.0, 0.0), 0.5, fill=False, ec=style.COLOURS[0], lw=0.6, ls=(0, (3, 2))))
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-reach, reach)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _spheres(scene: Scene, bodies: RigidBodies, body: int) -> tuple[Floats, Floats]:
    """Centres and diameters over the diameter of the sphere of the same volume [-]."""
    rows = bodies.rows(np.array([body]))
    return bodies.arm[rows] / bodies.d[body], scene.d[bodies.members[rows]] / bodies.d[body]


def _lengths(bodies: RigidBodies, body: int) -> tuple[float, float, float]:
    """Lengths a >= b >= c of the ellipsoid with the same moments of inertia [m]; as `Clump.lengths`."""
    inertia = bodies.inertia[body] / bodies.m[body]
    a, b, c = np.sqrt(20.0 * np.maximum(0.5 * inertia.sum() - inertia, 0.0)).tolist()
    return a, b, c


def _name(bodies: RigidBodies, body: int) -> str:
    form = int(bodies.form[body])
    return bodies.names[form] if bodies.names else f"form {form}"  # scenes from Python may have no names
