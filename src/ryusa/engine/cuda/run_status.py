"""Where a run stands, kept on the device: whole numbers and doubles, by the places named here."""

# int64
STOP = 0  # 0, or why steps are skipped (shared/status.py)
STEP = 1  # done since the start of the run
CURRENT = 2  # half that holds now
ENDED = 3  # records that wait to be fetched
OVERFLOWED = 4  # lowest id of a grain whose record found no room
TARGET = 5  # steps that will have been done when a call returns
KICKED = 6  # with exact timing, 1 after the kicks of a step, whose shear is still to come
N_STATUS = 8

# The same, doubles.
TRAVEL = 0  # bound of the displacement of any grain since the list was built [m]
SKIN = 1  # reach of the list beyond touch [m]
FASTEST = 2  # speed in the last step [m/s]
N_MOTION = 3
