"""Between rows of contact memory and the model's Contacts."""

import numpy as np

from ryusa.engine.listing import Layout, Memory
from ryusa.engine.pair import begin_row
from ryusa.engine.rows import R_DASH_N, R_DASH_R, R_DASH_S, R_F_N, R_SPRING_R, R_SPRING_S, Variant
from ryusa.model import Contacts
from ryusa.model.contacts import N_EVENT
from ryusa.model.scene import Floats


def contacts_of(memory: Memory, variant: Variant) -> Contacts:
    """Contacts of a snapshot."""
    i, j, rows = memory
    none = np.zeros((len(i), 3))
    return Contacts(
        i=i,
        j=j,
        spring_s=rows[:, R_SPRING_S : R_SPRING_S + 3].copy(),
        dash_s=rows[:, R_DASH_S : R_DASH_S + 3].copy(),
        dash_n=rows[:, R_DASH_N].copy(),
        f_n=rows[:, R_F_N].copy(),
        spring_r=rows[:, R_SPRING_R : R_SPRING_R + 3].copy() if variant.rolling else none,
        dash_r=rows[:, R_DASH_R : R_DASH_R + 3].copy() if variant.rolling else none,
        event=rows[:, variant.event_column :].copy() if variant.events else np.zeros((len(i), N_EVENT)),
    )


def memory_of(contacts: Contacts, variant: Variant, numbers: Floats, layout: Layout) -> Memory:
    """Rows from a snapshot; dashpots follow from masses anew."""
    rows = np.zeros((len(contacts), variant.row_width))
    for row, i, j in zip(rows, contacts.i, contacts.j, strict=True):
        begin_row(row, variant.rotation, i, j, numbers, layout.m, layout.r, layout.inertia)
    rows[:, R_SPRING_S : R_SPRING_S + 3], rows[:, R_DASH_S : R_DASH_S + 3] = (
        contacts.spring_s,
        contacts.dash_s,
    )
    rows[:, R_DASH_N], rows[:, R_F_N] = contacts.dash_n, contacts.f_n
    if variant.rolling:
        rows[:, R_SPRING_R : R_SPRING_R + 3], rows[:, R_DASH_R : R_DASH_R + 3] = (
            contacts.spring_r,
            contacts.dash_r,
        )
    if variant.events:
        rows[:, variant.event_column :] = contacts.event
    return Memory(contacts.i, contacts.j, rows)
