"""The commit of the package: that of its own checkout, or of the one it was built from, never of another."""

import subprocess
import sys
from pathlib import Path

import pytest

from ryusa import version

HASH = "0123456789abcdef0123456789abcdef01234567"


def told_by(package: Path) -> str:
    """What a copy of the module says in a fresh interpreter."""
    code = "import version; print(version.commit())"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=package, check=True, capture_output=True, text=True
    )
    return done.stdout.strip()


def git(folder: Path, *words: str) -> str:
    who = ("-c", "user.name=A", "-c", "user.email=a@example.org")
    return subprocess.check_output(["git", "-C", folder, *who, *words], text=True).strip()


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    package = copied(tmp_path / "src" / "ryusa")
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-q", "-m", "one")
    assert package.is_dir()
    return tmp_path


def copied(package: Path) -> Path:
    package.mkdir(parents=True)
    (package / "version.py").write_bytes(Path(version.__file__).read_bytes())
    return package


def test_the_commit_is_a_hash_or_absent() -> None:
    found = version.commit()
    assert found is None or len(found.rstrip("+")) == 40


def test_a_checkout_says_its_commit_and_whether_files_differ(checkout: Path) -> None:
    head = git(checkout, "rev-parse", "HEAD")
    package = checkout / "src" / "ryusa"
    assert told_by(package) == head
    with (package / "version.py").open("a") as file:
        file.write("\n")
    assert told_by(package) == f"{head}+"


def test_an_environment_in_a_checkout_does_not_take_the_commit_of_that(checkout: Path) -> None:
    installed = copied(checkout / ".venv" / "lib" / "ryusa")
    assert told_by(installed) == "None"
    (installed / version.COMMIT).write_text(f"{HASH}\n")
    assert told_by(installed) == HASH


def test_a_package_without_git_says_the_commit_it_was_built_from(tmp_path: Path) -> None:
    package = copied(tmp_path / "ryusa")
    assert told_by(package) == "None"
    (package / version.COMMIT).write_text(f"{HASH}+\n")
    assert told_by(package) == f"{HASH}+"
