"""What one step adds up over grains: work by model.tally.Term, then energies, then extremes."""

from ryusa.model.tally import N_TERM

PENDING_DRAG = N_TERM  # second half of the work of water in the present step
PENDING_TORQUE = N_TERM + 1
PENDING_LIFT = N_TERM + 2
PENDING_FLOW = N_TERM + 3
PENDING_FILM = N_TERM + 4
KINETIC = N_TERM + 5  # what grains and springs hold, in the last step of a call
SPIN = N_TERM + 6
POTENTIAL = N_TERM + 7
SPRING_N = N_TERM + 8
SPRING_S = N_TERM + 9
SPRING_R = N_TERM + 10
N_CONTACT = N_TERM + 11
PENDING_STEP = N_TERM + 12  # with exact timing, second half of the work of contacts at the kicks
N_SUM = 32
SPEED_2 = 32  # largest speed and spin, squared
SPIN_2 = 33
OVERLAP = 34  # largest overlap over diameter, with its pair
OVERLAP_GRAIN = 35
OVERLAP_PARTNER = 36
NOT_FINITE = 37  # lowest id of a grain whose velocity is not finite
KICKED_2 = 38  # with exact timing, largest speed after the kicks, squared
N_COLUMN = 40
NO_GRAIN = 2147483647

# What a shear adds up over grains: works that are booked with the next step, then extremes.
OF_STEP, OF_DASH_N, OF_DASH_S, OF_SLIDE = 0, 1, 2, 3
N_OF_SUM = 4
OF_SPEED_2, OF_SPIN_2 = 4, 5
N_OF_SHEAR = 8
