"""Runs: the time loop, the recorder, live numbers, checkpoints and resume."""
