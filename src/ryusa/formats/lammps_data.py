"""Data files of LAMMPS and LIGGGHTS of grains with a diameter, as `write_data` makes them."""

from itertools import takewhile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ryusa.errors import ParseError
from ryusa.formats.grains import GrainTable
from ryusa.formats.names import not_used
from ryusa.formats.text import Lines, ReadOptions, Rows, checked, opened, shown

_SKIPPED = {"Masses", "Pair Coeffs", "PairIJ Coeffs", "Atom Type Labels"}
_OF_HEAD = {"xlo xhi", "ylo yhi", "zlo zhi", "xy xz yz", "atom types"}  # of which nothing need be said
_VELOCITIES = {"vx": 1, "vy": 2, "vz": 3, "wx": 4, "wy": 5, "wz": 6}
_WIDTH = 1 + len(_VELOCITIES)  # words of a row of velocities
_UNUSED = {"molecule", "charge", "dipole_x", "dipole_y", "dipole_z"}  # words of a row of atoms
_IMAGES = 3  # words that may follow those of a row


class _Style(NamedTuple):
    """How the rows of a style of atoms read: what words 0, 1, ... are; what is not used has no name."""

    name: str
    words: tuple[str, ...]

    def place(self, one: str) -> int:
        return self.words.index(one)


_OF_SPHERES = ("d", "density")
_STYLES = {
    "sphere": _Style("sphere", ("id", "type", *_OF_SPHERES, "x", "y", "z")),
    "bpm/sphere": _Style("bpm/sphere", ("id", "molecule", "type", *_OF_SPHERES, "x", "y", "z")),
}
_STYLES["granular"] = _STYLES["sphere"]  # its name in LIGGGHTS
_HYBRID = {  # words that a style adds to a row of atom_style hybrid, in the order in which it names them
    "sphere": _OF_SPHERES,
    **dict.fromkeys(("angle", "bond", "molecular"), ("molecule",)),
    "charge": ("charge",),
    "full": ("molecule", "charge"),
    "dipole": ("charge", "dipole_x", "dipole_y", "dipole_z"),
    "atomic": (),
}


def read_data(path: Path, name: str, options: ReadOptions) -> GrainTable:
    """Read the grains of a data file. It does not say which sides are periodic, so the case must."""
    atoms: Rows | None = None
    speeds: Rows | None = None
    skipped = list[str]()
    with opened(path, name) as lines:
        lines.need("the title of a data file of LAMMPS")
        n, section, others = _head(lines)
        style = _STYLES["sphere"]
        while section:
            if section == "Atoms":
                style = _style(lines)
                atoms = _block(lines, n)
                _check_words(atoms, style)
            elif section == "Velocities":
                speeds = _block(lines, n)
                _check_speeds(speeds)
            elif section in _SKIPPED:
                _skip(lines)
                skipped.append(section)
            else:
                raise lines.error(f"expected Atoms or Velocities, found the section {shown(section)}")
            section = _next_section(lines)
        if atoms is None:
            raise lines.error("the file ends; expected the section Atoms")
        notes = (
            *lines.notes,
            *not_used(name, (one for one in style.words if one in _UNUSED)),
            *not_used(name, skipped, "sections"),
            *not_used(name, others, "lines of the head"),
        )
    ids = atoms.integers(style.place("id"), "an id")
    places = {one: style.place(one) for one in ("d", "density", "x", "y", "z")}
    values = atoms.columns(list(places.values()), [f"'{one}' of atom_style {style.name}" for one in places])
    columns = dict(zip(places, values, strict=True))
    if speeds is not None:
        columns |= _in_order(ids, speeds)
    table = GrainTable(
        name=name,
        columns=options.in_si(columns),
        fixed=options.fixed(atoms, style.place("type")),
        group=("",) * n,
        labels=tuple(f"of line {line} of {name}" for line, _ in atoms.where),
        ids=ids,
        notes=notes,
    )
    return checked(table, atoms, {**places, "id": style.place("id")})


