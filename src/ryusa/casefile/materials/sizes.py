"""Sizes of materials: what is wrong with them, and what `ryusa check` says of them."""

from collections.abc import Iterator

from ryusa.casefile.builders.values import drawn_range
from ryusa.casefile.case import Case
from ryusa.casefile.grading import BUILDERS, check_points, grading_of
from ryusa.casefile.grains.values import has_own_sizes, sized_as
from ryusa.casefile.materials.schema import MaterialSection
from ryusa.casefile.rows import ExplainRow, number, word
from ryusa.casefile.section import given
from ryusa.errors import CaseError
from ryusa.model.grading import SHARES


def check_sizes(case: Case) -> Iterator[CaseError]:
    """Find sizes of materials that contradict each other, or that no builder draws, and bad curves."""
    for name, one in case.materials.items():
        yield from _sizes(case, name, one)


def _sizes(case: Case, name: str, one: MaterialSection) -> Iterator[CaseError]:
    key = f"materials.{name}"
    if one.sieve_curve is not None:
        for other in ("diameter", "spread"):
            if given(one, other):
                yield CaseError(
                    f"{key}.{other}", None, f"excludes {key}.sieve_curve; give only one of the two"
                )
        yield from check_points(f"{key}.sieve_curve", one.sieve_curve)
    if (
        has_own_sizes(case.materials, name)
        and name in case.grains.mixture
        and case.build.kind not in BUILDERS
    ):
        yield CaseError(
            f"grains.mixture.{name}", None,
            f"is of a size of its own, which builder '{case.build.kind}' does not draw; "
            f"{', '.join(BUILDERS)} do",
        )  # fmt: skip


def size_rows(case: Case, name: str) -> list[ExplainRow]:
    """Sizes of a material that has its own."""
    if not has_own_sizes(case.materials, name):
        return []
    low, high = drawn_range(case, name)
    if low == high:
        return [number("materials", f"diameter of {name}", low, "cm", f"materials.{name}")]
    shown = f"{100.0 * low:.4g} to {100.0 * high:.4g} cm"
    rows = [word("materials", f"diameters of {name}", shown, f"materials.{name}")]
    curve = grading_of(sized_as(case, name))
    if curve is not None:
        rows += [
            number("materials", f"D{round(100 * share)} of {name}", curve.diameter(share), "cm", "by mass")
            for share in SHARES
        ]
    return rows
