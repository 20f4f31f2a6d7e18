"""Between rows of contact memory and the model's Contacts."""

import numpy as np

from ryusa.engine.cpu.verlet_list import Layout, Memory
from ryusa.engine.shared.pair import dashpots_of
from ryusa.engine.shared.rows import (
    E_ALONE,
    E_CLOSING_END,
    E_I,
    E_J,
    E_OMEGA_END,
    E_OVERLAP_MAX,
    E_SLIP_END,
    E_T_END,
    E_T_PART,
    E_V_END,
    ETA_N,
    R_DASH_N,
    R_DASH_R,
    R_DASH_S,
    R_F_N,
    R_SPRING_R,
    R_SPRING_S,
    Choice,
    Variant,
)
from ryusa.model import Contacts, State
from ryusa.model.contacts import N_EVENT
from ryusa.model.scene import Floats


def contacts_of(memory: Memory, variant: Variant) -> Contacts:
    """Contacts of a snapshot."""
    i, j, eta, rows = memory
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
        eta_n=eta[:, ETA_N].copy(),
        event=rows[:, variant.event_column :].copy() if variant.events else np.zeros((len(i), N_EVENT)),
    )


def memory_of(
    contacts: Contacts, variant: Variant, choice: Choice, numbers: Floats, layout: Layout
) -> Memory:
    """Rows from a snapshot; dashpots follow from masses anew, but one that a film has fixed stays."""
    rows = np.zeros((len(contacts), variant.row_width))
    eta, x = np.zeros((len(contacts), 2)), np.zeros((len(layout.r), 4))
    x[:, 3] = layout.r
    dashpots_of(contacts.i, contacts.j, variant.rotation, numbers, layout.m, x, layout.inertia, eta)
    if choice.rebound:
        eta[:, ETA_N] = contacts.eta_n
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
    return Memory(contacts.i, contacts.j, eta, rows)


def closed_records(state: State, places: np.ndarray) -> np.ndarray:
    """Open records of contacts whose partner is taken away, closed now; what parting would tell stays nan."""
    rows = state.contacts.event[places].copy()
    rows = rows[(rows[:, E_J] >= 0.0) & (rows[:, E_OVERLAP_MAX] > 0.0)]
    rows[:, E_T_END] = rows[:, E_T_PART] = state.t
    rows[:, E_CLOSING_END], rows[:, E_ALONE] = np.nan, 0.0
    rows[:, E_SLIP_END : E_SLIP_END + 3] = np.nan
    grains = rows[:, E_I].astype(np.int64)
    rows[:, E_V_END : E_V_END + 3] = state.v[grains]
    rows[:, E_OMEGA_END : E_OMEGA_END + 3] = state.omega[grains]
    return rows
