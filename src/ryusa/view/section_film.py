"""The long section of a row of columns, or its flow field, as a film: the same axes in all pictures."""

from collections.abc import Callable
from functools import partial

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from ryusa.errors import ResultsError
from ryusa.figures import flow_field as fields
from ryusa.figures import long_section as sections
from ryusa.figures import style
from ryusa.measure.flow_field import flow_field
from ryusa.measure.long_section import Bed, long_section
from ryusa.results import Results
from ryusa.view.box import Floats

SECTION, FIELD = "long_section", "flow_field"  # the words for them, beside those of `camera.VIEWS`


def section_pictures(
    results: Results, view: str, times: Floats, size: tuple[int, int], words: Callable[[float], str], bed: Bed
) -> Callable[[int], Image.Image]:
    """What draws picture k of a film of the long section or the flow field.

    Parameters
    ----------
    view : SECTION or FIELD.
    times : of the pictures [s], shape (n_picture,); each shows the frame nearest to it.
    size : width and height [pixel].
    words : above a picture, given its time.
    bed : what ends the bed of a long section, as of `measure.long_section`.

    Raises
    ------
    CaseError : `bed` is no such word.
    ResultsError : the run has no row of columns.
    """
    if results.row is None:
        raise ResultsError(f"{results.folder}: has no row of columns, whose {view} could be shown")
    recorded = np.asarray(results.frames.t, dtype=np.float64)
    nearest = np.abs(recorded[:, None] - times).argmin(axis=0)
    dpi, shown = size[0] / style.PAGE, [int(k) for k in np.unique(nearest)]
    pictures: dict[int, Callable[..., Figure]]
    if view == FIELD:
        moments = {k: flow_field(results, float(recorded[k])) for k in shown}
        scales = fields.scales_of(tuple(moments.values()))
        pictures = {k: partial(fields.flow_field, one, scales) for k, one in moments.items()}
    else:
        every = {k: long_section(results, float(recorded[k]), bed) for k in shown}
        among = tuple(every.values())
        pictures = {k: partial(sections.long_section, one, among) for k, one in every.items()}

    def draw(k: int) -> Image.Image:
        figure = pictures[int(nearest[k])](height=size[1] / dpi, words=words(float(times[k])))
        figure.set_dpi(dpi)
        canvas = figure.canvas
        canvas.draw()
        drawn = Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())  # pyright: ignore[reportAttributeAccessIssue]
        return drawn if drawn.size == size else drawn.resize(size)  # inches times dpi may round off a pixel

    return draw
