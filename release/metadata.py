"""Version and description in every file that tells them: `python release/metadata.py [VERSION]`.

With VERSION it is written wherever it stands; codemeta.json and .zenodo.json are written from pyproject.toml.
"""

import json
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
VERSION = r"\d+\.\d+\.\d+(?:(?:a|b|rc)\d+)?"
PLACES = {  # what stands before the version
    "src/ryusa/version.py": ['__version__ = "'],
    "pyproject.toml": ['\nversion = "', "ryusa-kernels==", "ryusa-studies=="],
    "studies/pyproject.toml": ['\nversion = "', '"ryusa=='],
    "CITATION.cff": ["\nversion: "],
    "packaging/conda/recipe.yaml": ['\n  version: "'],
}


def versions() -> dict[str, str]:
    """The version as each place has it, by file and what stands before it."""
    found: dict[str, str] = {}
    for name, befores in PLACES.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        for before in befores:
            (found[f"{name}: {before.strip()}"],) = re.findall(f"{re.escape(before)}({VERSION})", text)
    return found


def write_version(version: str) -> None:
    """Write another version wherever it stands."""
    if not re.fullmatch(VERSION, version):
        raise SystemExit(f"{version}: no version such as 1.0.0")
    for name, befores in PLACES.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        for before in befores:
            text = re.sub(f"({re.escape(before)}){VERSION}", rf"\g<1>{version}", text)
        (ROOT / name).write_text(text, encoding="utf-8")


def written() -> dict[Path, str]:
    """Content of the files that follow from pyproject.toml."""
    project: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    names = [one["name"] for one in project["authors"]]
    codemeta = {
        "@context": "https://w3id.org/codemeta/3.0",
        "@type": "SoftwareSourceCode",
        "name": project["name"],
        "version": project["version"],
        "description": project["description"],
        "license": f"https://spdx.org/licenses/{project['license']}",
        "author": [{"@type": "Organization", "name": name} for name in names],
        "keywords": project["keywords"],
        "programmingLanguage": "Python",
        "runtimePlatform": f"Python {project['requires-python']}",
        "operatingSystem": ["Linux"],
        "softwareRequirements": project["dependencies"],
    }
    zenodo = {
        "title": f"{project['name']}: {project['description'][0].lower()}{project['description'][1:]}",
        "upload_type": "software",
        "version": project["version"],
        "description": f"<p>{project['description']}.</p>",
        "license": project["license"],
        "creators": [{"name": name} for name in names],
        "keywords": project["keywords"],
        "language": "eng",
    }
    return {ROOT / "codemeta.json": _json(codemeta), ROOT / ".zenodo.json": _json(zenodo)}


def _json(data: dict[str, Any]) -> str:
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"


def main() -> None:
    """Write what is not as it should be."""
    if len(sys.argv) > 1:
        write_version(sys.argv[1])
    for file, text in written().items():
        file.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
