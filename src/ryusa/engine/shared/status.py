"""What a kernel reports, since it cannot raise: why it came back, and the first fault."""

# What a kernel cannot raise.
FAULT_NONE = 0
FAULT_NOT_A_NUMBER = 1
FAULT_OVERLAP = 2
FAULT_EVENTS_FULL = 3
FAULT_CROSSED = 4  # a grain went through a face
# Why a kernel call came back.
STOP_DONE = 0
STOP_LIST = 1  # the Verlet list has to be rebuilt
STOP_EVENTS = 2  # event buffers want draining
STOP_FAULT = 3
STOP_UNSAFE = 4  # a grain went further in one step than the list allows
STOP_PAIR = 5  # a pair in touch is not in the Verlet list, which should not be
