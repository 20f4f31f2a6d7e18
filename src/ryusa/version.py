"""Version of the package, and the commit it was made from."""

from functools import cache
from pathlib import Path

__version__ = "1.0.0"

COMMIT = "commit.txt"  # in a built package, beside this file; setup.py writes it
_GIT_PATIENCE = 5.0  # s


@cache
def commit() -> str | None:
    """Git commit of the checkout that contains this package, or of the one it was built from.

    It ends with "+" if files differed from it. None where neither is known.
    """
    here = Path(__file__).resolve().parent
    top = git(here, "rev-parse", "--show-toplevel")
    if top is None or Path(top, "src", "ryusa").resolve() != here:  # else of a checkout around an environment
        try:
            return (here / COMMIT).read_text(encoding="ascii").strip() or None
        except (OSError, UnicodeDecodeError):
            return None
    found = git(here, "rev-parse", "HEAD")
    changed = git(here, "status", "--porcelain", "--untracked-files=no", "--", str(here.parent))
    return None if found is None else found + ("+" if changed else "")


def described() -> str:
    """Version and commit in one line, as `ryusa --version` prints them.

    >>> described().startswith(f"{__version__} (commit ")
    True
    """
    return f"{__version__} (commit {commit() or 'unknown'})"


def git(folder: Path, *words: str) -> str | None:
    """What a command of git prints in a folder; None where it fails."""
    import subprocess

    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *words],
            capture_output=True,
            text=True,
            timeout=_GIT_PATIENCE,
            check=False,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() if done.returncode == 0 else None
