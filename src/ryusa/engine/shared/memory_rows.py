"""How the memory of a pair in touch lies in a row of doubles.

Vectors take three columns. A plane scene keeps the component along its one tangent in the first of them.
"""

# Row of a pair: vectors take three columns. A plane scene keeps the component along its one tangent.
SPRING_S = 0  # tangential spring force on grain i [N]
F_N = 3  # normal force in the last step [N]
DASH_S = 4  # tangential dashpot force on i in the last step [N]
DASH_N = 7  # normal force less normal spring in the last step [N]
OVERLAP = 7  # in its place, of elastic spheres: overlap in the last step [m]
SPRING_R = 8  # rolling spring torque on i [N m]; from here on only where rolling friction acts
DASH_R = 11  # rolling torque on i in the last step, less its spring [N m]
END_ROLLING = 14
WIDTH, WIDTH_ROLLING = 8, 16  # doubles of a row without and with rolling friction: whole cache lines

# Dashpots [N s/m] and stiffnesses [N/m] of a pair, kept beside its row. With exact timing those of its kicks
# (`kick_and_shear.springs_of_kicks`; the tangential one by step), then `way` [s], `after` [1/s] and `stored`
# [N/m] of them in the normal direction, and the effective masses [kg].
ETA_N, ETA_S, K_N, K_S = 0, 1, 2, 3
N_SPRING = 4
WAY, AFTER, STORED, MASS, MASS_S = 4, 5, 6, 7, 8
N_SPRING_OF_KICKS = 9
# Of elastic spheres in their places: dashpots over x**0.25 [N s/m**1.25], stiffness K [N/m**1.5], 1/m [1/kg].
K_HERTZ, PER_MASS = K_N, K_S

# Kinds of springs (`dashpots.set_springs`).
LINEAR, OF_KICKS, HERTZ = 0, 1, 2
