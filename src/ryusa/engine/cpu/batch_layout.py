"""How a batch of touching pairs lies in memory while the contact law is computed, lane by lane.

The loop over lanes becomes vector instructions: eight pairs at a time where the machine has them. For that
it works on one flat array, at places known when it is compiled. Groups of four doubles belong to one pair, so
that they are filled and emptied by whole vectors; rows hold one double a pair. Plain integers, since kernels
read them as constants. A loop reads all four of a group or none: else it would have to end in single lanes.
"""

LANES = 32  # pairs in a batch, a power of two
# Doubles between rows: with a power of two all rows would fall into the same few places of the cache.
PITCH = LANES + 8

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
# Energy account [J], summed lane by lane until the block is done:
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
K_N = 59 * PITCH  # stiffnesses of kick and map [N/m], only with exact timing
K_S = 60 * PITCH
# What the law does:
F_N = 61 * PITCH  # normal force, and that of the spring alone [N]
E_N = 62 * PITCH
RAW = 63 * PITCH  # normal force before the limit [N]
# Only with exact timing:
STATE = 64 * PITCH  # of the pair after this step (shared/contact_instants.py)
KICK = 65 * PITCH  # normal force of the kick: half of the dashpot acts before it, half after [N]
STORED = 66 * PITCH  # stiffness of which the energy is that of the spring [N/m]
WAY, AFTER = 67 * PITCH, 68 * PITCH  # of the shear, as in shared/memory_rows.py
MASS, MASS_S = 69 * PITCH, 70 * PITCH  # effective masses in the normal and the tangential direction [kg]
TURNS = 71 * PITCH  # 1 where the pair turns as it passes: 0 of planes and faces
CHANGE, SHIFT = 72 * PITCH, 73 * PITCH  # of the closing speed [m/s] and the overlap [m] between two kicks
KIND = 74 * PITCH  # what happens between two kicks
TOUCHES, MAY_PART = 75 * PITCH, 76 * PITCH  # lanes that touch, and may part, one after the other
K_LAW = 77 * PITCH  # normal stiffness of the law, where materials differ [N/m]

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
EVENT = 78 * PITCH
STATE_E, OVERLAP_E, CLOSING_E, F_N_E = (EVENT + k * PITCH for k in range(4))
MASS_E, ETA_N_E, K_N_E, WAY_E, AFTER_E = (EVENT + k * PITCH for k in range(4, 9))
MASS_S_E, K_S_E, ETA_S_E = (EVENT + k * PITCH for k in range(9, 12))
SPRING_E, SHEAR_E, SLIP_E = EVENT + 12 * PITCH, EVENT + 15 * PITCH, EVENT + 18 * PITCH  # three rows each
# in their place the answers
PUSH_E = EVENT + 26 * PITCH
SPENT_E = EVENT + 29 * PITCH
SLID_E = EVENT + 31 * PITCH
WHEN_E = EVENT + 32 * PITCH
LAW_E = EVENT + 33 * PITCH  # stiffnesses and friction, three rows, where materials differ
SIDEWAYS = EVENT + 36 * PITCH  # a group of four: shift of i times its mass, and nothing [kg m]
WHEN = EVENT + 40 * PITCH  # of a pair: time of touch or release after the step [s]
# Only where materials differ:
MU = 121 * PITCH  # friction of the pair [-]
MINDLIN = 122 * PITCH  # tangential stiffness of elastic spheres over K sqrt(overlap) [-]
# Only in scenes with walls:
SHARE = 126 * PITCH  # of its force that a contact with a face has [-], and what its account held before [J]
KEPT = 127 * PITCH
PUSH = 133 * PITCH  # tangential impulse of an event on i, three rows [N s]
BEND = 136 * PITCH  # rate at which the closing speed of free grains falls as they pass each other [m/s2]
SIZE = 137 * PITCH
FAR = 1.0e9  # [m] where a lane without a pair puts its partner
