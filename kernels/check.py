"""Install the two wheels alone, take the first run of each packaged case, and count what is compiled.

    python kernels/check.py FOLDER WHEELS [CASE ...]

FOLDER is that of make.py, whose runs compiled in place: all frames and the last state must have the same
bits. Fails where something was compiled, or where a bit differs.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
from first_run import first_run

from ryusa.cases import case_files
from ryusa.compiled.processor import Processor
from ryusa.compiled.store import Store

CONSTRAINTS = Path(__file__).resolve().parent.parent / "constraints.txt"


def main() -> None:
    """Check all packaged cases, or those that are named."""
    folder, wheels = (Path(one).resolve() for one in sys.argv[1:3])
    here, runs = folder / "environment", folder / "runs-from-wheels"
    os.environ.pop("PYTHONPATH", None)
    files = [one for part in ("ryusa", "ryusa_kernels") for one in wheels.glob(f"{part}-*.whl")]
    if len(files) != 2:
        raise SystemExit(f"{wheels} does not hold one wheel of ryusa and one of its kernels: make kernels")
    subprocess.run([sys.executable, "-m", "venv", "--clear", here], check=True)
    pip = [here / "bin" / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "--constraint", CONSTRAINTS, *files], check=True)
    shutil.rmtree(runs, ignore_errors=True)
    runs.mkdir()
    faults = 0
    print(f"{'case':<24}{'run':>6}{'resume':>8}{'report':>8}{'film':>6}  [s of processor time]")
    for name in sys.argv[3:] or list(case_files()):
        cache = runs / f"{name}.cache"
        os.environ["RYUSA_CACHE"] = str(cache)
        took = first_run([str(here / "bin" / "ryusa")], name, case_files()[name], runs / name)
        kept = Store(cache, Processor("", "", "")).listed()
        compiled = [one.about["name"] for one in kept if one.about["kind"] != "inner"]
        differ = different(folder / "runs" / name, runs / name)
        faults += bool(compiled or differ)
        times = "{run:6.1f}{resume:8.1f}{report:8.1f}{film:6.1f}".format_map(took)
        print(f"{name:<24}{times}  compiled: {compiled or 'nothing'}; {differ or 'same bits'}", flush=True)
    if faults:
        raise SystemExit(f"{faults} cases compiled something or gave other bits")


def different(one: Path, other: Path) -> list[str]:
    """Data sets of two run folders whose bits are not the same."""
    first, second = (_datasets(folder) for folder in (one, other))
    return [
        name for name in sorted(first.keys() | second.keys()) if not _same(first.get(name), second.get(name))
    ]


def _datasets(folder: Path) -> dict[str, np.ndarray]:
    """All frames, and the last state of grains and water; `about` holds times of the clock."""
    found: dict[str, np.ndarray] = {}
    for path in [*folder.glob("*.vtkhdf"), folder / "checkpoint.h5"]:

        def note(name: str, item: object, path: Path = path) -> None:
            if isinstance(item, h5py.Dataset) and name != "about":
                found[f"{path.name}:{name}"] = item[...]

        with h5py.File(path) as file:
            file.visititems(note)
    return found


def _same(one: np.ndarray | None, other: np.ndarray | None) -> bool:
    if one is None or other is None or one.shape != other.shape or one.dtype != other.dtype:
        return False
    return one.dtype.hasobject or one.tobytes() == other.tobytes()


if __name__ == "__main__":
    main()
