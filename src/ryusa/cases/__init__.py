"""Case files that come with the package: general ones here, those of the studies in a folder each."""

from pathlib import Path

_HERE = Path(__file__).resolve().parent

# What comes before the name of a case on the command line, and the folder that holds such cases.
FOLDERS = {
    "": _HERE,
    "paper": _HERE / "paper",
    "validation": _HERE / "validation",
}


def case_path(name: str) -> Path:
    """Path of a packaged case file, or of a table beside one.

    >>> case_path("paper/fig19.toml").is_file()
    True
    """
    folder, _, file = name.rpartition("/")
    return FOLDERS[folder] / file


def case_files(folder: str = "") -> dict[str, Path]:
    """Packaged cases of one folder: the name that `ryusa new` takes, and the file.

    >>> "drop" in case_files(), "paper/fig19" in case_files("paper")
    (True, True)
    """
    before = f"{folder}/" if folder else ""
    return {f"{before}{one.stem}": one for one in sorted(FOLDERS[folder].glob("*.toml"))}
