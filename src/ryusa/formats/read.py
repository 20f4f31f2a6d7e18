"""First grains from a file: which reader reads which format."""

from pathlib import Path

from ryusa.errors import ParseError
from ryusa.formats.csv import read_csv
from ryusa.formats.extxyz import read_xyz
from ryusa.formats.grains import GrainTable
from ryusa.formats.lammps_data import read_data
from ryusa.formats.lammps_dump import read_dump
from ryusa.formats.text import ReadOptions
from ryusa.formats.vtu import read_vtu

LARGEST_FILE = 1 << 30  # bytes


def read_grains(path: Path, name: str, kind: str, options: ReadOptions) -> GrainTable:
    """Read the grains of one frame.

    Parameters
    ----------
    path, name : the file, and what messages call it.
    kind : "csv", "lammps-dump", "lammps-data", "xyz" or "vtu".
    options : what the file leaves open.

    Raises
    ------
    ParseError : the file is not what it should be; names line and column.
    """
    if path.stat().st_size > LARGEST_FILE:
        raise ParseError(name, 1, 1, "is larger than 1 GiB, the limit for a file of grains")
    if kind == "csv":
        return read_csv(path, name, options.frame)
    if kind == "vtu":
        return read_vtu(path, name)
    return {"lammps-dump": read_dump, "lammps-data": read_data, "xyz": read_xyz}[kind](path, name, options)
