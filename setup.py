"""Writes into a package the commit it is built from, for `ryusa --version` and the provenance of runs."""

import subprocess
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

FILE = "ryusa/commit.txt"
HERE = Path(__file__).resolve().parent


def commit() -> str:
    """Commit of this checkout, with "+" if files differ; empty in an unpacked sdist, which has the file."""
    found = git("rev-parse", "HEAD") if (HERE / ".git").exists() else ""
    return found + ("+" if found and git("status", "--porcelain", "--untracked-files=no") else "")


def git(*words: str) -> str:
    """What git prints about this checkout; empty where it fails."""
    try:
        return subprocess.run(
            ["git", "-C", HERE, *words], check=True, capture_output=True, text=True
        ).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""


def write(file: Path) -> None:
    """Write the commit where it is known."""
    if found := commit():
        file.unlink(missing_ok=True)  # may be a hard link
        file.write_text(f"{found}\n", encoding="ascii")


class BuildPy(build_py):
    """The package with its commit; an editable one asks git."""

    def run(self) -> None:
        """Copy the files of the package, and add the commit."""
        super().run()
        if not self.editable_mode:
            write(Path(self.build_lib, FILE))


class Sdist(sdist):
    """The source with its commit."""

    def make_release_tree(self, base_dir: str, files: list[str]) -> None:
        """Copy the files of the source, and add the commit."""
        super().make_release_tree(base_dir, files)
        write(Path(base_dir, "src", FILE))


setup(cmdclass={"build_py": BuildPy, "sdist": Sdist})
