"""Settings of all tests."""

from hypothesis import settings

# With new examples on every run one run of the suite fails and the next passes; `make fuzz` looks further.
# No deadline: first calls compile, and machines are shared.
settings.register_profile("ryusa", deadline=None, derandomize=True)
settings.register_profile("random", deadline=None)  # pytest --hypothesis-profile=random
settings.load_profile("ryusa")
