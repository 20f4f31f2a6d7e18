"""Names in any language: a sign without a font is said once, in plain words."""

import warnings

import matplotlib as mpl
import pytest
from matplotlib import font_manager

from ryusa.figures import fonts, style

NOWHERE = "\U00013001\U00013002"  # Egyptian hieroglyphs, which none of the fonts has


@style.house
def picture(name):
    figure, (axes,) = style.new()
    axes.set_title(name)
    return figure


@pytest.fixture(autouse=True)
def nothing_noted():
    fonts.signs_without_font()


def test_signs_without_a_font_are_said_once_and_no_warning_is_shown(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in ("a.png", "b.png"):
            style.save(picture(f"dam {NOWHERE}"), tmp_path / name)
        picture(NOWHERE)._repr_png_()
    said = fonts.signs_without_font()
    assert NOWHERE in said
    assert "install one that has" in said
    assert fonts.signs_without_font() == ""


def test_other_warnings_are_passed_on():
    with pytest.warns(UserWarning, match="mine"), fonts.signs_watched():
        warnings.warn("mine", UserWarning, stacklevel=1)


def test_fonts_of_the_machine_come_after_our_own(monkeypatch):
    class Font:
        def __init__(self, name):
            self.name = name

    there = [Font("IPAexGothic"), Font("Comic"), Font("DejaVu Sans")]
    monkeypatch.setattr(font_manager.fontManager, "ttflist", there)
    fonts.families.cache_clear()
    try:
        assert fonts.families() == ["DejaVu Sans", "IPAexGothic"]
        with style.applied():
            assert mpl.rcParams["font.sans-serif"] == ["DejaVu Sans", "IPAexGothic"]
    finally:
        fonts.families.cache_clear()
