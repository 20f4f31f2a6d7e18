"""The page in a browser, opened from the disk as by a double click."""

import io

import numpy as np
import pytest
from PIL import Image

from ryusa.report.brief import brief_page, write_pdf
from ryusa.report.contents import Drawing
from ryusa.report.page import report_page
from ryusa.study.html import embedded
from ryusa.view.page import view_page

WIDE, HIGH = 1000, 640
BAR = 44  # pixels of the controls beneath the picture


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("pages")


@pytest.fixture
def opened(browser, folder):
    """Opens the page of a run; at the end no message of the browser may be left."""
    said, pages = [], []

    def open_page(results, name, written=view_page):
        path = folder / name
        path.write_text(written(results), encoding="utf-8")
        page = browser.new_page(viewport={"width": WIDE, "height": HIGH})
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.goto(path.as_uri())
        page.wait_for_selector("[data-first-picture]", timeout=30_000)
        pages.append(page)
        return page

    yield open_page
    for page in pages:
        page.close()
    assert said == []


def pixels(page):
    return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(int)


def settled(page):
    """Wait until the page has drawn what was changed."""
    page.evaluate("new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")


def looked_at(page, k):
    """The side view of frame k, grains alone and without perspective, and metres per pixel."""
    page.evaluate(
        """k => { const v = ryusaViewers[0]; v.camera.flat = true; v.fixedShown = v.wallsShown = false;
        v.frame = () => [];
        for (const one of v.holder.children) if (one !== v.canvas) one.style.visibility = 'hidden';
        document.activeElement.blur(); v.look('side'); v.seek(k); }""",
        k,
    )
    settled(page)
    return pixels(page)[: HIGH - BAR], page.evaluate("2 * ryusaViewers[0].camera.half") / (HIGH - BAR)


def discs(seen):
    """Centre x, centre z (upwards) and radius of each patch that is not background, in pixels."""
    from scipy.ndimage import label

    patches, count = label(np.abs(seen - seen[0, 0]).sum(axis=2) > 30)
    found = []
    for k in range(1, count + 1):
        rows, columns = np.nonzero(patches == k)
        found.append((columns.mean(), -rows.mean(), np.sqrt(len(rows) / np.pi)))
    return sorted(found)


@pytest.mark.parametrize("k", [0, 3, 10])
def test_grains_are_where_they_were_and_as_large_as_they_are(opened, three, flight, k):
    seen, metre = looked_at(opened(three, f"three-{k}.html"), k)
    x = flight.x + flight.v * three.frames.t[k]
    x[:, :2] %= flight.period
    order = np.argsort(x[:, 0])
    found = np.array(discs(seen)) * metre
    assert len(found) == 3
    for axis, place in ((0, x[order, 0]), (1, x[order, 2])):
        assert np.diff(found[:, axis]) == pytest.approx(np.diff(place), abs=1.5 * metre)
    assert found[:, 2] == pytest.approx(0.5 * flight.d[order], abs=1.0 * metre)


def test_between_two_frames_a_grain_that_crosses_a_side_leaves_no_streak(opened, three, flight):
    page = opened(three, "side.html")
    crossing = next(
        k for k in range(11) if (flight.x[1, 0] + flight.v[1, 0] * three.frames.t[k + 1]) > flight.period
    )
    for share in (0.1, 0.5, 0.9):
        seen, metre = looked_at(page, crossing + share)
        t = three.frames.t[crossing] + share * (three.frames.t[crossing + 1] - three.frames.t[crossing])
        found = np.array(discs(seen)) * metre
        x = (flight.x[:, 0] + flight.v[:, 0] * t) % flight.period
        assert np.diff(found[:, 0]) == pytest.approx(np.diff(np.sort(x)), abs=1.5 * metre)


def test_colour_follows_the_quantity_and_its_scale_is_shown(opened, three, flight):
    page = opened(three, "colour.html")
    seen = {}
    for word in ("speed", "size", "spin"):
        page.select_option("select[title^=colour]", word)
        one = page.evaluate("ryusaViewers[0].data.colourings[ryusaViewers[0].colouring]")
        assert one["label"] in page.inner_text(".scale")
        assert f"({one['unit']})" in page.inner_text(".scale")
        page.evaluate("document.querySelector('[data-run]').focus()")
        picture, _ = looked_at(page, 5)
        seen[word] = [picture[int(-z), int(x)] for x, z, _ in discs(picture)]
        page.evaluate("for (const one of ryusaViewers[0].holder.children) one.style.visibility = ''")
    # by speed: 0.1, 0.2, 0.1 m/s; by size: 4, 2, 4 mm; none spins
    order = np.argsort((flight.x[:, 0] + flight.v[:, 0] * three.frames.t[5]) % flight.period)
    fast, small = list(order).index(1), list(order).index(1)
    others = [k for k in range(3) if k != fast]
    for word, odd in (("speed", fast), ("size", small)):
        alike = np.abs(seen[word][others[0]] - seen[word][others[1]]).sum()
        apart = np.abs(seen[word][odd] - seen[word][others[0]]).sum()
        assert alike < 12
        assert apart > 100
    assert np.ptp(seen["spin"], axis=1).max() < 12  # grey: the middle of a scale from blue to red


