"""Which test of a heap a case shows: at what angle grains stand depends on how they were let go."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from ryusa.errors import CaseError
from ryusa.spelling import nearest_word

if TYPE_CHECKING:
    from ryusa.casefile.case import Case

HEAPS = ("surface", "cone")  # measures whose quantities depend on the test
OTHER = "other"
# test -> packaged cases that show it; a gate may be a tube, too, that is taken away at once
TESTS: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "poured in space": ("poured_heap",),
    "lifted cylinder in space": ("lifted_cylinder", "gravel_heap"),
    "gate in space": ("channel_collapse", "column_collapse"),
    "gate in a plane": ("heap",),
    "poured in a plane": (),
    "lifted cylinder in a plane": (),
})  # fmt: skip


def shown_test(case: "Case") -> str | None:
    """Test that a case shows, by its timeline and feeds; None where it is none of these."""
    where = "in a plane" if case.motion.plane else "in space"
    if any(one.remove is not None for one in case.timeline):
        return f"gate {where}"
    moves = [one.move.velocity for one in case.timeline if one.move is not None]
    if any(velocity is not None and velocity[2] > 0.0 for velocity in moves):
        return f"lifted cylinder {where}"
    return f"poured {where}" if case.feeds else None


def read_test(key: str, value: object, measure: str) -> str:
    """Test of an observation as the study states it; "" for a measure that needs none.

    Raises
    ------
    CaseError : missing, unknown, or of no use; the message names the cases that show each test.
    """
    if measure not in HEAPS:
        if value is not None:
            raise CaseError(key, value, f"is for observations of a heap, of the measures {', '.join(HEAPS)}")
        return ""
    words = (*TESTS, OTHER)
    if value in words:
        return str(value)
    shown = "; ".join(f"'{test}' ({_cases(test)})" for test in TESTS)
    problem = (
        "missing; the numbers of a heap depend on how it was made, so that this" if value is None else ""
    )
    raise CaseError(
        key, value, f"{problem} must name the test that was observed: {shown}; or '{OTHER}'".lstrip(),
        nearest_word(str(value), words),
    )  # fmt: skip


def refuse_other_test(key: str, test: str, case: "Case") -> None:
    """Refuse a case that shows another test than the observation is of.

    Raises
    ------
    CaseError : names the test of the case, and the cases that show that of the observation.
    """
    found = shown_test(case)
    if test in {"", OTHER, found}:
        return
    shows = f"shows '{found}'" if found is not None else "shows none of the tests of a heap"
    raise CaseError(
        key, test, f"{case.name}.toml {shows}; '{test}' needs {_cases(test)}. With '{OTHER}' the two "
        "tests are taken as alike",
    )  # fmt: skip


def _cases(test: str) -> str:
    """Packaged cases that show a test, as commands."""
    named = " or ".join(f"ryusa new {name}" for name in TESTS[test])
    return named or "a case of your own"
