"""What one step adds up over grains: work by model.tally.Book, then energies, then extremes."""

from ryusa.model.tally import N_BOOK

PENDING_DRAG = N_BOOK  # second half of the work of water in the present step
PENDING_TORQUE = N_BOOK + 1
PENDING_LIFT = N_BOOK + 2
PENDING_FLOW = N_BOOK + 3
PENDING_FILM = N_BOOK + 4
KINETIC = N_BOOK + 5  # what grains and springs hold, in the last step of a call
SPIN = N_BOOK + 6
POTENTIAL = N_BOOK + 7
SPRING_N = N_BOOK + 8
SPRING_S = N_BOOK + 9
SPRING_R = N_BOOK + 10
N_CONTACT = N_BOOK + 11
N_SUM = 32
SPEED_2 = 32  # largest speed and spin, squared
SPIN_2 = 33
OVERLAP = 34  # largest overlap over diameter, with its pair
OVERLAP_GRAIN = 35
OVERLAP_PARTNER = 36
NOT_FINITE = 37  # lowest id of a grain whose velocity is not finite
N_COLUMN = 40
NO_GRAIN = 2147483647
