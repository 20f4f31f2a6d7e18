"""Open pages of the built site in a browser: `python -m tests.docs.check_site build/site`; `make site` does.

One page of each kind must be free of faults that axe-core finds, in light and in dark, and no picture may
have the name of its file for words.
"""

import os
import re
import sys
from pathlib import Path

from tests.accessible import MISSING, Fault, chromium, chromium_path, faults_of_page

KINDS = (
    "index.html",
    "ja/index.html",
    "heap-notebook.html",  # pictures and a viewer
    "theory.html",  # formulae
    "gallery.html",
    "api/ryusa.measure.along_row.html",
)
KNOWN = {  # rule, and place of what Sphinx writes and no style sheet mends
    "definition-list": r"#ryusa\S+ > dl",  # the parameters of a signature, a list without terms
}
FILE_FOR_WORDS = re.compile(r'<img[^>]*\salt="([^"]*\.(?:png|svg|webp|gif))"')


def pictures_without_words(site: Path) -> list[str]:
    """Pages with a picture that is called as its file."""
    return [
        f"{page.relative_to(site)}: a picture is called {found}"
        for page in sorted(site.rglob("*.html"))
        for found in FILE_FOR_WORDS.findall(page.read_text(encoding="utf-8"))
    ]


def is_known(one: Fault) -> bool:
    """Whether a fault is listed as not ours."""
    return one.rule in KNOWN and re.fullmatch(KNOWN[one.rule], one.place) is not None


def main(site: Path) -> int:
    """Return the exit status: 1 with a fault."""
    faults = pictures_without_words(site)
    if chromium_path() is None:
        print(f"{MISSING}; the pages of the site are not opened")
        return 1 if faults or "RYUSA_BROWSER" in os.environ else 0
    with chromium() as browser:
        found = [fault for name in KINDS for fault in faults_of_page(browser, site / name)]
    faults += [f"{one.page}, {one.scheme}: {one.rule}: {one.what}" for one in found if not is_known(one)]
    there = {one.rule for one in found if is_known(one)}
    faults += [
        f"{rule} is listed as known, and no page has it any more" for rule in KNOWN if rule not in there
    ]
    for fault in faults:
        print(f"site: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
