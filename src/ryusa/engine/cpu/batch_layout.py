"""The desk: how a batch of touching pairs lies in memory while the law of contact works on it, lane by lane.

The loop over lanes becomes vector instructions: eight pairs at a time where the machine has them. For that
it works on one flat array, at places known when it is compiled. Groups of four doubles belong to one pair, so
that they are filled and emptied by whole vectors; rows hold one double a pair. Plain integers, since kernels
read them as constants. A loop reads all four of a group or none: else it would have to end in single lanes.
"""

LANES = 32  # pairs in a batch
PITCH = (
    LANES + 8
)  # between rows: with a power of two all rows would fall into the same few places of the cache

# Groups of four:
D_APART = 0  # from i to j, and both radii together [m]
D_MOVING = 4 * PITCH  # velocity of i against j [m/s], and the normal dashpot [N s/m]
D_SPIN_I = 8 * PITCH  # spin of i [rad/s] and its radius [m]
D_SPIN_J = 12 * PITCH
D_SPRING = 16 * PITCH  # memory: tangential spring force on i, and normal force [N]
D_DASH = 20 * PITCH  # memory: tangential dashpot force on i, and normal force less normal spring [N]
D_FORCE = 24 * PITCH  # force on i [N], and nothing
D_TORQUE_I = 28 * PITCH  # torque on i [N m], and 1 where they touch
D_TORQUE_J = 32 * PITCH
# Rows:
D_ETA_S = 36 * PITCH  # tangential dashpot [N s/m]
D_RAW = 37 * PITCH  # normal force before it is cut [N]
D_WAS = 38 * PITCH  # 1 where they touched in the last step
D_EXCESS = 39 * PITCH  # overlap less the largest so far for its size [m]
# Books [J], summed lane by lane until the block is done:
D_BOOKS = 40 * PITCH
D_DASH_N, D_DASH_S, D_SLIDE, D_RELEASED_N, D_RELEASED_S, D_STEP = (D_BOOKS + k * PITCH for k in range(6))
N_LANE_BOOK = 6
# Rows that one loop leaves for the next, and for rolling friction, films and records:
D_OVERLAP = 46 * PITCH  # [m], negative where they do not touch
D_CLOSING = 47 * PITCH  # [m/s]
D_NORMAL = 48 * PITCH  # three rows [-]
D_SLIP = 51 * PITCH  # slip velocity at the contact point, three rows [m/s]
D_SLIDES = 54 * PITCH  # 1 where it slides
D_ARM_I = 55 * PITCH  # [m]
D_ARM_J = 56 * PITCH
D_TWIST = 57 * PITCH  # angle the pair turned about its normal [rad]
D_F_N = 58 * PITCH  # normal force, and that of the spring alone [N]
D_E_N = 59 * PITCH
D_HELD = 60 * PITCH  # 1 where they push, or pull if they may
D_LIVE = 61 * PITCH  # 1 where they touch
DESK = 62 * PITCH
FAR = 1.0e9  # [m] where a lane without a pair puts its partner

# A grain in the water lies on a table, in groups of four:
M_V = 0  # velocity [m/s] and spin [rad/s] before the step, and after it
M_V_NEW = 4
M_W = 8
M_W_NEW = 12
M_PUSH = 16  # force [N] but for drag and weight
M_DRAG = 20  # [N]
M_TURN = 24  # torque [N m], and contacts
M_LIFT = 28  # lift and Magnus force [N], and torque of the water over spin [N m s]
M_FLOW = 32  # force of the flow on what it carries [N], and 1 where a grain is in the water
M_ADDED = 36  # added mass in the water [kg], and nothing
TABLE = 40
