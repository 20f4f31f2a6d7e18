"""How a batch of touching pairs lies in memory while the contact law is computed, lane by lane.

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
SEPARATION = 0  # from i to j, and both radii together [m]
RELATIVE_VELOCITY = 4 * PITCH  # velocity of i against j [m/s], and the normal dashpot [N s/m]
SPIN_I = 8 * PITCH  # spin of i [rad/s] and its radius [m]
SPIN_J = 12 * PITCH
SPRING = 16 * PITCH  # memory: tangential spring force on i, and normal force [N]
DASH = 20 * PITCH  # memory: tangential dashpot force on i, and normal force less normal spring [N]
FORCE = 24 * PITCH  # force on i [N], and nothing
TORQUE_I = 28 * PITCH  # torque on i [N m], and 1 where they touch
TORQUE_J = 32 * PITCH
# Rows:
ETA_S = 36 * PITCH  # tangential dashpot [N s/m]
RAW = 37 * PITCH  # normal force before the limit [N]
WAS_TOUCHING = 38 * PITCH  # 1 where they touched in the last step
EXCESS = 39 * PITCH  # overlap less the largest so far for its size [m]
# Books [J], summed lane by lane until the block is done:
WORK = 40 * PITCH
DASH_N, DASH_S, SLIDE, RELEASED_N, RELEASED_S, STEP = (WORK + k * PITCH for k in range(6))
N_WORK = 6
# Rows that one loop leaves for the next, and for rolling friction, films and records:
OVERLAP = 46 * PITCH  # [m], negative where they do not touch
CLOSING = 47 * PITCH  # [m/s]
NORMAL = 48 * PITCH  # three rows [-]
SLIP = 51 * PITCH  # slip velocity at the contact point, three rows [m/s]
SLIDES = 54 * PITCH  # 1 where it slides
ARM_I = 55 * PITCH  # [m]
ARM_J = 56 * PITCH
TWIST = 57 * PITCH  # angle the pair turned about its normal [rad]
F_N = 58 * PITCH  # normal force, and that of the spring alone [N]
E_N = 59 * PITCH
HELD = 60 * PITCH  # 1 where they push, or pull if they may
TOUCHING = 61 * PITCH  # 1 where they touch
# Only with exact timing:
K_N = 62 * PITCH  # stiffnesses of the map [N/m]
K_S = 63 * PITCH
STATE = 64 * PITCH  # of the pair after this step (shared/contact_instants.py)
WATCHED = 65 * PITCH  # 1 where the contact begins or ends, or may end
GIVEN = 66 * PITCH  # 1 where the tangential force is in the next six rows: spring, and the rest [N]
GIVEN_SPRING = 67 * PITCH
GIVEN_REST = 70 * PITCH
GIVEN_SLID = 73 * PITCH  # 1 where it slid
UNTIL = 74 * PITCH  # time to the end of the force [s]; inf where it goes on, -inf where it ended before
REST = 75 * PITCH  # correction of the closing speed that the next step makes [m/s]
SIZE = 76 * PITCH
FAR = 1.0e9  # [m] where a lane without a pair puts its partner
