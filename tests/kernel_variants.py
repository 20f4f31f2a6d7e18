"""The kernels that `make test` compiles, and the hook that keeps its tests to them.

Kernels cost seconds of compilation for each variant (src/ryusa/engine/shared/variant.py), whatever a test
then does with them. So the quick level has one list of a dozen, which together have every feature of the CPU
engine, and a test that needs another one belongs to `make test-all`.
"""

from collections.abc import Callable, Iterable
from typing import Any

import pytest

from ryusa.engine.shared.variant import KernelVariant

NONE = KernelVariant(*(0,) * 8)
DRY = NONE._replace(events=1, exact=1)  # contacts that are recorded and begin within steps
PLANE, SPACE = DRY._replace(plane_case=1), DRY._replace(rotation=1)

# Most are those of the paper's short runs or of the goldens, which are compiled anyway.
QUICK: dict[KernelVariant, str] = {
    PLANE: "drop: a grain on one line, as in the paper's tests of the contact",
    PLANE._replace(water=1): "saltation: the same in given water",
    PLANE._replace(rotation=1): "plane heap: grains that turn",
    PLANE._replace(rotation=1, water=1): "spinning saltation: grains that turn in given water",
    PLANE._replace(rotation=1, rolling=1): "plane heap with rolling friction; what the tests of resume step",
    PLANE._replace(rotation=1, events=0, column=1, water=1): "plane flow: a column of water, two-way",
    SPACE: "heap in space, its feeds and exits",
    SPACE._replace(walls=1): "walls: faces at rest and moving",
    SPACE._replace(events=0, column=1, water=1): "flow in space: columns and rows of water",
    SPACE._replace(rolling=1, mixed=1): "materials: every pair has its own law",
    SPACE._replace(exact=0, bodies=1): "clumps: spheres that make up bodies",
    SPACE._replace(exact=0, hertz=1, adhesive=1): "elastic spheres that attract each other",
}


def words(variant: KernelVariant) -> str:
    """The features of a kernel, as its fields name them."""
    return ", ".join(name for name, has in variant._asdict().items() if has) or "no feature"


def refusal(variant: KernelVariant) -> str:
    """What a test of the quick level is told that asks for another kernel."""
    return (
        f"{tuple(variant)} ({words(variant)}) is not among the kernels of `make test`"
        " (tests/kernel_variants.py): mark this test with @pytest.mark.full, which moves it to"
        " `make test-all`, or let it use one of them"
    )


def confined(pieces_of_step: Callable[..., Any]) -> Callable[..., Any]:
    """The maker of kernels, which fails the test that asks for another one than those above."""

    def make(variant: KernelVariant, *given: Any) -> Any:
        if variant not in QUICK:
            pytest.fail(refusal(variant), pytrace=False)
        return pieces_of_step(variant, *given)

    return make


def full_but(quick: Iterable[Any], values: Iterable[Any]) -> list[Any]:
    """Values of a parameter, or tuples for several; `make test` takes those in `quick` alone."""
    shown = list(quick)
    rows = {value: value if isinstance(value, tuple) else (value,) for value in values}
    return [
        value if value in shown else pytest.param(*row, marks=pytest.mark.full) for value, row in rows.items()
    ]
