"""Arrays that lie on the device, and the numbers that a kernel leaves behind.

Plain integers, since kernels read them as constants.
"""

from typing import Any, NamedTuple

from ryusa.model.tally import N_BOOK


class Bodies(NamedTuple):
    """Grains by place: n free ones in cell order, fixed ones, planes. What moves has two halves.

    A step reads half `flow[PARITY]` and writes the other, so that a grain may read its neighbours while they
    move. Fixed grains and planes stand in both.
    """

    x: Any  # centres [m], and the radius [m], (2, n_total, 4)
    v: Any  # velocities [m/s], and 0, (2, n_total, 4)
    w: Any  # spins [rad/s], and the radius [m], (2, n_total, 4)
    m: Any  # mass with added mass [kg], (n_total,); inf beyond n
    inertia: Any  # [kg m2], (n_total,); inf beyond n
    m_bare: Any  # mass without added mass [kg], (n,)
    m_weight: Any  # mass that gravity sees [kg], (n,)
    ids: Any  # id of each place, int32, (n_solid,)
    image: Any  # periods crossed, int32, (n, 2)
    tracked: Any  # 1 where its contacts are recorded, by id, uint8, (n,)
    touched: Any  # contacts in the last step, int32, (2, n)
    seen: Any  # water at each grain, columns of model.fluid, (n, N_SEEN); (1, N_SEEN) without a column
    taken: Any  # impulse it took from the water [N s], and drag over slip, (n, N_TAKEN)


class Placed(NamedTuple):
    """What engine/records.py reads of grains."""

    x: Any
    v: Any
    w: Any
    ids: Any
    image: Any
    tracked: Any


class Pairs(NamedTuple):
    """Neighbours of every grain, in ascending order of ids; a pair stands in it twice, once for each side.

    Both sides keep the memory of the pair, seen from the grain with the lower id, and reckon it alike: the
    two rows hold the same bits. Only that side's row keeps an open record.
    """

    start: Any  # neighbours of grain i are partners[start[i]:start[i + 1]], int64, (n + 1,)
    partners: Any  # places, int32, (room,)
    live: Any  # 1 where they touch and the row holds, uint8, (room,)
    eta: Any  # normal and tangential dashpot [N s/m], (room, 2)
    rows: Any  # memory (engine/rows.py), (room, width); holds where they touch


class Walls(NamedTuple):
    """Planes."""

    normals: Any  # (n_plane, 3)
    points: Any  # [m], (n_plane, 3)
    active: Any  # uint8, (n_plane,)


# What one step adds up over grains: works by model.tally.Book, then these.
A_PEND_DRAG = N_BOOK  # second half of the work of water in the step under way
A_PEND_TORQUE = N_BOOK + 1
A_PEND_LIFT = N_BOOK + 2
A_PEND_FLOW = N_BOOK + 3
A_PEND_FILM = N_BOOK + 4
A_KINETIC = N_BOOK + 5  # what grains and springs hold, in the last step of a call
A_SPIN = N_BOOK + 6
A_POTENTIAL = N_BOOK + 7
A_SPRING_N = N_BOOK + 8
A_SPRING_S = N_BOOK + 9
A_SPRING_R = N_BOOK + 10
A_N_CONTACT = N_BOOK + 11
N_SUM = 32
A_SPEED_2 = 32  # largest speed and spin, squared
A_SPIN_2 = 33
A_OVERLAP = 34  # largest overlap over diameter, with its pair
A_OVERLAP_GRAIN = 35
A_OVERLAP_PARTNER = 36
A_BAD = 37  # lowest id of a grain whose velocity is not finite
N_COLUMN = 40
NOBODY = 2147483647

# Where the run stands, on the device: int64.
F_STOP = 0  # 0, or why steps are passed over (rows.py)
F_STEP = 1  # done since the start of the run
F_PARITY = 2  # half that holds now
F_ENDED = 3  # records that wait to be fetched
F_SPILT = 4  # lowest id of a grain whose record found no room
N_FLOW = 8

# The same, doubles.
P_TRAVEL = 0  # how far the fastest grain may have gone since the list was made [m]
P_SKIN = 1  # reach of the list beyond touch [m]
P_FASTEST = 2  # speed in the last step [m/s]
N_PACE = 3

MOST_BLOCKS = 4096  # beyond, a thread takes several grains


class Shape(NamedTuple):
    """How the work of a step is cut up; sums depend on it, so it is the same for every card."""

    threads: int  # of a block
    group: int  # columns that a block adds up at once
    closers: int  # threads that close a step
    segments: int  # parts of the blocks that they add up by themselves

    @property
    def parts(self) -> int:
        """Parts of a block that are added up by themselves."""
        return max(1, self.threads // self.group)

    @property
    def desk(self) -> int:
        """Doubles that a block shares while it adds up."""
        return self.group * (self.threads + self.parts)


ON_CARD = Shape(128, 8, 960, 24)
IN_SIMULATOR = Shape(8, N_COLUMN, 8, 1)  # where every thread is one of Python's, and waits are dear
