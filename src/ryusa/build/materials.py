"""Materials of the grains, fixed grains and planes of a case."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ryusa.build.laws import contact_of, rolling_of
from ryusa.build.placement import Placement
from ryusa.build.sizes import laid_materials
from ryusa.casefile.builders.table import made_of
from ryusa.casefile.case import Case
from ryusa.casefile.materials.values import GRAINS, case_of_pair, density, names_of
from ryusa.model import Materials, Scene, Traffic
from ryusa.model.scene import Floats

Numbers = NDArray[np.int8]


def materials_of(case: Case, placement: Placement, n_first: int, traffic: Traffic | None) -> Numbers:
    """Number of the material of each grain, fixed grain and plane; empty where all are of one.

    Parameters
    ----------
    placement : with the grains of feeds, and the planes of the case after those of the builder.
    n_first : grains that are there at first.
    """
    if not case.materials:
        return np.zeros(0, np.int8)
    names = names_of(case.materials)
    of = np.zeros(len(placement.d) + len(placement.d_fixed) + len(placement.walls), np.int8)
    for name, which in laid_materials(case.grains.mixture, case.seed, n_first):
        of[which] = names.index(name)
    made = made_of(case.build)
    for group, begin, n in placement.free_groups:
        if group in made:
            of[begin : begin + n] = names.index(made[group])
    for feed, keys in zip(traffic.feeds if traffic is not None else (), case.feeds, strict=True):
        of[feed.first : feed.first + feed.count] = names.index(keys.material or GRAINS)
    of[len(placement.d) :] = names.index(case.grains.bed_material or GRAINS)
    for k, plane in enumerate(reversed(case.planes)):
        of[len(of) - 1 - k] = names.index(plane.material or GRAINS)
    return of


def densities(case: Case, of: Numbers) -> Floats:
    """Density of each grain [kg/m3]."""
    return np.array([density(case, name) for name in names_of(case.materials)])[of]


def with_materials(case: Case, scene: Scene, of: Numbers) -> Scene:
    """The same scene with the materials of a case, `of` by id without faces; as it is where there is one."""
    if not len(of):
        return scene
    names, walls = names_of(case.materials), scene.walls
    if walls is not None:
        of_case = [names.index(one.material or GRAINS) for one in case.walls]
        others = walls.names[len(of_case) :]  # bottom and dams of a stream
        bed = names.index(case.grains.bed_material or GRAINS)
        own = np.array([*of_case, *(bed for _ in others)], np.int8)
        of = np.concatenate([of, own[walls.wall]])
    of.flags.writeable = False
    pairs = [case_of_pair(case, *sorted((a, b), key=names.index)) for a in names for b in names]
    contact, rolling = tuple(map(contact_of, pairs)), tuple(map(rolling_of, pairs))
    return replace(scene, materials=Materials(names, of, contact, rolling))
