"""Arrays on the device, and how kernels are launched on them."""

from typing import Any, NamedTuple

from ryusa.engine.cuda import step_totals as T


class DeviceGrainArrays(NamedTuple):
    """Grains by place: n free ones in cell order, fixed ones, planes. What moves has two halves.

    A step reads half `status[CURRENT]` and writes the other: a grain may read its neighbours while they move.
    With exact timing kicks and shear do so each. Fixed grains and planes stand in both.
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
    n_touching: Any  # contacts in the last step, int32, (2, n)
    fluid: Any  # water at each grain, columns of model.fluid, (n, N_SAMPLED); (1, N_SAMPLED) without a column
    impulse: Any  # impulse from the water [N s], and drag over slip, (n, N_IMPULSE)


class RecordedGrains(NamedTuple):
    """What the contact records read of grains."""

    x: Any
    v: Any
    w: Any
    ids: Any
    image: Any
    tracked: Any


class DevicePairArrays(NamedTuple):
    """Neighbours of every grain, in ascending order of ids; a pair stands in it twice, once for each side.

    Both sides keep the memory of the pair, seen from the grain with the lower id, and compute it alike: the
    two rows hold the same bits. Only that side's row keeps an open record.
    """

    start: Any  # neighbours of grain i are partners[start[i]:start[i + 1]], int64, (n + 1,)
    partners: Any  # places, int32, (room,)
    touching: Any  # state (shared/contact_instants.py); where it is not 0 the row holds, uint8, (room,)
    eta: Any  # dashpots and stiffnesses (shared/memory_rows.py), (room, springs)
    rows: Any  # memory (shared/memory_rows.py), (room, width); holds where they touch


class DeviceWallArrays(NamedTuple):
    """Planes."""

    normals: Any  # (n_plane, 3)
    points: Any  # [m], (n_plane, 3)
    active: Any  # uint8, (n_plane,)


MOST_BLOCKS = 528  # beyond, a thread takes several grains: twice what 132 multiprocessors hold (design/0009)


class LaunchShape(NamedTuple):
    """How the work of a step is divided; sums depend on it, so it is the same for every card."""

    threads: int  # of a block
    group: int  # columns that a block adds up at once
    closers: int  # threads that close a step
    segments: int  # parts of the blocks that they add up by themselves

    @property
    def parts(self) -> int:
        """Parts of a block that are added up by themselves."""
        return max(1, self.threads // self.group)

    @property
    def shared_doubles(self) -> int:
        """Doubles that a block shares while it adds up."""
        return self.group * (self.threads + self.parts)


ON_CARD = LaunchShape(128, 8, 960, 24)
IN_SIMULATOR = LaunchShape(8, T.N_COLUMN, 8, 1)  # where every thread is one of Python's, and waits are dear
