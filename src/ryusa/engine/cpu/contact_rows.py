"""Memory rows and springs of candidate pairs: emptied at first touch, copied from list to list."""

from typing import Any

from ryusa.engine.cpu.simd.vec4 import copy4
from ryusa.engine.shared.dashpots import set_springs
from ryusa.engine.shared.kernel import inner


@inner(forceinline=True)
def dashpot_row(k: int, eta: Any) -> int:
    """Row of the dashpots of candidate k."""
    return k if len(eta) > 1 else 0


@inner()
def begin_row(
    k: int,
    i: int,
    j: int,
    rotation: int,
    exact: int,
    c: Any,
    m: Any,
    x: Any,
    inertia: Any,
    eta: Any,
    rows: Any,
) -> None:
    """Clear the row of candidate k, which may touch now and did not before, and set its springs.

    Where all are alike every thread writes the same numbers to the same place.
    """
    for a in range(rows.shape[1]):
        rows[k, a] = 0.0
    set_springs(dashpot_row(k, eta), i, j, rotation, exact, c, m, x, inertia, eta)


@inner(forceinline=True)
def copy_row(at: int, to_eta: Any, to_rows: Any, of: int, eta: Any, rows: Any) -> None:
    """Copy dashpots and memory of pair `of` of one list to pair `at` of another, by whole vectors."""
    width = rows.shape[1]
    a, e = dashpot_row(at, to_eta), dashpot_row(of, eta)
    for k in range(eta.shape[1]):
        to_eta[a, k] = eta[e, k]
    for k in range(0, width - 3, 4):
        copy4(to_rows, width * at + k, rows, width * of + k)
    for k in range(width // 4 * 4, width):
        to_rows[at, k] = rows[of, k]
