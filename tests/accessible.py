"""Pages in a Chromium, and what axe-core finds wrong on them: WCAG 2.1 (A, AA) and good practice."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
MISSING = "no Chromium on this machine (apt install chromium)"
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"]
OF_COLOURS = ["color-contrast", "link-in-text-block"]  # the others do not depend on the scheme
SCHEMES = {"light": {"runOnly": RULES}, "dark": {"runOnly": {"type": "rule", "values": OF_COLOURS}}}


def chromium_path() -> str | None:
    """The Chromium or Chrome of this machine."""
    return next((found for name in BROWSERS if (found := shutil.which(name))), None)


@contextmanager
def chromium() -> Iterator[Any]:
    """Start the browser, drawn by the processor, so that no graphics card is needed."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        started = play.chromium.launch(
            executable_path=chromium_path(),
            args=[
                "--no-sandbox",  # root has none
                "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
            ],
        )  # fmt: skip
        yield started
        started.close()


class Fault(NamedTuple):
    """An element that breaks a rule of axe-core: its page, scheme, rule, CSS selector, and what is wrong."""

    page: str
    scheme: str
    rule: str
    place: str
    what: str


def faults_of_page(browser: Any, path: Path, wide: int = 1200) -> list[Fault]:
    """What axe-core finds on a page in a window `wide` pixels wide, in light and in dark."""
    from axe_playwright_python.sync_playwright import Axe

    found: list[Fault] = []
    page = browser.new_page(viewport={"width": wide, "height": 800})
    page.goto(path.as_uri())
    if page.locator("[data-run]").count():
        page.wait_for_selector("[data-first-picture]", timeout=30_000)
    for scheme, rules in SCHEMES.items():
        page.emulate_media(color_scheme=scheme)
        said = Axe().run(page, options={**rules, "resultTypes": ["violations"]}).response
        found += [
            Fault(
                path.name, scheme, one["id"], node["target"][-1], f"{node['html']} {node['failureSummary']}"
            )
            for one in said["violations"]
            for node in one["nodes"]
        ]
    page.close()
    return found
