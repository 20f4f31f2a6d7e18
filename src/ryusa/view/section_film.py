"""The long section of a row of columns as a film: the same axes in all pictures."""

from collections.abc import Callable

import numpy as np
from PIL import Image

from ryusa.errors import ResultsError
from ryusa.figures import long_section as figures
from ryusa.figures import style
from ryusa.measure.long_section import Bed, long_section
from ryusa.results import Results
from ryusa.view.box import Floats

SECTION = "long_section"  # the word for it, beside those of `camera.VIEWS`


def section_pictures(
    results: Results, times: Floats, size: tuple[int, int], words: Callable[[float], str], bed: Bed
) -> Callable[[int], Image.Image]:
    """What draws picture k of a film of the long section.

    Parameters
    ----------
    times : of the pictures [s], shape (n_picture,); each shows the frame nearest to it.
    size : width and height [pixel].
    words : above a picture, given its time.
    bed : what ends the bed, as of `measure.long_section`.

    Raises
    ------
    CaseError : `bed` is no such word.
    ResultsError : the run has no row of columns.
    """
    if results.row is None:
        raise ResultsError(f"{results.folder}: has no row of columns, whose long section could be shown")
    recorded = np.asarray(results.frames.t, dtype=np.float64)
    nearest = np.abs(recorded[:, None] - times).argmin(axis=0)
    sections = {int(k): long_section(results, float(recorded[k]), bed) for k in np.unique(nearest)}
    among, dpi = tuple(sections.values()), size[0] / style.PAGE

    def draw(k: int) -> Image.Image:
        figure = figures.long_section(
            sections[int(nearest[k])], among, height=size[1] / dpi, words=words(float(times[k]))
        )
        figure.set_dpi(dpi)
        canvas = figure.canvas
        canvas.draw()
        drawn = Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())  # pyright: ignore[reportAttributeAccessIssue]
        return drawn if drawn.size == size else drawn.resize(size)  # inches times dpi may round off a pixel

    return draw
