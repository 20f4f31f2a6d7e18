"""Build the documentation site: `python docs/site/make.py OUT`; `make site` does it.

The pages lie in several places of the repository (docs, design, CONTRIBUTING.md, the changelog) and link to
each other as files, so that they can be read there too. Here they are gathered under one folder, their links
rewritten, the API reference is added, and Sphinx is run with every warning as an error.
"""

import argparse
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(HERE.parent)]

import api
import gallery
import generate
import listings

FENCE = re.compile(r"^(```|~~~|:::).*?^\1", flags=re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(?P<text>\[[^\]]*\])\((?P<target>[^)\s#]+)(?P<anchor>#[^)\s]*)?\)")
UNLISTED, LEDGERS = "@unlisted", "@ledgers"  # in the table of contents of a page
CONTENTS = re.compile(r"^<!-- contents: (.*) -->$", flags=re.MULTILINE)  # of a page read elsewhere too
QUESTIONS = "@questions"  # a table of what users come with
REMOTE = re.compile(r"^[a-z]+:")


def places() -> dict[Path, str]:
    """File of the repository to its place in the site, for every page written by hand."""
    found = {page: page.name for page in sorted((ROOT / "docs").glob("*.md"))}
    found |= {page: page.name for page in sorted((HERE / "pages").glob("*.md"))}
    for folder in ("docs/ja", "docs/ledgers", "design", "design/lab"):
        place = folder.removeprefix("docs/")
        found |= {page: f"{place}/{page.name}" for page in sorted((ROOT / folder).glob("*.md"))}
    found[ROOT / "CONTRIBUTING.md"] = "contributing.md"
    found[ROOT / "benchmarks" / "README.md"] = "benchmarks.md"
    found[ROOT / "benchmarks" / "results" / "full.md"] = "benchmark-tables.md"
    found[ROOT / "README.md"] = "index.md"
    found[ROOT / "CHANGELOG.md"] = "changelog.md"
    return {page: place for page, place in found.items() if page.exists()}


class Stage:
    """The folder from which Sphinx builds, and what could not be put into it.

    Attributes
    ----------
    folder : where the pages are gathered.
    problems : links that lead nowhere, and whatever else keeps the site from being whole.
    """

    def __init__(self, folder: Path) -> None:
        """Begin with an empty folder."""
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        self.folder = folder
        self.problems: list[str] = []
        self.places = places()

    def gather(self) -> None:
        """Write every page with its links rewritten."""
        for page, place in self.places.items():
            if page == ROOT / "README.md":
                continue  # the site has its own front page, to which links to the README lead
            text = page.read_text(encoding="utf-8").replace(UNLISTED, "\n".join(self.unlisted()))
            ledgers = [one.removesuffix(".md") for one in self.places.values() if one.startswith("ledgers/")]
            text = text.replace(LEDGERS, "\n".join(ledgers)).replace(QUESTIONS, listings.questions())
            text = CONTENTS.sub(r"```{toctree}\n:hidden:\n\n\1\n```", text)
            self.write(place, self.relinked(text, page, place))
        shutil.copytree(HERE / "static", self.folder / "static")
        for settings in ("conf.py", "docstrings.py", "languages.py"):
            shutil.copy(HERE / settings, self.folder)

    def unlisted(self) -> list[str]:
        """Pages that no table of contents names: they stand at the end of the how-to guides."""
        contents = " ".join(page.read_text(encoding="utf-8") for page in (HERE / "pages").glob("*.md"))
        named = set(re.findall(r"[\w/-]+", contents))
        pages = [place.removesuffix(".md") for place in self.places.values()]
        return [page for page in pages if "/" not in page and page not in {"index", *named}]

    def write(self, place: str, text: str) -> None:
        """Write one page."""
        page = self.folder / place
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text(text, encoding="utf-8")

    def relinked(self, text: str, page: Path, place: str) -> str:
        """Page whose links lead to places of the site; files that are no page come along as downloads."""
        kept: list[str] = []

        def keep(found: re.Match[str]) -> str:
            kept.append(found[0])
            return f"\0{len(kept) - 1}\0"

        def link(found: re.Match[str]) -> str:
            target = found["target"]
            if REMOTE.match(target):
                return found[0]
            aim = (page.parent / target).resolve()
            if page.is_relative_to(HERE / "pages"):
                aim = (ROOT / "docs" / target).resolve()
            if aim in self.places:
                there = self.places[aim]
            elif aim.is_file() and aim.is_relative_to(ROOT):
                inside = aim.relative_to(ROOT)
                there = (
                    str(inside.relative_to("docs")) if inside.is_relative_to("docs") else f"files/{inside}"
                )
                (self.folder / there).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(aim, self.folder / there)
            elif aim.is_dir() and aim.is_relative_to(ROOT):
                return found["text"][1:-1]  # a folder of the repository has no page
            else:
                self.problems.append(
                    f"{page.relative_to(ROOT)}: link to {target}, which is no file of the repository"
                )
                return found[0]
            up = "../" * place.count("/")
            return f"{found['text']}({up}{there}{found['anchor'] or ''})"

        text = FENCE.sub(keep, text)
        text = LINK.sub(link, text)
        return re.sub(r"\0(\d+)\0", lambda found: kept[int(found[1])], text)

    def changelog(self) -> None:
        """Add the fragments of the next release to the changelog."""
        page = ROOT / "CHANGELOG.md"
        text = self.relinked(page.read_text(encoding="utf-8"), page, "changelog.md")
        lines = [text.rstrip(), ""]
        for word in ("added", "changed", "fixed", "removed"):
            fragments = sorted((ROOT / "changelog").glob(f"*.{word}.md"))
            if fragments:
                lines += [f"### {word.capitalize()}", ""]
                for one in fragments:
                    said = " ".join(one.read_text(encoding="utf-8").split()).removeprefix("- ")
                    lines.append(f"- {self.relinked(said, page, 'changelog.md')}")
                lines.append("")
        self.write("changelog.md", "\n".join(lines))


def main() -> int:
    """Build the site; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--jobs", default="auto")
    options = parser.parse_args()
    out = options.out.resolve()
    stage = Stage(out.parent / f"{out.name}-source")
    problems = stage.problems
    problems += [f"{name}: no docstring" for name in api.undocumented()]
    problems += generate.undocumented()
    problems += [
        f"{page.relative_to(ROOT)} is not as generated: run `make docs`" for page in generate.stale()
    ]
    stage.gather()
    stage.changelog()
    stage.write("gallery.md", stage.relinked(gallery.page(), ROOT / "docs" / "gallery.md", "gallery.md"))
    problems += gallery.problems()
    stage.write("choices.md", listings.choices_page())
    stage.write("law-index.md", listings.laws_page())
    stage.write("cases.md", listings.cases_page())
    (stage.folder / "api").mkdir()
    api.write_pages(stage.folder / "api")
    for problem in problems:
        print(f"site: {problem}", file=sys.stderr)
    if problems:
        return 1
    shutil.rmtree(out, ignore_errors=True)
    words = ["-W", "--keep-going", "-n", "-q", "-j", options.jobs, "-b", "html", str(stage.folder), str(out)]
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", "-d", str(out.parent / f"{out.name}-doctrees"), *words], check=False
    )
    if done.returncode == 0:
        print(f"The site is in {options.out}/index.html")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
