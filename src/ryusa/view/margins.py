"""What stands above and below the grains in a film: title, time, directions, length and colour scales."""

import math
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont
from matplotlib.ticker import MaxNLocator
from PIL import Image, ImageDraw, ImageFont

from ryusa.view.box import Floats
from ryusa.view.camera import Camera
from ryusa.view.colouring import Colouring
from ryusa.view.raster import BACKGROUND, Bytes

INK = "#20262c"
PAPER = "#" + bytes(BACKGROUND).hex()
ARROWS = (("x", "#b5442d"), ("y", "#3a7d44"), ("z", "#2f5f98"))  # as in the page
_USUAL = (1280, 720)  # pixels at which the sizes below hold
_LEAST = 0.6  # smallest factor on them: letters stay legible
_HEAD, _FOOT = 46, 92  # heights of the margins
_SIDE, _WORDS, _TITLE = 16, 17, 19  # distance from the sides, heights of letters
_UNITS = ((1.0, 1.0, "m"), (1.0e-2, 100.0, "cm"), (0.0, 1000.0, "mm"))  # from which length on, in a metre


@dataclass(frozen=True)
class Margins:
    """The parts of a picture that never change, and where the rest goes.

    Attributes
    ----------
    still : all of the picture that does not change.
    head : height above the grains [pixel].
    inner : width and height of the picture of the grains [pixel].
    words : letters of the line of time.
    """

    still: Image.Image
    head: int
    inner: tuple[int, int]
    words: ImageFont.FreeTypeFont

    def around(self, grains: Bytes, text: str) -> Image.Image:
        """A picture of the film: the grains and, at the right above them, a line of text."""
        whole = self.still.copy()
        whole.paste(Image.fromarray(grains), (0, self.head))
        ImageDraw.Draw(whole).text(
            (whole.width - self.head * _SIDE / _HEAD, 0.5 * self.head), text, INK, self.words, anchor="rm"
        )
        return whole


def inner_size(size: tuple[int, int]) -> tuple[int, int]:
    """Width and height left for the grains in a picture of a size [pixel]."""
    factor = _factor(size)
    return size[0], size[1] - round(_HEAD * factor) - round(_FOOT * factor)


def margins(
    size: tuple[int, int], title: str, longest: str, camera: Camera, gravity: Floats,
    colouring: Colouring, low: float, high: float, beyond: tuple[bool, bool],
) -> Margins:  # fmt: skip
    """Draw what never changes.

    Parameters
    ----------
    size : of the picture, width and height [pixel].
    longest : line of time, the longest that occurs; the title ends before it.
    gravity : [m/s2], shape (3,).
    low, high : ends of the colour scale in SI.
    beyond : whether values below and above the scale occur.
    """
    factor = _factor(size)
    head, side = round(_HEAD * factor), _SIDE * round(_HEAD * factor) / _HEAD
    inner = inner_size(size)
    still = Image.new("RGB", size, BACKGROUND)
    words, bold = _font("normal", _WORDS * factor), _font("bold", _TITLE * factor)
    room = size[0] - 3.0 * side - words.getlength(longest)
    ImageDraw.Draw(still).text((side, 0.5 * head), shortened(title, bold, room), INK, bold, anchor="lm")
    foot = _foot(size, factor, camera, inner, gravity, (colouring, low, high, beyond))
    still.paste(foot, (0, head + inner[1]))
    return Margins(still, head, inner, words)


