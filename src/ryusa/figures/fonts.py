"""Letters of all languages in pictures: names of dams, walls and groups stand as the case has them."""

import re
import warnings
from collections.abc import Generator
from contextlib import contextmanager
from functools import cache

from matplotlib import font_manager

OWN = "DejaVu Sans"  # comes with matplotlib
# Of systems and of packages that distributions install; those that are there are asked after our own.
_MORE = (
    "Noto Sans CJK JP", "Noto Sans JP", "IPAexGothic", "IPAGothic", "TakaoGothic", "VL Gothic", "Yu Gothic",
    "Meiryo", "MS Gothic", "Hiragino Sans", "Hiragino Kaku Gothic ProN", "Source Han Sans",
    "Noto Sans CJK SC", "WenQuanYi Zen Hei", "WenQuanYi Micro Hei", "Droid Sans Fallback", "Microsoft YaHei",
    "PingFang SC", "Noto Sans CJK KR", "Malgun Gothic", "Apple SD Gothic Neo", "Noto Sans",
)  # fmt: skip
_MISSING = re.compile(r"Glyph (\d+) .* missing from ")

_signs: dict[str, None] = {}  # without a font, in the order in which they were met


@cache
def families() -> list[str]:
    """Fonts of this machine, in the order in which a sign is looked for."""
    there = {one.name for one in font_manager.fontManager.ttflist}
    return [OWN, *(one for one in _MORE if one in there)]


@contextmanager
def signs_watched() -> Generator[None]:
    """Note signs without a font while a picture is drawn, in place of a warning of matplotlib for each."""
    with warnings.catch_warnings(record=True) as met:
        warnings.simplefilter("always")
        yield
    for one in met:
        if found := _MISSING.match(str(one.message)):
            _signs[chr(int(found[1]))] = None
        else:
            warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)


def signs_without_font() -> str:
    """One sentence on signs that pictures lack since this was asked last; empty where they lack none."""
    signs = "".join(_signs)
    _signs.clear()
    if not signs:
        return ""
    return (
        f"no font of this machine has {signs}: pictures show boxes in their place; install one that has, "
        "such as Noto Sans CJK"
    )
