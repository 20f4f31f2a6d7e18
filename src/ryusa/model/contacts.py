"""History of touching pairs, and the record written when a contact ends."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.printed import ByShape

# One row per contact that ended. Vectors are those of grain i; n points from i to j.
EVENT = np.dtype(
    [
        ("i", np.int64),  # id of the free grain
        ("j", np.int64),  # id of its partner: free grain, fixed grain or plane (Scene)
        ("t_begin", np.float64),  # first touch, interpolated [s]
        ("t_end", np.float64),  # last end of the normal force, interpolated [s]
        ("t_part", np.float64),  # the overlap ends [s]
        ("overlap_max", np.float64),  # [m]
        ("closing_begin", np.float64),  # closing speed at first touch [m/s], positive when approaching
        ("closing_end", np.float64),  # at parting [m/s], negative; nan if the partner was removed
        ("slip_begin", np.float64, (3,)),  # slip velocity of i relative to j at the contact point [m/s]
        ("slip_end", np.float64, (3,)),
        ("impulse_n", np.float64),  # integral of f_n [N s]
        ("impulse", np.float64, (3,)),  # integral of the contact force on grain i [N s]
        ("t_slide", np.float64),  # time spent sliding [s]
        ("alone", np.float64),  # 1 if neither partner touched anything else during the contact, else 0
        ("x_begin", np.float64, (3,)),  # centre of grain i at first touch, unwrapped [m]
        ("v_begin", np.float64, (3,)),  # velocity of grain i at first touch [m/s]
        ("v_end", np.float64, (3,)),  # and at parting [m/s]
        ("omega_begin", np.float64, (3,)),  # spin of grain i at first touch [rad/s]
        ("omega_end", np.float64, (3,)),  # and at parting [rad/s]
    ]
)
N_EVENT = EVENT.itemsize // 8
N_STATE = 6  # states of a pair in contact


def joined(events: Sequence[np.ndarray]) -> np.ndarray:
    """One array of several with records of contacts; as numbers, which numpy copies faster than fields."""
    if not events:
        return np.zeros(0, dtype=EVENT)
    return np.concatenate([_numbers(one) for one in events]).view(EVENT).reshape(-1)


def in_order_of_parting(events: np.ndarray) -> np.ndarray:
    """Records of ended contacts, dtype EVENT, by time of parting.

    Those that part at one time are in order of grain, partner and beginning. Records that are in this order
    already are returned as they are, not copied.
    """
    t = np.ascontiguousarray(events["t_part"])
    if np.all(t[1:] > t[:-1]):
        return events
    order = np.argsort(t)
    t = t[order]
    equal = ~(t[1:] > t[:-1])
    tied = np.flatnonzero(np.append(equal, False) | np.append(False, equal))
    if len(tied):
        rows = events[order[tied]]
        order[tied] = order[tied][np.lexsort((rows["t_begin"], rows["j"], rows["i"], rows["t_part"]))]
    return _numbers(events).take(order, axis=0).view(EVENT).reshape(-1)


def _numbers(events: np.ndarray) -> np.ndarray:
    return events.view(np.float64).reshape(-1, N_EVENT)


@dataclass(frozen=True, repr=False)
class Contacts(ByShape):
    """History of the pairs that touch at present; it begins and ends with a contact.

    All arrays have n_contact rows; i is always a free grain, j > i a free grain, a fixed grain or a plane. In
    a plane scene column 0 of the tangential vectors is the component along the tangent (n_z, 0, -n_x), and
    the others are zero.
    """

    i: np.ndarray  # ids, int64
    j: np.ndarray
    spring_s: Floats  # tangential spring force on grain i [N], shape (n_contact, 3)
    dash_s: Floats  # tangential dashpot force on i in the last step [N], shape (n_contact, 3)
    dash_n: Floats  # normal force without its spring in the last step [N], shape (n_contact,)
    f_n: Floats  # normal force in the last step [N], shape (n_contact,)
    spring_r: Floats  # rolling spring torque on i [N m], shape (n_contact, 3)
    dash_r: Floats  # rolling torque on i without its spring in the last step [N m], shape (n_contact, 3)
    eta_n: Floats  # normal dashpot, set at first touch if films reduce rebound, shape (n_contact,);
    # [N s/m], of elastic spheres over the overlap to the power 0.25 [N s/m**1.25]
    # with exact timing the stiffness k with which a spring holds f**2/(2 k) [N/m], else 0, shape (n_contact,)
    k_n: Floats
    state: np.ndarray  # 1 in contact; others in the steps that begin or end it (engine/shared), int64
    overlap: Floats  # of elastic spheres in the last step [m], else 0, shape (n_contact,)
    event: np.ndarray  # incomplete record of each contact, shape (n_contact, N_EVENT), float64

    @staticmethod
    def none() -> "Contacts":
        """Contacts of a state without touching pairs."""
        ids = np.zeros(0, dtype=np.int64)
        v3 = np.zeros((0, 3))
        none, event = np.zeros(0), np.zeros((0, N_EVENT))
        return Contacts(ids, ids, v3, v3, none, none, v3, v3, none, none, ids, none, event)

    def __len__(self) -> int:
        return len(self.i)
