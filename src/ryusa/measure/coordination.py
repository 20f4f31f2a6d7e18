"""Coordination number: contacts per grain, over time and over height, with and without rattlers."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.measure._run import Floats, Run
from ryusa.measure.layers import Layers, layers_quotient
from ryusa.measure.slices_in_layers import frames_of_grains
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import average, ratio
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.results.touching import contacts_per_grain


@dataclass(frozen=True, repr=False)
class Coordination(Averaged):
    """Contacts per free grain.

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    contacts : mean number of contacts per free grain [-], shape (n_frame,).
    rattlers : share of the grains with fewer than `least` contacts [-], shape (n_frame,).
    least : contacts that a grain which is no rattler has at least: 2 in a plane scene, 4 in 3D.
    z : height of the middle of each layer above the datum [m], shape (n_layer,).
    thickness : of a layer [m].
    over_height, without_rattlers : mean number of contacts of all grains, and of those that are no
        rattlers, whose centres lie in the layer [-].
    averages : coordination, coordination without rattlers, share of rattlers.
    """

    t: Floats
    contacts: Floats
    rattlers: Floats
    least: int
    z: Floats
    thickness: float
    over_height: Layers
    without_rattlers: Layers
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per layer."""
        every, kept = self.over_height, self.without_rattlers
        columns = {
            "z_m": self.z, "coordination": every.value, "coordination_error": every.error,
            "without_rattlers": kept.value, "without_rattlers_error": kept.error,
        }  # fmt: skip
        return lines(columns)

    def series(self) -> list[dict[str, object]]:
        """One dictionary per frame."""
        return lines({"t_s": self.t, "coordination": self.contacts, "rattlers": self.rattlers})


def coordination(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    layer: float = 0.5,
) -> Coordination:
    """Mean number of contacts per grain, averaged over the frames in a window.

    Parameters
    ----------
    run : a run folder.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.
    layer : thickness of a layer in mean diameters.

    Raises
    ------
    ResultsError : no frame in the window.

    Notes
    -----
    Grains touch where they overlap, by the positions of the frame; contacts with fixed grains, planes and
    walls count, each once for the free grain. Rattlers are grains with fewer than 2 contacts in a plane scene
    and fewer than 4 in 3D, counted once: those that become such when rattlers are taken away stay. Without
    them the mean is that of all contacts of the other grains (z* of Agnolin and Roux 2007, Phys. Rev. E 76,
    061302, who tell rattlers by the forces). The number depends on the stiffness: softer grains touch more.
    """
    t, first, last, scene, since = frames_of_grains(run, begin, end)
    thickness = layer * float(scene.d.mean())
    least = 2 if scene.plane_case else 4
    counts: list[Floats] = []
    levels: list[Floats] = []
    for k in range(first, last):
        x = np.asarray(run.frames.x[k], dtype=np.float64)
        counts.append(
            contacts_per_grain(x, scene_at(run, float(t[k - first])), float(t[k - first])).astype(np.float64)
        )
        levels.append(np.floor(x[:, 2] / thickness))
    low = min(int(one.min()) for one in levels)
    n_layer = max(int(one.max()) for one in levels) - low + 1
    sums = np.zeros((len(t), n_layer, 4))  # grains, their contacts, grains that are no rattlers, theirs
    for row, count, level in zip(sums, counts, levels, strict=True):
        held = count >= least
        for c, weight in enumerate((np.ones(len(count)), count, 1.0 * held, count * held)):
            row[:, c] = np.bincount((level - low).astype(np.int64), weight, n_layer)
    whole, window = sums.sum(axis=1), (since, float(t[-1]))
    rattlers = 1.0 - whole[:, 2] / whole[:, 0]
    return Coordination(
        t=t,
        contacts=whole[:, 1] / whole[:, 0],
        rattlers=rattlers,
        least=least,
        z=np.asarray((low + np.arange(n_layer) + 0.5) * thickness, dtype=np.float64),
        thickness=thickness,
        over_height=layers_quotient("coordination", "-", sums[:, :, 1], sums[:, :, 0]),
        without_rattlers=layers_quotient("without_rattlers", "-", sums[:, :, 3], sums[:, :, 2]),
        averages=Averages(
            "coordination",
            (
                ratio("coordination", "-", [whole[:, 1]], [whole[:, 0]], window),
                ratio("without_rattlers", "-", [whole[:, 3]], [whole[:, 2]], window),
                average("rattlers", "-", [rattlers], window),
            ),
            (f"rattlers: grains with fewer than {least} contacts",),
        ),
    )
