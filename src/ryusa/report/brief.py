"""The page of `ryusa report --brief`: one sheet of A4 for a client."""

import re
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ryusa.cases.questions import CaseQuestion
from ryusa.catalogue import PICTURES
from ryusa.errors import ResultsError, RyusaError
from ryusa.report.answer import answer
from ryusa.report.contents import Drawing, RunContents, draw_picture, explain_values
from ryusa.report.covered import conditions, not_covered, rests_on
from ryusa.report.question import question_of
from ryusa.results import Results
from ryusa.results.label import run_label
from ryusa.results.presentation import saved
from ryusa.running.resume import changes_of
from ryusa.study.html import template
from ryusa.version import __version__

HERE = Path(__file__).parent
BROWSERS = (
    "chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
)  # fmt: skip
SHEET = 180.0  # width of what is written on the sheet [mm]
LOWER: dict[str, tuple[tuple[dict[str, Any], str], ...]] = {  # for a sheet with less room, and what they show
    "long_section": (
        ({"height": 3.3}, ""),
        ({"height": 2.0, "alone": True}, "bed, water and energy line along a row of columns"),
    ),
}
PATIENCE = 120.0  # longest time for printing [s]


def brief_page(
    runs: Sequence[Results],
    *,
    like: str | None = None,
    begin: float | None = None,
    reach: tuple[float, float] | None = None,
) -> str:
    """Write the sheet about runs of one case.

    Parameters
    ----------
    runs : one, or several that differ in their seed.
    like : packaged case whose question is answered; default the one that the case resembles most.
    begin : of the window of averages [s]; default that of each measure.
    reach : of a row, in which a deposit is measured [m]; default that of the measure.

    Raises
    ------
    ResultsError : no run, runs of different cases or of the same seed, or a run without a case.
    CaseError : no packaged case is called `like`.
    """
    _check(runs)
    question, _ = question_of(runs[0].case, like)
    about = RunContents(
        title=str(runs[0].case.get("title") or runs[0].folder.resolve().name), label="", folder="", status="",
        complete=True, rows=[],
    )  # fmt: skip
    explain_values(about, runs[0])
    return template(HERE / "brief.html").render(
        title=about.title,
        question=question.asked,
        answer=answer(runs, question, begin, reach),
        pictures=_pictures(about, runs[0], question),
        sheet=SHEET,
        of_run=run_label(runs[0]) if len(runs) > 1 else "",
        conditions=conditions(runs, about.values),
        rests_on=rests_on(runs, about.values),
        not_covered=not_covered(runs),
        version=__version__,
    )


def _check(runs: Sequence[Results]) -> None:
    if not runs:
        raise ResultsError("a brief needs a run folder")
    for one in runs:
        if not one.case.get("build"):
            raise ResultsError(f"{one.folder}: was run from a script and holds no case; a brief needs one")
        differ = [change for change in changes_of(runs[0].case, one.case) if not change.startswith("seed ")]
        if differ:
            raise ResultsError(
                f"{one.folder}: differs from {runs[0].folder} in more than its seed ({differ[0]}); a brief "
                "is about runs of one case, `ryusa report` without --brief puts others side by side"
            )
    seeds = [one.provenance.get("seed") for one in runs]
    if len({*seeds}) < len(seeds):
        raise ResultsError(f"seeds {', '.join(map(str, seeds))}: runs of one seed are one run; give others")


def _pictures(about: RunContents, results: Results, question: CaseQuestion) -> list[Drawing]:
    """The first picture of the question that the run allows, and lower ones of the same, by height."""
    entries = {one.name: one for one in PICTURES}
    for name in question.pictures:
        try:
            for how, doc in (({}, ""), *LOWER.get(name, ())):
                entry = entries[name]
                draw_picture(about, results, replace(entry, doc=doc or entry.doc), **how)
        except RyusaError:
            continue
        return about.drawings
    return []


def write_pdf(page: str, path: Path) -> int:
    """Print a page by the Chromium, Chrome or Edge of this machine; returns how many sheets it takes.

    Raises
    ------
    ResultsError : there is no such browser, it fails, or the file cannot be written.
    """
    browser = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    if browser is None:
        raise ResultsError(
            f"{path}: a PDF is printed by Chromium, Google Chrome or Microsoft Edge, and none was found "
            "(apt install chromium); or write an .html and print it from any browser"
        )
    with tempfile.TemporaryDirectory() as folder:
        source, printed = Path(folder) / "page.html", Path(folder) / "page.pdf"
        source.write_text(page, encoding="utf-8")
        command = [
            browser, "--headless", "--no-sandbox",  # root has none, and the page may run nothing
            "--disable-gpu", "--no-pdf-header-footer",
            f"--user-data-dir={folder}/profile", f"--print-to-pdf={printed}", source.as_uri(),
        ]  # fmt: skip
        try:
            made = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
            data = printed.read_bytes()
        except (OSError, subprocess.TimeoutExpired) as error:
            raise ResultsError(f"{path}: {browser} did not print the page ({error})") from None
        if made.returncode:
            raise ResultsError(f"{path}: {browser} did not print the page ({made.stderr.strip()[-200:]})")
    saved(data, path)
    return len(re.findall(rb"/Type\s*/Page\b", data))
