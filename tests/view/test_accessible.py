"""Pages for those who use keys alone, have them read aloud, see little, or want nothing to move by itself."""

import re

import pytest
from tests.accessible import faults_of_page

from ryusa.campaigns.sweep import sweep
from ryusa.cases import case_path
from ryusa.view.page import view_page

CONTROLS = [
    "play", "frame", "speed of the film", "colour of the grains", "oblique", "side", "top", "keys and mouse",
]  # fmt: skip
FOCUSED = "(document.activeElement.ariaLabel || document.activeElement.textContent)"
LEAST = 4.5  # contrast of text, WCAG 2.1, 1.4.3


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("accessible")


@pytest.fixture
def viewer(browser, folder, saltation):
    """The page of a run, opened by somebody who asked for less motion."""
    path = folder / "view.html"
    path.write_text(view_page(saltation), encoding="utf-8")
    page = browser.new_page(viewport={"width": 1000, "height": 640}, reduced_motion="reduce")
    page.goto(path.as_uri())
    page.wait_for_selector("[data-first-picture]", timeout=30_000)
    yield page
    page.close()


def now(page, what):
    """What the viewer of a page has under a name."""
    return page.evaluate(f"ryusaViewers[0].{what}")


def ring(page, element, pseudo=""):
    """Width of the outline of an element [pixels], and its colour."""
    style, width, colour = page.evaluate(
        f"(({{ outlineStyle, outlineWidth, outlineColor }}) => [outlineStyle, outlineWidth, outlineColor])"
        f"(getComputedStyle({element}, '{pseudo}'))"
    )
    return (0.0 if style == "none" else float(width.removesuffix("px"))), channels(colour)


def channels(colour):
    """Red, green, blue and opacity of a colour as a browser writes it, 0 to 1."""
    numbers = [float(one) for one in re.findall(r"[\d.]+", colour)]
    return [one / 255.0 for one in numbers[:3]] + (numbers[3:] or [1.0])


def contrast(ink, paper):
    """Ratio of the luminances of two colours (WCAG 2.1)."""

    def luminance(colour):
        linear = [one / 12.92 if one <= 0.04045 else ((one + 0.055) / 1.055) ** 2.4 for one in colour[:3]]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(ink), luminance(paper)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("name", ["report", "brief"])
def test_axe_finds_no_fault_on_a_page_about_runs(faults_of, folder, request, name):
    path = folder / f"{name}.html"
    path.write_text(request.getfixturevalue(name), encoding="utf-8")
    assert faults_of(path) == []


def test_axe_finds_no_fault_on_the_page_of_the_viewer(faults_of, folder, saltation):
    path = folder / "view.html"
    path.write_text(view_page(saltation), encoding="utf-8")
    assert faults_of(path) == []


def test_axe_finds_no_fault_on_the_page_of_a_sweep_in_a_narrow_window(browser, folder):
    short = {"build.starts": "3", "stop.time": "0.1 s", "record.frames": "4 ms", "record.settle": "0 s"}
    over = {"contact.friction_angle": ["20 deg", "30 deg"]}
    case = case_path("saltation.toml")
    sweep(
        case,
        over,
        "spin",
        seeds=1,
        overrides=short,
        folder=folder / "sweep",
        jobs=1,
        pages=False,
        progress=False,
    )
    assert faults_of_page(browser, folder / "sweep" / "sweep.html", wide=400) == []


def test_axe_finds_what_is_wrong(faults_of, folder):
    path = folder / "wrong.html"
    path.write_text(
        "<html lang=en><title>x</title><main><h1 style='color: #999'>Grains<img src=a></h1></main></html>"
    )
    assert [(one.page, one.scheme, one.rule) for one in faults_of(path)] == [
        ("wrong.html", "light", "color-contrast"),
        ("wrong.html", "light", "image-alt"),
        ("wrong.html", "dark", "color-contrast"),
    ]


def test_nothing_moves_before_it_is_asked_to_and_the_space_bar_stops_it(viewer):
    begun = now(viewer, "time")
    viewer.wait_for_timeout(300)
    assert (now(viewer, "time"), now(viewer, "playing")) == (begun, False)
    assert viewer.evaluate("document.getAnimations().length") == 0
    viewer.keyboard.press("Space")
    assert (now(viewer, "playing"), now(viewer, "play.ariaLabel"), now(viewer, "chosen.ariaLive")) == (
        True,
        "pause",
        "off",
    )
    viewer.keyboard.press("Space")
    assert (now(viewer, "playing"), now(viewer, "play.ariaLabel"), now(viewer, "chosen.ariaLive")) == (
        False,
        "play",
        "polite",
    )


