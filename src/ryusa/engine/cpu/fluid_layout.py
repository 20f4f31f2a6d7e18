"""How a batch of grains in water lies in memory while the forces on them are computed, lane by lane.

As in batch_layout.py: one flat array, groups of four doubles that belong to one grain, rows of one double a
grain. A loop reads all four of a group or none.
"""

LANES = 64  # grains in a batch, a power of two
PITCH = LANES + 8  # between rows

# Groups of four:
SLIP = 0  # velocity of the water relative to the grain [m/s], and its shear [1/s]
FLUID = 4 * PITCH  # columns 4 to 7 of model.fluid; in water of a given profile centre and radius [m]
SPIN = 8 * PITCH  # spin, then spin relative to the water [rad/s]; radius [m], then nothing
LIFT = 12 * PITCH  # lift and Magnus force [N], and nothing
FLOW = 16 * PITCH  # force of the flow on what it carries [N], and nothing
# Rows:
(
    SHARE,  # part of the grain in the water [-]
    ADDED,  # added mass in the water [kg]
    D,  # diameter [m]
    U_X, U_Y, U_Z,  # slip [m/s]
    SPEED,  # its magnitude [m/s]
    SHEAR,  # of the water [1/s]
    PHI,  # concentration of grains [-]
    A_X,  # acceleration of the water [m/s2]
    HEIGHT,  # over the zero of a given profile [m]
    PROFILE,  # its speed there [m/s]
    O_X, O_Y, O_Z,  # spin relative to the water [rad/s]
    WHIRL,  # its magnitude [rad/s]
    ALONE,  # slip of an isolated grain with the same drag but for the factor [m/s]
    FACTOR,  # of that drag [-]
    C_D,  # drag coefficient [-]
    K_D,  # drag over slip [N s/m]
    NORMAL,  # shear lift along z [N]
    ACROSS,  # shear lift over slip [N s/m]
    K_M,  # factor of the Magnus force [kg]
    K_T,  # torque over relative spin [N m s]
) = range(20 * PITCH, 44 * PITCH, PITCH)  # fmt: skip
# Work of each force [J] in groups of four, by component: before x(n), and after it
WORK = 44 * PITCH
DRAG_WORK, LIFT_WORK, FLOW_WORK, FILM_WORK, TORQUE_WORK = range(WORK, WORK + 40, 8)
SIZE = WORK + 40
