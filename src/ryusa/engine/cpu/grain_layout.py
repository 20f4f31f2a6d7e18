"""Where the quantities of one grain in water lie while its step is computed, in groups of four doubles."""

V = 0  # velocity [m/s] and spin [rad/s] before the step, and after it
V_NEW = 4
W = 8
W_NEW = 12
FORCE = 16  # force [N] but for drag and weight
DRAG = 20  # [N]
TORQUE = 24  # torque [N m], and contacts
LIFT = 28  # lift and Magnus force [N], and torque of the water over spin [N m s]
FLOW = 32  # force of the flow on what it carries [N], and 1 where a grain is in the water
ADDED = 36  # added mass in the water [kg], and nothing
SIZE = 40
