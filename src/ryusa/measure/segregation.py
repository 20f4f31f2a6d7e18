"""Segregation by size: where large and small grains lie over height."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.measure.slices_in_layers import frames_of_grains
from ryusa.measure.statistics import average
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.model.scene import Bools

EQUAL = 1.0e-9  # sizes that differ by less than this share are the same


@dataclass(frozen=True, repr=False)
class Segregation(Averaged):
    """Heights of the centres of mass of large and of small grains.

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    z, z_small, z_large : centre of mass of all free grains, of the small and of the large ones, in the
        coordinates of the scene [m], shape (n_frame,).
    index : segregation index [-], shape (n_frame,): 1 with all large grains above all small ones, -1 with all
        below, 0 where both are at the same height.
    cut : diameter above which a grain is large [m].
    share : of the volume of the free grains that is in large ones [-].
    averages : small and large relative to all [m], and the index.
    """

    t: Floats
    z: Floats
    z_small: Floats
    z_large: Floats
    index: Floats
    cut: float
    share: float
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per frame."""
        columns = {
            "t_s": self.t, "z_all_m": self.z, "z_small_m": self.z_small, "z_large_m": self.z_large,
            "segregation_index": self.index,
        }  # fmt: skip
        return lines(columns)


def segregation(
    run: Run, begin: float | None = None, end: float = math.inf, cut: float | None = None
) -> Segregation:
    """Heights of large and small grains over time, and a segregation index.

    Parameters
    ----------
    run : a run folder.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.
    cut : diameter above which a grain is large [m]; default the middle between the smallest and the largest.

    Raises
    ------
    ResultsError : no frame in the window, or no grain above or below the cut.

    Notes
    -----
    The index is z_large - z_small over its largest size with the same sign, which it would have if the
    volume of grains at every height stayed and the large ones lay all on top, or all below. Source: derived;
    for grains that fill a depth h evenly the scale is h/2. Centres are weighted with volume. The height is
    that along z, normal to a bed.
    """
    t, first, last, scene, since = frames_of_grains(run, begin, end)
    d = scene.d
    low, high = float(d.min()), float(d.max())
    cut = 0.5 * (low + high) if cut is None else cut
    large = d > cut
    if high - low <= EQUAL * high or large.all() or not large.any():
        raise ResultsError(
            f"no two sizes to tell apart at {cut:.4g} m: diameters are {low:.4g} .. {high:.4g} m"
        )
    volume = np.pi / 6.0 * d**3
    z = np.stack([np.asarray(run.frames.x[k], dtype=np.float64)[:, 2] for k in range(first, last)])
    middle = (z @ volume) / volume.sum()
    small = (z[:, ~large] @ volume[~large]) / volume[~large].sum()
    above = (z[:, large] @ volume[large]) / volume[large].sum()
    apart = above - small
    most = np.array(
        [_largest(one if up else -one, volume, large) for one, up in zip(z, apart > 0.0, strict=True)]
    )
    index = np.divide(apart, most, np.zeros(len(t)), where=most > 0.0)
    window = since, float(t[-1])
    share = float(volume[large].sum() / volume.sum())
    return Segregation(
        t=t,
        z=middle,
        z_small=small,
        z_large=above,
        index=index,
        cut=cut,
        share=share,
        averages=Averages(
            "segregation",
            (
                average("segregation_index", "-", [index], window),
                average("small_over_all", "m", [small - middle], window),
                average("large_over_all", "m", [above - middle], window),
            ),
            (
                f"large: d > {cut:.4g} m, {share:.1%} of the volume; 1: all large grains on top, 0: mixed, "
                "-1: all large grains below",
            ),
        ),
    )


def _largest(z: Floats, volume: Floats, large: Bools) -> float:
    """Largest difference of the two centres [m] where volume may be exchanged between the heights z."""
    order = np.argsort(z, kind="stable")
    passed = np.concatenate([[0.0], np.cumsum(volume[order])])
    moment = np.concatenate([[0.0], np.cumsum((volume * z)[order])])
    below = float(volume[~large].sum())
    lower = float(np.interp(below, passed, moment))
    return (float(moment[-1]) - lower) / (float(passed[-1]) - below) - lower / below
