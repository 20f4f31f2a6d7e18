"""[grains] sieve_curve: sizes by mass, what is cut of them, and what the finest grains cost."""

import math
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.files import contents, inside
from ryusa.casefile.grains.schema import GrainsSection
from ryusa.casefile.rows import ExplainRow, number, word
from ryusa.errors import CaseError
from ryusa.formats.sieve import read_sieve_curve
from ryusa.model.grading import SHARES, Grading, GradingFault

KEY = "grains.sieve_curve"
BUILDERS = ("packing", "flume", "box", "fill", "empty", "stream")  # those that draw sizes
MOVED = 0.01  # of a diameter by which cuts may change it without a word
COARSE = 0.05  # share of the mass in one grain above which a curve is laid poorly
DURATION = 1.5  # power of the diameter that the shortest contact follows at one stiffness


def points_of(case: Case) -> tuple[tuple[float, float], ...] | None:
    """Diameter [m] and percent finer of the sieve curve as given, in its order; None without one.

    Raises
    ------
    CaseError : its file cannot be read.
    """
    given = case.grains.sieve_curve
    if given is None or not isinstance(given, str):
        return given
    path = sieve_file(case)
    assert path is not None
    return contents(case.folder, KEY, given, path, _read)


@lru_cache(maxsize=4)
def _read(path: Path, name: str, _changed: int, _size: int) -> tuple[tuple[float, float], ...]:
    return read_sieve_curve(path, name)


def sieve_file(case: Case) -> Path | None:
    """File of the sieve curve; a run folder holds the one that its own run read."""
    given = case.grains.sieve_curve
    if not isinstance(given, str):
        return None
    from ryusa.results import schema

    kept = case.folder / schema.SIEVE
    if schema.is_run_folder(kept.parent) and kept.is_file() and not kept.is_symlink():
        return kept
    return inside(case.folder, KEY, given)


def grading_of(case: Case) -> Grading | None:
    """Curve of the grains that are laid: what lies between `finest` and `coarsest`, as 100 %; None without.

    Raises
    ------
    CaseError : it is no grading curve, or cannot be read.
    """
    points = points_of(case)
    if points is None:
        return None
    try:
        return _cut(points, case.grains.finest or 0.0, case.grains.coarsest or math.inf)
    except GradingFault as fault:
        raise CaseError(KEY, None, str(fault)) from None


@lru_cache(maxsize=16)
def _cut(points: tuple[tuple[float, float], ...], finest: float, coarsest: float) -> Grading:
    return _whole(points).cut(finest, coarsest)


@lru_cache(maxsize=16)
def _whole(points: tuple[tuple[float, float], ...]) -> Grading:
    return Grading.of([(d, percent / 100.0) for d, percent in points])


def reference_diameter(case: Case) -> float:
    """Diameter of u_star, roughness, overlap/d and fixed grains [m]: grains.diameter, or D50 of the curve."""
    if case.grains.diameter is not None:
        return case.grains.diameter
    grading = grading_of(case)
    if grading is None:  # the schema asks for one of the two
        raise CaseError("grains.diameter", None, "missing")
    return grading.diameter(0.5)


def check_grading(case: Case) -> Iterator[CaseError]:
    """Find a curve that does not say what every grain is, and keys or builders that have no use for it."""
    grains = case.grains
    if grains.sieve_curve is None:
        for key in ("finest", "coarsest"):
            if getattr(grains, key) is not None:
                yield CaseError(f"grains.{key}", getattr(grains, key), f"has no effect without {KEY}")
        return
    if case.build.kind not in BUILDERS:
        sizes = "takes sizes from its file" if case.build.kind in {"table", "run"} else "lays equal grains"
        allowed = f"has no effect with builder '{case.build.kind}', which {sizes}"
        yield CaseError(KEY, None, f"{allowed}; {', '.join(BUILDERS)} draw them from it")
        return
    try:
        points = points_of(case)
        assert points is not None
        whole = _whole(points)
    except CaseError as error:
        yield error
        return
    except GradingFault as fault:
        yield CaseError(f"{KEY}.{fault.point}", None, str(fault))
        return
    found = [*_ends(whole, grains.finest, grains.coarsest)]
    yield from found
    if not found:
        try:
            grading_of(case)
        except CaseError as error:
            yield error


