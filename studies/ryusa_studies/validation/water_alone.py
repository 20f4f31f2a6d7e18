"""Water alone: log laws over rough and smooth beds, their discharge, Poiseuille's and Couette's flows."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ryusa.figures.comparison import Axis, Curve
from ryusa.laws.families import BedKind, Drive, Mixing
from ryusa.laws.turbulence import speed_mean_rough
from ryusa.laws.water import log_law_rough, log_law_smooth
from ryusa.model.arrays import Floats
from ryusa.model.column import Column, Top
from ryusa.study import (
    Band,
    Finding,
    Found,
    Plan,
    Source,
    Task,
    at_most,
    calculation,
    comparison,
    misfit,
    relative,
)
from ryusa.water import discharge, steady

TITLE = "Water alone"
GRIDS = (10, 20, 40, 80)
U_STAR, DEPTH, ROUGH = 0.0985, 0.02, 0.002  # of the paper's saltation [m/s], [m], [m]
SMOOTH_CELLS = 1000

U = Axis("speed", "m/s")
Z = Axis("height", "m")
FAR = "largest difference over the largest speed, 80 cells"
SECOND = Band(1.9, 2.1, "-", "central differences are of second order")


def _laminar(n: int, **more: object) -> Column:
    """Viscous water 1 cm deep."""
    given = {"z_low": 0.0, "dz": 0.01 / n, "n": n, "depth": 0.01, "nu": 1e-5, **more}
    return Column(**given)  # pyright: ignore[reportArgumentType]


def film(n: int) -> Column:
    """Water on a slope, its surface free."""
    return _laminar(n, g_x=0.01)


def gap(n: int) -> Column:
    """Water that a pressure gradient drives between two plates at rest."""
    return _laminar(n, top=Top.LID, drive=Drive.GRADIENT, gradient=5.0)


def sheared(n: int) -> Column:
    """Water that a lid drags along."""
    return _laminar(n, top=Top.LID, u_lid=0.3)


def sheared_back(n: int) -> Column:
    """Water that a lid drags along against a pressure gradient."""
    return _laminar(n, top=Top.LID, u_lid=0.3, drive=Drive.GRADIENT, gradient=-50.0)


def _film_exact(c: Column) -> Floats:
    return c.g_x / (2.0 * c.nu) * c.z * (2.0 * c.depth - c.z)


def _gap_exact(c: Column) -> Floats:
    return c.gradient / (2.0 * c.rho_w * c.nu) * c.z * (c.depth - c.z)


def _couette_exact(c: Column) -> Floats:
    return c.u_lid * c.z / c.depth + _gap_exact(c)


LAMINAR: Mapping[str, tuple[Callable[[int], Column], Callable[[Column], Floats], str, str]] = {
    "film": (film, _film_exact, "Laminar film on a slope", "Nusselt 1916: U = g_x z (2 h - z)/(2 nu)"),
    "poiseuille": (gap, _gap_exact, "Poiseuille flow between plates", "U = -dp/dx z (h - z)/(2 rho nu)"),
    "couette": (sheared, _couette_exact, "Couette flow under a moving lid", "U = U_lid z/h"),
    "couette-poiseuille": (
        sheared_back, _couette_exact, "Moving lid with an opposing pressure gradient",
        "U = U_lid z/h - dp/dx z (h - z)/(2 rho nu)",
    ),
}  # fmt: skip


def river(n: int) -> Column:
    """The paper's saltation without viscosity, 2 cm deep over a rough bed; kappa = ln(10)/5.75 of Eq. (9)."""
    return Column(
        z_low=0.0, dz=DEPTH / n, n=n, depth=DEPTH, nu=1e-12, bed=BedKind.ROUGH, k_rough=ROUGH,
        mixing=Mixing.PARABOLIC, kappa=math.log(10.0) / 5.75, g_x=U_STAR**2 / DEPTH,
    )  # fmt: skip


def smooth(n: int, mixing: Mixing, bed: BedKind) -> Column:
    """Water over a smooth bed, u_star depth/nu = 1000."""
    return Column(
        z_low=0.0, dz=DEPTH / n, n=n, depth=DEPTH, bed=bed, mixing=mixing,
        g_x=(1000.0 * 1e-6 / DEPTH) ** 2 / DEPTH,
    )  # fmt: skip


