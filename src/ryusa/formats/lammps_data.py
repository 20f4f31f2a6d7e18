"""Data files of LAMMPS with `atom_style sphere`, as `write_data` makes them."""

import re
from pathlib import Path

import numpy as np

from ryusa.errors import ParseError
from ryusa.formats.grains import GrainTable
from ryusa.formats.text import Lines, ReadOptions, Rows, checked, opened, shown

_SKIPPED = {"Masses", "Pair Coeffs", "PairIJ Coeffs", "Atom Type Labels"}
_ATOMS = {"id": 0, "type": 1, "d": 2, "x": 4, "y": 5, "z": 6}  # words of a row; word 3 is the density
_VELOCITIES = {"vx": 1, "vy": 2, "vz": 3, "wx": 4, "wy": 5, "wz": 6}
_HEAD = re.compile(r"[^A-Za-z]*([a-z][a-zA-Z ]*)")


def read_data(path: Path, name: str, options: ReadOptions) -> GrainTable:
    """Read the grains of a data file. It does not say which sides are periodic, so the case must."""
    atoms: Rows | None = None
    speeds: Rows | None = None
    with opened(path, name) as lines:
        lines.need("the title of a data file of LAMMPS")
        n, section = _head(lines)
        while section:
            if section == "Atoms":
                atoms = _block(lines, n)
            elif section == "Velocities":
                speeds = _block(lines, n)
            elif section in _SKIPPED:
                _skip(lines)
            else:
                raise lines.error(f"expected Atoms or Velocities, found the section {shown(section)}")
            section = _next_section(lines)
        if atoms is None:
            raise lines.error("the file ends; expected the section Atoms")
    ids = atoms.integers(_ATOMS["id"], "an id")
    places = {one: word for one, word in _ATOMS.items() if one not in {"id", "type"}}
    values = atoms.columns(list(places.values()), [f"'{one}' of atom_style sphere" for one in places])
    columns = dict(zip(places, values, strict=True))
    if speeds is not None:
        columns |= _in_order(atoms, ids, speeds)
    table = GrainTable(
        name=name,
        columns=options.in_si(columns),
        fixed=options.fixed(atoms, _ATOMS["type"]),
        group=("",) * n,
        labels=tuple(f"of line {line} of {name}" for line, _ in atoms.where),
        ids=ids,
    )
    return checked(table, atoms, _ATOMS)


def _head(lines: Lines) -> tuple[int, str]:
    """Number of grains, and the name of the first section."""
    n = 0
    while lines.advance():
        text = lines.text.partition("#")[0].strip()
        if not text:
            continue
        if text[0].isalpha():
            if n < 1:
                raise lines.error("expected the number of atoms before the first section")
            return n, _style(lines)
        kind = _HEAD.fullmatch(text)
        words = kind.group(1) if kind else ""
        if words == "atoms":
            n = lines.integer(0, "the number of atoms", 1)
        elif words == "xy xz yz":
            raise lines.error("expected a box that is not skewed")
        elif not words:
            raise lines.error(f"expected a line such as '100 atoms', found {shown(text)}")
    raise lines.error("the file ends; expected the section Atoms")


def _style(lines: Lines) -> str:
    """Name of the section that this line begins; Atoms must be of style sphere where it says."""
    section, _, style = (part.strip() for part in lines.text.partition("#"))
    if section == "Atoms" and style and style != "sphere":
        raise lines.error(f"expected atom_style sphere, found {shown(style)}", 2)
    return section


def _next_section(lines: Lines) -> str:
    while lines.advance():
        if lines.text.strip():
            return _style(lines)
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


def _in_order(atoms: Rows, ids: np.ndarray, speeds: Rows) -> dict[str, np.ndarray]:
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