def check_points(key: str, points: tuple[tuple[float, float], ...]) -> Iterator[CaseError]:
    """Find pairs of diameter and percent that are no closed curve."""
    try:
        whole = _whole(points)
    except GradingFault as fault:
        yield CaseError(f"{key}.{fault.point}", None, str(fault))
        return
    if not whole.closed:
        first, last = 100.0 * float(whole.finer[0]), 100.0 * float(whole.finer[-1])
        yield CaseError(key, None, f"goes from {first:g} to {last:g} % finer; a curve goes from 0 to 100 %")
    else:
        try:
            whole.cut()
        except GradingFault as fault:
            yield CaseError(key, None, str(fault))


def _ends(whole: Grading, finest: float | None, coarsest: float | None) -> Iterator[CaseError]:
    """Find ends of a curve that are open, and cuts beyond them."""
    first, last = float(whole.d[0]), float(whole.d[-1])
    if finest is not None and coarsest is not None and finest >= coarsest:
        yield CaseError("grains.finest", finest, f"must be smaller than grains.coarsest, {coarsest:g} m")
        return
    for key, cut, end, percent, outside, over in (
        ("finest", finest, first, 0.0, "smaller", finest is not None and finest < first),
        ("coarsest", coarsest, last, 100.0, "larger", coarsest is not None and coarsest > last),
    ):
        stated = 100.0 * float(whole.finer[0] if key == "finest" else whole.finer[-1])
        if stated == percent:
            if over:
                why = f"has no effect: the curve ends at {1e3 * end:g} mm, and no grain is {outside}"
                yield CaseError(f"grains.{key}", cut, why)
            continue
        if cut is not None and not over:
            continue
        fraction = " (percent, not a fraction)" if key == "coarsest" and stated <= 1.0 else ""
        where = "begins" if key == "finest" else "ends"
        yield CaseError(
            KEY if not over else f"grains.{key}",
            None if not over else cut,
            f"the curve {where} at {stated:g} % finer{fraction}, at {1e3 * end:g} mm, and does not say how "
            f"{'small' if key == 'finest' else 'large'} the rest is: add the diameter at which "
            f"{percent:g} % is finer, or leave the rest out with grains.{key} = '{1e3 * end:g} mm' or "
            f"{'more' if key == 'finest' else 'less'}",
        )


# ---------------------------------------------------------------------------------------- rows of ryusa check


