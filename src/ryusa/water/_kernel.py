"""Decorator for the compiled functions of the column, and the column's parameters as they take them."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple, TypeVar

from ryusa.compiled.function import compiled
from ryusa.model.column import Column

F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compile a function at its first call.

    It runs without the lock of the interpreter, so that threads can share a loop (`row_threads`).
    """
    return compiled(nogil=True)(function)


def sums(function: F) -> F:
    """Compile as `kernel` a function that sums what no step of the water depends on: in any order."""
    return compiled(fastmath={"contract", "nsz", "reassoc"}, nogil=True)(function)


class ColumnParameters(NamedTuple):
    """Parameters of a column as plain numbers, for compiled functions."""

    n: int
    z_low: float
    dz: float
    z_bed: float
    z_surface: float
    rho_w: float
    nu: float
    bed: int
    k_rough: float
    top: int
    u_lid: float
    surface: int
    side: int
    width: float
    g_x: float
    drive: int
    gradient: float
    tau: float
    discharge: float
    mixing: int
    kappa: float
    phi_max: float
    k_f: float
    d: float


@lru_cache(maxsize=16)
def parameters_of(column: Column) -> ColumnParameters:
    """Parameters of a column as the integers and floats that Numba expects."""
    c = column
    return ColumnParameters(
        n=int(c.n),
        z_low=float(c.z_low),
        dz=float(c.dz),
        z_bed=float(c.origin),
        z_surface=float(c.z_surface),
        rho_w=float(c.rho_w),
        nu=float(c.nu),
        bed=int(c.bed),
        k_rough=float(c.k_rough),
        top=int(c.top),
        u_lid=float(c.u_lid),
        surface=int(c.surface),
        side=int(c.side),
        width=float(c.width),
        g_x=float(c.g_x),
        drive=int(c.drive),
        gradient=float(c.gradient),
        tau=float(c.tau),
        discharge=float(c.discharge),
        mixing=int(c.mixing),
        kappa=float(c.kappa),
        phi_max=float(c.phi_max),
        k_f=float(c.k_f),
        d=float(c.d),
    )
