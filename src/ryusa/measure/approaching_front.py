"""The front that comes against a dam of a row of columns, and what formulae make of its force."""

from dataclasses import dataclass

import numpy as np

from ryusa.laws.bore import reflected_bore
from ryusa.measure._run import Floats, Run
from ryusa.measure.along_row import grains_along_row
from ryusa.measure.long_section import long_section, row_of
from ryusa.model.row import RowDam

NEAR, FAR = 1.0, 2.0  # reach in which the flow is measured: distances from the dam, over its height
LEAST = 4  # segments of that reach
HALF, TENTH = 0.5, 0.1  # shares of the largest force, and of the largest discharge, see `approaching_front`
SLOW = 2.0  # times the travel from the far end of the reach


@dataclass(frozen=True)
class ApproachingFront:
    """A front that came against a dam, and the force of three formulae, by width.

    Attributes
    ----------
    came, struck : when it had come through the reach, and when the force first was half of the largest [s].
    reach : first and last x of the reach [m].
    u : speed of water and grains along x there [m/s].
    h : depth over what rests there [m].
    c : concentration of the discharge [-].
    rho : density of the mixture [kg/m3].
    g : gravity normal to the x axis [m/s2].
    tall : height of the dam over the bottom before it [m].
    """

    came: float
    struck: float
    reach: tuple[float, float]
    u: float
    h: float
    c: float
    rho: float
    g: float
    tall: float

    @property
    def froude(self) -> float:
        """Froude number u/sqrt(g h) [-]."""
        return self.u / float(np.sqrt(self.g * self.h))

    @property
    def behind_bore(self) -> float:
        """Depth behind the bore that the dam reflects, if it is higher than that [m]."""
        return reflected_bore(self.u, self.h, self.g)[0]

    @property
    def forces(self) -> dict[str, float]:
        """Force by width [N/m] at rest, of the reflected bore, and of what is stopped, by formula."""
        return {
            "rho g h^2/2": 0.5 * self.rho * self.g * self.h**2,
            "reflected bore": 0.5 * self.rho * self.g * self.behind_bore**2,
            "rho u^2 h": self.rho * self.u**2 * self.h,
        }


def approaching_front(
    run: Run, dam: RowDam, frames: slice, force: Floats, largest: float
) -> ApproachingFront | str:
    """Find the front to which the largest force on a dam is due.

    Parameters
    ----------
    run : its water is a row of columns with the dam.
    frames : of the run, one after the other.
    force : along x on the dam, means between these frames [N], shape (n_frame - 1,).
    largest : largest mean of it over a time [N].

    Returns
    -------
    The front; where there was none, or frames or segments are too few to see it, why in words.

    Notes
    -----
    The reach lies from one to two heights of the dam before it, and is four segments long at least. A front
    has come through it when the discharge of water and grains at its near end, mean from frame to frame,
    first is half of the largest until it struck. It counts as one if the force was less than a tenth of the
    largest until then, and half of it within twice the time in which the flow comes from the far end of the
    reach: a pond that fills does not. Speed, depth and concentration are means over the reach from one moment
    to the other, so that what the dam throws back is not in them.
    """
    found = row_of(run)
    row, t = found.row, np.asarray(found.t, dtype=np.float64)[frames]
    tall = float(dam.crest - row.bottom[max(dam.first - 1, 0)])
    begin, end = (dam.first - round(far * tall / row.dx) for far in (FAR, NEAR))
    begin = min(begin, end - LEAST)
    if begin < 0:
        return f"the reach before it, {FAR:g} of its heights long, begins above the row"
    if largest <= 0.0:
        return "nothing pushes it downstream"
    reach = slice(begin, end)
    struck = int(np.argmax(force >= HALF * largest))
    through = _discharge(run, frames)[:, end - 1]
    most = float(through[: struck + 1].max())
    came = int(np.argmax(through >= HALF * most))
    if most <= 0.0 or came >= struck or force[came] >= TENTH * largest:
        return "it bore more than a tenth of its largest load before half of the largest discharge had come"
    window = (float(t[came + 1]), float(t[struck]))
    if struck < came + 2:
        return "a front came and struck within two frames (`record.frames`)"
    flow = long_section(run, bed="rest", begin=window[0], end=window[1])
    grains, h = float(flow.solid_discharge[reach].mean()), float(flow.depth[reach].mean())
    both = grains + float(flow.discharge[reach].mean())
    if h <= 0.0 or both <= 0.0:
        return "nothing flows over what rests before it"
    u, c = both / h, grains / both
    if window[1] - window[0] > SLOW * (dam.first - begin) * row.dx / u:
        return "its load grew more slowly than a front that is thrown back, as in a pond that fills"
    rho_w, scene = row.column.rho_w, run.scene
    rho_s = float(scene.m.sum() / scene.solid_volume.sum()) if scene.n_grain else rho_w
    return ApproachingFront(
        *window, (row.x_low + begin * row.dx, row.x_low + end * row.dx), u, h, c,
        rho_w + (rho_s - rho_w) * c, row.g_z, tall,
    )  # fmt: skip


def rose_at_once(force: Floats, largest: float) -> bool:
    """Whether a force rose from a tenth to half of its largest mean over a time within two frames."""
    if largest <= 0.0 or not (force >= HALF * largest).any():
        return False
    struck = int(np.argmax(force >= HALF * largest))
    return bool((force[max(struck - 2, 0) : struck] < TENTH * largest).any())


def _discharge(run: Run, frames: slice) -> Floats:
    """Water and grains that passed the segments from frame to frame, by width [m2/s]."""
    found = row_of(run)
    at = np.arange(len(found.t))[frames]
    passed = np.asarray(found.passed, dtype=np.float64)[frames]
    if run.scene.n_grain:
        passed = passed + grains_along_row(run, found.row, at).passed
    rate = np.diff(passed, axis=0) / np.diff(np.asarray(found.t)[frames])[:, None]
    after = np.roll(rate, -1, axis=1) if found.row.periodic else rate[:, 1:]
    return 0.5 * (after + (rate if found.row.periodic else rate[:, :-1]))