def shortened(text: str, font: ImageFont.FreeTypeFont, room: float) -> str:
    """The first line of a text, cut so that it fits a width [pixel]."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    if font.getlength(line) <= room:
        return line
    while line and font.getlength(line + "…") > room:
        line = line[:-1]
    return line.rstrip() + "…"


def round_length(most: float) -> tuple[float, str]:
    """The largest 1, 2 or 5 times a power of ten that is at most a length [m], and how it is written.

    >>> round_length(0.034), round_length(0.0071), round_length(3.0)
    ((0.02, '2 cm'), (0.005, '5 mm'), (2.0, '2 m'))
    """
    power = 10.0 ** math.floor(math.log10(most) + 1e-9)
    length = next(k * power for k in (5.0, 2.0, 1.0) if k * power <= most * (1.0 + 1e-9))
    scale, unit = next((scale, unit) for least, scale, unit in _UNITS if length >= least * (1.0 - 1e-9))
    return length, f"{length * scale:g} {unit}"


def _factor(size: tuple[int, int]) -> float:
    return max(_LEAST, min(size[0] / _USUAL[0], size[1] / _USUAL[1]))


def _font(weight: str, pixels: float) -> ImageFont.FreeTypeFont:
    path = findfont(FontProperties(family="DejaVu Sans", weight=weight))
    return ImageFont.truetype(path, pixels, layout_engine=ImageFont.Layout.BASIC)


def _foot(
    size: tuple[int, int], factor: float, camera: Camera, inner: tuple[int, int], gravity: Floats,
    scale: tuple[Colouring, float, float, tuple[bool, bool]],
) -> Image.Image:  # fmt: skip
    """The lower margin: directions and length scale at the left, colour scale at the right."""
    wide, high = size[0], round(_FOOT * factor)
    figure = Figure(figsize=(wide / 100, high / 100), dpi=100, facecolor=PAPER)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0.0, wide)
    axes.set_ylim(0.0, high)
    letters = 0.72 * _WORDS * factor  # [point]; DejaVu's letters are 72 points an inch, pixels 100
    middle = np.array([_SIDE * factor + 0.5 * high, 0.5 * high])
    down = gravity / (np.linalg.norm(gravity) or 1.0)
    for (name, colour), way in zip((*ARROWS, ("g", INK)), (*np.eye(3), 0.8 * down), strict=True):
        seen = 0.34 * high * (camera.axes @ way)[:2]
        if np.linalg.norm(seen) < (0.17 if name == "g" else 0.04) * high:
            continue  # towards the eye, or nearly
        axes.annotate(
            "", (*(middle + seen),), (*middle,), arrowprops={
                "arrowstyle": "-|>", "color": colour, "lw": 1.4 * factor,
                "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 9.0 * factor,
            },
        )  # fmt: skip
        beside = middle + seen * (1.0 + 9.0 * factor / np.linalg.norm(seen))
        axes.text(beside[0], beside[1], name, color=colour, size=0.9 * letters, ha="center", va="center")
    metre = 0.5 * inner[1] / camera.half  # pixels
    length, text = round_length(0.2 * wide / metre)
    left, level = 1.6 * high, 0.38 * high
    axes.plot(
        [left, left + length * metre], [level, level], color=INK, lw=3.0 * factor, solid_capstyle="butt"
    )
    axes.text(left + 0.5 * length * metre, 0.62 * high, text, color=INK, size=letters, ha="center")
    _colour_scale(figure, factor, letters, *scale)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy())


def _colour_scale(
    figure: Figure, factor: float, letters: float,
    one: Colouring, low: float, high: float, beyond: tuple[bool, bool],
) -> None:  # fmt: skip
    wide = 100.0 * figure.get_figwidth()
    bar = figure.add_axes((1.0 - (460 * factor + 2 * _SIDE * factor) / wide, 0.42, 460 * factor / wide, 0.17))
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
    shown = figure.colorbar(
        ScalarMappable(Normalize(low * one.scale, high * one.scale), mpl.colormaps[one.colours]),
        cax=bar, orientation="horizontal", extend=extend[beyond],
        ticks=MaxNLocator(5, steps=[1, 2, 5, 10], integer=not one.unit),  # what has no unit is counted
    )  # fmt: skip
    shown.outline.set_linewidth(0.6 * factor)  # pyright: ignore[reportCallIssue]
    bar.tick_params(
        labelsize=0.9 * letters, labelcolor=INK, width=0.8 * factor, length=4.0 * factor, pad=3.0 * factor
    )
    bar.set_title(
        f"{one.label}  ({one.unit})" if one.unit else one.label, color=INK, size=letters,
        pad=7.0 * factor,
    )  # fmt: skip
