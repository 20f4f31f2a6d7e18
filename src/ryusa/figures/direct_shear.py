"""Direct shear test: friction and rise of the lid over displacement."""

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures import style
from ryusa.measure.direct_shear import LAST, DirectShear

MM = 1000.0  # millimetres in a metre


@style.house
def direct_shear(found: DirectShear) -> Figure:
    """Draw friction with its peak and residual value, and the rise of the lid, over the displacement."""
    figure, (upper, lower) = style.new(2, 1, width=4.8, height=3.8, sharex=True)
    x = found.displacement * MM
    upper.plot(x, found.shear / found.normal, color=style.COLOURS[0], lw=0.7)
    late = np.array([(1.0 - LAST) * x[-1], x[-1]])
    mu = found["mu"]
    upper.plot(
        late, [mu.value] * 2, color="black", lw=0.9, label=f"residual {mu.value:.3f} ± {mu.error_text}"
    )
    upper.plot(
        [found.peak_at * MM],
        [found.peak],
        "o",
        ms=4.0,
        color=style.COLOURS[1],
        label=f"peak {found.peak:.3f}",
    )
    upper.set_ylim(bottom=0.0)
    upper.set_ylabel(r"friction  $\mu$  (–)")
    upper.legend(fontsize=6.0, loc="lower right")
    lower.plot(x, found.rise * MM, color=style.COLOURS[2])
    lower.axhline(0.0, color=style.FAINT, lw=0.8)
    lower.margins(x=0.0)
    lower.set_ylabel("rise of the lid  (mm)")
    lower.set_xlabel("displacement  (mm)")
    return figure
