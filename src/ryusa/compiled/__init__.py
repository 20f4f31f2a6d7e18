"""Compiled functions: what decides about them, where they are kept, and how Numba makes them.

A function marked `compiled` is known by its content: its bytecode and that of all that it calls, the
constants it reads, its options. Numba is loaded and asked only when a kernel is called that the store does
not hold.
"""
