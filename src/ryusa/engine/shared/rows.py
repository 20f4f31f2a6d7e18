"""How a pair's memory lies in a row of doubles, and the numbers a kernel is given and gives back.

Plain integers, since kernels read them as constants.
"""

from typing import NamedTuple

from ryusa.model.contacts import N_EVENT

# Row of a pair: vectors take three columns. A plane scene keeps the component along its one tangent.
R_SPRING_S = 0  # tangential spring force on grain i [N]
R_F_N = 3  # normal force in the last step [N]
R_DASH_S = 4  # tangential dashpot force on i in the last step [N]
R_DASH_N = 7  # normal force less normal spring in the last step [N]
R_SPRING_R = 8  # rolling spring torque on i [N m]; from here on only where rolling friction acts
R_DASH_R = 11  # rolling torque on i in the last step, less its spring [N m]
R_ROLLING = 14
ETA_N, ETA_S = 0, 1  # dashpots of a pair [N s/m], beside its row

# Open contact record, counted from where it starts in the row (fields of model.EVENT).
E_I = 0
E_J = 1
E_T_BEGIN = 2
E_T_END = 3
E_T_PART = 4
E_OVERLAP_MAX = 5
E_CLOSING_BEGIN = 6
E_CLOSING_END = 7
E_SLIP_BEGIN = 8
E_SLIP_END = 11
E_IMPULSE_N = 14
E_IMPULSE = 15
E_T_SLIDE = 18
E_ALONE = 19
E_X_BEGIN = 20
E_V_BEGIN = 23
E_V_END = 26
E_OMEGA_BEGIN = 29
E_OMEGA_END = 32

# Scalars a kernel reads.
C_DT = 0
C_K_N = 1
C_K_S = 2
C_MU = 3
C_COHESION = 4
C_ROLL = 5
C_ROLL_STIFFNESS = 6
C_ROLL_ZETA = 7
C_OVERLAP_LIMIT = 8
C_STEP_LIMIT = 9  # longest way a grain may go in one step [m]
C_PERIOD_X = 10
C_PERIOD_Y = 11
C_G_X = 12
C_G_Y = 13
C_G_Z = 14
C_U_STAR = 15
C_K_ROUGH = 16
C_Z_ZERO = 17
C_U_UNIFORM = 18
C_DEPTH = 19
C_NU = 20
C_RHO_W = 21
C_C_D = 22
C_A_2 = 23
C_SKIN = 24
C_T_ZERO = 25  # time of step 0 [s]
C_ZETA_N = 26
C_ZETA_S = 27
C_ETA_N = 28  # constants, 0 where they follow from restitution
C_ETA_S = 29
C_HINDRANCE = 30  # exponent
C_C_L = 31
C_FILM_REACH = 32  # gap below which a film resists before touch [m]
C_ASPERITY = 33
C_ST_C = 34
C_E_DRY = 35  # restitution asked for [-]
C_E_LEAST = 36

# Per block: what holds at the last step of a call, and extremes (model.tally.Book is kept beside it).
N_KINETIC = 0
N_SPIN = 1
N_POTENTIAL = 2
N_SPRING_N = 3
N_SPRING_S = 4
N_SPRING_R = 5
N_N_CONTACT = 6
N_SPEED_MAX = 7
N_SPIN_MAX = 8
N_OVERLAP_MAX = 9  # largest overlap over diameter so far, with grain and step
N_OVERLAP_GRAIN = 10
N_OVERLAP_STEP = 11
N_PEND_DRAG = 12  # second half of the work of water in the step under way
N_PEND_TORQUE = 13
N_FAULT = 14  # 0, or a Fault
N_FAULT_GRAIN = 15
N_FAULT_PARTNER = 16
N_N_ENDED = 17  # records waiting in the block's event buffer
N_FAULT_SHOWN = 18  # FAULT and N_ENDED as they stood when the block last moved: what other threads may read
N_ENDED_SHOWN = 19
N_PEND_LIFT = 20
N_PEND_FLOW = 21
N_PEND_FILM = 22
N_FULL = 23  # pairs that found no room when the near list of the block was cut, all of them; else 0
N_TOUCHING = 24  # pairs in touch when it was cut
N_STRAY_MAX = 25  # largest difference of a velocity to what it was then [m/s]

# The near list's own clock, kept between calls; it never shows in the bits.
K_SKIN = 0  # reach of the near list beyond touch [m]
K_STRAY = 1  # how much nearer two grains may be than if each had kept its velocity since then [m]
K_SINCE = 2  # steps since
K_LANES = 3  # lanes of all blocks
K_LEAST = 4  # smallest and largest skin [m]
K_MOST = 5
K_TOUCHING = 6  # pairs in touch when it was cut
K_AHEAD = 7  # steps it should last
K_LASTS = 8  # steps it does last at most
K_ROOM = 9  # how far a pair may move before another image of it is the nearer one [m]
N_CLOCK = 10

# What a kernel cannot raise.
FAULT_NONE = 0
FAULT_NOT_A_NUMBER = 1
FAULT_OVERLAP = 2
FAULT_EVENTS_FULL = 3

# Why a kernel call came back.
STOP_DONE = 0
STOP_LIST = 1  # the list wants a rebuild
STOP_EVENTS = 2  # event buffers want draining
STOP_FAULT = 3
STOP_UNSAFE = 4  # a grain went further in one step than the list allows
STOP_ROOM = 5  # the near list wants more room

# Measured, and fixed so that a run never depends on a clock [ns]: to look at a pair of the wide list and at a
# grain while the near list is cut, to list a near pair, and to look at it in a step.
COST_LOOK, COST_GRAIN, COST_LAY, COST_NEAR = 7.0, 5.0, 10.0, 3.0
LONGEST_CUT = 512.0  # steps after which the near list is cut though nothing moves
LOOK_AHEAD = 1.5  # steps a near list is cut for, over those it should last
ROUNDED_UP = 1.000001  # what keeps a reach from falling short by round-off

BASE, WITH_ROLLING = 8, 16  # doubles a row takes without and with rolling friction: whole cache lines
# widths padded to whole cache lines, so that blocks of different threads do not share one
N_NOW = 32
N_BOOKS = 24
PENDING = (
    N_PEND_DRAG,
    N_PEND_TORQUE,
    N_PEND_LIFT,
    N_PEND_FLOW,
    N_PEND_FILM,
)  # kept behind the books in a snapshot


class Variant(NamedTuple):
    """What a kernel is compiled for; each is kept on disk once built."""

    plane_case: int
    rotation: int
    rolling: int
    events: int
    column: int
    film: int  # films resist before touch
    water: int  # there is any

    @property
    def row_width(self) -> int:
        """Doubles per contact row."""
        return self.event_column + (N_EVENT if self.events else 0)

    @property
    def event_column(self) -> int:
        """Where the open record starts."""
        return WITH_ROLLING if self.rolling else BASE


class Choice(NamedTuple):
    """Laws a kernel picks while it runs (model.enums); always the same, so that a branch is free."""

    slip: int
    cap: int
    tension: int
    rolling: int
    arm: int
    events: int
    profile: int
    above: int
    drag: int
    torque: int
    buoyancy: int
    hindrance: int
    lift: int
    magnus: int
    rebound: int