def grading_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Sizes of the curve, what is cut of it, how well so many grains lay it and what the finest cost."""
    grading, points = grading_of(case), points_of(case)
    if grading is None or points is None:
        return []
    whole, given = _whole(points), case.grains.sieve_curve
    source = given if isinstance(given, str) else "given in the case"
    rows = [
        word("grains", "sieve curve", f"{len(points)} sieves", f"{source}; by mass, straight over log d"),
        *(_size(share, whole, grading) for share in SHARES),
        number("grains", "sorting", grading.sorting, "-", "geometric standard deviation sqrt(D84/D16)"),
        number("grains", "mean by number", grading.mean_diameter, "cm", "fine grains are most in number"),
    ]
    cut = _cut_rows(case.grains, whole, grading)
    return [*rows, *cut, *_laid_rows(derived, grading), _cost(derived, grading)]


def _size(share: float, whole: Grading, grading: Grading) -> ExplainRow:
    """A characteristic diameter of what is laid, with that of the curve where the cuts change it."""
    laid, origin, flag = grading.diameter(share), "of the grains laid", ""
    if whole.finer[0] <= share <= whole.finer[-1]:
        asked = whole.diameter(share)
        if not math.isclose(laid, asked, rel_tol=MOVED):
            origin += f"; of the whole curve {100.0 * asked:.3g} cm: finest and coarsest change it"
            flag = "warning"
    return number("grains", f"D{round(100 * share)}", laid, "cm", origin, flag)


def _cut_rows(grains: GrainsSection, whole: Grading, grading: Grading) -> Iterator[ExplainRow]:
    """What truncation leaves out, and what it would have cost.

    The shortest contact is one of the finest grains, and a cell of the search for neighbours is as wide as
    the largest grain and a little more.
    """
    low, high = grains.finest, grains.coarsest
    if low is not None and (share := whole.share_below(low)) > 0.0:
        without = "how small they are the curve does not say"
        if whole.finer[0] == 0.0:
            kept = (whole.share_below(high) if high else 1.0) - share
            open_cut = whole.cut(0.0, high or math.inf)
            steps = (float(grading.d[0]) / float(open_cut.d[0])) ** DURATION
            more = grading.mean_cube / open_cut.mean_cube * (kept + share) / kept
            without = (
                f"with them, down to {1e3 * float(open_cut.d[0]):.3g} mm, {_times(steps)} as many steps and "
                f"{_times(more)} as many grains for the same mass of the others"
            )
        yield _share("mass finer than finest, left out", share, f"grains.finest; {without}")
    if high is not None and (share := 1.0 - whole.share_below(high)) > 0.0:
        without = "how large they are the curve does not say"
        if whole.finer[-1] == 1.0:
            kept = 1.0 - share - (whole.share_below(low) if low else 0.0)
            open_cut = whole.cut(low or 0.0)
            wider = float(open_cut.d[-1]) / float(grading.d[-1])
            more = grading.mean_cube / open_cut.mean_cube * (kept + share) / kept
            without = (
                f"with them, up to {1e3 * float(open_cut.d[-1]):.3g} mm, no more steps at the same "
                f"stiffness, as the finest grains set the step; {_times(more)} as many grains for the same "
                f"mass of the others, and cells of the search for neighbours {_times(wider)} as wide"
            )
        yield _share("mass coarser than coarsest, left out", share, f"grains.coarsest; {without}")


def _share(name: str, share: float, origin: str) -> ExplainRow:
    return ExplainRow("grains", name, share, "-", f"{100.0 * share:.3g} %", origin, "warning")


def _laid_rows(derived: Derived, grading: Grading) -> Iterator[ExplainRow]:
    """How closely so many grains can lay the curve."""
    if derived.n_grain < 1:
        return
    share = grading.largest_share(derived.n_grain)
    poor = share > COARSE
    origin = f"share of the mass in the coarsest of {derived.n_grain:,} grains"
    origin += "; take more grains or a smaller grains.coarsest" if poor else ""
    flag = "warning" if poor else ""
    yield ExplainRow("grains", "curve met within", share, "-", f"{100.0 * share:.3g} %", origin, flag)


def _cost(derived: Derived, grading: Grading) -> ExplainRow:
    """What the finest grains cost, against equal grains of the reference diameter."""
    finest, tenth = float(grading.d[0]), grading.diameter(0.1)
    steps, grains = (derived.d / finest) ** DURATION, derived.d**3 / grading.mean_cube
    rest = grading.cut(tenth)
    fewer_steps = (finest / tenth) ** DURATION
    fewer_grains = 0.9 * grading.mean_cube / rest.mean_cube
    origin = (
        f"against equal grains of {1e3 * derived.d:.3g} mm, at the same stiffness and mass: {_times(steps)} "
        f"as many steps, {_times(grains)} as many grains; without the finest tenth of the mass "
        f"(grains.finest = '{1e3 * tenth:.3g} mm') {100.0 * fewer_steps:.2g} % of the steps, "
        f"{100.0 * fewer_grains:.2g} % of the grains"
    )
    work = steps * grains
    return ExplainRow("grains", "cost of the finest grains", work, "-", f"{work:.3g} times", origin, "note")


def _times(factor: float) -> str:
    return f"{factor:.3g} times"
