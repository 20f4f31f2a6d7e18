"""Statistics of a block of grains: energies at the last step of a call, extremes, and the first fault.

The energy account of a block, by model.tally.Term, is kept beside them.
"""

KINETIC = 0
SPIN = 1
POTENTIAL = 2
SPRING_N = 3
SPRING_S = 4
SPRING_R = 5
N_CONTACT = 6
SPEED_MAX = 7  # posted (cpu/integration.py)
SPIN_MAX = 8
OVERLAP_MAX = 9  # largest overlap over diameter so far, with grain and step
OVERLAP_GRAIN = 10
OVERLAP_STEP = 11
PENDING_DRAG = 12  # second half of the work of water in the present step
PENDING_TORQUE = 13
FAULT = 14  # 0, or a Fault
FAULT_GRAIN = 15
FAULT_PARTNER = 16
N_ENDED = 17  # records waiting in the block's event buffer
FAULT_POSTED = 18  # FAULT and N_ENDED, posted
N_ENDED_POSTED = 19
PENDING_LIFT = 20
PENDING_FLOW = 21
PENDING_FILM = 22
N_TOUCHING = 24  # pairs in touch at the last pruning; -1 where one of them is not in the Verlet list
VELOCITY_CHANGE_MAX = 25  # largest difference of a velocity to that at the last pruning [m/s], posted
SPEED_MOVED = 26  # largest speed and difference as the block last moved: its own thread's, until posted
VELOCITY_CHANGE_MOVED = 27
PENDING_WALL = 28
# of contacts with exact timing, what belongs to the interval after the step: energy from the step itself, and
# what is dissipated
PENDING_STEP = 29
PENDING_DASH_N = 30
PENDING_DASH_S = 31
PENDING_SLIDE = 32
N_STATISTIC = 40  # a whole number of cache lines: blocks of different threads share none
PENDING = (
    PENDING_DRAG,
    PENDING_TORQUE,
    PENDING_LIFT,
    PENDING_FLOW,
    PENDING_FILM,
    PENDING_WALL,
    PENDING_STEP,
    PENDING_DASH_N,
    PENDING_DASH_S,
    PENDING_SLIDE,
)  # booked with the next step
