"""Water alone: log laws over rough and smooth beds, their discharge, Poiseuille's and Couette's flows."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.laws.families import BedKind, Drive, Mixing
from ryusa.laws.turbulence import speed_mean_rough
from ryusa.laws.water import log_law_rough, log_law_smooth
from ryusa.model.arrays import Floats
from ryusa.model.column import Column, Top
from ryusa.study import Finding, Found, Plan, Task, calculation, relative
from ryusa.water import discharge, steady
from ryusa_studies.validation.declared import declared

TITLE = "Water alone"
DECLARED = declared(__file__)
GRIDS = (10, 20, 40, 80)
U_STAR, DEPTH, ROUGH = 0.0985, 0.02, 0.002  # of the paper's saltation [m/s], [m], [m]
SMOOTH_CELLS = 1000


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


LAMINAR: Mapping[str, tuple[Callable[[int], Column], Callable[[Column], Floats]]] = {
    "film": (film, _film_exact), "poiseuille": (gap, _gap_exact), "couette": (sheared, _couette_exact),
    "couette-poiseuille": (sheared_back, _couette_exact),
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
    make, exact = LAMINAR[which]
    errors = _errors(found, which, exact)
    shown = found[_call(which, 20)]
    fine = make(200)
    numbers = {"difference": errors[-1]}
    if which != "couette":  # that is linear: there is nothing to converge
        numbers["order"] = float(np.log2(errors[-2] / errors[-1]))
    return DECLARED[which].finding(
        [Curve("20 cells", shown["z"], shown["u"])], [Curve("closed form", fine.z, exact(fine))], numbers
    )


def _rough(found: Found) -> Finding:
    ours = found[_call("river", 40)]
    usual = found[_call("viscous", 40)]
    law = np.array([log_law_rough(float(z), U_STAR, ROUGH) for z in ours["z"]])
    every = [_rough_error(found, n) for n in GRIDS]
    return DECLARED["log-rough"].finding(
        [Curve("parabolic mixing length, 40 cells", ours["z"], ours["u"])],
        [Curve("Eq. (9)", ours["z"], law)], {"difference": max(every), "usual": relative(usual["u"], law)},
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
    return DECLARED["log-discharge"].finding(
        [Curve("column", grids, ours)], [Curve("integral of Eq. (9)", grids, np.full(len(grids), exact))],
        {"difference": float(error[2]), "order": order},
    )  # fmt: skip


def _smooth(found: Found) -> Finding:
    ours = found[_call("coarse", 20)]
    law = np.array([log_law_smooth(float(z), 0.05, 1e-6) for z in ours["z"]])
    return DECLARED["log-smooth"].finding(
        [Curve("parabolic mixing length, 20 cells", ours["z"], ours["u"])],
        [Curve("two-layer law", ours["z"], law)], {"difference": float(np.abs(ours["u"] / law - 1.0).max())},
    )  # fmt: skip


def _van_driest(found: Found) -> Finding:
    ours = found[_call("fine", SMOOTH_CELLS)]
    z_plus, u_plus = ours["z"] * 0.05 / 1e-6, ours["u"] / 0.05
    low, log = z_plus < 3.0, (z_plus > 50.0) & (z_plus < 100.0)
    viscous = float(np.abs(u_plus[low] / z_plus[low] - 1.0).max())
    law = np.log(z_plus[log]) / 0.41 + 5.25
    steps = np.geomspace(0.5, 11.0, 40)
    return DECLARED["van-driest"].finding(
        [Curve("van Driest's mixing length, 1000 cells", z_plus, u_plus)],
        [Curve("u+ = z+", steps, steps), Curve("log law", z_plus[log], law)],
        {"viscous": viscous, "log": float(np.abs(u_plus[log] / law - 1.0).max())},
    )  # fmt: skip
