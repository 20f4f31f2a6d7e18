"""The gallery: every picture of docs/pictures with the commands that draw it, from gallery.toml.

`python docs/site/gallery.py FOLDER` draws those of the packaged cases anew; `make gallery` does it.
"""

import shlex
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
PICTURES = HERE.parent / "pictures"


def entries() -> list[dict[str, Any]]:
    """Entries of gallery.toml: picture, title, text and commands."""
    return tomllib.loads((HERE / "gallery.toml").read_text(encoding="utf-8"))["picture"]


def page() -> str:
    """Page of the gallery."""
    lines = [
        "# Gallery",
        "",
        "Every picture here was drawn by ryusa, with the commands shown beneath it. `ryusa draw` also writes "
        "the numbers in the picture as CSV.",
    ]
    for one in entries():
        lines += [
            "",
            f"## {one['title']}",
            "",
            f"![{one['title']}](pictures/{one['file']})",
            "",
            one["text"].strip(),
        ]
        lines += ["", "```sh", *one["commands"], "```"]
    return "\n".join([*lines, ""])


def problems() -> list[str]:
    """Pictures without an entry, and entries whose commands the command line does not know."""
    import generate

    shown = {one["file"] for one in entries()}
    found = [
        f"docs/pictures/{one.name} is not in the gallery"
        for one in PICTURES.glob("*.png")
        if one.name not in shown
    ]
    known = generate.commands()
    for one in entries():
        if not one["commands"]:
            found.append(f"gallery: {one['file']} has no command")
        for line in one["commands"]:
            found += [f"gallery: {one['file']}: {said}" for said in _unknown(line, known)]
    return found


def _unknown(line: str, known: dict[str, Any]) -> list[str]:
    words = shlex.split(line, comments=True)
    if words[0] != "ryusa" or words[1] not in known:
        return [f"'{line}' is no command of ryusa"]
    options = {option for one in known[words[1]].params for option in [*one.opts, *one.secondary_opts]}
    return [
        f"'{words[1]}' has no option {word}"
        for word in words
        if word.startswith("--") and word not in options
    ]


def draw(folder: Path) -> None:
    """Run the commands of the pictures of packaged cases in a folder, but those of hours, and keep these."""
    from PIL import Image

    folder.mkdir(parents=True)
    ran: set[str] = set()
    for one in entries():
        if one.get("hours") or any(line.startswith("ryusa paper") for line in one["commands"]):
            continue
        for line in one["commands"]:
            if line not in ran:
                print(line, flush=True)
                words = shlex.split(line)[1:]
                subprocess.run([sys.executable, "-m", "ryusa", *words], cwd=folder, check=True)
                ran.add(line)
        with Image.open(folder / one["file"]) as picture:
            small = picture.convert("RGB")
        small.thumbnail((1400, 1400), Image.Resampling.LANCZOS)
        small.quantize(128, dither=Image.Dither.NONE).save(PICTURES / one["file"], optimize=True)


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
