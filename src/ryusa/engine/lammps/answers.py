"""What a rank answers to the leader about its grains."""

from typing import NamedTuple

import numpy as np

from ryusa.model.arrays import Floats

FEWEST_IMAGES = 1024  # LAMMPS counts periods modulo this number: ten bits of a flag for each axis


class RankRows(NamedTuple):
    """Grains of one rank: ids from 0, and what is known of them; periods crossed modulo FEWEST_IMAGES."""

    ids: np.ndarray
    x: Floats
    v: Floats  # half a step before x, as omega
    omega: Floats
    image: np.ndarray


class Extremes(NamedTuple):
    """Sums and extremes over the grains of one rank, at the time of x."""

    kinetic: float
    spin: float
    spring_n: float
    n_contact: int
    overlap: float  # largest, over the smaller diameter [-]
    pair: tuple[int, int]  # that has it; -1 without
    speed: float  # of the fastest grain [m/s]
    fastest: int
    spin_max: float
    not_finite: int  # id of a grain that is not; -1 without
    outside: int  # id of a grain outside the world; -1 without


def together(parts: list[Extremes]) -> Extremes:
    """Sums and extremes of all ranks."""
    worst = max(parts, key=lambda one: one.overlap)
    fast = max(parts, key=lambda one: one.speed)
    return Extremes(
        kinetic=sum(one.kinetic for one in parts),
        spin=sum(one.spin for one in parts),
        spring_n=sum(one.spring_n for one in parts),
        n_contact=sum(one.n_contact for one in parts),
        overlap=worst.overlap,
        pair=worst.pair,
        speed=fast.speed,
        fastest=fast.fastest,
        spin_max=max(one.spin_max for one in parts),
        not_finite=max(one.not_finite for one in parts),
        outside=max(one.outside for one in parts),
    )