def test_every_control_is_reached_by_keys_and_shows_that_it_has_them(viewer):
    white, paper = [1.0, 1.0, 1.0], channels("rgb(246, 247, 249)")
    width, colour = ring(viewer, "ryusaViewers[0].holder", "::after")
    assert width >= 2.0
    assert contrast(colour, paper) >= 3.0  # WCAG 2.1, 1.4.11
    for name in CONTROLS:
        viewer.keyboard.press("Tab")
        assert viewer.evaluate(FOCUSED) == name
        width, colour = ring(viewer, "document.activeElement")
        assert width >= 2.0
        assert contrast(colour, white) >= 3.0


def test_a_button_is_pressed_by_the_space_bar_and_plays_nothing(viewer):
    viewer.keyboard.press("1")
    viewer.get_by_role("button", name="side", exact=True).focus()
    viewer.keyboard.press("Space")
    assert now(viewer, "camera.elevation") == 0.0
    viewer.get_by_role("button", name="keys and mouse").focus()
    viewer.keyboard.press("Space")
    assert (now(viewer, "playing"), now(viewer, "help.hidden"), now(viewer, "asked.ariaExpanded")) == (
        False,
        False,
        "true",
    )
    viewer.keyboard.press("Escape")
    assert (now(viewer, "help.hidden"), now(viewer, "asked.ariaExpanded")) == (True, "false")
    viewer.keyboard.press("h")
    viewer.evaluate("ryusaViewers[0].help.focus()")
    viewer.keyboard.press("Escape")
    viewer.keyboard.press("Space")
    assert now(viewer, "playing")


def test_keys_turn_shift_and_choose_as_the_mouse_does(viewer):
    turned = [now(viewer, "camera.azimuth"), now(viewer, "camera.elevation")]
    viewer.keyboard.press("Shift+ArrowRight")
    viewer.keyboard.press("Shift+ArrowDown")
    assert now(viewer, "camera.azimuth") < turned[0]  # as when the mouse drags to the right and down
    assert now(viewer, "camera.elevation") > turned[1]
    viewer.keyboard.press("2")
    x, _, z = now(viewer, "camera.target")
    viewer.keyboard.press("l")
    viewer.keyboard.press("i")
    assert now(viewer, "camera.target[0]") > x
    assert now(viewer, "camera.target[2]") > z
    viewer.keyboard.press("j")
    viewer.keyboard.press("k")
    assert now(viewer, "camera.target") == pytest.approx([x, now(viewer, "camera.target[1]"), z])
    for key, grain in (("g", 0), ("g", 1), ("Shift+G", 0), ("Shift+G", 2), ("g", 0)):
        viewer.keyboard.press(key)
        assert now(viewer, "picked") == grain
    viewer.locator("[role=status]").filter(has_text=re.compile("^grain 0: d 2.00 mm")).wait_for()


def test_pictures_and_the_time_have_words(viewer):
    names = viewer.get_by_role("img").evaluate_all("all => all.map(one => one.ariaLabel)")
    assert [name.split(":")[0] for name in names] == [
        "picture of the grains, coloured by speed", "velocity of the water over height",
        "directions of x, y, z and of gravity, g",
    ]  # fmt: skip
    assert "3 grains" in names[0]
    viewer.keyboard.press("End")
    viewer.wait_for_timeout(100)
    assert now(viewer, "slider.ariaValueText") == viewer.inner_text(".clock")
    assert now(viewer, "clock.ariaLive") == "off"  # of a film, every picture would be read aloud


def test_words_over_the_grains_are_legible_whatever_the_grains_are_like(viewer):
    viewer.keyboard.press("g")
    for words in (".title", ".about", ".chosen", ".scale .label", ".scale span"):
        ink = viewer.locator(words).first.evaluate("one => getComputedStyle(one).color")
        paper = viewer.locator(words).first.evaluate(
            "one => getComputedStyle(one.closest('.head, .scale')).backgroundColor"
        )
        *paper, opacity = channels(paper)
        assert contrast(channels(ink), [opacity * one for one in paper]) >= LEAST  # a black grain beneath


def test_a_report_leaves_the_keys_to_the_page_until_its_viewer_is_reached(browser, folder, report):
    path = folder / "report.html"
    path.write_text(report, encoding="utf-8")
    page = browser.new_page()
    page.goto(path.as_uri())
    page.wait_for_selector("[data-first-picture]", timeout=30_000)
    page.keyboard.press("Space")
    assert not now(page, "playing")
    for _ in range(3):  # past what differs between the runs, and their averages
        page.keyboard.press("Tab")
    assert page.evaluate(FOCUSED).endswith("grains in motion; h lists the keys")
    page.keyboard.press("Space")
    assert now(page, "playing")
    page.close()