def _head(lines: Lines) -> tuple[int, str, list[str]]:
    """Number of grains, the name of the first section, and the lines that are not used."""
    n, others = 0, list[str]()
    while lines.advance():
        text = lines.text.partition("#")[0].strip()
        if not text:
            continue
        if text[0].isalpha():
            if n < 1:
                raise lines.error("expected the number of atoms before the first section")
            return n, _section(lines), others
        words = text.split()
        numbers = list(takewhile(_is_number, words))
        about = " ".join(words[len(numbers) :])
        if about == "atoms":
            n = lines.integer(0, "the number of atoms", 1)
        elif about == "xy xz yz" and any(float(one) for one in numbers):
            raise lines.error("expected a box that is not skewed")
        elif about in {"avec", "bvec", "cvec"}:
            raise lines.error("expected a box along x, y and z, with xlo xhi, ylo yhi and zlo zhi")
        elif not numbers or not about:
            raise lines.error(f"expected a line such as '100 atoms', found {shown(text)}")
        elif about not in _OF_HEAD and any(float(one) for one in numbers):
            others.append(shown(text))
    raise lines.error("the file ends; expected the section Atoms")


def _is_number(word: str) -> bool:
    try:
        return bool(float(word) or True)
    except ValueError:
        return False


def _section(lines: Lines) -> str:
    """Name of the section that this line begins."""
    return lines.text.partition("#")[0].strip()


def _style(lines: Lines) -> _Style:
    """Style of the section Atoms that this line begins; sphere where it does not say."""
    words = lines.text.partition("#")[2].split()
    if not words:
        return _STYLES["sphere"]
    if words[0] == "hybrid" and "sphere" in words and set(words[1:]) <= set(_HYBRID):
        more = [one for style in words[1:] for one in _HYBRID[style]]
        return _Style(" ".join(words), ("id", "type", "x", "y", "z", *more))
    if words[0] not in _STYLES or len(words) > 1:
        raise lines.error(
            f"expected grains with a diameter, atom_style {', '.join(_STYLES)} or hybrid with sphere; found "
            f"{shown(' '.join(words))}",
            2,
        )
    return _STYLES[words[0]]


def _check_words(atoms: Rows, style: _Style) -> None:
    """Refuse rows that are not of the style: their words would be taken for other numbers."""
    n = len(style.words)
    for row, (_, text) in enumerate(atoms.where):
        found = len(text.partition("#")[0].split())
        if found not in {n, n + _IMAGES}:
            raise atoms.error(
                row, min(found, n) - 1,
                f"expected {n} words as of atom_style {style.name} ({' '.join(style.words)}), or "
                f"{n + _IMAGES} with image flags, found {found}: write the file with atom_style sphere, or "
                "name its style behind 'Atoms #'",
            )  # fmt: skip


def _check_speeds(speeds: Rows) -> None:
    """Refuse rows of more than the velocity and the spin of a sphere."""
    for row, (_, text) in enumerate(speeds.where):
        if (found := len(text.partition("#")[0].split())) > _WIDTH:
            raise speeds.error(row, _WIDTH, f"expected {_WIDTH} words: id vx vy vz wx wy wz, found {found}")


def _next_section(lines: Lines) -> str:
    while lines.advance():
        if lines.text.strip():
            return _section(lines)
    return ""


def _block(lines: Lines, n: int) -> Rows:
    """The n lines of a section, after one that is blank."""
    if lines.need("a blank line after the name of a section").strip():
        raise lines.error("expected a blank line after the name of a section")
    return lines.block(n)


def _skip(lines: Lines) -> None:
    lines.need("a blank line after the name of a section")
    while lines.advance() and lines.text.strip():
        pass


def _in_order(ids: np.ndarray, speeds: Rows) -> dict[str, np.ndarray]:
    """Velocities and spins, in the order of the atoms."""
    place = {one: k for k, one in enumerate(ids.tolist())}
    order = np.zeros(len(ids), dtype=np.intp)
    given = speeds.integers(0, "an id").tolist()
    for row, one in enumerate(given):
        if one not in place:
            raise speeds.error(row, 0, f"no atom has the id {one}")
        order[place[one]] = row
    if len(set(given)) < len(given):
        raise _twice(speeds, given)
    values = speeds.columns(list(_VELOCITIES.values()), [f"'{one}'" for one in _VELOCITIES])
    return {one: column[order] for one, column in zip(_VELOCITIES, values, strict=True)}


def _twice(rows: Rows, ids: list[int]) -> ParseError:
    row = next(k for k, one in enumerate(ids) if one in ids[:k])
    return rows.error(row, 0, f"the id {ids[row]} appears twice")
