"""Names under which files of other programs hold sizes, masses and densities of grains."""

import re
from collections.abc import Iterable

_PREFIX = re.compile(r"^[cfvid]_(?:.*_)?(?=[a-z])")  # of what a user of LAMMPS computes: c_rad, v_d, f_size
_MEANINGS = {  # column of a table of grains, and the factor to it
    **dict.fromkeys(("diameter", "diameters", "diam", "dia", "d"), ("d", 1.0)),
    **dict.fromkeys(("radius", "radii", "rad", "sphere_radius"), ("d", 2.0)),
    **dict.fromkeys(("density", "rho"), ("density", 1.0)),
    **dict.fromkeys(("mass", "masses", "m"), ("m", 1.0)),
}


def meaning_of(name: str) -> tuple[str, float] | None:
    """Column of a table of grains that a column of a file is, and the factor to it; None for others.

    >>> meaning_of("Radius"), meaning_of("c_rad"), meaning_of("v_d"), meaning_of("fx")
    (('d', 2.0), ('d', 2.0), ('d', 1.0), None)
    """
    word = name.strip().lower().partition("[")[0].replace(" ", "_")
    return _MEANINGS.get(word) or _MEANINGS.get(_PREFIX.sub("", word))


def not_used(file: str, columns: Iterable[str], what: str = "columns") -> tuple[str, ...]:
    """What is said of the columns of a file that a case has no use for; nothing where there are none."""
    names = ", ".join(dict.fromkeys(columns))
    return (f"{what} of {file} that are not used: {names}",) if names else ()


def open_in_z(file: str, periodic: bool) -> tuple[str, ...]:
    """What is said of a file whose box is periodic in z."""
    return (f"{file} is periodic in z, the scene is open there",) if periodic else ()