def test_a_scale_of_numbers_of_contacts_is_marked_at_whole_numbers(opened, three):
    page = opened(three, "contacts.html")
    page.evaluate("ryusaViewers[0].colourBy('contacts')")
    assert page.locator(".scale span").all_inner_texts() == ["0", "1"]


def test_a_plane_is_seen_from_its_side(opened, three):
    page = opened(three, "plane.html")
    without, _ = looked_at(page, 0)
    page.evaluate("ryusaViewers[0].wallsShown = true; ryusaViewers[0].changed()")
    settled(page)
    line = np.abs(pixels(page)[: HIGH - BAR] - without).sum(axis=2) > 60
    assert line.sum(axis=1).max() > 0.5 * WIDE  # the floor, along the whole period
    assert np.count_nonzero(line.any(axis=1)) < 10


def test_a_lid_that_is_dragged_on_is_seen_over_the_whole_period(opened, dragged, flight):
    page = opened(dragged, "lid.html")
    without, metre = looked_at(page, 10)
    page.evaluate("ryusaViewers[0].wallsShown = true; ryusaViewers[0].changed()")
    settled(page)
    lid = np.abs(pixels(page)[: HIGH - BAR] - without)[: HIGH // 2].sum(axis=2) > 60  # not the floor
    assert lid.sum(axis=1).max() == pytest.approx(flight.period / metre, abs=3.0)
    assert lid.any(axis=0).sum() == pytest.approx(flight.period / metre, abs=3.0)  # nothing beside the period


def test_slider_keys_and_play_move_the_time(opened, three):
    page = opened(three, "time.html")
    time = "ryusaViewers[0].time"
    page.locator("input[type=range]").fill("4")
    assert page.evaluate(time) == pytest.approx(three.frames.t[4])
    page.keyboard.press("ArrowRight")
    assert page.evaluate(time) == pytest.approx(three.frames.t[5])
    page.locator("[data-run]").focus()
    page.keyboard.press("Home")
    assert page.evaluate(time) == pytest.approx(three.frames.t[0])
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Space")
    for _ in range(200):  # the page allows no script made of text, which wait_for_function would need
        page.wait_for_timeout(50)
        if page.evaluate(time) > 0.01:
            break
    assert page.evaluate(time) > 0.01
    page.keyboard.press("Space")
    assert not page.evaluate("ryusaViewers[0].playing")
    assert f"{page.evaluate(time):.3f}"[:4] in page.inner_text(".clock")


def test_a_chosen_grain_is_named_and_followed(opened, three, flight):
    page = opened(three, "chosen.html")
    page.evaluate("ryusaViewers[0].look('side')")
    x, y = page.evaluate("ryusaViewers[0].camera.project(ryusaViewers[0].placeOf(2), ryusaViewers[0].aspect)")
    page.mouse.click((x + 1) / 2 * WIDE, (1 - y) / 2 * (HIGH - BAR))
    assert page.evaluate("ryusaViewers[0].picked") == 2
    settled(page)
    assert page.inner_text(".chosen").startswith("grain 2: d 4.00 mm")
    page.keyboard.press("f")
    page.keyboard.press("End")
    settled(page)
    middle = page.evaluate("ryusaViewers[0].camera.target")
    assert middle == pytest.approx(list((flight.x + flight.v * three.frames.t[-1])[2]), abs=1e-4)
    page.keyboard.press("Escape")
    assert page.evaluate("ryusaViewers[0].picked") == -1


def test_a_page_without_webgl2_says_what_is_missing(browser, folder, three):
    path = folder / "without.html"
    path.write_text(view_page(three), encoding="utf-8")
    page = browser.new_page()
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(path.as_uri())
    assert "WebGL2" in page.inner_text(".fault")
    page.close()


def test_a_title_made_of_script_is_shown_and_not_run(opened, three, monkeypatch):
    monkeypatch.setitem(three.case, "title", "</script><img src=x onerror='document.title=1'><b>bold")
    page = opened(three, "script.html")
    assert page.inner_text(".head .title").endswith("<b>bold")
    assert page.evaluate("document.title").startswith("</script>")


@pytest.mark.parametrize("written", [view_page, lambda run: report_page([run], size=1.0e6)])
def test_a_very_long_title_is_cut_and_covers_no_grain(opened, three, monkeypatch, written):
    monkeypatch.setitem(three.case, "title", "W" * 2000)
    page = opened(three, "long.html", written)
    assert page.evaluate("document.documentElement.scrollWidth") <= WIDE
    for words, most in ((".head", 90), ("h1", 200)):
        for box in (one.bounding_box() for one in page.locator(words).all()):
            assert box["height"] < most
            assert box["x"] + box["width"] < WIDE


@pytest.mark.parametrize("high", [240, 600])
@pytest.mark.parametrize("key", ["1", "2", "3"])
def test_the_whole_box_lies_below_the_title(opened, three, high, key):
    page = opened(three, "low.html")
    page.set_viewport_size({"width": WIDE, "height": high})
    page.keyboard.press(key)
    page.evaluate(
        """() => {
          window.one = ryusaViewers[0];
          const corner = (c) => [0, 1, 2].map((k) => (c >> k & 1 ? one.high : one.low)[k]);
          const all = [...Array(8).keys()].map((c) => one.camera.project(corner(c), one.aspect)[1]);
          window.down = all.map((y) => (1 - y) / 2 * one.canvas.clientHeight);
        }"""
    )
    top, bottom = page.evaluate("[Math.min(...down), Math.max(...down) - one.canvas.clientHeight]")
    title = page.evaluate("one.head.offsetTop + one.head.offsetHeight")
    assert top > title
    assert bottom < 0.0


def test_water_over_height_is_drawn(opened, saltation):
    page = opened(saltation, "water.html")
    assert page.is_visible(".profile")
    drawn = page.evaluate(
        """(() => { const c = document.querySelector('.profile'); let n = 0;
        const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
        for (let i = 0; i < d.length; i += 4) if (d[i + 2] > d[i] + 80 && d[i + 3] > 200) n++;
        return n; })()"""
    )
    assert drawn > 100  # blue pixels of the curve


def until(page, condition):
    """Wait for a condition; wait_for_function would evaluate it in the page, whose policy forbids that."""
    for _ in range(100):
        page.wait_for_timeout(200)
        if page.evaluate(condition):
            return
    raise AssertionError(condition)


def test_a_report_of_two_runs_plays_both(opened, report):
    page = opened(report, "report.html", str)
    assert page.locator(".grains").count() == 2
    for k in range(2):
        page.locator(".bar button[title^=play]").nth(k).click()
        until(page, f"ryusaViewers[{k}].time > ryusaViewers[{k}].data.t[0]")
    assert page.locator("figure img").count() >= 4
    broken = "[...document.querySelectorAll('figure img')].filter((one) => !one.naturalWidth).length"
    assert page.evaluate(broken) == 0


def test_a_brief_prints_on_one_sheet_however_much_it_has_to_say(
    browser, saltation, brief, folder, monkeypatch
):
    for loaded in (False, True):
        if loaded:
            monkeypatch.setitem(saltation.case, "title", "A title of many words " * 12)
            warnings = [f"{'this warning is long ' * 20} {'abcdefgh'[k]}" for k in range(8)]
            monkeypatch.setitem(saltation.summary, "warnings", warnings)
        text = brief_page([saltation]) if loaded else brief
        (folder / "brief.html").write_text(text, encoding="utf-8")
        assert write_pdf(text, folder / "brief.pdf") == 1
        page = browser.new_page()
        page.emulate_media(media="print")
        page.goto((folder / "brief.html").as_uri())
        fits = (
            "(() => { const m = document.querySelector('main'); return m.scrollHeight <= m.clientHeight; })()"
        )
        assert page.evaluate(fits)
        assert page.evaluate("document.querySelector('figure img').naturalWidth") > 0
        page.close()


def test_a_picture_on_a_brief_takes_its_width_and_of_several_heights_the_one_for_which_there_is_room(
    browser, saltation, folder, monkeypatch
):
    def drawings(*given):
        found = []
        for height in (480, 330, 200):
            held = io.BytesIO()
            Image.new("RGB", (710, height)).save(held, format="png")
            held.seek(0)
            found.append(Drawing("long_section", f"{height}", embedded(held), True, height / 710))
        return found

    monkeypatch.setattr("ryusa.report.brief._pictures", drawings)
    widths = (
        "[...document.querySelectorAll('figure img')]"
        ".map(one => one.getBoundingClientRect().width / document.querySelector('h2').clientWidth)"
    )
    for lines, shown in ((4, 0), (12, 1), (22, 2)):
        said = [("Grains", "of some kind")] * lines
        monkeypatch.setattr("ryusa.report.brief.conditions", lambda *given, said=said: said)
        (folder / "brief.html").write_text(brief_page([saltation]), encoding="utf-8")
        page = browser.new_page()
        page.goto((folder / "brief.html").as_uri())
        assert page.evaluate(widths) == pytest.approx([float(k == shown) for k in range(3)], abs=0.01)
        page.close()
