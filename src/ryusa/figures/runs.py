"""Pictures of a run folder: each calls the measures it needs, and returns the figure and its numbers."""

import math
from collections.abc import Sequence
from typing import Literal

from matplotlib.figure import Figure

from ryusa import figures, measure
from ryusa.errors import ResultsError
from ryusa.figures.snapshot import Colour
from ryusa.measure._run import settle_time
from ryusa.results import Results
from ryusa.results.label import run_label

Drawn = tuple[Figure, list[dict[str, object]]]
Side = Literal["right", "left"]


def grains(
    results: Results, t: float | None = None, colour: Colour = "speed", lane: int | None = None
) -> Drawn:
    """Grains at time t [s], default the last frame, by speed, by spin or all alike.

    Limits of axes and colours are those of all frames, so that pictures of two moments can be compared.
    """
    seen = measure.snapshot(results, t, lane)
    return figures.snapshot(seen, colour, measure.bounds(results, lane)), seen.rows()


def forces(results: Results, t: float | None = None, lane: int | None = None) -> Drawn:
    """Contact forces over the grains at time t [s], default the last frame."""
    found = measure.contact_network(results, t, lane)
    bounds = measure.bounds(results, lane if results.scene.plane_case else None)
    return figures.forces(found, bounds), found.rows()


def tracks(
    results: Results,
    grains: Sequence[int] | None = None,
    begin: float | None = None,
    end: float = math.inf,
    length: float | None = None,
    exaggeration: float = 1.0,
) -> Drawn:
    """Paths of grains within a window [s], by default after settling.

    Parameters
    ----------
    grains : ids; default the first of lone grains, in a bed or heap the one that goes farthest.
    length : distance along the bed that is shown [m]; default all.
    exaggeration : vertical over horizontal scale.
    """
    since = settle_time(results) if begin is None else begin
    chosen = grains
    if chosen is None:
        chosen = [0 if _lone(results) else measure.farthest(results, since, end)]
    paths = measure.tracks(results, chosen, since, end)
    last = min(end, float(results.frames.t[-1])) if len(results.frames) else 0.0
    _need(len(paths.t) > 1, results, f"two frames from t = {since:g} s to {last:.3g} s")
    around = measure.snapshot(results, float(paths.t[-1]))
    figure = figures.tracks(paths, exaggeration=exaggeration, length=length, around=around)
    return figure, paths.rows()


def spin(results: Results, grains: Sequence[int] | None = None, length: float | None = None) -> Drawn:
    """Spin of grains over the distance travelled, up to `length` [m]."""
    found = measure.spin(results)
    _need(len(found.t) > 1, results, "two frames")
    return figures.spin(found, grains, length), found.series()


def energy(results: Results) -> Drawn:
    """The energy account over time."""
    account = measure.energy(results)
    _need(len(account.t) > 1, results, "two frames")
    return figures.energy(account), account.rows()


def contacts(results: Results) -> Drawn:
    """Contact times with the bed of single grains over a bed, else of all contacts by kind of partner."""
    hopping = measure.saltation(results) if _lone(results) else None
    if hopping is not None and len(hopping.hops):
        return figures.contact_times(hopping), [{"contact_time_s": float(t)} for t in hopping.contact_time]
    found = measure.collisions(results)
    _need(len(found.events) > 0, results, "contacts that ended after the settling time (record.events)")
    return figures.collision_times(found, results.scene), measure.rows_of(found.events)


def hops(results: Results) -> Drawn:
    """Heights and lengths of hops over fixed grains."""
    found = measure.saltation(results)
    _need(len(found.hops) > 0, results, "hops over fixed grains after the settling time")
    drawn = figures.hops({run_label(results): found}, float(results.scene.d[0]))
    return drawn, measure.rows_of(found.hops)


def profile(results: Results, begin: float | None = None, end: float = math.inf) -> Drawn:
    """Concentration and speed of the grains over height within a window [s]."""
    layers = measure.profiles(results, begin, end, bed=True)
    return figures.profiles({run_label(results): layers}), layers.rows()


def transport(results: Results, begin: float | None = None, end: float = math.inf) -> Drawn:
    """Transport rate within a window [s], over time and beside bed-load formulae."""
    found = measure.transport(results, begin, end)
    lines = [figures.Formula(*one) for one in measure.classical(results, found)]
    return figures.transport_of_run(found, lines, run_label(results)), found.rows()


def surface(results: Results, t: float | None = None, side: Side = "right", lane: int | None = None) -> Drawn:
    """A heap at time t [s], default the last frame, with its free surface and the fitted slope."""
    found = measure.surface(results, t, side, lane=lane)
    return figures.surface(measure.snapshot(results, t, lane), found), found.samples()


def sizes(results: Results) -> Drawn:
    """Grading curves asked for and laid."""
    found = measure.sizes(results)
    return figures.sizes(found), found.series()


def vibration(
    results: Results,
    grains: Sequence[int] | None = None,
    begin: float = -math.inf,
    end: float = math.inf,
) -> Drawn:
    """Motion of grains within short time windows; by default of the two that move most."""
    found = measure.vibration(results, begin=begin, end=end)
    return figures.vibration(found, grains or found.most_restless(2)), found.rows()


def _lone(results: Results) -> bool:
    """Whether the case has single grains that do not form a bed."""
    return results.case.get("build", {}).get("kind") in {"saltation", "drop"}


def _need(there: bool, results: Results, what: str) -> None:
    """Refuse a run without the data that a picture needs."""
    if not there:
        raise ResultsError(f"{results.folder}: does not hold {what}")
