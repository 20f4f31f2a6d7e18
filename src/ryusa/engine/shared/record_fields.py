"""Columns of an open contact record, counted from where it starts in a memory row (fields of model.EVENT)."""

# Open contact record, counted from where it starts in the row (fields of model.EVENT).
GRAIN = 0
PARTNER = 1
T_BEGIN = 2
T_END = 3
T_PART = 4
OVERLAP_MAX = 5
CLOSING_BEGIN = 6
CLOSING_END = 7
SLIP_BEGIN = 8
SLIP_END = 11
IMPULSE_N = 14
IMPULSE = 15
T_SLIDE = 18
ALONE = 19
X_BEGIN = 20
V_BEGIN = 23
V_END = 26
OMEGA_BEGIN = 29
OMEGA_END = 32
