"""How a batch of pairs lies in memory: what the law of contact reads and leaves, lane by lane.

The loop over lanes becomes vector instructions: eight pairs at a time where the machine has them. For that it works on
two flat arrays only, at places known when it is compiled. Groups of four doubles belong to one pair, so that they
are filled and emptied by whole vectors. Plain integers, since kernels read them as constants.
"""

LANES = 64  # pairs in a batch

# Desk: what one batch works on, the same few kilobytes for batch after batch. Groups of four:
D_APART = 0  # from i to j [m], and nothing
D_SLIP = 4 * LANES  # velocity of i against j [m/s], and nothing
D_SPIN_I = 8 * LANES  # spin of i [rad/s] and its radius [m]
D_SPIN_J = 12 * LANES
D_FORCE = 16 * LANES  # force on i [N], and nothing
D_TORQUE_I = 20 * LANES  # torque on i [N m], and 1 where they touch
D_TORQUE_J = 24 * LANES
# and rows of one double a pair:
D_DASH_N = 28 * LANES  # what goes into the books [J]
D_DASH_S = 29 * LANES
D_SLIDE = 30 * LANES
D_RELEASED_N = 31 * LANES
D_RELEASED_S = 32 * LANES
D_STEP = 33 * LANES
D_OVERLAP = 34 * LANES  # [m]; of every lane, negative where they do not touch
D_RATIO = 35 * LANES  # overlap over the smaller diameter [-], 0 where they do not touch
# for rolling friction, films and records alone:
D_WAS = 36 * LANES  # 1 where they touched in the last step
D_CLOSING = 37 * LANES  # [m/s]
D_NORMAL = 38 * LANES  # three rows [-]
D_SLIDING_V = 41 * LANES  # slip velocity at the contact point, three rows [m/s]
D_SLIDES = 44 * LANES  # 1 where it slides
D_SUMS = 45 * LANES  # books of the block so far, and its largest ratio of overlap
DESK = D_SUMS + 8

# Memory of a batch: rows of one double a pair. A pair that does not touch holds zeros, but for its dashpots.
M_SPRING_S = 0  # tangential spring force on i [N], three rows; a plane scene uses the first
M_DASH_S = 3 * LANES  # tangential dashpot force on i in the last step [N]
M_DASH_N = 6 * LANES  # normal force less normal spring in the last step [N]
M_F_N = 7 * LANES  # normal force in the last step [N]
M_ETA_N = 8 * LANES  # dashpots of this pair [N s/m]
M_ETA_S = 9 * LANES
M_LIVE = 10 * LANES  # 1 where they touched in the last step
N_MEMORY = 11
MEMORY = N_MEMORY * LANES

# What only some variants keep, a row of doubles a pair.
X_SPRING_R = 0  # rolling spring torque on i [N m]
X_DASH_R = 3  # rolling torque on i in the last step, less its spring [N m]
X_ROLLING = 6

FAR = 1.0e9  # [m] where a lane without a pair puts its partner
