"""Adhesion of touching pairs, added to the forces of a batch once its contact law is done (design/0024).

Springs, dashpots, friction and rolling friction are those of the contact without adhesion: the pair is pushed
together by its attraction as by a load, and its Coulomb cap sees the push that results.
"""
# ruff: noqa: E741  (l is a lane)

from functools import cache
from typing import Any

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.arrays import CandidateArrays, GrainArrays
from ryusa.engine.cpu.contact_rows import SHORT, springs_of_row
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.materials import material_of
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.adhesion import adhesion_given_by_step
from ryusa.laws.dispatch import attraction
from ryusa.laws.rolling import reduced_radius


@inner(fastmath=FAST)
def attract(
    choice: LawChoice,
    m: int,
    hdt: float,
    selected: Any,
    c: Any,
    material: Any,
    table: Any,
    grains: GrainArrays,
    candidates: CandidateArrays,
    batch: Any,
) -> None:
    """Add the attraction of the first m lanes to their forces, and what a step gains from it to the account.

    The overlap of the step before is taken from the closing speed, to third order in the step.
    """
    w = grains.w
    amount = c[P.ADHESION]
    for l in range(m):
        now, was = batch[B.TOUCHING + l], batch[B.WAS_TOUCHING + l]
        if now == 0.0 and was == 0.0:
            continue
        i, j = candidates.i[selected[l]], candidates.j[selected[l]]
        if table is not None:
            a, b = material_of(i, grains.ids, material), material_of(j, grains.ids, material)
            amount = table[a, b, P.ADHESION]
        r = reduced_radius(w[i, 3], w[j, 3])
        overlap, closing = batch[B.OVERLAP + l], batch[B.CLOSING + l]
        force, energy = attraction(choice.adhesion, amount, r, overlap)
        before, energy_before = attraction(choice.adhesion, amount, r, overlap - 2.0 * hdt * closing)
        begins = 1.0 if now > was and hdt > 0.0 else 0.0
        batch[B.STEP + l] += adhesion_given_by_step(
            force, energy, before, energy_before, begins, 1.0 if now < was else 0.0, closing, hdt
        )
        for k in range(3):
            batch[B.FORCE + 4 * l + k] += now * force * batch[B.NORMAL + k * B.PITCH + l]


@cache
def make_energy_of_attraction(hertz: bool) -> Any:
    """Build energy_of_attraction for springs or elastic spheres."""

    @inner(fastmath=FAST)
    def energy_of_attraction(
        b: int, choice: LawChoice, c: Any, material: Any, table: Any, grains: GrainArrays,
        candidates: CandidateArrays,
    ) -> float:  # fmt: skip
        """Energy that the attraction of the pairs of block b has released since they touched [J]."""
        w, rows, amount, total = grains.w, candidates.rows, c[P.ADHESION], 0.0
        column = 2 if rows.shape[1] == len(SHORT) else M.OVERLAP  # SHORT.index(M.OVERLAP)
        for k in range(candidates.first[b], candidates.first[b] + candidates.count[b]):
            if candidates.touching[k]:
                i, j = candidates.i[k], candidates.j[k]
                if table is not None:
                    a, b_ = material_of(i, grains.ids, material), material_of(j, grains.ids, material)
                    amount = table[a, b_, P.ADHESION]
                overlap = rows[k, column]
                if not hertz:
                    overlap = springs_of_row(k, rows)[0] / c[P.K_N]
                total += attraction(choice.adhesion, amount, reduced_radius(w[i, 3], w[j, 3]), overlap)[1]
        return total

    return energy_of_attraction
