"""How a batch of touching pairs lies in memory while the contact law is computed, lane by lane.

The loop over lanes becomes vector instructions: eight pairs at a time where the machine has them. For that
it works on one flat array, at places known when it is compiled. Groups of four doubles belong to one pair, so
that they are filled and emptied by whole vectors; rows hold one double a pair. Plain integers, since kernels
read them as constants. A loop reads all four of a group or none: else it would have to end in single lanes.
"""

LANES = 32  # pairs in a batch, a power of two
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
WAS_TOUCHING = 36 * PITCH  # state of the pair: 1 where they touched in the last step
EXCESS = 37 * PITCH  # overlap less the largest so far for its size [m]
# Books [J], summed lane by lane until the block is done:
WORK = 38 * PITCH
DASH_N, DASH_S, SLIDE, RELEASED_N, RELEASED_S, STEP = (WORK + k * PITCH for k in range(6))
N_WORK = 6
# Rows that one loop leaves for the next, and for rolling friction, films and records:
SLIDES = 44 * PITCH  # 1 where it slides
ARM_I = 45 * PITCH  # [m]
ARM_J = 46 * PITCH
HELD = 47 * PITCH  # 1 where they push, or pull if they may
TOUCHING = 48 * PITCH  # 1 where they touch
# These are also the first rows of an event:
OVERLAP = 49 * PITCH  # [m], negative where they do not touch
CLOSING = 50 * PITCH  # [m/s]
NORMAL = 51 * PITCH  # three rows [-]
SLIP = 54 * PITCH  # slip velocity at the contact point, three rows [m/s]
TWIST = 57 * PITCH  # angle the pair turned about its normal [rad]
ETA_S = 58 * PITCH  # tangential dashpot [N s/m]
K_N = 59 * PITCH  # stiffnesses of the map [N/m], only with exact timing
K_S = 60 * PITCH
# What an event comes to, and what the law does without one:
F_N = 61 * PITCH  # normal force, and that of the spring alone [N]
E_N = 62 * PITCH
RAW = 63 * PITCH  # normal force before the limit, without corrections [N]
# Only with exact timing:
STATE = 64 * PITCH  # of the pair after this step (shared/contact_instants.py)
GIVEN = 65 * PITCH  # 1 where the tangential force is in the next six rows: spring, and the rest [N]
GIVEN_SPRING = 66 * PITCH
GIVEN_REST = 69 * PITCH
GIVEN_SLID = 72 * PITCH  # 1 where it slid
UNTIL = 73 * PITCH  # time to the end of the force [s]; inf where it goes on, -inf where it ended before
REST = 74 * PITCH  # correction of the closing speed that the next step makes [m/s]
KIND = 75 * PITCH  # what the step does with the pair (shared/contact_instants.py)
BEGINS, MAY_END = 76 * PITCH, 77 * PITCH  # lanes where contacts begin, and may end, one after the other

# Only with elastic spheres, in place of those of exact timing (hertz_contact.py):
OVERLAP_OLD = 64 * PITCH  # memory: overlap in the last step [m], and force of the spring then [N]
E_OLD = 65 * PITCH
ROOT = 66 * PITCH  # root of the overlap [m**0.5], and its fourth root [m**0.25]
FOURTH = 67 * PITCH
STIFF_S = 68 * PITCH  # tangential stiffness [N/m], its inverse, that of the last step [m/N]
SOFT_S = 69 * PITCH
SOFT_OLD = 70 * PITCH
SCALE = 71 * PITCH  # factor of the tangential spring [-]

# Events: contacts that begin or may end, packed into lanes of their own (contact_events.py)
EVENT = 78 * PITCH  # twelve rows as from OVERLAP on
N_INPUT = 12
ETA_N_OF_EVENT = 90 * PITCH
STATE_OF_EVENT = 91 * PITCH
SPRING_OF_EVENT = 92 * PITCH  # memory, four rows
DASH_OF_EVENT = 96 * PITCH  # memory, four rows
MASS_OF_EVENT = 100 * PITCH  # of i and of j, two rows each [kg], [kg m2], [m]
INERTIA_OF_EVENT = 102 * PITCH
RADIUS_OF_EVENT = 104 * PITCH
CURVE_OF_EVENT = 106 * PITCH  # of `contact_map.passing` [m/s2]
ANSWER = 107 * PITCH  # fourteen rows as from F_N on
N_ANSWER = 14
# Only where materials differ:
MU = 121 * PITCH  # friction of the pair [-]
MINDLIN = 122 * PITCH  # tangential stiffness of elastic spheres over K sqrt(overlap) [-]
MU_OF_EVENT = 123 * PITCH
K_N_OF_EVENT = 124 * PITCH  # of the law, not of the map [N/m]
K_S_OF_EVENT = 125 * PITCH
# Only in scenes with walls:
SHARE = 126 * PITCH  # of its force that a contact with a face has [-], and what its books held before [J]
KEPT = 127 * PITCH
SIZE = 133 * PITCH
FAR = 1.0e9  # [m] where a lane without a pair puts its partner
