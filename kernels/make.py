"""Compile what the packaged cases need, and build the wheels of ryusa and of that code.

    python kernels/make.py FOLDER WHEELS [CASE ...]

Every case is run, resumed, measured, drawn and filmed by the commands that a user types, for some steps. What
they compile is kept in FOLDER; the machine code of it goes into a wheel, without what is built into that.
Code is for x86-64-v3, the processors of 2013 and later; for another architecture it is for this processor.
"""

import os
import platform
import shutil
import subprocess
import sys
import time
from pathlib import Path

NAMED = {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""}
HERE = Path(__file__).resolve().parent
ASIDE = 2 * 86_400.0  # [s] of age that all code is given, so that what is read again shows (store.py)


def main() -> None:
    """Make the wheels for all packaged cases, or for those that are named."""
    folder, wheels = (Path(one).resolve() for one in sys.argv[1:3])
    os.environ |= {"RYUSA_CACHE": str(folder / "cache"), "RYUSA_KERNELS": "native"}
    os.environ |= NAMED if platform.machine().lower() in {"x86_64", "amd64"} else {}
    from first_run import first_run

    from ryusa.cases import case_files
    from ryusa.compiled import store

    cases = sys.argv[3:] or list(case_files())
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    kept, aside = store.own(), time.time() - ASIDE
    for one in kept.listed():
        os.utime(one.file, (aside, aside))
    for name in cases:
        took = first_run([sys.executable, "-m", "ryusa"], name, case_files()[name], folder / "runs" / name)
        print(f"{name:<24}{sum(took.values()):6.0f} s of processor time", flush=True)
    used = [one for one in kept.listed() if one.used > aside + ASIDE / 2]
    project = copy(folder / "project", [one.file for one in used if one.about["kind"] != "inner"], cases)
    wheel(project, wheels)
    shutil.rmtree(HERE.parent / "build" / "lib", ignore_errors=True)  # else modules that are gone come along
    wheel(HERE.parent, wheels)


def copy(project: Path, files: list[Path], cases: list[str]) -> Path:
    """Copy the project of the wheel, with files of a store and the manifest of them."""
    from ryusa import __version__
    from ryusa.compiled import processor, shipped

    shutil.rmtree(project, ignore_errors=True)
    shutil.copytree(HERE, project, ignore=shutil.ignore_patterns("*.egg-info", "build", "__pycache__"))
    package = project / shipped.PACKAGE
    for file in files:
        place = package / shipped.STORE / file.parent.name / file.name
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, place)
    shipped.Manifest(
        ryusa=__version__, source=shipped.source_digest(), versions=processor.versions(),
        processor=processor.own().key, cases=tuple(cases), files=len(files),
    ).write(package / shipped.MANIFEST)  # fmt: skip
    return project


def wheel(project: Path, wheels: Path) -> None:
    """Build the wheel of a project."""
    words = ["wheel", "--quiet", "--no-deps", "--wheel-dir", str(wheels), str(project)]
    subprocess.run([sys.executable, "-m", "pip", *words], check=True)


if __name__ == "__main__":
    main()
