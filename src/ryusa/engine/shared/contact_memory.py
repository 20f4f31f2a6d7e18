"""Memory of the contacts of a state, as rows that an engine keeps and as the model's Contacts."""

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared.contact_instants import BEGAN
from ryusa.engine.shared.dashpots import make_springs_of, normal_springs_of
from ryusa.engine.shared.layout import Layout
from ryusa.engine.shared.parameters import parameters_of
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.model import Contacts, Scene
from ryusa.model.contacts import N_EVENT
from ryusa.model.scene import Floats


class ContactMemory(NamedTuple):
    """Touching pairs by id: states (contact_instants.py), springs and memory rows (memory_rows.py).

    `eta` has one row where the springs of all pairs are alike.
    """

    i: np.ndarray
    j: np.ndarray
    states: np.ndarray
    eta: Floats
    rows: Floats

    def first(self, count: int) -> "ContactMemory":
        """The first of the pairs, in the same arrays."""
        return self._part(slice(count))

    def after(self, count: int) -> "ContactMemory":
        """The pairs but for the first, in the same arrays."""
        return self._part(slice(count, None))

    def parts(self, count: int) -> "list[ContactMemory]":
        """The pairs in so many parts; their names are uint32, as places are, the arrays else the same."""
        named = self._replace(i=self.i.astype(np.uint32), j=self.j.astype(np.uint32))
        ends = [k * len(self.i) // count for k in range(count + 1)]
        return [named._part(slice(*ends_of)) for ends_of in pairwise(ends)]

    def _part(self, some: slice) -> "ContactMemory":
        eta = self.eta if len(self.eta) == 1 else self.eta[some]
        return ContactMemory(self.i[some], self.j[some], self.states[some], eta, self.rows[some])


def contacts_of(memory: ContactMemory, variant: KernelVariant) -> Contacts:
    """Contacts of a snapshot; the arrays are views of the memory where they can be."""
    i, j, states, eta, rows = memory
    n = len(i)
    eta = np.broadcast_to(eta, (n, eta.shape[1]))
    dash_n, overlap = rows[:, M.DASH_N], np.zeros(n)
    if variant.hertz:
        overlap = rows[:, M.OVERLAP]
        dash_n = rows[:, M.F_N] - eta[:, M.K_HERTZ] * overlap * np.sqrt(overlap)
    k_n = np.zeros(n)
    if variant.exact:  # with which the energy of a spring is f**2/(2 k)
        k_n = eta[:, M.K_N] ** 2 / eta[:, M.STORED]
    return Contacts(
        i=i.astype(np.int64, copy=False),
        j=j.astype(np.int64, copy=False),
        spring_s=rows[:, M.SPRING_S : M.SPRING_S + 3],
        dash_s=rows[:, M.DASH_S : M.DASH_S + 3],
        dash_n=dash_n,
        f_n=rows[:, M.F_N],
        spring_r=rows[:, M.SPRING_R : M.SPRING_R + 3] if variant.rolling else np.zeros((n, 3)),
        dash_r=rows[:, M.DASH_R : M.DASH_R + 3] if variant.rolling else np.zeros((n, 3)),
        eta_n=eta[:, M.ETA_N],
        k_n=k_n,
        state=states.astype(np.int64),
        overlap=overlap,
        event=rows[:, variant.event_column :] if variant.events else np.zeros((n, N_EVENT)),
    )


def memory_of(
    contacts: Contacts, variant: KernelVariant, choice: LawChoice, numbers: Floats, layout: Layout
) -> ContactMemory:
    """Rows from a snapshot; dashpots follow from masses anew, but one that a film has fixed stays."""
    rows = np.zeros((len(contacts), variant.row_width))
    m, inertia, x = layout.m, layout.inertia, np.zeros((layout.n_total, 4))
    eta, x[:, 3] = np.zeros((len(contacts), variant.springs)), layout.r
    for scene, some in layout.scene.by_pair(contacts.i, contacts.j):
        mine, law = np.empty((len(contacts.i[some]), variant.springs)), numbers
        if layout.scene.materials is not None:
            law = parameters_of(scene)
        make_springs_of(variant.kind)(
            contacts.i[some], contacts.j[some], variant.rotation, law, m, x, inertia, mine
        )
        if choice.rebound:
            mine[:, M.ETA_N] = contacts.eta_n[some]
        if choice.rebound and variant.exact:
            normal_springs_of(contacts.i[some], contacts.j[some], law, m, mine)
        eta[some] = mine
    rows[:, M.SPRING_S : M.SPRING_S + 3], rows[:, M.DASH_S : M.DASH_S + 3] = (
        contacts.spring_s,
        contacts.dash_s,
    )
    rows[:, M.DASH_N], rows[:, M.F_N] = contacts.dash_n, contacts.f_n
    if variant.hertz:
        rows[:, M.OVERLAP] = contacts.overlap
    if variant.rolling:
        rows[:, M.SPRING_R : M.SPRING_R + 3], rows[:, M.DASH_R : M.DASH_R + 3] = (
            contacts.spring_r,
            contacts.dash_r,
        )
    if variant.events:
        rows[:, variant.event_column :] = contacts.event
    states = contacts.state.astype(np.uint8) if variant.exact else np.ones(len(contacts), np.uint8)
    return ContactMemory(contacts.i, contacts.j, states, eta, rows)


def contacts_of_grains(memory: ContactMemory, n: int) -> np.ndarray:
    """Partners that each of n free grains touched in the last step, int32."""
    touches = memory.states != BEGAN  # since the last step
    i, j = memory.i[touches], memory.j[touches]
    return np.bincount(np.concatenate([i, j[j < n]]), minlength=n).astype(np.int32)


def remaining_contacts(scene: Scene, contacts: Contacts) -> tuple[Contacts, np.ndarray]:
    """Contacts whose partner still stands, and the places of those whose partner was taken away."""
    faces = np.ones(0, np.bool_) if scene.walls is None else scene.walls.face_active
    active = np.concatenate([np.ones(scene.n_grain, np.bool_), scene.fixed_active, scene.plane_active, faces])
    keep = active[contacts.j]
    if keep.all():
        return contacts, np.zeros(0, np.int64)
    return replace(contacts, **{name: array[keep] for name, array in vars(contacts).items()}), np.flatnonzero(
        ~keep
    )