def flow(which: str, n: int) -> dict[str, Floats]:
    """Steady speeds on a grid of n cells [m/s], where they are [m], and the discharge [m2/s]."""
    columns: dict[str, Callable[[int], Column]] = {
        **{name: made[0] for name, made in LAMINAR.items()},
        "river": river,
        "viscous": lambda n: replace(river(n), nu=1e-6, kappa=0.41),
        "coarse": lambda n: smooth(n, Mixing.PARABOLIC, BedKind.SMOOTH),
        "fine": lambda n: smooth(n, Mixing.VAN_DRIEST, BedKind.NO_SLIP),
    }
    c = columns[which](n)
    state, _ = steady(c)
    return {"z": c.z, "u": state.u, "q": np.array(discharge(state)), "tau": state.tau}


def _call(which: str, n: int) -> Task:
    return calculation(flow, which=which, n=n, seconds=0.05)


def tasks(plan: Plan) -> Sequence[Task]:
    """Each flow on a few grids; they take no time, so both levels have all."""
    del plan
    grids = [_call(which, n) for which in (*LAMINAR, "river") for n in GRIDS]
    return [*grids, _call("viscous", 40), _call("coarse", 20), _call("fine", SMOOTH_CELLS)]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Profiles, discharge and order of convergence."""
    del plan
    laminar = [_laminar_flow(found, name) for name in LAMINAR]
    return [_rough(found), _rough_discharge(found), _smooth(found), _van_driest(found), *laminar]


def _errors(found: Found, which: str, exact: Callable[[Column], Floats]) -> list[float]:
    make = LAMINAR[which][0]
    return [relative(found[_call(which, n)]["u"], exact(make(n))) for n in GRIDS]


def _laminar_flow(found: Found, which: str) -> Finding:
    make, exact, title, words = LAMINAR[which]
    errors = _errors(found, which, exact)
    shown = found[_call(which, 20)]
    fine = make(200)
    if which == "couette":  # linear: there is nothing to converge
        last = misfit(FAR, errors[-1], "-", at_most(1e-12, "linear in z: round-off"))
        said, kept = "A linear profile is reproduced without error.", [last]
    else:
        order = float(np.log2(errors[-2] / errors[-1]))
        last = misfit(FAR, errors[-1], "-", at_most(3e-4, "1/n^2 for n cells, with a margin of 2"))
        said = "The order is log2 of the errors on 40 and 80 cells."
        kept = [last, misfit("order of convergence in space", order, "-", SECOND)]
    return comparison(
        which, title, Source(words), Z, U, [Curve("20 cells", shown["z"], shown["u"])],
        [Curve("closed form", fine.z, exact(fine))], kept, {"depth": "1 cm", "nu": "1e-5 m2/s"}, said,
    )  # fmt: skip


def _rough(found: Found) -> Finding:
    ours = found[_call("river", 40)]
    usual = found[_call("viscous", 40)]
    law = np.array([log_law_rough(float(z), U_STAR, ROUGH) for z in ours["z"]])
    every = [_rough_error(found, n) for n in GRIDS]
    return comparison(
        "log-rough", "Logarithmic law over a rough bed",
        Source("the paper, Eq. (9): U/u_star = 8.5 + 5.75 log10(z/k_s)"),
        Axis("height", "m", log=True), U, [Curve("parabolic mixing length, 40 cells", ours["z"], ours["u"])],
        [Curve("Eq. (9)", ours["z"], law)],
        [
            misfit(
                "largest relative difference on 10 to 80 cells", max(every), "-", at_most(1e-7, "one law")
            ),
            misfit(
                "the same with nu = 1e-6 m2/s and kappa = 0.41", relative(usual["u"], law), "-",
                at_most(0.03, "0.41 is not ln(10)/5.75 = 0.4005: 2.4 %"),
            ),
        ],
        {"u_star": "0.0985 m/s", "depth": "2 cm", "k_s": "2 mm"},
        "With kappa = ln(10)/5.75 and without viscosity the column reproduces Eq. (9) on any grid.",
    )  # fmt: skip


def _rough_error(found: Found, n: int) -> float:
    ours = found[_call("river", n)]
    law = np.array([log_law_rough(float(z), U_STAR, ROUGH) for z in ours["z"]])
    return float(np.abs(ours["u"] / law - 1.0).max())


def _rough_discharge(found: Found) -> Finding:
    exact = DEPTH * speed_mean_rough(DEPTH, U_STAR, ROUGH)
    ours = np.array([float(found[_call("river", n)]["q"]) for n in GRIDS])
    error = np.abs(ours / exact - 1.0)
    grids = np.array(GRIDS, dtype=np.float64)
    order = float(np.log2(error[0] / error[-1]) / 3.0)
    return comparison(
        "log-discharge", "Discharge of the logarithmic law",
        Source("Eq. (9) over depth: q = u_star h (8.5 - 5.75/ln(10) + 5.75 log10(h/k_s)), from k_s/30 up"),
        Axis("cells", log=True), Axis("discharge", "m2/s"), [Curve("column", grids, ours)],
        [Curve("integral of Eq. (9)", grids, np.full(len(grids), exact))],
        [
            misfit(
                "relative difference, 40 cells", float(error[2]), "-",
                at_most(1.2e-3, "a logarithm, resolved by cells"),
            ),
            misfit(
                "order of convergence in space, 10 to 80 cells", order, "-",
                Band(
                    0.9, math.inf, "-",
                    "the logarithm is singular at the bed: the lowest cell is of first order",
                ),
            ),
        ],
        {"u_star": "0.0985 m/s", "depth": "2 cm", "k_s": "2 mm"},
    )  # fmt: skip


def _smooth(found: Found) -> Finding:
    ours = found[_call("coarse", 20)]
    law = np.array([log_law_smooth(float(z), 0.05, 1e-6) for z in ours["z"]])
    return comparison(
        "log-smooth", "Logarithmic law over a smooth bed, coarse grid",
        Source("two layers: u+ = z+ up to 11.3, then ln(z+/11.3)/0.41 + 11.3"),
        Axis("height", "m", log=True), U, [Curve("parabolic mixing length, 20 cells", ours["z"], ours["u"])],
        [Curve("two-layer law", ours["z"], law)],
        [
            misfit(
                "largest relative difference", float(np.abs(ours["u"] / law - 1.0).max()), "-",
                at_most(0.01, "the law neglects viscosity above z+ = 11.3"),
            )
        ],
        {"u_star depth/nu": "1000"},
    )  # fmt: skip


def _van_driest(found: Found) -> Finding:
    ours = found[_call("fine", SMOOTH_CELLS)]
    z_plus, u_plus = ours["z"] * 0.05 / 1e-6, ours["u"] / 0.05
    low, log = z_plus < 3.0, (z_plus > 50.0) & (z_plus < 100.0)
    viscous = float(np.abs(u_plus[low] / z_plus[low] - 1.0).max())
    law = np.log(z_plus[log]) / 0.41 + 5.25
    steps = np.geomspace(0.5, 11.0, 40)
    wall = Axis("z+", log=True)
    return comparison(
        "van-driest", "Viscous layer and log layer over a smooth bed, fine grid",
        Source("law of the wall: u+ = z+; u+ = ln(z+)/0.41 + 5.25, the limit of van Driest's mixing length"),
        wall, Axis("u+"), [Curve("van Driest's mixing length, 1000 cells", z_plus, u_plus)],
        [Curve("u+ = z+", steps, steps), Curve("log law", z_plus[log], law)],
        [
            misfit("z+ below 3, relative", viscous, "-", at_most(5e-3, "onset of turbulence")),
            misfit(
                "z+ 50 to 100, relative", float(np.abs(u_plus[log] / law - 1.0).max()), "-",
                at_most(0.015, "the stress decreases by z/h = 0.1 over the layer"),
            ),
        ],
        {"u_star depth/nu": "1000"},
    )  # fmt: skip
